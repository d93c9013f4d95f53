"""I-, A-, L- and A(α)-stability of a rational stability function, decided exactly and with checkable reasons."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, zip_longest

from flint import acb, acb_poly, arb, arb_poly, ctx, fmpq

from driftproof.methods.number_field import as_fmpq, as_fraction, dyadic
from driftproof.symbolic.algebra.bivariate import ParametricPair, critical_polynomial
from driftproof.symbolic.algebra.certified import decide_by_enclosure, settled, sign_of_ball
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    ZERO,
    FieldPolynomial,
    Polynomial,
    Scalar,
    X,
    at_ball,
    evaluate,
    from_scalars,
    reflected,
    scalar,
    sign,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT as NO_SECTOR
from driftproof.symbolic.algebra.real_roots import RealRoot, positive_roots, samples
from driftproof.symbolic.linear.region import complex_roots
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


# First and last precision, in bits, at which balls test a ray. If the last does not decide, |R| may touch 1 on the ray,
# and the exact test follows. Chosen: the first is about a double; more than the last would only delay the exact test.
FIRST_SECTOR_BITS, LAST_SECTOR_BITS = 64, 4096


class EnclosedTangent:
    """The number tan α, enclosed by bisection to any precision; `margin` is the result of `ray_margin`.

    |R| <= 1 in the closed sector up to T = tan² if it holds on the two rays and no pole lies inside, by the theorem of
    Phragmén and Lindelöf for a rational R bounded at infinity. Sectors are nested, so bisection in T finds the largest.
    """

    def __init__(self, r: RationalFunction, margin: list[Polynomial]) -> None:
        """Bracket T by a sector that is stable and one that is not. Raises ValueError if the negative axis is not."""
        self.r, self.margin = r, margin
        self.low, self.high = Fraction(0), Fraction(1)
        self._bits, self._poles = FIRST_SECTOR_BITS, dict[int, list[acb]]()
        if not self.holds(self.low):
            raise ValueError("|R| > 1 somewhere on the negative real axis, so there is no sector")
        while self.holds(self.high):
            self.low, self.high = self.high, 4 * self.high * self.high
        while not self.low:
            middle = self.high / 4
            self.low, self.high = (middle, self.high) if self.holds(middle) else (self.low, middle)

    def ball(self) -> arb:
        """A ball around tan α, at Arb's current precision."""
        while (self.high - self.low) * 2**ctx.prec > self.low:
            # The exponents are bisected first, as T may be 1e-40 or 1e40.
            gap = (self.high // self.low).bit_length() // 2
            middle = self.low * 2**gap if gap > 1 else (self.low + self.high) / 2
            self.low, self.high = (middle, self.high) if self.holds(middle) else (self.low, middle)
        low, high = (arb(as_fmpq(x)).sqrt() for x in (self.low, self.high))
        return low.union(high)

    def holds(self, square: Fraction) -> bool:
        """True if |R| <= 1 in the closed sector with tan² = square."""
        return self._holds_on_rays(square) and not self._has_pole_inside(square)

    def _holds_on_rays(self, square: Fraction) -> bool:
        """True if |R| <= 1 on the two rays, decided by balls if they suffice, else exactly."""
        while self._bits <= LAST_SECTOR_BITS:
            with ctx.workprec(self._bits):
                x = arb(scalar(square))
                verdict = positive_in_balls([at_ball(c, x) for c in self.margin])
            if verdict is not None:
                return verdict
            self._bits *= 2
        self._bits = FIRST_SECTOR_BITS
        return negative_point(_at(self.margin, scalar(square))) is None

    def _has_pole_inside(self, square: Fraction) -> bool:
        """True if some pole has Re < 0 and Im² < square Re². A pole with equality would make the margin negative."""

        def read() -> bool | None:
            if ctx.prec not in self._poles:
                self._poles[ctx.prec] = complex_roots(self.r.den, ctx.prec)
            verdicts = [_is_inside(z, square) for z in self._poles[ctx.prec]]
            return None if None in verdicts else any(verdicts)

        return settled(read)


def positive_in_balls(balls: list[arb]) -> bool | None:
    """Whether p > 0 on (0, oo) for every p with coefficients in these balls, constant term first; None if undecided.

    True if the leading coefficient is positive and no ball around a root meets the positive axis. False if p is
    negative at one of some points near the roots that may lie on the axis and between them.
    """
    leading = sign_of_ball(balls[-1])
    if leading is None:
        return None
    try:
        roots = acb_poly(balls).roots(tol=arb(2) ** (-ctx.prec // 4))
    except ValueError:  # the balls of the coefficients are too wide
        return None
    near = [z.real.abs_upper() for z in roots if z.imag.contains(0) and sign_of_ball(z.real) != -1]
    if not near:
        return leading == 1
    near.sort(key=dyadic)
    p = arb_poly(balls)
    points = [*((a + b) / 2 for a, b in pairwise(near)), *(x / 2 for x in near[:1]), *(2 * x for x in near[-1:])]
    return False if any(p(x) < 0 for x in points) else None


def _is_inside(z: acb, square: Fraction) -> bool | None:
    """True if the pole z lies in the sector with tan² = square; None if its ball does not decide."""
    reach = z.real**2 * arb(as_fmpq(square)) - z.imag**2
    right, within = sign_of_ball(z.real), sign_of_ball(reach)
    if right == 1 or within == -1:
        return False
    return True if (right, within) == (-1, 1) else None


# Largest size in bits, by `critical_bits`, of the exact critical polynomial; chosen: longer ones soon take minutes.
LARGEST_EXACT_BITS = 2**17


@dataclass(frozen=True)
class Angle:
    """An angle from 0 to 90 degrees, given by its tangent."""

    tangent: Limit | EnclosedTangent

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


def sector_tangent(r: RationalFunction) -> Limit | EnclosedTangent:
    """tan α for the largest α <= 90° with |R(z)| <= 1 wherever |arg(-z)| < α; `oo` if A-stable, 0 without a sector.

    On the ray z = x(-1 + it) the margin |Q|² - |P|² is a polynomial in x and T = t². Its sign pattern in x > 0 can
    only change at a T where its leading, trailing or first nonzero principal subresultant coefficient vanishes; one
    rational T decides each interval between (basu-pollack-roy-2006, chapter 5). If that coefficient is a polynomial of
    more than LARGEST_EXACT_BITS, bisection encloses the number, unless |R| = 1 somewhere on the negative axis.
    """
    if r.num.degree() > r.den.degree():
        return NO_SECTOR
    if a_stability(r):
        return INFINITY
    margin = ray_margin(r)
    on_axis = _at(margin, fmpq(0))
    if negative_point(on_axis) is not None:
        return NO_SECTOR
    if critical_bits(margin) > LARGEST_EXACT_BITS and not positive_roots([on_axis]):
        return EnclosedTangent(r, margin)
    return sector_tangent_by_rays(margin)


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
