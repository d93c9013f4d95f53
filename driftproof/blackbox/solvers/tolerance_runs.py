"""Runs of a solver on problems whose solutions are known: what tolerances change, and what errors are compared with."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from math import exp, hypot, inf, log, log2, sin
from typing import Any, NamedTuple

import numpy as np
from flint import arb

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem, walls
from driftproof.blackbox.solvers.foreign_solver import (
    NOTHING,
    TOLERANCES,
    DoesNotEnd,
    ForeignSolver,
    RunSlopes,
    Solution,
    TooSlow,
)

# The start, the end and the length all have many bits.
SPAN = (0.1, 0.1 + 1.7)
RTOL, ATOL = 1e-6, 1e-9
_TOLERANCES, _TINIEST = (1e-3, 1e-4, 1e-5, 1e-6), 1e-12
# So many of these tolerances show an effect; solvers of low order take too many calls at the last one.
_FEWEST = 3
_SIZE = 2.0**20  # a power of two: numbers so many times as large are rounded alike
# The size to which a solution grows: its errors are compared at this tolerance with numbers of that size, or of 1.
_GROWN, _OF_GROWN = 2.0**16, 1e-4
# A slope by which y = 1 changes by 2^-8, the tolerance of one kind, and the share of it that the other one is.
_SLOW, _STEADY, _NEGLIGIBLE = 2.0**-4, 1e-6, 1e-4
# In each of these pairs of rtol and atol only the tolerance named is large enough to matter.
_ONE_AT_A_TIME = {"rtol": ((1e-3, 1e-12), (1e-6, 1e-12)), "atol": ((1e-12, 1e-3), (1e-12, 1e-6))}
# Errors follow at least the square root of a tolerance (by 30 here). They fall by less where it is without effect, and
# are far below those of two large tolerances, unless it is a largest step size that makes the errors.
_EFFECT, _BELOW = 10.0, 100.0
_OSCILLATOR = NonlinearProblem("q'' = -q", lambda t, y: [y[1], -y[0]], lambda t: [t.cos(), -t.sin()])
_KNOWN = (("q'' = -q to t = 6", _OSCILLATOR, (0.0, 6.0)), ("q'' = exp(-2 q) to t = 3", walls(1), (-2.0, 3.0)))
# Errors of 10^4 steps, each as large as the tolerance, may add up; ten times that is a fault.
_FAR = 1e5
# A clock of 24 bits costs up to this in some thousand steps (2^12 u), which is no error of the method.
GROSS = 2.0**-12
# Rounding in estimates of high order moves steps by 1e-8; an error that counts less moves them by part of a step.
SAME_TIME = 1e-6


class RunLines(NamedTuple):
    """What was seen and the faults, in lines; `beside` are faults that are none of the method's steps.

    `orders` are those observed with more and more steps, `implicit` says that it solves for its steps. `final` is True
    if further runs would show nothing else.
    """

    lines: Sequence[str] = ()
    faults: Sequence[str] = ()
    beside: Sequence[str] = ()
    orders: Sequence[float] = ()
    implicit: str = ""
    final: bool = False


def tolerance_effect(subject: ForeignSolver) -> RunLines:
    """Measure the effect of tolerances, and what errors are compared with, also where it takes too many calls."""
    grown = [*_of_growth(subject), *_of_changes(subject)] if subject.adaptive else []
    try:
        known = _on_known_problems(subject)
    except TooSlow as slow:
        if not grown:
            raise
        return RunLines([f"not seen: {slow}"], grown)
    return known if known.faults else known._replace(faults=grown)


def _on_known_problems(subject: ForeignSolver) -> RunLines:
    """Measure the effect of smaller tolerances or steps on two problems whose solutions are enclosed in balls."""
    lines, orders = list[str](), list[float]()
    for words, problem, span in _KNOWN:
        seen = (_requested if subject.adaptive else _shortened)(subject, problem, span)
        lines += [f"{words}: {line}" for line in seen.lines]
        orders += seen.orders
        if seen.faults:
            return RunLines(lines, [*seen.faults, *([] if seen.final else _ignored(subject))])
    faults = [*_ignored(subject), *(_of_another_scale(subject) if subject.takes == TOLERANCES else [])]
    return RunLines(lines, faults, orders=orders)


def _requested(subject: ForeignSolver, problem: NonlinearProblem, span: tuple[float, float]) -> RunLines:
    """For each rtol, the error at the end and its multiple of rtol; then the power of rtol that the errors follow."""
    runs = list[Solution]()
    try:
        runs += (_solved(subject, problem, span, rtol=rtol, atol=rtol * 1e-3) for rtol in _TOLERANCES)
    except TooSlow:
        if len(runs) < _FEWEST:
            raise
    least = _TOLERANCES[len(runs) - 1]
    if failed := next((run for run in runs if run.complaint), None):
        return RunLines([f"it ends at t = {failed.t[-1]:.6g} and reports: {failed.complaint}"])
    if early := next((run for run in runs if _ends_early(run, span)), None):
        fault = f"on {problem.words} it ends at t = {early.t[-1]:.6g} of {span}, without saying so"
        return RunLines(faults=[fault], final=True)
    errors = [_error(run, problem) for run in runs]
    lines = [
        f"at rtol = {rtol:g}: error {error:.2g}, {error / rtol:.2g} times rtol, {len(run.calls)} calls"
        for rtol, error, run in zip(_TOLERANCES, errors, runs, strict=False)
    ]
    hidden = f"a largest step size hides these tolerances: at rtol = {_TINIEST:g} steps are others"
    if len({run.t for run in runs}) == 1:
        if _is_deaf(subject, problem, span, runs[0]):
            return RunLines(lines, ["rtol is ignored: the steps are the same at every tolerance"], final=True)
        return RunLines([*lines, hidden])
    # Rounding of a few hundred steps, or a largest step size, may hide the effect of the last tolerance.
    floor = max(float(run.format.u) for run in runs) * 2.0**10
    if max(errors[-1], floor) > max(errors[0] / 10, least) and errors[0] > 10 * floor:
        tiniest = _solved(subject, problem, span, rtol=_TINIEST, atol=_TINIEST) if errors[0] < _TOLERANCES[0] else None
        if tiniest and not tiniest.complaint and 10 * _error(tiniest, problem) < errors[-1]:
            return RunLines([*lines, hidden])
        smaller = f"{_TOLERANCES[0] / least:.0f} times smaller"
        return RunLines(lines, [f"a tolerance {smaller} does not make the error 10 times smaller"])
    clear = [(rtol, error) for rtol, error in zip(_TOLERANCES, errors, strict=False) if error > floor]
    if len(clear) > 1:
        (first, most), (last, smallest) = clear[0], clear[-1]
        lines.append(f"errors fall like rtol^{log(most / smallest) / log(first / last):.2f}")
    far = [error / rtol for rtol, error in clear if error / rtol > _FAR]
    faults = [f"errors are {max(far):.2g} times the tolerance: rtol does not indicate the error"] if far else []
    return RunLines(lines, faults)


def _ends_early(run: Solution, span: tuple[float, float]) -> bool:
    """True if it ends by more than a step before the end, where it has no error yet."""
    last = run.t[-1] - run.t[-2] if len(run.t) > 1 else 0.0
    return span[1] - run.t[-1] > last + GROSS


def _shortened(subject: ForeignSolver, problem: NonlinearProblem, span: tuple[float, float]) -> RunLines:
    """The errors with more and more equal steps, if the solver takes their size or number."""
    lines, orders, before = list[str](), list[float](), 0.0
    for steps in (64, 128, 256) if subject.takes != NOTHING else (64,):
        run = _solved(subject, problem, span, steps=steps)
        error = _error(run, problem)
        order = [log2(before / error)] if before > error > 0 else []
        lines.append(f"with {len(run.t) - 1} steps: error {error:.2g}{''.join(f', order {x:.2f}' for x in order)}")
        orders, before = orders + order, error
    return RunLines(lines, orders=orders)


def _ignored(subject: ForeignSolver) -> list[str]:
    """The tolerances that are ignored: one of them is changed while the other is too small to matter.

    One that only sets the first step size is ignored as well: the other one governs the error.
    """
    if subject.takes != TOLERANCES:
        return []
    _, problem, span = _KNOWN[0]
    found = []
    for name, pairs in _ONE_AT_A_TIME.items():
        runs = [_solved(subject, problem, span, rtol=rtol, atol=atol) for rtol, atol in (*pairs, (1e-3, 1e-3))]
        if any(run.complaint for run in runs):  # a refusal shows no steps
            continue
        large, small, both_large = (_error(run, problem) for run in runs)
        if runs[0].t == runs[1].t:
            deaf = _is_deaf(subject, problem, span, runs[0])
            found += [f"{name} is ignored: the steps are the same whatever it is"] * deaf
        elif large < _EFFECT * small and _BELOW * large < both_large:
            found.append(f"{name} is ignored: the error is {large:.2g} at {name} = 0.001 and {small:.2g} at 1e-06")
    return found


def _is_deaf(subject: ForeignSolver, problem: NonlinearProblem, span: tuple[float, float], run: Solution) -> bool:
    """True if the steps are those of the run also at tolerances that no largest step size hides."""
    with suppress(DoesNotEnd, TooSlow):
        return _solved(subject, problem, span, rtol=_TINIEST, atol=_TINIEST).t == run.t
    return False


def _of_another_scale(subject: ForeignSolver) -> list[str]:
    """The fault of other steps where y and atol are 2^20 times as large; they are the same for atol + rtol |y|.

    If they are the same, to rounding, where rtol is given as atol and atol as rtol, the two are exchanged, unless atol
    changes nothing: then rtol is absolute.
    """

    def times(size: float, rtol: float, atol: float) -> tuple[float, ...]:
        run = subject.solve(lambda n, t, y: [y[1], -y[0]], _KNOWN[0][2], (size, 0.0), rtol, atol)
        return () if run.complaint else run.t

    small, large = (len(times(x, RTOL, x * ATOL)[1:]) for x in (1.0, _SIZE))
    if not 4 * abs(large - small) > small > 0:
        return []
    one, other = times(1.0, ATOL, RTOL), times(_SIZE, _SIZE * ATOL, RTOL)
    exchanged = len(one) == len(other) and np.allclose(one, other, rtol=0, atol=SAME_TIME)
    how = "errors are not compared with atol + rtol |y| alone"
    if exchanged:
        absolute = one == times(1.0, ATOL, ATOL)
        how = "rtol is taken as an absolute tolerance" if absolute else "rtol and atol are exchanged"
    return [f"{how}: with y and atol 2^20 times as large it takes {large} steps instead of {small}"]


def _of_growth(subject: ForeignSolver) -> list[str]:
    """The fault of far more steps where y grows from 1 to 2^16 than where it begins there, by the same slopes.

    These are constant up to the middle of the run, and vary from there on, so that no step is short before. About as
    many steps follow if errors are compared with y as it is, and not with y at the start.
    """
    middle = sum(SPAN) / 2

    def late(start: float) -> int:
        pace: RunSlopes = lambda n, t, y: [_GROWN * (1 + sin(30 * t) / (2 + exp(40 * (middle - t))))]
        run = subject.solve(pace, SPAN, (start,), _OF_GROWN, _OF_GROWN / 1e3)
        return sum(t > middle for t in run.t)

    grown: float = inf
    with suppress(Misbehaviour, TooSlow):
        begun = late(_GROWN)
        with suppress(DoesNotEnd, TooSlow):
            grown = late(1.0)
        if grown > 2 * begun:
            seen = f"of y from 1 to 2^16 its second half takes {grown} steps, from 2^16 on {begun}"
            return [f"errors are not compared with atol + rtol |y| alone, as if y were that at the start: {seen}"]
    return []


def _of_changes(subject: ForeignSolver) -> list[str]:
    """The fault of far more steps at rtol = tol than at atol = tol where |y| stays near 1, which both scales are then.

    A scale of what y changes in a step, in place of y, is far smaller.
    """
    if subject.takes != TOLERANCES:
        return []
    counts = list[float]()
    for settings in ((_STEADY, _STEADY * _NEGLIGIBLE), (_STEADY * _NEGLIGIBLE, _STEADY)):
        counts.append(inf)
        with suppress(DoesNotEnd, TooSlow):
            run = subject.solve(lambda n, t, y: [_SLOW * sin(30 * t)], SPAN, (1.0,), *settings)
            if run.complaint:  # a refusal shows no steps
                return []
            counts[-1] = len(run.t)
    if counts[0] > 2 * counts[1]:
        seen = (
            f"where y stays near 1 it takes {counts[0]} steps at rtol = {_STEADY:g}, {counts[1]} at atol = {_STEADY:g}"
        )
        return [f"errors are not compared with atol + rtol |y| alone: {seen}"]
    return []


def _solved(subject: ForeignSolver, problem: NonlinearProblem, span: tuple[float, float], **settings: Any) -> Solution:
    rate: RunSlopes = lambda n, t, y: [float(x) for x in problem.rate(t, list(y))]
    return subject.solve(rate, span, problem.start(span[0]), **settings)


def _error(run: Solution, problem: NonlinearProblem) -> float:
    """The distance of the last state from the solution, whose enclosure is far narrower than the digits shown."""
    true = problem.solution(arb(run.t[-1]))
    return hypot(*(float((arb(x) - y).mid()) for x, y in zip(run.y[-1], true, strict=True)))
