"""The boundary |R(z)| = 1 of the stability region, as certified points."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import acb, acb_poly, arb, ctx

from symbolic.linear.number_field_polynomials import FieldPolynomial, root_ball
from symbolic.linear.polynomials import Polynomial, scalar, squarefree
from symbolic.linear.rational_functions import RationalFunction


class BoundaryPoint(NamedTuple):
    """A complex ball that contains a point z with |R(z)| = 1 and Re R(z) = `cosine`."""

    cosine: Fraction
    z: acb


def boundary_points(r: RationalFunction, count: int, bits: int = 64) -> list[BoundaryPoint]:
    """Every z with |R(z)| = 1 and Re R(z) among 2 count + 1 rational numbers from -1 to 1, in balls.

    R(z) = c ± i sqrt(1 - c²) are the roots of P² - 2cPQ + Q², a polynomial with real exact coefficients; multiple roots
    are separated exactly, so balls isolate what is left. c = (1 - t²)/(1 + t²) makes the angles of R(z) nearly even.
    """
    squares = [Fraction(k * k, count * count) for k in range(count + 1)]
    cosines = [(1 - t) / (1 + t) for t in squares]
    cosines += [-c for c in cosines[-2::-1]]
    return [BoundaryPoint(c, z) for c in cosines for z in points_at(r, c, bits)]


def points_at(r: RationalFunction, cosine: Fraction, bits: int = 64) -> list[acb]:
    """Balls around every z with |R(z)| = 1 and Re R(z) = cosine, radii about 2**-bits, relative or absolute."""
    if abs(cosine) == 1:
        level = r.num - r.den * int(cosine)
    else:
        level = r.num * r.num - r.num * r.den * (2 * scalar(cosine)) + r.den * r.den
    return complex_roots(level, bits)


def complex_roots(p: Polynomial, bits: int) -> list[acb]:
    """Balls around the distinct complex roots of p, real ones with imaginary part exactly 0 where p is over Q."""
    if p.degree() < 1:
        return []
    if not isinstance(p, FieldPolynomial):
        with ctx.workprec(bits):
            return [root for root, _ in p.numer().complex_roots()]
    simple, work = squarefree(p), 2 * bits
    while True:
        with ctx.workprec(work):
            try:
                found: list[acb] = acb_poly([_ball(c) for c in simple.coeffs()]).roots(tol=arb(2) ** -bits)
            except ValueError:  # the balls of the coefficients are too wide
                work *= 2
            else:
                return found


def _ball(x: FieldPolynomial) -> arb:
    total, alpha = arb(0), root_ball(x.field)
    for part in reversed(x.parts):
        total = total * alpha + arb(part[0])
    return total
