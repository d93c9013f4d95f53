"""The float steppers hold to the exact expressions within a bound derived by hand, at every scale of h and state."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as Q
from math import copysign, inf, isfinite, isnan, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from driftproof import strategies
from driftproof.methods.problems import oscillator
from driftproof.methods.stepping import Step, stepper
from driftproof.numeric.steppers import (
    HAND_WRITTEN,
    CountedForce,
    evaluations_per_step,
    float_stepper,
    forward_euler,
    rk4,
    symplectic_euler,
)
from driftproof.strategies import STABILITY_LIMITS, states, step_by_ulps, steps, steps_near_stability_limits
from driftproof.symbolic.derivation.one_step import matrix_at, one_step_matrix
from tests.nine import NINE

# Rounding to nearest in binary64: fl(x) = x (1 + d) + e with |d| <= U, |e| <= E and d e = 0; sums and differences, and
# products with powers of two except where they become subnormal, have e = 0, and unary minus has neither.
U = Q(1, 2**53)
E = Q(1, 2**1075)

Bound = Callable[[Q, Q, Q], tuple[Q, Q]]


def g(k: int) -> Q:
    """(1 + U)^k - 1, the relative error of a term that passes k roundings."""
    return (1 + U) ** k - 1


def forward_euler_bound(q: Q, v: Q, h: Q) -> tuple[Q, Q]:
    """fl(q + fl(h v)): q passes one rounding, h v two, and the product's e one; F(q) = -q is exact, so v is alike."""
    underflow = (1 + U) * E
    return g(1) * q + g(2) * h * v + underflow, g(1) * v + g(2) * h * q + underflow


def symplectic_euler_bound(q: Q, v: Q, h: Q) -> tuple[Q, Q]:
    """v₁ as above; fl(q + fl(h v₁)) puts two more roundings on its terms v and h q, and on its e.

    So q₁ holds q with 1 rounding, h v with 1 + 2, h² q with 2 + 2; its underflow is h (1+U)³ E from v₁ and (1+U) E.
    """
    _, dv = forward_euler_bound(q, v, h)
    dq = g(1) * q + g(3) * h * v + g(4) * h**2 * q + h * (1 + U) ** 3 * E + (1 + U) * E
    return dq, dv


def rk4_bound(q: Q, v: Q, h: Q) -> tuple[Q, Q]:
    """Roundings that each term of q₁ passes, in the lesson's order of operations; v₁ is the same with q, v exchanged.

    k₁ is (v, -q) exactly. A stage x + (h k)/2 adds to the terms of k one rounding for the product, none for the half,
    one for the sum; x itself has one. The half of a product is exact up to one more e, so with the product's e halved
    a stage adds 3/2 E, and its sum makes that (1+U) 3/2 E. Terms of k, as (roundings: v, h q, h² v, h³ q):
        k₂ = v - hq/2                       1, 2
        k₃ = v - hq/2 - h²v/4               1, 3, 4
        k₄ = v - hq - h²v/2 + h³q/4         1, 3, 5, 6      (x + h k, no half: E instead of 3/2 E)
    The sum ((k₁ + 2k₂) + 2k₃) + k₄ adds 3 roundings to k₁ and k₂, 2 to k₃, 1 to k₄; doubling is exact. Multiplying by
    h, dividing by 6 and adding to q add 3 more; the product's e is divided by 6, and the division has one of its own.
    """
    e2 = (1 + U) * E * Q(3, 2)
    e3 = (1 + U) ** 2 * h / 2 * e2 + e2
    e4 = (1 + U) ** 2 * h * e3 + (1 + U) * E
    e_sum = 2 * (1 + U) ** 3 * e2 + 2 * (1 + U) ** 2 * e3 + (1 + U) * e4
    underflow = (1 + U) ** 3 * h * e_sum / 6 + (1 + U) ** 2 * E / 6 + (1 + U) * E

    def one(x: Q, y: Q) -> Q:
        of_hy = g(0 + 3 + 3) + 2 * g(1 + 3 + 3) + 2 * g(1 + 2 + 3) + g(1 + 1 + 3)
        of_h2x = g(2 + 3 + 3) + g(3 + 2 + 3) + g(3 + 1 + 3)
        of_h3y = g(4 + 2 + 3) / 2 + g(5 + 1 + 3) / 2
        of_h4x = g(6 + 1 + 3) / 4
        return g(1) * x + (of_hy * h * y + of_h2x * h**2 * x + of_h3y * h**3 * y + of_h4x * h**4 * x) / 6 + underflow

    return one(q, v), one(v, q)


BOUNDS: dict[str, Bound] = {
    "forward_euler": forward_euler_bound,
    "symplectic_euler": symplectic_euler_bound,
    "rk4": rk4_bound,
}


def exact_step(key: str, q: float, v: float, h: float) -> tuple[Q, Q]:
    """The lesson's formulas written out once more, on the exact values of the doubles."""
    x, y, s = Q(q), Q(v), Q(h)
    if key == "forward_euler":
        return x + s * y, y - s * x
    if key == "symplectic_euler":
        return x + s * (y - s * x), y - s * x
    c, d = 1 - s**2 / 2 + s**4 / 24, s - s**3 / 6
    return c * x + d * y, c * y - d * x


def leaves_bound(step: Step, key: str, q: float, v: float, h: float) -> bool:
    """True when either component is farther from the exact one than the bound."""
    found = step(oscillator, q, v, h)
    errors = [abs(Q(a) - b) for a, b in zip(found, exact_step(key, q, v, h), strict=True)]
    bounds = BOUNDS[key](abs(Q(q)), abs(Q(v)), abs(Q(h)))
    return any(error > bound for error, bound in zip(errors, bounds, strict=True))


def stays_finite(key: str, q: float, v: float, h: float) -> bool:
    """No infinite intermediate becomes finite again, and each goes into a component, so the components tell of all."""
    return all(isfinite(x) for x in HAND_WRITTEN[key](oscillator, q, v, h))


KEYS = pytest.mark.parametrize("key", HAND_WRITTEN)
# No step of size at most 4 multiplies a state by 2^10, so these states overflow nowhere.
BELOW_OVERFLOW = states(max_exponent=1010)


@KEYS
@given(state=BELOW_OVERFLOW, h=steps())
@example(state=(5e-324, 5e-324), h=0.25)
@example(state=(-0.0, 0.0), h=-0.0)
@example(state=(2.0**-1022, 5e-324), h=5e-324)
def test_float_step_is_within_the_bound_for_states_of_all_exponents(
    key: str, state: tuple[float, float], h: float
) -> None:
    assert not leaves_bound(HAND_WRITTEN[key], key, *state, h)


@KEYS
@given(state=BELOW_OVERFLOW, h=steps_near_stability_limits())
def test_float_step_is_within_the_bound_near_the_stability_limits(
    key: str, state: tuple[float, float], h: float
) -> None:
    assert not leaves_bound(HAND_WRITTEN[key], key, *state, h)


@KEYS
@given(state=states(), h=strategies.finite_floats())
def test_float_step_is_within_the_bound_for_every_h_that_does_not_overflow(
    key: str, state: tuple[float, float], h: float
) -> None:
    assume(stays_finite(key, *state, h))
    assert not leaves_bound(HAND_WRITTEN[key], key, *state, h)


@KEYS
def test_no_overflow_can_be_met_by_huge_and_by_tiny_numbers(key: str) -> None:
    """The hypothesis of the test above is not empty, and not always true."""
    assert stays_finite(key, 1e300, -1e300, 1e-3)
    assert stays_finite(key, 1e307, 1e-308, 5e-324)
    assert not stays_finite(key, 1.7e308, 1.7e308, 1.7)


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
    for wrong in PLANTED[key]:
        assert leaves_bound(wrong, key, 0.3, 0.7, 0.25)
        assert leaves_bound(wrong, key, 0.3e200, 0.7e200, 0.25)
        assert leaves_bound(wrong, key, 0.3e-200, 0.7e-200, 0.25)


@KEYS
def test_bound_is_no_larger_than_the_first_order_says(key: str) -> None:
    """At first order in U it is what one reads off the formulas; a bound that is too generous would catch nothing."""
    h, q, v = Q(1, 4), Q(3), Q(7)
    first = {
        "forward_euler": (q + 2 * h * v, v + 2 * h * q),
        "symplectic_euler": ((1 + 4 * h**2) * q + 3 * h * v, v + 2 * h * q),
        "rk4": (
            (1 + Q(23, 6) * h**2 + Q(5, 12) * h**4) * q + (Q(37, 6) * h + Q(3, 2) * h**3) * v,
            (1 + Q(23, 6) * h**2 + Q(5, 12) * h**4) * v + (Q(37, 6) * h + Q(3, 2) * h**3) * q,
        ),
    }[key]
    for bound, linear in zip(BOUNDS[key](q, v, h), first, strict=True):
        assert U * linear <= bound <= U * linear * (1 + 100 * U)  # at most 10 roundings: 45 U² of each term


@KEYS
def test_bound_is_not_idle(key: str) -> None:
    """Some step errs by more than a third of the bound: it could not be three times smaller."""
    rng = np.random.default_rng(1)
    worst = Q(0)
    for q, v, h in rng.uniform(0.1, 1, (2000, 3)):
        bounds = BOUNDS[key](Q(q), Q(v), Q(h))
        found = zip(HAND_WRITTEN[key](oscillator, q, v, h), exact_step(key, q, v, h), bounds, strict=True)
        worst = max(worst, *(abs(Q(a) - b) / bound for a, b, bound in found))
    assert Q(1, 3) < worst <= 1


@KEYS
def test_exact_formulas_of_this_file_are_the_one_step_matrix(key: str) -> None:
    q, v, h = 0.3, -0.7, 0.1
    qq, qv, vq, vv = matrix_at(one_step_matrix(NINE[key]), Q(h))
    assert exact_step(key, q, v, h) == (qq * Q(q) + qv * Q(v), vq * Q(q) + vv * Q(v))


def bits(x: Any) -> bytes:
    return np.asarray(x, dtype=np.float64).tobytes()


ALL = pytest.mark.parametrize("key", NINE)
ENSEMBLES = st.lists(st.tuples(BELOW_OVERFLOW, steps()), min_size=1, max_size=6)


@ALL
@given(members=ENSEMBLES)
def test_arrays_step_to_the_same_bits_as_their_members(key: str, members: list[Any]) -> None:
    q, v, h = (np.array(column) for column in zip(*((q, v, h) for (q, v), h in members), strict=True))
    step = float_stepper(key)
    together = step(oscillator, q, v, h)
    apart = [step(oscillator, *state, h) for state, h in members]
    assert [bits(x) for x in together] == [bits(column) for column in zip(*apart, strict=True)]


@ALL
def test_states_and_steps_broadcast(key: str) -> None:
    q, v, h = np.linspace(-1, 1, 5)[:, None], np.float64(0.5), np.array([0.1, 0.25, 2.0])
    step = float_stepper(key)
    q1, v1 = step(oscillator, q, v, h)
    assert q1.shape == v1.shape == (5, 3)
    alone = step(oscillator, float(q[4, 0]), 0.5, 0.25)
    assert (q1[4, 1], v1[4, 1]) == alone


@ALL
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_precision_of_the_arguments_is_kept(key: str, dtype: Any) -> None:
    step = float_stepper(key)
    for q, v, h in [
        (dtype(1), dtype(0), dtype(0.25)),
        (np.ones(3, dtype), np.zeros(3, dtype), dtype(0.25)),
        (np.ones((2, 3), dtype), dtype(0), np.full(3, 0.25, dtype)),
        (np.ones(3, dtype), np.zeros(3, dtype), 0.25),  # a Python float follows the arrays
    ]:
        assert [np.asarray(x).dtype for x in step(oscillator, q, v, h)] == [dtype, dtype]


def test_float32_is_really_computed_in_float32() -> None:
    q1, _ = rk4(oscillator, np.float32(1), np.float32(0), np.float32(0.1))
    assert float(q1) != rk4(oscillator, 1.0, 0.0, 0.1)[0]
    assert abs(float(q1) - rk4(oscillator, 1.0, 0.0, 0.1)[0]) < 2.0**-22  # 10 roundings of 2^-24 on terms below h


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
    bounds = BOUNDS[key](*(abs(Q(x)) for x in (*state, h)))
    for a, b, bound in zip(generic, by_hand, bounds, strict=True):
        assert abs(Q(a) - Q(b)) <= 2 * bound


def test_generic_rk4_does_round_differently_somewhere() -> None:
    generic = stepper(NINE["rk4"], float)
    inputs = np.random.default_rng(1).uniform(-1, 1, (200, 3))
    assert any(generic(oscillator, *z) != rk4(oscillator, *z) for z in inputs)


@ALL
@given(state=BELOW_OVERFLOW)
def test_no_step_at_all_returns_the_state(key: str, state: tuple[float, float]) -> None:
    for h in (0.0, -0.0):
        assert float_stepper(key)(oscillator, *state, h) == state  # == does not look at the sign of a zero


def test_no_step_at_all_returns_the_state_unless_slopes_overflow_in_their_sum() -> None:
    assert forward_euler(oscillator, 1.7e308, 1.0, 0.0) == (1.7e308, 1.0)
    assert isnan(rk4(oscillator, 1.7e308, 1.0, 0.0)[1])  # 0 * (6 * 1.7e308)


@ALL
@given(state=BELOW_OVERFLOW, h=steps())
def test_negative_step_is_the_mirror_image(key: str, state: tuple[float, float], h: float) -> None:
    """Reversing h and v reverses v₁ and leaves q₁, in floats too: rounding to nearest is symmetric."""
    q1, v1 = float_stepper(key)(oscillator, *state, h)
    q, v = state
    assert float_stepper(key)(oscillator, q, -v, -h) == (q1, -v1)


@KEYS
def test_infinities_and_nan_pass_through_by_ieee_rules(key: str) -> None:
    step = HAND_WRITTEN[key]
    assert all(isnan(x) for x in step(oscillator, nan, 1.0, 0.25))
    assert not any(isfinite(x) for x in step(oscillator, inf, 1.0, 0.25))
    assert not all(isfinite(x) for x in step(oscillator, 1.0, 0.0, nan))
    assert isnan(step(oscillator, inf, 0.0, 0.0)[1])  # 0 * inf


def test_overflow_is_infinite_and_not_wrapped_or_clamped() -> None:
    assert forward_euler(oscillator, 1e308, 1e308, 1.0)[0] == inf
    assert forward_euler(oscillator, 1e308, 1e308, 1.0)[1] == 0.0
    assert symplectic_euler(oscillator, 1.7e308, -1.7e308, 1.0)[1] == -inf


def test_subnormals_are_not_flushed() -> None:
    assert forward_euler(oscillator, 5e-324, 0.0, 1.0) == (5e-324, -5e-324)
    assert forward_euler(oscillator, 5e-324, 5e-324, 0.25) == (5e-324, 5e-324)  # a quarter of it rounds to 0


def test_signed_zeros_follow_ieee() -> None:
    q1, v1 = forward_euler(oscillator, 0.0, -0.0, 0.25)
    assert (copysign(1, q1), copysign(1, v1)) == (1, -1)  # 0 + -0 is 0; -0 + 0.25 * -0 is -0


def test_doubles_near_two_root_two_lie_on_both_sides_and_none_on_it() -> None:
    below, nearest, above = (step_by_ulps(STABILITY_LIMITS[1], k) for k in (-1, 0, 1))
    assert Q(below) ** 2 < 8 < Q(above) ** 2
    assert Q(nearest) ** 2 != 8
    assert abs(Q(nearest) ** 2 - 8) < min(8 - Q(below) ** 2, Q(above) ** 2 - 8)


def test_tiny_steps_leave_the_energy_of_the_start_at_exactly_a_half() -> None:
    """h² below half an ulp of 1 is lost, in floats only: over the reals the energy grows for every h > 0."""
    h = 2.0**-27
    q, v = forward_euler(oscillator, 1.0, 0.0, h)
    assert (q * q + v * v) / 2 == 0.5
    assert (Q(q) ** 2 + Q(v) ** 2) / 2 > Q(1, 2)


EVALUATIONS = {"rk4": 4, "rk38": 4, "heun2": 2, "midpoint2": 2, "velocity_verlet": 2}


@ALL
def test_evaluations_are_counted_on_a_real_step(key: str) -> None:
    """Velocity Verlet really calls twice: nothing is carried over from the step before."""
    assert evaluations_per_step(key) == EVALUATIONS.get(key, 1)


def test_counted_force_counts_and_forwards() -> None:
    force = CountedForce(lambda q: 3 * q)
    assert [force(1), force(2), force.calls] == [3, 6, 2]


def test_float_runs_use_the_hand_written_stepper_where_there_is_one() -> None:
    assert {key: float_stepper(key) for key in HAND_WRITTEN} == HAND_WRITTEN
    assert set(HAND_WRITTEN) < set(NINE)
