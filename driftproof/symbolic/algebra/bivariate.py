"""Polynomials over Q in x and a parameter t, as rows: the coefficients of 1, x, x**2, ..., each a polynomial in t."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from flint import fmpq, fmpq_mpoly_ctx, fmpq_poly

from driftproof.symbolic.algebra.polynomials import ZERO, Polynomial, Scalar, evaluate, from_scalars
from driftproof.symbolic.algebra.subresultants import Pair, critical_polynomial
from driftproof.symbolic.algebra.text import polynomial_text, sum_text

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


def total(a: Bivariate, b: Bivariate) -> Bivariate:
    """a + b."""
    size = max(len(a), len(b))
    padded = ([*rows, *[ZERO] * (size - len(rows))] for rows in (a, b))
    return trimmed([x + y for x, y in zip(*padded, strict=True)])


def difference(a: Bivariate, b: Bivariate) -> Bivariate:
    """a - b."""
    return total(a, [-c for c in b])


def product(a: Bivariate, b: Bivariate) -> Bivariate:
    """a b."""
    rows: Bivariate = [ZERO] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            rows[i + j] = rows[i + j] + x * y
    return trimmed(rows)


def size_on_axis(rows: Bivariate) -> Bivariate:
    """|p(iy)|² by powers of x = y²."""
    even, odd = signed(rows[::2]), signed(rows[1::2])
    return total(product(even, even), [ZERO, *product(odd, odd)])


def in_square(rows: Bivariate) -> Bivariate:
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


def quotient(a: Bivariate, b: Bivariate) -> Bivariate:
    """a / b for a divisor b of a."""
    return _rows(_flint(a) // _flint(b))


def merging_values(a: Bivariate, b: Bivariate) -> Polynomial | None:
    """A polynomial in t that vanishes wherever the common roots of a and b may change; None if a or b is zero."""
    if not a or not b:
        return None

    def at(value: fmpq) -> tuple[Polynomial, Polynomial]:
        return at_parameter(a, value), at_parameter(b, value)

    first, second = (max(int(c.degree()) for c in rows) for rows in (a, b))
    return critical_polynomial(Pair(at, (len(a) - 1, len(b) - 1), (first, second)))


def slope(rows: Bivariate) -> Bivariate:
    """The derivative by x."""
    return [c * k for k, c in enumerate(rows)][1:]


def text(rows: Bivariate, variable: str, parameter: str) -> str:
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
