"""Points of the boundary |R| = 1, and the functions of order reduction on a stiff problem."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import arb, ctx, fmpq, fmpq_mat, fmpq_poly

from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.polynomials import coefficients, exact, polynomial, scalar
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT, RealRoot
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.region import boundary_points, points_at
from driftproof.symbolic.linear.stability_function import prothero_robinson
from driftproof.symbolic.linear.stability_limits import INFINITY
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import (
    GAUSS_2,
    GAUSS_3,
    LOBATTO_3,
    MIDPOINT,
    QIN_ZHANG,
    RADAU_3,
    RADAU_IIA_2,
    ROOT_3,
    SDIRK,
    Z,
    chebyshev,
    value,
)


def test_order_reduction_functions_of_sdirk_and_radau() -> None:
    """ψₖ vanishes up to the stage order; Radau IIA is stiffly accurate: ψ tends to 0 as z grows."""
    zero = fraction(fmpq_poly())
    for power in (1, 2):
        assert prothero_robinson(RADAU_IIA_2, power) == zero
    third = prothero_robinson(RADAU_IIA_2, 3)
    assert third != zero
    assert third.at_infinity() == 0
    assert prothero_robinson(MIDPOINT, 1) == zero
    assert prothero_robinson(MIDPOINT, 2).at_infinity() == Q(1, 4)
    with pytest.raises(ValueError, match="numbered from 1"):
        prothero_robinson(MIDPOINT, 0)


@pytest.mark.parametrize("stages", [GAUSS_3, RADAU_3, LOBATTO_3])
def test_collocation_has_stage_order_s(stages: Collocation) -> None:
    zero = fraction(fmpq_poly())
    assert [prothero_robinson(stages, k) == zero for k in range(1, 5)] == [True, True, True, False]


def test_order_reduction_by_nodes_and_by_the_monomial_basis() -> None:
    by_nodes = Collocation("gauss2", "Gauss", 4, "x", (Q(1, 6), Q(-1), Q(1)))
    for power in range(1, 7):
        assert prothero_robinson(GAUSS_2, power) == prothero_robinson(by_nodes, power)


@pytest.mark.parametrize("method", [NINE["rk4"], RADAU_IIA_2, MIDPOINT, QIN_ZHANG])
def test_error_on_prothero_and_robinsons_problem(method: RungeKutta) -> None:
    """φ = t³ and a step from t = 1 by the stage equations, solved over Q: the error is Σ ψₖ(z) hᵏ φ⁽ᵏ⁾(1), exactly."""
    h, z, start = Q(1, 5), Q(-7, 3), Q(1)
    size, lam = method.stages, z / h
    times = [start + c * h for c in method.c]
    forcing = [3 * t**2 - lam * t**3 for t in times]
    # kᵢ = λ(y₀ + h Σ aᵢⱼ kⱼ) + forcingᵢ
    matrix = fmpq_mat([[scalar(Q(int(i == j)) - z * x) for j, x in enumerate(row)] for i, row in enumerate(method.a)])
    slopes = matrix.inv() * fmpq_mat(size, 1, [scalar(lam * start**3 + f) for f in forcing])
    end = start**3 + h * sum(b * exact(slopes[i, 0]) for i, b in enumerate(method.b))
    derivatives = {1: 3 * start**2, 2: 6 * start, 3: Q(6)}
    error = sum(exact(prothero_robinson(method, k)(scalar(z))) * h**k * d for k, d in derivatives.items())
    assert (start + h) ** 3 - end == error
    assert error != 0


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


def test_multiple_boundary_points_are_found_once() -> None:
    """T₁₀ touches ±1: double roots of R = ±1; over Q(√3) too."""
    now = chebyshev(10, 1 + Z / 100)
    assert len(points_at(fraction(now), Q(1))) == 6
    assert len(points_at(fraction(now), Q(-1))) == 5
    square = polynomial([1, ROOT_3]) * polynomial([1, ROOT_3])
    assert len(points_at(fraction(1 + square - square[0], fmpq_poly([1])), Q(1))) == 2
    assert len(points_at(fraction(square), Q(1))) == 2
    (double,) = points_at(fraction(square * square * 2 - 1), Q(-1))
    assert (double.real + 1 / arb(3).sqrt()).contains(0)
    assert coefficients(square)[1] == 2 * ROOT_3
    assert ZERO_ROOT is not INFINITY
