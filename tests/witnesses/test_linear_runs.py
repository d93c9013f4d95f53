"""One-step matrices without a run, and endpoints of the oscillator by powers of them."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.numeric.implicit import implicit_stepper
from driftproof.numeric.tableaux import float_tableau
from driftproof.symbolic.runs import exact_matrix_at
from tests.numeric.implicit_runs import implicit_run
from tests.witnesses import linear_runs as linear
from tests.witnesses.linear_runs import endpoint, exact_matrix, float_matrix

IMPLICIT = [method for method in METHODS.values() if not method.explicit]
U = Q(1, 2**53)


def oscillator(t, y):
    return [y[1], -y[0]]


def rounding_of_a_step(method, h):
    """A bound on the error of a step of the oscillator from the unit circle, to first order in u.

    A component of a residual is at most 8E + 4R, where |Z|, |w| <= 2hw, w being the largest sum of |A| in a row and at
    least 1, |f| and |y + Z| <= 2, |J| = 1: E <= u hw (8 + 2 (s + 20) + 34), R <= u (2hw + 2h²w²). Stage by stage, the
    slope (Z - w)/aⱼⱼ takes a residual into those that follow. (I - hA⊗J)⁻¹ makes an error of Z of it, d or b one of y₁,
    whose formula rounds s + 1 terms of at most 2hw and the sum, of at most 2.
    """
    table = float_tableau(method)
    a, s = np.abs(table.a), table.stages
    w = max(1.0, float(a.sum(axis=1).max()))
    floor = 8 * h * w * (8 + 2 * (s + 20) + 34) + 4 * (2 * h * w + 2 * h * h * w * w)
    if not np.triu(a, 1).any():
        floor *= 1 + max(sum(a[i, j] / a[j, j] for j in range(i) if a[j, j] > 0) for i in range(s))
    inverse = np.linalg.inv(np.eye(2 * s) - h * np.kron(table.a, [[0, 1], [-1, 0]]))
    weights = 1.0 if table.stiffly_accurate else float(np.abs(table.b if table.d is None else table.d).sum())
    return float(U) * (np.abs(inverse).sum(axis=1).max() * floor * weights + (s + 1) * 2 * h * w * weights + 4)


@pytest.mark.parametrize("method", IMPLICIT, ids=lambda m: m.key)
def test_the_exact_matrix_is_the_one_that_the_exact_side_derives(method):
    for h in (Q(1, 3), Q(-7, 2)):
        (a, b), (c, d) = exact_matrix(method, h)
        assert (a, b, c, d) == exact_matrix_at(method, h)


def test_the_exact_matrix_of_an_explicit_method_is_its_step():
    for key in ("rk4", "yoshida4", "nystrom5"):
        (a, b), (c, d) = exact_matrix(METHODS[key], Q(1, 3))
        assert (a, b, c, d) == exact_matrix_at(METHODS[key], Q(1, 3))


def test_a_step_without_a_solution_is_refused_by_the_exact_matrix():
    """Row sums 1 and -1: I + h²A² is singular at h = 1 for A = ((0, 1), (-1, 0)), whose square is -I."""
    a = ((Q(0), Q(1)), (Q(-1), Q(0)))
    turning = RungeKutta("turning", "turning", 0, "a test", a, (Q(1, 2), Q(1, 2)), (Q(1), Q(-1)))
    with pytest.raises(ZeroDivisionError, match="singular"):
        exact_matrix(turning, Q(1))
    exact_matrix(turning, Q(1, 2))


@pytest.mark.parametrize(("steps", "h"), [(0, 0.5), (1, 0.5), (1000, 0.125)])
def test_an_endpoint_by_powers_is_that_of_the_run_and_says_that_it_is_none(steps, h):
    """Rotation by Gauss's matrix: each product of two matrices rounds each entry by at most 3u, each step too."""
    found = endpoint(METHODS["gauss3"], (0.6, -0.8), h, steps)
    run = implicit_run(implicit_stepper(METHODS["gauss3"], oscillator), [0.6, -0.8], h, steps)
    most = steps * (rounding_of_a_step(METHODS["gauss3"], h) + 12 * float(U))
    assert np.hypot(*(np.array(run.y) - [found.q, found.v])) <= most
    assert f"power {steps} of the one-step matrix" in found.how
    assert "no step was taken" in found.how


COLLOCATION = [method for method in METHODS.values() if isinstance(method, Collocation)]


def by_products(matrix, steps):
    """matrix**steps by squares and products of matrices of floats, and how many."""
    power, products = matrix, 0
    for bit in bin(steps)[3:]:
        power, products = linear._product(power, power), products + 1
        if bit == "1":
            power, products = linear._product(power, matrix), products + 1
    return power, products


@pytest.mark.parametrize(
    "key", ["gauss3", "radau_iia2", "backward_euler", "rk4", "velocity_verlet", "symplectic_euler"]
)
@pytest.mark.parametrize("steps", [1, 2, 3, 100, 1023, 1024])
def test_an_endpoint_has_the_bits_of_products_of_matrices_and_says_how_many(key, steps):
    """Those of Runge-Kutta methods are formed as complex numbers, in the same operations."""
    ((a, b), (c, d)), products = by_products(float_matrix(METHODS[key], 0.3), steps)
    q, v, how = endpoint(METHODS[key], (0.6, -0.8), 0.3, steps)
    assert (q, v) == (a * 0.6 + b * -0.8, c * 0.6 + d * -0.8)
    assert f", in {products} products" in how


def test_powers_in_another_order_have_other_bits():
    matrix = float_matrix(METHODS["rk4"], 0.3)
    power = matrix
    for _ in range(99):
        power = linear._product(power, matrix)
    assert power != by_products(matrix, 100)[0]


def test_no_step_is_the_start():
    for key in ("gauss3", "velocity_verlet"):
        assert endpoint(METHODS[key], (0.6, -0.8), 0.3, 0)[:2] == (0.6, -0.8)


@pytest.mark.parametrize("method", COLLOCATION, ids=lambda m: m.key)
def test_the_float_matrix_of_a_collocation_method_is_the_exact_one_rounded_once(method):
    for h in (0.3, -0.125, 1000.0, 1e-9):
        exact = exact_matrix(method, Q(h))
        assert float_matrix(method, h) == tuple(tuple(map(float, row)) for row in exact)
        assert float_matrix(method, h) != float_matrix(method, h + abs(h) / 2**20)
