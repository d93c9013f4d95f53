"""Polynomials over Q in x and a parameter t: rows of coefficients, factors, and where common roots can change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import Any, NamedTuple, TypeAlias

from flint import fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly

from driftproof.symbolic.algebra.polynomials import ZERO, Polynomial, Scalar, evaluate, from_scalars, interpolate
from driftproof.symbolic.algebra.rational_functions import polynomial_text, sum_text

# An element of Q[x, t]; FLINT has no static types.
Bivariate: TypeAlias = Any

_RING = fmpq_mpoly_ctx.get(("x", "t"))
X_OF_TWO, T_OF_TWO = _RING.gens()


def from_rows(rows: Sequence[Polynomial]) -> Bivariate:
    """The polynomial Σ rows[k] x**k, each row being a polynomial in t."""
    return _RING.from_dict({(k, j): c for k, row in enumerate(rows) for j, c in enumerate(row.coeffs())})


def rows_in_x(p: Bivariate) -> list[Polynomial]:
    """The coefficients of 1, x, ..., x**degree as polynomials in t; an empty list for zero."""
    rows = [ZERO] * (degree_in_x(p) + 1)
    for (k, j), c in p.to_dict().items():
        rows[k] += fmpq_poly([c]).left_shift(j)
    return rows


def degree_in_x(p: Bivariate) -> int:
    """The degree in x; -1 for zero."""
    return int(p.degrees()[0])


def degree_in_t(p: Bivariate) -> int:
    """The degree in t; -1 for zero."""
    return int(p.degrees()[1])


def without_root_zero(p: Bivariate) -> Bivariate:
    """The polynomial divided by the highest power of x that divides it."""
    return p // X_OF_TWO ** min((k for k, _ in p.to_dict()), default=0)


def reflected_in_x(p: Bivariate) -> Bivariate:
    """The polynomial p(-x)."""
    return p.compose(-X_OF_TWO, T_OF_TWO)


def even_and_odd_part(p: Bivariate) -> tuple[Bivariate, Bivariate]:
    """The pair (e, o) with p(iy) = e(y²) + iy o(y²), as polynomials in x = y²."""
    rows = rows_in_x(p)
    even, odd = (reflected_in_x(from_rows(rows[start::2])) for start in (0, 1))
    return even, odd


def modulus_squared_in_x(p: Bivariate) -> Bivariate:
    """|p(iy)|² as a polynomial in x = y²."""
    even, odd = even_and_odd_part(p)
    return even * even + X_OF_TWO * odd * odd


def in_square_of_x(p: Bivariate) -> Bivariate:
    """The polynomial p(x**2)."""
    return p.compose(X_OF_TWO**2, T_OF_TWO)


def at_parameter(p: Bivariate, value: Scalar) -> Polynomial:
    """The polynomial in x that p becomes at t = `value`."""
    return from_scalars([evaluate(c, value) for c in rows_in_x(p)])


def irreducible_factors(p: Bivariate) -> list[Bivariate]:
    """The distinct irreducible factors over Q that contain x, primitive over Z; an empty list for zero."""
    return [factor for factor, _ in p.factor()[1] if degree_in_x(factor)]


def merging_values(a: Bivariate, b: Bivariate) -> Polynomial | None:
    """A polynomial in t that vanishes wherever the common roots of a and b may change; None if a or b is zero."""
    if not a or not b:
        return None

    def at(value: fmpq) -> tuple[Polynomial, Polynomial]:
        return at_parameter(a, value), at_parameter(b, value)

    return critical_polynomial(ParametricPair(at, (degree_in_x(a), degree_in_x(b)), (degree_in_t(a), degree_in_t(b))))


def bivariate_text(p: Bivariate, variable: str, parameter: str) -> str:
    """The polynomial in SymPy's syntax, highest power of x first, e.g. "(1 - 2*gamma)*x - 2"."""
    rows = list(enumerate(rows_in_x(p)))[::-1]
    return sum_text(_term(row, k, variable, parameter) for k, row in rows if row)


def _term(coefficient: Polynomial, power: int, variable: str, parameter: str) -> str:
    written = polynomial_text(coefficient, parameter)
    if not power:
        return f"({written})" if " " in written else written
    monomial = variable if power == 1 else f"{variable}**{power}"
    if written in ("1", "-1"):
        return written[:-1] + monomial
    return f"({written})*{monomial}" if " " in written else f"{written}*{monomial}"


class ParametricPair(NamedTuple):
    """Two polynomials over Q in x, given by `at` at each value of t, with bounds on their degrees in x and in t."""

    at: Callable[[fmpq], tuple[Polynomial, Polynomial]]
    degrees: tuple[int, int]
    reaches: tuple[int, int]


def critical_polynomial(pair: ParametricPair) -> Polynomial | None:
    """The first principal subresultant coefficient that is not zero for all t, a polynomial in t; None if all are.

    On an interval of t where it does not vanish, and the two leading coefficients do not vanish together, the greatest
    common divisor has constant degree and the common roots are continuous in t (basu-pollack-roy-2006, chapter 4).
    """
    (m, n), (reach, other) = pair.degrees, pair.reaches
    values = cache(lambda k: pair.at(fmpq(k)))
    for index in range(min(m, n) + 1):
        if found := interpolate(partial(_principal_subresultant, values, pair.degrees, index), n * reach + m * other):
            return found
    return None


def _principal_subresultant(
    values: Callable[[int], tuple[Polynomial, Polynomial]], degrees: tuple[int, int], index: int, k: int
) -> Scalar:
    """The determinant, at t = k, of xⁱp, i < n - index, and xⁱq, i < m - index, without the columns x**j, j < index.

    p is padded to degree m and q to degree n where a leading coefficient vanishes: the determinant then is one
    polynomial in t.
    """
    (p, q), (m, n) = values(k), degrees
    shifts = [p.left_shift(i) for i in reversed(range(n - index))] + [
        q.left_shift(i) for i in reversed(range(m - index))
    ]
    size, top = len(shifts), m + n - 1 - index
    return fmpq_mat(size, size, [row[top - column] for row in shifts for column in range(size)]).det()
