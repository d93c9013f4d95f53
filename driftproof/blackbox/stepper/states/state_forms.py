"""Adapters for other forms of states: complex numbers, batches, bodies, vectors, tensors, arrays of compiled code."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

from driftproof.blackbox.findings import NotANumber, WrongShape
from driftproof.blackbox.stepper.calling_conventions import FIELD, MAP, STATE, CallingConvention
from driftproof.blackbox.stepper.states.array_adapters import (
    AnyNumber,
    ArrayAdapter,
    Foreign,
    as_array,
    floats_in,
    one_number,
)
from driftproof.blackbox.stepper.states.records import adapter_of, further_fields, handed_on, record_of


def forms_of(step: Callable[..., Any], convention: CallingConvention) -> Iterator[ArrayAdapter]:
    """Yield the adapters for other forms of a state that the convention allows, the likeliest first."""
    if convention.kind == MAP and STATE in convention.order:
        alone = lambda state: step(state, 0.25)
        record = record_of(step, alone)
        own = record is not None and not any(record.slopes.values()) and not further_fields(record, alone)
        if record is not None and own and not handed_on(lambda state, t, h: step(state, h), record):
            yield adapter_of(record)
        yield from (COMPLEX, CONJUGATE, BATCH)
    elif convention.kind == FIELD:
        yield BATCH
    else:
        yield from (BODIES, BATCH, *VECTORS, IN_PLANE)
    if torch := sys.modules.get("torch"):
        tensor = partial(torch.tensor, dtype=torch.float64)
        yield from _of_library("torch tensors, torch scalars", tensor, "torch.tensor({}, dtype=torch.float64)")
    if "jax" in sys.modules and convention.kind != MAP:
        array, calling = sys.modules["jax"].numpy.array, CompiledCallback().calling  # for code that is compiled
        yield from _of_library("JAX arrays, JAX scalars", array, "jax.numpy.array({})", function=calling)
    if "numba" in sys.modules and hasattr(step, "py_func") and convention.kind != MAP:
        yield _in_machine_code(sys.modules["numba"])


def _complex(sign: int) -> ArrayAdapter:
    """The adapter of z = q + i v with z' = -i z, or of its conjugate, which turns the other way."""

    def read(value: Foreign, size: int) -> list[AnyNumber]:
        try:
            z = complex(np.asarray(value).item())
        except Exception as error:
            what = f"{type(value).__name__}, which is not read as a complex number"
            raise NotANumber(f"it returns {what}: {error}") from None
        return floats_in([z.real, sign * z.imag], size)

    name, shown = ("q + i v", "complex({}, {})") if sign > 0 else ("q - i v", "complex({}, -{})")
    return ArrayAdapter(f"a complex number {name}", lambda x: complex(x[0], sign * x[1]), read, shown=shown)


# With the wrong one the state turns the other way, which the first trial shows.
COMPLEX, CONJUGATE = _complex(1), _complex(-1)
BATCH = ArrayAdapter(
    "NumPy arrays of rows", lambda x: np.array([x], dtype=np.float64), floats_in, shown="numpy.array([[{}]])"
)


def _first_of(filled: int, value: Foreign, size: int) -> list[AnyNumber]:
    """The first `size` numbers of an array of `filled` numbers; any other array has to hold exactly `size`."""
    array = as_array(value)
    return floats_in(array.ravel()[:size] if array.size == filled else array, size)


def _rows_of(columns: int, name: str) -> ArrayAdapter:
    """The adapter of arrays with this many columns, filled row by row, with 0 for the missing numbers of the last."""

    def write(numbers: Sequence[AnyNumber]) -> Foreign:
        filled = np.zeros((-(-len(numbers) // columns), columns))
        filled.flat[: len(numbers)] = numbers
        return filled

    read = lambda value, size: _first_of(-(-size // columns) * columns, value, size)
    shown = f"numpy.array([[{{}}{', 0.0' * (columns - 1)}]])"
    return ArrayAdapter(name, write, read, shown=shown, together=columns)


BODIES = _rows_of(3, "NumPy arrays of bodies in space")
IN_PLANE = _rows_of(2, "NumPy arrays of bodies in the plane")
WITH_GAPS = ArrayAdapter("arrays with gaps such as y[::2]", lambda x: np.repeat(np.array(x, float), 2)[::2], floats_in)
# States of a right-hand side with two dimensions.
OF_TWO_DIMENSIONS = _rows_of(3, "NumPy arrays of two dimensions")


def columns_of(rows: int) -> ArrayAdapter:
    """The adapter of numbers [q..., v...] as this many rows (q, v)."""
    write = lambda numbers: np.array(numbers, dtype=np.float64).reshape(-1, rows).T
    return ArrayAdapter(BATCH.name, write, lambda value, size: floats_in(as_array(value).T, size))


def _vector(size: int, name: str, first: int, others: Sequence[float]) -> ArrayAdapter:
    """The adapter of one vector of `size` coordinates: those after the `first` ones are the `others` if missing."""

    def write(numbers: Sequence[AnyNumber]) -> Foreign:
        if len(numbers) > size:
            raise WrongShape(f"a vector of {size} numbers holds no {len(numbers)}")
        return np.array([*numbers, *others[len(numbers) - size :][: size - len(numbers)]])

    shown = f"numpy.array([{{}}{''.join(f', {x}' for x in others[first - size :])}])"
    return ArrayAdapter(f"NumPy {name} of {size}", write, partial(_first_of, size), shown=shown, together=size)


# For steps that multiply by a matrix of their own, or take a vector product.
VECTORS = tuple(_vector(size, "vectors", 1, [0.0] * size) for size in (2, 3))
# For steps of a system that has more numbers built in, such as bodies that attract each other.
SYSTEMS = tuple(_vector(size, "arrays", 2, [1 / (i + 2) for i in range(size)]) for size in (*range(3, 11), 12, 13, 18))


def _of_library(names: str, make: Callable[[Any], Foreign], shown: str, **how: Any) -> Iterator[ArrayAdapter]:
    """Yield the adapters of a library's arrays, and of its scalars."""
    arrays, scalars = names.split(", ")
    yield ArrayAdapter(arrays, lambda x: make(list(x)), floats_in, shown=shown.replace("{}", "[{}]"), **how)
    yield ArrayAdapter(scalars, lambda x: make(one_number(x)), floats_in, shown=shown, **how)


# What code compiled by Numba calls at present. Numba copies what a function encloses, but not what a module holds.
_asked: list[Callable[..., Any]] = []


def _called_back(*given: Any) -> np.ndarray[Any, Any]:
    return np.array(_asked[0](*given), dtype=float)


def _in_machine_code(numba: Any) -> ArrayAdapter:
    """The adapter of a step compiled by Numba, whose function has to be compiled as well, once for all calls."""

    @numba.njit
    def compiled(*given):  # type: ignore[no-untyped-def]
        with numba.objmode(answer="float64[::1]"):
            answer = _called_back(*given)
        return answer

    name, write = "NumPy arrays, in code compiled by Numba", lambda numbers: np.array(numbers, dtype=float)
    calling = lambda function: _asked.__setitem__(slice(None), [function]) or compiled
    return ArrayAdapter(name, write, floats_in, function=calling, shown="numpy.array([{}])")


class CompiledCallback:
    """A function for compiled code to call: one object, whatever it calls at present, so that nothing compiles again.

    A step compiled with its right-hand side as a static argument, `jax.jit(step, static_argnums=0)`, is compiled for
    each new one. It calls the right-hand side with tracers instead of numbers, which ordinary Python code cannot use.
    """

    def __init__(self) -> None:
        self.function: Callable[..., Any] | None = None

    def calling(self, function: Callable[..., Any]) -> CompiledCallback:
        """Set the function that this object calls from now on, and return the object."""
        self.function = function
        return self

    def __call__(self, *arguments: Any) -> Any:
        """The function's answer, in the shape and type of the largest argument, which is the state."""
        jax: Any = import_module("jax")
        callbacks: Any = import_module("jax.experimental")
        state = max(map(jax.numpy.asarray, arguments), key=lambda array: array.size)
        shape = jax.ShapeDtypeStruct(state.shape, jax.numpy.result_type(state, jax.numpy.float32))
        return callbacks.io_callback(lambda *given: self._answer(shape, *given), shape, *arguments, ordered=True)

    def _answer(self, shape: Any, *arguments: Any) -> np.ndarray[Any, Any]:
        assert self.function is not None
        plain = [np.asarray(x).item() if np.ndim(x) == 0 else np.asarray(x) for x in arguments]
        return np.asarray(self.function(*plain), dtype=shape.dtype).reshape(shape.shape)
