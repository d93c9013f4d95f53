"""Functions of data at an enclosed number: lines between points, bins, and SciPy's splines, with exact coefficients."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import perm
from typing import Any

import numpy as np

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed


def interpolated(
    x: Enclosed,
    xp: Sequence[float],
    fp: Sequence[float],
    left: float | None = None,
    right: float | None = None,
) -> Any:
    """numpy.interp at a number: the line through the two points around x, `left` and `right` beyond the first and last.

    The slope is exact, where NumPy rounds it.
    """
    knots, values = _Exact(xp), _Exact(fp)
    i = bisect_right(knots, x)
    if i == 0:
        return values[0] if left is None else left
    if i == len(knots):
        return values[-1] if right is None or knots[-1] == x else right
    return values[i - 1] + (x - knots[i - 1]) * (values[i] - values[i - 1]) / (knots[i] - knots[i - 1])


def bin_of(x: Enclosed, bins: Sequence[float], right: bool = False) -> int:
    """numpy.digitize at a number: the place of x among edges that rise or fall; an edge is of the bin on its right.

    With `right`, it is of the bin on its left.
    """
    edges = _Exact(bins)
    find = bisect_left if right else bisect_right
    return find(edges, x) if edges[0] <= edges[-1] else len(edges) - find(edges[::-1], x)


def sorted_place(among: Sequence[float], x: Enclosed, side: str = "left") -> int:
    """numpy.searchsorted at a number: how many of the rising numbers are below x, with side "right" not above it."""
    return (bisect_right if side == "right" else bisect_left)(_Exact(among), x)


def spline_of(value: Any) -> Callable[..., Any] | None:
    """The spline of SciPy that a value is, as a function of an enclosed number; None for anything else.

    SciPy is not loaded here. A class that computes its values in its own way has none.
    """
    called = next((kind for kind in type(value).__mro__ if "__call__" in vars(kind)), object)
    if not called.__module__.startswith("scipy.interpolate."):
        return None
    if hasattr(value, "from_spline") and hasattr(value, "extrapolate"):
        return lambda x, *more: _of_pieces(value, x, *more)
    if hasattr(value, "extrapolate") and hasattr(value, "tck"):  # a BSpline
        return lambda x: spline_at(value.tck, x, value.extrapolate)
    if hasattr(value, "bounds_error") and hasattr(value, "_kind"):  # an interp1d, whose kind SciPy gives no other name
        return lambda x: _of_points(value, x)
    return None


def _of_pieces(spline: Any, x: Enclosed, derivative: int = 0) -> Any:
    """A `PPoly` at a number: the polynomial of the piece that x is in, with its coefficients."""
    knots, rows = _Exact(spline.x), _Exact(spline.c)
    if derivative < 0 or knots[0] > knots[-1]:
        raise Refused("f takes an integral of a spline, or a spline whose knots decrease")
    x = _within(x, knots[0], knots[-1], spline.extrapolate)
    i = min(max(bisect_right(knots, x) - 1, 0), len(knots) - 2)
    total, from_knot = 0, x - knots[i]
    for power in reversed(range(derivative, len(rows))):
        total = total * from_knot + rows[len(rows) - 1 - power, i] * perm(power, derivative)
    return total


def spline_at(of: tuple[Any, Any, int], x: Enclosed, extrapolate: Any) -> Any:
    """A sum of B-splines, of knots, coefficients and degree, by de Boor's recursion on the piece that x is in."""
    knots, coefficients, degree = of
    t, count = _Exact(knots), len(knots) - degree - 1
    x = _within(x, t[degree], t[count], extrapolate)
    i = bisect_right(t, x, degree + 1, count) - 1
    d = [*_Exact(coefficients)[i - degree : i + 1]]
    for level in range(1, degree + 1):
        for j in range(degree, level - 1, -1):
            left, right = t[i - degree + j], t[i + 1 + j - level]
            d[j] = d[j - 1] + (x - left) / (right - left) * (d[j] - d[j - 1])
    return d[degree]


def _of_points(table: Any, x: Enclosed) -> Any:
    """An interp1d at a number: by lines, by the values of points that are next to it, or by splines."""
    knots, values = _Exact(table.x), _Exact(table.y)
    if not isinstance(fill := table.fill_value, str):  # "extrapolate"
        below, above = fill if isinstance(fill, tuple) else (fill, fill)
        for beyond, value in ((x < knots[0], below), (x > knots[-1], above)):
            if beyond and table.bounds_error:
                raise Refused("f takes data beyond their ends")
            if beyond:
                return _Exact(np.ravel(value))[0]
    if table._kind == "previous":
        return values[bisect_right(knots, x) - 1]
    if table._kind == "next":
        return values[bisect_left(knots, x)]
    if table._kind.startswith("nearest"):
        half = table.x / 2  # as SciPy rounds
        return values[sorted_place(half[:-1] + half[1:], x, "right" if table._kind == "nearest-up" else "left")]
    of_lines = ([knots[0], *knots, knots[-1]], values, 1)
    return spline_at(of_lines if table._kind == "linear" else table._spline.tck, x, extrapolate=True)


def _within(x: Enclosed, first: Fraction, last: Fraction, extrapolate: Any) -> Any:
    """The number, or that of a period in its place. Raises Refused if it is where the spline has no value."""
    if extrapolate == "periodic":
        return first + (x - first) % (last - first)
    if not extrapolate and (x < first or x > last):
        raise Refused("f takes a spline beyond its ends")
    return x


class _Exact(Sequence[Any]):
    """Doubles as Fractions, which are data and not constants of f; each is converted where it is asked for."""

    def __init__(self, doubles: Any) -> None:
        if np.iscomplexobj(doubles):
            raise Refused("f uses complex data")
        self._doubles = np.asarray(doubles, dtype=float)

    def __len__(self) -> int:
        return len(self._doubles)

    def __getitem__(self, place: Any) -> Any:
        return np.vectorize(Fraction, otypes=[object])(self._doubles[place])[()]
