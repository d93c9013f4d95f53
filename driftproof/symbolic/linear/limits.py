"""Stability limits: how far |R| <= 1 on the negative real and on the imaginary axis, exact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from typing import TypeAlias

from flint import fmpq

from driftproof.symbolic.algebra.polynomials import (
    Polynomial,
    evaluate,
    modulus_squared_on_imaginary_axis,
    reflected,
    sign,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot, positive_roots, samples


class Infinity(Enum):
    """The limit that is never reached."""

    INFINITY = "oo"


INFINITY = Infinity.INFINITY
# A number in [0, oo].
Limit: TypeAlias = RealRoot | Infinity


def real_limit(r: RationalFunction) -> Limit:
    """The largest x₀ with |R(-x)| <= 1 for every x in [0, x₀]: Q² - P² = (Q - P)(Q + P) at -x has to stay >= 0."""
    num, den = reflected(r.num), reflected(r.den)
    factors = [f for f in (den - num, den + num) if f != 0]
    if len(factors) < 2:
        return INFINITY
    return first_failure(factors, lambda x: _sign_of_product(factors, x) >= 0)


def imaginary_limit(r: RationalFunction) -> Limit:
    """The largest y₀ with |R(iy)| <= 1 for every y in [0, y₀]: |Q|² - |P|², a polynomial in y², has to stay >= 0."""
    margin = imaginary_margin(r)
    if margin == 0:
        return INFINITY
    limit = first_failure([margin], lambda square: sign(evaluate(margin, square)) >= 0)
    return limit if isinstance(limit, Infinity) else limit.square_root()


def imaginary_margin(r: RationalFunction) -> Polynomial:
    """|Q(iy)|² - |P(iy)|² as a polynomial in y², negative at a pole (hairer-wanner-1996, IV.3)."""
    return modulus_squared_on_imaginary_axis(r.den) - modulus_squared_on_imaginary_axis(r.num)


def first_failure(polynomials: Sequence[Polynomial], holds: Callable[[fmpq], bool]) -> Limit:
    """The left end of the first interval in which a closed condition fails; `oo` if there is none.

    `holds` must be constant between consecutive positive roots of the polynomials, and must hold at a point where it
    holds on both sides: then a root that touches is no limit, and one rational point decides each interval.
    """
    roots = positive_roots(polynomials)
    for start, inner in zip([ZERO_ROOT, *roots], samples(roots), strict=True):
        if not holds(inner):
            return start
    return INFINITY


def smallest(limits: Sequence[Limit]) -> Limit:
    """The least of some limits; `oo` of none."""
    finite = {limit for limit in limits if isinstance(limit, RealRoot)}
    if ZERO_ROOT in finite or not finite:
        return ZERO_ROOT if finite else INFINITY
    order = positive_roots([limit.polynomial for limit in finite])
    return next(root for root in order if root in finite)


def _sign_of_product(factors: Sequence[Polynomial], x: fmpq) -> int:
    product = 1
    for factor in factors:
        product *= sign(evaluate(factor, x))
    return product
