"""What a target answers on small problems, to be compared with what is expected of it: no instrument is used."""

from __future__ import annotations

from driftproof.blackbox.stepper.calling_conventions import FIELD, MAP
from driftproof.blackbox.stepper.calling_conventions import TIME as TIME_ARGUMENT
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

Pair = tuple[float, float]
START, TIME = (0.75, 0.5), 0.25
STEPS = tuple(2.0**-k for k in range(1, 7))
DRIVEN, SPRING, OSCILLATOR = "driven", "spring", "oscillator"


def matrix(subject: ForeignStepper) -> tuple[Pair, Pair]:
    """The one-step matrix on the oscillator at h = 1/2, by rows."""
    (a, c), (b, d) = subject.step(1.0, 0.0, 0.5), subject.step(0.0, 1.0, 0.5)
    return (a, b), (c, d)


def answers(subject: ForeignStepper) -> tuple[str, list[Pair]]:
    """The hardest of three problems that the target takes, and one step from START for each h of STEPS.

    DRIVEN is y' = driven(t, y) from TIME, SPRING is q'' = hard_spring(q), OSCILLATOR is q'' = -q.
    """
    if subject.convention.kind == MAP:
        return OSCILLATOR, [_pair(subject.step(*START, h)) for h in STEPS]
    if subject.convention.kind == FIELD and TIME_ARGUMENT in subject.convention.order:
        return DRIVEN, [_pair(subject.step_field(driven, TIME, START, h)) for h in STEPS]
    return SPRING, [_pair(subject.step_with(hard_spring, *START, h)) for h in STEPS]


def format_of(subject: ForeignStepper) -> str:
    """The precision of the target's answers, by name."""
    return subject.format.name


def driven(t, y):
    """A right-hand side that depends on everything; it runs on any kind of number."""
    return [y[1] + t * t / 2, y[0] * y[1] / 4 - y[0] - t * y[0] * y[0]]


def hard_spring(q):
    """A force that is not linear; it runs on any kind of number."""
    return -q - q * q * q / 4


def _pair(answer) -> Pair:
    q, v = answer
    return float(q), float(v)
