"""Matrices of balls in doubles, for what needs few digits: how errors are carried along, and ranges of polynomials.

A sum of N products of doubles, in any order and fused or not, is off by at most γ Σ |a b|, γ = Nu/(1 - Nu), besides
underflows, each of which, to zero or not, loses less than 2⁻¹⁰²². Bounds are sums of such products themselves: they are
taken larger by c = 2(N + 4)u, which is more than γ for the sum, γ for its bound and a few roundings before and after.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

_Array: TypeAlias = NDArray[np.float64]
_U = 2.0**-53
# More than the underflows of some products and sums can lose, for each.
_TINY = 2.0**-1016


class DoubleBalls(NamedTuple):
    """Matrices, the coefficients of a polynomial along the first axis: each entry is within `rad` of `mid`."""

    mid: _Array
    rad: _Array

    @classmethod
    def of(cls, entries: Iterable[arb], *shape: int) -> DoubleBalls:
        """The balls in doubles; what is beyond their range becomes infinite."""
        pairs = np.array([(float(x), float(x.rad())) for x in entries]).reshape(*shape, 2)
        mid, rad = pairs[..., 0], pairs[..., 1]
        return cls(mid, (rad + 4 * _U * np.abs(mid)) * (1 + 4 * _U) + _TINY)

    def sizes(self) -> _Array:
        """Upper bounds of the entries' sizes."""
        return (np.abs(self.mid) + self.rad) * (1 + 4 * _U)

    def less(self, other: DoubleBalls) -> DoubleBalls:
        """The difference from a polynomial that is not longer."""
        mid, rad, k = self.mid.copy(), self.rad.copy(), len(other.mid)
        mid[:k] -= other.mid
        rad[:k] += other.rad
        return DoubleBalls(mid, (rad + 2 * _U * np.abs(mid)) * (1 + 4 * _U) + _TINY)

    def in_arb(self) -> arb_mat:
        """The only matrix, or the first."""
        pairs = zip(self.mid[0].tolist(), self.rad[0].tolist(), strict=True)
        return arb_mat([[arb(*pair) for pair in zip(*rows, strict=True)] for rows in pairs])


def coefficients_in_doubles(matrices: Sequence[arb_mat]) -> DoubleBalls:
    """Matrices of balls in doubles."""
    return DoubleBalls.of(
        (x for m in matrices for x in m.entries()), len(matrices), matrices[0].nrows(), matrices[0].ncols()
    )


def derivative(b: _Array) -> DoubleBalls:
    """The coefficients of the derivative of a polynomial of exact matrices."""
    slopes = b[1:] * np.arange(1.0, len(b))[:, None, None]
    return DoubleBalls(slopes, 2 * _U * np.abs(slopes) + _TINY)


def value_at_one(b: _Array) -> arb_mat:
    """The sum of exact matrices."""
    c = 2 * (len(b) + 4) * _U
    return DoubleBalls(b.sum(axis=0)[None], c * np.abs(b).sum(axis=0)[None] * (1 + c) + _TINY).in_arb()


def norm_of(sizes: _Array) -> arb:
    """The matrix norm that belongs to the maximum norm, of a polynomial for |σ| <= 1, rounded up."""
    return arb(float(summed(sizes, axis=(0, 2)).max()))


def convolved(a: DoubleBalls, b: _Array) -> DoubleBalls:
    """The coefficients of the product of two polynomials; those of the second may have been rounded twice."""

    def convolution(x: _Array, y: _Array) -> _Array:
        made = np.zeros((len(x) + len(y) - 1, x.shape[1], y.shape[2]))
        for i, m in enumerate(x):
            made[i : i + len(y)] += m @ y
        return made

    return _product(convolution, a, b, min(len(a.mid), len(b)) * b.shape[1])


def _product(multiply: Callable[[_Array, _Array], _Array], a: DoubleBalls, b: _Array, terms: int) -> DoubleBalls:
    """Sums of at most so many products of entries of a and of b; one that overflows may be any number."""
    c = 2 * (terms + 4) * _U
    rad = multiply(a.rad + c * np.abs(a.mid), np.abs(b)) * (1 + c) + terms * _TINY
    mid = multiply(a.mid, b)
    return DoubleBalls(mid, np.where(np.isfinite(mid), rad, np.inf))


def summed(sizes: _Array, axis: Any = None) -> Any:
    """An upper bound of a sum of numbers that are not negative."""
    return sizes.sum(axis=axis) * (1 + 2 * (sizes.size + 4) * _U) + sizes.size * _TINY


def ranges(chebyshev: _Array, coefficients: Sequence[arb_mat] | DoubleBalls) -> DoubleBalls:
    """Balls of the entries of Σ C_k σ^k for -1 <= σ <= 1, from coefficients of Chebyshev polynomials.

    Those of the powers would be larger by a factor of up to 1 + sqrt 2 for each power. `chebyshev` maps rows of
    coefficients of powers to coefficients of Chebyshev polynomials; what is beyond its size counts as it is.
    """
    given = coefficients if isinstance(coefficients, DoubleBalls) else coefficients_in_doubles(coefficients)
    rows, sizes = chebyshev[: len(given.mid)], given.sizes()
    first = DoubleBalls(*(x[: len(rows)] for x in given))
    found = _product(lambda x, y: np.tensordot(y, x, axes=(0, 0)), first, rows, len(rows))
    around = [found.rad[:1], found.sizes()[1:], sizes[len(rows) :]]
    return DoubleBalls(found.mid[:1], summed(np.concatenate(around), axis=0)[None])


def bounds(chebyshev: _Array, coefficients: Sequence[arb_mat] | DoubleBalls) -> arb_mat:
    """Upper bounds of the sizes of the entries of Σ C_k σ^k for -1 <= σ <= 1."""
    return arb_mat(ranges(chebyshev, coefficients).sizes()[0].tolist())
