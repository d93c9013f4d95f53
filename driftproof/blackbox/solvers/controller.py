"""The law of a solver's step sizes, measured on slopes that depend on t alone, for which every estimate is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import chain, pairwise, product
from math import fsum, log
from typing import NamedTuple, TypeAlias

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.solvers.attempts import (
    ATOLS,
    LOOSE,
    NEAR,
    RTOL,
    Attempt,
    Slope,
    attempts_of,
    of_another_estimate,
    power_of_estimate,
    row_of,
    settled_steps,
)
from driftproof.blackbox.solvers.foreign_solver import MOST_CALLS_OF_A_RUN, ForeignSolver, Solution, TooSlow
from driftproof.blackbox.solvers.marked_steps import StageRate, stage_slopes
from driftproof.blackbox.solvers.step_size_law import FORGOTTEN, Law, LawPoint, exceptions, fitted_law, is_close, shown
from driftproof.blackbox.solvers.steps import SolverSteps
from driftproof.methods.catalogue import EMBEDDED_SUFFIX, METHODS
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import RungeKutta

# The error estimate of a step of size h from the slopes k of its stages.
_OfSlopes: TypeAlias = Callable[[Sequence[float], float], float]
# The span of the run: bumps and jumps at every unit of time make some hundred steps, some of them rejected.
# The shorter span is for estimates with a wrong stage, O(h^2), which take some thousand steps.
_SPAN, _SHORTER, _WIDTH = (0.0, 8.0), (0.0, 3.0), 12.0
# An estimate may be the difference of two states below 1, of which each rounds by u and each sum before it by less.
_ROUNDED = 2.0**-51
# The least factor after a step that is just accepted, which is the safety: 0.8 to 1 in most codes; chosen with room.
_LEAST_SAFETY = 0.5
# Other scales in use, such as (1 + |y|) tol, limits of their own and halved estimates make a few times the tolerance.
_MOST_ACCEPTED = 10.0
# A factor of the estimate is told if it is known as well as this: the errors about the tolerance lie closely enough.
_MOST_BETWEEN = 1.5
# By what the difference of one step and two halves may be divided for 2^4 - 1: 1, 2^4, 2^5 - 1, 2^5; a safety that
# the code then has is of two digits.
_DIVISORS = (1, 16, 31, 32)
# Two tolerances; a step size follows them as if the order of the estimate were less by more than this only if it is.
_TWO, _LESS = (1e-5, 1e-7), 1.5
# Settling at half the pace of the right exponent or more: of an error no more than its root is left in the next step.
_MOST_LEFT = 0.5
# As many factors have codes that halve and double their steps; chosen with room.
_FEW = 5
_NO_TOLERANCE = "it takes no tolerance: its step size is constant"
# In units of u: t is up to 8, slopes change by up to 13 in a unit of time, and h times the sum of the absolute weights
# is below 4, so that rounding makes 416. A step that ends elsewhere is off by far more.
_TRACE = 2.0**9


@dataclass(frozen=True)
class ControllerReading:
    """The step size control as measured: its law, if one was found, the evidence as lines, and the faults.

    The `remarks` are on an exponent that settles all the same, and on a solver that advances the other row of the pair
    whose estimate is in the law. `unseen` says why it is not known whether the step sizes follow the estimate of the
    pair that it advances; "" if they do.
    """

    law: Law | None
    lines: tuple[str, ...]
    faults: tuple[str, ...]
    remarks: tuple[str, ...] = ()
    unseen: str = ""


def bumps(t: float, between: float = 0.5) -> float:
    """A slope with a bump in the middle of every unit of time, flat between, whose sign jumps at every whole time."""
    unit = int(t)
    return (-1.0) ** unit * (between + 1.0 / (1.0 + (_WIDTH * (t - unit - 0.5)) ** 4))


def read_controller(subject: ForeignSolver, steps: SolverSteps, held: RungeKutta | None = None) -> ControllerReading:
    """Read the law of the step sizes, by the estimate of a pair, from a run of y' = bumps(t). Raises NotReadable.

    The slopes depend on t alone: the estimate of each attempt, and with it r, follows from the two rows of the pair,
    and the factors are observed. Rejected attempts show in the times of the calls. The pair is one of the catalogue, or
    that to which the solver is `held`: then the estimate has to be that of the pair that it advances.
    """
    steps = steps if held is None else steps.held_to(held)
    run, atol, slope = _run(subject)
    attempts = list(attempts_of(run, steps))
    traces = _traces(run, steps, attempts, slope)
    factors = [each.factor for each in attempts if each.factor is not None]
    if silent := [pair.key for pair in steps.pairs if _is_silent(pair)]:
        raise NotReadable(f"the estimate of {silent[0]} is 0 wherever slopes depend on t alone: no law can be observed")
    if len(factors) > 1 and is_close(max(factors), min(factors)):
        return _of_one_factor(factors[0], subject.adaptive, traces)
    if len(factors) < 8:
        raise NotReadable(f"{len(factors)} step sizes are too few to determine a law")
    estimates = list(_estimates(steps.pairs or [pair for pair in steps.other_pairs if not _is_silent(pair)]))
    law, rtol = _law(estimates, run, attempts, atol, slope), RTOL
    if law is None and (of_rtol := _of_rtol_alone(subject, run, atol, slope)):
        attempts, rtol = list(attempts_of(of_rtol, steps)), atol
        law = _law(estimates, of_rtol, attempts, atol, slope)
    if law is None:
        return _without_law(subject, steps, attempts, traces, held)
    if traces:  # with slopes of other times, errors differ as well
        law = replace(law, exception="", accepted=1.0)
    after = ["a step after a rejected one does not grow"] if law.after_rejection else []
    of_what = f"r is the estimate of {law.estimate} over the tolerance"
    lines = (f"measured: {law.words}", of_what, *after, _counted(attempts))
    used = next(each for each in estimates if each.name == law.estimate)
    others = chain(_accepted_beyond(law), _elsewhere(subject, steps, law, used, rtol, atol, slope))
    wrong, another = _another_exponent(law, used.order)
    remarks = tuple(filter(None, (another, _scaled(law), _other_row(used.pair.key, steps))))
    return ControllerReading(law, lines, (*filter(None, [wrong]), *(traces or others)), remarks)


def _law(
    estimates: Sequence[_Estimate], run: Solution, attempts: Sequence[Attempt], atol: float, slope: Slope
) -> Law | None:
    """The law of the step sizes in one of these estimates, the simplest if there are several; None if there is none."""
    points = partial(_points, lambda t, y: [slope(t)], run, attempts, atol)
    laws = filter(None, (fitted_law(each.name, list(points(each))) for each in estimates))
    return min(laws, key=lambda law: (bool(law.exception), bool(law.memory or law.filtered)), default=None)


def _of_rtol_alone(subject: ForeignSolver, run: Solution, atol: float, slope: Slope) -> Solution | None:
    """The run with rtol as large as atol, if its steps are the same whatever atol is: rtol may be absolute."""
    solved = partial(subject.solve, lambda n, t, y: [slope(t)], _SPAN, (0.0,))
    with suppress(Misbehaviour, TooSlow):
        if solved(RTOL, 2 * atol).t == run.t:
            return solved(atol, atol)
    return None


def _of_one_factor(factor: float, adaptive: bool, traces: tuple[str, ...]) -> ControllerReading:
    """The reading of a solver whose steps grow by one factor: a fault, but for equal ones without a tolerance."""
    if is_close(factor, 1.0) and not adaptive:
        return ControllerReading(None, (_NO_TOLERANCE,), traces)
    grown = f"the step size does not depend on the error: every step is {factor:.6g} times the previous one"
    fault = "all steps have the same size, whatever the error" if is_close(factor, 1.0) else grown
    return ControllerReading(None, (fault,), (fault, *traces))


def _counted(attempts: Sequence[Attempt]) -> str:
    """How many steps were attempted and rejected, in words."""
    most = max(each.rejections for each in attempts)
    rejected = sum(not each.accepted for each in attempts)
    in_a_row = f", up to {most} in a row" * (most > 1)
    return f"{len(attempts)} attempted steps observed, {rejected} rejected{in_a_row}"


def _without_law(
    subject: ForeignSolver,
    steps: SolverSteps,
    attempts: Sequence[Attempt],
    traces: tuple[str, ...],
    held: RungeKutta | None,
) -> ControllerReading:
    """What is seen of step sizes that no law gives: whether they settle, and another estimate that they follow."""
    pairs = ", ".join(pair.key for pair in steps.pairs) or "any pair of the catalogue"
    seen = f"no law in the estimate of {pairs} gives the step sizes"
    few = sorted({f"{each.factor:.4g}" for each in attempts if each.factor is not None}, key=float)
    if 1 < len(few) <= _FEW:
        seen += f"; each step is {', '.join(few[:-1])} or {few[-1]} times as long as the one before"
    another = settled = unsettled = ""
    if pair := min(steps.pairs, key=power_of_estimate, default=None):
        another = of_another_estimate(subject, pair)
        settled, unsettled = ("", "") if another else settled_steps(subject, steps, pair)
    lines = tuple(filter(None, [seen, settled, another * (held is None)]))
    faults = tuple(filter(None, [another * (held is not None), unsettled * (len(few) > _FEW)]))
    hint = "nor do they settle where that depends on h alone; verify one step that returns its estimate"
    unseen = f"{seen}, {hint}" if held and steps.pairs and not settled else ""
    faults = traces or faults or tuple(_of_low_order(subject, steps))
    return ControllerReading(None, (*lines, _counted(attempts)), faults, unseen=unseen)


def _other_row(key: str, steps: SolverSteps) -> str:
    """Say that the row is advanced that the catalogue does not propagate in the pair whose estimate is in a law."""
    if steps.pairs and not key.endswith(EMBEDDED_SUFFIX):
        return ""
    pair, other = (METHODS[key.removesuffix(EMBEDDED_SUFFIX) + row] for row in ("", EMBEDDED_SUFFIX))
    row = "lower-order" if other.claimed_order < pair.claimed_order else "other"
    return f"controlled by the estimate of {pair.key}, but advances its {row} row, of order {other.claimed_order}"


def _accepted_beyond(law: Law) -> Iterator[str]:
    """Say that a step was accepted far beyond the tolerance, or where the controller's own law asks for far less."""
    factor = law.safety * law.accepted ** -float(law.exponent)
    if law.accepted > _MOST_ACCEPTED or (law.accepted > 1 and factor < _LEAST_SAFETY):
        asked = f"after which its law gives {factor:.2g} h"
        yield f"steps are accepted with {law.accepted:.3g} times the tolerance, {asked}"


def _scaled(law: Law) -> str:
    """Say that steps are accepted up to another error than the tolerance, as with a factor in the estimate.

    All accepted steps have smaller errors than all rejected ones, which tells the factor from an exception.
    """
    least, most = 1 / law.rejected, 1 / law.accepted
    if not least < most or least <= 1 <= most or most > _MOST_BETWEEN * least:
        return ""
    seen = f"steps are accepted up to {law.accepted:.3g} times the tolerance and rejected from {law.rejected:.3g} on"
    power = float(law.exponent - law.memory)
    safeties = {n: law.safety * (15 / n) ** power for n in _DIVISORS if least < 15 / n < most}
    doubled = [n for n, x in safeties.items() if law.estimate.startswith("rk4_doubling54") and is_close(x, round(x, 2))]
    of_doubling = f", as with y2 - y1 divided by {doubled[0]} in place of 15" if doubled else ""
    return f"{seen}, as if its estimate were {least:.3g} to {most:.3g} times that of {law.estimate}{of_doubling}"


def _elsewhere(
    subject: ForeignSolver, steps: SolverSteps, law: Law, estimate: _Estimate, rtol: float, atol: float, slope: Slope
) -> Iterator[str]:
    """Say that most step sizes do not follow the law where slopes depend on y, as if a stage had another state."""
    rate: StageRate = lambda t, y: [slope(t) * (1 + y[0] * y[0])]
    run = subject.solve(lambda n, t, y: rate(t, [*y]), _SHORTER, (0.0,), rtol, atol)
    points = list(_points(rate, run, list(attempts_of(run, steps)), atol, estimate))
    words = "on y' = b(t) (1 + y^2) most step sizes do not follow this law"
    if (factors := [p.factor for p in points]) and exceptions(points, law, min(factors), max(factors)) is None:
        yield f"{words}, as if a stage of {law.estimate} had another state in the estimate"


def _of_low_order(subject: ForeignSolver, steps: SolverSteps) -> Iterator[str]:
    """Say that a smaller tolerance takes far more calls than the order of the estimate needs, per unit of time or not.

    The step size follows the tolerance to the power 1/p of an estimate O(h^p).
    """
    power = min((power_of_estimate(pair) - 1 for pair in steps.pairs), default=0)
    calls = list[int]()
    for tol in _TWO if power > _LESS else ():
        try:
            calls.append(len(subject.solve(lambda n, t, y: [y[1], -y[0]], _SPAN, (1.0, 0.0), tol, tol).calls))
        except TooSlow:
            calls.append(MOST_CALLS_OF_A_RUN)
        except Misbehaviour:
            return
    if calls and calls[1] > calls[0] * (_TWO[0] / _TWO[1]) ** (1 / (power - _LESS)):
        seen = f"on q'' = -q it makes {calls[0]} calls of f at a tolerance of {_TWO[0]:g}, {calls[1]} at {_TWO[1]:g}"
        yield f"{seen}: far more than an estimate O(h^{power}) needs, as if one of its coefficients were another"


def _another_exponent(law: Law, power: int) -> tuple[str, str]:
    """The fault, or else the remark, that the exponent b of a law without memory is not 1/p, for an estimate r ~ h^p.

    Where errors change little, one of r is followed by safety^p r^(1 - p b): 1/p leaves nothing of r.
    """
    if not power or law.memory or law.filtered or is_close(float(law.exponent), 1 / power):
        return "", ""
    left = 1 - power * law.exponent
    where = " after accepted steps" * law.exception.startswith("; after a rejection")
    seen = f"the exponent of the step size control{where} is {shown(law.exponent)}"
    leaves = (
        f"{seen}, for an estimate O(h^{power}) it is 1/{power}: an error r leaves r^({shown(left)}) in the next step"
    )
    if abs(left) >= 1:
        return f"{leaves}, and never settles", ""
    if left > _MOST_LEFT:
        return f"{leaves}, and settles very slowly", ""
    if left > 0:
        return "", f"{leaves}, and settles more slowly"
    # The least r whose step no limit cuts is followed by the largest error, (safety largest^(p b - 1))^(1/b).
    if law.largest and law.safety * law.largest ** -float(left) <= 1:
        return "", f"{leaves}, which its largest factor keeps below the tolerance"
    return f"{leaves}, so that a step after a small error is rejected", ""


def _run(subject: ForeignSolver) -> tuple[Solution, float, Slope]:
    """The run, its absolute tolerance, the larger one if need be, and its slope, without jumps if they stop the solver.

    As they stop one whose estimate is per unit of time: it stays large at a jump. Raises the last Misbehaviour.
    """

    def solved(slope: Slope, atol: float) -> tuple[Solution, float, Slope]:
        return subject.solve(lambda n, t, y: [slope(t)], _SPAN, (0.0,), RTOL, atol), atol, slope

    without_jumps: Slope = partial(bumps, between=-1.0 / (1.0 + (_WIDTH / 2) ** 4))
    for each in product([bumps, without_jumps], ATOLS):
        with suppress(Misbehaviour, TooSlow):
            return solved(*each)
    return solved(without_jumps, LOOSE)


class _Estimate(NamedTuple):
    """An error estimate by the stages of a pair, O(h^order); a blend has no order of its own, which is 0."""

    name: str
    pair: RungeKutta
    of: _OfSlopes
    order: int = 0


def _estimates(pairs: Sequence[RungeKutta]) -> Iterator[_Estimate]:
    """The error estimates of these pairs; DOP853 programs blend those of two."""
    rows = {pair.key: [*map(float, row_of(pair))] for pair in pairs}
    for pair in pairs:
        weighed, order = partial(_weighed, rows[pair.key]), power_of_estimate(pair)
        yield _Estimate(pair.key, pair, weighed, order)
        per_unit: _OfSlopes = lambda k, h, weighed=weighed: weighed(k, 1.0)  # type: ignore[misc]
        yield _Estimate(f"{pair.key} per unit of time", pair, per_unit, order - 1)  # divided by h (burden-faires, 5.5)
    if {"dop853", "dop853_third"} <= set(rows):
        fifth, third = rows["dop853"], rows["dop853_third"]

        def blended(k: Sequence[float], h: float) -> float:
            a, b = (fsum(e * x for e, x in zip(row, k, strict=False)) for row in (fifth, third))
            return h * a * a / (a * a + 0.01 * b * b) ** 0.5 if a or b else 0.0

        yield _Estimate("dop853 blended with dop853_third", next(p for p in pairs if p.key == "dop853"), blended)


def _weighed(row: Sequence[float], slopes: Sequence[float], h: float) -> float:
    return h * abs(fsum(e * k for e, k in zip(row, slopes, strict=False)))


def _is_silent(pair: RungeKutta) -> bool:
    """True if the weights of the estimate cancel at every node, as in Fehlberg's pair 7(8)."""
    by_node: dict[Exact, Exact] = {}
    for c, e in zip(pair.c, row_of(pair), strict=True):
        by_node[c] = by_node.get(c, Fraction(0)) + e
    return not any(by_node.values())


def _points(
    rate: StageRate, run: Solution, attempts: Sequence[Attempt], atol: float, estimate: _Estimate
) -> Iterator[LawPoint]:
    """The attempts whose error is known and not 0, and whose factor is known, by the stages of the pair."""
    pair, states = estimate.pair, dict(zip(run.t, run.y, strict=True))
    a, c = [[*map(float, row)] for row in pair.a], [*map(float, pair.c)]
    before, length = log(FORGOTTEN), attempts[0].h  # the first error remembered is the code's own
    longest = max(each.h for each in attempts)
    for each in attempts:
        times = [each.start + x * each.h for x in c]
        r = estimate.of([k for (k,) in stage_slopes(a, c, rate, each.start, each.h, states[each.start])], each.h) / atol
        if each.factor is not None and r > 0:
            at_jump = any(abs(t - round(t)) <= NEAR for t in times)
            growth, later = log(each.h / length), each.factor * each.h
            later *= is_close(later, longest)
            rounded = _ROUNDED / (r * atol)
            yield LawPoint(log(r), rounded, before, growth, each.factor, each.accepted, each.rejections, at_jump, later)
        if each.accepted and r > 0:
            before, length = log(r), each.h


def _traces(run: Solution, steps: SolverSteps, attempts: Sequence[Attempt], slope: Slope) -> tuple[str, ...]:
    """The faults of steps that do not end where their weights and the slopes at their own times say."""
    allowed = _TRACE * float(steps.reading.format.u)
    reading, tried = steps.reading, {each.start: each.h for each in attempts if not each.accepted}
    wrong_after = wrong_else = seen_after = stale = 0
    for (start, end), ((y,), (y1,)) in zip(pairwise(run.t), pairwise(run.y), strict=True):
        if int(start - NEAR) != int(end + NEAR):  # across a jump, or up to it, where rounding of a time matters
            continue
        h = end - start
        slopes = [slope(start + c * h) for c in reading.c or ()]
        off = y1 - y - h * fsum(b * k for b, k in zip(reading.b, slopes, strict=True))
        seen_after += start in tried
        if abs(off) <= allowed:
            continue
        wrong_after, wrong_else = wrong_after + (start in tried), wrong_else + (start not in tried)
        if start in tried:
            old = slope(start + tried[start])
            stale += abs(off - h * reading.b[0] * (old - slopes[0])) <= allowed
    if wrong_after and not wrong_else:
        cause = ": its first slope is the last one of the rejected attempt" if stale == wrong_after else ""
        return (f"a rejected step affects the next: {wrong_after} of {seen_after} steps after one are wrong{cause}",)
    if wrong_else:
        count = f"{wrong_else} of {len(run.t) - 1} steps"
        return (f"{count} are not steps of this method: they do not end where its weights give",)
    return ()
