"""The root condition: whether a polynomial has its roots in the unit disc, decided exactly, and up to which parameter.

ζ = (1 + w)/(1 - w) maps the half-plane Re w < 0 to the unit disc, and the imaginary axis to its circle, with w = oo
going to ζ = -1. So roots ζ are located by polynomials in w, with Routh's scheme and counts of real roots (jury-1964).
"""

from __future__ import annotations

from typing import NamedTuple

from flint import fmpq, fmpq_poly

from driftproof.methods.numbers.flint_rationals import as_fraction
from driftproof.symbolic.algebra.bivariate import ParametricPair, critical_polynomial
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    X,
    even_part,
    greatest_common_divisor,
    interpolate,
    odd_part,
    polynomial,
    quotient,
    reflected,
    squarefree,
)
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, positive_roots
from driftproof.symbolic.linear.a_stability import is_hurwitz
from driftproof.symbolic.linear.stability_limits import Limit, first_bound, smallest


class RootCondition(NamedTuple):
    """Whether no root lies outside the unit circle, nor too often on it; `strong` if no root but 1 lies on it."""

    holds: bool
    strong: bool
    reason: str


def half_plane_form(p: Polynomial, degree: int) -> Polynomial:
    """The polynomial (1 - w)ᵏ p((1 + w)/(1 - w)), k = `degree`; a root ζ = -1 lowers its degree, as its w is oo."""
    up, down = fmpq_poly([1, 1]), fmpq_poly([1, -1])
    return sum((c * up**j * down ** (degree - j) for j, c in enumerate(p.coeffs())), fmpq_poly())


def root_condition(p: Polynomial, most: int = 1) -> RootCondition:
    """Decide for a nonzero p whether no root has |ζ| > 1 and none with |ζ| = 1 has a multiplicity above `most`."""
    form = half_plane_form(p, p.degree())
    at_minus_one, at_one = p.degree() - form.degree(), valuation(form)
    rest = quotient(form, X**at_one)
    # Pairs of roots w and -w, all imaginary ones among them, are the roots of a common factor of both parts in s = w².
    paired = greatest_common_divisor(even_part(rest), odd_part(rest))
    on_circle = squarefree(paired)
    pairs = on_circle.degree()
    if not is_hurwitz(quotient(rest, paired(X * X))) or len(positive_roots([reflected(on_circle)])) < pairs:
        return RootCondition(False, False, "a root is outside the unit circle")
    multiplicities = {"1": at_one, "-1": at_minus_one, "a conjugate pair": _largest_multiplicity(paired)}
    strong = at_one <= most and not at_minus_one and not paired.degree()
    for where, multiplicity in multiplicities.items():
        if multiplicity > most:
            return RootCondition(False, False, f"on the unit circle, {where} is a root of multiplicity {multiplicity}")
    counted = "a conjugate pair" if pairs < 2 else f"{pairs} conjugate pairs"
    on = [where.replace("a conjugate pair", counted) for where, multiplicity in multiplicities.items() if multiplicity]
    only = f"{on[0]} {'is' if pairs < 2 else 'are'} on it" if on else "none is on it"
    found = f"{' and '.join(on)} are on it" if on[1:] else only
    return RootCondition(True, strong, f"no root is outside the unit circle; {found}")


def valuation(p: Polynomial) -> int:
    """The multiplicity of the root 0 of a nonzero polynomial."""
    return next(k for k, c in enumerate(p.coeffs()) if c)


def _largest_multiplicity(p: Polynomial) -> int:
    """The largest multiplicity of a root; 0 for a constant."""
    found = 0
    while p.degree() > 0:
        p, found = greatest_common_divisor(p, p.derivative()), found + 1
    return found


def reciprocal(p: Polynomial, degree: int) -> Polynomial:
    """The polynomial ζᵏ p(1/ζ), k = `degree`."""
    return fmpq_poly([p[degree - k] for k in range(degree + 1)])


def on_circle(p: Polynomial) -> Polynomial:
    """The factor of the roots on the unit circle, for a p without roots outside it."""
    return greatest_common_divisor(p, reciprocal(p, p.degree()))


def root_condition_limit(a: Polynomial, b: Polynomial, factor: Polynomial = ONE) -> Limit:
    """The largest t₀ such that `factor` (a + t b), of the degree at 0, satisfies the root condition for t in (0, t₀).

    Roots leave the disc only at a t where one comes to the circle, or where two on it meet. Between two intervals in
    which the condition holds, two ζ on the circle cannot meet, as then some t near by would have a ζ outside: if a and
    b have no common root, b(ζ) != 0, and k meeting roots move as ζ + c (Δt)^(1/k) for all k values of the power, of
    which one leads out of the disc for Δt of one sign. So the condition fails at a single t only where a root on the
    circle is one of `factor`, too, or where a and b are constants and vanish. Raises ValueError for a common root.
    """
    if greatest_common_divisor(a, b).degree() > 0:
        raise ValueError("a and b have a common root; divide both by it")
    if not root_condition(factor).holds:
        return ZERO_ROOT
    degree = max(a.degree(), b.degree())
    forms = half_plane_form(a, degree), half_plane_form(b, degree)

    def with_slope(t: fmpq) -> tuple[Polynomial, Polynomial]:
        form = forms[0] + forms[1] * t
        return form, form.derivative()

    merging = critical_polynomial(ParametricPair(with_slope, (degree, degree), (1, 1)))
    critical = [*_meeting_the_circle(forms, degree), *filter(None, [merging])]
    holds = lambda t: (a + b * t).degree() == degree and root_condition(a + b * t).holds
    fixed, leading = on_circle(factor), polynomial([as_fraction(p[degree]) for p in (a, b)])
    doubled = interpolate(lambda t: fixed.resultant(a + b * t), fixed.degree())
    return smallest([first_bound(positive_roots(critical), holds).limit, *positive_roots([leading, doubled])])


def all_inside(p: Polynomial) -> bool:
    """True if every root lies inside the unit circle."""
    form = half_plane_form(p, p.degree())
    return form.degree() == p.degree() and is_hurwitz(form)


def _meeting_the_circle(forms: tuple[Polynomial, Polynomial], degree: int) -> list[Polynomial]:
    """Polynomials with a root t where a root of form₀ + t form₁ comes to the imaginary axis, w = 0 and oo among them.

    There the even and the odd part in w² have a common root, w = 0, or the leading coefficient vanishes. Other common
    roots are of w and -w, of which one lies on the right.
    """

    def halves(t: fmpq) -> tuple[Polynomial, Polynomial]:
        form = forms[0] + forms[1] * t
        return even_part(form), odd_part(form)

    at_one, at_minus_one = (polynomial([as_fraction(form[k]) for form in forms]) for k in (0, degree))
    even, odd = (max(part(form).degree() for form in forms) for part in (even_part, odd_part))
    common = critical_polynomial(ParametricPair(halves, (even, odd), (1, 1)))
    return [p for p in (at_one, at_minus_one, common) if p]
