"""The products of alpha, gamma and b of a Rosenbrock step, read with marked slopes and a nilpotent Jacobian."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from driftproof.blackbox.findings import UnsupportedCall, first_taken
from driftproof.blackbox.matching.tables import Array
from driftproof.blackbox.probes import scripted_answers as scripted
from driftproof.blackbox.stepper.calling_conventions import JACOBIAN, TIME_SLOPE
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.second_functions import with_functions
from driftproof.symbolic.rounding.formats import FloatFormat

# The numbers of components to try, the largest first: n of them show the powers of gamma up to n - 1.
_SIZES = (8, 4, 3, 2)
# Calls at the start but nearer to its time than this part of h are differences for df/dt.
_DIFFERENCE = 2.0**-6
# Calls with places and times this close are of one stage: rounding separates them by less, stages by more. The control
# allows as much, or this many u in a narrower format, as seven systems of eight equations need: 1 + 8 for each.
_SAME, _ROUNDINGS = 2.0**-30, 64


@dataclass(frozen=True)
class RosenbrockReading:
    """C Γᶜ E for c = 0, 1, ...: the weight of hᶜ⁺¹ Jᶜ times each call's slope in the place of each call and the result.

    Stages at one place are one call. Row i of C is the row of α for call i, its last row is b; E adds up the stages
    that share a call, so that E = 1 if none do. `nodes` are the times of the calls, None if f gets none. `time_slope`
    is C Γᶜ γ, the weights of ∂f/∂t, with γ the row sums of Γ; `by` is its source, "a function" or "differences", or ""
    if there is none. `jacobian_at` is the node at which the Jacobian is evaluated, and how far from the start.
    """

    weights: tuple[tuple[tuple[float, ...], ...], ...]
    nodes: tuple[float, ...] | None
    time_slope: tuple[tuple[float, ...], ...] | None
    by: str
    jacobian_at: tuple[float, float]
    format: FloatFormat

    @property
    def calls(self) -> int:
        """The number of different places at which f is evaluated."""
        return len(self.weights[0]) - 1

    @property
    def slack(self) -> float:
        """The error of a df/dt by differences in floats; 0 if there are none."""
        return float(self.format.u) ** 0.5 if self.by == "differences" else 0.0

    @property
    def table(self) -> tuple[Array, Array, Array] | None:
        """α, Γ and b by least squares, if each stage has a call of its own that shows; else None."""
        levels = [np.array(level) for level in self.weights]
        seen, moved = np.vstack(levels[:-1]), np.vstack(levels[1:])
        gamma, _, rank, _ = np.linalg.lstsq(seen, moved, rcond=_SAME)
        if rank < self.calls or np.abs(seen @ gamma - moved).max() > _SAME:
            return None
        return levels[0][:-1], gamma, levels[0][-1]


def read_rosenbrock_step(subject: ForeignStepper) -> RosenbrockReading:
    """Read the products from steps with t = 0, y = 0 and h = 1, in which one call at a time is answered by 1.

    The Jacobian is y₁ -> y₂ -> y₃ -> ..., whatever f is, as W methods allow. Raises NotReadable, UnsupportedCall.
    """
    if JACOBIAN not in subject.convention.order:
        raise UnsupportedCall(
            f"the stepper is called as {subject.convention.kind!r}, which takes no Jacobian: hand it that"
        )
    return _Probe(subject).reading()


class _Step:
    """One step: where it evaluated f and the Jacobian, and its result."""

    def __init__(self, subject: ForeignStepper, answer: Callable[[int, float, Array], Sequence[float]], **given: Any):
        heard = scripted.Listener(lambda asked: answer(len(heard.calls) - 1, *asked))
        self.jacobian_at: list[tuple[float, Array]] = []

        def matrix(t: float, y: Sequence[float]) -> Any:
            self.jacobian_at.append((t, np.array(y)))
            return given["jacobian"]

        functions = {JACOBIAN: matrix, TIME_SLOPE: lambda t, y: given["time_slope"]}
        clock = float(given["t"])

        def rate(t: float, y: Sequence[float]) -> Any:
            self.timed |= t is not clock
            return heard((t, np.array(y)))

        self.timed = False
        stepped = with_functions(subject, functions)
        end = scripted.result_of(lambda: stepped.step_field(rate, clock, given["start"], given["h"]))
        self.times, self.places = [t for t, _ in heard.calls], [y for _, y in heard.calls]
        self.result = np.array(end)


class _Probe:
    def __init__(self, subject: ForeignStepper) -> None:
        """Take a first step, with as many components as the stepper takes, and tell its calls apart."""
        self.subject = subject
        self.first = first_taken(self._generic, _SIZES)
        if not self.first.places or not self.first.jacobian_at:
            raise scripted.NotReadable("it never calls its right-hand side, or its Jacobian")
        self.calls = len(self.first.places)
        asked = [np.array([t, *y]) for t, y in zip(self.first.times, self.first.places, strict=True)]
        self.groups, self.differences = list[list[int]](), list[int]()
        for i, place in enumerate(asked):
            same = [group for group in self.groups if np.abs(place - asked[group[0]]).max() <= _SAME]
            if 0 < abs(place[0]) < _DIFFERENCE and np.abs(place - asked[0])[1:].max() <= _SAME:
                self.differences.append(i)
            elif same:
                same[0].append(i)
            else:
                self.groups.append([i])

    def _generic(self, size: int) -> _Step:
        """A step with so many components in which no two stages lie at one place by chance."""
        self.size = size
        matrix = [[0.25 / (1 + i + 2 * j) - 0.5 * (i == j) for j in range(self.size)] for i in range(self.size)]

        def answer(_: int, t: float, y: Array) -> list[float]:
            return [(1 + i) / (2 + t + float(np.dot(y, y)) + float(y[i])) for i in range(self.size)]

        return self._step(answer, jacobian=matrix, start=scripted.varied(self.size, 3))

    def _step(self, answer: Callable[[int, float, Array], Sequence[float]], **given: Any) -> _Step:
        chain = [[float(i == j + 1) for j in range(self.size)] for i in range(self.size)]
        usual = {"jacobian": chain, "time_slope": [0.0] * self.size, "start": [0.0] * self.size, "t": 0.0, "h": 1.0}
        return _Step(self.subject, answer, **{**usual, **given})

    def _seen(self, answer: Callable[[int, float, Array], Sequence[float]], **given: Any) -> Array:
        """The numbers of a step from 0: a row for the place of each group, and one for the result."""
        step = self._step(answer, **given)
        scripted.require_calls(self.calls, len(step.places))
        return np.array([*(step.places[group[0]] for group in self.groups), step.result])

    def reading(self) -> RosenbrockReading:
        """The products of all groups that move anything, confirmed by a step with other answers, h and t."""
        zero = [0.0] * self.size
        one = [1.0, *zero[1:]]
        if np.abs(self._seen(lambda i, t, y: zero)).max() > 0:
            raise scripted.NotReadable("with all slopes 0, y = 0 does not stay 0")
        columns = []
        for number, group in enumerate(self.groups):
            marked = {*group, *(self.differences if number == 0 else ())}
            columns.append(self._seen(lambda i, t, y, marked=marked: one if i in marked else zero))  # type: ignore[misc]
        by, slope = "", None
        if TIME_SLOPE in self.subject.convention.order:
            by, slope = "a function", self._seen(lambda i, t, y: zero, time_slope=one)
        elif self.differences:
            late = {i: [self.first.times[i], *zero[1:]] for i in self.differences}
            by, slope = "differences", self._seen(lambda i, t, y: late.get(i, zero))
        used = [g for g, column in enumerate(columns) if np.abs(column).max() > 0]
        if not used:
            raise scripted.NotReadable("no call moves the step in which it is made")
        self._control(np.array(columns))
        rows = [*used, len(self.groups)]
        at, place = self.first.jacobian_at[0]
        return RosenbrockReading(
            tuple(tuple(tuple(float(columns[g][r][c]) for g in used) for r in rows) for c in range(self.size)),
            tuple(self.first.times[self.groups[g][0]] for g in used) if self.first.timed else None,
            None if slope is None else tuple(tuple(float(slope[r][c]) for r in rows) for c in range(self.size)),
            by,
            (at, float(np.abs(place - np.array(scripted.varied(self.size, 3))).max())),
            self.subject.format,
        )

    def _control(self, columns: Array) -> None:
        """Raise NotReadable if a step with other answers, h, t and start does not end where the products say."""
        h, t = 0.5, 2.0
        slopes, start = scripted.varied(len(self.groups), 2), scripted.varied(self.size, 1)
        answers = defaultdict(float, {i: slopes[g] for g, group in enumerate(self.groups) for i in group})
        answers |= dict.fromkeys(self.differences, slopes[0])
        step = self._step(lambda i, t, y: [answers[i], *[0.0] * (self.size - 1)], start=start, t=t, h=h)
        scripted.require_calls(self.calls, len(step.places))
        said = np.tensordot(np.array(slopes), columns[:, -1, :], axes=1) * h ** np.arange(1, self.size + 1) + start
        i = int(np.argmax(off := np.abs(step.result - said)))
        if off[i] > max(_SAME, _ROUNDINGS * float(self.subject.format.u)) * (1 + np.abs(said).max()):
            ends = "it ends at {}, where the coefficients read give {}".format(
                *scripted.shown_apart(step.result[i], said[i])
            )
            why = "it is not linear in its slopes, does not scale with h, or remembers another step"
            raise scripted.NotReadable(f"with other slopes and h = {h:g} {ends}: {why}")
