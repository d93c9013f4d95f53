"""Right-hand sides that recognise the stage of each call, by its time and by clocks that run along in y."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import fsum, prod
from typing import NamedTuple, TypeAlias

from driftproof.blackbox.findings import Misbehaviour, first_taken
from driftproof.blackbox.probes.scripted_answers import ADAPTIVE, Listener, NotReadable, result_of
from driftproof.blackbox.stepper.foreign_code import FieldFunction
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import PARTED, SCALARS

# A stage: the number of its time, then that of each clock's value there, all in the order of the first call.
StageLabel: TypeAlias = tuple[int, ...]
# How much of each stage a call is: 1 for one of them if the clocks show its values.
StageShares: TypeAlias = Mapping[StageLabel, float]
# The slopes of the marked numbers, from the shares and how far each number has moved since the start of the step.
MarkedSlopes: TypeAlias = Callable[[StageShares, Sequence[float]], Sequence[float]]
# The slopes from the node (t - t₀)/h, None if no time is passed on, and how far each number has moved.
MovedSlopes: TypeAlias = Callable[[float | None, Sequence[float]], Sequence[float]]
# Nodes closer than this many u count as one: a time of up to 8 h is a rounded product and a sum, divided by h.
_SAME_NODE = 256
_WIDEST_NODE = 2.0**-8
# Difference quotients for a Jacobian shift a clock by about as much; stages that differ by less count as one.
_SAME_HAND = 2.0**-16
# Enough for difference quotients in some dozen unknowns, in some dozen iterations; an adaptive solver makes more.
_MOST_CALLS = 20000
# More labels than this are steps of an adaptive solver, and no stages.
_MOST_LABELS = 40
# How many numbers y has, the most first: more of them allow longer chains and more clocks, but some codes take two.
_SIZES = (4, 3, 2)


class _UnknownNode(Misbehaviour):
    """Ends a step from inside; it never leaves this module."""


class Setting(NamedTuple):
    """The setting of a step: where every number of y starts, at which time, and its h."""

    start: float = 0.0
    time: float = 0.0
    h: float = 1.0


class MarkedRun(NamedTuple):
    """The nodes (t - t₀)/h of the calls, None if no time is passed on; the places of the calls; and the result.

    Places and result are as they come, including the factor h and the start.
    """

    nodes: list[float | None]
    places: list[list[float]]
    result: list[float]


@dataclass(frozen=True)
class StageMarks:
    """The marks that tell stages apart: their nodes, and what each clock shows at the stages told apart before it.

    A clock is a number of y whose slope at a call is a function of the label so far, so that at stage i it shows
    h Σ aᵢⱼ g(label j). Stages that no clock tells apart are equal on every problem. Clocks depend on nothing else in y,
    so every solver has them right after one iteration.
    """

    nodes: tuple[float, ...]
    hands: tuple[Mapping[StageLabel, Mapping[int, float]], ...] = ()

    @property
    def labels(self) -> list[StageLabel]:
        """All labels, with those of first guesses and of difference quotients, in the order of their first call."""
        found: list[StageLabel] = [(i,) for i in range(max(1, len(self.nodes)))]
        for shown in self.hands:
            found = [(*label, i) for label in found for i in shown.get(label, ())]
        return found

    def only(self, kept: Sequence[StageLabel]) -> StageMarks:
        """The marks of these stages alone; the others have turned out not to be stages."""
        hands = []
        for k, shown in enumerate(self.hands, start=1):
            meant = {label[: k + 1] for label in kept}
            hands.append({p: {i: x for i, x in seen.items() if (*p, i) in meant} for p, seen in shown.items()})
        return StageMarks(self.nodes, tuple(hands))

    def shares(self, place: int, hands: Sequence[float]) -> dict[StageLabel, float]:
        """How much of each stage a call is, from its node and its clocks, by Lagrange's polynomials in the clocks.

        They are smooth, so that a solver which follows its residual arrives at the stage.
        """
        found: dict[StageLabel, float] = {(place,): 1.0}
        for shown, hand in zip(self.hands, hands, strict=False):
            found = {
                (*label, i): share * prod((hand - y) / (x - y) for y in shown[label].values() if y != x)
                for label, share in found.items()
                for i, x in shown.get(label, {}).items()
            }
        return found


def clock_slopes(shares: Sequence[StageShares]) -> list[float]:
    """The slopes of the clocks, each from the shares by the clocks before it; 1 for the first if calls have no time."""
    numbered = [[(sum(i * _MOST_LABELS**k for k, i in enumerate(at)), x) for at, x in seen.items()] for seen in shares]
    return [fsum(share * spread(number) for number, share in seen) for seen in numbered]


class MarkedSteps:
    """Steps of one subject on right-hand sides that know the stage; `part` is the number of the function called.

    A stepper that takes one number only is given one that stands for several (`PARTED`). Its difference quotients then
    shift all of them at once: marks depend on distances from an idle number, which shifts by the same amount.
    """

    parts = 1
    # True if all of these stages may be explicit, because others, those of velocities, may be implicit.
    may_be_explicit = False

    def __init__(self, subject: ForeignStepper) -> None:
        """Raises NotReadable if the subject takes no two numbers, or never calls its right-hand side."""
        self.subject, self.part = subject, 0
        self.alone = False  # True if the numbers are parts of one
        try:
            self.size, first = self._opened()
        except NotReadable:
            if not subject.single and subject.adapter is not SCALARS:
                raise
            self.subject, self.alone = replace(subject, adapter=PARTED), True
            self.size, first = self._opened()
        times = [node for node in first.nodes if node is not None]
        if not first.nodes:
            raise NotReadable("the right-hand side is never called")
        self.timed = len(times) == len(first.nodes)
        self.same_node = min(_SAME_NODE * float(subject.format.u), _WIDEST_NODE)
        self.nodes = _distinct(times, self.same_node) if self.timed else ()

    def marks(self, clocks: int) -> StageMarks:
        """The marks by `clocks` clocks. Raises NotReadable if they show more stages than a method has."""
        marks = StageMarks(self.nodes)
        for k in range(clocks):
            run = self.run(marks, Setting(), lambda shares, moved: [0.0] * len(moved), clocks=k + 1)
            shown: dict[StageLabel, list[float]] = {}
            for node, place in zip(run.nodes, run.places, strict=True):
                shares = marks.shares(self._place(node), place[:k])
                shown.setdefault(max(shares, key=lambda label: abs(shares[label])), []).append(place[k])
            # Of the values that count as one, the last is the one that a solver has come to.
            hands = {p: dict(enumerate(_distinct(seen[::-1], _SAME_HAND)[::-1])) for p, seen in shown.items()}
            marks = replace(marks, hands=(*marks.hands, hands))
        if len(marks.labels) > _MOST_LABELS:
            many = f"its right-hand side is called at {len(marks.labels)} stages"
            raise NotReadable(f"{many}: it is adaptive", ADAPTIVE)
        return marks

    def run(
        self, marks: StageMarks, setting: Setting, slopes: MarkedSlopes, *, clocks: int | None = None, size: int = 0
    ) -> MarkedRun:
        """One step of y' = (slopes of the clocks, `slopes` of the shares and of how far the other numbers have moved).

        y has `size` numbers besides the clocks, or as many as the subject takes.
        """
        count = len(marks.hands) if clocks is None else clocks

        def rates(node: float | None, moved: Sequence[float]) -> Sequence[float]:
            place, hands = self._place(node), [x / setting.h for x in moved[:count]]
            seen = [replace(marks, hands=marks.hands[:k]).shares(place, hands) for k in range(count + 1)]
            return [*clock_slopes(seen[:-1]), *slopes(marks.shares(place, hands), moved[count:])]

        return self.smooth(setting, rates, max(2, count + size) if size else self.size, self.alone)

    def smooth(self, setting: Setting, rates: MovedSlopes, size: int = 0, idle: bool = False) -> MarkedRun:
        """One step of y' = rates(node, y - start), perhaps beside an `idle` number.

        Raises NotReadable for any Misbehaviour: it is no evidence here.
        """
        start, clock, h = setting.start, float(setting.time), setting.h

        def answered(asked: tuple[float | None, list[float]]) -> Sequence[float]:
            node, y = asked
            return rates(node, [x - start for x in y])

        heard = Listener(answered, _MOST_CALLS)

        def rate(t: float, y: Sequence[float]) -> Sequence[float]:
            # If the stepper passes on no time, t is the very object `clock`.
            answer: Sequence[float] = heard((None if t is clock else (t - setting.time) / h, list(y)))
            return answer

        try:
            step = self._beside_idle if idle else self.step
            y1 = result_of(lambda: step(rate, clock, [start] * (size or self.size), h))
        except _UnknownNode as seen:
            raise NotReadable(str(seen), ADAPTIVE) from None
        except Misbehaviour as failure:
            raise NotReadable(f"with its stages marked, {failure}") from failure
        return MarkedRun([node for node, _ in heard.calls], [y for _, y in heard.calls], y1)

    def _beside_idle(self, rate: FieldFunction, t: float, y: list[float], h: float) -> list[float]:
        """One step beside a number whose shift is taken from all others."""
        moved: FieldFunction = lambda at, z: [*rate(at, [x - (z[-1] - y[0]) for x in z[:-1]]), 0.0]
        return self.step(moved, t, [*y, y[0]], h)[:-1]

    def step(self, rate: FieldFunction, t: float, y: list[float], h: float) -> list[float]:
        """One step of the subject."""
        return self.subject.step_field(rate, t, y, h)

    def _place(self, node: float | None) -> int:
        """The number of the node. Raises _UnknownNode for a node that was not seen before."""
        place = 0 if node is None else min(range(len(self.nodes)), key=lambda i: abs(self.nodes[i] - node))
        if node is not None and abs(node - self.nodes[place]) > self.same_node:
            nodes = ", ".join(f"{x:.6g}" for x in self.nodes)
            raise _UnknownNode(
                f"the right-hand side is called at t + {node:.6g} h, and with other slopes, times and h at the nodes "
                f"{nodes}: the step is adaptive, or its times do not scale with h"
            )
        return place

    def _opened(self) -> tuple[int, MarkedRun]:
        moved_by_one = partial(self.smooth, Setting(), lambda node, moved: [1.0] * len(moved))
        return first_taken(lambda size: (size, moved_by_one(size)), _SIZES, NotReadable)


def _distinct(numbers: Sequence[float], distance: float) -> tuple[float, ...]:
    """The numbers without those that are within `distance` of an earlier one."""
    found: list[float] = []
    for x in numbers:
        if all(abs(x - y) > distance for y in found):
            found.append(x)
    return tuple(found)


def spread(number: int) -> float:
    """A number from 1 to 2, 1 for 0, far from those of all other small numbers: multiples of the golden mean."""
    return 1.0 + number * 0.6180339887498949 % 1
