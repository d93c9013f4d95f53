"""The first questions about a stepper: how it is called, and which coefficients it has."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TypeAlias

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.probes.force import ForceReading, read_forces
from driftproof.blackbox.probes.implicit_forces import read_implicit_forces
from driftproof.blackbox.probes.implicit_tableau import read_implicit_tableau
from driftproof.blackbox.probes.scripted_answers import REMEMBERS, NotReadable, Rounding, unit
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.calling_conventions import FIELD, TIME
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

_OF_ONE = "one number shows the stability function only; a step that takes an array of them shows its stages"
CoefficientReading: TypeAlias = TableauReading | ForceReading


@dataclass(frozen=True)
class Introduction:
    """A stepper's calling convention, the kind of its numbers, and the floating-point format in which it works."""

    calls: str
    numbers: str
    format: str


def introduction(subject: ForeignStepper) -> Introduction:
    """Describe the stepper as it was opened."""
    return Introduction(subject.convention.kind, subject.adapter.name, subject.format.name)


def read_coefficients(subject: ForeignStepper) -> CoefficientReading:
    """The stepper's own coefficients: its tableau, read through a right-hand side, or else those that a force shows.

    If the calls are not the stages of an explicit step, they are read as those of an implicit one. A symplectic step of
    y = [q, v] has no tableau, but coefficients on q'' = F(q). These come with the reason against the tableau, since a
    force shows neither times nor the other components.

    If the force of a step is also given the velocities of a Runge-Kutta method's stages, the step has its tableau.

    Raises UnsupportedCall or NotReadable.
    """
    if subject.convention.kind == FIELD:
        try:
            return read_tableau(subject)
        except (NotReadable, Misbehaviour) as refusal:
            return _otherwise(subject, refusal)
    _require_inertia(subject)
    try:
        reading = read_forces(subject)
    except NotReadable as refusal:
        try:
            reading = read_implicit_forces(subject)
        except NotReadable as second:
            if REMEMBERS in refusal.traits:
                raise refusal from None
            both = f"{refusal}; as one with implicit stages: {second}"
            raise NotReadable(both, *refusal.traits, *second.traits) from None
    return _as_tableau(reading, timed=TIME in subject.convention.order and TIME in subject.convention.asks) or reading


def _as_tableau(reading: ForceReading, *, timed: bool) -> TableauReading | None:
    """The tableau A, b, c if the velocities have rows A, the positions A², and b_position is bᵀA; otherwise None."""
    if reading.a_velocity is None or reading.wrong_time:
        return None
    a, b, calls = reading.a_velocity, reading.b_velocity, range(reading.calls)
    for row, node, seen in [*zip(a, reading.c, reading.a, strict=True), (b, reading.drift, reading.b_position)]:
        size = sum(abs(x) * (1 + sum(map(abs, a[k]))) for k, x in enumerate(row))
        allowed = reading.rounding.of(1 + abs(node) + size)
        said = [sum(row[k] * a[k][j] for k in calls) for j in calls]
        if any(abs(x - y) > allowed for x, y in zip((sum(row), *said), (node, *seen), strict=True)):
            return None
    c, solved = reading.c if timed else None, (reading.stage_error, reading.solved)
    return TableauReading(a, b, c, reading.format, reading.remarks, reading.amplitude, *solved)


def _require_inertia(subject: ForeignStepper) -> None:
    """Raise NotReadable unless each component of a vector keeps its velocity without a force: probes see only one."""
    numbers = subject.adapter.together
    allowed = Rounding(subject.format, numbers).of(1.0)
    for i in range(numbers):
        v = unit(numbers, i)
        end = subject.step_forced(lambda t, q: [0.0 * x for x in q], 0.0, [0.0] * numbers, v, 1.0)[numbers:]
        if any(abs(x - y) > allowed for x, y in zip(end, v, strict=True)):
            became = " becomes ".join(f"({', '.join(f'{x:.6g}' for x in numbers)})" for numbers in (v, end))
            raise NotReadable(f"with h = 1 and without a force, the velocity {became}")


def _otherwise(subject: ForeignStepper, refusal: NotReadable | Misbehaviour) -> CoefficientReading:
    """The coefficients with implicit stages, or as a force shows them. Raises the refusal, with the second reason."""
    try:
        return read_implicit_tableau(subject)
    except NotReadable as second:
        if isinstance(refusal, Misbehaviour):
            raise refusal from None
        with suppress(NotReadable, Misbehaviour, UnsupportedCall):  # of a step of one number
            return replace(read_forces(subject), refused=str(refusal))
        other = NotReadable(_OF_ONE) if subject.single else second
        both = f"{refusal}; as one with implicit stages: {other}"
        raise NotReadable(both, *refusal.traits, *other.traits) from None
