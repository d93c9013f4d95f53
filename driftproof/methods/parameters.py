"""Rational functions of one free parameter, exact: the entries of a tableau that is a family of methods."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest

from driftproof.methods.number_field import Exact
from driftproof.methods.polynomials import Coefficients, Polynomial, divide, product, trimmed


@dataclass(frozen=True)
class Function:
    """num/den over Q, constant terms first, in lowest terms with den monic: equal functions are equal objects.

    Arithmetic with int, Fraction and its own kind; anything else raises TypeError. Made by `function`.
    """

    num: Polynomial
    den: Polynomial

    @property
    def coefficients(self) -> Polynomial:
        """All coefficients, those of the denominator last."""
        return (*self.num, *self.den)

    def __call__(self, value: Exact) -> Exact:
        """The value at a value of the parameter. Raises ZeroDivisionError at a pole."""
        return _horner(self.num, value) / _horner(self.den, value)

    def __bool__(self) -> bool:
        """False for the function that is zero everywhere."""
        return bool(self.num)

    def __add__(self, other: object) -> Function:
        """The sum."""
        g = _coerced(other)
        crossed = zip_longest(product(self.num, g.den), product(g.num, self.den), fillvalue=Fraction(0))
        return function([x + y for x, y in crossed], product(self.den, g.den))

    __radd__ = __add__

    def __neg__(self) -> Function:
        """The negative."""
        return Function(tuple(-x for x in self.num), self.den)

    def __sub__(self, other: object) -> Function:
        """The difference."""
        return self + -_coerced(other)

    def __rsub__(self, other: object) -> Function:
        """The difference."""
        return -self + other

    def __mul__(self, other: object) -> Function:
        """The product."""
        g = _coerced(other)
        return function(product(self.num, g.num), product(self.den, g.den))

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Function:
        """The quotient. Raises ZeroDivisionError for division by the zero function."""
        return self * _reciprocal(_coerced(other))

    def __rtruediv__(self, other: object) -> Function:
        """The quotient. Raises ZeroDivisionError for division by the zero function."""
        return _reciprocal(self) * other


def function(num: Coefficients, den: Coefficients = (1,)) -> Function:
    """num/den, reduced and normalised. Raises ZeroDivisionError if den is zero."""
    top, bottom = trimmed(num), trimmed(den)
    if not bottom:
        raise ZeroDivisionError("the denominator is the zero polynomial")
    common = _common_divisor(top, bottom)
    top, bottom = divide(top, common)[0], divide(bottom, common)[0]
    return Function(tuple(x / bottom[-1] for x in top), tuple(x / bottom[-1] for x in bottom))


# The parameter itself.
PARAMETER = Function((Fraction(0), Fraction(1)), (Fraction(1),))


def _coerced(x: object) -> Function:
    if isinstance(x, Function):
        return x
    if isinstance(x, int | Fraction) and not isinstance(x, bool):
        return function((x,))
    raise TypeError(f"no exact arithmetic between a function of a parameter and {x!r} ({type(x).__name__})")


def _reciprocal(f: Function) -> Function:
    return function(f.den, f.num)


def _common_divisor(a: Polynomial, b: Polynomial) -> Polynomial:
    """A greatest common divisor, by Euclid's algorithm."""
    while b:
        a, b = b, divide(a, b)[1]
    return a


def _horner(a: Polynomial, x: Exact) -> Exact:
    total: Exact = Fraction(0)
    for c in reversed(a):
        total = total * x + c
    return total
