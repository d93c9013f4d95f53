"""Polynomials over Q in x and a parameter t, as rows: the coefficients of 1, x, x**2, ..., each a polynomial in t."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeAlias

from flint import fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpq_poly

from driftproof.symbolic.algebra.polynomials import ZERO, Polynomial, Scalar, evaluate, from_scalars, interpolate
from driftproof.symbolic.algebra.rational_functions import polynomial_text, sum_text

Bivariate: TypeAlias = list[Polynomial]

# FLINT's polynomials in several variables: powers of x, then of t.
_RING = fmpq_mpoly_ctx.get(("x", "t"))


def trimmed(rows: Sequence[Polynomial]) -> Bivariate:
    """The same polynomial without leading zeros; [] is zero."""
    end = len(rows)
    while end and rows[end - 1] == 0:
        end -= 1
    return list(rows[:end])


def without_root_zero(rows: Bivariate) -> Bivariate:
    """The polynomial divided by the highest power of x that divides it."""
    return trimmed(trimmed(rows)[::-1])[::-1]


def signed(rows: Bivariate) -> Bivariate:
    """p(-x)."""
    return trimmed([-c if k % 2 else c for k, c in enumerate(rows)])


def add_rows(a: Bivariate, b: Bivariate) -> Bivariate:
    """a + b."""
    size = max(len(a), len(b))
    padded = ([*rows, *[ZERO] * (size - len(rows))] for rows in (a, b))
    return trimmed([x + y for x, y in zip(*padded, strict=True)])


def subtract_rows(a: Bivariate, b: Bivariate) -> Bivariate:
    """a - b."""
    return add_rows(a, [-c for c in b])


def multiply_rows(a: Bivariate, b: Bivariate) -> Bivariate:
    """a b."""
    rows: Bivariate = [ZERO] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            rows[i + j] = rows[i + j] + x * y
    return trimmed(rows)


def rows_modulus_squared(rows: Bivariate) -> Bivariate:
    """|p(iy)|² by powers of x = y²."""
    even, odd = signed(rows[::2]), signed(rows[1::2])
    return add_rows(multiply_rows(even, even), [ZERO, *multiply_rows(odd, odd)])


def inflate(rows: Bivariate) -> Bivariate:
    """p(x**2)."""
    return trimmed([c for row in rows for c in (row, ZERO)])


def at_parameter(rows: Bivariate, value: Scalar) -> Polynomial:
    """The polynomial in x at a value of the parameter."""
    return from_scalars([evaluate(c, value) for c in rows])


def irreducible_factors(rows: Bivariate) -> list[Bivariate]:
    """The factors over Q that are irreducible and not free of x, each once, primitive over Z; of [] none."""
    factors = (_rows(factor) for factor, _ in _flint(rows).factor()[1]) if rows else ()
    return [factor for factor in factors if len(factor) > 1]


def common_divisor(a: Bivariate, b: Bivariate) -> Bivariate:
    """A greatest common divisor over Q, of two that are not zero."""
    return _rows(_flint(a).gcd(_flint(b)))


def divide_rows(a: Bivariate, b: Bivariate) -> Bivariate:
    """a / b for a divisor b of a."""
    return _rows(_flint(a) // _flint(b))


def merging_values(a: Bivariate, b: Bivariate) -> Polynomial | None:
    """A polynomial in t that vanishes wherever the common roots of a and b may change; None if a or b is zero."""
    if not a or not b:
        return None

    def at(value: fmpq) -> tuple[Polynomial, Polynomial]:
        return at_parameter(a, value), at_parameter(b, value)

    first, second = (max(int(c.degree()) for c in rows) for rows in (a, b))
    return critical_polynomial(ParametricPair(at, (len(a) - 1, len(b) - 1), (first, second)))


def slope_in_x(rows: Bivariate) -> Bivariate:
    """The derivative by x."""
    return [c * k for k, c in enumerate(rows)][1:]


def bivariate_text(rows: Bivariate, variable: str, parameter: str) -> str:
    """The polynomial in SymPy's syntax, highest power of x first, e.g. "(1 - 2*gamma)*x - 2"."""
    powers = (k for k in reversed(range(len(rows))) if rows[k] != 0)
    return sum_text(_term(rows[k], k, variable, parameter) for k in powers)


def _term(coefficient: Polynomial, power: int, variable: str, parameter: str) -> str:
    written = polynomial_text(coefficient, parameter)
    if power == 0:
        return f"({written})" if " " in written else written
    monomial = variable if power == 1 else f"{variable}**{power}"
    if written in ("1", "-1"):
        return written[:-1] + monomial
    return f"({written})*{monomial}" if " " in written else f"{written}*{monomial}"


def _flint(rows: Bivariate) -> Any:
    """The polynomial in FLINT's ring of two variables."""
    return _RING.from_dict({(k, j): c for k, row in enumerate(rows) for j, c in enumerate(row.coeffs()) if c != 0})


def _rows(p: Any) -> Bivariate:
    terms = {tuple(map(int, powers)): c for powers, c in p.to_dict().items()}
    reach = max((k for k, _ in terms), default=-1)
    degree = max((j for _, j in terms), default=-1)
    return [fmpq_poly([terms.get((k, j), 0) for j in range(degree + 1)]) for k in range(reach + 1)]


class ParametricPair(NamedTuple):
    """Two polynomials over Q in x at a value of the parameter t, and bounds on their degrees in x and in t."""

    at: Callable[[fmpq], tuple[Polynomial, Polynomial]]
    degrees: tuple[int, int]
    reaches: tuple[int, int]


def critical_polynomial(pair: ParametricPair) -> Polynomial | None:
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
