"""A(α)-stability: published angles, two methods, and certified points of the boundary."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb, ctx, fmpq_poly

from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.algebra.polynomials import from_scalars, polynomial, scalar
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.linear.a_stability import (
    Angle,
    EnclosedTangent,
    negative_point,
    ray_margin,
    sector_tangent,
    sector_tangent_by_rays,
)
from driftproof.symbolic.linear.region import boundary_points
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import INFINITY, real_limit
from driftproof.texts.writing.records import number_record, record
from tests.symbolic.linear.linear_examples import ROOT_3, Z, pade, sdirk


@pytest.mark.parametrize(
    ("num", "den", "degrees"), [(0, 3, "88.23"), (0, 4, "83.98"), (0, 5, "79.11"), (1, 4, "89.73")]
)
def test_sectors_of_pade_approximants(num: int, den: int, degrees: str) -> None:
    tangent = sector_tangent(pade(num, den))
    assert isinstance(tangent, RealRoot)
    assert significant(Angle(tangent).exact, 4) == degrees


def test_sector_of_order_three_without_a_numerator() -> None:
    tangent = sector_tangent(pade(0, 3))
    assert number_record(tangent, 12) == {
        "exact": None,
        "minpoly": "81*x**14 - 84830*x**12 - 6537*x**10 - 129912*x**8 - 78065*x**6 - 39990*x**4 - 6711*x**2 - 340",
        "interval": ["32", "33"],
        "decimal": "32.3629798962",
    }


@pytest.mark.parametrize(("num", "den"), [(0, 3), (0, 4), (1, 4), (0, 5)])
def test_boundary_of_the_region_stays_outside_the_sector_and_comes_near_it(num: int, den: int) -> None:
    """The witness: of hundreds of certified points on |R| = 1, none is in the sector, and one is within 0.1 degrees."""
    r = pade(num, den)
    tangent = sector_tangent(r)
    assert isinstance(tangent, RealRoot)
    alpha = tangent.ball().atan()
    angles = [abs((-point.z).arg()) for point in boundary_points(r, 60) if not point.z.contains(0)]
    assert len(angles) > 200
    assert all(angle > alpha or angle.overlaps(alpha) for angle in angles)
    assert any(angle < alpha + arb.pi() / 1800 for angle in angles)


def test_contact_on_the_negative_axis_leaves_no_sector() -> None:
    """R = 2s/(1 + s²) is at most 1 where s is real, and 1 at z = -1, where s - 1 has a double root: not nearby."""
    s = 1 + Z**2 * (Z + 1) ** 2
    r = fraction(2 * s, 1 + s * s)
    assert r.den.degree() == 8  # too large for the exact method, were it not for the contact
    assert real_limit(r) is INFINITY
    assert sector_tangent(r) == ZERO_ROOT


def test_sector_that_ends_at_the_origin() -> None:
    """R = 1 - z² + ...: near 0, |R| <= 1 up to 45 degrees and no further."""
    tangent = sector_tangent(fraction(fmpq_poly([1]), 1 + Z**2))
    assert record(tangent)["exact"] == "1"
    assert significant(Angle(tangent).exact, 6) == "45.0000"


def test_no_sector_for_polynomials_and_for_what_is_unstable_at_infinity() -> None:
    assert sector_tangent(fraction(1 + Z)) == ZERO_ROOT
    assert sector_tangent(fraction(1 - 2 * Z, 1 - Z)) == ZERO_ROOT
    assert (record(Angle(ZERO_ROOT)), record(Angle(INFINITY))) == ("0", "90")


@pytest.mark.parametrize(("num", "den"), [(0, 3), (0, 4), (1, 4), (2, 5)])
def test_sector_by_bisection_is_the_exact_one(num: int, den: int) -> None:
    """The second method: Phragmén and Lindelöf, a ray and the poles, instead of a discriminant."""
    r = pade(num, den)
    enclosed = EnclosedTangent(r, ray_margin(r))
    exact_one = sector_tangent(r)
    assert isinstance(exact_one, RealRoot)
    assert record(Angle(enclosed)) == record(Angle(exact_one))
    with ctx.workprec(150):
        assert enclosed.ball().overlaps(exact_one.ball())
        assert enclosed.ball().rad() < enclosed.ball() * arb(2) ** -140


def test_sector_of_high_degree_is_enclosed() -> None:
    found = sector_tangent(pade(2, 8))
    assert isinstance(found, EnclosedTangent)
    assert significant(Angle(found).exact, 12) == "84.8830684663"
    first = record(found)
    assert (first["exact"], first["minpoly"]) == (None, None)
    assert first["interval"] == ["11167507641/1000000000", "5583753821/500000000"]
    assert first["decimal"].startswith("11.16750764")
    assert record(found) == first


def test_pole_inside_the_sector_ends_it() -> None:
    """R = 1/(100 (1 + z)) is small on the rays of slope 1 and of slope 1000; the pole -1 lies between them."""
    found = EnclosedTangent(pade(0, 3), ray_margin(pade(0, 3)))
    assert found.holds(Q(1))
    assert not found.holds(Q(10**9))
    found.r = fraction(fmpq_poly([1]), 100 * (1 + Z))
    found.margin = ray_margin(found.r)
    for square in (Q(1), Q(10**6)):
        assert negative_point(from_scalars([c(scalar(square)) for c in found.margin])) is None
        assert not found.holds(square)
    with pytest.raises(ValueError, match="no sector"):
        EnclosedTangent(found.r, found.margin)


def test_sector_by_rays_agrees_where_the_half_plane_decides() -> None:
    for num, den in [(0, 1), (1, 1), (1, 2), (2, 2), (2, 4)]:
        assert sector_tangent_by_rays(ray_margin(pade(num, den))) is INFINITY


def test_sector_over_a_number_field() -> None:
    """γ = (3 - √3)/6 leaves at x = 6 + 4√3 on the negative axis: no sector; 1/(1 - z + z²/2 - a z³) has one."""
    assert sector_tangent(stability_function(sdirk(Q(1, 2) - ROOT_3 / 6))) == ZERO_ROOT
    near = ROOT_3 / Q(1039230485, 10**8)  # about 1/6
    tangent = sector_tangent(fraction(fmpq_poly([1]), polynomial([1, -1, Q(1, 2), -near])))
    assert isinstance(tangent, RealRoot)
    assert significant(Angle(tangent).exact, 5) == "88.230"
