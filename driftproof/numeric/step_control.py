"""Steps of controlled size: a plain controller, over attempts whose error is told by the method itself.

An attempt tells the size of its error, at most 1 where it is right: the largest over components of what it is off over
`absolute` + `relative` |y|. It is repeated shorter where it is not; the next h is SAFETY (1 / error)^(1 / power) of
the last, within limits (hairer-norsett-wanner-1993, II.4). What attempts of explicit pairs are is here; those of
implicit methods are in `numeric.simplified_newton`. Loops over numbers, as in `numeric.newton`: the same bits compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp, inf, isfinite, log
from typing import Any, NamedTuple, TypeAlias

from driftproof.numeric.elimination import PYTHON_FLOATS, NumberKind

MOST_LONGER, MOST_SHORTER, SAFETY = 5.0, 0.2, 0.9
# The logarithm is taken of no error below this, which makes a step MOST_LONGER.
SMALLEST = 1e-10
# No problem needs a step that is so much shorter than the run; from t = 0 they would get shorter for ever.
LEAST_STEP = 1e-30
# Places in a report, and how a run has ended.
EVALUATIONS, STEPS, REJECTED, STATE, TIME = range(5)
DONE, TOO_SHORT, GIVEN_UP = 0.0, 1.0, 2.0


class Tolerances(NamedTuple):
    """An error of a step is right that is at most `absolute` + `relative` |y| in every component.

    `power` is that of h in it. Steps that may grow by no more than `steady` times stay as they are. After `most`
    evaluations the run is given up.
    """

    relative: float
    absolute: float
    power: float
    steady: float = 1.0
    most: float = inf


# attempt(t, y, h, moved, new, given, table, work, report) writes the state at t + h and returns the size of its error;
# `moved` tells that y is another than in the attempt before.
StepAttempt: TypeAlias = Callable[..., float]
# run(y, end, given, table, work, report): y becomes the state at the end, in steps from t = 0.
Controlled: TypeAlias = Callable[..., None]


def error_size(kind: NumberKind = PYTHON_FLOATS) -> Callable[..., float]:
    """The function that measures what a step is off."""

    @kind.compiled
    def size(off: Any, y: Any, new: Any, given: Tolerances) -> float:
        """The largest |off| / (absolute + relative max(|y|, |new|)); infinite for what is not finite."""
        largest = 0.0
        for k in range(len(y)):
            scale = given.absolute + given.relative * max(abs(y[k]), abs(new[k]))
            if not isfinite(new[k]) or not isfinite(off[k]):
                return inf
            if abs(off[k]) > largest * scale:
                largest = abs(off[k]) / scale if scale > 0 else inf
        return largest

    return size  # type: ignore[no-any-return]


def controlled_steps(rate: Callable[..., None], attempt: StepAttempt, kind: NumberKind = PYTHON_FLOATS) -> Controlled:
    """The loop over steps from t = 0 to the end."""
    compiled, rows, _, _ = kind
    size = error_size(kind)

    @compiled
    def first_step(y: Any, end: float, given: Tolerances, report: Any) -> float:
        """A step in which y and f move by a hundredth of what is right (hairer-norsett-wanner-1993, II.4)."""
        n = len(y)
        place, slope, other = rows(3, n)
        rate(0.0, y, slope)
        moving, resting = size(slope, y, y, given), size(y, y, y, given)
        h = min(0.01 * resting / moving if resting > 1e-5 and 1e-5 < moving < inf else 1e-6, end)
        for k in range(n):
            place[k] = y[k] + h * slope[k]
        rate(h, place, other)
        for k in range(n):
            other[k] = (other[k] - slope[k]) / h
        report[EVALUATIONS] += 2
        bend = max(size(other, y, y, given), moving)
        return min(100 * h, end, exp(log(0.01 / bend) / given.power) if 1e-15 < bend < inf else end)

    @compiled
    def run(y: Any, end: float, given: Tolerances, table: Any, work: Any, report: Any) -> None:
        n, t, moved, new = len(y), 0.0, True, rows(1, len(y))[0]
        h = first_step(y, end, given, report)
        while t < end:
            last = not t + h < end
            h = end - t if last else h
            error = attempt(t, y, h, moved, new, given, table, work, report)
            moved = error <= 1
            if moved:
                t = end if last else t + h
                for k in range(n):
                    y[k] = new[k]
            report[STEPS if moved else REJECTED] += 1
            factor = SAFETY * exp(-log(max(error, SMALLEST)) / given.power) if isfinite(error) else 0.0
            if not 1 <= factor <= given.steady:
                h *= min(MOST_LONGER, max(MOST_SHORTER, factor))
            short = not t + h > t or h < LEAST_STEP * end
            if t < end and (short or report[EVALUATIONS] > given.most):
                report[STATE], report[TIME] = TOO_SHORT if short else GIVEN_UP, t
                return

    return run  # type: ignore[no-any-return]


def pair_attempts(
    rate: Callable[..., None], step: Callable[..., None], kind: NumberKind = PYTHON_FLOATS
) -> StepAttempt:
    """The attempts of an explicit pair, whose step(t, y, h, first, last, new, off) gets f(t, y) and tells the last f.

    `table` is (calls of f in a step but the first, whether the last is at the new state); `work` a row for each of
    both, and one for the error.
    """
    size = error_size(kind)

    @kind.compiled
    def attempt(
        t: float, y: Any, h: float, moved: bool, new: Any, given: Tolerances, table: Any, work: Any, report: Any
    ) -> float:
        first, last, off = work
        calls, keeps = table
        if moved and (t == 0 or not keeps):
            rate(t, y, first)
            report[EVALUATIONS] += 1
        elif moved:
            for k in range(len(y)):
                first[k] = last[k]
        step(t, y, h, first, last, new, off)
        report[EVALUATIONS] += calls
        return size(off, y, new, given)

    return attempt  # type: ignore[no-any-return]
