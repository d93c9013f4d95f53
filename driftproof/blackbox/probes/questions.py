"""What a stepper is asked first: how it is called, and which coefficients it has."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TypeAlias

from driftproof.blackbox.findings import Misbehaviour, NoAnswer
from driftproof.blackbox.probes.force import ForceReading, read_forces
from driftproof.blackbox.probes.implicit_tableau import read_implicit_tableau
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.calling_conventions import FIELD
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

CoefficientReading: TypeAlias = TableauReading | ForceReading


@dataclass(frozen=True)
class Introduction:
    """How the stepper is called, what numbers it takes and gives, and in which format it works."""

    calls: str
    numbers: str
    format: str


def introduction(subject: ForeignStepper) -> Introduction:
    """The stepper as it was opened."""
    return Introduction(subject.convention.kind, subject.adapter.name, subject.format.name)


def read_coefficients(subject: ForeignStepper) -> CoefficientReading:
    """The stepper's own coefficients: of its tableau through a right-hand side, else as a force sees them.

    Where calls are not the stages of an explicit step, they are looked for as those of an implicit one. A symplectic
    step of y = [q, v] has no tableau, but has coefficients on q'' = F(q): these come with the refusal of the tableau,
    since a force sees neither times nor other numbers.

    Raises UnsupportedCall, NotReadable.
    """
    if subject.convention.kind == FIELD:
        try:
            return read_tableau(subject)
        except NoAnswer:
            raise
        except (NotReadable, Misbehaviour) as refusal:
            return _otherwise(subject, refusal)
    return read_forces(subject)


def _otherwise(subject: ForeignStepper, refusal: NotReadable | Misbehaviour) -> CoefficientReading:
    """Of implicit stages, or as a force sees them. Raises the refusal, with what is against implicit stages."""
    try:
        return read_implicit_tableau(subject)
    except NotReadable as second:
        if isinstance(refusal, Misbehaviour):
            raise refusal from None
        with suppress(NotReadable):
            return replace(read_forces(subject), refused=str(refusal))
        raise NotReadable(f"{refusal}; as one with implicit stages: {second}") from None
