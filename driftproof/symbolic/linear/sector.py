"""A(α)-stability: the widest sector around the negative real axis in which |R| <= 1, with tan α exact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, fmpq

from driftproof.symbolic.algebra.bivariate import ParametricPair, critical_polynomial
from driftproof.symbolic.algebra.polynomials import ONE, ZERO, FieldPolynomial, Polynomial, X, evaluate, from_scalars
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT as NO_SECTOR
from driftproof.symbolic.algebra.real_roots import RealRoot, positive_roots
from driftproof.symbolic.linear.implicit_stability import a_stability, negative_point
from driftproof.symbolic.linear.limits import INFINITY, Infinity, Limit, first_failure
from driftproof.symbolic.linear.sector_enclosure import EnclosedTangent

# Beyond, the critical polynomial has a degree of hundreds, and takes minutes.
LARGEST_EXACT_DEGREE = 7


@dataclass(frozen=True)
class Angle:
    """An angle of at most 90 degrees by its tangent."""

    tangent: Limit | EnclosedTangent

    def ball(self) -> arb:
        """The angle in degrees, at Arb's current precision; not of 0 and 90 degrees."""
        assert not isinstance(self.tangent, Infinity)
        return self.tangent.ball().atan() * 180 / arb.pi()

    @property
    def exact(self) -> Fraction | Callable[[], arb]:
        """The angle in degrees as a number for `certified`."""
        if isinstance(self.tangent, Infinity) or self.tangent == NO_SECTOR:
            return Fraction(90 if isinstance(self.tangent, Infinity) else 0)
        return self.ball


def sector_tangent(r: RationalFunction) -> Limit | EnclosedTangent:
    """tan α for the largest α <= 90° with |R(z)| <= 1 wherever |arg(-z)| < α; `oo` if A-stable, 0 without a sector.

    On the ray z = x(-1 + it) the margin |Q|² - |P|² is a polynomial in x and T = t². Its sign pattern in x > 0 can
    only change at a T where its leading, trailing or first nonzero principal subresultant coefficient vanishes; one
    rational T decides each interval between (basu-pollack-roy-2006, chapter 5). For degrees above
    LARGEST_EXACT_DEGREE the number is enclosed by bisection instead, unless |R| comes to 1 on the negative axis.
    """
    if r.num.degree() > r.den.degree():
        return NO_SECTOR
    if a_stability(r):
        return INFINITY
    margin = ray_margin(r)
    on_axis = _at(margin, fmpq(0))
    if negative_point(on_axis) is not None:
        return NO_SECTOR
    touches = on_axis[0] == 0 or on_axis.degree() < len(margin) - 1 or positive_roots([on_axis])
    if r.den.degree() > LARGEST_EXACT_DEGREE and not touches:
        return EnclosedTangent(r, margin)
    return sector_tangent_by_rays(margin)


def sector_tangent_by_rays(margin: list[Polynomial]) -> Limit:
    """tan α from the margin on the rays; also where R is A-stable."""
    if not margin:
        return INFINITY
    limit = first_failure(_critical(margin), lambda square: negative_point(_at(margin, square)) is None)
    return limit.square_root() if isinstance(limit, RealRoot) else limit


def ray_margin(r: RationalFunction) -> list[Polynomial]:
    """|Q(z)|² - |P(z)|² at z = x(-1 + it), without common powers of x: coefficients in T = t², by powers of x."""
    size = 2 * max(r.num.degree(), r.den.degree()) + 1
    den, num = (_size_on_ray(p, size) for p in (r.den, r.num))
    margin = [a - b for a, b in zip(den, num, strict=True)]
    while margin and margin[-1] == 0:
        margin.pop()
    while margin and margin[0] == 0:
        margin.pop(0)
    return margin


def _size_on_ray(p: Polynomial, size: int) -> list[Polynomial]:
    """|p(x(-1 + it))|² by powers of x: (-1 + it)ᵏ = uₖ(T) + it vₖ(T)."""
    terms, u, v = [], ONE, ZERO
    for c in p.coeffs():
        terms.append((u * c, v * c))
        u, v = -u - X * v, u - v
    square: list[Polynomial] = [ZERO] * size
    for k, (real, imaginary) in enumerate(terms):
        for m, (other_real, other_imaginary) in enumerate(terms):
            square[k + m] = square[k + m] + real * other_real + X * imaginary * other_imaginary
    return square


def _at(margin: list[Polynomial], square: fmpq) -> Polynomial:
    return from_scalars([evaluate(c, square) for c in margin])


def _critical(margin: list[Polynomial]) -> list[Polynomial]:
    """Polynomials in T, one of which vanishes wherever the number of distinct positive roots in x can change."""
    conjugates = max(c.field.degree if isinstance(c, FieldPolynomial) else 1 for c in margin)
    degree = (len(margin) - 1) * conjugates
    reach = max(c.degree() for c in margin) * conjugates

    def with_slope(square: fmpq) -> tuple[Polynomial, Polynomial]:
        value = _rational_at(margin, square, conjugates)
        return value, value.derivative()

    merging = (
        critical_polynomial(ParametricPair(with_slope, (degree, degree - 1), (reach, reach))) if degree > 1 else None
    )
    return [margin[0], margin[-1], *([merging] if merging is not None else [])]


def _rational_at(margin: list[Polynomial], square: fmpq, conjugates: int) -> Polynomial:
    """The product of the conjugates of the margin at T = square: over Q, its coefficients polynomial in T."""
    value = _at(margin, square)
    return value.norm() if isinstance(value, FieldPolynomial) else value**conjugates
