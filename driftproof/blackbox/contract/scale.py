"""Whether a step is proportional to the state, from the smallest numbers to the largest, and how it ends to be."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from driftproof.blackbox.contract.bench import ORDINARY, TYPICAL_STEP, Bench, State, steady_bench
from driftproof.blackbox.contract.clauses import Clause
from driftproof.blackbox.contract.rays import LINEAR, Ray, apart, departing
from driftproof.blackbox.contract.still import NAMES
from driftproof.blackbox.contract.thresholds import edge
from driftproof.blackbox.stepper.subject import Subject
from driftproof.symbolic.rounding.formats import power_of_two

_REST, _DIGITS, _SUBNORMALS = "rest", "small_digits", "subnormals"
# So many roundings of sums with a number of ordinary size, or units of the smallest number, are no rule.
_SUMS = 64
_SMALL = (-30, -20, -12, -8, -5, -3, -1, 0)
_LARGE = (0, 1, 3, 5, 8, 12, 20, 40, 100, 300, 700)


def scale(subject: Subject) -> tuple[Clause, ...]:
    """Whether (0, 0) stays at rest, whether S(sz) = s S(z), and whether the smallest numbers survive."""
    bench = steady_bench(subject)
    origin = bench.trial(0.0, 0.0, TYPICAL_STEP)
    if origin.answer is None or not origin.finite:
        return (Clause(_REST, False, f"(0, 0) has no answer: {origin.seen}", (origin,)),)
    if any(origin.answer):
        rest = Clause(_REST, None, f"(0, 0) does not stay at rest, it goes to {origin.seen}", (origin,))
        return rest, Clause(LINEAR, False, "not proportional to the state, since (0, 0) moves", (origin,))
    if bench.is_coarse:
        return (Clause(LINEAR, None, "not asked: answers are too coarse to tell whether the step is linear"),)
    rays = [Ray(bench, direction) for direction in _directions()]
    return Clause(_REST, True, "(0, 0) stays at rest", (origin,)), *_linear(bench, rays), *_subnormals(bench, rays[::2])


def _directions() -> tuple[State, ...]:
    q, v = ORDINARY
    return (q, 0.0), (-q, 0.0), (0.0, v), (0.0, -v)


def _linear(bench: Bench, rays: Sequence[Ray]) -> tuple[Clause, ...]:
    """Proportional along the rays, if need be from ordinary size on, odd and additive."""
    small = next(filter(None, map(_absolute_rounding, rays)), None)
    exponents = [*(() if small else _SMALL[:-1]), *(k for k in _LARGE if k < bench.format.emax - 3)]
    broken = [(ray, *pair) for ray in rays for pair in [_first_break(ray, exponents)] if pair]
    found = departing(broken) if broken else _odd_and_additive(bench, rays)
    return found, small or Clause(_DIGITS, True, "small states keep all their digits")


def _absolute_rounding(ray: Ray) -> Clause | None:
    """A clause if small states have errors as of a sum with a number of ordinary size, and no others."""
    once = ray.over(1.0)
    errors = [(apart(ray.over(2.0**k), once), 2.0**k) for k in _SMALL]
    largest = max(error * s for error, s in errors)
    allowed = _SUMS * max(float(ray.bench.format.u), ray.bench.grain)
    if max(error for error, _ in errors) <= ray.bench.rounding or largest > allowed:
        return None
    words = f"small states lose digits: the error stays at up to {largest:.1g} however small they are"
    return Clause(_DIGITS, False, words, (ray.trial(1.0), ray.trial(2.0 ** _SMALL[0])))


def _first_break(ray: Ray, exponents: Sequence[int]) -> tuple[float, float] | None:
    """The first neighbouring powers of two between which S(sz)/s changes by more than rounding."""
    for k, m in pairwise(exponents):
        if apart(ray.over(2.0**m), ray.over(2.0**k)) > ray.bench.rounding:
            return 2.0**k, 2.0**m
    return None


def _odd_and_additive(bench: Bench, rays: Sequence[Ray]) -> Clause:
    """Along the rays all is proportional: what is left is S(-z) = -S(z) and S(q, v) = S(q, 0) + S(0, v)."""
    (q, minus_q, v, minus_v), both = (ray.trial(1.0) for ray in rays), bench.trial(*ORDINARY, TYPICAL_STEP)
    for one, other in ((q, minus_q), (v, minus_v)):
        if one.answer and other.answer and apart([-x for x in other.answer], one.answer) > bench.rounding:
            return Clause(LINEAR, False, "not linear: S(-z) is not -S(z)", (one, other))
    if q.answer and v.answer and both.answer:
        summed = [x + y for x, y in zip(q.answer, v.answer, strict=True)]
        if apart(both.answer, summed) > bench.rounding:
            return Clause(LINEAR, False, "not linear: S(q, v) is not S(q, 0) + S(0, v)", (q, v, both))
    return Clause(LINEAR, True, "linear in the state, to rounding")


def _subnormals(bench: Bench, rays: Sequence[Ray]) -> tuple[Clause, ...]:
    """Whether results below the normal numbers are there to a few units of the smallest number."""
    e_min = bench.format.emin
    ordinary, tiny = 2.0 ** (e_min // 4), 2.0 ** (e_min - 9)
    asked = [ray for ray in rays if apart(ray.over(ordinary), ray.over(16 * ordinary)) <= bench.rounding]
    for ray in asked:
        c, base, seen = ray.component, ray.over(ordinary), ray.trial(tiny)
        if base is not None and seen.answer is not None:
            lost = abs(seen.answer[c] - base[c] * tiny) > _SUMS * float(bench.format.eta)
            if lost:
                return (_lost(ray, ordinary, tiny),)
    if not asked:
        return (Clause(_SUBNORMALS, None, "not asked of subnormal numbers: small steps are not linear"),)
    return (Clause(_SUBNORMALS, True, "subnormal numbers are kept"),)


def _lost(ray: Ray, ordinary: float, tiny: float) -> Clause:
    """The clause where numbers below the normal ones, or long before, become 0 or something else."""
    name, size = NAMES[ray.component], abs(ray.z[ray.component])

    def vanishes(s: float) -> bool:
        answer = ray.trial(s).answer
        return answer is None or answer[ray.component] == 0

    if not vanishes(tiny):
        return Clause(_SUBNORMALS, False, f"{name} near {size * tiny:.2g} has another answer", (ray.trial(tiny),))
    ends = edge(vanishes, ordinary, tiny, ray.bench)
    limit = size * ends[0]
    kind = "subnormal" if limit < 2 * float(power_of_two(ray.bench.format.emin)) else "small"
    words = f"{kind} numbers become 0: {name} below {limit:.3g}"
    return Clause(_SUBNORMALS, False, words, tuple(map(ray.trial, ends)))
