"""What the derived bound notices where a tolerance does not, and what it must let pass: each planted, each judged."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import cache

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.stepping import oscillator, stepper
from driftproof.numeric.steppers import HAND_WRITTEN, forward_euler, rk4, symplectic_euler
from driftproof.symbolic.rounding.fixed_step_bound import fixed_step_bound
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64
from driftproof.symbolic.rounding.step_bound import step_bound
from tests.symbolic.rounding.programs import all_within, rk4_reassociated
from tests.witnesses.any_order import any_order
from tests.witnesses.soft_float import soft_lift

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


@pytest.mark.slow
def test_the_sharper_bound_catches_even_more_of_a_smaller_error():
    points, wrong = random_checks(2, 100), rk4_weight_off_by(2e-15)

    @cache
    def sharp(h, q, v):
        return fixed_step_bound(rk4, h).error_of(q, v)

    plain_rate, sharp_rate = (caught(wrong, "rk4", f, *points) for f in (step_bound(rk4).error_of, sharp))
    assert caught(rk4, "rk4", sharp, *points) == 0
    assert plain_rate < sharp_rate


def test_the_tolerance_sees_an_error_of_1e_11_and_the_bound_still_lets_the_right_step_pass():
    """The tolerance is not blind, only blunt."""
    points = random_checks(3, 400)
    wrong = rk4_weight_off_by(1e-11)
    assert caught(wrong, "rk4", lambda *at: (Q(TOLERANCE), Q(TOLERANCE)), *points) > 0.5


def test_float32_arithmetic_smuggled_into_one_operation_is_caught():
    def smuggled(force, q, v, h):
        return q + np.float64(np.float32(h * v)), v + h * force(q)

    points = random_checks(4, 400)
    assert caught(smuggled, "forward_euler", step_bound(forward_euler).error_of, *points) > 0.99
    assert caught(smuggled, "forward_euler", step_bound(forward_euler, BINARY32).error_of, *points) == 0


def test_the_order_of_the_updates_is_noticed():
    points = random_checks(5, 100)
    assert caught(symplectic_euler, "forward_euler", step_bound(forward_euler).error_of, *points) == 1


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_fused_multiply_adds_pass(key):
    """Emulated exactly: every product that enters a sum is fused into it, which changes bits and stays in bounds."""
    step, fused = HAND_WRITTEN[key], soft_lift(BINARY64, fusing=True)
    bound, changed = step_bound(step), 0
    for h, q, v in zip(*random_checks(6, 120), strict=True):
        at = Q(h), Q(q), Q(v)
        results = step(oscillator, *(fused(x) for x in (at[1], at[2], at[0])))
        plain = step(oscillator, q, v, h)
        exact = step(oscillator, at[1], at[2], at[0])
        changed += any(x.value != Q(y) for x, y in zip(results, plain, strict=True))
        for bounds in (bound.error_of(*at), fixed_step_bound(step, at[0]).error_of(*at[1:])):
            assert all_within([abs(x.value - y) for x, y in zip(results, exact, strict=True)], bounds)
    assert changed > 5


@pytest.mark.slow
def test_a_reassociated_step_stays_inside_the_definition_s_any_order_bound():
    points, allowed = random_checks(7, 60), cache(any_order(METHODS["rk4"]).error_of)
    assert caught(rk4_reassociated, "rk4", allowed, *points) == 0
    assert caught(rk4_weight_off_by(1e-13), "rk4", allowed, *points) > 0.9
