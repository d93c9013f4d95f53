"""Adapters that write the numbers a stepper takes and read those it returns: Python floats, lists, arrays, ..."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from numbers import Real
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.findings import NotANumber, NothingReturned, StepRaised, UnlikeParts, WrongShape
from driftproof.support.plain_text import counted

# A float, or a number of the arithmetic that an adapter is for.
AnyNumber: TypeAlias = Any
Foreign: TypeAlias = Any


@dataclass(frozen=True)
class ArrayAdapter:
    """A form of numbers: `write` makes the stepper's argument from n numbers, `read` makes n numbers from its answer.

    `number` makes a single number from a float, and `function` turns a Python function into one that the stepper can
    call. `read` raises WrongShape or NotANumber. All are exact, up to the rounding to the stepper's own precision.
    `shown` is the format of the numbers in a line of Python, if this is not a call of `name`. A record has `parts`, the
    names of position and velocity, and maybe `parameters` of its oscillator; `with_parameters` makes it with others.
    `at` makes that of another time, if the record holds one. `together` is how many numbers make one body, one vector
    or one state; 0 if any number does.
    """

    name: str
    write: Callable[[Sequence[AnyNumber]], Foreign]
    read: Callable[[Foreign, int], list[AnyNumber]]
    number: Callable[[float], AnyNumber] = float
    function: Callable[[Callable[..., Foreign]], Callable[..., Foreign]] = lambda function: function
    shown: str = ""
    parts: tuple[str, ...] = ()
    parameters: Mapping[str, float] = field(default_factory=dict, compare=False)
    with_parameters: Callable[[Mapping[str, float]], ArrayAdapter] | None = None
    at: Callable[[float], ArrayAdapter] | None = None
    together: int = 0


def floats_in(value: Foreign, size: int) -> list[float]:
    """The `size` real numbers in a scalar, a sequence or any array, as Python floats.

    Raises WrongShape for another count, and NotANumber for anything that is not real.
    """
    array = as_array(value)
    if array.size != size:
        raise WrongShape(f"{counted(size, 'number')} went in, {array.size} came out (shape {array.shape})")
    return array.astype(float, copy=False).ravel().tolist()


def as_array(value: Foreign) -> np.ndarray[Any, Any]:
    """The value as a NumPy array of real numbers. Raises NotANumber."""
    if value is None:
        raise NothingReturned("it returns None")
    plain = value.detach() if hasattr(value, "detach") else value  # a tensor that records its gradient
    try:
        array = np.asarray(plain)
        if array.dtype == object and all(isinstance(x, Real | Decimal) for x in array.ravel()):
            array = array.astype(float)  # fractions, decimals, numbers of mpmath
    except Exception as error:  # foreign array types may raise anything
        if isinstance(plain, list | tuple) and all(isinstance(x, np.ndarray | float) for x in plain):
            raise UnlikeParts(f"it returns parts of {', '.join(str(np.size(x)) for x in plain)} numbers") from None
        raise NotANumber(f"it returns {type(value).__name__}, which is not read as numbers: {error}") from None
    if array.dtype.kind == "c" and not array.imag.any():
        array = array.real
    if array.dtype.kind not in "fiub":
        raise NotANumber(f"it returns {type(value).__name__} with entries of type {array.dtype}, not real numbers")
    return array


def type_of(value: Foreign) -> str:
    """The type of the value's numbers as its own library names it: float, float64, torch.float32, ..."""
    if isinstance(value, list | tuple) and value:
        return type_of(next(iter(value)))
    return str(getattr(value, "dtype", type(value).__name__))


def one_number(numbers: Sequence[AnyNumber]) -> AnyNumber:
    """The only number of the sequence. Raises WrongShape for another count."""
    if len(numbers) != 1:
        raise WrongShape(f"a scalar holds one number, not {len(numbers)}")
    (number,) = numbers
    return number


class Parted(np.ndarray[Any, Any]):
    """Several numbers that pass for one: their absolute value is the largest, and less means that all of them are."""

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **named: Any) -> Any:
        """The answer; no argument is changed in place, because a single number is not."""
        plain = [np.asarray(x).view(np.ndarray) if isinstance(x, Parted) else x for x in inputs]
        answer = getattr(ufunc, method)(*plain, **{name: x for name, x in named.items() if name != "out"})
        if ufunc in (np.absolute, np.fabs):
            return float(np.max(answer))
        if getattr(answer, "dtype", None) == np.bool_:
            return bool(np.any(answer) if ufunc in (np.greater, np.greater_equal, np.not_equal) else np.all(answer))
        return answer.view(Parted) if np.ndim(answer) else answer


SCALARS = ArrayAdapter("Python floats", lambda numbers: float(one_number(numbers)), floats_in)
ARRAYS = ArrayAdapter("NumPy arrays", lambda numbers: np.array(numbers, dtype=np.float64), floats_in)
PARTED = ArrayAdapter("numbers of parts", lambda numbers: np.array(numbers, float).view(Parted), floats_in)
LISTS = ArrayAdapter("lists", lambda numbers: [float(x) for x in numbers], floats_in)
TUPLES = ArrayAdapter("tuples", lambda numbers: tuple(float(x) for x in numbers), floats_in)


def adapters_of(make: Callable[[Any], Foreign]) -> tuple[ArrayAdapter, ArrayAdapter]:
    """The adapters that call `make` with a list of floats (torch.tensor), and with one float (numpy.float32)."""
    name = f"{getattr(make, '__module__', '')}.{getattr(make, '__name__', 'array')}"

    def made(numbers: Any) -> Foreign:
        try:
            return make(numbers)
        except Exception as error:
            raise StepRaised(f"{name} raises {type(error).__name__}: {error}") from error

    return ArrayAdapter(name, made, floats_in), ArrayAdapter(name, lambda numbers: made(one_number(numbers)), floats_in)
