"""Rational functions in lowest terms, over Q or over a real number field."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    Scalar,
    coefficients,
    descend,
    evaluate,
    exact,
    greatest_common_divisor,
    quotient,
    reflected,
)


@dataclass(frozen=True)
class RationalFunction:
    """num/den in lowest terms, with den(0) = 1, or den monic where 0 is a pole. Made by `fraction`."""

    num: Polynomial
    den: Polynomial

    def data(self) -> dict[str, list[str]]:
        """{"num": [...], "den": [...]}: the coefficients as strings, constant term first."""
        num, den = ([str(c) for c in coefficients(p)] or ["0"] for p in (self.num, self.den))
        return {"num": num, "den": den}

    def at_infinity(self) -> Exact | None:
        """The limit as the variable grows; None where there is a pole at infinity."""
        excess = self.num.degree() - self.den.degree()
        if excess > 0:
            return None
        return exact(self.num.leading_coefficient() / self.den.leading_coefficient()) if excess == 0 else Fraction(0)

    def __call__(self, x: Scalar) -> Scalar:
        """The value at a scalar. Raises ZeroDivisionError at a pole."""
        return evaluate(self.num, x) / evaluate(self.den, x)

    def __add__(self, other: RationalFunction) -> RationalFunction:
        """The sum."""
        return fraction(self.num * other.den + other.num * self.den, self.den * other.den)

    def __neg__(self) -> RationalFunction:
        """The negative."""
        return RationalFunction(-self.num, self.den)

    def __sub__(self, other: RationalFunction) -> RationalFunction:
        """The difference."""
        return self + -other

    def __mul__(self, other: RationalFunction) -> RationalFunction:
        """The product."""
        return fraction(self.num * other.num, self.den * other.den)


def fraction(num: Polynomial, den: Polynomial = ONE) -> RationalFunction:
    """num/den, reduced and normalised. Raises ZeroDivisionError if den is zero."""
    if den == 0:
        raise ZeroDivisionError("the denominator is the zero polynomial")
    if den.degree() > 0:
        common = greatest_common_divisor(num, den)
        num, den = quotient(num, common), quotient(den, common)
    unit = den[0] if den[0] != 0 else den.leading_coefficient()
    return RationalFunction(descend(num / unit), descend(den / unit))


def reversed_sign(f: RationalFunction) -> RationalFunction:
    """f(-z)."""
    return fraction(reflected(f.num), reflected(f.den))
