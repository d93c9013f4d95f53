"""Families of Runge-Kutta methods with a free parameter, and what holds for them as functions of the parameter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq

from methods.number_field import Exact
from methods.schemes import MethodError, RungeKutta
from symbolic.linear.matrices import characteristic_and_adjugate
from symbolic.linear.polynomials import ONE, Polynomial, X, descend, exact, greatest_common_divisor, quotient, scalar
from symbolic.linear.rational_functions import RationalFunction, fraction
from symbolic.linear.series import exponential


@dataclass(frozen=True)
class Family:
    """The methods with tableau (A, b, c), whose entries are rational functions over Q of one real parameter."""

    key: str
    title: str
    parameter: str
    source: str
    a: tuple[tuple[RationalFunction, ...], ...]
    b: tuple[RationalFunction, ...]
    c: tuple[RationalFunction, ...]

    def member(self, value: Exact) -> RungeKutta:
        """The method at one value of the parameter. Raises MethodError where an entry has a pole."""
        at = scalar(value)
        try:
            a = tuple(tuple(exact(f(at)) for f in row) for row in self.a)
            b, c = (tuple(exact(f(at)) for f in row) for row in (self.b, self.c))
        except ZeroDivisionError:
            raise MethodError(
                f"{self.key}: no method at {self.parameter} = {value}, a pole of its coefficients"
            ) from None
        name = f"{self.key} at {self.parameter} = {value}"
        return RungeKutta(key=name, title=name, claimed_order=0, source=self.source, a=a, b=b, c=c)

    def poles(self) -> Polynomial:
        """The product, up to repetition, of the denominators: it vanishes where the method is not defined."""
        common: Polynomial = ONE
        for entry in (*(f for row in self.a for f in row), *self.b, *self.c):
            common = common * quotient(entry.den, greatest_common_divisor(common, entry.den))
        return common


@dataclass(frozen=True)
class FamilyStability:
    """R(z) = Σ numₖ zᵏ / Σ denₖ zᵏ, the coefficients rational functions of the parameter; den₀ = 1.

    In lowest terms for almost every value; at single values a factor may cancel.
    """

    num: tuple[RationalFunction, ...]
    den: tuple[RationalFunction, ...]

    def taylor(self, terms: int) -> list[RationalFunction]:
        """The first Taylor coefficients at z = 0, as functions of the parameter."""
        found: list[RationalFunction] = []
        for k in range(terms):
            total = self.num[k] if k < len(self.num) else fraction(ONE * 0)
            for j in range(1, min(k, len(self.den) - 1) + 1):
                total = total - self.den[j] * found[k - j]
            found.append(total)
        return found


def family_stability(family: Family) -> FamilyStability:
    """R(z) = det(I - zA + z1bᵀ) / det(I - zA), the coefficients as functions of the parameter."""
    shifted = [[x - y for x, y in zip(row, family.b, strict=True)] for row in family.a]
    return FamilyStability(_determinant(shifted, family.poles()), _determinant(family.a, family.poles()))


def family_error_constant(family: Family) -> tuple[int, RationalFunction]:
    """(power, C) with R(z) - eᶻ = C(parameter) z**power + ..., C not zero; at the roots of C the order is higher."""
    r = family_stability(family)
    terms = len(r.num) + len(r.den) + 1
    for power, (found, wanted) in enumerate(zip(r.taylor(terms), exponential(terms), strict=True)):
        difference = found - fraction(ONE * wanted)
        if difference.num != 0:
            return power, difference
    raise AssertionError("a rational function agrees with exp to finitely many powers")


def _determinant(rows: Sequence[Sequence[RationalFunction]], poles: Polynomial) -> tuple[RationalFunction, ...]:
    """The coefficients of det(I - zA): those of dA, a matrix of polynomials, over the powers of d."""
    scaled = [[descend(x.num * quotient(poles, x.den)) for x in row] for row in rows]
    found = [fraction(c, poles**k) for k, c in enumerate(characteristic_and_adjugate(scaled)[0])]
    while found[-1].num == 0:
        found.pop()
    return tuple(found)


def _constant(x: int | Fraction) -> RationalFunction:
    return fraction(ONE * fmpq(*Fraction(x).as_integer_ratio()))


_T, _NIL, _UNIT, _HALF = fraction(X), _constant(0), _constant(1), _constant(Fraction(1, 2))

# Two equal diagonal entries, order 2 for every gamma, order 3 for gamma = 1/2 ± sqrt(3)/6.
SDIRK_ORDER_2 = Family(
    key="sdirk_order_2",
    title="Two-stage SDIRK methods of order 2",
    parameter="gamma",
    source="hairer-wanner-1996, IV.6",
    a=((_T, _NIL), (_UNIT - _T - _T, _T)),
    b=(_HALF, _HALF),
    c=(_T, _UNIT - _T),
)

# The last stage is the result; order 2 for gamma = 1 ± sqrt(2)/2 only.
SDIRK_STIFFLY_ACCURATE = Family(
    key="sdirk_stiffly_accurate",
    title="Two-stage stiffly accurate SDIRK methods",
    parameter="gamma",
    source="hairer-wanner-1996, IV.6",
    a=((_T, _NIL), (_UNIT - _T, _T)),
    b=(_UNIT - _T, _T),
    c=(_T, _UNIT),
)

# Heun at 1, the midpoint rule at 1/2, Ralston at 2/3.
EXPLICIT_ORDER_2 = Family(
    key="explicit_order_2",
    title="Two-stage explicit methods of order 2",
    parameter="alpha",
    source="butcher-2016, 231",
    a=((_NIL, _NIL), (_T, _NIL)),
    b=(_UNIT - fraction(ONE, 2 * X), fraction(ONE, 2 * X)),
    c=(_NIL, _T),
)

FAMILIES = {family.key: family for family in (SDIRK_ORDER_2, SDIRK_STIFFLY_ACCURATE, EXPLICIT_ORDER_2)}
