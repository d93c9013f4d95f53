"""The check that answers have all digits of their format: that no rule rounds them or numbers inside the step."""

from __future__ import annotations

from collections.abc import Sequence
from math import log2

from driftproof.blackbox.checks.quantisation import narrow_format, quantisation_of
from driftproof.blackbox.checks.trials import (
    ANOTHER,
    IRREGULAR_STEP,
    ORDINARY_STATE,
    CheckResult,
    TrialRunner,
    steady_runner,
)
from driftproof.blackbox.stepper.array_adapters import ARRAYS, LISTS, SCALARS
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.rounding.formats import BINARY64

_KEY = "full_precision"
# A larger error is no matter of rounding: binary32 inside a step leaves 24 bits less a few. Rounding errors at two
# sizes differ by at most the second factor, six bits of chance.
_NO_DIGITS, _ALIKE = 2.0**-18, 2.0**6
_DOUBLES = (SCALARS, ARRAYS, LISTS)


def digits(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check whether answers are whole, decimal, fixed-point or narrower numbers, or were computed from such."""
    runner = steady_runner(subject)
    trials = [trial for trial in (runner.trial(*z, IRREGULAR_STEP) for z in _states()) if trial.finite]
    numbers = [x for trial in trials for x in trial.answer or ()]
    words = _rounded(numbers, subject) or _rounds_inside(runner)
    if words:
        return (CheckResult(_KEY, False, words, (trials[0],)),)
    return (CheckResult(_KEY, True, f"answers have the full precision of {subject.format.name}"),)


def _states() -> list[tuple[float, float]]:
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
    least, most = sorted(max(_defect(runner, 2.0**-k, *z) for z in _states()) for k in (30, 60))
    if not runner.rounding < least <= most < _NO_DIGITS:
        return ""
    if most > _ALIKE * least:  # a rule about sizes, or dynamics, and no rounding
        return ""
    bits = round(-log2(most))
    return f"S(3z) is 3 S(z) to about {bits} bits only: it uses narrower numbers, or a solver that stops early"


def _defect(runner: TrialRunner, size: float, q: float, v: float) -> float:
    """|S(3z) - 3 S(z)| over |S(3z)|, each in its largest component, for z of that size."""
    once = runner.trial(size * q, size * v, IRREGULAR_STEP).answer
    thrice = runner.trial(3 * size * q, 3 * size * v, IRREGULAR_STEP).answer
    if once is None or thrice is None or not any(thrice):
        return 0.0
    return max(abs(b - 3 * a) for a, b in zip(once, thrice, strict=True)) / max(map(abs, thrice))
