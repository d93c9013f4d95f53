"""Copies of a stepper as it was before its first step, which share nothing that it remembers."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from copy import deepcopy
from types import CellType, FunctionType, ModuleType
from typing import Any


def fresh_copy(function: Callable[..., Any]) -> Callable[..., Any] | None:
    """A copy that a run of its own would have: a method gets a copy of its object, a function copies of its closure.

    What is remembered in a module, in a default, or in an attribute of a function found by its name, is still shared,
    as it is by all runs of one process. A caller that needs a copy without memory checks that two copies begin alike.
    Returns None if no copy can be made.

    >>> def counter():
    ...     seen = []
    ...     return lambda: seen.append(0) or len(seen)
    >>> count = counter()
    >>> other = fresh_copy(count)
    >>> count(), count(), other()
    (1, 2, 1)
    """
    try:
        made: Callable[..., Any] = copied(function, {})
    except Exception:  # foreign objects may refuse in any way: locks, open files, handles of libraries
        return None
    return made


def copied(x: Any, memo: dict[int, Any]) -> Any:
    """A copy in which one object, or one variable of several functions, remains one; a module is none of them."""
    if isinstance(x, ModuleType):
        return x
    if not isinstance(x, FunctionType):
        return deepcopy(x, memo)
    if id(x) not in memo:
        cells = tuple(_cell(cell, memo) for cell in x.__closure__ or ())
        memo[id(x)] = made = FunctionType(x.__code__, x.__globals__, x.__name__, x.__defaults__, cells)
        made.__kwdefaults__ = x.__kwdefaults__
        made.__dict__.update(x.__dict__)
    return memo[id(x)]


def _cell(cell: CellType, memo: dict[int, Any]) -> CellType:
    """A copy of an enclosed variable, whose value may be the function itself."""
    if id(cell) not in memo:
        memo[id(cell)] = made = CellType()
        with suppress(ValueError):  # the variable has no value yet
            made.cell_contents = copied(cell.cell_contents, memo)
    found: CellType = memo[id(cell)]
    return found
