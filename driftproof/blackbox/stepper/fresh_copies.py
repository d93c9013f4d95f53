"""A copy of somebody's stepper as it was before its first step: what it remembers is not shared with the original."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from types import CellType, FunctionType
from typing import Any


def fresh_copy(function: Callable[..., Any]) -> Callable[..., Any] | None:
    """A copy with an object of its own: of a method its object, of a function what it encloses and its defaults.

    What is remembered in a module, or in an attribute of a function that it finds by its name, is shared: whoever
    needs a copy that remembers nothing looks whether two of them begin alike. None where no copy can be made.

    >>> def counter():
    ...     seen = []
    ...     return lambda: seen.append(0) or len(seen)
    >>> count = counter()
    >>> other = fresh_copy(count)
    >>> count(), count(), other()
    (1, 2, 1)
    """
    try:
        return _function_copy(function) if isinstance(function, FunctionType) else deepcopy(function)
    except Exception:  # objects of others may refuse in any way: locks, open files, handles of libraries
        return None


def _function_copy(function: FunctionType) -> FunctionType:
    """A function of the same code and names, with cells and defaults of its own."""
    enclosed, memo = function.__closure__ or (), dict[int, Any]()
    cells = tuple(CellType(deepcopy(cell.cell_contents, memo)) for cell in enclosed)
    defaults = deepcopy(function.__defaults__, memo)
    copied = FunctionType(function.__code__, function.__globals__, function.__name__, defaults, cells)
    copied.__kwdefaults__ = deepcopy(function.__kwdefaults__, memo)
    copied.__dict__.update(function.__dict__)
    copied.__qualname__, copied.__module__ = function.__qualname__, function.__module__
    return copied
