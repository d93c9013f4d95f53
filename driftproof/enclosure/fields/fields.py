"""Running a user's right-hand side on enclosed numbers: its code is unchanged, math and numpy are replaced."""

from __future__ import annotations

import builtins
import math
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from contextvars import ContextVar
from copy import copy
from fractions import Fraction
from functools import partial
from inspect import signature
from types import BuiltinFunctionType, CellType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np
from flint import arb

from driftproof.enclosure.arithmetic.array_functions import MATH, NUMPY, REPLACED, FloatOrEnclosed, array_of, chosen_by
from driftproof.enclosure.arithmetic.clocks import Clock
from driftproof.enclosure.arithmetic.data import spline_of
from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.arithmetic.numbers import OWN_SLOPE, Enclosed, enclosed, size
from driftproof.enclosure.arithmetic.scipy_functions import OF_SCIPY, Sparse, is_sparse
from driftproof.support.plain_text import counted
from driftproof.symbolic.algebra.certified import enclose

# f(t, y) -> y', y being an array; what a user writes.
RightHandSide = Callable[[Any, Any], Any]

# Whether f wrote into its y since this was last set to False.
WRITTEN = ContextVar("f wrote into y", default=False)
# Functions that call each other are followed to this depth, which no right-hand side needs.
_DEEPEST_CALLS = 50
# What ∂f/∂y holds where a rate does not depend on a component.
NO_SLOPE = arb(0)
# Lists and objects within others count for so many of these.
_OF_PARTS = 8


def enclosed_rates(f: RightHandSide, t: Enclosed, y: Sequence[Enclosed]) -> list[Enclosed]:
    """f(t, y) in the arithmetic of its arguments, a number for each component. Raises Refused if f cannot run in it."""
    rates = enclosed_values("f", partial(f, t), y, t.evaluation)
    if len(rates) != len(y):
        raise Refused(f"f returns {len(rates)} numbers for {len(y)} components")
    return rates


def linearised(
    f: RightHandSide, time: Enclosed, y: Sequence[Any], *, slopes: bool = True
) -> tuple[list[Any], list[list[Any]]]:
    """f and, with `slopes`, ∂f/∂y by rows, in the arithmetic of y; constant entries are balls.

    Entries are NO_SLOPE where a rate does not depend on a component.
    """
    state = [Enclosed(time.evaluation, value, {j: OWN_SLOPE} if slopes else None) for j, value in enumerate(y)]
    rates = enclosed_rates(f, time, state)
    rows = [[(rate.partials or {}).get(j, NO_SLOPE) for j in range(len(y))] for rate in rates]
    return [rate.value for rate in rates], rows


def decisions(f: RightHandSide, t: Fraction, y: Sequence[arb], seen: set[float]) -> list[int]:
    """The outcomes of f's comparisons at a point, just after t; the doubles that f reads are added to `seen`."""
    evaluation = Evaluation(doubles=seen, span=(t, None))
    rates = enclosed_rates(f, Clock(evaluation, enclose(t)), [Enclosed(evaluation, x) for x in y])
    for i, rate in enumerate(rates):
        if not rate.value.is_finite():
            raise Refused(f"f is not finite (component {i})")
    return evaluation.taken


def require_the_same(f: RightHandSide, t: Fraction, y: Sequence[arb], before: Sequence[arb]) -> None:
    """Raise Refused if f at a point is certainly no longer what it was `before`, by half of a double's digits."""
    rates, _ = linearised(f, Clock(Evaluation(span=(t, None)), enclose(t)), y, slopes=False)
    least = arb(2) ** -26 * size([*rates, *before, *y])
    for j, (x, now) in enumerate(zip(before, rates, strict=True)):
        if abs(now - x) > least:
            said = f"component {j} at t = {float(t):.9g} was {float(x):.9g} and is {float(now):.9g} in a later call"
            raise Refused(f"f keeps a state from call to call, and so is no function of (t, y): {said}")


def obstacle_ahead(f: RightHandSide, t: Fraction, y: Sequence[arb], h: Fraction) -> Refused | None:
    """What f refuses on a box ahead that the solution needs the time 16 h to leave, or None: a guess for a message."""
    evaluation, ahead = Evaluation(span=(t, None)), enclose(16 * h) * arb(0.5, 0.5)
    try:
        rates = enclosed_rates(f, Clock(evaluation, enclose(t)), [Enclosed(evaluation, x) for x in y])
        box = [Enclosed(evaluation, x + rate.value * ahead) for x, rate in zip(y, rates, strict=True)]
        enclosed_rates(f, Clock(evaluation, enclose(t) + ahead), box)
    except Refused as refusal:
        return refusal
    return None


def enclosed_values(
    name: str, function: Callable[[Any], Any], y: Sequence[Enclosed], evaluation: Evaluation
) -> list[Enclosed]:
    """The values of a user's function of an array, in the arithmetic of y. Raises Refused if it cannot run in it."""
    refusals, given = Refused.made, array_of(y)
    try:
        values = np.asarray(function(given), dtype=object).ravel()
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
        if str(error).startswith("unhashable"):
            raise Refused(
                f"{name} looks numbers up by their value, as in a dict or lru_cache, which has no enclosure"
            ) from None
        said = f"{type(error).__name__}: {' '.join(str(error).split())}"
        said += f"; y has {counted(len(y), 'component')}" if "unpack" in said or "index" in said else ""
        raise Refused(f"{name} fails on enclosed numbers: {said}") from None
    if any(x is not own for x, own in zip(given, y, strict=True)):
        WRITTEN.set(True)
    if Refused.made > refusals:  # floats may take another path
        raise Refused(f"{name} catches the exception by which the enclosure refuses an operation; let it propagate")
    made = (enclosed(evaluation, x) for x in values)
    return [x for each in made for x in (each.ravel() if isinstance(each, np.ndarray) else (each,))]


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
        return MATH
    if value is np:
        return NUMPY
    if value is np.linalg:
        return NUMPY.linalg
    if isinstance(value, BuiltinFunctionType) and getattr(math, str(name), None) is value:
        return getattr(MATH, str(name))
    if isinstance(name, str) and name in REPLACED and getattr(np, name, None) is value:
        return getattr(NUMPY, name)
    if isinstance(value, _OfSciPy | Sparse):
        return value
    home = _home(value)
    if (own := OF_SCIPY.get((home.partition("._")[0], str(name)))) is not None:
        return own(value)
    if spline_of(value) or (home and (isinstance(value, ModuleType) or home.startswith("scipy.interpolate."))):
        return _OfSciPy(value)
    if is_sparse(value):
        return Sparse(value)
    if isinstance(value, MethodType):
        return MethodType(_rebound(value.__func__, known, depth), _rebound_parts(value.__self__, known, depth))
    if isinstance(value, partial):
        given = _rebound_parts(value.args, known, depth), _rebound_parts(value.keywords, known, depth)
        return partial(_rebound(value.func, known, depth), *given[0], **given[1])
    if isinstance(value, FunctionType):
        foreign = (value.__module__ or "").partition(".")[0] in ("numpy", "driftproof")
        return value if foreign or depth > _DEEPEST_CALLS else _rebound_function(value, known, depth)
    made, call = _rebound_parts(value, known, depth), vars(type(value)).get("__call__")
    return MethodType(_rebound(call, known, depth), made) if isinstance(call, FunctionType) else made


def _home(value: Any) -> str:
    """The module of SciPy that the value, its function or its class is of; else an empty string."""
    if isinstance(value, np.ufunc):  # which knows no module
        return "" if getattr(np, value.__name__, None) is value else "scipy.special"
    of = value if hasattr(value, "__name__") else type(value)
    home = str(value.__name__ if isinstance(value, ModuleType) else getattr(of, "__module__", ""))
    return home if home.partition(".")[0] == "scipy" else ""


def _rebound_parts(value: Any, known: dict[int, Any], depth: int) -> Any:
    """A list, a tuple, a dict or an object; a copy of it if something in it has to take enclosed numbers."""
    if id(value) in known or depth > _DEEPEST_CALLS:
        return known.get(id(value), value)
    plain = type(value) in (list, tuple, dict) or hasattr(value, "_fields")
    parts = value if plain else getattr(value, "__dict__", None)
    if not isinstance(parts, list | tuple | dict) or isinstance(value, ModuleType | type):
        return value
    known[id(value)] = changed = value
    held = dict(parts if isinstance(parts, dict) else enumerate(parts))
    made = {key: _rebound(x, known, depth + _OF_PARTS) for key, x in held.items()}
    if any(made[key] is not x for key, x in held.items()):
        if not plain:
            with suppress(Exception):  # of what cannot be copied, as parts of another library
                changed = copy(value)
                vars(changed).update(made if changed is not value else {})  # some are copied as themselves
        elif isinstance(value, dict):
            changed = made
        else:
            changed = getattr(value, "_make", type(value))(made.values())
    known[id(value)] = changed
    return changed


class _OfSciPy:
    """A spline of SciPy, or a module, class or function: what it makes and holds takes enclosed numbers, too."""

    def __init__(self, value: Any) -> None:
        self._value, self._spline = value, spline_of(value)

    @property  # type: ignore[misc]
    def __class__(self) -> Any:
        """The type of what it stands for, of which f may ask."""
        return type(self._value)

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        if self._spline is not None and isinstance(arguments[0], Enclosed):
            return self._spline(*arguments, **options)
        return _rebound(self._value(*arguments, **options), {}, 0)

    def __getattr__(self, name: str) -> Any:
        found = getattr(self._value, name)
        plain = isinstance(found, FunctionType) and (_home(found).partition("._")[0], name) not in OF_SCIPY
        return found if plain else _rebound(found, {}, 0)

    def __instancecheck__(self, x: Any) -> bool:
        return isinstance(x, self._value)


def _rebound_function(f: FunctionType, known: dict[int, Any], depth: int) -> FunctionType:
    # What several functions share, they share as copies: one may write what another reads.
    names = known.setdefault(id(f.__globals__), f.__globals__ | {"__builtins__": _BUILTINS})
    cells = tuple(known.setdefault(id(cell), CellType()) for cell in f.__closure__ or ())
    copy = FunctionType(f.__code__, names, f.__name__, None, cells or None)
    copy.__dict__ = f.__dict__
    known[id(f)] = copy  # before the functions that it calls, which may call it
    copy.__defaults__ = _rebound_parts(f.__defaults__, known, depth)
    copy.__kwdefaults__ = _rebound_parts(f.__kwdefaults__, known, depth)
    for cell, given in zip(cells, f.__closure__ or (), strict=True):
        with suppress(ValueError):  # the cell is empty
            cell.cell_contents = _rebound(given.cell_contents, known, depth + 1)
    for name in _names_of(f.__code__):
        if name in f.__globals__:
            names[name] = _rebound(f.__globals__[name], known, depth + 1)
    return copy


def _names_of(code: Any) -> set[str]:
    """The global names that the code and the functions defined in it may read."""
    inner = [constant for constant in code.co_consts if hasattr(constant, "co_names")]
    return set(code.co_names).union(*(_names_of(each) for each in inner))


def _imported(*arguments: Any, **options: Any) -> Any:
    """What an import in the body of f finds."""
    return _rebound(builtins.__import__(*arguments, **options), {}, 0)


_OWN = {"max": chosen_by(max), "min": chosen_by(min), "float": FloatOrEnclosed, "__import__": _imported}
_BUILTINS = vars(builtins) | _OWN
