"""The coefficients of implicit steps for q'' = F(q), read as those of implicit steps of y' = f(t, y)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.implicit_tableau import read_by_chains
from driftproof.blackbox.probes.marked_stages import MarkedSteps, Setting, StageLabel, StageShares
from driftproof.blackbox.probes.scripted_answers import CoefficientRow, NotReadable, Rounding
from driftproof.blackbox.probes.stage_chains import StageChains
from driftproof.blackbox.probes.tableau import is_explicit
from driftproof.blackbox.stepper.foreign_code import FieldFunction
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber

# The part of the position's weights in what chains are read from: every stage shows, and none in use cancels.
_OF_POSITION = 0.625
# The settings in which nodes are read: they are nodes if another start, time and h show the same.
_SETTINGS = (Setting(), Setting(1.0, 1.0, 0.5))
_OTHERWISE = "its force is called with velocities of other stages than the positions"


class ForcedSteps(MarkedSteps):
    """Steps of q'' = F from rest as steps of y' = f(t, y) with the same stages: y = q and F = f/h, or y = v and F = f.

    If y is q, stage i is at y + h Σ aᵢⱼ fⱼ with Nyström's A, and the result is y + h Σ bⱼ fⱼ, where b is the row of the
    velocity's weights plus `position` times that of the position's, or the latter alone if `position` is None. If y is
    v, which the stepper has to pass to its force, A is that of the velocities. The number `moving`, if not -1, starts
    with the velocity 1.
    """

    def __init__(self, subject: ForeignStepper, *, of_velocity: bool = False) -> None:
        """Raises NotReadable if the stepper takes no two positions, or never calls its force."""
        self.of_velocity, self.moving = of_velocity, -1
        self.position: float | None = _OF_POSITION
        self.may_be_explicit = subject.gives_velocities
        super().__init__(subject)

    def step(self, rate: FieldFunction, t: float, y: list[float], h: float) -> list[float]:
        """One step of the subject."""
        count = len(y)

        def force(at: AnyNumber, q: Sequence[AnyNumber], v: Sequence[AnyNumber] = ()) -> Sequence[AnyNumber]:
            asked = [*(v if self.of_velocity else q)]
            if len(asked) != count:
                raise Misbehaviour("its force is called for one position after the other")
            return [k if self.of_velocity else k / h for k in rate(at, asked)]

        rest = [float(i == self.moving) for i in range(count)]
        q, v = (rest, y) if self.of_velocity else (y, rest)
        stepped = self.subject.step_dragged if self.subject.gives_velocities else self.subject.step_forced
        end = stepped(force, t, q, v, h)
        q1, v1 = end[:count], end[count:]
        if self.of_velocity:
            return v1
        if self.position is None:
            return q1
        return [x + h * w + self.position * (x1 - x) for x, x1, w in zip(y, q1, v1, strict=True)]


def read_implicit_forces(subject: ForeignStepper) -> ForceReading:
    """The coefficients of a step(force, q, v, h) with implicit stages, as near as its solver comes to them.

    Steps from rest have the stages of a step of y' = f(t, y) (`ForcedSteps`) and are read as such. Each row of weights
    is then read alone. A velocity without a force shows the nodes of the positions, and how far it moves them in a
    step. The velocities that a force is given are read likewise. Raises NotReadable, saying what was seen.
    """
    steps = ForcedSteps(subject)
    read, chains = read_by_chains(steps)
    weights, moved, nodes = [], [], []
    for position in (None, 0.0):
        steps.position = position
        weights.append(tuple(chains.weight(label) for label in chains.kept))
        moved.append(_moved(chains, None))
    (b_position, b_velocity), (drift, kept) = weights, moved
    if abs(kept - 1) > read.rounding.of(1.0):
        raise NotReadable(f"without a force, the new velocity is {kept:.6g} v, not 1 v")
    for i, label in enumerate(chains.kept):
        steps.position, weight = (0.0, b_velocity[i]) if b_velocity[i] else (None, b_position[i])
        if not weight:
            raise NotReadable("one of its stages has no weight, and its position is not known")
        nodes.append(_moved(chains, label) / weight)
    timed = zip(nodes, read.c or (), strict=False)
    late = ((c, t) for c, t in timed if abs(c - t) > read.rounding.of(1 + abs(c)))
    wrong = (f"its force is called at t + {t:.6g} h with the position of t + {c:.6g} h" for c, t in late)
    velocities = _velocities(subject, b_velocity) if subject.gives_velocities else None
    if all(map(is_explicit, filter(None, (read.a, velocities)))):
        raise NotReadable("none of its stages is implicit")
    found = ForceReading(tuple(nodes), read.a, b_position, b_velocity, drift, read.format, read.remarks)
    found = replace(found, wrong_time=next(wrong, ""), a_velocity=velocities)
    return replace(found, stage_error=chains.left, solved=read.solved)


def _moved(chains: StageChains, label: StageLabel | None) -> float:
    """How far a number of velocity 1 moves in a step, or its new velocity; with a stage, the node times its weight."""
    steps, seen = chains.steps, list[float]()
    assert isinstance(steps, ForcedSteps)
    clocks = len(chains.marks.hands)
    steps.moving = clocks

    def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
        pulled = 0.0 if label is None else shares.get(label, 0.0) * moved[0]
        return [0.0, pulled, *[0.0] * (len(moved) - 2)]

    for setting in _SETTINGS:
        result = steps.run(chains.marks, setting, slopes, size=2).result[clocks:]
        power = 1 if label is None else 2
        seen.append((result[power - 1] - setting.start) / setting.h**power)
    steps.moving = -1
    if abs(seen[1] - seen[0]) > Rounding(steps.subject.format, 8, 4 * chains.left).of(1 + abs(seen[0])):
        raise NotReadable(
            f"without a force a velocity counts {seen[0]:.6g} times, and {seen[1]:.6g} times with another start and h"
        )
    return seen[0]


def _velocities(subject: ForeignStepper, weights: CoefficientRow) -> tuple[CoefficientRow, ...]:
    """The rows of the velocities that a force is given. Raises NotReadable if they are of other stages."""
    read, _ = read_by_chains(ForcedSteps(subject, of_velocity=True))
    allowed = 2 * read.rounding.of(1.0)
    if len(read.b) != len(weights) or any(abs(x - y) > allowed for x, y in zip(read.b, weights, strict=True)):
        raise NotReadable(_OTHERWISE)
    return read.a
