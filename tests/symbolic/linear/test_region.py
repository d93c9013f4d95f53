"""The boundary of the stability region: points of modulus one, real ones, multiple ones, and their decimals."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb, ctx, fmpq, fmpq_poly

from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.algebra.real_roots import RealRoot
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.region import boundary_points, complex_roots, points_at, rounded_boundary
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import GAUSS_2, RADAU_IIA_2, ROOT_3, SDIRK, Z, chebyshev, value


@pytest.mark.parametrize("name", ["rk4", "gauss2", "radau_iia2", "sdirk"])
def test_boundary_points_have_modulus_one(name: str) -> None:
    method = {"rk4": NINE["rk4"], "gauss2": GAUSS_2, "radau_iia2": RADAU_IIA_2, "sdirk": SDIRK}[name]
    r = stability_function_of(method)
    assert r is not None
    points = boundary_points(r, 4, bits=100)
    assert len({point.cosine for point in points}) == 9
    with ctx.workprec(400):
        for cosine, z in points:
            found = value(r, z)
            assert abs(found).contains(1)
            assert found.real.contains(fmpq(*cosine.as_integer_ratio()))
            assert abs(found).rad() < arb(2) ** -60


def test_boundary_on_the_axes_is_where_the_limits_are() -> None:
    r = stability_function_of(NINE["rk4"])
    assert r is not None
    real = [z for z in points_at(r, Q(1)) if z.imag.is_zero()]
    limit = RealRoot((-24, 12, -4, 1), 0)
    assert any((-z.real).overlaps(limit.ball()) for z in real)
    assert points_at(fraction(fmpq_poly([1])), Q(1, 2)) == []


def test_boundary_in_decimals_goes_from_one_to_minus_one() -> None:
    """Of forward Euler, R = 1 + z: a circle about -1, at t = k/3 and its mirror images."""
    r = stability_function_of(NINE["forward_euler"])
    assert r is not None
    assert rounded_boundary(r, 2, 3) == [
        *(("1", "0.000", "0.000"), ("3/5", "-0.400", "0.800"), ("0", "-1.000", "1.000")),
        *(("-3/5", "-1.600", "0.800"), ("-1", "-2.000", "0.000")),
    ]
    assert rounded_boundary(r, 3, 60)[1][2] == f"0.6{0:059}"
    fact = rounded_boundary(r)
    assert (len(fact), fact[1]) == (25, ("143/145", "-0.013793103448276", "0.165517241379310"))


def test_multiple_boundary_points_are_found_once() -> None:
    """T₁₀ touches ±1: double roots of R = ±1; over Q(√3) too, where two others are 10⁻⁸⁰ apart."""
    now = chebyshev(10, 1 + Z / 100)
    assert len(points_at(fraction(now), Q(1))) == 6
    assert len(points_at(fraction(now), Q(-1))) == 5
    square = polynomial([1, ROOT_3]) * polynomial([1, ROOT_3])
    assert len(points_at(fraction(1 + square - square[0], fmpq_poly([1])), Q(1))) == 2
    assert len(points_at(fraction(square), Q(1))) == 2
    near = complex_roots(polynomial([-ROOT_3, 1]) * polynomial([-ROOT_3 - Q(1, 10**80), 1]), 64)
    assert not near[0].overlaps(near[1])
    (double,) = points_at(fraction(square * square * 2 - 1), Q(-1))
    assert (double.real + 1 / arb(3).sqrt()).contains(0)
