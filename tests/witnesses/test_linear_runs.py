"""Endpoints of the oscillator by powers: the products of matrices, however they are formed."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation
from tests.witnesses import linear_runs as linear
from tests.witnesses.linear_runs import endpoint, exact_matrix, float_matrix

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
