"""Runs of a solver with known solutions: constant slopes, its clock, backward, NaN, a jump, stiffness."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import cos, e, isclose, isfinite, nan, sin
from typing import Any

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, NoAnswer
from driftproof.blackbox.solvers.foreign_solver import (
    LENGTH,
    TOLERANCES,
    USUAL,
    DoesNotEnd,
    ForeignSolver,
    RunSlopes,
    Solution,
    TooSlow,
    in_binary32,
)
from driftproof.blackbox.solvers.tolerance_runs import ATOL, GROSS, RTOL, SAME_TIME, SPAN, RunLines, tolerance_effect

# A jump costs about its height times a step, which the estimate should bound by the tolerance: chosen with room.
_OF_A_JUMP = 1e3
# The rate of a decay: an explicit method of s stages is stable up to h = 2 s^2/1000 at most, of seven below 100/1000.
_STIFF, _EXPLICIT = 1000.0, 100.0
# Solutions have size 1: every stable method follows them to a tenth, an unstable one is off by far more.
_FOLLOWED = 0.1
# Differences for a Jacobian are a few times the square root of u long, or less.
_NEARBY = 2.0**-23
# A last step that is a smaller part of the run than this is one too many.
_TINY = 1e-9
# An unstable control makes other steps of roundings, but hardly more or fewer: by this part of them at most.
_UNSTABLE = 1 / 100
# Step sizes that do not divide their span, once rounded down and once up; and one of which 3, rounded, are less than
# the span, so that programs that count steps by int(), or add h until the end, lose one or gain one.
_NOT_DIVIDED = ((SPAN, 1.7 / 5.4), (SPAN, 1.7 / 5.6), ((0.0, 0.3), 0.1))
# One more number than the widest unrolled loops have.
_NUMBERS = 5


@dataclass(frozen=True)
class RunsReading:
    """What was seen in these runs, by subject; all of it is measured on the runs named.

    The `remarks` name the subjects of which nothing was seen, as of runs that would take too many calls.
    """

    answers: dict[str, RunLines]
    remarks: tuple[str, ...] = ()

    @property
    def seen(self) -> dict[str, tuple[str, ...]]:
        """The lines by subject."""
        return {title: (*answer.lines,) for title, answer in self.answers.items()}

    @property
    def faults(self) -> tuple[str, ...]:
        """The faults, also those that are none of the method's steps."""
        return tuple(fault for each in self.answers.values() for fault in (*each.faults, *each.beside))

    @property
    def beside(self) -> list[str]:
        """The faults that are none of the method's steps."""
        return [line for each in self.answers.values() for line in each.beside]


def read_runs(subject: ForeignSolver) -> RunsReading:
    """Make the runs one after the other; a run that fails is reported and does not stop the others."""
    found, remarks = dict[str, RunLines](), list[str]()
    for title, question in _QUESTIONS.items():
        try:
            found[title] = question(subject)
        except NoAnswer as hang:
            found[title] = RunLines([f"not seen: {hang}"])
            remarks.append(f"{title.lower()} not seen: {hang}")
        except Misbehaviour as failure:
            found[title] = RunLines(faults=[f"{title.lower()}: {failure.word}: {failure}"])
        if found[title].final:
            break
    return RunsReading(found, tuple(remarks))


def _constant_slopes(subject: ForeignSolver) -> RunLines:
    """Make runs of u' = 0 and u' = 1, where every method is exact and its error estimate is rounding."""
    lines, faults = [], []
    for slope, start in ((0.0, 1 / 3), (1.0, 0.5)):  # many bits, and one
        name = f"u' = {slope:g}"
        try:
            run = subject.solve(lambda n, t, y, slope=slope: [slope], SPAN, (start,), RTOL, ATOL)  # type: ignore[misc]
        except (Misbehaviour, TooSlow) as failure:
            if isinstance(failure, TooSlow) and not slope:  # as slow on every problem
                raise
            estimate = ", as happens when the weights of an error estimate do not add up to 0" if slope else ""
            faults.append(f"it cannot integrate {name}: {failure}{estimate}")
            continue
        (begun,), (last,) = run.y[0], run.y[-1]
        if run.t[0] == SPAN[0] and not isclose(begun, start, rel_tol=float(run.format.u)):
            faults.append(f"it begins at u = {begun!r} instead of {start!r}")
        end = start + slope * (run.t[-1] - SPAN[0])
        if not isclose(last, end, abs_tol=GROSS * (1 + abs(end))):
            faults.append(f"{name} ends at u = {last:.9g} instead of {end:.9g}")
        lines.append(f"{name}: {len(run.t) - 1} steps, {len(run.calls)} calls, off by {abs(last - end):.2g}")
    return RunLines(lines, faults, final=len(lines) < 2)  # where one is not integrated, no other run shows more


def _clock(subject: ForeignSolver) -> RunLines:
    """Check where the last step ends and which time is kept, also with a step size that does not divide the span."""
    run = _of_time(subject, SPAN)
    timed = _timed(run, SPAN, subject.adaptive)
    if subject.takes != LENGTH or timed.faults:
        return timed
    lines, faults, exact = [*timed.lines], list[str](), _is_parabola(run)
    for (start, end), h in _NOT_DIVIDED:
        words = f"with h = {h:g} from {start:g} to {end:g}"
        try:
            run = _of_time(subject, (start, end), (end - start) / h)
        except Misbehaviour as failure:
            lines.append(f"{words} it gives no answer: {failure.word}")
            continue
        wrong = _timed(run, (start, end)).faults
        seen, other = _lengths(run, h, (end - start) / h)
        lines.append(f"{words} it makes {seen}")
        if exact and not wrong and not _is_parabola(run):
            wrong = ["the last step is not of its method: y' = t is solved exactly only if h divides the span"]
        faults = faults or [f"{words}, {fault}" for fault in (wrong or other)]
    return RunLines(lines, faults)


def _of_time(subject: ForeignSolver, span: tuple[float, float], steps: float = USUAL) -> Solution:
    return subject.solve(lambda n, t, y: [1.0, y[0]], span, (0.0, 0.0), RTOL, ATOL, steps)


def _is_parabola(run: Solution) -> bool:
    """True if the run of y' = (1, y[0]) ends where methods of order 2 and above do, to rounding."""
    u, v = run.y[-1]
    return isclose(v, u * u / 2, abs_tol=4 * len(run.calls) * float(run.format.u) * (1 + u * u))


def _lengths(run: Solution, h: float, asked: float) -> tuple[str, list[str]]:
    """The steps in words, and the fault of equal ones that neither are h long nor part the span in as many."""
    in_h = [(b - a) / h for a, b in pairwise(run.t)] or [0.0]
    *most, last = in_h
    same = partial(isclose, rel_tol=SAME_TIME)
    if all(same(x, 1.0) for x in in_h):
        return f"{len(in_h)} steps of h", []
    if all(same(x, 1.0) for x in most):
        return f"{len(most)} steps of h, then one of {last:.4g} h", []
    if not all(same(x, last) for x in most):
        return f"{len(in_h)} steps of {min(most):.4g} h to {max(most):.4g} h, the last one of {last:.4g} h", []
    seen = f"{len(in_h)} equal steps of {last:.4g} h"
    return seen, [f"it makes {seen}"] * (abs(len(in_h) - asked) >= 1)


def _timed(run: Solution, span: tuple[float, float], chosen: bool = False) -> RunLines:
    """Say where the last step ends, whether there is one too many, and in which format time is kept."""
    (start, end), t = span, run.t
    if len(t) < 2:
        return RunLines(faults=["where y' = 1 it makes no step"])
    lines, length = list[str](), end - start
    faults = ["its times do not increase"] * any(b <= a for a, b in pairwise(t))
    off, beyond = t[-1] - end, max(call.t for call in run.calls) - end
    last, steps = t[-1] - t[-2], len(t) - 1
    accumulated = _accumulated(t, span)
    if in_binary32(t):
        faults.append(f"time is kept in binary32: the last step ends at {t[-1]!r}, {off:.3g} from the end{accumulated}")
    elif off == 0:
        lines.append("the last step ends at the end, to the last bit")
    elif isclose(t[-1], end, rel_tol=steps * 2.0**-52):
        lines.append(f"the last step ends {off:.2g} from the end: rounding errors of {steps} steps{accumulated}")
    elif 0.2 * last < abs(off) < (1.0 + _TINY) * last:
        which = "many, or a last one that is not shortened" if off > 0 else "few"
        faults.append(f"one step too {which}: it ends {abs(off):.6g} {'beyond' if off > 0 else 'before'} the end")
    else:
        faults.append(f"the last step ends {off:.6g} from the end")
    many = [f"one step too many: the last one is {last:.2g} long"] * (0 < last < _TINY * length)
    # Where the sum t + (end - t) is rounded, a step size that is chosen makes a step of the rest, at no other cost.
    beside = many if chosen and off == 0 and last <= abs(end) * 2.0**-51 else []
    faults += [] if beside else many
    # y[0] = t - t_start keeps the time that was integrated over, whatever is returned as t.
    drift = max(abs(y[0] - (x - start)) for x, y in zip(t, run.y, strict=True))
    allowed = 4 * len(run.calls) * float(run.format.u) * (abs(start) + length)
    if steps > 1 and drift > allowed and len({*run.y[1:]}) == 1:
        faults.append("where y' = 1 all its states are the last one, as of an array changed in place: append copies")
    elif drift > allowed:
        faults.append(f"the time that it integrates over and the time that it returns differ by {drift:.3g}")
    if beyond > 2.0**-50 * abs(end) and off <= 0:
        lines.append(f"f is called up to {beyond:.3g} beyond the end")
    return RunLines(lines, faults, beside)


def _accumulated(times: Sequence[float], span: tuple[float, float]) -> str:
    """The remark that the times are exactly those of t += h in one of the formats; "" if they are not."""
    count = len(times) - 1
    for number, name in ((np.float64, "binary64"), (np.float32, "binary32")):
        for h in {number((span[1] - span[0]) / count), number(times[1] - times[0]), number(0.01)}:
            t = number(times[0])
            if all(float(t := t + h) == x for x in times[1:]):
                return f"; time is accumulated, t += h in {name}, which gives these times exactly"
    return ""


def _backward(subject: ForeignSolver) -> RunLines:
    """Solve y' = -y, which grows backward in time, from t = 1 to 0."""
    try:
        run = subject.solve(lambda n, t, y: [-y[0]], (1.0, 0.0), (1.0,), RTOL, ATOL)
    except Misbehaviour as failure:
        return RunLines([f"backward in time it gives no answer: {failure.word}"])
    if run.complaint:
        return RunLines([f"backward in time it ends at t = {run.t[-1]:.6g} and reports: {run.complaint}"])
    (last,) = run.y[-1]
    if (run.t[-1], last) == (1.0, 1.0):
        return RunLines(["it does not run backward in time: it makes no step, and does not say so"])
    off = abs(last - e)
    if off < _FOLLOWED and isclose(run.t[-1], 0.0, abs_tol=GROSS):
        return RunLines(["it integrates backward in time"])
    seen = f"it ends at t = {run.t[-1]:.6g}, off by {off:.3g}, without saying so"
    return RunLines(faults=[f"backward in time, from 1 to 0, {seen}"])


def _numbers(subject: ForeignSolver) -> RunLines:
    """Compare the step sizes of runs in which one of five numbers has a bump: they should be the same for each.

    If all have it, a norm of the errors is at most five times as large, which takes at most five times as many steps;
    if two have opposite ones, it is no smaller than for one of them. None takes fewer; a sign changes no step.
    """
    times, alone = [], [[float(i == place) for i in range(_NUMBERS)] for place in range(_NUMBERS)]
    bump: Callable[[float], float] = lambda t: 1 / (1 + (8 * (t - 1)) ** 2)
    opposite = [x - y for x, y in zip(*alone[:2], strict=True)]
    for sizes in [*alone, alone[0], [-x for x in alone[0]], opposite, [1.0] * _NUMBERS, [0.0] * _NUMBERS]:
        slopes = lambda n, t, y, sizes=sizes: [bump(t) * x for x in sizes]
        times.append(subject.solve(slopes, SPAN, (0.0,) * _NUMBERS, RTOL, ATOL).t)
    first, (negative, *others) = times[0], times[-4:]
    same: Callable[[Any], bool] = lambda t: len(t) == len(first) and np.allclose(t, first, rtol=0, atol=SAME_TIME)
    steps, opposed, together, still = (len(t) - 1 for t in (first, *others))
    if not same(times[_NUMBERS]):
        return RunLines(faults=["the same run, made again after others, takes other steps: it remembers them"])
    if not same(negative):
        seen = f"with a bump in y[0] it takes {steps} steps, with its negative {len(negative) - 1}"
        return RunLines(faults=[f"the step sizes depend on the signs of the numbers: {seen}"])
    if 2 * opposed < steps:  # far fewer: by other orders it may make some
        seen = f"with opposite bumps in y[0] and y[1] it takes {opposed} steps, with one of them {steps}"
        return RunLines(faults=[f"errors of opposite signs cancel in its error norm: {seen}"])
    for place, found in enumerate(times[:_NUMBERS]):
        if not same(found) and abs(len(found) - len(first)) > _UNSTABLE * steps:
            seen = f"with a bump in y[{place}] it takes {len(found) - 1} steps, with one in y[0] {steps}"
            return RunLines(faults=[f"the error norm does not treat all components alike: {seen}"])
    if together > _NUMBERS * steps or steps <= still < together:
        seen = f"with a bump in one of {_NUMBERS} components it takes {steps} steps, in all of them"
        return RunLines(faults=[f"an error counts only if other components have errors as well: {seen} {together}"])
    alike = f"the same {steps} steps" if all(map(same, times[:_NUMBERS])) else f"about {steps} steps"
    return RunLines([f"a bump in any of {_NUMBERS} components gives {alike}"])


def _nan(subject: ForeignSolver) -> RunLines:
    """Solve with a right-hand side that is NaN from the middle on: the solver should return NaN or report failure."""
    middle = sum(SPAN) / 2
    try:
        run = subject.solve(lambda n, t, y: [nan if t > middle else -y[0]], SPAN, (1.0,), RTOL, ATOL)
    except DoesNotEnd as failure:
        return RunLines(beside=[f"where f is NaN it has not ended: {failure}"])
    except Misbehaviour as failure:
        return RunLines([f"where f becomes NaN it reports that: {failure.word}"])
    if run.complaint:
        return RunLines([f"where f becomes NaN it ends at t = {run.t[-1]:.6g} and reports: {run.complaint}"])
    if not all(isfinite(x) for x in run.y[-1]):
        return RunLines(["where f becomes NaN it returns NaN"])
    seen = f"it ends at t = {run.t[-1]:.6g} with {run.y[-1][0]:.6g}, without saying so"
    return RunLines(beside=[f"where f becomes NaN {seen}"])


def _jump(subject: ForeignSolver) -> RunLines:
    """Solve u' = 0 before t = 2/3 and u' = 1 after it, where every step across the jump has a large error."""
    at = 2.0 / 3.0
    try:
        run = subject.solve(lambda n, t, y: [float(t > at)], SPAN, (0.0,), RTOL, ATOL)
    except DoesNotEnd as failure:
        return RunLines(faults=[f"at a jump of f it has not ended: {failure}"])
    except Misbehaviour as failure:
        return RunLines([f"at a jump of f it reports that: {failure.word}"])
    (last,) = run.y[-1]
    off = abs(last - (run.t[-1] - at))
    lines = [f"across a jump of f: {len(run.t) - 1} steps, {len(run.calls)} calls, off by {off:.2g}"]
    if run.complaint:
        return RunLines([*lines, f"it reports: {run.complaint}"])
    if off > _OF_A_JUMP * RTOL and subject.adaptive:
        over = f"it is off by {off:.3g} at rtol = {RTOL:g}: the jump is stepped over"
        return RunLines(lines, [f"across a jump of f {over}"])
    shortest = min((b - a for a, b in pairwise(run.t[:-1])), default=0.0) * (1 + _TINY)
    for (a, b), (u,), (v,) in zip(pairwise(run.t), run.y, run.y[1:], strict=False):
        error = abs(v - u - (b - at)) / ((ATOL if subject.takes == TOLERANCES else RTOL) + RTOL * abs(v))
        if a <= at < b <= a + shortest and error > _OF_A_JUMP and subject.adaptive:
            most = f"the shortest step that it takes, of {b - a:.3g}, is off by {error:.2g} times the tolerance"
            return RunLines(lines, [f"across a jump of f {most}, without saying so"])
    return RunLines(lines)


def _stiffness(subject: ForeignSolver) -> RunLines:
    """Solve y' = -1000 (y - cos t) - sin t, which an explicit method follows only in steps of a few thousandths."""
    try:
        slopes: RunSlopes = lambda n, t, y: [-_STIFF * (y[0] - cos(t)) - sin(t)]
        run = subject.solve(slopes, SPAN, (cos(SPAN[0]),), 1e-3, 1e-6)
    except DoesNotEnd as failure:
        return RunLines([f"on y' = -1000 (y - cos t) - sin t it has not ended: {failure}"])
    longest = _STIFF * max((b - a for a, b in pairwise(run.t)), default=0.0)
    (last,) = run.y[-1]
    off = abs(last - cos(run.t[-1]))
    lines = [f"on y' = -1000 (y - cos t) - sin t its longest step is {longest:.3g}/1000, off by {off:.2g} at the end"]
    implicit = ""
    if longest > _EXPLICIT and off < _FOLLOWED:  # long steps alone may ignore the error
        implicit = "it solves equations for its steps: no explicit method of up to 7 stages is stable like this"
        lines.append(implicit)
        # Asked of implicit solvers only: the last two stages of an explicit pair are as near, at one time.
        pairs = pairwise((call.t, *call.y) for call in run.calls)
        apart = sum(t == s and 0 < abs(u - v) < _NEARBY * (1 + abs(u)) for (t, u), (s, v) in pairs)
        lines += [f"it forms differences of f in y, {apart} times, as for a Jacobian"] if apart > 1 else []
    return RunLines(lines, implicit=implicit)


_QUESTIONS = {
    "Constant slopes": _constant_slopes, "Clock": _clock, "Backward": _backward, "Numbers": _numbers, "NaN": _nan,
    "A jump": _jump, "Tolerance": tolerance_effect, "Stiffness": _stiffness,
}  # fmt: skip
