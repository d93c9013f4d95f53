"""For which h the powers of M(h) stay bounded: characteristic polynomial, roots, and the first h where that ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import sympy
from flint import ctx
from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from driftproof.symbolic.algebra.certified import certified_sign, endpoints
from driftproof.symbolic.derivation.expression_balls import enclose_expression
from driftproof.symbolic.derivation.one_step import (
    RING,
    H,
    MatrixEntry,
    StepPolynomial,
    determinant,
    entries,
    expression,
    numerator_and_denominator,
    over_common_denominator,
    trace,
)

LAMBDA = sympy.Symbol("lambda")


def characteristic_polynomial(m: DomainMatrix) -> sympy.Poly:
    """λ² - tr M λ + det M, as a polynomial in λ: both components obey this recurrence."""
    return sympy.Poly(LAMBDA**2 - expression(trace(m)) * LAMBDA + expression(determinant(m)), LAMBDA)


def discriminant(m: DomainMatrix) -> MatrixEntry:
    """(tr M)² - 4 det M: the roots are complex conjugate where it is negative, and merge where it is zero."""
    return trace(m) ** 2 - 4 * determinant(m)


def square_root_of_discriminant(m: DomainMatrix) -> tuple[sympy.Expr, sympy.Expr]:
    """(s, r) with discriminant s² r, r without square factors: s is positive for small h > 0."""
    factor, rest = RING.one, RING.one
    numerators, denominator = over_common_denominator(m)
    content, powers = discriminant(numerators).factor_list()
    for base, power in powers:
        lowest = base[min(base.monoms())]
        base, content = (base, content) if lowest > 0 else (-base, content * (-1) ** power)
        factor, rest = factor * base ** (power // 2), rest * base ** (power % 2)
    return expression(factor) / expression(denominator), expression(rest * content)


def multipliers(m: DomainMatrix) -> tuple[sympy.Expr, sympy.Expr]:
    """The two roots of the characteristic polynomial, half the trace ± half a root of the discriminant, in h."""
    half_trace, (factor, rest) = expression(trace(m)) / 2, square_root_of_discriminant(m)
    half_root = factor * sympy.sqrt(rest) / 2
    return half_trace + half_root, half_trace - half_root


class BoundednessConditions(NamedTuple):
    """Polynomials in h whose signs decide boundedness: 1 - det, 1 + det + tr and 1 + det - tr, all times d².

    M = N / d; `merged` is d² times the discriminant, and `off` vanishes where M is a multiple of the identity.
    """

    pole: StepPolynomial
    area: StepPolynomial
    plus: StepPolynomial
    minus: StepPolynomial
    merged: StepPolynomial
    off: tuple[StepPolynomial, StepPolynomial, StepPolynomial]


def conditions(m: DomainMatrix) -> BoundednessConditions:
    """The conditions of jury-1964, chapter 3, on λ² - tr M λ + det M, without denominators."""
    n, d = over_common_denominator(m)
    (qq, qv, vq, vv), t, area = entries(n), trace(n) * d, determinant(n)
    return BoundednessConditions(d, d**2 - area, d**2 + area + t, d**2 + area - t, discriminant(n), (qv, vq, qq - vv))


@dataclass(frozen=True)
class AtStep:
    """M(h) at one exact real algebraic h (a SymPy number), and whether its powers stay bounded there."""

    m: DomainMatrix
    h: sympy.Expr

    @property
    def matrix(self) -> sympy.ImmutableMatrix:
        """M(h) with exact algebraic entries."""
        return sympy.ImmutableMatrix(2, 2, [self._value(entry) for entry in entries(self.m)])

    @property
    def trace(self) -> sympy.Expr:
        """tr M(h), exact."""
        return self._value(trace(self.m))

    @property
    def determinant(self) -> sympy.Expr:
        """det M(h), exact."""
        return self._value(determinant(self.m))

    @property
    def jordan_block(self) -> bool:
        """True when the two eigenvalues coincide and M(h) is not a multiple of the identity."""
        found = conditions(self.m)
        return self._sign(found.merged) == 0 and any(self._sign(entry) != 0 for entry in found.off)

    @property
    def bounded(self) -> bool:
        """True when sup over n of |M(h)ⁿ| is finite: every |λ| <= 1, and |λ| = 1 only without a Jordan block."""
        return _is_bounded(conditions(self.m), self._sign)

    def _value(self, entry: MatrixEntry) -> sympy.Expr:
        top, bottom = (_in_field(p, self.h) for p in numerator_and_denominator(entry))
        return top[1] / bottom[1]

    def _sign(self, polynomial: StepPolynomial) -> int:
        is_zero, value = _in_field(polynomial, self.h)
        return 0 if is_zero else certified_sign(partial(enclose_expression, value))


def stability_limit(m: DomainMatrix) -> sympy.Expr:
    """The largest H such that the powers of M(h) are bounded for every h in the open interval (0, H).

    An exact real number: 0 if there is no such interval, `oo` if the powers are always bounded. Between
    consecutive roots of the boundary polynomials no verdict can change, so one rational h decides each interval
    and a root where the verdict holds (a touch) is passed over.
    """
    found = conditions(m)
    boundary = _boundary(found)
    reached: sympy.Expr = sympy.Integer(0)
    for inner, end in _cells(boundary):
        if not _is_bounded(found, lambda p, at=inner: sympy.sign(_poly(p).eval(at))):  # type: ignore[misc]
            return reached
        if end is None:
            return sympy.oo
        reached = _root_in(boundary, *end)
        if not _is_bounded(found, partial(_sign_at_root, boundary, end)):
            return reached
    raise AssertionError("the cells end with an unbounded one")


def _is_bounded(found: BoundednessConditions, sign_of: Callable[[StepPolynomial], int]) -> bool:
    area = sign_of(found.area)
    if area < 0 or sign_of(found.plus) < 0 or sign_of(found.minus) < 0 or sign_of(found.pole) == 0:
        return False
    # Now every |λ| <= 1. A double root on the unit circle needs |det| = 1 and a zero discriminant.
    return not (area == 0 and sign_of(found.merged) == 0 and any(sign_of(entry) != 0 for entry in found.off))


def _boundary(found: BoundednessConditions) -> sympy.Poly:
    """The product of the nonzero ones of the first four conditions, squarefree: a verdict can change at its roots."""
    product = RING.one
    for factor in found[:4]:
        product = product if factor == 0 else product.lcm(factor)
    return _poly(product).sqf_part()


def _poly(polynomial: StepPolynomial) -> Any:
    return sympy.Poly(expression(polynomial), expression(H), domain=QQ)


def _sign_at_root(boundary: Any, ends: tuple[sympy.Rational, sympy.Rational], polynomial: StepPolynomial) -> int:
    """The sign at the only root of `boundary` between the ends: zero if a common factor has a root there, too."""
    p, (low, high) = _poly(polynomial), ends
    if p.is_zero or (low == high and p.eval(low) == 0) or boundary.gcd(p).count_roots(low, high):
        return 0
    while low != high and p.count_roots(low, high):
        low, high = boundary.refine_root(low, high, steps=1)
    return int(sympy.sign(p.eval(low)))


def _cells(boundary: Any) -> Iterator[tuple[sympy.Rational, tuple[sympy.Rational, sympy.Rational] | None]]:
    """A rational point of each interval between 0, the positive roots and infinity, and an interval around its end."""
    previous = sympy.Integer(0)
    for low, high in boundary.intervals(sqf=True, inf=0) if boundary.degree() > 0 else ():
        if high == 0:
            continue
        while low <= previous and low != high:
            low, high = boundary.refine_root(low, high, steps=1)
        yield (previous + low) / 2, (low, high)
        previous = high
    yield previous + 1, None


def _root_in(boundary: Any, low: sympy.Rational, high: sympy.Rational) -> sympy.Expr:
    """The root in the isolating interval as an exact number: in radicals where SymPy has them, else with a CRootOf.

    In an even polynomial h² is the unknown: SymPy parts h from -h by bisection, for long coefficients in minutes.
    """
    factor = _factor_between(boundary, low, high)
    ascending = factor.all_coeffs()[::-1]
    if any(ascending[1::2]):
        candidates = factor.real_roots()
    else:
        squares = sympy.Poly(ascending[::2][::-1], factor.gen).real_roots()
        candidates = [sympy.sqrt(x) for x in squares if certified_sign(partial(enclose_expression, x)) > 0]
    inside = lambda x: min(certified_sign(partial(enclose_expression, side)) for side in (x - low, high - x)) >= 0
    return next(filter(inside, candidates))


def _factor_between(boundary: Any, low: sympy.Rational, high: sympy.Rational) -> Any:
    return next(f for f, _ in boundary.factor_list()[1] if f.count_roots(low, high))


def minimal_polynomial_of(m: DomainMatrix, limit: sympy.Expr) -> sympy.Poly:
    """The irreducible polynomial in h of which a stability limit without radicals is a root."""
    with ctx.workprec(256):
        ends = [sympy.Rational(x.numerator, x.denominator) for x in endpoints(enclose_expression(limit))]
    polynomial: sympy.Poly = _factor_between(_boundary(conditions(m)), *ends)
    return polynomial


def _in_field(polynomial: StepPolynomial, h: sympy.Expr) -> tuple[bool, sympy.Expr]:
    """(is zero, value) of polynomial(h), by arithmetic in the number field Q(h), where equality is decidable."""
    field: Any = QQ if h.is_Rational else QQ.algebraic_field(h)
    at, total = field.from_sympy(h), field.zero
    for coefficient in sympy.Poly(expression(polynomial), expression(H)).all_coeffs():
        total = total * at + field.from_sympy(coefficient)
    return total == field.zero, field.to_sympy(total)
