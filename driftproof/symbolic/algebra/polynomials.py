"""Polynomials and scalars over Q or over a real number field, through one set of verbs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeAlias

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from driftproof.methods.number_field import Algebraic, Exact
from driftproof.symbolic.algebra.number_field_polynomials import FieldPolynomial, field_element

# fmpq_poly over Q, FieldPolynomial over a number field; FLINT has no static types.
Polynomial: TypeAlias = Any
# fmpq, or a FieldPolynomial of degree 0.
Scalar: TypeAlias = Any

X = fmpq_poly([0, 1])
ONE = fmpq_poly([1])
ZERO = fmpq_poly()


def scalar(x: Exact | int) -> Scalar:
    """`x` as an exact scalar. Refuses floats and whatever else is not exact."""
    if isinstance(x, Fraction):
        return fmpq(x.numerator, x.denominator)
    if isinstance(x, int) and not isinstance(x, bool):
        return fmpq(x)
    if isinstance(x, Algebraic):
        return field_element(x)
    raise TypeError(f"{x!r} is {type(x).__name__}; exact arithmetic takes int, Fraction or Algebraic")


def exact(x: Scalar) -> Exact:
    """A scalar as exact data of `methods`: a Fraction, or an Algebraic where it is irrational."""
    if isinstance(x, FieldPolynomial):
        element = x.element()
        return (element.coefficients or (Fraction(0),))[0] if element.is_rational else element
    return Fraction(int(x.p), int(x.q))


def polynomial(coefficients_: Iterable[Exact | int]) -> Polynomial:
    """The polynomial with these coefficients, constant term first."""
    return from_scalars([scalar(c) for c in coefficients_])


def from_scalars(scalars: Sequence[Scalar]) -> Polynomial:
    """The polynomial with these scalars as coefficients, constant term first; over Q where all of them are rational."""
    fields = {c.field for c in scalars if isinstance(c, FieldPolynomial)}
    if not fields:
        return fmpq_poly(list(scalars))
    if len(fields) > 1:
        raise TypeError(f"no exact arithmetic between {' and '.join(sorted(f.name for f in fields))}")
    (field,) = fields
    columns = [c.parts if isinstance(c, FieldPolynomial) else (fmpq_poly([c]),) for c in scalars]
    parts = [fmpq_poly([column[i][0] if i < len(column) else 0 for column in columns]) for i in range(field.degree)]
    return descend(FieldPolynomial(field, parts))


def descend(p: Polynomial) -> Polynomial:
    """The same polynomial, over Q if its coefficients are rational."""
    if isinstance(p, FieldPolynomial) and not any(p.parts[1:]):
        return p.parts[0]
    return p


def coefficients(p: Polynomial) -> tuple[Exact, ...]:
    """The coefficients as exact data, constant term first, no trailing zero."""
    return tuple(exact(c) for c in p.coeffs())


def evaluate(p: Polynomial, x: Any) -> Any:
    """p(x) for x in any ring over the coefficients' field, by Horner's rule."""
    total = x * 0
    for c in reversed(p.coeffs()):
        total = total * x + c
    return total


def at_ball(p: Polynomial, x: arb) -> arb:
    """A ball around p(x), at Arb's current precision."""
    return p.at_ball(x) if isinstance(p, FieldPolynomial) else arb_poly(p)(x)


def sign(x: Scalar) -> int:
    """-1, 0 or 1: zero is decided exactly, a nonzero irrational by balls that shrink until they exclude zero."""
    if not isinstance(x, FieldPolynomial):
        return int(x > 0) - int(x < 0)
    if x == 0:
        return 0
    bits = 64
    while True:
        with ctx.workprec(bits):
            ball = x.at_ball(arb(0))
            if ball > 0 or ball < 0:
                return 1 if ball > 0 else -1
        bits *= 2


def dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    """Σ aᵢ bᵢ."""
    total = fmpq(0)
    for x, y in zip(a, b, strict=True):
        total = total + x * y
    return total


def norm(p: Polynomial) -> Polynomial:
    """A polynomial over Q that has every root of p: p itself, or the product of its conjugates."""
    return p.norm() if isinstance(p, FieldPolynomial) else p


def reflected(p: Polynomial) -> Polynomial:
    """p(-z)."""
    return from_scalars([-c if k % 2 else c for k, c in enumerate(p.coeffs())])


def even_part(p: Polynomial) -> Polynomial:
    """The e with p(z) = e(z²) + z o(z²)."""
    return from_scalars(p.coeffs()[::2])


def odd_part(p: Polynomial) -> Polynomial:
    """The o with p(z) = e(z²) + z o(z²)."""
    return from_scalars(p.coeffs()[1::2])


def in_square(p: Polynomial) -> Polynomial:
    """The e with p(z) = e(z²). Raises ValueError if an odd power occurs."""
    if odd_part(p) != 0:
        raise ValueError("an odd power occurs")
    return even_part(p)


def size_on_imaginary_axis(p: Polynomial) -> Polynomial:
    """|p(iy)|² as a polynomial in y², for p with real coefficients: e(-y²)² + y² o(-y²)²."""
    even, odd = reflected(even_part(p)), reflected(odd_part(p))
    return descend(even * even + (odd * odd).left_shift(1))


def greatest_common_divisor(p: Polynomial, q: Polynomial) -> Polynomial:
    """The monic greatest common divisor; over the number field if either has coefficients there."""
    if isinstance(q, FieldPolynomial) and not isinstance(p, FieldPolynomial):
        p, q = q, p
    return descend(p.gcd(q))


def quotient(p: Polynomial, q: Polynomial) -> Polynomial:
    """p / q for a divisor q of p. Raises ValueError if a remainder is left."""
    if isinstance(q, FieldPolynomial) and not isinstance(p, FieldPolynomial):
        p = q * 0 + p
    result, rest = divmod(p, q)
    if rest != 0:
        raise ValueError("the division leaves a remainder")
    return descend(result)


def squarefree(p: Polynomial) -> Polynomial:
    """The product of the distinct irreducible factors of p, up to a constant."""
    return quotient(p, greatest_common_divisor(p, p.derivative()))


def sign_changes(p: Polynomial) -> int:
    """Changes of sign along the coefficients, zeros skipped: an upper bound on the positive roots (Descartes)."""
    signs = [s for c in p.coeffs() if (s := sign(c))]
    return sum(a != b for a, b in pairwise(signs))
