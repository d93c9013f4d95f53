"""Exact stability limits: how far |R| <= 1 holds on the axes, and how far powers of a 2x2 M(h) stay bounded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from enum import Enum
from fractions import Fraction
from functools import partial
from itertools import chain
from math import inf, isqrt, prod
from typing import NamedTuple, TypeAlias

from flint import fmpq

from driftproof.methods.families import ParameterFunction
from driftproof.methods.numbers.number_field import Algebraic
from driftproof.symbolic.algebra.certified import CertifiableReal, enclose
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    descend,
    evaluate,
    exact,
    greatest_common_divisor,
    modulus_squared_on_imaginary_axis,
    quotient,
    reflected,
    scalar,
    sign,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, positive_roots, samples, sign_at


class Infinity(Enum):
    """The limit of a condition that never fails."""

    INFINITY = "oo"

    def __float__(self) -> float:
        """The float inf."""
        return inf

    def __str__(self) -> str:
        return self.value


INFINITY = Infinity.INFINITY
# A number in [0, oo].
Limit: TypeAlias = RealRoot | Infinity


def real_limit(r: RationalFunction) -> Limit:
    """The largest x₀ with |R(-x)| <= 1 for every x in [0, x₀], where Q² - P² = (Q - P)(Q + P) >= 0 at -x."""
    num, den = reflected(r.num), reflected(r.den)
    factors = [f for f in (den - num, den + num) if f]
    if len(factors) < 2:
        return INFINITY
    return nonnegative_limit(*factors)


def imaginary_limit(r: RationalFunction) -> Limit:
    """The largest y₀ with |R(iy)| <= 1 for every y in [0, y₀], where |Q|² - |P|², a polynomial in y², is >= 0."""
    margin = imaginary_margin(r)
    if not margin:
        return INFINITY
    limit = nonnegative_limit(margin)
    return limit if isinstance(limit, Infinity) else limit.square_root()


def imaginary_margin(r: RationalFunction) -> Polynomial:
    """|Q(iy)|² - |P(iy)|² as a polynomial in y², negative at a pole (hairer-wanner-1996, IV.3)."""
    return modulus_squared_on_imaginary_axis(r.den) - modulus_squared_on_imaginary_axis(r.num)


def nonnegative_limit(*factors: Polynomial) -> Limit:
    """The left end of the first interval of x > 0 in which the product of the factors is negative; `oo` without any."""
    return first_bound(positive_roots(factors), lambda x: prod(sign(evaluate(f, x)) for f in factors) != -1).limit


class Bound(NamedTuple):
    """A condition holds for every x in (0, `limit`); `attained` says whether for x = `limit`, None for 0 and oo."""

    limit: Limit
    attained: bool | None


NEVER, ALWAYS = Bound(ZERO_ROOT, None), Bound(INFINITY, None)


def first_bound(
    roots: list[RealRoot], holds: Callable[[fmpq], bool], holds_at: Callable[[RealRoot], bool] = lambda root: True
) -> Bound:
    """The bound of a condition that is constant between consecutive positive numbers, the `roots`.

    So one rational point decides each interval, by `holds`, and `holds_at` each root; by default that of a closed
    condition, which holds at a root if on both sides of it.
    """
    for start, inner in zip([ZERO_ROOT, *roots], samples(roots), strict=True):
        if start != ZERO_ROOT and not holds_at(start):
            return Bound(start, False)
        if not holds(inner):
            return NEVER if start == ZERO_ROOT else Bound(start, True)
    return ALWAYS


def smallest(limits: Sequence[Limit]) -> Limit:
    """The smallest of the limits; `oo` for an empty sequence."""
    finite = {limit for limit in limits if isinstance(limit, RealRoot)}
    if ZERO_ROOT in finite or not finite:
        return ZERO_ROOT if finite else INFINITY
    order = positive_roots([limit.polynomial for limit in finite])
    return next(root for root in order if root in finite)


class Boundary(NamedTuple):
    """Polynomials in h whose signs decide whether the powers of M are bounded; `den` is the common denominator.

    `area`, `plus`, `minus` and `merged` are 1 - det, 1 + det + tr, 1 + det - tr and tr² - 4 det, times den²; the three
    of `off` vanish together exactly where M is a multiple of the identity.
    """

    den: Polynomial
    area: Polynomial
    plus: Polynomial
    minus: Polynomial
    merged: Polynomial
    off: tuple[Polynomial, Polynomial, Polynomial]


def bounded_powers(m: StepMatrix) -> Bound:
    """The largest H such that the powers of M(h) are bounded for every h in (0, H), and whether they are for h = H.

    Boundedness cannot change between consecutive roots of the boundary polynomials. At the roots exact signs decide:
    there 1 or -1 may be an eigenvalue, and a double one is harmless only if M = ±I.
    """
    boundary = boundary_of(m)
    polynomials = [boundary.den, boundary.area, boundary.plus, boundary.minus]
    return first_bound(
        positive_roots([*polynomials, *(() if boundary.merged else boundary.off)]),
        lambda x: is_bounded(boundary, lambda p: sign(evaluate(p, x))),
        lambda root: is_bounded(boundary, partial(sign_at, root=root)),
    )


def is_bounded(boundary: Boundary, sign_of: Callable[[Polynomial], int]) -> bool:
    """True if the powers of M are bounded where the polynomials have the signs `sign_of` (jury-1964, chapter 3).

    Then there is no pole, every eigenvalue lies in the closed unit disc, and none on the circle has a Jordan block.
    """
    if not sign_of(boundary.den):
        return False
    area = sign_of(boundary.area)
    if area == -1 or sign_of(boundary.plus) == -1 or sign_of(boundary.minus) == -1:
        return False
    # Now every |λ| <= 1; a double root on the circle needs |det| = 1 and a zero discriminant.
    jordan = not area and not sign_of(boundary.merged) and any(sign_of(p) for p in boundary.off)
    return not jordan


def boundary_of(m: StepMatrix) -> Boundary:
    """The boundary polynomials of M = N/d, computed from the entries of N and the common denominator d."""
    den = common_denominator(m)
    (qq, qv), (vq, vv) = ([descend(x.num * quotient(den, x.den)) for x in row] for row in m)
    square, area, trace = den * den, qq * vv - qv * vq, (qq + vv) * den
    merged = (qq - vv) * (qq - vv) + 4 * qv * vq
    return Boundary(den, square - area, square + area + trace, square + area - trace, merged, (qv, vq, qq - vv))


def common_denominator(rows: Iterable[Iterable[RationalFunction | ParameterFunction]]) -> Polynomial:
    """The least common multiple of the entries' denominators."""
    common: Polynomial = ONE
    for entry in chain.from_iterable(rows):
        common = common * quotient(entry.den, greatest_common_divisor(common, entry.den))
    return descend(common)


def spectral_radius(entries: Sequence[Fraction | Algebraic]) -> CertifiableReal:
    """The largest |λ| of a 2x2 matrix, given by its entries row by row; a Fraction if found to be rational.

    It is sqrt(det) for complex eigenvalues, else (|tr| + sqrt(tr² - 4 det))/2.
    """
    qq, qv, vq, vv = entries
    trace, area = (exact(scalar(x)) for x in (qq + vv, qq * vv - qv * vq))
    discriminant = exact(scalar(trace * trace - 4 * area))
    if sign(scalar(discriminant)) == -1:
        return nonnegative_root(area)
    root, trace = nonnegative_root(discriminant), max(trace, -trace)
    if isinstance(trace, Fraction) and isinstance(root, Fraction):
        return (trace + root) / 2
    return lambda: (enclose(trace) + enclose(root)) / 2


def nonnegative_root(x: Fraction | Algebraic) -> CertifiableReal:
    """The square root of x >= 0; a Fraction if found to be rational."""
    if isinstance(x, Fraction):
        root = Fraction(isqrt(x.numerator), isqrt(x.denominator))
        if root * root == x:
            return root
    return lambda: enclose(x).sqrt()
