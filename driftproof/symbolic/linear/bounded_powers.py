"""How far the powers of a 2x2 matrix M(h) stay bounded: touching eigenvalues and Jordan blocks decided exactly."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    Scalar,
    descend,
    evaluate,
    greatest_common_divisor,
    quotient,
    sign,
)
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, positive_roots, samples, sign_at
from driftproof.symbolic.linear.limits import INFINITY, Limit


class Boundary(NamedTuple):
    """Polynomials in h, multiples by squares of the common denominator `den`, whose signs decide boundedness.

    area ~ 1 - det, plus ~ 1 + det + tr, minus ~ 1 + det - tr, merged ~ tr² - 4 det; off the three entries that vanish
    together where M is a multiple of the identity.
    """

    den: Polynomial
    area: Polynomial
    plus: Polynomial
    minus: Polynomial
    merged: Polynomial
    off: tuple[Polynomial, Polynomial, Polynomial]


def bounded_limit(m: StepMatrix) -> Limit:
    """The largest H with the powers of M(h) bounded for every h in (0, H); `oo` if always, 0 if there is none.

    Between consecutive roots of the boundary polynomials no verdict changes, so one rational h decides each interval;
    at a root itself the verdict comes from exact signs: there -1 or 1 may be an eigenvalue, twice without harm only
    where M is ±I.
    """
    boundary = boundary_of(m)
    polynomials = [boundary.den, boundary.area, boundary.plus, boundary.minus]
    if boundary.merged == 0:
        polynomials += boundary.off
    roots = positive_roots([p for p in polynomials if p != 0])
    for start, inner in zip([ZERO_ROOT, *roots], samples(roots), strict=True):
        if start != ZERO_ROOT and not is_bounded(boundary, partial(sign_at, root=start)):
            return start
        if not is_bounded(boundary, partial(_sign_at_rational, x=inner)):
            return start
    return INFINITY


def is_bounded(boundary: Boundary, sign_of: Callable[[Polynomial], int]) -> bool:
    """The powers of M are bounded where the polynomials have the signs given (jury-1964, chapter 3).

    That is: no pole, every eigenvalue in the closed unit disc, and none on the circle with a Jordan block.
    """
    if sign_of(boundary.den) == 0:
        return False
    area = sign_of(boundary.area)
    if area < 0 or sign_of(boundary.plus) < 0 or sign_of(boundary.minus) < 0:
        return False
    # Now every |λ| <= 1; a double root on the circle needs |det| = 1 and a zero discriminant.
    jordan = area == 0 and sign_of(boundary.merged) == 0 and any(sign_of(p) for p in boundary.off)
    return not jordan


def boundary_of(m: StepMatrix) -> Boundary:
    """The boundary polynomials of M = N/d, d a common denominator: all are polynomial in the entries of N and d."""
    den = common_denominator(m)
    (qq, qv), (vq, vv) = ([descend(x.num * quotient(den, x.den)) for x in row] for row in m)
    square, area, trace = den * den, qq * vv - qv * vq, (qq + vv) * den
    merged = (qq - vv) * (qq - vv) + 4 * qv * vq
    return Boundary(den, square - area, square + area + trace, square + area - trace, merged, (qv, vq, qq - vv))


def _sign_at_rational(p: Polynomial, x: Scalar) -> int:
    return sign(evaluate(p, x))


def common_denominator(m: StepMatrix) -> Polynomial:
    """The least common multiple of the entries' denominators."""
    common: Polynomial = ONE
    for row in m:
        for entry in row:
            common = common * quotient(entry.den, greatest_common_divisor(common, entry.den))
    return descend(common)
