"""Steps of controlled size: the controller's loop, and attempts of explicit pairs, which estimate their own error.

An attempt returns the size of its error: the largest over components of the estimate over `absolute` + `relative` |y|.
It is accepted if that is at most 1, and else repeated with a shorter h; the next h is SAFETY (1 / error)^(1 / power)
times the last, within limits (hairer-norsett-wanner-1993, II.4). Attempts of implicit methods are in
`numeric.steps.simplified_newton`. These are loops over numbers, as `numeric.steps.loops` says.
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp, inf, isfinite, log
from typing import Any, NamedTuple, TypeAlias

from driftproof.numeric.steps.loops import FieldWriters

# The limits and the safety factor of the change of h (hairer-norsett-wanner-1993, II.4).
MOST_LONGER, MOST_SHORTER, SAFETY = 5.0, 0.2, 0.9
# Smaller errors are taken as this, the logarithm of 0 being undefined; it makes the next step MOST_LONGER already.
SMALLEST = 1e-10
# A run whose steps are this much shorter than itself is given up; at t = 0 they would otherwise shrink for ever.
# Chosen: well below u, as the first steps of stiff runs may be, and long before h² underflows.
LEAST_STEP = 1e-30
# Smaller sizes of y and f, and a smaller bend, tell nothing of the first step (hairer-norsett-wanner-1993, II.4).
_LEAST_SIZE, _LEAST_BEND = 1e-5, 1e-15
# Indices in a report, and the values of its STATE.
EVALUATIONS, STEPS, REJECTED, STATE, TIME = range(5)
DONE, TOO_SHORT, GIVEN_UP = range(3)


class Tolerances(NamedTuple):
    """The tolerances of a run: an error of at most `absolute` + `relative` |y| in every component is accepted.

    The error of a step is of order h to the `power`. A step size that would grow by no more than the factor `steady` is
    kept. The run is given up after `most` evaluations.
    """

    relative: float
    absolute: float
    power: float
    steady: float = 1.0
    most: float = inf


class StepControl(NamedTuple):
    """What a controlled run is given, and its report; the table and the workspace are those of its attempts.

    After each step of a multiple of `apart` its t and y are written into the next row of the `way`, if there is one.
    """

    given: Tolerances
    table: Any
    work: Any
    report: Any
    way: Any = ()
    apart: int = 1


# attempt(writers, t, y, h, moved, new, control) writes the state at t + h into `new` and returns the size of its error;
# `moved` says that y is not that of the previous attempt.
StepAttempt: TypeAlias = Callable[..., float]


class PairTable(NamedTuple):
    """An explicit pair: its step(t, y, h, first, last, new, off), where `first` holds f(t, y), and what that calls."""

    step: Callable[..., None]
    calls: int  # of f in a step but the first
    keeps: bool  # the last one is at the new state


def error_size(off: Any, y: Any, new: Any, given: Tolerances) -> float:
    """The largest |off| / (absolute + relative max(|y|, |new|)); inf if a component is not finite."""
    largest = 0.0
    for k in range(len(y)):
        scale = given.absolute + given.relative * max(abs(y[k]), abs(new[k]))
        if not isfinite(new[k]) or not isfinite(off[k]):
            return inf
        if abs(off[k]) > largest * scale:
            largest = abs(off[k]) / scale if scale > 0 else inf
    return largest


def _first_step(writers: FieldWriters, y: Any, end: float, given: Tolerances, report: Any) -> float:
    """The initial step size of (hairer-norsett-wanner-1993, II.4), from the sizes of y, f and the change of f."""
    place, slope, other = writers.zeros(3, len(y))
    writers.rate(0.0, y, slope)
    moving, resting = error_size(slope, y, y, given), error_size(y, y, y, given)
    told = resting > _LEAST_SIZE and _LEAST_SIZE < moving < inf
    h = min(0.01 * resting / moving if told else 1e-6, end)
    for k in range(len(y)):
        place[k] = y[k] + h * slope[k]
    writers.rate(h, place, other)
    for k in range(len(y)):
        other[k] = (other[k] - slope[k]) / h
    report[EVALUATIONS] += 2
    bend = max(error_size(other, y, y, given), moving)
    return min(100 * h, end, exp(log(0.01 / bend) / given.power) if _LEAST_BEND < bend < inf else end)


def controlled_steps(writers: FieldWriters, attempt: StepAttempt, y: Any, end: float, control: StepControl) -> None:
    """Overwrite y, the state at t = 0, with that at `end`, unless the run ends in another state of the report."""
    given, _, _, report, way, apart = control
    n, t, moved, new = len(y), 0.0, True, writers.zeros(len(y))
    h = _first_step(writers, y, end, given, report)
    while t < end:
        last = not t + h < end
        h = end - t if last else h
        error = attempt(writers, t, y, h, moved, new, control)
        moved = error <= 1
        if moved:
            t = end if last else t + h
            for k in range(n):
                y[k] = new[k]
        report[STEPS if moved else REJECTED] += 1
        row, rest = divmod(int(report[STEPS]), apart)
        if moved and rest == 0 and row <= len(way):
            way[row - 1][0] = t
            for k in range(n):
                way[row - 1][1 + k] = y[k]
        factor = SAFETY * exp(-log(max(error, SMALLEST)) / given.power) if isfinite(error) else 0.0
        if not 1 <= factor <= given.steady:
            h *= min(MOST_LONGER, max(MOST_SHORTER, factor))
        short = not t + h > t or h < LEAST_STEP * end
        if t < end and (short or report[EVALUATIONS] > given.most):
            report[STATE], report[TIME] = TOO_SHORT if short else GIVEN_UP, t
            return


def pair_attempt(
    writers: FieldWriters, t: float, y: Any, h: float, moved: bool, new: Any, control: StepControl
) -> float:
    """Attempt a step; `work` has a row for f at the start, one for the last f, and one for the error."""
    given, table, (first, last, off), report, _, _ = control
    if moved and (t == 0 or not table.keeps):
        writers.rate(t, y, first)
        report[EVALUATIONS] += 1
    elif moved:
        for k in range(len(y)):
            first[k] = last[k]
    table.step(t, y, h, first, last, new, off)
    report[EVALUATIONS] += table.calls
    return error_size(off, y, new, given)
