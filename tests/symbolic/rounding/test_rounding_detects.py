"""What the derived bound notices where a tolerance does not, and what it must let pass: each planted, each judged."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import cache

import numpy as np

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.numeric.steppers import forward_euler, rk4
from driftproof.symbolic.rounding.formats import BINARY32
from driftproof.symbolic.rounding.step_bound import step_bound
from tests.symbolic.rounding.programs import all_within

TOLERANCE = 1e-12
RANDOM_CHECKS = 500


def rk4_weight_off_by(error: float):
    """RK4 as it is written out, but with a last weight of 1/6 + error."""

    def step(force, q, v, h):
        q1, v1 = rk4(force, q, v, h)
        k2q, k2v = v + h * force(q) / 2, force(q + h * v / 2)
        k3q, k3v = v + h * k2v / 2, force(q + h * k2q / 2)
        k4q, k4v = v + h * k3v, force(q + h * k3q)
        return q1 + h * (error * k4q), v1 + h * (error * k4v)

    return step


def random_checks(seed: int, count: int = RANDOM_CHECKS):
    """h and states of the lesson's own range: h up to 5/2, |q| and |v| up to 1."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.01, 2.5, count), *rng.uniform(-1, 1, (2, count))


@cache
def exact_step(definition: str, h: Q, q: Q, v: Q) -> tuple[Q, Q]:
    """Kept, for the right step and the wrong one are judged at the same points; so are the bounds, below."""
    return stepper(METHODS[definition], lambda c: c)(oscillator, q, v, h)


def caught(step, definition: str, allowed, h, q, v) -> float:
    """The fraction of the checks in which the float step leaves the bound allowed around the definition's."""
    outside = 0
    for one_h, one_q, one_v in zip(h, q, v, strict=True):
        exact_h, exact_q, exact_v = Q(one_h), Q(one_q), Q(one_v)
        floats = step(oscillator, one_q, one_v, one_h)
        exact = exact_step(definition, exact_h, exact_q, exact_v)
        bounds = allowed(exact_h, exact_q, exact_v)
        outside += not all_within([abs(Q(float(x)) - y) for x, y in zip(floats, exact, strict=True)], bounds)
    return outside / len(h)


def test_a_weight_wrong_by_1e_13_is_caught_nearly_always_where_a_tolerance_of_1e_12_sees_nothing():
    points, wrong = random_checks(1), rk4_weight_off_by(1e-13)
    allowed = cache(step_bound(rk4).error_of)
    assert caught(rk4, "rk4", allowed, *points) == 0
    assert caught(wrong, "rk4", allowed, *points) >= 0.95
    assert caught(wrong, "rk4", lambda *at: (Q(TOLERANCE), Q(TOLERANCE)), *points) == 0


def test_float32_arithmetic_smuggled_into_one_operation_is_caught():
    def smuggled(force, q, v, h):
        return q + np.float64(np.float32(h * v)), v + h * force(q)

    points = random_checks(4, 400)
    assert caught(smuggled, "forward_euler", step_bound(forward_euler).error_of, *points) > 0.99
    assert caught(smuggled, "forward_euler", step_bound(forward_euler, BINARY32).error_of, *points) == 0
