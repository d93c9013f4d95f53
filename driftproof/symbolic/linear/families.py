"""R(z) and the error constant of a family of Runge-Kutta methods, as functions of its parameter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from driftproof.methods.families import Family
from driftproof.methods.parameters import Function
from driftproof.symbolic.algebra.bivariate import Bivariate, common_divisor, quotient
from driftproof.symbolic.algebra.matrices import characteristic_and_adjugate
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    ZERO,
    Polynomial,
    descend,
    greatest_common_divisor,
)
from driftproof.symbolic.algebra.polynomials import quotient as polynomial_quotient
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.series import exponential

NIL = fraction(ZERO)


@dataclass(frozen=True)
class FamilyStability:
    """R(z) = P/Q, in lowest terms over Q(parameter): rows by powers of z, polynomials in the parameter.

    At single values of the parameter a further factor may cancel; at roots of `den[0]` there may be no method.
    """

    num: Bivariate
    den: Bivariate

    def coefficients(self) -> tuple[list[RationalFunction], list[RationalFunction]]:
        """The coefficients of numerator and denominator as functions of the parameter, the first of the latter 1."""
        num, den = ([fraction(c, self.den[0]) for c in rows] for rows in (self.num, self.den))
        return num, den

    def taylor(self, terms: int) -> list[RationalFunction]:
        """The first Taylor coefficients at z = 0, as functions of the parameter."""
        num, den = self.coefficients()
        found: list[RationalFunction] = []
        for k in range(terms):
            total = num[k] if k < len(num) else NIL
            for j in range(1, min(k, len(den) - 1) + 1):
                total = total - den[j] * found[k - j]
            found.append(total)
        return found


def poles(family: Family) -> Polynomial:
    """The least common multiple of the denominators of all entries: it vanishes where the method is not defined."""
    common: Polynomial = ONE
    for entry in (*(f for row in family.a for f in row), *family.b, *family.c):
        common = common * polynomial_quotient(entry.den, greatest_common_divisor(common, entry.den))
    return common


def cleared(entries: Sequence[Function], common: Polynomial) -> list[Polynomial]:
    """The entries times a common multiple of their denominators: polynomials in the parameter."""
    return [f.num * polynomial_quotient(common, f.den) for f in entries]


def family_stability(family: Family) -> FamilyStability:
    """R(z) = det(I - zA + z1bᵀ) / det(I - zA) as a function of z and of the parameter."""
    common = poles(family)
    rows, weights = [cleared(row, common) for row in family.a], cleared(family.b, common)
    shifted = [[x - y for x, y in zip(row, weights, strict=True)] for row in rows]
    num, den = (_determinant(matrix, common) for matrix in (shifted, rows))
    shared = common_divisor(num, den)
    return FamilyStability(quotient(num, shared), quotient(den, shared))


def family_error_constant(family: Family) -> tuple[int, RationalFunction]:
    """(power, C) with R(z) - eᶻ = C(parameter) z**power + ..., C not zero; at the roots of C the order is higher.

    There is one: R agrees with exp up to the power deg P + deg Q at most, as for a single method.
    """
    r = family_stability(family)
    terms = len(r.num) + len(r.den) + 1
    differences = (f - fraction(ONE * wanted) for f, wanted in zip(r.taylor(terms), exponential(terms), strict=True))
    return next((power, f) for power, f in enumerate(differences) if f != NIL)


def _determinant(rows: Sequence[Sequence[Polynomial]], common: Polynomial) -> Bivariate:
    """det(I - zA) times commonˢ, for A = rows/common: coefficient k is that of `rows` times common**(s - k)."""
    found = [descend(c) for c in characteristic_and_adjugate(rows)[0]]
    scaled = [c * common ** (len(rows) - k) for k, c in enumerate(found)]
    while scaled[-1] == 0:
        scaled.pop()
    return scaled
