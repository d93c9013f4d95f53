"""The attempts at steps of a solver, told apart by their calls, and what they show where an estimate needs no law."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from math import fsum, isclose
from operator import sub
from typing import NamedTuple, TypeAlias

from numpy.polynomial import Chebyshev

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.solvers.foreign_solver import MOST_CALLS_OF_A_RUN, ForeignSolver, Solution, TooSlow
from driftproof.blackbox.solvers.steps import SolverSteps
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import RungeKutta

# The slope of a run as a function of t.
Slope: TypeAlias = Callable[[float], float]
# |y| stays below 1, so that rtol changes the scale of errors by less than one part in 10^6. The larger atol is for
# methods of low order, which take too many steps at the smaller one, the loose one for their errors per unit of time.
RTOL, ATOLS, LOOSE = 1e-13, (1e-7, 1e-4), 1e-3
# Steps this near to a jump are not compared with their slopes.
NEAR = 1e-6
# Times in a step of h at t are equal to this part of h: they are rounded to u t, and h is above 10^-6 t.
_SAME = 1e-8
# The last attempts of a run may be made to land on its end.
_LANDING = 3
# In how many steps an estimate that depends on h alone reaches its tolerance: so few that all are above rounding.
_COUNTS = (16, 32)
# Another first step size costs the few calls in which steps grow from it.
_FAR_MORE = 4
# Codes that keep a step which would grow by less than 1.2 settle at sizes this far apart.
_KEPT = 1.25
# A law that follows an error which is always the same rejects nothing; to and fro, every second attempt is rejected.
_OFTEN, _APART = 1 / 3, 2.0


class Attempt(NamedTuple):
    """One attempt at a step; `accepted` if the run goes on from its end.

    `rejections` counts the rejected attempts in a row, this one included. `factor` is h of the next attempt over h of
    this one, or None if that is not known.
    """

    start: float
    h: float
    rejections: int
    accepted: bool
    factor: float | None


def attempts_of(run: Solution, steps: SolverSteps) -> Iterator[Attempt]:
    """All attempts in order, told apart by the times of their calls; those that end at a returned time are accepted."""
    nodes, position = steps.nodes, 0
    found: list[Attempt] = []
    for start, end in pairwise(run.t):
        lengths: list[float] = []
        while position < len(run.calls) and not (lengths and _at(start + lengths[-1], end, end - start)):
            group = [call.t for call in run.calls[position : position + len(nodes)]]
            length = (max(group) - start) / max(nodes)
            if length <= 0 or not all(_at(t, start + c * length, length) for t, c in zip(group, nodes, strict=False)):
                position += 1  # a call outside all attempts, as for the first step size
                continue
            position += len(nodes)
            lengths.append(length)
            while position < len(run.calls) and _at(run.calls[position].t, start + length, length):
                position += 1
        if not found and len(lengths) > 1 and lengths[0] < lengths[1]:  # of two stages: it chose its first step size
            del lengths[0]
        rejected = lengths[:-1]
        found += [Attempt(start, length, n, False, None) for n, length in enumerate(rejected, 1)]
        found.append(Attempt(start, end - start, len(rejected), True, None))
    # A step that would pass the end is shortened, and the last ones may be stretched to land there.
    for this, after in pairwise(found):
        free = this.start < found[-_LANDING:][0].start and after.start + after.h < run.t[-1] - _SAME * after.h
        free = free and min(this.h, after.h) > NEAR * this.start  # an error per unit of time stays large at a jump
        yield this._replace(factor=after.h / this.h if free else None)


def _at(t: float, time: float, h: float) -> bool:
    return isclose(t, time, rel_tol=0.0, abs_tol=_SAME * h)


def of_another_estimate(subject: ForeignSolver, pair: RungeKutta) -> str:
    """Say that a solver makes far more calls of f where the estimate of this pair is 0 than where every one is; or "".

    As an estimate O(h^p) is 0 where slopes are polynomials in t of a degree below p - 1.
    """
    degree, atol = power_of_estimate(pair) - 2, min(*ATOLS, *_tolerances(pair))
    still = calls = 0
    try:
        still = len(_in_t(subject, lambda t: 0.0, atol).calls)
        calls = len(_in_t(subject, _chebyshev(degree), atol).calls)
    except TooSlow:
        calls = MOST_CALLS_OF_A_RUN * bool(still)
    except Misbehaviour:
        return ""
    seen = f"{calls} calls of f on slopes of degree {degree} in t, where the estimate of {pair.key} is 0"
    told = f"it makes {seen}, and {still} on slopes 0: as if a coefficient of its estimate were another"
    return told if calls > _FAR_MORE * still else ""


def settled_steps(subject: ForeignSolver, steps: SolverSteps, pair: RungeKutta) -> tuple[str, str]:
    """The line on step sizes that settle as the estimate of a pair asks, and the fault of those that go to and fro.

    On slopes of degree p - 1 in t an estimate O(h^p) is the same for all steps of h: they become one length, which goes
    like the tolerance to the power 1/p.
    """
    atols, power = _tolerances(pair), power_of_estimate(pair)
    try:
        runs = [_in_t(subject, _chebyshev(power - 1), atol) for atol in atols]
    except (Misbehaviour, TooSlow):
        return "", ""
    late = [[x for x in attempts_of(run, steps) if 1 < x.start < run.t[-_LANDING - 1 :][0]] for run in runs]
    if not all(late):
        return "", ""
    (long, apart), (short, also) = ((fsum(h) / len(h), max(h) / min(h)) for h in ([x.h for x in each] for each in late))
    rejected = [sum(not x.accepted for x in each) for each in late]
    where = f"where the estimate of {pair.key} is one of h alone"
    if max(apart, also) <= _KEPT:
        said = [(atols[0] / atols[1]) ** (1 / p) for p in (power, power - 1)]  # the second one per unit of time
        close = any(1 / _KEPT < long / short / x < _KEPT for x in said)
        return f"{where}, steps settle {long / short:.3g} times as long at {2**power} times the tolerance" * close, ""
    if min(apart, also) > _APART and all(n > _OFTEN * len(x) for n, x in zip(rejected, late, strict=True)):
        seen = f"{rejected[1]} of {len(late[1])} attempts are rejected, as with too large an exponent"
        return "", f"{where}, step sizes change by a factor of {also:.3g} and {seen}"
    return "", ""


def _in_t(subject: ForeignSolver, slope: Slope, atol: float) -> Solution:
    return subject.solve(lambda n, t, y: [float(slope(t))], (0.0, 2.0), (0.0,), RTOL, atol)


def _chebyshev(degree: int) -> Slope:
    return Chebyshev.basis(degree, domain=(0.0, 2.0))


def _tolerances(pair: RungeKutta) -> list[float]:
    """The tolerances that the estimate reaches in so many steps of the length 2, on slopes of its degree p - 1 = n.

    Of T_n(t) = 2^(n - 1) t^n + ... it is 2^(n - 1) h^(n + 1) times the sum of e_i c_i^n.
    """
    n = power_of_estimate(pair) - 1
    moment = abs(fsum(float(e) * float(c) ** n for e, c in zip(row_of(pair), pair.c, strict=True)))
    return [moment * (2 / count) ** (n + 1) * 2.0 ** (n - 1) for count in _COUNTS]


def power_of_estimate(pair: RungeKutta) -> int:
    """The power of h in the error estimate of a pair."""
    return min(pair.claimed_order, pair.embedded_order or 0) + 1


def row_of(pair: RungeKutta) -> list[Exact]:
    """The weights of the slopes in the error estimate of a pair."""
    assert pair.b_embedded is not None
    return [*map(sub, pair.b, pair.b_embedded)]
