"""Runs of a stepper on right-hand sides that answer otherwise at every step: what a recurrence is read from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall, WrongShape
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem, gives_force_times, hands_on_time
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.array_adapters import AnyNumber
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

# The golden mean's multiples lie far apart: no two of a run's answers are alike, and no few of them are related.
_GOLDEN = 0.6180339887498949
# Where in a step f is asked is told to a sixteenth of it: stages of the first steps are answered each in its own way.
_PLACES = 16
# How many numbers a right-hand side has, the most first; some codes take one.
_SIZES = (3, 2, 1)
# One more than the start of any method of the catalogue is long, and one more to look at.
_LOOKED_AT = 8
# A solver of stages that begins with its last solution leaves less, another method more.
_ALIKE = 2.0**-10
# The slopes are bent by less than so much of the state, so that h times that contracts with the h of 1 of these runs.
_BEND = 0.125


@dataclass(frozen=True)
class SteadyRun:
    """y₀, ..., y_N at equal steps of somebody's stepper, and hᵈF(yₙ) there, d being 1 for y' = F, 2 for y'' = F."""

    states: Array
    slopes: Array


def course(
    subject: ForeignStepper, problem: NonlinearProblem, t: float, y: Sequence[float], h: float, steps: int
) -> list[list[AnyNumber]]:
    """y₀, ..., y_N: a whole run of a code that makes runs, else N steps of one copy that remembers nothing before.

    Raises UnsupportedCall where it cannot be copied, and the Misbehaviour that comes instead of a step.
    """
    moving = subject.fresh(steps)
    if moving.convention.run:
        problem.stepped(moving, t, y, h)
        if len(moving.log.states) != steps + 1:
            raise UnsupportedCall("a run returns no state but its last one")
        return [[float(x) for x in state] for state in moving.log.states]
    states: list[list[AnyNumber]] = [list(y)]
    for n in range(steps):
        states.append(problem.stepped(moving, t + n * h, states[-1], h))
    return states


@dataclass(frozen=True)
class MarkedRuns:
    """Runs of one subject on slopes that are marked by the time, or by a clock among its numbers; else by the place.

    `size` counts the numbers, the positions of y'' = F(y), without the clock.
    """

    subject: ForeignStepper
    size: int
    clock: bool
    by_place: bool

    @classmethod
    def of(cls, subject: ForeignStepper) -> MarkedRuns:
        """Of as many numbers as the subject takes. Raises UnsupportedCall, or the Misbehaviour of one number."""
        if subject.convention.kind == FORCE:
            timed = gives_force_times(subject.fresh(subject.shortest))
            return cls(subject, 1, clock=False, by_place=not timed)
        if subject.convention.kind != FIELD:
            raise UnsupportedCall("its system is built in: no right-hand side of ours marks its steps")
        for size in _SIZES:
            try:
                timed = hands_on_time(subject.fresh(subject.shortest), size)
                break
            except Misbehaviour:
                if size == _SIZES[-1]:
                    raise
        clock = not timed and size > 1
        return cls(subject, size - clock, clock, by_place=not timed and not clock)

    @property
    def derivative(self) -> int:
        """d of y⁽ᵈ⁾ = F."""
        return 2 if self.subject.convention.kind == FORCE else 1

    def run(self, steps: int, *, h: float = 1.0, t: float = 0.0, bent: bool = False) -> SteadyRun:
        """One run; the slopes are of the marks alone, or where `bent` of the place, too. Raises NotReadable."""
        problem = self.problem(h, t, bent=bent)
        try:
            states = course(self.subject, problem, t, self.start(t), h, steps)
        except Misbehaviour as failure:
            raise NotReadable(f"in a run of {steps} steps, {failure}") from failure
        slopes = [self.slopes(problem, t + n * h, y) for n, y in enumerate(states)]
        numbers = np.array([y[: self.size] for y in states], dtype=float)
        return SteadyRun(numbers, np.array(slopes, dtype=float) * h**self.derivative)

    def begins_anew(self) -> bool:
        """Whether a run is the same after another one: copies share nothing."""
        first, _, again = (self.run(_LOOKED_AT, h=h) for h in (1.0, 0.5, 1.0))
        return bool(np.array_equal(first.states, again.states))

    def start(self, t: float) -> list[float]:
        """The state at the time t from which runs begin."""
        numbers = [0.25 * (1 + i) for i in range(self.size)]
        return [*numbers, *([t] if self.clock else []), *([0.5] * self.size if self.derivative == 2 else [])]

    def slopes(self, problem: NonlinearProblem, t: float, y: Sequence[AnyNumber]) -> list[float]:
        """F at a state, number by number."""
        rate = problem.rate(t, list(y))
        return [float(x) for x in (rate[-self.size :] if self.derivative == 2 else rate[: self.size])]

    def problem(self, h: float, t: float, *, bent: bool) -> NonlinearProblem:
        """y' = F or y'' = F with these slopes, from the time t on."""

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
                raise WrongShape(f"{len(y)} numbers came where {self.size + self.clock} went in")
            return [*marked(at, y), *([1.0] if self.clock else [])]

        return NonlinearProblem("", rate, lambda _: [], self.size if self.derivative == 2 else 0)


def _mark(number: int, place: AnyNumber) -> float:
    """Between -1 and 1, another one at each place and for each number."""
    return 2 * ((round(float(place)) * _GOLDEN * (number + 1) + 0.3 * number) % 1.0) - 1


def remembers(subject: ForeignStepper) -> bool:
    """Whether a step after others is another one than from the same state at once; False where that cannot be told."""
    try:
        return _departs(subject)
    except (UnsupportedCall, Misbehaviour):
        return False


def _departs(subject: ForeignStepper) -> bool:
    """As `remembers`. Raises UnsupportedCall, or the Misbehaviour that comes instead of a step."""
    if subject.shortest > 1:
        return True
    runs = MarkedRuns.of(subject)
    h, t = 1.0, 2.0
    problem = runs.problem(h, t, bent=True)
    states = course(subject, problem, t, runs.start(t), h, _LOOKED_AT)
    anew = [problem.stepped(subject.fresh(), t + n * h, y, h) for n, y in enumerate(states[:-1])]
    off = np.abs(np.array(states[1:], dtype=float) - np.array(anew, dtype=float)).max()
    return bool(off > _ALIKE * np.abs(states).max())


def later_steps(subject: ForeignStepper) -> tuple[bool | None, str, str]:
    """Whether a run goes on as it begins, in words; None of what makes single steps, or no longer run."""
    if not subject.convention.run:
        return None, "single steps are made, not runs", ""
    try:
        departs = _departs(subject)
    except (UnsupportedCall, Misbehaviour) as refusal:
        return None, f"no run of {_LOOKED_AT} steps is seen: {refusal}", ""
    if departs:
        return False, "a step after others is another one than from the same state at once: it remembers, or varies", ""
    return True, f"{_LOOKED_AT} steps of a run, each as from its state at once", ""
