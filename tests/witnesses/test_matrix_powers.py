"""Endpoints by powers: the matrix is the exact one rounded once, the power is in the stated products, and as a run."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation
from driftproof.symbolic.runs import exact_matrix_at
from tests.numeric.implicit_runs import U, implicit_stepper, oscillator, rounding_of_a_step
from tests.witnesses.matrix_powers import endpoint, float_turn

COLLOCATION = [method for method in METHODS.values() if isinstance(method, Collocation)]


@pytest.mark.parametrize("method", COLLOCATION, ids=lambda m: m.key)
def test_the_float_matrix_of_a_collocation_method_is_the_exact_one_rounded_once(method):
    for h in (0.3, -0.125, 1000.0, 1e-9):
        found = float_turn(method, h)
        rho, sigma = found.real, found.imag
        assert (rho, sigma, -sigma, rho) == tuple(map(float, exact_matrix_at(method, Q(h))))
        assert found != float_turn(method, h + abs(h) / 2**20)


@pytest.mark.parametrize("key", ["gauss5", "radau_iia4", "lobatto_iiia5"])
@pytest.mark.parametrize("steps", [1, 2, 3, 100, 1023, 1024])
def test_an_endpoint_has_the_bits_of_products_of_matrices_and_says_how_many(key, steps):
    """They are formed as complex numbers, in the same operations; in another order the bits are others."""
    turn = float_turn(METHODS[key], 0.3)
    matrix = ((turn.real, turn.imag), (-turn.imag, turn.real))

    def product(x, y):
        (a, b), (c, d), (e, f), (g, h) = *x, *y
        return (a * e + b * g, a * f + b * h), (c * e + d * g, c * f + d * h)

    power, products = matrix, 0
    for bit in bin(steps)[3:]:
        power, products = product(power, power), products + 1
        if bit == "1":
            power, products = product(power, matrix), products + 1
    (a, b), (c, d) = power
    q, v, how = endpoint(METHODS[key], (0.6, -0.8), 0.3, steps)
    assert (q, v) == (a * 0.6 + b * -0.8, c * 0.6 + d * -0.8)
    assert f", in {products} products" in how
    one_by_one = matrix
    for _ in range(steps - 1):
        one_by_one = product(one_by_one, matrix)
    assert (one_by_one != power) or steps <= 3


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("steps", "h"), [(0, 0.5), (1, 0.5), (1000, 0.125)])
def test_an_endpoint_by_powers_is_that_of_the_run_and_says_that_it_is_none(steps, h):
    """Rotation by Gauss's matrix: each product of two matrices rounds each entry by at most 3u, each step too."""
    found = endpoint(METHODS["gauss5"], (0.6, -0.8), h, steps)
    run = implicit_stepper(METHODS["gauss5"], oscillator)(0.0, [0.6, -0.8], h, steps)
    most = steps * (rounding_of_a_step(METHODS["gauss5"], h) + 12 * float(U))
    assert np.hypot(*(np.array(run.y) - [found.q, found.v])) <= most
    assert f"power {steps} of the one-step matrix" in found.how
    assert "no step was taken" in found.how
