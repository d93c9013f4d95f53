"""N steps at once: powers of M by squaring, and M to the N in closed form."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, TypeAlias

import sympy
from sympy.polys.matrices import DomainMatrix

from symbolic.certified import enclose
from symbolic.one_step import at_rational, determinant, entries, expression
from symbolic.phase import phase_per_step

# (M_qq, M_qv, M_vq, M_vv) over Fractions or over balls.
Entries: TypeAlias = tuple[Any, Any, Any, Any]
STEPS = sympy.Symbol("n", integer=True)


def matrix_at(m: DomainMatrix, h: Fraction) -> Entries:
    """The entries of M(h) at a rational h, as Fractions."""
    qq, qv, vq, vv = (at_rational(entry, h) for entry in entries(m))
    return qq, qv, vq, vv


def as_balls(matrix: Entries) -> Entries:
    """The entries as Arb balls at the current precision."""
    qq, qv, vq, vv = (enclose(entry) for entry in matrix)
    return qq, qv, vq, vv


def power(matrix: Entries, n: int) -> Entries:
    """matrix**n for n >= 0 by repeated squaring, in the arithmetic of its entries.

    In balls this is what makes long runs possible: stepping n times would widen the radius by (1 + h)**n.
    """
    result: Entries = (1, 0, 0, 1)
    while n:
        if n & 1:
            result = multiply(result, matrix)
        n >>= 1
        if n:
            matrix = multiply(matrix, matrix)
    return result


def short_power(matrix: Entries, n: int, bits: int) -> Entries | None:
    """matrix**n over Fractions, or None once a numerator or denominator on the way is longer than `bits` bits.

    Short powers are not only the small ones: a matrix of finite order has none but short powers.
    """
    result: Entries = (Fraction(1), Fraction(0), Fraction(0), Fraction(1))
    while n:
        if n & 1:
            result = multiply(result, matrix)
        n >>= 1
        if n:
            matrix = multiply(matrix, matrix)
        if max(_length(x) for x in (*result, *matrix)) > bits:
            return None
    return result


def _length(x: Fraction) -> int:
    return max(abs(x.numerator).bit_length(), x.denominator.bit_length())


def multiply(a: Entries, b: Entries) -> Entries:
    """The 2x2 matrix product a b."""
    return (
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
    )


def apply(matrix: Entries, q: Any, v: Any) -> tuple[Any, Any]:
    """The matrix times the column (q, v)."""
    return matrix[0] * q + matrix[1] * v, matrix[2] * q + matrix[3] * v


def closed_form(m: DomainMatrix) -> sympy.ImmutableMatrix:
    """Mⁿ = ρⁿ⁻¹ (sin(nθ) M - ρ sin((n-1)θ) I) / sin θ, with ρ = sqrt(det M): entries in the symbols h and n.

    Holds wherever the two roots are complex, so that 0 < θ < π. By Cayley-Hamilton and induction on n.
    """
    rho, theta = sympy.sqrt(expression(determinant(m))), phase_per_step(m)
    one_step = sympy.Matrix(2, 2, [expression(entry) for entry in entries(m)])
    turned = sympy.sin(STEPS * theta) * one_step - rho * sympy.sin((STEPS - 1) * theta) * sympy.eye(2)
    return sympy.ImmutableMatrix(rho ** (STEPS - 1) * turned / sympy.sin(theta))
