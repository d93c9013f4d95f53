"""The float steppers hold to the exact expressions within their rounding bound, and to the rules of IEEE 754."""

from __future__ import annotations

from fractions import Fraction as Q
from functools import cache
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.programs.stepping import Step, oscillator, stepper
from driftproof.numeric.steppers import (
    HAND_WRITTEN,
    evaluations_per_step,
    float_stepper,
    forward_euler,
    rk4,
    symplectic_euler,
)
from driftproof.strategies import states, steps
from driftproof.symbolic.rounding.step_bound import step_bound
from tests.nine import NINE

bound_of = cache(lambda key: step_bound(HAND_WRITTEN[key]))


def leaves_bound(step: Step, key: str, q: float, v: float, h: float) -> bool:
    """True when either component is farther from the exact step than the bound derived of the lesson's own."""
    at = Q(q), Q(v), Q(h)
    found, exact = step(oscillator, q, v, h), HAND_WRITTEN[key](oscillator, *at)
    bounds = bound_of(key).error_of(at[2], *at[:2])
    return any(abs(Q(a) - b) > bound for a, b, bound in zip(found, exact, bounds, strict=True))


KEYS = pytest.mark.parametrize("key", HAND_WRITTEN)
# No step of size at most 4 multiplies a state by 2^10, so these states overflow nowhere.
BELOW_OVERFLOW = states(max_exponent=1010)


PLANTED: dict[str, list[Step]] = {
    "forward_euler": [lambda F, q, v, h: (q + h * v * (1 + 1e-13), v + h * F(q))],
    "symplectic_euler": [
        lambda F, q, v, h: (q + h * v, v + h * F(q)),
        lambda F, q, v, h: symplectic_euler(F, q, v, h * (1 + 1e-13)),
    ],
    "rk4": [
        lambda F, q, v, h: rk4(lambda x: F(x) * (1 + 1e-13), q, v, h),
        lambda F, q, v, h: tuple(x * (1 + 1e-14) for x in rk4(F, q, v, h)),
    ],
}


@KEYS
def test_planted_error_of_1e_13_leaves_the_bound(key: str) -> None:
    assert not leaves_bound(HAND_WRITTEN[key], key, 0.3, 0.7, 0.25)
    for wrong in PLANTED[key]:
        assert leaves_bound(wrong, key, 0.3, 0.7, 0.25)
        assert leaves_bound(wrong, key, 0.3e200, 0.7e200, 0.25)
        assert leaves_bound(wrong, key, 0.3e-200, 0.7e-200, 0.25)


def bits(x: Any) -> bytes:
    return np.asarray(x, dtype=np.float64).tobytes()


ALL = pytest.mark.parametrize("key", NINE)
ENSEMBLES = st.lists(st.tuples(BELOW_OVERFLOW, steps()), min_size=1, max_size=6)


@pytest.mark.slow(keep=1)
@ALL
@given(members=ENSEMBLES)
def test_arrays_step_to_the_same_bits_as_their_members(key: str, members: list[Any]) -> None:
    q, v, h = (np.array(column) for column in zip(*((q, v, h) for (q, v), h in members), strict=True))
    step = float_stepper(key)
    together = step(oscillator, q, v, h)
    apart = [step(oscillator, *state, h) for state, h in members]
    assert [bits(x) for x in together] == [bits(column) for column in zip(*apart, strict=True)]


@ALL
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_precision_of_the_arguments_is_kept_and_their_shapes_are_broadcast(key: str, dtype: Any) -> None:
    step = float_stepper(key)
    for q, v, h in [
        (dtype(1), dtype(0), dtype(0.25)),
        (np.ones(3, dtype), np.zeros(3, dtype), dtype(0.25)),
        (np.ones((2, 3), dtype), dtype(0), np.full(3, 0.25, dtype)),
        (np.ones(3, dtype), np.zeros(3, dtype), 0.25),  # a Python float follows the arrays
    ]:
        found, shape = step(oscillator, q, v, h), np.broadcast_shapes(*map(np.shape, (q, v, h)))
        assert [(np.asarray(x).dtype, np.shape(x)) for x in found] == [(dtype, shape)] * 2


@KEYS
@given(state=BELOW_OVERFLOW, h=steps())
def test_generic_stepper_differs_from_the_hand_written_by_rounding_only(
    key: str, state: tuple[float, float], h: float
) -> None:
    """Bit for bit for the two Euler methods; for RK4, which it sums in another order, within twice the bound.

    Its own bound is smaller or equal term by term, but for its rounded coefficients 1/6 and 1/3: two roundings more.
    """
    generic, by_hand = stepper(NINE[key], float)(oscillator, *state, h), HAND_WRITTEN[key](oscillator, *state, h)
    if key != "rk4":
        assert bits(generic) == bits(by_hand)
    bounds = bound_of(key).error_of(Q(h), *map(Q, state))
    for a, b, bound in zip(generic, by_hand, bounds, strict=True):
        assert abs(Q(a) - Q(b)) <= 2 * bound


@pytest.mark.slow(keep=1)
@ALL
@given(state=BELOW_OVERFLOW)
def test_no_step_at_all_returns_the_state(key: str, state: tuple[float, float]) -> None:
    for h in (0.0, -0.0):
        assert float_stepper(key)(oscillator, *state, h) == state  # == does not look at the sign of a zero


AT_THE_EDGES = [
    (forward_euler, (1e308, 1e308, 1.0), (inf, 0.0)),
    (symplectic_euler, (1.7e308, -1.7e308, 1.0), (-inf, -inf)),
    (forward_euler, (5e-324, 0.0, 1.0), (5e-324, -5e-324)),
    (forward_euler, (5e-324, 5e-324, 0.25), (5e-324, 5e-324)),  # a quarter of it rounds to 0
    (forward_euler, (0.0, -0.0, 0.25), (0.0, -0.0)),  # 0 + -0 is 0; -0 + 0.25 * -0 is -0
    (forward_euler, (1.7e308, 1.0, 0.0), (1.7e308, 1.0)),
    (rk4, (1.7e308, 1.0, 0.0), (1.7e308, nan)),  # 0 * (6 * 1.7e308)
    (forward_euler, (inf, 0.0, 0.0), (inf, nan)),
]


@pytest.mark.parametrize(("step", "given", "found"), AT_THE_EDGES)
def test_overflow_is_infinite_subnormals_are_kept_and_so_are_signs_of_zeros(
    step: Step, given: tuple[float, float, float], found: tuple[float, float]
) -> None:
    assert [repr(x) for x in step(oscillator, *given)] == [repr(x) for x in found]


EVALUATIONS = {"rk4": 4, "rk38": 4, "heun2": 2, "midpoint2": 2, "velocity_verlet": 2}


@ALL
def test_evaluations_are_counted_on_a_real_step(key: str) -> None:
    """Velocity Verlet really calls twice: nothing is carried over from the step before."""
    assert evaluations_per_step(key) == EVALUATIONS.get(key, 1)


def test_float_runs_use_the_hand_written_stepper_where_there_is_one() -> None:
    assert {key: float_stepper(key) for key in HAND_WRITTEN} == HAND_WRITTEN
    assert set(HAND_WRITTEN) < set(NINE)
