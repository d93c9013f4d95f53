"""The numbers that order conditions are computed in: rationals of FLINT, and elements of a number field over them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Protocol, TypeAlias

from flint import fmpq, fmpq_poly

from driftproof.methods.number_field import Algebraic, Exact, NumberField

# A number of some `Scalars`: it has +, -, * among its kind and with fmpq. FLINT's numbers have no static types.
Number: TypeAlias = Any


class Scalars(Protocol):
    """A ring that holds the rationals, with exact ways in and out."""

    def lift(self, x: Exact | int) -> Number:
        """The number `x` as an element of the ring. Raises TypeError for anything that is not exact."""

    def exact(self, x: Number) -> Exact:
        """The element `x` as a coefficient is written: a Fraction, or an Algebraic."""


@dataclass(frozen=True)
class Rationals:
    """Q, its elements FLINT's fmpq."""

    def lift(self, x: Exact | int) -> Number:
        """The rational as an fmpq. Raises TypeError for a float, or for an irrational number."""
        if isinstance(x, bool) or not isinstance(x, int | Fraction):
            raise TypeError(f"{x!r} ({type(x).__name__}) is no rational; exact arithmetic takes int or Fraction")
        return fmpq(x.numerator, x.denominator)

    def exact(self, x: Number) -> Exact:
        """The fmpq, or an integer, as a Fraction."""
        return _fraction(x)


class FieldElement:
    """A polynomial over Q modulo the minimal polynomial of a field's generator: exact, and fast."""

    __slots__ = ("modulus", "polynomial")

    def __init__(self, polynomial: fmpq_poly, modulus: fmpq_poly) -> None:
        """`polynomial` has a smaller degree than `modulus`."""
        self.polynomial = polynomial
        self.modulus = modulus

    def __add__(self, other: Number) -> FieldElement:
        """The sum, in the field."""
        return FieldElement(self.polynomial + _polynomial(other), self.modulus)

    __radd__ = __add__

    def __sub__(self, other: Number) -> FieldElement:
        """The difference, in the field."""
        return FieldElement(self.polynomial - _polynomial(other), self.modulus)

    def __rsub__(self, other: Number) -> FieldElement:
        """The difference, in the field."""
        return FieldElement(_polynomial(other) - self.polynomial, self.modulus)

    def __neg__(self) -> FieldElement:
        """The negative."""
        return FieldElement(-self.polynomial, self.modulus)

    def __mul__(self, other: Number) -> FieldElement:
        """The product, in the field."""
        if isinstance(other, FieldElement):
            return FieldElement(self.polynomial * other.polynomial % self.modulus, self.modulus)
        return FieldElement(self.polynomial * other, self.modulus)

    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        """Equal as numbers: the polynomials agree, because the modulus is irreducible."""
        return bool(self.polynomial == _polynomial(other))

    def __hash__(self) -> int:
        """Of the coefficients."""
        return hash(tuple(self.polynomial.coeffs()))

    def __bool__(self) -> bool:
        """False for zero."""
        return bool(self.polynomial.degree() >= 0)


@dataclass(frozen=True)
class FieldScalars:
    """Q(α) for the generator α of a number field, its elements polynomials in α."""

    field: NumberField

    @cached_property
    def modulus(self) -> fmpq_poly:
        """The minimal polynomial of α."""
        return fmpq_poly(list(self.field.minimal))

    def lift(self, x: Exact | int) -> Number:
        """The number as a polynomial in α. Raises TypeError for a float, or an element of another field."""
        if not isinstance(x, Algebraic):
            return FieldElement(fmpq_poly([Rationals().lift(x)]), self.modulus)
        if x.field != self.field:
            raise TypeError(f"coefficients in {self.field.name} and in {x.field.name}: give all of them in one field")
        return FieldElement(fmpq_poly([Rationals().lift(y) for y in x.coefficients]), self.modulus)

    def exact(self, x: Number) -> Exact:
        """The number as an Algebraic; as a Fraction where it is rational."""
        coefficients = [_fraction(y) for y in _polynomial(x).coeffs()]
        if len(coefficients) <= 1:
            return coefficients[0] if coefficients else Fraction(0)
        return Algebraic(self.field, tuple(coefficients))


def scalars_for(coefficients: Iterable[Exact | int]) -> Scalars:
    """Q if all coefficients are rational, else the one field in which the others lie. Raises TypeError for two."""
    fields = {x.field: None for x in coefficients if isinstance(x, Algebraic)}
    if len(fields) > 1:
        raise TypeError(f"coefficients in {' and in '.join(field.name for field in fields)}: give all in one field")
    return FieldScalars(next(iter(fields))) if fields else Rationals()


def _fraction(x: Number) -> Fraction:
    return Fraction(int(x.numerator), int(x.denominator))


def _polynomial(x: Any) -> fmpq_poly:
    return x.polynomial if isinstance(x, FieldElement) else fmpq_poly([x])
