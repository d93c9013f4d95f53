"""A-, I- and L-stability: theorems about Padé approximants and collocation, contact with the boundary, twins."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import ctx, fmpq, fmpq_poly
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.symbolic.algebra.polynomials import (
    coefficients,
    evaluate,
    exact,
    modulus_squared_on_imaginary_axis,
    polynomial,
    reflected,
    scalar,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT
from driftproof.symbolic.linear.a_stability import (
    a_stability,
    i_stability,
    is_hurwitz,
    l_stability,
    negative_point,
    ray_margin,
    sector_tangent,
    sector_tangent_by_rays,
)
from driftproof.symbolic.linear.stability_function import (
    NodeTableau,
    resolvent,
    scalar_tableau,
    stability_function,
    stability_function_by_determinants,
    stability_function_by_moments,
    stability_function_of_collocation,
)
from driftproof.symbolic.linear.stability_limits import INFINITY, imaginary_limit, imaginary_margin, real_limit
from tests.symbolic.linear.linear_examples import ROOT_2, ROOT_3, Z, pade, sdirk

PADE = [(j, k) for j in range(7) for k in range(7)]


@pytest.mark.parametrize(("num", "den"), PADE)
def test_pade_is_a_stable_exactly_on_three_diagonals(num: int, den: int) -> None:
    """Ehle's conjecture, a theorem: num <= den <= num + 2 (hairer-wanner-1996, IV.4)."""
    r = pade(num, den)
    assert bool(a_stability(r)) == (num <= den <= num + 2)
    assert bool(l_stability(r)) == (num < den <= num + 2)
    assert bool(i_stability(r)) == (num <= den <= num + 2 or (num, den) == (0, 6))  # which has poles on the left
    if num <= den <= num + 2:
        assert (real_limit(r), imaginary_limit(r), sector_tangent(r)) == (INFINITY, INFINITY, INFINITY)


def shifted_legendre(degree: int) -> Any:
    p = (Z**2 - Z) ** degree
    for _ in range(degree):
        p = p.derivative()
    return p


@pytest.mark.parametrize("stages", range(1, 11))
def test_gauss_radau_and_lobatto_are_pade(stages: int) -> None:
    """R of Gauss, Radau IIA and Lobatto IIIA on the diagonal, below it, and on the diagonal again."""
    below = shifted_legendre(stages - 1)
    gauss = stability_function_of_collocation(coefficients(shifted_legendre(stages)))
    assert gauss == pade(stages, stages)
    weight = shifted_legendre(stages)(1) / below(1)
    radau = stability_function_of_collocation(coefficients(shifted_legendre(stages) - below * weight))
    assert radau == pade(stages - 1, stages)
    assert a_stability(gauss).reason.startswith("|R(iy)| = 1 for every y")
    assert l_stability(radau)


@pytest.mark.parametrize("nodes", [(-1, 30, -210, 560, -630, 252), (0, 1), (-1, 1), (Q(2, 9), -1, 1), (1, -5, 5)])
def test_collocation_function_by_the_monomial_tableau(nodes: tuple[Q | int, ...]) -> None:
    """The second formula integrates in Q[x]/M and needs no node either."""
    monic = polynomial(nodes) / polynomial(nodes).leading_coefficient()
    assert stability_function_by_moments(NodeTableau.of(monic)) == stability_function_of_collocation(nodes)


def test_collocation_needs_a_node() -> None:
    with pytest.raises(ValueError, match="at least one node"):
        stability_function_of_collocation((3,))


# ---- contact with the boundary

BLASCHKE = ((1 + Z / 4) ** 3, (1 - Z / 4) ** 3)  # of modulus 1 on the axis, equal to 1 at y = 0 and y = ±4 sqrt(3)


def contact(extra: fmpq) -> RationalFunction:
    """φ(B(z)) with φ(w) = w((1 + extra) + w)/(2 + extra): of modulus 1 where B = 1, below elsewhere on the disc."""
    num, den = BLASCHKE
    return fraction(num * (den * (1 + extra) + num), den * den * (2 + extra))


def test_contact_with_the_boundary_at_a_finite_point_is_a_stable() -> None:
    r = contact(fmpq(0))
    margin = imaginary_margin(r)
    assert margin(48) == 0  # y = 4 sqrt(3)
    assert margin.derivative()(48) == 0
    assert a_stability(r)
    assert imaginary_limit(r) is INFINITY
    assert sector_tangent_by_rays(ray_margin(r)) is INFINITY


def test_contact_that_becomes_a_crossing_is_not_a_stable() -> None:
    """The twin: the numerator 1e-30 larger at the contact, and at no other decimal visible."""
    num, den = contact(fmpq(0)).num, contact(fmpq(0)).den
    swollen = fraction(num + Z * Z * fmpq(1, 10**30) * (1 + Z / 4) ** 2, den)
    found = a_stability(swollen)
    assert not found
    assert found.witness is not None
    assert exact(evaluate(imaginary_margin(swollen), scalar(found.witness))) < 0


def test_i_stable_with_poles_on_the_wrong_side_is_not_a_stable() -> None:
    r = fraction(1 - Z / 2, 1 + Z / 2)
    assert i_stability(r)
    assert not a_stability(r)
    assert "pole" in a_stability(r).reason
    assert real_limit(r) == ZERO_ROOT


def test_pole_on_the_axis_is_not_i_stable_and_a_removable_one_is() -> None:
    assert not i_stability(fraction(fmpq_poly([1]), 1 + Z**2))
    assert i_stability(fraction(1 + Z**2, (1 + Z**2) * (1 - Z)))


GAMMAS = {
    "1/4": (Q(1, 4), True, False),
    "just below 1/4": (Q(1, 4) - Q(1, 10**30), False, False),
    "just above 1/4": (Q(1, 4) + Q(1, 10**30), True, False),
    "order 3, large": (Q(1, 2) + ROOT_3 / 6, True, False),
    "order 3, small": (Q(1, 2) - ROOT_3 / 6, False, False),
    "L-stable, small": (1 - ROOT_2 / 2, True, True),
    "L-stable, large": (1 + ROOT_2 / 2, True, True),
    "negative": (Q(-1), False, False),
}


@pytest.mark.parametrize("name", GAMMAS)
def test_sdirk_family_at(name: str) -> None:
    gamma, a_stable, l_stable = GAMMAS[name]
    r = stability_function(sdirk(gamma))
    assert (bool(a_stability(r)), bool(l_stability(r))) == (a_stable, l_stable)


@pytest.mark.parametrize("name", GAMMAS)
def test_two_formulas_for_r_agree_over_q_and_over_number_fields(name: str) -> None:
    data = scalar_tableau(sdirk(GAMMAS[name][0]))
    r = stability_function_by_moments(data)
    assert stability_function_by_determinants(data) == r
    one = fraction(fmpq_poly([1]))
    assert one + fraction(Z) * resolvent(data, data.power(0)) == r


def test_l_stable_over_a_number_field_needs_the_leading_coefficient_exactly_zero() -> None:
    """gamma = 1 - sqrt(2)/2 makes R(oo) = 0; the twin off by 1e-30 is A-stable only."""
    r = stability_function(sdirk(1 - ROOT_2 / 2 + Q(1, 10**30)))
    assert a_stability(r)
    assert not l_stability(r)
    assert "R(oo) =" in l_stability(r).reason


# ---- Routh and Hurwitz

HURWITZ = {
    (1,): True,
    (1, 1): True,
    (0, 1): False,
    (-1, -1): True,
    (1, 0, 1): False,
    (1, 1, 1, 1): False,  # ±i: the degenerate case
    (1, 2, 1): True,
    (1, 5, 10, 10, 5, 1): True,
    (1, 0, 2, 0, 1): False,
    (6, 11, 6, 1): True,
    (-6, 11, -6, 1): False,
    (2, 3, 0, 1): False,
}


@pytest.mark.parametrize("p", HURWITZ)
def test_hurwitz(p: tuple[int, ...]) -> None:
    assert is_hurwitz(polynomial(p)) == HURWITZ[p]


@given(st.lists(st.fractions(-4, 4, max_denominator=6), min_size=1, max_size=7))
def test_hurwitz_agrees_with_the_complex_roots(c: list[Q]) -> None:
    assume(c[-1] != 0)
    p = polynomial(c)
    with ctx.workprec(300):
        roots = [root for root, _ in p.numer().complex_roots()]
        assume(not any(root.real.contains(0) and not root.real.is_zero() for root in roots))
        assert is_hurwitz(p) == all(root.real < 0 for root in roots)


def test_hurwitz_over_a_number_field() -> None:
    shift = polynomial([ROOT_2 - Q(14142135623730950488, 10**19), 1])  # a root of about -1e-20... on the left
    assert is_hurwitz(shift * polynomial([1, 1]))
    assert not is_hurwitz(polynomial([ROOT_2 - Q(14142135623730950489, 10**19), 1]) * polynomial([1, 1]))
    with pytest.raises(ValueError, match="zero polynomial"):
        is_hurwitz(fmpq_poly())


def test_negative_point_is_a_proof_and_touching_is_not_negative() -> None:
    assert negative_point((Z - 1) ** 2 * (Z**2 - 2) ** 2) is None
    found = negative_point((Z - 1) ** 2 * (Z - 3))
    assert found is not None
    assert 0 < found < 3
    assert found != 1
    assert negative_point(fmpq_poly()) is None
    assert negative_point((Z - 1) ** 2 - fmpq(1, 10**40)) is not None


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=5))
def test_witness_of_instability_is_a_point_where_r_is_too_large(c: list[int]) -> None:
    r = fraction(polynomial([1, *c]), (1 - Z / 3) ** 3)
    found = i_stability(r)
    if not found:
        assert found.witness is not None
        at = scalar(found.witness)
        assert modulus_squared_on_imaginary_axis(r.num)(at) > modulus_squared_on_imaginary_axis(r.den)(at)


def test_pade_0_6_is_i_stable_and_has_poles_in_the_left_half_plane() -> None:
    r = pade(0, 6)
    assert [bool(decide(r)) for decide in (i_stability, a_stability)] == [True, False]
    assert sum(root.real < 0 for root, _ in r.den.numer().complex_roots()) == 2
    assert not is_hurwitz(reflected(r.den))
