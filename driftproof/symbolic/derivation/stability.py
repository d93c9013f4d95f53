"""Boundedness of the powers of M(h): characteristic polynomial, its roots, and the limit of the step size."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import sympy
from flint import arb_poly, ctx, fmpq, fmpq_poly
from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from driftproof.methods.numbers.number_field import real_root_balls
from driftproof.symbolic.algebra.certified import ISOLATING_BITS, certified_sign, endpoints
from driftproof.symbolic.derivation.expression_balls import enclose_expression, integer_coefficients
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
    """The polynomial λ² - tr M λ + det M in λ; both components of the state satisfy the recurrence that it defines."""
    return sympy.Poly(LAMBDA**2 - expression(trace(m)) * LAMBDA + expression(determinant(m)), LAMBDA)


def discriminant(m: DomainMatrix) -> MatrixEntry:
    """The discriminant (tr M)² - 4 det M: the roots are complex where it is negative, and coincide where it is zero."""
    return trace(m) ** 2 - 4 * determinant(m)


def square_root_of_discriminant(m: DomainMatrix) -> tuple[sympy.Expr, sympy.Expr]:
    """The pair (s, r) with discriminant s² r, where r is squarefree and s is positive for small h > 0."""
    factor, rest = RING.one, RING.one
    numerators, denominator = over_common_denominator(m)
    content, powers = discriminant(numerators).factor_list()
    for base, power in powers:
        lowest = base[min(base.monoms())]
        base, content = (base, content) if lowest > 0 else (-base, content * (-1) ** power)
        factor, rest = factor * base ** (power // 2), rest * base ** (power % 2)
    return expression(factor) / expression(denominator), expression(rest * content)


def multipliers(m: DomainMatrix) -> tuple[sympy.Expr, sympy.Expr]:
    """The roots of the characteristic polynomial in h: half the trace ± half the square root of the discriminant."""
    half_trace, (factor, rest) = expression(trace(m)) / 2, square_root_of_discriminant(m)
    half_root = factor * sympy.sqrt(rest) / 2
    return half_trace + half_root, half_trace - half_root


class BoundednessConditions(NamedTuple):
    """Polynomials in h whose signs decide whether the powers of M = N / d are bounded; `pole` is d.

    `area`, `plus`, `minus` and `merged` are 1 - det, 1 + det + tr, 1 + det - tr and the discriminant, times d²; the
    three of `off` vanish together exactly where M is a multiple of the identity.
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
        return sympy.ImmutableMatrix([[self._value(entry) for entry in row] for row in self.m.to_list()])

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
        """True if the two eigenvalues coincide and M(h) is not a multiple of the identity."""
        found = conditions(self.m)
        return not self._sign(found.merged) and any(self._sign(entry) for entry in found.off)

    @property
    def bounded(self) -> bool:
        """True if sup over n of |M(h)ⁿ| is finite: every |λ| <= 1, and |λ| = 1 only without a Jordan block."""
        return _is_bounded(conditions(self.m), self._sign)

    def _value(self, entry: MatrixEntry) -> sympy.Expr:
        top, bottom = (_in_field(p, self.h) for p in numerator_and_denominator(entry))
        return top[1] / bottom[1]

    def _sign(self, polynomial: StepPolynomial) -> int:
        is_zero, value = _in_field(polynomial, self.h)
        return 0 if is_zero else certified_sign(partial(enclose_expression, value))


def stability_limit(m: DomainMatrix) -> sympy.Expr:
    """The largest H such that the powers of M(h) are bounded for every h in the open interval (0, H).

    It is an exact real number: 0 if there is no such interval, `oo` if the powers are always bounded. Boundedness
    cannot change between consecutive roots of the boundary polynomial, so one rational h decides each interval. A root
    at which the powers are bounded, as on both sides of it, is no limit.
    """
    found = conditions(m)
    reached: sympy.Expr = sympy.Integer(0)
    for inner, end in _cells(_boundary(found)):
        if not _is_bounded(found, lambda p, at=inner: sympy.sign(_poly(p).eval(at))):  # type: ignore[misc]
            return reached
        if end is None:
            return sympy.oo
        reached = end.value
        if not _is_bounded(found, end.sign_of):
            return reached
    raise AssertionError("the cells end with an unbounded one")


def _is_bounded(found: BoundednessConditions, sign_of: Callable[[StepPolynomial], int]) -> bool:
    area = sign_of(found.area)
    if area == -1 or sign_of(found.plus) == -1 or sign_of(found.minus) == -1 or not sign_of(found.pole):
        return False
    # Now every |λ| <= 1. A double root on the unit circle needs |det| = 1 and a zero discriminant.
    return not (not area and not sign_of(found.merged) and any(sign_of(entry) for entry in found.off))


def _boundary(found: BoundednessConditions) -> sympy.Poly:
    """The squarefree product of the conditions, zero ones left out, at whose roots boundedness can change.

    Of the conditions `off` matters only if the eigenvalues coincide for every h, and `merged` never.
    """
    product = RING.one
    for factor in (*found[:4], *(() if found.merged else found.off)):
        product = product.lcm(factor) if factor else product
    return _poly(product).sqf_part()


def _poly(polynomial: StepPolynomial) -> Any:
    return sympy.Poly(expression(polynomial), expression(H), domain=QQ)


@dataclass(frozen=True)
class _Root:
    """The only root of an irreducible polynomial in [low, high]; the ends are equal, or neither is a root."""

    factor: Any
    low: sympy.Rational
    high: sympy.Rational

    @cached_property
    def value(self) -> sympy.Expr:
        """The root as an exact number: in radicals if SymPy finds them, else with a CRootOf.

        An even polynomial is solved for h². CRootOf is called with an index, and FLINT counts the real roots: SymPy's
        own list of them takes minutes if the coefficients are long.
        """
        ascending = self.factor.all_coeffs()[::-1]
        even = not any(ascending[1::2])
        unknown = sympy.Poly(ascending[:: 2 if even else 1][::-1], self.factor.gen)
        if unknown.degree() <= 2 or len(unknown.terms()) == 2:
            roots = unknown.real_roots()
        else:
            count = len(real_root_balls(integer_coefficients(unknown), ISOLATING_BITS))
            roots = [sympy.CRootOf(unknown, k) for k in range(count)]
        if even:
            roots = [_square_root(x) for x in roots if certified_sign(partial(enclose_expression, x)) == 1]
        ends = (self.low, self.high)
        return next(x for x in roots if [certified_sign(partial(enclose_expression, x - y)) for y in ends] in _BETWEEN)

    def sign_of(self, polynomial: StepPolynomial) -> int:
        """The sign of `polynomial` at the root: zero exactly if the irreducible polynomial divides it."""
        p = _poly(polynomial)
        if p.rem(self.factor).is_zero:
            return 0
        coefficients = fmpq_poly([fmpq(int(c.p), int(c.q)) for c in p.all_coeffs()[::-1]])
        return certified_sign(lambda: arb_poly(coefficients)(enclose_expression(self.value)))


_BETWEEN = ([0, 0], [1, -1])


def _square_root(x: sympy.Expr) -> sympy.Expr:
    """The square root of x > 0, unevaluated for a CRootOf: to find its sign, SymPy would list all roots."""
    factor, root = x.as_coeff_Mul()
    return sympy.sqrt(factor) * sympy.Pow(root, sympy.S.Half, evaluate=not root.atoms(sympy.CRootOf))


def _cells(boundary: Any) -> Iterator[tuple[sympy.Rational, _Root | None]]:
    """Yield a rational point of each interval between 0, the positive roots and infinity, and the root at its end."""
    previous = sympy.Integer(0)
    for low, high in boundary.intervals(sqf=True, inf=0):
        if not high:
            continue
        while low != high and (low <= previous or not boundary.eval(high)):
            low, high = boundary.refine_root(low, high, steps=1)
        yield (previous + low) / 2, _Root(_factor_between(boundary, low, high), low, high)
        previous = high
    yield previous + 1, None


def _factor_between(boundary: Any, low: sympy.Rational, high: sympy.Rational) -> Any:
    """The irreducible factor with the root between the ends: all roots are simple, and only one lies there."""
    return next(f for f, _ in boundary.factor_list()[1] if f.eval(low) * f.eval(high) <= 0)


def minimal_polynomial_of(m: DomainMatrix, limit: sympy.Expr) -> sympy.Poly:
    """The irreducible polynomial in h with the stability limit as a root, for a limit without radicals."""
    with ctx.workprec(256):
        ends = [sympy.Rational(x.numerator, x.denominator) for x in endpoints(enclose_expression(limit))]
    polynomial: sympy.Poly = _factor_between(_boundary(conditions(m)), *ends)
    return polynomial


def _in_field(polynomial: StepPolynomial, h: sympy.Expr) -> tuple[bool, sympy.Expr]:
    """Whether polynomial(h) is zero, and its value, by arithmetic in the field Q(h), where equality is decidable."""
    field: Any = QQ if h.is_Rational else QQ.algebraic_field(h)
    at, total = field.from_sympy(h), field.zero
    for coefficient in sympy.Poly(expression(polynomial), expression(H)).all_coeffs():
        total = total * at + field.from_sympy(coefficient)
    return total == field.zero, field.to_sympy(total)
