"""Runs of a stepper on right-hand sides that answer differently at every step, to read a recurrence from."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from math import sin
from typing import NamedTuple

import numpy as np

from driftproof.blackbox.checks.determinism import ALIKE, MANY
from driftproof.blackbox.findings import Misbehaviour, StepFinding, UnsupportedCall, WrongShape, first_taken
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem, gives_force_times, passes_time, walls
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, GRID, MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber

# The multiples of the golden mean, modulo 1, lie far apart: no two answers of a run are alike, and no few related.
_GOLDEN = 0.6180339887498949
# Answers differ between sixteenths of a step, so that the stages of the first steps get different ones.
_PLACES = 16
# The numbers of components to try, the largest first; some codes take only one.
_SIZES = (3, 2, 1)
# Each interval of an uneven grid is longer than the one before by twice such a part of the first.
_UNEVEN = (0.125, 2.0**-10)
# The part by which explicit steps may differ in a run and alone: that of times, or so many roundings.
_EXACTLY, _ROUNDINGS = 2.0**-36, 2.0**12
# A bound on the derivative of the slopes by the state, so that iterations contract with the h of 1 of these runs.
_BEND = 0.125


@dataclass(frozen=True)
class SteadyRun:
    """The states y₀, ..., y_N of equal steps, and hᵈF(yₙ) there, with d = 1 for y' = F and d = 2 for y'' = F."""

    states: Array
    slopes: Array


def course(
    subject: ForeignStepper, problem: NonlinearProblem, t: float, y: Sequence[float], h: float, steps: int
) -> list[list[AnyNumber]]:
    """The states y₀, ..., y_N of a run of a code that makes runs, or the last alone; or of N steps of one fresh copy.

    Raises UnsupportedCall if the stepper cannot be copied, and the Misbehaviour that comes instead of a step.
    """
    moving = subject.fresh(steps)
    if moving.convention.run:
        problem.stepped(moving, t, y, h)
        return [[float(x) for x in state] for state in moving.log.states]
    states: list[list[AnyNumber]] = [list(y)]
    for at, after in pairwise(moving.convention.times(t, h)):
        states.append(problem.stepped(moving, at, states[-1], after - at))
    return states


@dataclass(frozen=True)
class MarkedRuns:
    """Runs of one subject on slopes that are marked by the time, by a clock in y, or else by the state.

    `size` is the number of components, or of positions for y'' = F(y), without the clock.
    """

    subject: ForeignStepper
    size: int
    clock: bool
    by_place: bool

    @classmethod
    def of(cls, subject: ForeignStepper) -> MarkedRuns:
        """Runs with as many components as the subject takes. Raises UnsupportedCall, Misbehaviour."""
        if subject.convention.kind == FORCE:
            timed = gives_force_times(subject.fresh(subject.shortest))
            return cls(subject, 1, clock=False, by_place=not timed)
        if subject.convention.kind != FIELD:
            raise UnsupportedCall("its system is built in: its steps cannot be marked by a given right-hand side")
        size, timed = first_taken(lambda n: (n, passes_time(subject.fresh(subject.shortest), n)), _SIZES)
        clock = not timed and size > 1
        return cls(subject, size - clock, clock, by_place=not timed and not clock)

    @property
    def derivative(self) -> int:
        """The d of y⁽ᵈ⁾ = F."""
        return 2 if self.subject.convention.kind == FORCE else 1

    def run(
        self, steps: int, *, h: float = 1.0, t: float = 0.0, bent: bool = False, untimed: bool = False
    ) -> SteadyRun:
        """One run, whose slopes depend on the marks, and if `bent` on the state as well. Raises NotReadable.

        Those that are `untimed` depend on the state alone.
        """
        problem = self.untimed if untimed else self.problem(h, t, bent=bent)
        try:
            states = course(self.subject, problem, t, self.start(t), h, steps)
        except Misbehaviour as failure:
            raise NotReadable(f"in a run of {steps} steps, {failure}") from failure
        if len(states) != steps + 1:
            raise UnsupportedCall("a run returns only its last state")
        slopes = [self.slopes(problem, t + n * h, y) for n, y in enumerate(states)]
        numbers = np.array([y[: self.size] for y in states], dtype=float)
        return SteadyRun(numbers, np.array(slopes, dtype=float) * h**self.derivative)

    def begins_anew(self) -> bool:
        """True if a run is the same after another one, so that copies share nothing."""
        first, _, again = (self.run(MANY, h=h) for h in (1.0, 0.5, 1.0))
        return bool(np.array_equal(first.states, again.states))

    def start(self, t: float) -> list[float]:
        """The state at the time t from which runs begin."""
        numbers = [0.25 * (1 + i) for i in range(self.size)]
        return [*numbers, *([t] if self.clock else []), *([0.5] * self.size if self.derivative == 2 else [])]

    def slopes(self, problem: NonlinearProblem, t: float, y: Sequence[AnyNumber]) -> list[float]:
        """F at a state, without the clock."""
        rate = problem.rate(t, list(y))
        return [float(x) for x in (rate[-self.size :] if self.derivative == 2 else rate[: self.size])]

    @property
    def untimed(self) -> NonlinearProblem:
        """A problem without time that turns, so that its steps of size 1 differ from method to method."""

        def rate(at: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            if self.derivative == 2:
                return [*y[self.size :], *(-sin(x) / 4 for x in y[: self.size])]
            return [*(sin(x) / 2 for x in y[1:]), -sin(y[0]) / 2]

        return NonlinearProblem("", rate, lambda _: [], self.size if self.derivative == 2 else 0)

    def problem(self, h: float, t: float, *, bent: bool) -> NonlinearProblem:
        """The problem y' = F or y'' = F with these slopes, from the time t on."""

        def marked(at: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            state = list(y[: self.size])
            if self.by_place:
                return [_mark(i, x * _PLACES) for i, x in enumerate(state)]
            place = ((y[-1] if self.clock else at) - t) / h * _PLACES
            moved = [*state[1:], state[0]]
            bend = _BEND if bent else 0.0
            pairs = enumerate(zip(state, moved, strict=True))
            return [_mark(i, place) + bend * z / (1 + x * x + z * z) for i, (x, z) in pairs]

        def rate(at: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            if self.derivative == 2:
                return [*y[self.size :], *marked(at, y)]
            if len(y) != self.size + self.clock:
                raise WrongShape(f"{len(y)} numbers came back for {self.size + self.clock} given")
            return [*marked(at, y), *([1.0] if self.clock else [])]

        return NonlinearProblem("", rate, lambda _: [], self.size if self.derivative == 2 else 0)


def _mark(number: int, place: AnyNumber) -> float:
    """A number between -1 and 1, a different one for each place and each component."""
    return 2 * ((round(float(place)) * _GOLDEN * (number + 1) + 0.3 * number) % 1.0) - 1


class Across(NamedTuple):
    """The first step after a change of h: its order, and whether it is as if there were no change, or as a first one.

    A step that is neither takes account of the change.
    """

    order: int
    plain: bool


def order_across(subject: ForeignStepper, order: int, rho: Sequence[float], sigma: Sequence[float]) -> Across | None:
    """The first step after a change of h, its order up to the given one; None if no such step is taken.

    A step of order p is exact on y' = p c^(p-1), c' = 1, where values before it are off by a constant at most.
    """
    if subject.convention.run or subject.convention.kind != FIELD:
        return None
    h = 0.125
    for p in range(1, order + 1):
        moving, ends, times = subject.fresh(), [(-h * MANY) ** p], [h * (n - MANY) for n in range(MANY + 1)]
        problem = lambda _, y, p=p: [p * y[1] ** (p - 1), 1.0]
        for t in times:  # of which the last step goes from t = 0
            ends.append(float(moving.step_field(problem, t, [ends[-1], t], h if t < 0 else 2 * h)[0]))
        if abs(ends[-1] - ends[-2] - (2 * h) ** p) > ALIKE * h**p:
            slopes = [p * t ** (p - 1) for t in (*times, 2 * h)]
            left = np.dot(rho, ends[-len(rho) :]) - 2 * h * np.dot(sigma, slopes[-len(sigma) :])
            first = float(subject.fresh().step_field(problem, 0.0, [ends[-2], 0.0], 2 * h)[0])
            return Across(p - 1, bool(min(abs(left), abs(first - ends[-1])) <= ALIKE * h**p))
    return Across(order, False)


def remembers(subject: ForeignStepper, uneven: float = 0.0, alike: float = ALIKE) -> bool:
    """True if a step after others differs from one taken afresh from that state. Raises UnsupportedCall, Misbehaviour.

    The intervals become longer by `uneven`; a built-in system steps from a state of its own. A part `alike` of the
    numbers does not count.
    """
    if subject.shortest > 1:
        return True
    if subject.convention.kind == MAP:
        problem, start, h, t = walls(1), [1.0, 0.75], 0.25, 0.0
    else:
        runs, h, t = MarkedRuns.of(subject), 1.0, 2.0
        problem, start = runs.problem(h, t, bent=True), runs.start(t)
    longer, alone = replace(subject, convention=replace(subject.convention, uneven=uneven)), [start]
    seen = course(longer, problem, t, start, h, MANY)
    for at, after in pairwise(longer.convention.of_steps(MANY).times(t, h)):
        alone.append(problem.stepped(subject.fresh(), at, alone[-1], after - at))
    off = np.abs(np.array(seen, dtype=float) - np.array(alone[-len(seen) :], dtype=float)).max()
    return bool(off > alike * np.abs(np.array(alone, dtype=float)).max())


def _clock_of_run(subject: ForeignStepper) -> str:
    """The part of h by which all later steps of a run call f too late or early, in words; "" if they do not."""
    h, t = 1.0, 2.0
    with suppress(UnsupportedCall, Misbehaviour):
        runs, asked = MarkedRuns.of(subject), list[float]()
        problem, start = runs.problem(h, t, bent=True), runs.start(t)

        def rate(at: AnyNumber, y: Sequence[AnyNumber]) -> Sequence[AnyNumber]:
            asked.append(float(at))
            return problem.rate(at, [*y])

        heard = replace(problem, rate=rate)
        course(subject, heard, t, start, h, MANY)
        in_run, first = asked.copy(), len(asked) // MANY
        asked.clear()
        for n in range(MANY):
            heard.stepped(subject.fresh(), t + n * h, start, h)
        if len(asked) == len(in_run):
            off = np.subtract(in_run, asked)[first:] / h
            if np.ptp(off) <= _EXACTLY and abs(off[0]) > _EXACTLY:
                return f"later ones call f at t {'+' if off[0] > 0 else '-'} {abs(off[0]):.6g} h instead of t"
    return ""


def later_steps(subject: ForeignStepper, explicit: bool = False) -> StepFinding:
    """Whether later steps of a run are like its first, in words; None for single steps, or if no run is seen."""
    if not (subject.convention.run or subject.anew):
        return StepFinding(None, "it makes single steps, not runs")
    alike = max(_EXACTLY, _ROUNDINGS * float(subject.format.u)) if explicit else ALIKE
    try:
        departs = remembers(subject, alike=alike)
    except (UnsupportedCall, Misbehaviour) as refusal:
        return StepFinding(None, f"no run of {MANY} steps was obtained: {refusal}")
    differs = "a step in a run differs from the same step taken alone"
    if departs:
        return StepFinding(False, f"{differs}: {_clock_of_run(subject) or 'it remembers, or varies'}")
    with suppress(UnsupportedCall, Misbehaviour):  # it may refuse unequal intervals
        grid = GRID in subject.convention.order
        if (grid or subject.anew) and any(remembers(subject, x, alike) for x in _UNEVEN):
            uneven = "where the times of its grid are unequally spaced, a later step takes another step size"
            return StepFinding(False, uneven if grid else f"where h changes, {differs}")
    return StepFinding(True, f"{MANY} steps of a run, each the same as taken alone")
