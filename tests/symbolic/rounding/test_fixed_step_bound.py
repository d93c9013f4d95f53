"""The sharper bound at one h: rigorous for every state, and several times smaller where h is large."""

from __future__ import annotations

import random
from fractions import Fraction as Q
from functools import cache
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.methods.schemes import Splitting
from driftproof.numeric.steppers import HAND_WRITTEN, forward_euler, rk4
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.rounding.fixed_step_bound import fixed_step_bound
from driftproof.symbolic.rounding.formats import BFLOAT16, BINARY16, BINARY64, FloatFormat
from driftproof.symbolic.rounding.polynomials import absolute_value
from driftproof.symbolic.rounding.step_bound import NotLinear, step_bound, step_with_stored_coefficients
from driftproof.symbolic.runs import apply, exact_matrix_at
from tests.changes import first_weight, moved
from tests.looping import exactly
from tests.symbolic.rounding.programs import IRRATIONAL, PROGRAMS, all_within, as_step, error_in_balls
from tests.witnesses.leapfrog import leapfrog
from tests.witnesses.soft_float import soft_lift
from tests.witnesses.worst_case import Envelope, envelope_of, search

COARSE = FloatFormat("coarse", 3, -1, 7)
# No dyadic number, so that h times a coefficient really rounds.
STEP = Q(0.7)
sharp_of = cache(lambda key: fixed_step_bound(METHODS[key], STEP))


def envelope(subject, h: Q) -> Envelope:
    """The sharper bound at |h| as a check of many steps takes it: constants, next to M, which depends on the sign of h.

    A step from (q, v) by -h is the mirror image of one from (q, -v) by h, float by float.
    """
    bound = fixed_step_bound(subject, abs(h)).linear
    (qq, qv), (vq, vv) = bound.error
    rq, rv = bound.underflow
    exact, _, _ = envelope_of(step_bound(subject))
    return Envelope(exact, (((qq,), (qv,)), ((vq,), (vv,))), ((rq,), (rv,)))


def test_rk4_at_five_halves_is_bounded_by_22_u_where_the_plain_form_says_80():
    h, one, u = Q(5, 2), Q(1), BINARY64.u
    sharp, plain = fixed_step_bound(rk4, h), step_bound(rk4).error_of(h, one, one)
    # convex in the state, so that it is largest at corners of the square
    assert max(e for corner in product((1, -1), repeat=2) for e in sharp.error_of(*map(Q, corner))) < 22 * u
    assert min(plain) > 80 * u


def test_rk4_at_five_halves_comes_within_a_factor_of_two_of_that():
    """So little is left to gain: states are found whose error is more than half of the sharper bound."""
    found = search(rk4, envelope(rk4, Q(5, 2)), np.float64, (2.5, 2.5), seed=1, population=1 << 11)
    assert found.violations == 0
    assert found.ratio > 1 / 2


@pytest.mark.slow(keep=8)
@pytest.mark.parametrize("key", PROGRAMS)
@pytest.mark.parametrize("h", [0.25, 1.9, 2.5, 1e-8])
def test_no_step_of_a_search_exceeds_the_sharper_bound(key, h):
    at = {"dtype": np.float64, "h_range": (h, h), "seed": 2, "generations": 6, "population": 1 << 10}
    assert search(as_step(PROGRAMS[key]), envelope(PROGRAMS[key], Q(h)), **at).violations == 0


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", PROGRAMS)
@settings(max_examples=16)
@given(h=st.floats(-2.5, 2.5).map(Q), q=st.floats(-1, 1).map(Q), v=st.floats(-1, 1).map(Q))
def test_the_sharper_bound_holds_for_the_very_state_and_is_hardly_ever_above_the_plain_one(key, h, q, v):
    subject = PROGRAMS[key]
    floats = as_step(subject)(oscillator, float(q), float(v), float(h))
    bound = fixed_step_bound(subject, h)
    exact = apply((*bound.matrix[0], *bound.matrix[1]), q, v)
    plain = step_bound(subject).error_of(h, q, v)
    of_each = zip(floats, exact, bound.error_of(q, v), plain, bound.linear.of(q, v), strict=True)
    for x, y, e, most, linear in exactly(2, of_each):
        assert abs(Q(x) - y) <= e <= linear
        # Only the terms of second order and of underflow may be larger, by a fixed factor at most.
        assert e <= most * (1 + 64 * BINARY64.u) + 64 * BINARY64.eta


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("key", [*PROGRAMS, *IRRATIONAL])
def test_its_matrix_is_the_definition_s_at_that_h(key):
    """Over a field the program with the coefficients that are stored has another one."""
    definition = METHODS[key.removeprefix("generic ").replace("leapfrog", "velocity_verlet")]
    (qq, qv), (vq, vv) = (sharp_of(key) if key in IRRATIONAL else fixed_step_bound(PROGRAMS[key], STEP)).matrix
    assert (qq, qv, vq, vv) == exact_matrix_at(definition, STEP)
    if key in IRRATIONAL:
        stored = fixed_step_bound(step_with_stored_coefficients(definition, BINARY64), STEP)
        assert stored.matrix != sharp_of(key).matrix


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("fusing", [False, True])
@pytest.mark.parametrize("step", [*HAND_WRITTEN.values(), leapfrog])
@pytest.mark.parametrize("fmt", [COARSE, BFLOAT16], ids=lambda fmt: fmt.name)
def test_it_holds_in_coarse_formats_where_second_order_counts_fused_or_not(step, fusing, fmt):
    numbers = [fmt.nearest(Q(n, 7)) for n in (-9, -4, -1, 2, 7)]
    lift = soft_lift(fmt, fusing)
    for h in (fmt.nearest(Q(n, 8)) for n in (1, 3, 5, 7, 11)):
        bound = fixed_step_bound(step, h, fmt)
        for q, v in product(numbers, repeat=2):
            floats = step(oscillator, lift(q), lift(v), lift(h))
            exact = step(oscillator, q, v, h)
            assert all_within([abs(x.value - y) for x, y in zip(floats, exact, strict=True)], bound.error_of(q, v))


def test_a_product_used_twice_is_weighed_use_by_use_because_it_may_be_fused_into_one_of_them():
    """x = h q; (x + v) - x is v up to rounding: without fusing x's own rounding cancels, with it it does not."""

    def cancelling(force, q, v, h):
        x = h * q
        return (x + v) - x, v

    h, q, v = (BINARY16.nearest(Q(x)) for x in (0.7, 0.9, 1e-3))
    bound = fixed_step_bound(cancelling, h, BINARY16)
    lift = soft_lift(BINARY16, fusing=True)
    fused = cancelling(oscillator, lift(q), lift(v), lift(h))[0].value
    assert abs(fused - v) <= bound.error_of(q, v)[0]
    own_rounding_of_x = BINARY16.relative_error * abs(h * q)
    (entry, _), _ = bound.linear.error
    # The sum's rounding alone would be d|h q|; the two uses of x add twice its own.
    assert entry * abs(q) > 5 * own_rounding_of_x / 2


def test_the_remainder_makes_the_bound_of_products_exact():
    """n roundings in a row: (1 + d)^n - 1, no less. And c (h q), with c rounded: both errors and their product."""
    d, h, n = BFLOAT16.relative_error, Q(3, 8), 5

    def multiply(force, q, v, h):
        for _ in range(n):
            q = q * h
        return q, Q(1, 3) * (h * v)

    (chain, _), (_, scaled) = fixed_step_bound(multiply, h, BFLOAT16).linear.error
    assert chain == ((1 + d) ** n - 1) * h**n
    held = BFLOAT16.nearest(Q(1, 3))
    both = (1 + d) * max(held, Q(2, 3) - held) * (1 + d) * h - h / 3
    assert both <= scaled <= both * (1 + d**2)


def test_a_power_of_two_step_is_known_to_multiply_exactly():
    quarter, third = (
        fixed_step_bound(forward_euler, BINARY64.nearest(h)).linear.error[0][1] for h in (Q(1, 4), Q(1, 3))
    )
    assert quarter == BINARY64.relative_error / 4
    assert third > 2 * BINARY64.relative_error / 4


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize("key", IRRATIONAL)
def test_it_holds_around_the_exact_map_over_a_field_and_a_planted_error_of_1e_13_leaves_it(key: str):
    method, draw, left = METHODS[key], random.Random(3), 0
    right, wrong = (stepper(m, float) for m in (method, moved(method, first_weight(method), Q(1, 10**13))))
    for q, v in [(draw.uniform(-1, 1), draw.uniform(-1, 1)) for _ in range(8)]:
        most = [enclose(x) for x in sharp_of(key).error_of(Q(q), Q(v))]
        assert all_within(error_in_balls(key, right, float(STEP), q, v), most)
        left += not all_within(error_in_balls(key, wrong, float(STEP), q, v), most)
    assert left >= 7


def test_a_bound_as_stored_does_not_speak_of_the_definition():
    """c = 1.0004... is stored as 1: the program is q + h v, within 2d|h v| + d|q| of that, not of q + c h v."""
    fmt, draw = BINARY16, random.Random(1)
    c = 1 + (square_root(2) - 1) * 2 * fmt.u
    method = Splitting("almost_one", "One drift", 0, "none", (("drift", c),))
    h, left, lift = fmt.nearest(Q(61, 32)), 0, soft_lift(fmt)
    stored, defined = (fixed_step_bound(s, h, fmt) for s in (step_with_stored_coefficients(method, fmt), method))
    assert stored.matrix[0][1] == h != defined.matrix[0][1] == c * h
    for _ in range(200):
        q, v = (fmt.nearest(Q(x)) for x in (draw.uniform(-1 / 4, 1 / 4), draw.uniform(1, 2)))
        reached = stepper(method, lift)(oscillator, lift(q), lift(v), lift(h))[0].value
        assert abs(reached - (q + h * v)) <= stored.error_of(q, v)[0]
        assert absolute_value(reached - (q + c * h * v)) <= defined.error_of(q, v)[0]
        left += absolute_value(reached - (q + c * h * v)) > stored.error_of(q, v)[0]
    assert left > 0


def test_what_is_no_number_of_the_format_or_not_linear_is_refused():
    with pytest.raises(ValueError, match="h = 1/10 is not a binary64 number; the nearest is 36028797018963"):
        fixed_step_bound(rk4, Q(1, 10))
    with pytest.raises(NotLinear, match=r"q\*\*3"):
        fixed_step_bound(forward_euler, Q(1, 4), force=lambda q: q * q * q)


def test_a_constant_that_depends_on_what_is_fused_is_not_taken_as_the_one_that_is_stored():
    """fl(1 - fl(3 fl(1/3))) is 0, and fused, fl(1 - 3 fl(1/3)), it is 2⁻⁵⁴."""
    bound = fixed_step_bound(lambda force, q, v, h: ((1 - h * Q(1, 3)) * q + v, v), Q(3))
    fused = 1 - 3 * BINARY64.nearest(Q(1, 3))
    assert fused == Q(1, 2**54)
    assert bound.error_of(Q(1), Q(0))[0] >= fused
