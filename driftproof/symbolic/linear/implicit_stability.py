"""I-, A- and L-stability of a rational stability function, decided exactly, with a reason that can be checked."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq

from driftproof.symbolic.algebra.polynomials import Polynomial, Scalar, evaluate, reflected, sign
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import positive_roots, samples
from driftproof.symbolic.linear.limits import imaginary_margin


@dataclass(frozen=True)
class Decision:
    """A yes or no with its reason; `witness`, where a no has one, is a rational point that shows it."""

    holds: bool
    reason: str
    witness: Fraction | None = None

    def __bool__(self) -> bool:
        """The answer."""
        return self.holds


def i_stability(r: RationalFunction) -> Decision:
    """|R(iy)| <= 1 for every real y: |Q(iy)|² - |P(iy)|² >= 0; roots that touch are allowed, poles are not.

    A witness is a y² where it is negative.
    """
    margin = imaginary_margin(r)
    negative = negative_point(margin)
    if negative is not None:
        return Decision(False, "|Q(iy)|**2 - |P(iy)|**2 < 0 at the y**2 given", negative)
    return Decision(True, "|R(iy)| = 1 for every y" if margin == 0 else "|Q(iy)|**2 - |P(iy)|**2 >= 0 for every y")


def a_stability(r: RationalFunction) -> Decision:
    """|R(z)| <= 1 for every z with Re z <= 0: I-stable, and no pole there (hairer-wanner-1996, IV.3).

    By the maximum principle: R is bounded at infinity, as it is on the imaginary axis.
    """
    on_axis = i_stability(r)
    if not on_axis:
        return on_axis
    if not is_hurwitz(reflected(r.den)):
        return Decision(False, "a pole in the left half-plane: the Routh scheme of Q(-z) is not of one sign")
    return Decision(True, f"{on_axis.reason}, and every pole has Re z > 0 (Routh)")


def l_stability(r: RationalFunction) -> Decision:
    """A-stable, and R(z) -> 0 as z -> oo: deg P < deg Q."""
    half_plane = a_stability(r)
    if not half_plane:
        return half_plane
    if r.num.degree() < r.den.degree():
        return Decision(True, f"{half_plane.reason}; R(oo) = 0")
    return Decision(False, f"A-stable, but R(oo) = {r.at_infinity()}")


def negative_point(p: Polynomial) -> Fraction | None:
    """A rational x > 0 with p(x) < 0; None where p >= 0 on all of [0, oo).

    Between consecutive positive roots the sign is constant, so one rational point decides each interval.
    """
    if p == 0:
        return None
    for inner in samples(positive_roots([p])):
        if sign(evaluate(p, inner)) < 0:
            return _as_fraction(inner)
    return None


def is_hurwitz(p: Polynomial) -> bool:
    """True when every root of p has a negative real part: the first column of the Routh scheme is of one sign.

    A zero in that column, the degenerate case, is met only if some root has Re >= 0 (gantmacher-1959, XV.4).
    Raises ValueError for the zero polynomial.
    """
    if p == 0:
        raise ValueError("the zero polynomial has every number as a root")
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


def _as_fraction(x: fmpq) -> Fraction:
    return Fraction(int(x.p), int(x.q))
