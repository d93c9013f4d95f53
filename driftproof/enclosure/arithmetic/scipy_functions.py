"""Functions of SciPy at enclosed numbers: a wave, splines by their parts, and products with sparse matrices."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np

from driftproof.enclosure.arithmetic.array_functions import among, at_enclosed, holds_enclosed
from driftproof.enclosure.arithmetic.data import spline_at
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed, exact_value

# SciPy takes the wave modulo twice this.
_PI = Fraction(np.pi)


def _square(t: Enclosed, duty: Any = 0.5) -> Any:
    """1 on the first part of each period, -1 on the rest."""
    return 1 if t % (2 * _PI) < _part(duty) * 2 * _PI else -1


def _part(given: Any) -> Fraction:
    known = exact_value(given)
    if known is None or not 0 <= known <= 1:
        raise Refused("f gives a wave of scipy.signal a duty that is no constant from 0 to 1")
    return known


def _splev(x: Enclosed, tck: Any, der: int = 0, ext: int = 0) -> Any:
    """A sum of B-splines that is given as its parts, or as an object."""
    if der or ext not in (0, 2):
        raise Refused("f calls splev with der or ext, which has no enclosure; derivatives are those of a CubicSpline")
    return tck(x) if callable(tck) else spline_at(tck, x, ext == 0)


def _of_special(name: str) -> Callable[[Any], Callable[..., Any]]:
    return at_enclosed(lambda x, *more: getattr(x, name)(*more))


# By the public module and the name.
OF_SCIPY = {
    **{("scipy.special", name): _of_special(name) for name in ("erf", "erfc", "expit", "exprel")},
    ("scipy.signal", "square"): at_enclosed(_square),
    ("scipy.interpolate", "splev"): at_enclosed(_splev),
}


def is_sparse(value: Any) -> bool:
    """True for a matrix or an array of scipy.sparse, which is not loaded here."""
    return type(value).__module__.startswith("scipy.sparse") and hasattr(value, "tocoo")


class Sparse:
    """A sparse matrix of doubles or enclosed numbers, which multiplies arrays of either."""

    __array_ufunc__ = None  # so that an array leaves the product to it

    def __init__(self, matrix: Any, numbers: Any = None) -> None:
        """Take a matrix of SciPy, with other numbers in its places if these are given."""
        parts = matrix.tocoo()
        self.shape, self._matrix, self._places = parts.shape, matrix, (parts.row, parts.col)
        self._numbers = parts.data.tolist() if numbers is None else numbers
        self._products = "array" not in type(matrix).__name__  # if * is that of matrices

    def __matmul__(self, x: Any) -> Any:
        x = np.asarray(x)
        if x.shape[0] != self.shape[1]:
            raise ValueError(f"a matrix of {self.shape[1]} columns times {x.shape[0]} rows")
        x = among((x, self._numbers), x)  # or products of doubles would be rounded
        made = np.zeros((self.shape[0], *x.shape[1:]), dtype=object)
        for i, j, a in zip(*self._places, self._numbers, strict=True):
            made[i] = made[i] + a * x[j]
        return made if holds_enclosed(made) else made.astype(float)

    dot = __matmul__

    def __mul__(self, x: Any) -> Any:
        if np.ndim(x) and self._products:
            return self @ x
        if np.ndim(x):
            raise Refused("f multiplies a sparse matrix entry by entry, which has no enclosure; @ has one")
        return Sparse(self._matrix, [a * x for a in self._numbers])

    def __rmul__(self, x: Any) -> Any:
        if np.ndim(x):
            raise Refused("f multiplies a sparse matrix from the left, which has no enclosure; A @ y has one")
        return self * x

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise Refused(f"f uses {name} of a sparse matrix, which has no enclosure; products with @ have one")
