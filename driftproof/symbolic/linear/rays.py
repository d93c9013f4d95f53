"""How far the powers of R(hλ), and of R of a Jordan block, stay bounded along a ray h λ: exact."""

from __future__ import annotations

from typing import NamedTuple

from driftproof.symbolic.algebra.polynomials import Polynomial, Scalar, evaluate, from_scalars, sign
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, positive_roots, samples, vanishes_at
from driftproof.symbolic.linear.limits import INFINITY, Limit


class Bound(NamedTuple):
    """Powers are bounded for every h in (0, `limit`); `attained`: at the limit, too; None where it is 0 or oo."""

    limit: Limit
    attained: bool | None


NEVER, ALWAYS = Bound(ZERO_ROOT, None), Bound(INFINITY, None)


def ray_bound(r: RationalFunction, total: Scalar, product: Scalar, block: int) -> Bound:
    """The bound for R(xJ), x > 0, J a Jordan block of size `block` for λ with λ + λ̄ = `total` and λλ̄ = `product`.

    Powers of R(xJ) are bounded where |R(xλ)| < 1, and where |R(xλ)| = 1 and R(xJ) is a multiple of the identity: there
    R', ..., of orders below the block's, vanish at xλ, and so do as many derivatives of P'Q - PQ' from the zeroth on.
    """
    margin, obstacles = ray_conditions(r, total, product, block)
    if margin == 0:
        return ALWAYS if not any(obstacles) else NEVER
    roots = positive_roots([margin])
    for start, inner in zip([ZERO_ROOT, *roots], samples(roots), strict=True):
        touches = start != ZERO_ROOT and vanishes_at(margin, start)
        if touches and not all(vanishes_at(p, start) for p in obstacles):
            return Bound(start, False)
        if sign(evaluate(margin, inner)) < 0:
            return NEVER if start == ZERO_ROOT else Bound(start, True)
    return ALWAYS


def ray_conditions(
    r: RationalFunction, total: Scalar, product: Scalar, block: int
) -> tuple[Polynomial, list[Polynomial]]:
    """|Q|² - |P|² at xλ, whose sign decides where it is not 0; and what else has to vanish where it is, all in x."""
    margin = size_along(r.den, total, product) - size_along(r.num, total, product)
    slope = r.num.derivative() * r.den - r.num * r.den.derivative()
    return margin, [size_along(p, total, product) for p in _derivatives(slope, block - 1)]


def at_rest(r: RationalFunction, block: int) -> Bound:
    """The bound for a Jordan block of the eigenvalue 0: R(xJ) has to be the identity."""
    slope = r.num.derivative() * r.den - r.num * r.den.derivative()
    return ALWAYS if all(p[0] == 0 for p in _derivatives(slope, block - 1)) else NEVER


def size_along(p: Polynomial, total: Scalar, product: Scalar) -> Polynomial:
    """|p(xλ)|² as a polynomial in x, for λ + λ̄ = `total` and λλ̄ = `product`, p with real coefficients.

    Σ cⱼ cₖ xʲ⁺ᵏ λʲ λ̄ᵏ, where λⁿ + λ̄ⁿ follows the recurrence of x² - total x + product.
    """
    coefficients = p.coeffs()
    if not coefficients:
        return p
    one = product * 0 + 1
    sums = [2 * one, total]
    while len(sums) < len(coefficients):
        sums.append(total * sums[-1] - product * sums[-2])
    square = [coefficients[0] * 0] * (2 * len(coefficients) - 1)
    for j, c in enumerate(coefficients):
        square[2 * j] = square[2 * j] + c * c * product**j
        for k in range(j + 1, len(coefficients)):
            square[j + k] = square[j + k] + c * coefficients[k] * (product**j * sums[k - j])
    return from_scalars(square)


def _derivatives(p: Polynomial, count: int) -> list[Polynomial]:
    """p, p', ..., so many of them."""
    found = [p]
    while len(found) < count:
        found.append(found[-1].derivative())
    return found[:count]
