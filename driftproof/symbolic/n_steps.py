"""N steps at once: powers of M by squaring."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

from flint import arb

from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.linear.oscillator import one_step_matrix as linear_one_step_matrix

if TYPE_CHECKING:
    from sympy.polys.matrices import DomainMatrix

# (M_qq, M_qv, M_vq, M_vv) over Fractions or over balls.
Entries: TypeAlias = tuple[Any, Any, Any, Any]


def matrix_at(m: DomainMatrix, h: Fraction) -> Entries:
    """The entries of M(h) at a rational h, as Fractions."""
    from driftproof.symbolic.derivation.one_step import at_rational, entries  # loads SymPy, which runs have no need of

    qq, qv, vq, vv = (at_rational(entry, h) for entry in entries(m))
    return qq, qv, vq, vv


def exact_matrix_at(method: Method, h: Fraction) -> Entries:
    """(M_qq, M_qv, M_vq, M_vv) at a rational h: rational, or in the number field of the method's coefficients.

    Raises ValueError where M has a pole at h, so that the step has no solution.
    """
    try:
        qq, qv, vq, vv = (exact(entry(scalar(h))) for row in linear_one_step_matrix(method) for entry in row)
    except ZeroDivisionError:
        raise ValueError(f"{method.key} has no step of h = {h}: its one-step matrix has a pole there") from None
    return qq, qv, vq, vv


def exact_flow(start: tuple[Fraction, Fraction], t: Fraction) -> tuple[arb, arb]:
    """(q₀ cos t + v₀ sin t, v₀ cos t - q₀ sin t), the exact state at time t, in balls at the current precision."""
    (q, v), angle = (enclose(x) for x in start), enclose(t)
    c, s = angle.cos(), angle.sin()
    return q * c + v * s, v * c - q * s


def distance(a: tuple[arb, arb], b: tuple[arb, arb]) -> arb:
    """The Euclidean distance of two states in balls."""
    return ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2).sqrt()


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
    """matrix**n over Fractions, or None if an entry is irrational or on the way longer than `bits` bits.

    Short powers are not only the small ones: a matrix of finite order has none but short powers.
    """
    if not all(isinstance(x, Fraction) for x in matrix):
        return None
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
