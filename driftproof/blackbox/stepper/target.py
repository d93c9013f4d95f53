"""A stepper by name, as `package.module:step`, imported; or the callable itself."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.subject import Subject


@dataclass(frozen=True)
class Target:
    """What to examine: a callable or `package.module:name`, its door if it has to be told, its array maker likewise."""

    step: Callable[..., Any] | str
    door: str | None = None
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

    def open(self, before: Callable[[str], None] = lambda call: None) -> Subject:
        """The stepper, imported if need be, behind its door; `before` is told of each call.

        Raises ValueError or a `Misbehaviour`.
        """
        array = None if self.array is None else imported(self.array)
        return opened(imported(self.step), self.door, array, before)


def imported(named: Callable[..., Any] | str) -> Callable[..., Any]:
    """The callable that `package.module:name` names, found from the current directory too; a callable as it is.

    Raises ValueError, in one line, for a text of another form, and for what cannot be imported or called.
    """
    if not isinstance(named, str):
        return named
    module, colon, path = named.partition(":")
    if not (colon and all(part.isidentifier() for part in (*module.split("."), *path.split(".")))):
        raise ValueError(f"{named!r} names no stepper; write package.module:function")
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
