"""What loops over numbers share: written once, they are run by Python or compiled by numba, with the same bits.

In Python rows are lists of floats, compiled they are arrays; the operations and their order are the same. A loop takes
what it needs as arguments, the functions of the problem among them, and calls the other loops by their names.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from driftproof.numeric.steps.elimination import FULL, Band
from driftproof.numeric.steps.engine import compiled_function

# rate(t, y, f) writes f(t, y) into f; jacobian(t, y, matrix) writes the derivatives into the rows of a band.
RateWriter: TypeAlias = Callable[[float, Any, Any], None]
# zeros(n), zeros(n, m), ...
Allocator: TypeAlias = Callable[..., Any]
_arrays: Allocator = lambda *shape: np.zeros(shape)
_integers: Allocator = lambda *shape: np.zeros(shape, np.int64)


def _lists(n: int, *others: int) -> list[Any]:
    return [_lists(*others) for _ in range(n)] if others else [0.0] * n


class FieldWriters(NamedTuple):
    """The functions that write f and its Jacobian in a band, and those that allocate zeros, `indices` for integers."""

    rate: RateWriter
    jacobian: RateWriter
    band: Band = FULL
    zeros: Allocator = _lists
    indices: Allocator = _lists


def loop(function: Callable[..., Any], *, compiled: bool) -> Callable[..., Any]:
    """The loop as it is or, with all the functions that it calls by name, compiled, which needs the extra `fast`."""
    return _linked(function, compiled_function) if compiled else function


@cache
def _linked(function: Callable[..., Any], compile_: Callable[..., Any]) -> Callable[..., Any]:
    """Numba calls compiled functions only, so that the names of others are bound to compiled ones in a copy."""
    code, names = function.__code__, function.__globals__
    called = {name: value for name in code.co_names if isinstance(value := names.get(name), FunctionType)}
    inner = {name: _linked(value, compile_) for name, value in called.items()}
    bound = FunctionType(code, {**names, **inner}, function.__name__, None, function.__closure__)
    return compile_(bound)  # type: ignore[no-any-return]


def maker_of_rows(*, compiled: bool) -> Callable[[Any], Any]:
    """The function that makes rows from numbers, or from rows: a list or, for compiled loops, an array."""
    return (lambda x: np.array(x, np.float64)) if compiled else list


def allocators(*, compiled: bool) -> tuple[Allocator, Allocator]:
    """The functions that allocate rows of zeros, and of integers: lists or, for compiled loops, arrays."""
    return (loop(_arrays, compiled=True), loop(_integers, compiled=True)) if compiled else (_lists, _lists)
