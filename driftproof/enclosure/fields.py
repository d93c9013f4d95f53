"""Running a user's right-hand side on enclosed numbers: its code is unchanged, math and numpy are replaced."""

from __future__ import annotations

import builtins
import math
import re
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from copy import copy
from functools import partial
from inspect import signature
from types import BuiltinFunctionType, CellType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from driftproof.enclosure.data import bin_of, interpolated, sorted_place, spline_of
from driftproof.enclosure.evaluations import Evaluation, Refused
from driftproof.enclosure.numbers import SELECTING, Enclosed, enclosed
from driftproof.support.plain_text import counted

# f(t, y) -> y', y being an array; what a user writes.
RightHandSide = Callable[[Any, Any], Any]

# The functions of math that NumPy has by the same name, and those that it has by another name.
_SAME = ("sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "expm1", "log1p", "log2", "log10", "cbrt")
_OTHER = {"atan": "arctan", "asin": "arcsin", "acos": "arccos", "atan2": "arctan2", "fabs": "absolute"}
_MATH = {name: name for name in (*_SAME, "hypot", "copysign", "degrees", "radians")} | _OTHER
_FILLED_WITH_FLOATS = ("zeros", "ones", "empty", "full", "zeros_like", "ones_like", "empty_like", "full_like")
_REPLACED = ("array", "asarray", "sign", "interp", "digitize", "searchsorted", *_FILLED_WITH_FLOATS, *SELECTING)
_TO_INTEGERS = ("floor", "ceil", "trunc")
# The answers for enclosed numbers that are finite.
_OF_FINITE = {"isnan": False, "isinf": False, "isfinite": True}
# Functions that call each other are followed to this depth, which no right-hand side needs.
_DEEPEST_CALLS = 50


def enclosed_rates(f: RightHandSide, t: Enclosed, y: Sequence[Enclosed]) -> list[Enclosed]:
    """f(t, y) in the arithmetic of its arguments, a number for each component. Raises Refused if f cannot run in it."""
    rates = enclosed_values("f", partial(f, t), y, t.evaluation)
    if len(rates) != len(y):
        raise Refused(f"f returns {len(rates)} numbers for {len(y)} components")
    return rates


def enclosed_values(
    name: str, function: Callable[[Any], Any], y: Sequence[Enclosed], evaluation: Evaluation
) -> list[Enclosed]:
    """The values of a user's function of an array, in the arithmetic of y. Raises Refused if it cannot run in it."""
    refusals = Refused.made
    try:
        values = np.asarray(function(array_of(y)), dtype=object).ravel()
    except Refused:
        raise
    except Exception as error:  # a user's function may raise anything
        if isinstance(error.__cause__, Refused):  # of a method that NumPy calls for each number of an array
            raise error.__cause__ from None
        if ufunc := re.match(r"ufunc '(\w+)' not supported", str(error)):
            raise Refused(f"{name} uses {ufunc[1]}, which has no enclosure") from None
        if "object arrays are not supported" in str(error):
            has = "numpy.interp and CubicSpline have one"
            raise Refused(f"{name} calls an interpolation that has no enclosure; {has}") from None
        said = f"{type(error).__name__}: {' '.join(str(error).split())}"
        said += f"; y has {counted(len(y), 'component')}" if "unpack" in said or "index" in said else ""
        raise Refused(f"{name} fails on enclosed numbers: {said}") from None
    if Refused.made > refusals:  # floats may take another path
        raise Refused(f"{name} catches the exception by which the enclosure refuses an operation; let it propagate")
    made = (enclosed(evaluation, x) for x in values)
    return [x for each in made for x in (each.ravel() if isinstance(each, np.ndarray) else (each,))]


def array_of(values: Iterable[Any]) -> Any:
    """An array of objects: NumPy would look into balls."""
    listed = list(values)
    made = np.empty(len(listed), dtype=object)
    made[:] = listed
    return made


def time_first(f: RightHandSide) -> RightHandSide:
    """The function itself. Raises ValueError if its parameters are named (y, t), as those of SciPy's odeint are."""
    names = list[str]()
    with suppress(TypeError, ValueError):  # compiled code may have no signature
        names = [*signature(f).parameters][:2]
    if names[1:] in (["t"], ["time"]):
        raise ValueError(f"f takes ({', '.join(names)}), but is called with the time first: give lambda t, y: f(y, t)")
    return f


def enclosable(f: RightHandSide) -> RightHandSide:
    """f with the same code, in which the names of math, numpy and their functions mean our replacements.

    f is a plain function, a method, a partial, or a callable object; functions that it calls are treated alike. Other
    kinds, such as compiled code, are returned as they are, and refused if they do not run on enclosed numbers.
    """
    result: RightHandSide = _rebound(f, {}, 0)
    return result


def _rebound(value: Any, known: dict[int, Any], depth: int) -> Any:
    if id(value) in known:
        return known[id(value)]
    name = getattr(value, "__name__", None)
    if value is math:
        return _MODULE_MATH
    if value is np:
        return _MODULE_NUMPY
    if value is np.linalg:
        return _MODULE_NUMPY.linalg
    if isinstance(value, BuiltinFunctionType) and getattr(math, str(name), None) is value:
        return getattr(_MODULE_MATH, str(name))
    if isinstance(name, str) and name in _REPLACED and getattr(np, name, None) is value:
        return getattr(_MODULE_NUMPY, name)
    if isinstance(value, MethodType):
        return MethodType(_rebound(value.__func__, known, depth), _with_splines(value.__self__))
    if isinstance(value, partial):
        return partial(_rebound(value.func, known, depth), *value.args, **value.keywords)
    if isinstance(value, FunctionType):
        foreign = (value.__module__ or "").partition(".")[0] in ("numpy", "driftproof")
        return value if foreign or depth > _DEEPEST_CALLS else _rebound_function(value, known, depth)
    if (spline := spline_of(value)) is not None:
        return lambda x, *more: spline(x, *more) if isinstance(x, Enclosed) else value(x, *more)
    call = vars(type(value)).get("__call__")
    if isinstance(call, FunctionType):
        return MethodType(_rebound(call, known, depth), _with_splines(value))
    return value


def _with_splines(owner: Any) -> Any:
    """The object itself, or a copy whose splines take enclosed numbers."""
    splines = {name: value for name, value in getattr(owner, "__dict__", {}).items() if spline_of(value)}
    if not splines:
        return owner
    made = copy(owner)
    vars(made).update({name: _rebound(value, {}, 0) for name, value in splines.items()})
    return made


def _rebound_function(f: FunctionType, known: dict[int, Any], depth: int) -> FunctionType:
    # What several functions share, they share as copies: one may write what another reads.
    names = known.setdefault(id(f.__globals__), f.__globals__ | {"__builtins__": _BUILTINS})
    cells = tuple(known.setdefault(id(cell), CellType()) for cell in f.__closure__ or ())
    copy = FunctionType(f.__code__, names, f.__name__, f.__defaults__, cells or None)
    copy.__kwdefaults__, copy.__dict__ = f.__kwdefaults__, f.__dict__
    known[id(f)] = copy  # before the functions that it calls, which may call it
    for cell, given in zip(cells, f.__closure__ or (), strict=True):
        with suppress(ValueError):  # the cell is empty
            cell.cell_contents = _rebound(given.cell_contents, known, depth + 1)
    for name in _names_of(f.__code__):
        if name in names:
            names[name] = _rebound(names[name], known, depth + 1)
    return copy


def _names_of(code: Any) -> set[str]:
    """The global names that the code and the functions defined in it may read."""
    inner = [constant for constant in code.co_consts if hasattr(constant, "co_names")]
    return set(code.co_names).union(*(_names_of(each) for each in inner))


def _holds_enclosed(values: Any) -> bool:
    return any(isinstance(x, Enclosed) for x in np.ravel(values))


def _sign(x: Any) -> Any:
    return enclosed(x.evaluation, x.sign()) if isinstance(x, Enclosed) else np.sign(x)


def _among(given: Any, chosen: Any) -> Any:
    """What is chosen among enclosed numbers, enclosed: a constant stays exact in what f makes of it."""
    held = next((x for each in given for x in np.ravel(each) if isinstance(x, Enclosed)), None)
    return chosen if held is None or isinstance(chosen, tuple | list) else enclosed(held.evaluation, chosen)


def _chosen(choose: Callable[..., Any]) -> Callable[..., Any]:
    """The builtin max or min."""

    def chosen(*arguments: Any, **options: Any) -> Any:
        among = list(arguments[0]) if len(arguments) == 1 else arguments
        return _among(among, choose(among, **options))

    return chosen


def _imported(*arguments: Any, **options: Any) -> Any:
    """What an import in the body of f finds."""
    return _rebound(builtins.__import__(*arguments, **options), {}, 0)


_BUILTINS = vars(builtins) | {"max": _chosen(max), "min": _chosen(min), "__import__": _imported}


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
            return lambda among: sum(given) if _holds_enclosed(given := [*among]) else math.fsum(given)

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
            return lambda x: np.vectorize(partial(_as_finite, name))(x)[()] if _holds_enclosed(x) else value(x)
        if name in SELECTING:
            return lambda *among: _among(among, value(*among))
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
        if not _holds_enclosed(made):
            return np.array(values, dtype=dtype, **options)
        if dtype is not None and np.dtype(dtype) not in (np.dtype(float), np.dtype(object)):
            raise Refused(f"f makes an array of type {np.dtype(dtype)}, which has no enclosure")
        return made

    asarray = array

    @staticmethod
    def clip(x: Any, least: Any, most: Any) -> Any:
        """numpy.clip, of which None for a bound has no enclosure."""
        return _MODULE_NUMPY.minimum(_MODULE_NUMPY.maximum(x, least), most)

    @staticmethod
    def sign(x: Any) -> Any:
        """numpy.sign, whose loop over objects asks three times for what one comparison or two decide."""
        return np.vectorize(_sign, otypes=[object])(x)[()] if _holds_enclosed(x) else np.sign(x)

    @staticmethod
    def interp(x: Any, *points: Any, **options: Any) -> Any:
        """numpy.interp, which enclosed numbers have at a single number."""
        return interpolated(x, *points, **options) if isinstance(x, Enclosed) else np.interp(x, *points, **options)

    @staticmethod
    def digitize(x: Any, *bins: Any, **options: Any) -> Any:
        """numpy.digitize, also at a single enclosed number."""
        return (bin_of if isinstance(x, Enclosed) else np.digitize)(x, *bins, **options)

    @staticmethod
    def searchsorted(a: Any, v: Any, *side: Any, **options: Any) -> Any:
        """numpy.searchsorted, also at a single enclosed number."""
        return (
            sorted_place(a, v, *side, **options) if isinstance(v, Enclosed) else np.searchsorted(a, v, *side, **options)
        )

    class _Linalg(ModuleType):
        """The module numpy.linalg; of its functions, enclosed numbers have the Euclidean norm of a vector only."""

        def __getattr__(self, name: str) -> Any:
            return getattr(np.linalg, name)

        @staticmethod
        def norm(x: Any, *arguments: Any, **options: Any) -> Any:
            if arguments or options or not _holds_enclosed(x):
                return np.linalg.norm(x, *arguments, **options)
            return np.sqrt(sum(each * each for each in np.ravel(x)))

    linalg = _Linalg("numpy.linalg")


_MODULE_MATH, _MODULE_NUMPY = _Math("math"), _Numpy("numpy")
