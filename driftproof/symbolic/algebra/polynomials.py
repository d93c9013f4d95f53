"""Polynomials and scalars over Q or over a real number field, with the same functions for both."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeAlias

from flint import acb, acb_poly, arb, arb_poly, fmpq, fmpq_mat, fmpq_poly

from driftproof.methods.numbers.flint_rationals import as_fraction
from driftproof.methods.numbers.number_field import Algebraic, Exact, ScalarExtension

# fmpq_poly over Q, FieldPolynomial over a number field; FLINT has no static types.
Polynomial: TypeAlias = Any
# fmpq, or a FieldPolynomial of degree 0.
Scalar: TypeAlias = Any

X = fmpq_poly([0, 1])
ONE = fmpq_poly([1])
ZERO = fmpq_poly()


class FieldPolynomial(ScalarExtension):
    """A polynomial Σ αⁱ pᵢ(z) over a number field K = Q(α), pᵢ in Q[z]; one of degree 0 is an element of K.

    It has the methods of FLINT's polynomials, and arithmetic with int, fmpq, fmpq_poly and its own kind over K.
    """

    __slots__ = ()

    @staticmethod
    def part(x: object) -> Polynomial:
        """A rational operand as a polynomial over Q. Raises TypeError for any other operand."""
        if isinstance(x, fmpq_poly):
            return x
        if isinstance(x, int | fmpq) and not isinstance(x, bool):
            return fmpq_poly([x])
        raise TypeError

    def degree(self) -> int:
        """The degree in z; -1 for zero."""
        return max(int(p.degree()) for p in self.parts)

    def coeffs(self) -> list[FieldPolynomial]:
        """The coefficients in K, constant term first."""
        return [self[k] for k in range(self.degree() + 1)]

    def leading_coefficient(self) -> FieldPolynomial:
        """The coefficient in K of the highest power of z."""
        return self[self.degree()]

    def __getitem__(self, k: int) -> FieldPolynomial:
        """The coefficient in K of z**k."""
        return FieldPolynomial(self.field, [fmpq_poly([p[k]]) for p in self.parts])

    def derivative(self) -> FieldPolynomial:
        """The derivative with respect to z."""
        return self._map(lambda p: p.derivative())

    def left_shift(self, k: int) -> FieldPolynomial:
        """The product with z**k."""
        return self._map(lambda p: p.left_shift(k))

    def __truediv__(self, other: object) -> FieldPolynomial:
        """The quotient by an element of K. Raises ZeroDivisionError if that is 0."""
        if isinstance(other, int | fmpq):
            return self._map(lambda p: p / other)
        return self * self._coerce(other).inverse()

    def __rtruediv__(self, other: object) -> FieldPolynomial:
        """The quotient of `other` by this element of K. Raises ZeroDivisionError if this is 0."""
        return self._coerce(other) * self.inverse()

    def __divmod__(self, other: object) -> tuple[FieldPolynomial, FieldPolynomial]:
        divisor = self._coerce(other)
        size, inverse = divisor.degree(), divisor.leading_coefficient().inverse()
        quotient, rest = self * 0, self
        while (excess := rest.degree() - size) >= 0:
            term = (rest.leading_coefficient() * inverse).left_shift(excess)
            quotient, rest = quotient + term, rest - term * divisor
        return quotient, rest

    def __floordiv__(self, other: object) -> FieldPolynomial:
        return divmod(self, other)[0]

    def __mod__(self, other: object) -> FieldPolynomial:
        return divmod(self, other)[1]

    def gcd(self, other: object) -> FieldPolynomial:
        """The monic greatest common divisor, by Euclid's algorithm."""
        a, b = self, self._coerce(other)
        while b:
            a, b = b, a % b
        return a / a.leading_coefficient() if a else a

    def inverse(self) -> FieldPolynomial:
        """1/x for an element x of K. Raises ZeroDivisionError for 0, ValueError for a polynomial in z."""
        if self.degree() > 0:
            raise ValueError("only an element of the field has an inverse")
        return field_element(Algebraic(self.field, self.field.inverse([p[0] for p in self.parts])))

    def __repr__(self) -> str:
        """The coefficients, constant term first."""
        return f"{type(self).__name__}({', '.join(str(c.element()) for c in self.coeffs())})"

    def at_ball(self, x: arb) -> arb:
        """A ball around the value at a ball x, at Arb's current precision."""
        alpha, total = self.field.ball(), arb(0)
        for part in reversed(self.parts):
            total = total * alpha + arb_poly(part)(x)
        return total

    def element(self) -> Algebraic:
        """An element of K as exact data of `methods`."""
        return Algebraic(self.field, [p[0] for p in self.parts])

    def norm(self) -> Polynomial:
        """The product of all conjugates, in Q[z]: the determinant of multiplication by this polynomial.

        The roots of the norm are those of this polynomial and of its conjugates.
        """
        rows = list(zip(*(column.parts for column in self.multiples()), strict=True))
        values = lambda k: fmpq_mat([[p(fmpq(k)) for p in row] for row in rows]).det()
        return interpolate(values, self.degree() * len(rows))

    def multiples(self) -> list[FieldPolynomial]:
        """The products with 1, α, α**2, ...: the columns of the matrix of multiplication by this polynomial."""
        found, alpha = [self], FieldPolynomial(self.field, [ZERO, ONE])
        while len(found) < self.field.degree:
            found.append(found[-1] * alpha)
        return found

    def _coerce(self, other: object) -> FieldPolynomial:
        return other if isinstance(other, FieldPolynomial) else FieldPolynomial(self.field, self._parts(other))


def field_element(x: Algebraic) -> FieldPolynomial:
    """`x` as a constant polynomial over its field."""
    return FieldPolynomial(x.field, [fmpq_poly([c]) for c in x.parts])


def scalar(x: Exact | int) -> Scalar:
    """`x` as an exact scalar. Raises TypeError for a float or anything else that is not exact."""
    if isinstance(x, Fraction):
        return fmpq(x.numerator, x.denominator)
    if isinstance(x, int) and not isinstance(x, bool):
        return fmpq(x)
    if isinstance(x, Algebraic):
        return field_element(x)
    raise TypeError(f"{x!r} is {type(x).__name__}; exact arithmetic takes int, Fraction or Algebraic")


def exact(x: Scalar) -> Exact:
    """A scalar as exact data of `methods`: a Fraction, or an Algebraic if it is irrational."""
    if isinstance(x, FieldPolynomial):
        element = x.element()
        return element.as_fraction() if element.is_rational else element
    return as_fraction(x)


def polynomial(coefficients_: Iterable[Exact | int]) -> Polynomial:
    """The polynomial with these coefficients, constant term first."""
    return from_scalars([scalar(c) for c in coefficients_])


def from_scalars(scalars: Sequence[Scalar]) -> Polynomial:
    """The polynomial with these scalars as coefficients, constant term first; over Q if all of them are rational."""
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


def at_complex_ball(p: Polynomial, z: acb) -> acb:
    """A ball around p(z) for a complex ball z, at Arb's current precision."""
    return acb_poly([at_ball(ONE * c, arb(0)) for c in p.coeffs()])(z)


def sign(x: Scalar) -> int:
    """The sign -1, 0 or 1: zero is decided exactly, another irrational by balls that shrink until they exclude zero."""
    return x.element().sign() if isinstance(x, FieldPolynomial) else int(x > 0) - int(x < 0)


def interpolate(values: Callable[[int], fmpq], degree: int) -> Polynomial:
    """The polynomial over Q of degree at most `degree` with these values at 0, 1, ..., `degree` (Newton's formula)."""
    differences = [values(k) for k in range(degree + 1)]
    for order in range(1, len(differences)):
        for k in reversed(range(order, len(differences))):
            differences[k] = (differences[k] - differences[k - 1]) / order
    total = fmpq_poly()
    for k in reversed(range(len(differences))):
        total = total * fmpq_poly([-k, 1]) + differences[k]
    return total


def dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    """The sum Σ aᵢ bᵢ."""
    return sum((x * y for x, y in zip(a, b, strict=True)), fmpq(0))


def norm(p: Polynomial) -> Polynomial:
    """A polynomial over Q that has every root of p: p itself, or the product of its conjugates."""
    return p.norm() if isinstance(p, FieldPolynomial) else p


def reflected(p: Polynomial) -> Polynomial:
    """The polynomial p(-z)."""
    return from_scalars([-c if k % 2 else c for k, c in enumerate(p.coeffs())])


def even_part(p: Polynomial) -> Polynomial:
    """The polynomial e with p(z) = e(z²) + z o(z²)."""
    return from_scalars(p.coeffs()[::2])


def odd_part(p: Polynomial) -> Polynomial:
    """The polynomial o with p(z) = e(z²) + z o(z²)."""
    return from_scalars(p.coeffs()[1::2])


def deflate(p: Polynomial) -> Polynomial:
    """The polynomial e with p(z) = e(z²). Raises ValueError if an odd power occurs."""
    if odd_part(p):
        raise ValueError("the polynomial has an odd power")
    return even_part(p)


def modulus_squared_on_imaginary_axis(p: Polynomial) -> Polynomial:
    """|p(iy)|² as a polynomial in y², for p with real coefficients: e(-y²)² + y² o(-y²)²."""
    even, odd = reflected(even_part(p)), reflected(odd_part(p))
    return descend(even * even + (odd * odd).left_shift(1))


def greatest_common_divisor(p: Polynomial, q: Polynomial) -> Polynomial:
    """The monic greatest common divisor; over the number field if either has coefficients there."""
    if isinstance(q, FieldPolynomial) and not isinstance(p, FieldPolynomial):
        p, q = q, p
    # Euclid's algorithm over the number field needs coefficients of thousands of digits: first look at the norms.
    if isinstance(p, FieldPolynomial) and p and q and norm(p).gcd(norm(q)).degree() == 0:
        return ONE
    return descend(p.gcd(q))


def quotient(p: Polynomial, q: Polynomial) -> Polynomial:
    """p / q for a divisor q of p. Raises ValueError if a remainder is left."""
    if isinstance(q, FieldPolynomial) and not isinstance(p, FieldPolynomial):
        p = q * 0 + p
    result, rest = divmod(p, q)
    if rest:
        raise ValueError("the division leaves a remainder")
    return descend(result)


def squarefree(p: Polynomial) -> Polynomial:
    """The product of the distinct irreducible factors of p, up to a constant."""
    return quotient(p, greatest_common_divisor(p, p.derivative()))


def sign_changes(p: Polynomial) -> int:
    """The number of sign changes of the coefficients, zeros skipped, a bound on that of positive roots (Descartes)."""
    signs = [s for c in p.coeffs() if (s := sign(c))]
    return sum(a != b for a, b in pairwise(signs))
