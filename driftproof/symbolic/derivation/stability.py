"""Boundedness of the powers of M(h): characteristic polynomial, its roots, and the limit of the step size."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import sympy
from flint import fmpq, fmpq_poly
from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from driftproof.symbolic.algebra.certified import certified_sign
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import every_real_root
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
from driftproof.symbolic.linear.stability_limits import Boundary, Infinity, Limit, bounded_powers, is_bounded

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


def conditions(m: DomainMatrix) -> Boundary:
    """The conditions of jury-1964, chapter 3, on λ² - tr M λ + det M, without denominators, in Q[h]."""
    n, d = over_common_denominator(m)
    (qq, qv, vq, vv), t, area = entries(n), trace(n) * d, determinant(n)
    return Boundary(d, d**2 - area, d**2 + area + t, d**2 + area - t, discriminant(n), (qv, vq, qq - vv))


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
        return is_bounded(conditions(self.m), self._sign)

    def _value(self, entry: MatrixEntry) -> sympy.Expr:
        top, bottom = (_in_field(p, self.h) for p in numerator_and_denominator(entry))
        return top[1] / bottom[1]

    def _sign(self, polynomial: StepPolynomial) -> int:
        is_zero, value = _in_field(polynomial, self.h)
        return 0 if is_zero else certified_sign(partial(enclose_expression, value))


def stability_limit(m: DomainMatrix) -> sympy.Expr:
    """The largest H such that the powers of M(h) are bounded for every h in (0, H): an exact real number, 0 or `oo`."""
    return limit_in_sympy(limit_of_step(m))


def limit_of_step(m: DomainMatrix) -> Limit:
    """The stability limit as a root of its minimal polynomial, 0 or `oo`."""
    return bounded_powers(tuple(tuple(map(_in_flint, row)) for row in m.to_list())).limit


def _in_flint(entry: MatrixEntry) -> RationalFunction:
    """An element of Q[h] or of Q(h) over FLINT's polynomials."""
    parts = (sympy.Poly(expression(p), expression(H)).all_coeffs()[::-1] for p in numerator_and_denominator(entry))
    top, bottom = (fmpq_poly([fmpq(int(c.p), int(c.q)) for c in part]) for part in parts)
    return fraction(top, bottom)


def limit_in_sympy(limit: Limit) -> sympy.Expr:
    """The exact number: in radicals if SymPy finds them, else with a CRootOf.

    An even polynomial is solved for h². CRootOf is called with an index, and FLINT counts the real roots: SymPy's own
    list of them takes minutes if the coefficients are long.
    """
    if isinstance(limit, Infinity):
        return sympy.oo
    even = not any(limit.minimal[1::2])
    minimal = limit.minimal[:: 2 if even else 1]
    unknown = sympy.Poly(minimal[::-1], expression(H))
    if unknown.degree() <= 2 or len(unknown.terms()) == 2:
        roots = unknown.real_roots()
    else:
        roots = [sympy.CRootOf(unknown, k) for k in range(len(every_real_root(minimal)))]
    if even:
        roots = [_square_root(x) for x in roots if certified_sign(partial(enclose_expression, x)) == 1]
    return roots[limit.index - len(every_real_root(limit.minimal))]


def _square_root(x: sympy.Expr) -> sympy.Expr:
    """The square root of x > 0, unevaluated for a CRootOf: to find its sign, SymPy would list all roots."""
    factor, root = x.as_coeff_Mul()
    return sympy.sqrt(factor) * sympy.Pow(root, sympy.S.Half, evaluate=not root.atoms(sympy.CRootOf))


def _in_field(polynomial: StepPolynomial, h: sympy.Expr) -> tuple[bool, sympy.Expr]:
    """Whether polynomial(h) is zero, and its value, by arithmetic in the field Q(h), where equality is decidable."""
    field: Any = QQ if h.is_Rational else QQ.algebraic_field(h)
    at, total = field.from_sympy(h), field.zero
    for coefficient in sympy.Poly(expression(polynomial), expression(H)).all_coeffs():
        total = total * at + field.from_sympy(coefficient)
    return total == field.zero, field.to_sympy(total)
