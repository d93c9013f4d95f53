"""The boundary |R(z)| = 1 of the stability region, as certified points."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import acb, acb_poly, arb, ctx

from driftproof.symbolic.algebra.certified import endpoints, fixed, settled, sign_of_ball
from driftproof.symbolic.algebra.polynomials import FieldPolynomial, Polynomial, scalar, squarefree
from driftproof.symbolic.algebra.rational_functions import RationalFunction

# The boundary as a fact: how many values of Re R(z) on each side of 0, and digits after the point; chosen for a plot.
COUNT = 12
PLACES = 15


class BoundaryPoint(NamedTuple):
    """A complex ball that contains a point z with |R(z)| = 1 and Re R(z) = `cosine`."""

    cosine: Fraction
    z: acb


def boundary_points(r: RationalFunction, count: int, bits: int = 64) -> list[BoundaryPoint]:
    """Balls around every z with |R(z)| = 1 and Re R(z) one of 2 count + 1 rational numbers from 1 to -1.

    The z with R(z) = c ± i sqrt(1 - c²) are the roots of P² - 2cPQ + Q², a polynomial with real exact coefficients.
    Multiple roots are separated exactly, so that balls isolate the others. The choice c = (1 - t²)/(1 + t²) spaces the
    angles of R(z) nearly evenly.

    >>> from driftproof import METHODS, boundary_points, stability_function_of
    >>> [float(point.z.real) for point in boundary_points(stability_function_of(METHODS["forward_euler"]), 1)]
    [0.0, -1.0, -1.0, -2.0]

    Raises ValueError if `count` is below 1.
    """
    if count < 1:
        raise ValueError(f"count = {count}; must be at least 1")
    squares = [Fraction(k * k, count * count) for k in range(count + 1)]
    cosines = [(1 - t) / (1 + t) for t in squares]
    cosines += [-c for c in cosines[-2::-1]]
    return [BoundaryPoint(c, z) for c in cosines for z in points_at(r, c, bits)]


def rounded_boundary(r: RationalFunction, count: int = COUNT, places: int = PLACES) -> list[tuple[str, str, str]]:
    """(Re R(z), Re z, Im z) of the boundary points with Im z >= 0, as text; the error of z is below 10**-places.

    Each part of z is rounded, by at most 1/2 unit of the last place, from the centre of a ball of radius below 1/8.
    """

    def middles() -> list[tuple[Fraction, ...]] | None:
        points = [point for point in boundary_points(r, count, ctx.prec) if sign_of_ball(point.z.imag) != -1]
        parts = [tuple(endpoints(part) for part in (point.z.real, point.z.imag)) for point in points]
        if not all(8 * (high - low) * 10**places < 2 for pair in parts for low, high in pair):
            return None
        return [(-p.cosine, *((low + high) / 2 for low, high in pair)) for p, pair in zip(points, parts, strict=True)]

    return [(str(-c), fixed(x, places), fixed(y, places)) for c, x, y in sorted(settled(middles))]


def points_at(r: RationalFunction, cosine: Fraction, bits: int = 64) -> list[acb]:
    """Balls around every z with |R(z)| = 1 and Re R(z) = cosine, of relative or absolute radius about 2**-bits."""
    return complex_roots(r.num * r.num - r.num * r.den * (2 * scalar(cosine)) + r.den * r.den, bits)


def complex_roots(p: Polynomial, bits: int) -> list[acb]:
    """Balls around the distinct complex roots of p; if p is over Q, real roots have an imaginary part of exactly 0."""
    if p.degree() < 1:
        return []
    if not isinstance(p, FieldPolynomial):
        with ctx.workprec(bits):
            return [root for root, _ in p.numer().complex_roots()]
    simple = squarefree(p)

    def isolated() -> list[acb] | None:
        try:
            return list(acb_poly([c.element().ball() for c in simple.coeffs()]).roots(tol=arb(2) ** -bits))
        except ValueError:  # the balls of the coefficients are too wide
            return None

    return settled(isolated, 2 * bits)
