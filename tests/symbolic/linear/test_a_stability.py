"""I-, A-, L- and A(α)-stability: Padé, contact with the boundary, Hurwitz, and angles in print."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import ctx, fmpq, fmpq_poly
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.methods.numbers.number_field import square_root
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.algebra.polynomials import (
    evaluate,
    exact,
    modulus_squared_on_imaginary_axis,
    polynomial,
    scalar,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.linear.a_stability import (
    LARGEST_CRITICAL_BITS,
    Angle,
    a_stability,
    critical_bits,
    i_stability,
    is_hurwitz,
    l_stability,
    ray_margin,
    sector_tangent,
    sector_tangent_by_rays,
)
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import INFINITY, imaginary_limit, imaginary_margin, real_limit
from driftproof.texts.writing.records import record
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
    assert i_stability(r).reason == "|R(iy)| = 1 for every y"
    assert i_stability(contact(fmpq(0))).reason == "|Q(iy)|**2 - |P(iy)|**2 >= 0 for every y"
    assert not a_stability(r)
    assert "pole" in a_stability(r).reason
    assert real_limit(r) == ZERO_ROOT


def test_pole_on_the_axis_is_not_i_stable_and_a_removable_one_is() -> None:
    assert not i_stability(fraction(fmpq_poly([1]), 1 + Z**2))
    assert i_stability(fraction(1 + Z**2, (1 + Z**2) * (1 - Z)))


def test_l_stable_over_a_number_field_needs_the_leading_coefficient_exactly_zero() -> None:
    """gamma = 1 - sqrt(2)/2 makes R(oo) = 0; the twin off by 1e-30 is A-stable only."""
    r = stability_function(sdirk(1 - ROOT_2 / 2 + Q(1, 10**30)))
    assert a_stability(r)
    assert not l_stability(r)
    assert "R(oo) =" in l_stability(r).reason


HURWITZ = {
    (1,): True, (1, 1): True, (0, 1): False, (-1, -1): True, (1, 0, 1): False,
    (1, 1, 1, 1): False,  # ±i: the degenerate case
    (1, 2, 1): True, (1, 5, 10, 10, 5, 1): True, (1, 0, 2, 0, 1): False, (6, 11, 6, 1): True, (-6, 11, -6, 1): False,
    (2, 3, 0, 1): False,
}  # fmt: skip


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


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=5))
def test_witness_of_instability_is_a_point_where_r_is_too_large(c: list[int]) -> None:
    r = fraction(polynomial([1, *c]), (1 - Z / 3) ** 3)
    found = i_stability(r)
    if not found:
        assert found.witness is not None
        at = scalar(found.witness)
        assert modulus_squared_on_imaginary_axis(r.num)(at) > modulus_squared_on_imaginary_axis(r.den)(at)


@pytest.mark.parametrize(
    ("num", "den", "degrees"), [(0, 3, "88.23"), (0, 4, "83.98"), (0, 5, "79.11"), (1, 4, "89.73")]
)
def test_sectors_of_pade_approximants(num: int, den: int, degrees: str) -> None:
    tangent = sector_tangent(pade(num, den))
    assert isinstance(tangent, RealRoot)
    assert significant(Angle(tangent).exact, 4) == degrees


def test_sector_does_not_know_the_unit_of_length() -> None:
    """R(z sqrt 2), over a number field, has the sector of R."""
    r = pade(0, 3)
    scaled = fraction(polynomial([1]), polynomial([exact(c) * ROOT_2**k for k, c in enumerate(r.den.coeffs())]))
    assert sector_tangent(scaled) == sector_tangent(r)


def test_contact_on_the_negative_axis_leaves_no_sector() -> None:
    """R = 2s/(1 + s²) is at most 1 where s is real, and 1 at z = -1, where s - 1 has a double root: not nearby."""
    s = 1 + Z**2 * (Z + 1) ** 2
    r = fraction(2 * s, 1 + s * s)
    assert r.den.degree() == 8  # too large for the exact method, were it not for the contact
    assert real_limit(r) is INFINITY
    assert sector_tangent(r) == ZERO_ROOT


@pytest.mark.parametrize("r", [fraction(fmpq_poly([1]), 1 + Z**2), fraction(1 - Z**3 / 10, (1 + Z**2 / 2) ** 2)])
def test_sector_that_ends_at_the_origin(r: RationalFunction) -> None:
    """R = 1 - z² + ...: near 0, |R| <= 1 up to 45 degrees and no further."""
    tangent = sector_tangent(r)
    assert record(tangent)["exact"] == "1"
    assert significant(Angle(tangent).exact, 6) == "45.0000"


def test_sector_of_a_margin_over_a_field_that_is_rational_on_the_axis() -> None:
    """(1 + sqrt(2) T)(1 - 4 T x + x²) is negative for some x > 0 from T = 1/2 on, and rational at T = 0."""
    margin = [polynomial([1, square_root(2)]) * c for c in (1, polynomial([0, -4]), 1)]
    assert sector_tangent_by_rays(margin) == RealRoot((-1, 0, 2), 1)


def test_no_sector_for_polynomials_and_for_what_is_unstable_at_infinity() -> None:
    assert sector_tangent(fraction(1 + Z)) == ZERO_ROOT
    assert sector_tangent(fraction(1 - 2 * Z, 1 - Z)) == ZERO_ROOT
    assert (record(Angle(ZERO_ROOT)), record(Angle(INFINITY))) == ("0", "90")


def test_bits_of_the_critical_polynomial_are_estimated_from_degrees_and_coefficients() -> None:
    functions = (pade(0, 3), pade(1, 4), stability_function(sdirk(Q(1, 2) - ROOT_3 / 6)))
    assert [critical_bits(ray_margin(r)) for r in functions] == [1458, 9464, 250]
    # None is told whose equation is too long.
    assert critical_bits(ray_margin(pade(2, 10))) > LARGEST_CRITICAL_BITS
    assert sector_tangent(pade(2, 10)) is None
