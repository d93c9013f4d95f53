"""The stepper opened: its door found, the numbers it wants tried out, its precision seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.stepper.dialects import ARRAYS, LISTS, SCALARS, Dialect, dialect_of, dialect_of_scalars
from driftproof.blackbox.stepper.doors import FIELD, MAP, STATE, Door, door_of
from driftproof.blackbox.stepper.subject import Subject, Watch
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat

# Where a stepper is tried out: nothing cancels, and every term of a step is of ordinary size.
TRIAL_STATE, TRIAL_STEP = (1.0, 0.75), 0.25
# The type that an answer's name ends in, the narrowest first.
FORMATS = {"float16": BINARY16, "float32": BINARY32, "float64": BINARY64}


def opened(
    step: Callable[..., Any],
    door: str | None = None,
    array: Callable[[Any], Any] | None = None,
    before: Callable[[str], None] = lambda call: None,
) -> Subject:
    """The stepper as a `Subject`: in the first dialect in which it answers.

    `array` makes the stepper's own numbers of a list of floats (torch.tensor, ...) or of one float (numpy.float32).
    `before` is told of each call before it is made.
    Raises ValueError if no door fits, and the `Misbehaviour` of the most natural dialect if it answers in none.
    """
    found = door_of(step, door)
    failures: list[Misbehaviour] = []
    for trial in (_one_step, _one_number) if found.kind == FIELD else (_one_step,):
        for dialect in _dialects(found, array):
            try:
                return _tried(Subject(step, found, dialect, before=before), trial)
            except Misbehaviour as failure:
                failures.append(failure)
    raise failures[0]


def _dialects(door: Door, array: Callable[[Any], Any] | None) -> Sequence[Dialect]:
    if array is not None:
        return dialect_of(array), dialect_of_scalars(array)
    vectors = door.kind == FIELD or (door.kind == MAP and STATE in door.order)
    return (ARRAYS, LISTS, SCALARS) if vectors else (SCALARS, ARRAYS)


def _one_step(subject: Subject) -> None:
    subject.step(*TRIAL_STATE, TRIAL_STEP)


def _one_number(subject: Subject) -> None:
    """A step of y' = -y, for a stepper that takes no more than one number."""
    subject.step_field(lambda t, y: [-x for x in y], 0.0, TRIAL_STATE[:1], TRIAL_STEP)


def _tried(subject: Subject, trial: Callable[[Subject], None]) -> Subject:
    """The subject after one call, with the format of its answer, and on its watch only whether it works in place."""
    trial(subject)
    subject.format = _format(subject.watch.types)
    # At rest a step written into its arguments changes nothing: that it works in place must be known by then.
    subject.watch = Watch(works_in_place=subject.watch.works_in_place)
    return subject


def _format(types: set[str]) -> FloatFormat:
    return next((fmt for name, fmt in FORMATS.items() if any(t.endswith(name) for t in types)), BINARY64)
