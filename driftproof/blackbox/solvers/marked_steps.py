"""The one step of a solver that is examined, in runs in which f returns 0 at every call but one, and 1 at that."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from math import fsum, inf
from typing import Any, TypeAlias

from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.probes.dense import BETWEEN, THETAS, DenseReading
from driftproof.blackbox.probes.scripted_answers import (
    MOST_CALLS,
    CoefficientRow,
    NotReadable,
    Rounding,
    shown_apart,
    varied,
)
from driftproof.blackbox.probes.stage_solutions import advanced
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.solvers.foreign_solver import Call, ForeignSolver, Solution, in_binary32
from driftproof.blackbox.stepper.states.array_adapters import as_array
from driftproof.symbolic.rounding.formats import BINARY32

# With these tolerances a slope of size 1 makes no error: every step is accepted, and as long as the solver allows.
# `steps` is for solvers that take a number of steps.
_LAX: dict[str, Any] = {"rtol": 1.0, "atol": 2.0**100, "steps": 16}
_SPAN = (0.0, 1.0)
# A mark so small that even a solver that ignores its tolerances accepts its error.
_MARK = 2.0**-80
# The start, the end and the length have many bits: no time is a number of binary32 by chance.
_ODD_SPAN = (0.1, 1.8)
# No explicit method in use makes so many calls in a row at one time.
_AT_ONE_TIME = 8
StageRate: TypeAlias = Callable[[float, list[float]], Sequence[float]]
# The roundings in a coefficient: times h, the difference of two times that it is divided by, and the quotient.
ROUNDINGS_READ = 4


def stepped(reading: TableauReading, rate: StageRate, t: float, h: float, y: Sequence[float]) -> list[float]:
    """The end of a step of size h from y at t by the explicit stages read."""
    return advanced(y, h, [reading.b], [stage_slopes(reading.a, reading.c or (), rate, t, h, y)])


def stage_slopes(
    a: Sequence[Sequence[float]], c: Sequence[float], rate: StageRate, t: float, h: float, y: Sequence[float]
) -> list[Sequence[float]]:
    """The slopes of the explicit stages of a step of size h from y at t."""
    slopes: list[Sequence[float]] = []
    for row, node in zip(a, c, strict=True):
        slopes.append(rate(t + node * h, advanced(y, h, [row], [slopes])))
    return slopes


def _bent(t: float, y: Sequence[float]) -> list[float]:
    """A smooth slope of size 1 that depends on both t and y."""
    return [(1 - 2 * y[0] * y[0]) / (1 + t + y[0] * y[0])]


class MarkedStep:
    """Runs of y' = f where f is 0 except at marked calls, and the one step of them that is examined."""

    def __init__(self, subject: ForeignSolver) -> None:
        self.subject = subject
        odd = subject.solve(lambda n, t, y: [0.0], _ODD_SPAN, (0.0,), **_LAX)
        self.silent = self._run({})
        self.format = BINARY32 if in_binary32(odd.t) else self.silent.format
        t = self.silent.t
        if len(t) < 2 or t[0] != _SPAN[0]:
            raise NotReadable("it does not return the times of its steps from the start on")
        if any(any(y) for y in self.silent.y):
            raise NotReadable("with all slopes 0, y = 0 does not stay 0")
        # If there are others: not the last step, which is shortened to the end, nor the first, which has none before.
        inner = range(1, len(t) - 2) if len(t) > 3 else range(len(t) - 1)
        self.place = max(inner, key=lambda n: (t[n + 1] - t[n]) / (t[n + 1] or inf))
        self.start, self.end = t[self.place], t[self.place + 1]
        self.h = self.end - self.start
        if not self.h > 0:
            raise NotReadable(f"its times do not increase: {self.start!r} is followed by {self.end!r}")
        # A call within rounding of the start, such as the end of the step before, is one at the start.
        near = 2 * float(self.format.u) * abs(self.start)
        calls = tuple(x._replace(t=self.start) if abs(x.t - self.start) <= near else x for x in self.silent.calls)
        self.silent = self.silent._replace(calls=calls)
        # The calls that choose the first step size come before those of the steps, and may lie in this one.
        since = max((n for n, call in enumerate(calls) if call.t < self.start), default=-1)
        # The slope at the start may be needed before the extra stages of the previous step's dense output.
        within = [n for n, call in enumerate(calls) if self.start <= call.t <= self.end]
        self.near = [n for n in within if n > since or calls[n].t == self.start]
        earlier = self.silent.t[self.place - 1]  # in the first step t[-1]: the range is empty
        self.earlier = [n for n, call in enumerate(self.silent.calls) if earlier <= call.t < self.start]
        elsewhere = next((call for n in self.near if any((call := self.silent.calls[n]).y)), None)
        if elsewhere is not None and self.place:
            at = next(x for x in elsewhere.y if x) * _MARK
            raise NotReadable(f"with all slopes 0, from y = 0, it calls f at y = {at:.3g}: differences for a Jacobian")
        if len(self.near) > MOST_CALLS:
            raise NotReadable(f"{len(self.near)} calls fall in one step: an iteration, or it does not return its steps")

    @property
    def nodes(self) -> tuple[float, ...]:
        """The nodes of the calls from the first stage after the start on, without the last ones at the end."""
        times = [self.silent.calls[n].t for n in self.near if n >= self.first]
        while len(times) > 1 and times[-1] == self.end:
            times.pop()
        return tuple((t - self.start) / self.h for t in times)

    def reading(self) -> TableauReading:
        """The tableau of the calls that move the end of the step and not its start, directly or through others."""
        self.runs = runs = {n: self._run({n: 1.0}) for n in self.near}
        before = {n: self._run({n: 1.0}) for n in self.earlier}
        self._require_no_memory([*before.values(), *runs.values()])
        self._require_slopes_at_the_start(before)
        weights = {n: run.y[self.place + 1][0] / self.h for n, run in runs.items() if not run.y[self.place][0]}
        entries = {
            n: {m: runs[m].calls[n].y[0] / self.h for m in weights if m < n and runs[m].calls[n].y[0]} for n in weights
        }
        self.weights, self.entries = weights, entries
        stages, a, c = self._stages({n for n, x in weights.items() if x})
        if not stages:
            raise NotReadable("no call moves the step in which it is made")
        # The calls of another row may come first; in the first step, those that choose its size come before all.
        later = [n for n in (self.near if self.place else stages) if self.silent.calls[n].t > self.start]
        self.first = later[0] if later else self.near[-1]
        if c[-_AT_ONE_TIME:] == c[-1:] * _AT_ONE_TIME:
            raise NotReadable(f"{len(c)} calls in one step, the last {_AT_ONE_TIME} at one time: it iterates")
        reading = TableauReading(a, tuple(weights[n] for n in stages), c, self.format)
        self._control(reading, stages)
        self._control_bent(reading)
        return reading

    def reaches_beyond(self) -> bool:
        """Take the calls up to a step beyond the end that move it, themselves or through others; False if none does."""
        beyond = [n for n, call in enumerate(self.silent.calls) if self.end < call.t <= self.end + self.h]
        if len(self.near) + len(beyond) > MOST_CALLS:
            return False
        runs = {n: self._run({n: 1.0}) for n in (*self.near, *beyond)}
        own = {n for n, run in runs.items() if run.y[self.place + 1][0] and not run.y[self.place][0]}
        through = {n for n in beyond if any(runs[n].calls[m].y[0] for m in own)}
        if not (moving := {*beyond} & (own | through)):
            return False
        self.near = sorted(moving | {n for n in self.near if not runs[n].y[self.place][0]})
        return True

    def dense(self) -> DenseReading | None:
        """The dense output within the step as a function of time, after `reading`; None if there is none."""
        rows: dict[int, list[float]] = {}
        times = [self.start + float(theta) * self.h for theta in (*THETAS, *BETWEEN)]
        for n in self.weights:
            found = self.runs[n].dense
            if found is None:
                return None
            values = [as_array(found(time)).ravel()[0] for time in times]
            rows[n] = [float(x) / _MARK / self.h for x in values]
        stages, a, c = self._stages({n for n, row in rows.items() if any(row) or self.weights[n]})
        columns = tuple(tuple(rows[n][k] for n in stages) for k in range(len(times)))
        sixteenths, others = columns[: len(THETAS)], columns[len(THETAS) :]
        step = TableauReading(a, sixteenths[-1], c, self.format)
        as_rounded = ((Fraction(time) - Fraction(self.start)) / Fraction(self.h) for time in times[len(THETAS) :])
        between = tuple(zip(as_rounded, others, strict=True))
        return DenseReading("the time", step, sixteenths, tuple(self.weights[n] for n in stages), between)

    def _stages(self, used: set[int]) -> tuple[list[int], tuple[CoefficientRow, ...], CoefficientRow]:
        """These calls and all that they depend on, in order, with their A and c."""
        while not used >= (further := {m for n in used for m in self.entries[n]}):
            used = used | further
        stages = sorted(used)
        a = tuple(tuple(self.entries[n].get(m, 0.0) for m in stages) for n in stages)
        return stages, a, tuple((self.silent.calls[n].t - self.start) / self.h for n in stages)

    def _require_no_memory(self, runs: Sequence[Solution]) -> None:
        """Raise NotReadable if an answer that moves the start of the step moves its end by another amount."""
        rounding = Rounding(self.format, len(self.near))
        for run in runs:
            before, after = run.y[self.place][0], run.y[self.place + 1][0]
            if before and not abs(after - before) <= rounding.of(abs(before)):
                share = f"a slope that enters one step enters the next as well, by {(after - before) / self.h:.6g} h"
                raise NotReadable(f"{share}: it is a multistep method, or uses a last stage as the slope at the end")

    def _require_slopes_at_the_start(self, before: Mapping[int, Solution]) -> None:
        """Raise NotReadable if an answer to a call before the start moves the end of this step alone."""
        for n, run in before.items():
            if run.y[self.place + 1][0] and not run.y[self.place][0]:
                since = self.silent.t[self.place - 1]
                h = self.start - since
                near = ROUNDINGS_READ * float(self.format.u) / h  # of times up to 1
                node = coefficient_text((self.silent.calls[n].t - since) / h, self.format, near)
                if node != "1":
                    said = f"its first slope is that of a call at c = {node} of the step before, not at the end, c = 1"
                    raise NotReadable(f"{said}: a last stage that is the next first one is called at a wrong time")

    def _control(self, reading: TableauReading, stages: list[int]) -> None:
        """Raise NotReadable if a run with other answers does not end where the coefficients say."""
        answers = varied(len(stages), 2)
        run = self._run(dict(zip(stages, answers, strict=True)))
        seen = run.y[self.place + 1][0] - run.y[self.place][0]
        said = self.h * fsum(x * k for x, k in zip(reading.b, answers, strict=True))
        size = self.h * fsum(abs(x * k) for x, k in zip(reading.b, answers, strict=True))
        if not abs(seen - said) <= reading.rounding.of(size):
            ends = "a step ends at {} where the coefficients read give {}".format(*shown_apart(seen, said))
            raise NotReadable(f"with other answers {ends}: it is not linear in its slopes: an iteration, or a limiter")

    def _control_bent(self, reading: TableauReading) -> None:
        """Raise NotReadable if a step of a nonlinear problem is not that of the stages read, as in an iteration."""
        run, rounding = self.subject.solve(lambda n, t, y: _bent(t, y), _SPAN, (0.25,), **_LAX), reading.rounding
        for (t, end), ((before,), (after,)) in zip(pairwise(run.t), pairwise(run.y), strict=True):
            h = end - t
            (said,) = stepped(reading, _bent, t, h, [before])
            size = abs(before) + h * fsum(abs(x) for row in (*reading.a, reading.b) for x in row)
            if not abs(after - said) <= rounding.of(size):
                ends = "a step ends at {} where the explicit stages read give {}".format(*shown_apart(after, said, 9))
                why = "it iterates, or takes other stages than those read"
                raise NotReadable(f"on a nonlinear problem {ends}: {why}")

    def _run(self, answers: dict[int, float]) -> Solution:
        run = self.subject.solve(lambda n, t, y: [_MARK * answers.get(n, 0.0), 0.0], _SPAN, (0.0, 0.0), **_LAX)
        y = tuple(tuple(x / _MARK for x in numbers) for numbers in run.y)
        calls = tuple(Call(call.t, tuple(x / _MARK for x in call.y)) for call in run.calls)
        run = run._replace(y=y, calls=calls)
        silent = getattr(self, "silent", run)
        if run.t != silent.t or len(run.calls) != len(silent.calls):
            raise NotReadable("with other slopes it takes other steps, although no error exceeds the tolerance")
        return run
