"""The numbers that order conditions are computed in: rationals of FLINT, and elements of a number field over them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol, TypeAlias

from flint import fmpq

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


@dataclass(frozen=True)
class FieldScalars:
    """A number field, its elements Algebraic."""

    field: NumberField

    def lift(self, x: Exact | int) -> Number:
        """The number as an element of the field. Raises TypeError for a float, or an element of another field."""
        if not isinstance(x, Algebraic):
            return Algebraic(self.field, [Rationals().lift(x)])
        if x.field != self.field:
            raise TypeError(f"coefficients in {self.field.name} and in {x.field.name}: give all of them in one field")
        return x

    def exact(self, x: Number) -> Exact:
        """The number as an Algebraic; as a Fraction where it is rational."""
        if not isinstance(x, Algebraic):
            return _fraction(x)
        return x.as_fraction() if x.is_rational else x


def scalars_for(coefficients: Iterable[Exact | int]) -> Scalars:
    """Q if all coefficients are rational, else the one field in which the others lie. Raises TypeError for two."""
    fields = {x.field: None for x in coefficients if isinstance(x, Algebraic)}
    if len(fields) > 1:
        raise TypeError(f"coefficients in {' and in '.join(field.name for field in fields)}: give all in one field")
    return FieldScalars(next(iter(fields))) if fields else Rationals()


def _fraction(x: Number) -> Fraction:
    return Fraction(int(x.numerator), int(x.denominator))
