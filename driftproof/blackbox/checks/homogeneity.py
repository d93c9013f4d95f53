"""Checks that a step is proportional to the state, from the smallest numbers to the largest, and to all digits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, log2, log10

from driftproof.blackbox.checks.borders import COMPONENT_NAMES, NegligibleStep, bisected_neighbours, negligible_step
from driftproof.blackbox.checks.trials import (
    ANOTHER,
    IRREGULAR_STEP,
    ORDINARY_STATE,
    TYPICAL_STEP,
    CheckResult,
    PhasePoint,
    Trial,
    TrialRunner,
    narrow_format,
    quantisation_of,
    steady_runner,
)
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, LISTS, SCALARS
from driftproof.symbolic.rounding.formats import BINARY64, power_of_two

LINEAR, _REST, _DIGITS, _SUBNORMALS = "linear", "rest", "small_digits", "subnormals"
# An error of up to this many u of a number of ordinary size, or of this many smallest numbers, is rounding and no rule:
# no sum of the catalogue has more than 18 terms (kahan_li8), each rounded at most three times in a program's own units.
_SUMS = 64
# Exponents of two at which states are tried: closely spaced where rules and bends begin, widely where only overflow is.
_SMALL = (-30, -20, -12, -8, -5, -3, -1, 0)
_LARGE = (0, 1, 3, 5, 8, 12, 20, 40, 100, 300, 700)
# A smooth departure from proportionality grows at most like the sixth power of the size: from where it first shows to
# _SOON times that size by less than _SHARP. One that begins at a border grows by more, or exceeds the part _PLAIN.
_SOON, _SHARP, _PLAIN = 4.0, 2.0**16, 2.0**-4
# A step that changes within this factor is linear nowhere.
_NEXT = 1 + 2.0**-20


def homogeneity(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that (0, 0) stays at rest, that S(sz) = s S(z), and that the smallest numbers survive."""
    runner = steady_runner(subject)
    origin = runner.trial(0.0, 0.0, TYPICAL_STEP)
    if origin.answer is None or not origin.finite:
        holds = None if subject.convention.kind == MAP else False  # of a system of its own, such as one with a pole
        return (CheckResult(_REST, holds, f"a step from (0, 0) gives no answer: {origin.seen}", (origin,)),)
    if any(origin.answer):
        rest = CheckResult(_REST, None, f"(0, 0) does not stay at rest, it goes to {origin.seen}", (origin,))
        return rest, CheckResult(LINEAR, False, "not proportional to the state, since (0, 0) moves", (origin,))
    if runner.is_coarse:
        return (CheckResult(LINEAR, None, "not tested: answers are too coarse to tell whether the step is linear"),)
    q, v = ORDINARY_STATE
    rays = [Ray(runner, direction) for direction in ((q, 0.0), (-q, 0.0), (0.0, v), (0.0, -v))]
    rest = CheckResult(_REST, True, "(0, 0) stays at rest", (origin,))
    return rest, *_linear(runner, rays), *_subnormals(runner, rays[::2])


def _linear(runner: TrialRunner, rays: Sequence[Ray]) -> tuple[CheckResult, ...]:
    """Check that the step is proportional along the rays, if need be from ordinary size on, and odd and additive."""
    small = next(filter(None, map(_absolute_rounding, rays)), None)
    exponents = [*(() if small else _small(runner)[:-1]), *(k for k in _LARGE if k in range(runner.format.emax))]
    broken = [(ray, *change) for ray in rays if (change := _first_break(ray, exponents))]
    found = _departing(broken) if broken else _odd_and_additive(runner, rays)
    return found, small or CheckResult(_DIGITS, True, "small states keep all their digits")


def _small(runner: TrialRunner) -> list[int]:
    """The small exponents with relative rounding: below _SUMS 2**emin, eta/2 for a sum is more than u of it."""
    return [k for k in _SMALL if 2.0**k >= _SUMS * 2.0**runner.format.emin]


def _absolute_rounding(ray: Ray) -> CheckResult | None:
    """The failed check if the errors of small states are those of a sum with a number of ordinary size; else None."""
    once, small = ray.over(1.0), _small(ray.runner)
    errors = [(relative_error(ray.over(2.0**k), once), 2.0**k) for k in small]
    largest = max(error * s for error, s in errors)
    allowed = _SUMS * max(float(ray.runner.format.u), ray.runner.grain)
    if max(error for error, _ in errors) <= ray.runner.rounding or largest > allowed:
        return None
    words = f"small states lose digits: the error remains up to {largest:.1g}, however small the state"
    return CheckResult(_DIGITS, False, words, (ray.trial(1.0), ray.trial(2.0 ** small[0])))


def _first_break(ray: Ray, exponents: Sequence[int]) -> tuple[float, float] | None:
    """The first neighbouring powers of two between which S(sz)/s changes by more than rounding; None if none do."""
    for k, m in pairwise(exponents):
        if relative_error(ray.over(2.0**m), ray.over(2.0**k)) > ray.runner.rounding:
            return 2.0**k, 2.0**m
    return None


def _odd_and_additive(runner: TrialRunner, rays: Sequence[Ray]) -> CheckResult:
    """Check S(-z) = -S(z) and S(q, v) = S(q, 0) + S(0, v) of a step that is proportional along the rays."""
    (q, minus_q, v, minus_v), both = (ray.trial(1.0) for ray in rays), runner.trial(*ORDINARY_STATE, TYPICAL_STEP)
    for one, other in ((q, minus_q), (v, minus_v)):
        if one.answer and other.answer and relative_error([-x for x in other.answer], one.answer) > runner.rounding:
            return CheckResult(LINEAR, False, "not linear: S(-z) is not -S(z)", (one, other))
    if q.answer and v.answer and both.answer:
        summed = [x + y for x, y in zip(q.answer, v.answer, strict=True)]
        if relative_error(both.answer, summed) > runner.rounding:
            return CheckResult(LINEAR, False, "not linear: S(q, v) is not S(q, 0) + S(0, v)", (q, v, both))
    if missing := [trial for trial in (q, minus_q, v, minus_v, both) if not trial.answer]:
        return CheckResult(LINEAR, None, f"not tested everywhere: {missing[0].line}", (missing[0],))
    return CheckResult(LINEAR, True, "linear in the state, to rounding")


def _subnormals(runner: TrialRunner, rays: Sequence[Ray]) -> tuple[CheckResult, ...]:
    """Check that results below the normal numbers are right to a few units of the smallest number."""
    e_min = runner.format.emin
    ordinary, tiny = 2.0 ** (e_min // 4), 2.0 ** (e_min - 9)
    asked = [ray for ray in rays if relative_error(ray.over(ordinary), ray.over(16 * ordinary)) <= runner.rounding]
    for ray in asked:
        c, base, seen = ray.component, ray.over(ordinary), ray.trial(tiny)
        off = abs(seen.answer[c] - base[c] * tiny) / float(runner.format.eta) if base and seen.answer else 0.0
        if off > _SUMS and off > _SUMS * _grown(ray):
            return (_lost(ray, ordinary, tiny),)
    if not asked:
        return (CheckResult(_SUBNORMALS, None, "not tested on subnormal numbers: small steps are not linear"),)
    return (CheckResult(_SUBNORMALS, True, "subnormal numbers are preserved"),)


def _grown(ray: Ray) -> float:
    """How far a step multiplies a state, forward or backward, and with it the rounding of its stages: 1 or more."""
    trials = (ray.runner.trial(*ray.z, h) for h in (TYPICAL_STEP, -TYPICAL_STEP))
    ends = [abs(x) for trial in trials if trial.finite for x in trial.answer or ()]
    return max(1.0, *(x / abs(ray.z[ray.component]) for x in ends), 0.0)


def _lost(ray: Ray, ordinary: float, tiny: float) -> CheckResult:
    """The failed check of a step whose results below the normal numbers, or larger ones, become 0 or something else."""
    name, size = COMPONENT_NAMES[ray.component], abs(ray.z[ray.component])

    def vanishes(s: float) -> bool:
        answer = ray.trial(s).answer
        return not (answer and answer[ray.component])

    if not vanishes(tiny):
        words = f"for {name} near {size * tiny:.2g} the answer does not scale with the state"
        return CheckResult(_SUBNORMALS, False, words, (ray.trial(tiny),))
    ends = bisected_neighbours(vanishes, ordinary, tiny, ray.runner)
    limit = size * ends[0]
    kind = "subnormal" if limit < 2 * float(power_of_two(ray.runner.format.emin)) else "small"
    words = f"{kind} numbers become 0: {name} below {limit:.3g}"
    return CheckResult(_SUBNORMALS, False, words, tuple(map(ray.trial, ends)))


@dataclass(frozen=True)
class Ray:
    """The states s z with s > 0."""

    runner: TrialRunner
    z: PhasePoint

    @property
    def component(self) -> int:
        """The component that is not 0."""
        return int(self.z[0] == 0)

    def trial(self, s: float) -> Trial:
        """The step from s z."""
        q, v = (self.runner.number(s * x) for x in self.z)
        return self.runner.trial(q, v, TYPICAL_STEP)

    def over(self, s: float) -> tuple[float, float] | None:
        """S(sz)/s; None if there is no finite answer."""
        trial = self.trial(s)
        return (trial.answer[0] / s, trial.answer[1] / s) if trial.answer and trial.finite else None


def relative_error(first: Sequence[float] | None, second: Sequence[float] | None) -> float:
    """The distance of the two, relative to the second; 0 if one of them is missing, which other checks report."""
    if first is None or second is None or first == second:
        return 0.0
    distance, size = max(abs(x - y) for x, y in zip(first, second, strict=True)), max(map(abs, second))
    return distance / size if size else inf


def _departing(broken: Sequence[tuple[Ray, float, float]]) -> CheckResult:
    """The check of a step that is linear only up to borders, or nowhere; each ray has a change between its two s."""
    short, borders = negligible_step(broken[0][0].runner), []
    for ray, low, high in broken:
        if short is not None and _leaves_domain(short, ray, low, high):
            continue  # another check reports that
        differs = lambda s, ray=ray, low=low: _departure(ray, low, s) > ray.runner.rounding
        s, name = bisected_neighbours(differs, low, high, ray.runner)[1], COMPONENT_NAMES[ray.component]
        if s <= low * _NEXT or _departure(ray, low, _SOON * s) <= min(_SHARP * ray.runner.rounding, _PLAIN):
            at = max(1.0, low * _SOON)
            where = f"at {name} = {at * ray.z[ray.component]:.3g}"
            bent = f"nonlinear: {where} it departs from proportionality by {_departure(ray, low, at):.2g}"
            return CheckResult(LINEAR, False, bent, (ray.trial(low), ray.trial(at)))
        digits = round(-log10(ray.runner.rounding)) - 2  # digits that show the border, not the rounding
        border = f"linear only up to {name} = {s * ray.z[ray.component]:.{digits}g}"
        borders.append((border, (ray.trial(s), ray.trial(_SOON * s))))
    if not borders:
        return CheckResult(LINEAR, True, "linear within its domain, to rounding")
    words, examples = zip(*borders, strict=True)
    return CheckResult(LINEAR, False, "; ".join(words), tuple(trial for example in examples for trial in example))


def _departure(ray: Ray, low: float, s: float) -> float:
    return relative_error(ray.over(s), ray.over(low))


def _leaves_domain(short: NegligibleStep, ray: Ray, low: float, s: float) -> bool:
    """True if a rule about states changes the state itself, or the one that a linear step would reach."""
    straight = ray.over(low)
    states = [ray.z] if straight is None else [ray.z, straight]
    scaled = [[ray.runner.number(s * x) for x in z] for z in states]
    return not all(short.keeps(ray.runner.trial(q, v, short.h)) for q, v in scaled)


# A larger error is no matter of rounding: binary32 inside a step leaves 24 bits less a few. Rounding errors at two
# sizes differ by at most the second factor, six bits of chance.
_NO_DIGITS, _ALIKE = 2.0**-18, 2.0**6
_DOUBLES = (SCALARS, ARRAYS, LISTS)


def digits(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check whether answers are whole, decimal, fixed-point or narrower numbers, or were computed from such."""
    runner = steady_runner(subject)
    trials = [trial for trial in (runner.trial(*z, IRREGULAR_STEP) for z in _generic_states()) if trial.finite]
    numbers = [x for trial in trials for x in trial.answer or ()]
    words = _rounded(numbers, subject) or _rounds_inside(runner)
    if words:
        return (CheckResult("full_precision", False, words, (trials[0],)),)
    return (CheckResult("full_precision", True, f"answers have the full precision of {subject.format.name}"),)


def _generic_states() -> list[tuple[float, float]]:
    """States with all their bits, of ordinary size, of up to a thousand times and down to a thousandth of it."""
    return [(a * q, b * v) for q, v in (ORDINARY_STATE, ANOTHER) for a, b in ((1, 1), (1000, 10), (0.01, 0.001))]


def _rounded(numbers: Sequence[float], subject: ForeignStepper) -> str:
    """The rule by which all numbers are rounded, in words; "" if there is none."""
    grain, narrow = quantisation_of(numbers), narrow_format(numbers)
    given = BINARY64 if subject.adapter in _DOUBLES else subject.format
    if grain is not None:
        return grain.words
    return f"answers are rounded to {narrow.name}" if narrow and narrow.precision < given.precision else ""


def _rounds_inside(runner: TrialRunner) -> str:
    """The remark that S(3z) = 3 S(z) holds to fewer digits than are returned, alike at two sizes; "" if not."""
    if runner.format is not BINARY64 or runner.grain:
        return ""
    least, most = sorted(max(_tripled(runner, 2.0**-k, *z) for z in _generic_states()) for k in (30, 60))
    if not runner.rounding < least <= most < _NO_DIGITS:
        return ""
    if most > _ALIKE * least:  # a rule about sizes, or dynamics, and no rounding
        return ""
    bits = round(-log2(most))
    return f"S(3z) is 3 S(z) to about {bits} bits only: it uses narrower numbers, or a solver that stops early"


def _tripled(runner: TrialRunner, size: float, q: float, v: float) -> float:
    """|S(3z) - 3 S(z)| over |S(3z)|, each in its largest component, for z of that size."""
    once = runner.trial(size * q, size * v, IRREGULAR_STEP).answer
    thrice = runner.trial(3 * size * q, 3 * size * v, IRREGULAR_STEP).answer
    if once is None or thrice is None or not any(thrice):
        return 0.0
    return max(abs(b - 3 * a) for a, b in zip(once, thrice, strict=True)) / max(map(abs, thrice))
