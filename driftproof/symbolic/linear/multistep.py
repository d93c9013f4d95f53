"""The exact facts about a linear multistep method: order, root condition, A- and A(α)-stability, stability limits.

Stability at z = hλ is decided by the values of the function ρ/σ outside the unit disc (hairer-wanner-1996, V.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from itertools import count
from math import factorial
from typing import NamedTuple

from flint import arb

from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction
from driftproof.symbolic.algebra.polynomials import (
    Polynomial,
    X,
    at_ball,
    coefficients,
    even_part,
    greatest_common_divisor,
    interpolate,
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
    one_root,
    positive_roots,
    rational_root,
    samples,
    vanishes_at,
)
from driftproof.symbolic.linear.a_stability import Angle, is_hurwitz, negative_point
from driftproof.symbolic.linear.fact_values import AStability, ExactFunction, Sector
from driftproof.symbolic.linear.facts import FactsOfFamily, fact_names
from driftproof.symbolic.linear.printed_digits import RoundedOrder, order_within_digits, roundings
from driftproof.symbolic.linear.root_condition import (
    RootCondition,
    half_plane_form,
    on_circle,
    reciprocal,
    root_condition,
    root_condition_limit,
    valuation,
)
from driftproof.symbolic.linear.stability_limits import INFINITY, Limit, smallest


class Residual(NamedTuple):
    """Why the order p is no higher: the first nonzero residual L(tᵏ)/k! on solutions tᵏ, with k = `power` = p + d."""

    power: int
    residual: Fraction


class Barrier(NamedTuple):
    """The highest order of zero-stable methods with as many steps (dahlquist-1956), and whether this one has it."""

    highest_order: int
    attained: bool


class MultistepFacts(FactsOfFamily[Multistep]):
    """The exact facts about a linear multistep method, each derived at its first use.

    Facts about y' = λy with z = hλ are None for methods for y'' = F(y). If rho and sigma have a `common_factor`, then
    its roots, too, are ζ of numerical solutions ζⁿ, for every z: all facts are about the formula as written.

    >>> from driftproof.methods.catalogue import FURTHER_METHODS
    >>> facts = MultistepFacts(FURTHER_METHODS["bdf2"])
    >>> facts.order, facts.a_stable, facts.error_constant
    (2, True, Fraction(-1, 3))
    """

    kind = "multistep"

    @cached_property
    def rho(self) -> ExactFunction:
        """The polynomial ρ(ζ) = Σ ρⱼ ζʲ."""
        return ExactFunction(fraction(self._written[0]), "zeta")

    @cached_property
    def sigma(self) -> ExactFunction:
        """The polynomial σ(ζ) = Σ σⱼ ζʲ."""
        return ExactFunction(fraction(self._written[1]), "zeta")

    @cached_property
    def common_factor(self) -> ExactFunction | None:
        """The greatest common divisor of rho and sigma; None if the method is irreducible."""
        return ExactFunction(fraction(self._common), "zeta") if self._common.degree() else None

    @cached_property
    def order(self) -> int:
        """The largest p such that every polynomial solution of degree p + d - 1 is reproduced exactly, for y⁽ᵈ⁾ = F."""
        return self.order_fails.power - self.method.derivative

    @cached_property
    def order_fails(self) -> Residual:
        """The first power of t that the method does not reproduce, with its residual for h = 1."""
        return next(Residual(power, x) for power in count() if (x := self.residual(power)))

    @cached_property
    def order_but_for_rounding(self) -> RoundedOrder | None:
        """The order that rounded coefficients miss only by their rounding; None if there is no such order."""
        method = self.method
        if method.claimed_order == self.order:
            return None
        off = roundings(method)
        rho, sigma = [off(x) for x in method.rho], [-off(x) for x in method.sigma]  # so that nothing cancels
        powers = range(2 * method.steps + 4)
        pairs = ((abs(self.residual(n)), _residual(rho, sigma, method.derivative, n)) for n in powers)
        balls = ([(arb(as_fmpq(size)), arb(as_fmpq(radius)))] for size, radius in pairs)
        found = order_within_digits(balls, method.decimal)
        return found and found._replace(order=found.order - method.derivative)

    @cached_property
    def error_constant(self) -> Fraction | None:
        """C = C_{p+d}/σ(1), local errors C hᵖ⁺ᵈ y⁽ᵖ⁺ᵈ⁾ being exact minus computed (III.2); None if σ(1) = 0."""
        total = sum(self.method.sigma)
        return None if not total else self.order_fails.residual / total

    @cached_property
    def zero_stable(self) -> bool:
        """True if numerical solutions stay bounded on y' = 0, or grow no faster than n on y'' = 0."""
        return self.root_condition.holds

    @cached_property
    def root_condition(self) -> RootCondition:
        """Whether the roots of rho satisfy the root condition, with the reason."""
        return root_condition(self._written[0], self.method.derivative)

    @cached_property
    def convergent(self) -> bool:
        """True if zero-stable and of order 1 at least, which is necessary and sufficient (dahlquist-1956)."""
        return self.zero_stable and self.order >= 1

    @cached_property
    def first_barrier(self) -> Barrier | None:
        """The first Dahlquist barrier for y' = F(y): k if σₖ/ρₖ <= 0, else k + 2 for even k and k + 1 for odd k.

        It is None for y'' = F(y). Raises AssertionError if the facts derived here contradict it.
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
        """True if numerical solutions of y' = λy stay bounded for every z with Re z <= 0; None for y'' = F(y)."""
        return None if self.a_stability is None else self.a_stability.holds

    @cached_property
    def a_stability(self) -> AStability | None:
        """A-stability with its reason; if it fails on the locus, `witness` is the tan²(arg ζ/2) of a point there.

        Without a common factor, a method is A-stable exactly if ρ/σ is positive real outside the unit disc: Re(ρ/σ) is
        >= 0 on the circle, and no root of ρ + σ on or outside it. A factor may have roots in the disc, and simple ones
        on the circle where Re(ρ/σ) is not 0. Raises AssertionError if the second barrier contradicts (dahlquist-1963).
        """
        if self.method.derivative != 1:
            return None
        holds, reason, witness = self._positive_real()
        beyond = self.error_constant is not None and (self.order, self.error_constant) > (2, Fraction(-1, 12))
        if holds and (self.method.explicit or beyond):  # with sigma(1) = 0, order and constant are another method's
            raise AssertionError(f"{self.method.key}: found A-stable, which contradicts Dahlquist's second barrier")
        return AStability(holds, reason, witness, coefficients(self._on_circle[0]))

    @cached_property
    def sector(self) -> Sector | None:
        """The widest sector |arg(-z)| < α of stability, for A(α)-stability; None for y'' = F(y)."""
        if self.method.derivative != 1:
            return None
        bounded = root_condition(self._common).holds
        tangent = INFINITY if self.a_stable else self._sector_tangent() if bounded else ZERO_ROOT
        return Sector(tangent, Angle(tangent))

    @cached_property
    def real_limit(self) -> Limit | None:
        """The largest x₀ such that numerical solutions stay bounded for every z in (-x₀, 0); None for y'' = F(y)."""
        return None if self.method.derivative != 1 else root_condition_limit(*self._irreducible, self._common)

    @cached_property
    def imaginary_limit(self) -> Limit:
        """The largest y₀ such that numerical solutions stay bounded for z = iy, or hω = y on y'' = -ω²y, 0 < y < y₀."""
        rho, sigma = self._irreducible
        squares = (rho * rho, sigma * sigma) if self.method.derivative == 1 else (rho, sigma)
        found = root_condition_limit(*squares, self._common)
        return found.square_root() if isinstance(found, RealRoot) else found

    def residual(self, power: int) -> Fraction:
        """The residual on solutions tᵖ, over p!, p = `power`."""
        return _residual(self.method.rho, self.method.sigma, self.method.derivative, power)

    @property
    def _written(self) -> tuple[Polynomial, Polynomial]:
        return polynomial(self.method.rho), polynomial(self.method.sigma)

    @cached_property
    def _common(self) -> Polynomial:
        return greatest_common_divisor(*self._written)

    @cached_property
    def _irreducible(self) -> tuple[Polynomial, Polynomial]:
        rho, sigma = self._written
        return quotient(rho, self._common), quotient(sigma, self._common)

    @cached_property
    def _in_half_plane(self) -> tuple[Polynomial, Polynomial]:
        rho, sigma = self._irreducible
        return half_plane_form(rho, rho.degree()), half_plane_form(sigma, rho.degree())

    @cached_property
    def _on_circle(self) -> tuple[Polynomial, Polynomial]:
        """The polynomials M and K with ρσ̄ = M(s) + iy K(s) at w = iy, s = y², up to a positive factor."""
        r, s = self._in_half_plane
        product = r * reflected(s)
        return reflected(even_part(product)), reflected(odd_part(product))

    def _stable_at_minus_one(self) -> bool:
        """True if every root of ρ + σ lies inside the unit circle, that is if the method is stable at z = -1."""
        rho, sigma = self._irreducible
        both = half_plane_form(rho + sigma, rho.degree())
        return both.degree() == rho.degree() and is_hurwitz(both)

    def _positive_real(self) -> tuple[bool, str, Fraction | None]:
        if not self._stable_at_minus_one():
            return False, "rho + sigma (z = -1) has a root on or outside the unit circle", None
        negative = negative_point(self._on_circle[0])
        if negative is not None:
            return False, "Re(rho/sigma) < 0 on the unit circle, at the given tan(arg/2)**2", negative
        if not root_condition(self._common).holds:
            return False, "the common factor of rho and sigma does not satisfy the root condition", None
        if self._doubles_a_root():
            return False, "the common factor of rho and sigma doubles a root on the unit circle, where Re z = 0", None
        return True, "Re(rho/sigma) >= 0 on the unit circle, and rho + sigma has all roots inside (Routh)", None

    def _doubles_a_root(self) -> bool:
        """True if Re(ρ/σ) = 0 at a root ζ of the common factor, on the circle: there the conjugate of ρ is that of 1/ζ.

        At a pole of ρ/σ, no finite z has the root ζ twice.
        """
        rho, sigma = self._irreducible
        on = on_circle(self._common)
        on = quotient(on, greatest_common_divisor(on, sigma))
        real = rho * reciprocal(sigma, rho.degree()) + reciprocal(rho, rho.degree()) * sigma
        return bool(greatest_common_divisor(on, real).degree() > 0)

    def _sector_tangent(self) -> Limit:
        """tan α, the least |Im z|/|Re z| on the part of the locus with Re z < 0, which bounds the stability region.

        A sector that meets the locus at the z of some ζ₀ is not stable, as ρ/σ is open: it maps some ζ near ζ₀ with
        |ζ| > 1 into the sector. On the locus tan² is s K²/M², which is least at a root of its derivative, at one of
        M = K = 0, or at s = 0 or oo, where its limit is 0 or oo, as sK² and M² differ there by an odd power of s.
        """
        if not self._stable_at_minus_one():
            return ZERO_ROOT
        m, k = self._on_circle
        if not k:
            return ZERO_ROOT
        common = greatest_common_divisor(m, k)
        top, bottom = quotient(k, common), quotient(m, common)
        slope = (top + 2 * X * top.derivative()) * bottom - 2 * X * top * bottom.derivative()
        points = positive_roots([p for p in (m, top, slope, common) if p])
        below = [sign(m(x)) == -1 for x in samples(points)]
        at_ends = (below[0] and valuation(bottom) <= valuation(top), below[-1] and bottom.degree() > top.degree())
        if any(at_ends):
            return ZERO_ROOT
        near = [x for x, left, right in zip(points, below, below[1:], strict=False) if left or right]
        values = [_square_of_tangent(top, bottom, x) for x in near if not vanishes_at(bottom, x)]
        least = smallest(values)
        return least.square_root() if isinstance(least, RealRoot) else least


_IDENTITY = ("method", "title", "family", "derivative", "source", "steps", "explicit", "decimal", "rho", "sigma")
# The names of all facts, in the order in which they are printed.
MULTISTEP_FACTS = tuple(dict.fromkeys((*_IDENTITY, "inconsistencies", "claimed_order", *fact_names(MultistepFacts))))


def _residual(rho: Sequence[Fraction], sigma: Sequence[Fraction], derivative: int, power: int) -> Fraction:
    """The residual L(tᵖ)/p! = Σ ρⱼ jᵖ/p! - Σ σⱼ jᵖ⁻ᵈ/(p - d)! at t = 0, h = 1, for p = `power`, d = `derivative`."""
    pairs = ((rho, power, 1), (sigma, power - derivative, -1))
    terms = (sign * x * Fraction(j**n, factorial(n)) for row, n, sign in pairs if n >= 0 for j, x in enumerate(row))
    return sum(terms, Fraction(0))


def _square_of_tangent(top: Polynomial, bottom: Polynomial, s: RealRoot) -> RealRoot:
    """T = s K²/M² with K/M = top/bottom, a root of the resultant of the minimal polynomial of s and sK² - TM²."""
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

    return one_root(positive_roots([product]), fits)
