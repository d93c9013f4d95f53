"""Principal subresultant coefficients of polynomials that depend on a parameter, by values at integers."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from flint import fmpq, fmpq_mat

from driftproof.symbolic.algebra.polynomials import Polynomial, Scalar, interpolate


class Pair(NamedTuple):
    """Two polynomials over Q in x at a value of the parameter t, and bounds on their degrees in x and in t."""

    at: Callable[[fmpq], tuple[Polynomial, Polynomial]]
    degrees: tuple[int, int]
    reaches: tuple[int, int]


def critical_polynomial(pair: Pair) -> Polynomial | None:
    """The first principal subresultant coefficient that is not zero for all t, a polynomial in t; None if all are.

    Where it does not vanish, nor both leading coefficients, the greatest common divisor of the two has one degree, and
    their common roots depend continuously on t (basu-pollack-roy-2006, chapter 4).
    """
    (m, n), (reach, other) = pair.degrees, pair.reaches
    values: list[tuple[Polynomial, Polynomial]] = []
    for index in range(min(m, n) + 1):
        count = (n - index) * reach + (m - index) * other + 1
        values += [pair.at(fmpq(k)) for k in range(len(values), count)]
        found = [_principal_subresultant(p, q, (m, n), index) for p, q in values[:count]]
        if any(found):
            return interpolate(found)
    return None


def _principal_subresultant(p: Polynomial, q: Polynomial, degrees: tuple[int, int], index: int) -> Scalar:
    """The determinant of the shifts xᵏp, k < n - index, and xᵏq, k < m - index, without powers of x below `index`.

    p counts as of degree m and q as of degree n, whatever their leading coefficients: so the determinant is a
    polynomial in the coefficients.
    """
    m, n = degrees
    shifts = [p.left_shift(k) for k in reversed(range(n - index))] + [
        q.left_shift(k) for k in reversed(range(m - index))
    ]
    size, top = len(shifts), m + n - 1 - index
    if not size:
        return fmpq(1)
    return fmpq_mat([[row[top - column] for column in range(size)] for row in shifts]).det()
