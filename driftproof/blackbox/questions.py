"""What the child is asked of a stepper, one experiment each: functions of the opened stepper with picklable answers."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

from driftproof.blackbox.matching.match import Reading
from driftproof.blackbox.probes.force_probe import read_forces
from driftproof.blackbox.probes.probing import NotReadable
from driftproof.blackbox.probes.tableau_probe import read_tableau
from driftproof.blackbox.stepper.doors import FIELD
from driftproof.blackbox.stepper.subject import Subject


@dataclass(frozen=True)
class Introduction:
    """Which door the stepper has, what numbers it takes and gives, and in which format it works."""

    door: str
    numbers: str
    format: str


def introduction(subject: Subject) -> Introduction:
    """The stepper as it was opened."""
    return Introduction(subject.door.kind, subject.dialect.name, subject.format.name)


def coefficients(subject: Subject) -> Reading:
    """The stepper's own coefficients: of its tableau through a right-hand side, else as a force sees them.

    A symplectic step of y = [q, v] has no tableau, but has coefficients on q'' = F(q). Raises NoSuchDoor, NotReadable.
    """
    if subject.door.kind == FIELD:
        try:
            return read_tableau(subject)
        except NotReadable as refusal:
            with suppress(NotReadable):
                return read_forces(subject)
            raise refusal
    return read_forces(subject)
