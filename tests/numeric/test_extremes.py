"""Runs at the ends of the formats, steps at the ends of stability, and formats: each outcome named."""

from __future__ import annotations

from fractions import Fraction as Q
from math import cos, inf, isfinite, nextafter

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.stepping import oscillator
from driftproof.numeric.steppers import rk4
from driftproof.symbolic.runs import exact_matrix_at
from tests.methods.tables.entries import EXPLICIT
from tests.numeric.engine_runs import oscillator_run

RK4, VERLET, SYMPLECTIC = METHODS["rk4"], METHODS["velocity_verlet"], METHODS["symplectic_euler"]
U = Q(1, 2**53)
LARGEST, TINIEST = Q(np.finfo(float).max.item()), 5e-324

# Huge and tiny states


def test_the_lessons_rk4_overflows_from_2_5e307_in_a_sum_of_stages_though_its_result_is_representable():
    """Of (x, x) the sum k₁ + 2k₂ + 2k₃ + k₄ of v is -(6 + 3h - h² - h³/4) x, which is 7.2 x at h = 1/2."""
    factor = 6 + 3 * Q(1, 2) - Q(1, 4) - Q(1, 32)
    assert Q(24, 10) * 10**307 < LARGEST / factor < Q(25, 10) * 10**307
    assert all(map(isfinite, rk4(oscillator, 2.4e307, 2.4e307, 0.5)))
    assert rk4(oscillator, 2.5e307, 2.5e307, 0.5)[1] == -inf


def test_the_text_of_rk4_weighs_stages_before_it_adds_them_and_does_not_overflow_there():
    q, v = oscillator_run(RK4)(2.5e307, 2.5e307, 0.5, 1)
    (a, b), (c, d) = (row for row in np.reshape(exact_matrix_at(RK4, Q(1, 2)), (2, 2)).tolist())
    x = Q(2.5e307)
    assert abs(Q(q) - (a + b) * x) + abs(Q(v) - (c + d) * x) < 20 * U * x
    assert all(map(isfinite, oscillator_run(RK4)(1e308, 1e308, 0.5, 1)))
    assert not all(map(isfinite, oscillator_run(RK4)(1.7e308, 1.7e308, 0.5, 1)))


@pytest.mark.parametrize("method", EXPLICIT, ids=lambda m: m.key)
def test_a_run_at_1e302_or_1e_245_is_the_run_at_1_scaled_bit_for_bit(method):
    """Rounding knows no scale, and the problem is linear: 2^k times the state is 2^k times every number in between."""
    q, v = oscillator_run(method)(0.6, -0.8, 0.125, 5)
    for scale in (2.0**1000, 2.0**-800):
        assert oscillator_run(method)(0.6 * scale, -0.8 * scale, 0.125, 5) == (q * scale, v * scale)


def test_at_1e_308_products_are_subnormal_and_scaling_ends():
    """2^-1022 is 2.2e-308: h v is below it, and has fewer bits."""
    scale = 2.0**-1022
    q, v = oscillator_run(VERLET)(0.6, -0.8, 0.125, 5)
    small = oscillator_run(VERLET)(0.6 * scale, -0.8 * scale, 0.125, 5)
    assert small != (q * scale, v * scale)
    # 15 products, each off by half of the smallest number, and of the start half of it: nothing amplifies them here
    assert max(abs(Q(small[0]) - Q(q) * Q(scale)), abs(Q(small[1]) - Q(v) * Q(scale))) < 32 * Q(TINIEST)


def test_the_smallest_state_never_moves_by_a_step_below_a_half():
    """h times the smallest number rounds to 0 for h <= 1/2, a tie to even; above, to the number itself."""
    for key in ("forward_euler", "symplectic_euler", "velocity_verlet"):
        assert oscillator_run(METHODS[key])(TINIEST, 0.0, 0.5, 1000) == (TINIEST, 0.0)
    assert oscillator_run(SYMPLECTIC)(TINIEST, 0.0, nextafter(0.5, 1), 1) == (0.0, -TINIEST)


def test_a_compiled_run_does_not_flush_subnormals():
    pytest.importorskip("numba")
    for start in ((1e-308, -1e-310), (TINIEST, 40 * TINIEST), (1e308, 1e308)):
        assert oscillator_run(SYMPLECTIC, compiled=True)(*start, 0.75, 100) == oscillator_run(SYMPLECTIC)(
            *start, 0.75, 100
        )


# Formats


def test_float16_at_a_step_of_2_to_the_minus_12_never_leaves_1_and_compensated_it_does():
    """h v is below half a unit of q all the way to t = 1, so each addition loses all of it, and keeps it if told to."""
    h, steps = 2.0**-12, 2**12
    start = np.ones(1, np.float16), np.zeros(1, np.float16)
    (plain,), _ = oscillator_run(SYMPLECTIC)(*start, h, steps)
    (kept,), _ = oscillator_run(SYMPLECTIC, compensated=True)(*start, h, steps)
    assert plain.dtype == kept.dtype == np.float16
    assert plain == 1
    assert abs(float(kept) - cos(1)) < 4 * 2.0**-11
