"""I-, A-, L- and A(α)-stability of a rational stability function, decided exactly and with checkable reasons."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest

from flint import arb, fmpq

from driftproof.methods.numbers.flint_rationals import as_fraction
from driftproof.symbolic.algebra.bivariate import ParametricPair, critical_polynomial
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    ZERO,
    FieldPolynomial,
    Polynomial,
    Scalar,
    X,
    evaluate,
    from_scalars,
    reflected,
    sign,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT as NO_SECTOR
from driftproof.symbolic.algebra.real_roots import RealRoot, positive_roots, samples
from driftproof.symbolic.linear.stability_limits import INFINITY, Infinity, Limit, first_bound, imaginary_margin


@dataclass(frozen=True)
class Decision:
    """A yes or no with its reason; `witness` is a rational point that proves a no, or None."""

    holds: bool
    reason: str
    witness: Fraction | None = None

    def __bool__(self) -> bool:
        return self.holds


def i_stability(r: RationalFunction) -> Decision:
    """Decide whether |R(iy)| <= 1 for every real y, that is |Q(iy)|² - |P(iy)|² >= 0: roots may touch, poles may not.

    The witness of a no is a y² at which the difference is negative.
    """
    margin = imaginary_margin(r)
    negative = negative_point(margin)
    if negative is not None:
        return Decision(False, "|Q(iy)|**2 - |P(iy)|**2 < 0 at the given y**2", negative)
    return Decision(True, "|Q(iy)|**2 - |P(iy)|**2 >= 0 for every y" if margin else "|R(iy)| = 1 for every y")


def a_stability(r: RationalFunction) -> Decision:
    """Decide whether |R(z)| <= 1 for every z with Re z <= 0: I-stable, and no pole there (hairer-wanner-1996, IV.3).

    It follows from the maximum principle, as a rational R that is bounded on the imaginary axis is bounded at infinity.
    """
    on_axis = i_stability(r)
    if not on_axis:
        return on_axis
    if not is_hurwitz(reflected(r.den)):
        return Decision(False, "a pole in the left half-plane: the Routh scheme of Q(-z) changes sign")
    return Decision(True, f"{on_axis.reason}, and every pole has Re z > 0 (Routh)")


def l_stability(r: RationalFunction) -> Decision:
    """Decide whether R is A-stable and R(z) -> 0 as z -> oo, that is deg P < deg Q."""
    half_plane = a_stability(r)
    if not half_plane:
        return half_plane
    if r.num.degree() < r.den.degree():
        return Decision(True, f"{half_plane.reason}; R(oo) = 0")
    return Decision(False, f"A-stable, but R(oo) = {r.at_infinity()}")


def negative_point(p: Polynomial) -> Fraction | None:
    """A rational x > 0 with p(x) < 0; None if p >= 0 on all of [0, oo).

    Between consecutive positive roots the sign is constant, so one rational point decides each interval.
    """
    if not p:
        return None
    for inner in samples(positive_roots([p])):
        if sign(evaluate(p, inner)) == -1:
            return as_fraction(inner)
    return None


def is_hurwitz(p: Polynomial) -> bool:
    """True if every root of p has a negative real part: the first column of the Routh scheme has one sign.

    A zero in that column, the degenerate case, occurs only if some root has Re >= 0 (gantmacher-1959, XV.4).
    Raises ValueError for the zero polynomial.
    """
    if not p:
        raise ValueError("every number is a root of the zero polynomial")
    descending = p.coeffs()[::-1]
    upper, lower = descending[::2], descending[1::2]
    expected = sign(upper[0])
    for _ in range(p.degree()):
        if sign(lower[0]) != expected:
            return False
        upper, lower = lower, _next_row(upper, lower)
    return True


def _next_row(upper: list[Scalar], lower: list[Scalar]) -> list[Scalar]:
    factor = upper[0] / lower[0]
    padded = [*lower[1:], *[fmpq(0)] * (len(upper) - len(lower))]
    return [u - factor * v for u, v in zip(upper[1:], padded, strict=True)]


# Largest size in bits, by `critical_bits`, of the critical polynomial; chosen: its roots are found in some seconds.
LARGEST_CRITICAL_BITS = 2**19


@dataclass(frozen=True)
class Angle:
    """An angle from 0 to 90 degrees, given by its tangent."""

    tangent: Limit

    def __float__(self) -> float:
        """The double nearest to the angle in degrees."""
        return decide_by_enclosure(self.exact, float)

    def ball(self) -> arb:
        """A ball around the angle in degrees, at Arb's current precision, for an angle below 90 degrees."""
        assert not isinstance(self.tangent, Infinity)
        return self.tangent.ball().atan() * 180 / arb.pi()

    @property
    def exact(self) -> Fraction | Callable[[], arb]:
        """The angle in degrees: 0 and 90 as a Fraction, any other as a procedure that returns a ball."""
        if isinstance(self.tangent, Infinity) or self.tangent == NO_SECTOR:
            return Fraction(90 if isinstance(self.tangent, Infinity) else 0)
        return self.ball


def sector_tangent(r: RationalFunction) -> Limit | None:
    """tan α for the largest α <= 90° with |R(z)| <= 1 wherever |arg(-z)| < α; `oo` if A-stable, 0 without a sector.

    On the ray z = x(-1 + it) the margin |Q|² - |P|² is a polynomial in x and T = t². Its sign pattern in x > 0 can
    only change at a T where its leading, trailing or first nonzero principal subresultant coefficient vanishes; one
    rational T decides each interval between (basu-pollack-roy-2006, chapter 5). None if that coefficient is a
    polynomial of more than LARGEST_CRITICAL_BITS.
    """
    if r.num.degree() > r.den.degree():
        return NO_SECTOR
    if a_stability(r):
        return INFINITY
    margin = ray_margin(r)
    if negative_point(_at(margin, fmpq(0))) is not None:
        return NO_SECTOR
    return None if critical_bits(margin) > LARGEST_CRITICAL_BITS else sector_tangent_by_rays(margin)


def sector_tangent_by_rays(margin: list[Polynomial]) -> Limit:
    """tan α from the margin on the rays; also valid if R is A-stable, but not if R is constant."""
    critical = positive_roots(_critical(margin))
    limit = first_bound(critical, lambda square: negative_point(_at(margin, square)) is None).limit
    return limit.square_root() if isinstance(limit, RealRoot) else limit


def ray_margin(r: RationalFunction) -> list[Polynomial]:
    """|Q(z)|² - |P(z)|² at z = x(-1 + it), divided by powers of x: its coefficients in x, as polynomials in T = t²."""
    den, num = (_size_on_ray(p) for p in (r.den, r.num))
    margin = [a - b for a, b in zip_longest(den, num, fillvalue=ZERO)]
    places = [k for k, c in enumerate(margin) if c]
    return margin[min(places) : max(places) + 1]


def critical_bits(margin: list[Polynomial]) -> int:
    """An estimate in bits of a discriminant of the margin: its degree in T times the length of a coefficient."""
    factors = 2 * len(margin) - 3
    parts = [p for c in margin for p in (c.parts if isinstance(c, FieldPolynomial) else (c,))]
    height = max(int(n).bit_length() for p in parts for x in p.coeffs() for n in (x.p, x.q))
    return int(factors * factors * height * max(c.degree() for c in margin))


def _size_on_ray(p: Polynomial) -> list[Polynomial]:
    """The coefficients in x of |p(x(-1 + it))|², as polynomials in T = t², from (-1 + it)ᵏ = uₖ(T) + it vₖ(T)."""
    terms, u, v = [], ONE, ZERO
    for c in p.coeffs():
        terms.append((u * c, v * c))
        u, v = -u - X * v, u - v
    square: dict[int, Polynomial] = {}
    for k, (real, imaginary) in enumerate(terms):
        for m, (other_real, other_imaginary) in enumerate(terms):
            square[k + m] = square.get(k + m, ZERO) + real * other_real + X * imaginary * other_imaginary
    return list(square.values())


def _at(margin: list[Polynomial], square: fmpq) -> Polynomial:
    return from_scalars([evaluate(c, square) for c in margin])


def _critical(margin: list[Polynomial]) -> list[Polynomial]:
    """Polynomials in T, one of which vanishes wherever the number of distinct positive roots in x can change.

    Where the leading coefficient vanishes, so does the subresultant: its first column holds multiples of that alone.
    """
    conjugates = max(c.field.degree if isinstance(c, FieldPolynomial) else 1 for c in margin)
    bounds = [(conjugates * n,) * 2 for n in (len(margin) - 1, max(c.degree() for c in margin))]

    def with_slope(square: fmpq) -> tuple[Polynomial, Polynomial]:
        value = _at(margin, square)  # over a field the product of all conjugates, polynomial in T and over Q
        value = value.norm() if isinstance(value, FieldPolynomial) else value**conjugates
        return value, value.derivative()

    merging = critical_polynomial(ParametricPair(with_slope, *bounds))
    return [p for p in (margin[0], merging) if p]
