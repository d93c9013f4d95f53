"""Rational functions of one free parameter, exact: the entries of a tableau that is a family of methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from driftproof.methods.number_field import Algebraic, Exact, as_fmpq, as_fraction

if TYPE_CHECKING:
    from flint import fmpq, fmpq_poly


@dataclass(frozen=True, eq=False)
class Function:
    """num/den over Q in lowest terms, with den monic. Made by `function`.

    Arithmetic with int, Fraction and its own kind; anything else raises TypeError.
    """

    num: fmpq_poly
    den: fmpq_poly

    @property
    def coefficients(self) -> list[fmpq]:
        """All coefficients, those of the denominator last."""
        return [*self.num.coeffs(), *self.den.coeffs()]

    def __call__(self, value: Exact) -> Exact:
        """The value at a value of the parameter. Raises ZeroDivisionError at a pole."""
        x = value if isinstance(value, Algebraic) else as_fmpq(value)
        num, den = 0 * x, 0 * x
        for c in reversed(self.num.coeffs()):
            num = num * x + c
        for c in reversed(self.den.coeffs()):
            den = den * x + c
        found = num / den
        return found if isinstance(found, Algebraic) else as_fraction(found)

    def __eq__(self, other: object) -> bool:
        """The same function of the parameter."""
        return isinstance(other, Function) and bool(self.num == other.num and self.den == other.den)

    def __hash__(self) -> int:
        """By the coefficients."""
        return hash((*self.coefficients,))

    def __bool__(self) -> bool:
        """False for the function that is zero everywhere."""
        return bool(self.num != 0)

    def __add__(self, other: object) -> Function:
        """The sum."""
        g = _coerced(other)
        return function(self.num * g.den + g.num * self.den, self.den * g.den)

    __radd__ = __add__

    def __neg__(self) -> Function:
        """The negative."""
        return Function(-self.num, self.den)

    def __sub__(self, other: object) -> Function:
        """The difference."""
        return self + -_coerced(other)

    def __rsub__(self, other: object) -> Function:
        """The difference."""
        return -self + other

    def __mul__(self, other: object) -> Function:
        """The product."""
        g = _coerced(other)
        return function(self.num * g.num, self.den * g.den)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Function:
        """The quotient. Raises ZeroDivisionError for division by the zero function."""
        g = _coerced(other)
        return self * function(g.den, g.num)

    def __rtruediv__(self, other: object) -> Function:
        """The quotient. Raises ZeroDivisionError for division by the zero function."""
        return _coerced(other) / self


def function(num: fmpq_poly | Sequence[object], den: fmpq_poly | Sequence[object] = (1,)) -> Function:
    """num/den, polynomials or their coefficients, constant term first. Raises ZeroDivisionError if den is zero."""
    from flint import fmpq_poly

    top, bottom = (p if isinstance(p, fmpq_poly) else fmpq_poly([as_fmpq(x) for x in p]) for p in (num, den))
    if bottom == 0:
        raise ZeroDivisionError("the denominator is the zero polynomial")
    common = top.gcd(bottom) * bottom.leading_coefficient()
    return Function(top // common, bottom // common)


def _coerced(x: object) -> Function:
    if isinstance(x, Function):
        return x
    try:
        return function((x,))
    except TypeError:
        kind = type(x).__name__
        raise TypeError(f"no exact arithmetic between a function of a parameter and {x!r} ({kind})") from None
