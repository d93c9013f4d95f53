"""The functions of math and NumPy, and some of Python, which also take enclosed numbers and make arrays for them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import lru_cache, partial
from types import ModuleType
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

from driftproof.enclosure.arithmetic.data import bin_of, interpolated, sorted_place
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.arithmetic.numbers import SELECTING, Enclosed, enclosed

# The functions of math that NumPy has by the same name, and those that it has by another name.
_SAME = ("sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "expm1", "log1p", "log2", "log10", "cbrt")
_OTHER = {"atan": "arctan", "asin": "arcsin", "acos": "arccos", "atan2": "arctan2", "fabs": "absolute"}
_MATH = {name: name for name in (*_SAME, "hypot", "copysign", "degrees", "radians")} | _OTHER
_MATH_ALONE = ("erf", "erfc")
_FILLED_WITH_FLOATS = ("zeros", "ones", "empty", "full", "zeros_like", "ones_like", "empty_like", "full_like")
# Of two numbers, of which the first may be a constant.
_OF_TWO = ("hypot", "arctan2")
_OWN = ("array", "asarray", "sign", "interp", "digitize", "searchsorted", "sinc")
REPLACED = (*_OWN, *_FILLED_WITH_FLOATS, *SELECTING, *_OF_TWO)
_TO_INTEGERS = ("floor", "ceil", "trunc")
# The answers for enclosed numbers that are finite.
_OF_FINITE = {"isnan": False, "isinf": False, "isfinite": True}


def array_of(values: Iterable[Any]) -> Any:
    """An array of objects: NumPy would look into balls."""
    listed = list(values)
    made = np.empty(len(listed), dtype=object)
    made[:] = listed
    return made


def holds_enclosed(values: Any) -> bool:
    """True if any of the values is an enclosed number."""
    return any(isinstance(x, Enclosed) for x in np.ravel(values))


def at_enclosed(own: Callable[..., Any]) -> Callable[[Any], Callable[..., Any]]:
    """What makes a function of NumPy or SciPy one that calls our own at an enclosed number, or at each in an array."""

    def made(plain: Any) -> Callable[..., Any]:
        def function(x: Any, *more: Any, **options: Any) -> Any:
            if not isinstance(x, Enclosed) and holds_enclosed(x):
                return np.vectorize(lambda each: function(each, *more, **options), otypes=[object])(x)[()]
            return (own if isinstance(x, Enclosed) else plain)(x, *more, **options)

        return function

    return made


def among(given: Any, chosen: Any) -> Any:
    """What is chosen among enclosed numbers, enclosed: a constant stays exact in what f makes of it."""
    held = next((x for each in given for x in np.ravel(each) if isinstance(x, Enclosed)), None)
    return chosen if held is None or isinstance(chosen, tuple | list) else enclosed(held.evaluation, chosen)


def chosen_by(choose: Callable[..., Any]) -> Callable[..., Any]:
    """The builtin max or min."""

    def chosen(*arguments: Any, **options: Any) -> Any:
        given = list(arguments[0]) if len(arguments) == 1 else arguments
        return among(given, choose(given, **options))

    return chosen


class _Floats(type):
    def __instancecheck__(cls, x: Any) -> bool:
        return isinstance(x, float)

    def __call__(cls, *given: Any) -> Any:
        alone = [x[()] if isinstance(x, np.ndarray) and not x.ndim else x for x in given[:1]]
        return alone[0] if isinstance((*alone, None)[0], Enclosed) else float(*given)

    def __eq__(cls, other: object) -> bool:
        return other is cls or other is float

    def __hash__(cls) -> int:
        return hash(float)


class FloatOrEnclosed(float, metaclass=_Floats):
    """The type float, which leaves an enclosed number as it is: the float of a float is itself."""

    dtype = np.dtype(float)


def _as_finite(name: str, x: Any) -> bool:
    """The answer of isfinite and its like. Raises Refused for a ball that is not finite."""
    if isinstance(x, Enclosed) and not getattr(x.value, "is_finite", bool)():
        raise Refused(f"f takes {name} of a number that may have no value")
    return _OF_FINITE[name]


class _Math(ModuleType):
    """The module math, whose functions also take enclosed numbers."""

    def __getattr__(self, name: str) -> Any:
        plain = getattr(math, name)
        if not callable(plain):
            return plain
        if name == "fsum":
            return lambda among: sum(given) if holds_enclosed(given := [*among]) else math.fsum(given)

        def function(*arguments: Any) -> Any:
            evaluations = [x.evaluation for x in arguments if isinstance(x, Enclosed)]
            if not evaluations:
                return plain(*arguments)
            if name in _TO_INTEGERS:
                return plain(arguments[0])
            if name == "fmod" and isinstance(first := arguments[0], Enclosed):
                return first.fmod(arguments[1])
            if name == "pow":
                return arguments[0] ** arguments[1]
            arguments = tuple(enclosed(evaluations[0], x) for x in arguments)
            if name in _OF_FINITE:
                return _as_finite(name, arguments[0])
            if name in _MATH_ALONE:
                return getattr(arguments[0], name)()
            if name not in _MATH:
                raise Refused(f"f uses math.{name}, which has no enclosure")
            if name == "log" and len(arguments) == 2:
                return arguments[0].log() / arguments[1].log()
            return getattr(np, _MATH[name])(*arguments)

        return function


class _Numpy(ModuleType):
    """The module numpy, whose new arrays can hold enclosed numbers."""

    def __getattr__(self, name: str) -> Any:
        value = getattr(np, name)
        if name in _OF_FINITE:
            return lambda x: np.vectorize(partial(_as_finite, name))(x)[()] if holds_enclosed(x) else value(x)
        if name in SELECTING:
            return lambda *given: among(given, value(*given))
        if name in _OF_TWO:
            return lambda *given: value(*(among(given, x if isinstance(x, Enclosed) else np.asarray(x)) for x in given))
        if name not in _FILLED_WITH_FLOATS:
            return value

        def filled(*arguments: Any, **options: Any) -> Any:
            if options.get("dtype") in (float, np.float64, "float", "float64"):
                del options["dtype"]
            made = value(*arguments, **options)
            return made.astype(object) if made.dtype == float else made

        return filled

    @staticmethod
    def array(values: Any, dtype: Any = None, **options: Any) -> Any:
        """numpy.array, with dtype object if there are enclosed numbers among the values."""
        made = np.array(values, dtype=object, **options)
        if not holds_enclosed(made):
            return np.array(values, dtype=dtype, **options)
        if dtype is not None and np.dtype(dtype) not in (np.dtype(float), np.dtype(object)):
            raise Refused(f"f makes an array of type {np.dtype(dtype)}, which has no enclosure")
        return made

    asarray = array

    @staticmethod
    def clip(x: Any, least: Any, most: Any) -> Any:
        """numpy.clip, of which None for a bound has no enclosure."""
        return NUMPY.minimum(NUMPY.maximum(x, least), most)

    # NumPy's loop of sign over objects asks three times for what one comparison or two decide; sinc wants a type.
    sign = staticmethod(at_enclosed(lambda x: enclosed(x.evaluation, x.sign()))(np.sign))
    sinc = staticmethod(at_enclosed(lambda x: x.sinc())(np.sinc))
    interp = staticmethod(at_enclosed(interpolated)(np.interp))
    digitize = staticmethod(at_enclosed(bin_of)(np.digitize))

    @staticmethod
    def searchsorted(a: Any, v: Any, *side: Any, **options: Any) -> Any:
        """numpy.searchsorted, also at a single enclosed number."""
        return (sorted_place if isinstance(v, Enclosed) else np.searchsorted)(a, v, *side, **options)

    class _Linalg(ModuleType):
        """The module numpy.linalg; of its functions, enclosed numbers have the Euclidean norm, solve and inv."""

        def __getattr__(self, name: str) -> Any:
            return getattr(np.linalg, name)

        @staticmethod
        def norm(x: Any, *arguments: Any, **options: Any) -> Any:
            if arguments or options or not holds_enclosed(x):
                return np.linalg.norm(x, *arguments, **options)
            return np.sqrt(sum(each * each for each in np.ravel(x)))

        @staticmethod
        def solve(a: Any, b: Any) -> Any:
            """numpy.linalg.solve of one system: by the exact inverse of a constant matrix, else by elimination."""
            matrix, right = np.asarray(a), np.asarray(b)
            if not (holds_enclosed(matrix) or holds_enclosed(right)):
                return np.linalg.solve(a, b)
            if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
                raise Refused("f gives numpy.linalg.solve several matrices; solve with one at a time")
            if not holds_enclosed(matrix):
                doubles = np.array(matrix, dtype=float)
                return _inverse(doubles.tobytes(), len(doubles)) @ among([right], right)
            return _eliminated(matrix, right)

        @staticmethod
        def inv(a: Any) -> Any:
            return NUMPY.linalg.solve(a, np.eye(len(a))) if holds_enclosed(a) else np.linalg.inv(a)

    linalg = _Linalg("numpy.linalg")


@lru_cache(maxsize=16)
def _inverse(doubles: bytes, n: int) -> Any:
    """The exact inverse of a matrix of doubles. Raises Refused if it has none."""
    entries = [Fraction(x) for x in np.frombuffer(doubles)]
    try:
        found = fmpq_mat(n, n, [fmpq(x.numerator, x.denominator) for x in entries]).inv()
    except ZeroDivisionError:
        raise Refused("f solves with a matrix that has no inverse") from None
    return array_of(Fraction(int(x.p), int(x.q)) for x in found.entries()).reshape(n, n)


def _eliminated(matrix: Any, right: Any) -> Any:
    """The solution of a system by Gauss's elimination, with the first pivot in a column that is certainly not 0."""
    held = next(x for x in matrix.ravel() if isinstance(x, Enclosed))
    A, b = enclosed(held.evaluation, matrix), enclosed(held.evaluation, right)
    certain: Callable[[Any], bool] = lambda x: any(held.evaluation.is_positive(each.value) for each in (x, -x))
    for k in range(len(A)):
        pivot = next((i for i in range(k, len(A)) if certain(A[i, k])), k)
        A[[k, pivot]], b[[k, pivot]] = A[[pivot, k]], b[[pivot, k]]
        for i in range(k + 1, len(A)):
            factor = A[i, k] / A[k, k]
            A[i, k:], b[i] = A[i, k:] - factor * A[k, k:], b[i] - factor * b[k]
    for k in reversed(range(len(A))):
        b[k] = (b[k] - A[k, k + 1 :] @ b[k + 1 :]) / A[k, k]
    return b


MATH, NUMPY = _Math("math"), _Numpy("numpy")
