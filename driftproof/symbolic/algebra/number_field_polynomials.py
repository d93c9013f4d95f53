"""K[z] for a real number field K = Q(α): polynomials with the operators of FLINT's, held as Σ αⁱ pᵢ(z)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any, TypeAlias

from flint import arb, arb_poly, ctx, fmpq, fmpq_mat, fmpq_poly, fmpz_poly

from driftproof.methods.number_field import Algebraic, NumberField

# FLINT's polynomials and rationals carry no static types.
RationalPolynomial: TypeAlias = Any


class FieldPolynomial:
    """The element Σ αⁱ pᵢ(z) of K[z], pᵢ in Q[z], i below the degree of K; of degree 0 in z also K's own elements.

    Arithmetic with int, fmpq, fmpq_poly and its own kind over the same field; mixing fields raises TypeError.
    """

    __slots__ = ("field", "parts")

    def __init__(self, field: NumberField, parts: Sequence[RationalPolynomial]) -> None:
        """Reduce the powers of α from the field's degree on by its minimal polynomial."""
        d = field.degree
        low = [*parts[:d], *(fmpq_poly() for _ in range(d - len(parts)))]
        for high, row in zip(parts[d:], _reductions(field), strict=False):
            low = [p + high * r for p, r in zip(low, row, strict=True)]
        self.field = field
        self.parts: tuple[RationalPolynomial, ...] = tuple(low)

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
        """d/dz."""
        return self._map(lambda p: p.derivative())

    def left_shift(self, k: int) -> FieldPolynomial:
        """Times z**k."""
        return self._map(lambda p: p.left_shift(k))

    def __neg__(self) -> FieldPolynomial:
        """The negative."""
        return self._map(lambda p: -p)

    def __add__(self, other: object) -> FieldPolynomial:
        """The sum."""
        return FieldPolynomial(self.field, [p + q for p, q in zip(self.parts, self._parts(other), strict=True)])

    __radd__ = __add__

    def __sub__(self, other: object) -> FieldPolynomial:
        """The difference."""
        return FieldPolynomial(self.field, [p - q for p, q in zip(self.parts, self._parts(other), strict=True)])

    def __rsub__(self, other: object) -> FieldPolynomial:
        """The difference."""
        return -(self - other)

    def __mul__(self, other: object) -> FieldPolynomial:
        """The product."""
        if isinstance(other, int | fmpq | fmpq_poly):
            return self._map(lambda p: p * other)
        products = [fmpq_poly()] * (2 * len(self.parts) - 1)
        for i, p in enumerate(self.parts):
            for j, q in enumerate(self._parts(other)):
                products[i + j] = products[i + j] + p * q
        return FieldPolynomial(self.field, products)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> FieldPolynomial:
        """The quotient by an element of K. Raises ZeroDivisionError."""
        if isinstance(other, int | fmpq):
            return self._map(lambda p: p / other)
        return self * self._coerce(other).inverse()

    def __rtruediv__(self, other: object) -> FieldPolynomial:
        """The quotient by an element of K. Raises ZeroDivisionError."""
        return self._coerce(other) * self.inverse()

    def __pow__(self, exponent: int) -> FieldPolynomial:
        """A power with exponent >= 0."""
        result = FieldPolynomial(self.field, [fmpq_poly([1])])
        for _ in range(exponent):
            result = result * self
        return result

    def __divmod__(self, other: object) -> tuple[FieldPolynomial, FieldPolynomial]:
        """Quotient and remainder in K[z]."""
        divisor = self._coerce(other)
        size, inverse = divisor.degree(), divisor.leading_coefficient().inverse()
        quotient, rest = self * 0, self
        while (excess := rest.degree() - size) >= 0:
            term = (rest.leading_coefficient() * inverse).left_shift(excess)
            quotient, rest = quotient + term, rest - term * divisor
        return quotient, rest

    def __floordiv__(self, other: object) -> FieldPolynomial:
        """The quotient in K[z]."""
        return divmod(self, other)[0]

    def __mod__(self, other: object) -> FieldPolynomial:
        """The remainder in K[z]."""
        return divmod(self, other)[1]

    def gcd(self, other: object) -> FieldPolynomial:
        """The monic greatest common divisor, by Euclid's algorithm."""
        a, b = self, self._coerce(other)
        while b != 0:
            a, b = b, a % b
        return a / a.leading_coefficient() if a != 0 else a

    def inverse(self) -> FieldPolynomial:
        """1/x for an element x of K. Raises ZeroDivisionError for 0, ValueError for a polynomial in z."""
        if self.degree() > 0:
            raise ValueError("only an element of the field has an inverse")
        if self.degree() < 0:
            raise ZeroDivisionError("division by zero in a number field")
        element = fmpq_poly([p[0] for p in self.parts])
        _, inverse, _ = element.xgcd(_modulus(self.field))
        return FieldPolynomial(self.field, [fmpq_poly([c]) for c in inverse.coeffs()])

    def __eq__(self, other: object) -> bool:
        """Equal as polynomials over the real numbers, exactly."""
        try:
            return self.parts == self._parts(other)
        except TypeError:
            return NotImplemented

    def __call__(self, x: fmpq) -> FieldPolynomial:
        """The value at a rational x, in K."""
        return self._map(lambda p: fmpq_poly([p(x)]))

    def __repr__(self) -> str:
        """The coefficients, constant term first."""
        return f"{type(self).__name__}({', '.join(str(c.element()) for c in self.coeffs())})"

    def at_ball(self, x: arb) -> arb:
        """A ball around the value at a ball x, at Arb's current precision."""
        alpha, total = root_ball(self.field), arb(0)
        for part in reversed(self.parts):
            total = total * alpha + arb_poly(part)(x)
        return total

    def element(self) -> Algebraic:
        """An element of K as exact data of `methods`."""
        return Algebraic(self.field, tuple(Fraction(int(p[0].p), int(p[0].q)) for p in self.parts))

    def norm(self) -> RationalPolynomial:
        """The product of all conjugates, in Q[z]: the determinant of multiplication by this polynomial.

        Every root of this polynomial is one of its norm; the norm has further ones, the roots of the conjugates.
        """
        d = self.field.degree
        alpha = FieldPolynomial(self.field, [fmpq_poly(), fmpq_poly([1])])
        columns = [self]
        for _ in range(d - 1):
            columns.append(columns[-1] * alpha)
        points = self.degree() * d + 1
        values = [_determinant_at(columns, fmpq(k)) for k in range(points)]
        return interpolate(values)

    def _map(self, change: Callable[[RationalPolynomial], RationalPolynomial]) -> FieldPolynomial:
        return FieldPolynomial(self.field, [change(p) for p in self.parts])

    def _coerce(self, other: object) -> FieldPolynomial:
        return other if isinstance(other, FieldPolynomial) else FieldPolynomial(self.field, self._parts(other))

    def _parts(self, other: object) -> Sequence[RationalPolynomial]:
        if isinstance(other, FieldPolynomial):
            if other.field != self.field:
                raise TypeError(f"no exact arithmetic between {self.field.name} and {other.field.name}")
            return other.parts
        if isinstance(other, int | fmpq | fmpq_poly) and not isinstance(other, bool):
            first = other if isinstance(other, fmpq_poly) else fmpq_poly([other])
            return (first, *(fmpq_poly() for _ in self.parts[1:]))
        raise TypeError(f"no exact arithmetic between {self.field.name} and {other!r} ({type(other).__name__})")


def field_element(x: Algebraic) -> FieldPolynomial:
    """`x` as a constant polynomial over its field."""
    return FieldPolynomial(x.field, [fmpq_poly([fmpq(*c.as_integer_ratio())]) for c in x.coefficients])


def root_ball(field: NumberField) -> arb:
    """A ball around α at Arb's current precision."""
    return _root_ball(field, ctx.prec)


def interpolate(values: Sequence[fmpq]) -> RationalPolynomial:
    """The polynomial over Q of degree below n with the given values at 0, 1, ..., n - 1 (Newton's formula)."""
    differences = [fmpq(v) for v in values]
    for order in range(1, len(differences)):
        for k in reversed(range(order, len(differences))):
            differences[k] = (differences[k] - differences[k - 1]) / order
    total = fmpq_poly()
    for k in reversed(range(len(differences))):
        total = total * fmpq_poly([-k, 1]) + differences[k]
    return total


@cache
def _modulus(field: NumberField) -> RationalPolynomial:
    return fmpq_poly(list(field.minimal))


@cache
def _reductions(field: NumberField) -> list[list[fmpq]]:
    """Rows: the coefficients of α**d, α**(d + 1), ..., α**(2d - 2) in 1, α, ..., α**(d - 1)."""
    d, modulus = field.degree, _modulus(field)
    powers = [fmpq_poly([0] * k + [1]) % modulus for k in range(d, 2 * d - 1)]
    return [[power[i] for i in range(d)] for power in powers]


@lru_cache(maxsize=64)
def _root_ball(field: NumberField, bits: int) -> arb:
    low, high = (fmpq(*end.as_integer_ratio()) for end in (field.low, field.high))
    with ctx.workprec(bits):
        balls = [root.real for root, _ in fmpz_poly(list(field.minimal)).complex_roots() if root.imag.is_zero()]
        inside = [ball for ball in balls if ball > arb(low) and ball < arb(high)]
    if len(inside) == 1:
        return inside[0]
    if bits > 1 << 16 or len(inside) > 1:
        raise ValueError(f"{field.name}: the interval must hold exactly one root of its polynomial")
    return _root_ball(field, 2 * bits)


def _determinant_at(columns: Sequence[FieldPolynomial], x: fmpq) -> fmpq:
    d = len(columns)
    entries_ = [[column.parts[i](x) for column in columns] for i in range(d)]
    return fmpq_mat(entries_).det()
