"""The stepper opened: its calling convention told, the numbers it wants tried out, its precision seen."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.stepper.array_adapters import (
    ARRAYS,
    LISTS,
    SCALARS,
    ArrayAdapter,
    adapter_of,
    scalar_adapter_of,
)
from driftproof.blackbox.stepper.calling_conventions import FIELD, MAP, STATE, CallingConvention, convention_of
from driftproof.blackbox.stepper.foreign_stepper import CallLog, ForeignStepper
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64

# Where a stepper is tried out: nothing cancels, and every term of a step is of ordinary size.
TRIAL_STATE, TRIAL_STEP = (1.0, 0.75), 0.25
# The type that an answer's name ends in, the narrowest first.
_FORMATS = {"float16": BINARY16, "float32": BINARY32, "float64": BINARY64}


def opened(
    step: Callable[..., Any],
    calls: str | None = None,
    array: Callable[[Any], Any] | None = None,
    before: Callable[[str], None] = lambda call: None,
    after: Callable[[], None] = lambda: None,
) -> ForeignStepper:
    """The stepper as a `ForeignStepper`: in the first adapter in which it answers.

    `array` makes the stepper's own numbers of a list of floats (torch.tensor, ...) or of one float (numpy.float32).
    `before` is told of each call before it is made, `after` hears when it is over.
    Raises ValueError if no calling convention fits, and the `Misbehaviour` of the most natural adapter if none
    gets an answer.
    """
    found = convention_of(step, calls)
    failures: list[Misbehaviour] = []
    for trial in (_one_step, _one_number) if found.kind == FIELD else (_one_step,):
        for adapter in _adapters(found, array):
            try:
                return _tried(ForeignStepper(step, found, adapter, before=before, after=after), trial)
            except Misbehaviour as failure:
                failures.append(failure)
    raise failures[0]


def _adapters(convention: CallingConvention, array: Callable[[Any], Any] | None) -> Sequence[ArrayAdapter]:
    if array is not None:
        return adapter_of(array), scalar_adapter_of(array)
    vectors = convention.kind == FIELD or (convention.kind == MAP and STATE in convention.order)
    return (ARRAYS, LISTS, SCALARS) if vectors else (SCALARS, ARRAYS)


def _one_step(subject: ForeignStepper) -> None:
    subject.step(*TRIAL_STATE, TRIAL_STEP)


def _one_number(subject: ForeignStepper) -> None:
    """A step of y' = -y, for a stepper that takes no more than one number."""
    subject.step_field(lambda t, y: [-x for x in y], 0.0, TRIAL_STATE[:1], TRIAL_STEP)


def _tried(subject: ForeignStepper, trial: Callable[[ForeignStepper], None]) -> ForeignStepper:
    """The subject after one call, with the format of its answer, and on its log only whether it works in place."""
    trial(subject)
    types = subject.log.types
    subject.format = next((fmt for name, fmt in _FORMATS.items() if any(t.endswith(name) for t in types)), BINARY64)
    # At rest a step written into its arguments changes nothing: that it works in place must be known by then.
    subject.log = CallLog(works_in_place=subject.log.works_in_place)
    return subject


@dataclass(frozen=True)
class Target:
    """What to examine: a callable or `package.module:name`, its calls and its arrays if they have to be told."""

    step: Callable[..., Any] | str
    calls: str | None = None
    array: Callable[[Any], Any] | str | None = None

    @property
    def name(self) -> str:
        """What a report calls it."""
        if isinstance(self.step, str):
            return self.step
        module = getattr(self.step, "__module__", None)
        name: str = getattr(self.step, "__qualname__", type(self.step).__name__)
        return f"{module}:{name}" if module else name

    @property
    def by_name(self) -> bool:
        """True when another interpreter can import all of it."""
        return isinstance(self.step, str) and not callable(self.array)

    def open(
        self, before: Callable[[str], None] = lambda call: None, after: Callable[[], None] = lambda: None
    ) -> ForeignStepper:
        """The stepper, imported if need be; `before` and `after` are told of each call.

        Raises ValueError or a `Misbehaviour`.
        """
        array = None if self.array is None else imported(self.array)
        return opened(imported(self.step), self.calls, array, before, after)


def imported(named: Callable[..., Any] | str, what: str = "stepper") -> Callable[..., Any]:
    """The callable that `package.module:name` names, found from the current directory too; a callable as it is.

    Raises ValueError, in one line, for a text of another form, and for what cannot be imported or called.
    """
    if not isinstance(named, str):
        return named
    module, colon, path = named.partition(":")
    if not (colon and all(part.isidentifier() for part in (*module.split("."), *path.split(".")))):
        raise ValueError(f"{named!r} names no {what}; write package.module:function")
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())
    try:
        found: Any = import_module(module)
        for part in path.split("."):
            found = getattr(found, part)
    except Exception as error:  # a foreign module raises what it likes when it is imported
        raise ValueError(f"{named} cannot be imported: {type(error).__name__}: {error}") from error
    if not callable(found):
        raise ValueError(f"{named} is {type(found).__name__}, which cannot be called")
    function: Callable[..., Any] = found
    return function
