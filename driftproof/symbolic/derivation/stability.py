"""For which h the powers of M(h) stay bounded: characteristic polynomial, roots, and the first h where that ends."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import sympy
from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from driftproof.symbolic.algebra.certified import sign
from driftproof.symbolic.derivation.one_step import RING, H, Polynomial, determinant, entries, expression, trace

LAMBDA = sympy.Symbol("lambda")


def characteristic_polynomial(m: DomainMatrix) -> sympy.Poly:
    """λ² - tr M λ + det M, as a polynomial in λ over Q[h]: both components obey this recurrence."""
    return sympy.Poly(LAMBDA**2 - expression(trace(m)) * LAMBDA + expression(determinant(m)), LAMBDA)


def discriminant(m: DomainMatrix) -> Polynomial:
    """(tr M)² - 4 det M, in Q[h]: the roots are complex conjugate where it is negative, and merge where it is zero."""
    return trace(m) ** 2 - 4 * determinant(m)


def multipliers(m: DomainMatrix) -> tuple[sympy.Expr, sympy.Expr]:
    """The two roots (tr M ± sqrt(discriminant)) / 2 of the characteristic polynomial, as expressions in h."""
    half_trace = expression(trace(m)) / 2
    half_root = sympy.sqrt(sympy.factor(expression(discriminant(m)))) / 2
    return half_trace + half_root, half_trace - half_root


@dataclass(frozen=True)
class AtStep:
    """M(h) at one exact real algebraic h (a SymPy number), and whether its powers stay bounded there."""

    m: DomainMatrix
    h: sympy.Expr

    @cached_property
    def matrix(self) -> sympy.ImmutableMatrix:
        """M(h) with exact algebraic entries."""
        return sympy.ImmutableMatrix(2, 2, [self._value(entry) for entry in entries(self.m)])

    @cached_property
    def trace(self) -> sympy.Expr:
        """tr M(h), exact."""
        return self._value(trace(self.m))

    @cached_property
    def determinant(self) -> sympy.Expr:
        """det M(h), exact."""
        return self._value(determinant(self.m))

    @property
    def jordan_block(self) -> bool:
        """True when the two eigenvalues coincide and M(h) is not a multiple of the identity."""
        merged = self._sign(discriminant(self.m)) == 0
        qq, qv, vq, vv = entries(self.m)
        return merged and any(self._sign(entry) != 0 for entry in (qv, vq, qq - vv))

    @property
    def bounded(self) -> bool:
        """True when sup over n of |M(h)ⁿ| is finite: every |λ| <= 1, and |λ| = 1 only without a Jordan block.

        Decided exactly from the signs of 1 - det and 1 + det ± tr (jury-1964, chapter 3).
        """
        t, d = trace(self.m), determinant(self.m)
        area, plus, minus = (self._sign(p) for p in (1 - d, 1 + d + t, 1 + d - t))
        if area < 0 or plus < 0 or minus < 0:
            return False
        # Now every |λ| <= 1. A double root on the unit circle needs |det| = 1 and a zero discriminant.
        return not (area == 0 and self.jordan_block)

    def _value(self, polynomial: Polynomial) -> sympy.Expr:
        return _in_field(polynomial, self.h)[1]

    def _sign(self, polynomial: Polynomial) -> int:
        is_zero, value = _in_field(polynomial, self.h)
        return 0 if is_zero else sign(value)


def stability_limit(m: DomainMatrix) -> sympy.Expr:
    """The largest H such that the powers of M(h) are bounded for every h in the open interval (0, H).

    An exact real number: 0 if there is no such interval, `oo` if the powers are always bounded. Between
    consecutive roots of the boundary polynomials no verdict can change, so one rational h decides each interval
    and a root where the verdict holds (a touch) is passed over.
    """
    reached: sympy.Expr = sympy.Integer(0)
    for root, inner in _cells(_boundary_polynomial(m)):
        if not AtStep(m, inner).bounded:
            return reached
        if root is None:
            return sympy.oo
        reached = root
        if not AtStep(m, root).bounded:
            return reached
    raise AssertionError("the cells end with an unbounded one")


def _boundary_polynomial(m: DomainMatrix) -> Polynomial:
    """The product of the nonzero polynomials among 1 - det, 1 + det ± tr: a verdict can only change at its roots."""
    t, d = trace(m), determinant(m)
    product = RING.one
    for factor in (1 - d, 1 + d + t, 1 + d - t):
        if factor != 0:
            product *= factor
    return product


def _cells(polynomial: Polynomial) -> Iterator[tuple[sympy.Expr | None, sympy.Expr]]:
    """Pairs (root, rational point just inside the open interval that ends at root), for the positive roots in order.

    The last pair has root None: the interval to infinity.
    """
    poly = sympy.Poly(expression(polynomial), expression(H)).sqf_part()
    roots = [root for root in poly.real_roots() if sign(root) > 0]
    previous = sympy.Integer(0)
    for root in roots:
        yield root, _rational_between(previous, root)
        previous = root
    yield None, sympy.ceiling(previous) + 1


def _rational_between(low: sympy.Expr, high: sympy.Expr) -> sympy.Rational:
    denominator = 1
    while True:
        candidate = sympy.Rational(sympy.floor(low * denominator) + 1, denominator)
        if sign(high - candidate) > 0:
            return candidate
        denominator *= 2


def _in_field(polynomial: Polynomial, h: sympy.Expr) -> tuple[bool, sympy.Expr]:
    """(is zero, value) of polynomial(h), by arithmetic in the number field Q(h), where equality is decidable."""
    field = QQ if h.is_Rational else QQ.algebraic_field(h)
    at, total = field.from_sympy(h), field.zero
    for coefficient in sympy.Poly(expression(polynomial), expression(H)).all_coeffs():
        total = total * at + field.from_sympy(coefficient)
    return total == field.zero, field.to_sympy(total)


def bounded_at(m: DomainMatrix, h: Fraction) -> bool:
    """True when the powers of M(h) are bounded at this rational h, e.g. at the exact value of a double."""
    return AtStep(m, sympy.Rational(h.numerator, h.denominator)).bounded
