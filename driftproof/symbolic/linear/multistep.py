"""What is true of a linear multistep method: order, root condition, A- and A(α)-stability, limits; all decided exactly.

The tests in the complex plane of z = hλ are those of the function ρ/σ outside the unit disc (hairer-wanner-1996, V.1).
"""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from itertools import count
from math import factorial
from typing import NamedTuple

from driftproof.methods.multistep import Multistep
from driftproof.methods.number_field import as_fmpq, as_fraction
from driftproof.symbolic.algebra.polynomials import (
    Polynomial,
    X,
    at_ball,
    coefficients,
    even_part,
    greatest_common_divisor,
    interpolate,
    modulus_squared_on_imaginary_axis,
    odd_part,
    polynomial,
    quotient,
    reflected,
    sign,
)
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.algebra.real_roots import (
    ZERO_ROOT,
    RealRoot,
    positive_roots,
    rational_root,
    samples,
    the_one,
    vanishes_at,
)
from driftproof.symbolic.linear.a_stability import Angle, is_hurwitz, negative_point
from driftproof.symbolic.linear.facts import AStability, ExactFunction, FactsOfFamily, Sector, fact_names
from driftproof.symbolic.linear.root_condition import (
    RootCondition,
    half_plane_form,
    root_condition,
    root_condition_limit,
    valuation,
)
from driftproof.symbolic.linear.stability_limits import INFINITY, Limit, smallest

# Points of the root locus as a fact: on either side of ζ = i.
_LOCUS_POINTS = 6


class Residual(NamedTuple):
    """Why the order is no higher: L(tᵖ⁺ᵈ)/(p + d)!, the first residual, on the polynomial solution of this `power`."""

    power: int
    residual: Fraction


class Barrier(NamedTuple):
    """The highest order of zero-stable methods of so many steps (dahlquist-1956), and whether this one has it."""

    highest_order: int
    attained: bool


class LocusPoint(NamedTuple):
    """z = ρ(ζ)/σ(ζ) for the ζ on the unit circle with this real and imaginary part: all exact."""

    cosine: Fraction
    sine: Fraction
    re: Fraction
    im: Fraction


class MultistepFacts(FactsOfFamily[Multistep]):
    """The exact facts about a linear multistep method, each derived when it is first asked for.

    Those of y' = λy, z = hλ, are None of methods for y'' = F(y). Where rho and sigma have a common factor,
    zero-stability is of rho as it is, stability at z is that of the method without the factor: `common_factor` says so.

    >>> from driftproof.methods.catalogue import FACTS_ONLY
    >>> facts = MultistepFacts(FACTS_ONLY["bdf2"])
    >>> facts.order, facts.a_stable, facts.error_constant
    (2, True, Fraction(-1, 3))
    """

    kind = "multistep"

    @cached_property
    def rho(self) -> ExactFunction:
        """ρ(ζ) = Σ ρⱼ ζʲ."""
        return ExactFunction(fraction(self._written[0]), "zeta")

    @cached_property
    def sigma(self) -> ExactFunction:
        """σ(ζ) = Σ σⱼ ζʲ."""
        return ExactFunction(fraction(self._written[1]), "zeta")

    @cached_property
    def common_factor(self) -> ExactFunction | None:
        """The common factor of rho and sigma; None where the method is irreducible."""
        found = greatest_common_divisor(*self._written)
        return None if not found.degree() else ExactFunction(fraction(found), "zeta")

    @cached_property
    def order(self) -> int:
        """The largest p such that every polynomial solution of degree p + d - 1 is followed exactly."""
        return self.order_fails.power - self.method.derivative

    @cached_property
    def order_fails(self) -> Residual:
        """The first power of t on which the method fails, and by how much, for h = 1."""
        return next(Residual(power, x) for power in count() if (x := _residual(self.method, power)))

    @cached_property
    def error_constant(self) -> Fraction | None:
        """C = C_{p+d}/σ(1): the global error begins like that of a method with local error C hᵖ⁺ᵈ y⁽ᵖ⁺ᵈ⁾ (III.2)."""
        total = sum(self.method.sigma)
        return None if not total else self.order_fails.residual / total

    @cached_property
    def zero_stable(self) -> bool:
        """Whether its numbers stay bounded on y' = 0, or grow no faster than n on y'' = 0."""
        return self.root_condition.holds

    @cached_property
    def root_condition(self) -> RootCondition:
        """The condition on the roots of rho, with its reason."""
        return root_condition(self._written[0], self.method.derivative)

    @cached_property
    def convergent(self) -> bool:
        """Zero-stable and of order 1 at least: that is necessary and sufficient (dahlquist-1956)."""
        return self.zero_stable and self.order >= 1

    @cached_property
    def first_barrier(self) -> Barrier | None:
        """Of methods for y' = F(y): k + 2 for even k, k + 1 for odd, k for explicit ones; above it none is zero-stable.

        Raises AssertionError where what was derived contradicts it.
        """
        if self.method.derivative != 1:
            return None
        k = self.method.steps
        highest = k if self.method.sigma[-1] * self.method.rho[-1] <= 0 else k + 2 - k % 2
        if self.zero_stable and self.order > highest:
            raise AssertionError(f"{self.method.key}: order {self.order} is above Dahlquist's barrier {highest}")
        return Barrier(highest, self.zero_stable and self.order == highest)

    @cached_property
    def a_stable(self) -> bool | None:
        """Whether its numbers stay bounded on y' = λy for every z with Re z <= 0."""
        return None if self.a_stability is None else self.a_stability.holds

    @cached_property
    def a_stability(self) -> AStability | None:
        """A-stability with its reason; where it fails on the locus, `witness` is the tan²(arg ζ/2) of such a point.

        Exactly if ρ/σ is positive real outside the disc: Re(ρ/σ) >= 0 on the circle, no root of ρ + σ outside or on it.
        Raises AssertionError where what was derived contradicts the second barrier (dahlquist-1963).
        """
        if self.method.derivative != 1:
            return None
        holds, reason, witness = self._positive_real()
        constant = self.error_constant or Fraction(0)
        if holds and (self.method.explicit or self.order > 2 or (self.order == 2 and constant > Fraction(-1, 12))):
            raise AssertionError(f"{self.method.key}: A-stable against Dahlquist's second barrier")
        return AStability(holds, reason, witness, coefficients(self._on_circle[0]))

    @cached_property
    def sector(self) -> Sector | None:
        """The widest sector |arg(-z)| < α in which it is stable: A(α)-stability."""
        if self.method.derivative != 1:
            return None
        tangent = INFINITY if self.a_stable else self._sector_tangent()
        return Sector(tangent, Angle(tangent))

    @cached_property
    def real_limit(self) -> Limit | None:
        """The largest x₀ such that its numbers stay bounded for every z in (-x₀, 0)."""
        return None if self.method.derivative != 1 else root_condition_limit(*self._irreducible)

    @cached_property
    def imaginary_limit(self) -> Limit:
        """The largest y₀ such that they do for z = iy, 0 < y < y₀; on y'' = -ω²y, for 0 < hω < y₀."""
        rho, sigma = self._irreducible
        squares = (rho * rho, sigma * sigma) if self.method.derivative == 1 else (rho, sigma)
        found = root_condition_limit(*squares)
        return found.square_root() if isinstance(found, RealRoot) else found

    @cached_property
    def root_locus(self) -> list[LocusPoint]:
        """Points ρ(ζ)/σ(ζ) with |ζ| = 1, Im ζ > 0, where a root of the method crosses the circle; poles left out."""
        halves = [Fraction(k, _LOCUS_POINTS) for k in range(1, _LOCUS_POINTS)]
        found = (self._locus_point(t) for t in [*halves, Fraction(1), *(1 / t for t in reversed(halves))])
        return [point for point in found if point is not None]

    @property
    def _written(self) -> tuple[Polynomial, Polynomial]:
        return polynomial(self.method.rho), polynomial(self.method.sigma)

    @cached_property
    def _irreducible(self) -> tuple[Polynomial, Polynomial]:
        rho, sigma = self._written
        common = greatest_common_divisor(rho, sigma)
        return quotient(rho, common), quotient(sigma, common)

    @cached_property
    def _in_half_plane(self) -> tuple[Polynomial, Polynomial]:
        rho, sigma = self._irreducible
        return half_plane_form(rho, rho.degree()), half_plane_form(sigma, rho.degree())

    @cached_property
    def _on_circle(self) -> tuple[Polynomial, Polynomial]:
        """M and K with ρσ̄ ~ M(s) + iy K(s) at w = iy, s = y², times a positive number."""
        r, s = self._in_half_plane
        product = r * reflected(s)
        return reflected(even_part(product)), reflected(odd_part(product))

    def _stable_at_minus_one(self) -> bool:
        """Every root of ρ + σ is inside the circle."""
        rho, sigma = self._irreducible
        both = half_plane_form(rho + sigma, rho.degree())
        return both.degree() == rho.degree() and is_hurwitz(both)

    def _positive_real(self) -> tuple[bool, str, Fraction | None]:
        if not self._stable_at_minus_one():
            return False, "rho + sigma, of z = -1, has a root on or outside the unit circle", None
        negative = negative_point(self._on_circle[0])
        if negative is not None:
            return False, "Re(rho/sigma) < 0 on the unit circle, at the tan(arg/2)**2 given", negative
        return True, "Re(rho/sigma) >= 0 on the unit circle, and rho + sigma has all roots inside (Routh)", None

    def _sector_tangent(self) -> Limit:
        """tan α: the least of |Im z|/|Re z| on the locus where Re z < 0, as ρ/σ maps |ζ| = 1 to its borders.

        A sector that meets the locus is not stable: near ζ₀ some |ζ| > 1 has its z there, as ρ/σ is open. On the locus
        tan² = s K²/M², which is least at a root of its derivative, of M = K = 0, or at 0 or oo, where its limit is 0
        or oo, as one of the two degrees is odd.
        """
        if not self._stable_at_minus_one():
            return ZERO_ROOT
        m, k = self._on_circle
        common = greatest_common_divisor(m, k)
        top, bottom = quotient(k, common), quotient(m, common)
        slope = (top + 2 * X * top.derivative()) * bottom - 2 * X * top * bottom.derivative()
        points = positive_roots([p for p in (m, top, slope, common) if p])
        below = [sign(m(x)) == -1 for x in samples(points)]
        at_ends = (below[0] and valuation(bottom) <= valuation(top), below[-1] and bottom.degree() > top.degree())
        if not top or any(at_ends):
            return ZERO_ROOT
        near = [x for x, left, right in zip(points, below, below[1:], strict=False) if left or right]
        values = [_square_of_tangent(top, bottom, x) for x in near if not vanishes_at(bottom, x)]
        least = smallest(values)
        return least.square_root() if isinstance(least, RealRoot) else least

    def _locus_point(self, half: Fraction) -> LocusPoint | None:
        """ρ/σ at w = i tan(arg ζ/2)."""
        _, s = self._in_half_plane
        square = as_fmpq(half * half)
        size = modulus_squared_on_imaginary_axis(s)(square)
        if not size:
            return None
        m, k = self._on_circle
        re, im = (as_fraction(p(square) / size) for p in (m, k))
        return LocusPoint((1 - half * half) / (1 + half * half), 2 * half / (1 + half * half), re, half * im)


MULTISTEP_ON_REQUEST = ("root_locus",)
_IDENTITY = ("method", "title", "family", "derivative", "source", "steps", "explicit", "decimal", "rho", "sigma")
_DERIVED = (name for name in fact_names(MultistepFacts) if name not in MULTISTEP_ON_REQUEST)
# Every fact by name, in the order in which a reader wants them.
MULTISTEP_FACTS = tuple(dict.fromkeys((*_IDENTITY, "inconsistencies", "claimed_order", *_DERIVED)))


def _residual(method: Multistep, power: int) -> Fraction:
    """L(tᵖ)/p! at t = 0, h = 1: Σ ρⱼ jᵖ/p! - Σ σⱼ jᵖ⁻ᵈ/(p - d)!."""
    left = sum((x * j**power for j, x in enumerate(method.rho)), Fraction(0)) / factorial(power)
    lower = power - method.derivative
    if lower < 0:
        return left
    return left - sum((x * j**lower for j, x in enumerate(method.sigma)), Fraction(0)) / factorial(lower)


def _square_of_tangent(top: Polynomial, bottom: Polynomial, s: RealRoot) -> RealRoot:
    """T = s K(s)²/M(s)², a root of the resultant of s's polynomial and sK² - TM²."""
    if vanishes_at(top, s):
        return ZERO_ROOT
    if s.rational is not None:
        x = as_fmpq(s.rational)
        return rational_root(as_fraction(x * (top(x) / bottom(x)) ** 2))
    monic = s.polynomial / s.minimal[-1]
    product = interpolate(lambda t: monic.resultant(X * top * top - bottom * bottom * t), s.degree)

    def fits(root: RealRoot) -> bool:
        x = s.ball()
        return bool(root.ball().overlaps(x * (at_ball(top, x) / at_ball(bottom, x)) ** 2))

    return the_one(positive_roots([product]), fits)
