"""The bound of one step: equal to the first order derived by hand, held by floats of all formats, and sharp enough."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from functools import cache
from itertools import product

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.steppers import HAND_WRITTEN, forward_euler, rk4, symplectic_euler
from driftproof.symbolic.algebra.certified import decide_by_enclosure, enclose
from driftproof.symbolic.algebra.polynomials import ONE as CONSTANT
from driftproof.symbolic.algebra.polynomials import X
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.linear.oscillator import oscillator_matrix
from driftproof.symbolic.rounding.formats import BFLOAT16, BINARY16, BINARY32, BINARY64, FloatFormat
from driftproof.symbolic.rounding.number import RefusedOperation
from driftproof.symbolic.rounding.polynomials import ONE, H, constant_polynomial
from driftproof.symbolic.rounding.step_bound import NotLinear, step_bound
from tests.changes import coefficients, first_weight, moved
from tests.nine import NINE
from tests.symbolic.rounding.programs import IRRATIONAL, PROGRAMS, all_within, as_step, error_in_balls
from tests.witnesses.leapfrog import leapfrog
from tests.witnesses.soft_float import NATIVE, soft_lift
from tests.witnesses.worst_case import (
    Envelope,
    envelope_of,
    search,
)

# Derived by hand for the lesson's order of operations: the coefficient of u in |dq| and |dv|, of |q| and |v|.
RK4_OWN, RK4_OTHER = 1 + 23 * H**2 / 6 + 5 * H**4 / 12, 37 * H / 6 + 3 * H**3 / 2
BY_HAND = {
    "forward_euler": ((ONE, 2 * H), (2 * H, ONE)),
    "symplectic_euler": ((1 + 4 * H**2, 3 * H), (2 * H, ONE)),
    "rk4": ((RK4_OWN, RK4_OTHER), (RK4_OTHER, RK4_OWN)),
}
# So coarse that every power of d counts, and small enough to try every state.
COARSE = FloatFormat("coarse", 3, -1, 1)
FORMATS = pytest.mark.parametrize("fmt", [BINARY64, BINARY32, BINARY16, BFLOAT16], ids=lambda fmt: fmt.name)
NATIVE_FORMATS = pytest.mark.parametrize("fmt", NATIVE, ids=lambda fmt: fmt.name)

bound_of = cache(lambda key, fmt=BINARY64: step_bound(PROGRAMS.get(key) or METHODS[key], fmt))


def envelope(key: str, fmt: FloatFormat = BINARY64) -> Envelope:
    return envelope_of(bound_of(key, fmt))


def in_floats(key: str):
    """The step as it runs on floats of any type."""
    return as_step(PROGRAMS.get(key) or METHODS[key])


# --- what is derived ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_first_order_form_equals_the_one_derived_by_hand(key):
    assert step_bound(HAND_WRITTEN[key]).first_order == BY_HAND[key]


def test_first_order_form_notices_another_order_of_operations():
    assert step_bound(lambda force, q, v, h: rk4(force, q, v, h / 6 * 6)).first_order != BY_HAND["rk4"]


@pytest.mark.parametrize("key", [*PROGRAMS, *IRRATIONAL])
def test_the_same_run_proves_the_formula_of_every_method_over_q_or_its_field(key):
    method = METHODS[key.removeprefix("generic ").replace("leapfrog", "velocity_verlet")]
    assert bound_of(key).differences(oscillator_matrix(method)) == []
    assert bound_of(key).differences(oscillator_matrix(moved(method, first_weight(method), Q(1, 10**13)))) != []
    assert bound_of(key).rounds_constants or key not in IRRATIONAL


def test_a_step_with_another_polynomial_is_reported_with_the_coefficient():
    def rk4_with_a_fifth(force, q, v, h):
        q1, v1 = rk4(force, q, v, h)
        return q1 + h * h * h * v / 30, v1

    (line,) = step_bound(rk4_with_a_fifth).differences(oscillator_matrix(NINE["rk4"]))
    assert line == "M_qv, coefficient of h**3: the program has -2/15, the definition -1/6"
    for step, other, x, y in ((forward_euler, "symplectic_euler", 0, -1), (symplectic_euler, "forward_euler", -1, 0)):
        (line,) = step_bound(step).differences(oscillator_matrix(NINE[other]))
        assert line == f"M_qq, coefficient of h**2: the program has {x}, the definition {y}"
    implicit = step_bound(forward_euler).differences(oscillator_matrix(METHODS["backward_euler"]))
    assert implicit == [f"M_{x}: in the definition it is not a polynomial in h" for x in ("qq", "qv", "vq", "vv")]


def test_a_decimal_constant_is_the_double_that_it_is_and_not_the_fraction_that_it_means():
    def euler_times_a_tenth(force, q, v, h):
        return q + 0.1 * h * v, v + 0.1 * h * force(q)

    one, tenth = fraction(CONSTANT), fraction(X / 10)
    meant = ((one, tenth), (-tenth, one))
    assert f"the program has {Q(0.1)}, the definition 1/10" in step_bound(euler_times_a_tenth).differences(meant)[0]


@FORMATS
def test_a_lifted_coefficient_owns_up_to_its_distance_from_the_float(fmt):
    """q + (c h) v: for c = 1/6 that is c's own error, and u/6 for c*h, (c h)*v and the sum each; 1/4 has only two."""

    def drift_by(c: Q):
        """The first-order bound on |dq| per |v| of the sub-step q + (c h) v."""
        return step_bound(replace(NINE["symplectic_euler"], parts=(("drift", c),)), fmt).first_order[0][1]

    own = abs(fmt.nearest(Q(1, 6)) - Q(1, 6)) / fmt.u
    assert own > 0
    assert drift_by(Q(1, 6)) == constant_polynomial(own + Q(3, 6)) * H
    assert drift_by(Q(1, 4)) == constant_polynomial(Q(2, 4)) * H


def test_bounds_of_all_formats_are_one_polynomial_where_every_constant_is_a_float():
    assert all(step_bound(rk4, fmt).error == step_bound(rk4).error for fmt in (BINARY32, BINARY16, BFLOAT16))
    at = Q(1, 4), Q(1), Q(1)
    wide, narrow = (step_bound(rk4, fmt).error_of(*at)[0] / fmt.u for fmt in (BINARY64, BFLOAT16))
    assert wide < narrow < wide * (1 + 16 * BFLOAT16.u)  # the powers of d beyond the first


def test_constants_of_every_exact_kind_are_taken_and_plain_uses_of_zero_and_one_are_free():
    def step(force, q, v, h):
        half = np.float32(0.5)
        return sum([q, Q(1, 2) * h * v, half * h * v]), np.int64(1) * v + 0 + 1.0 * h * force(q)

    bound = step_bound(step)
    assert bound.differences(oscillator_matrix(NINE["forward_euler"])) == []
    assert bound.first_order[1] == BY_HAND["forward_euler"][1]


def test_a_step_may_return_a_number_and_nothing_else():
    assert step_bound(lambda force, q, v, h: (q, 0)).entries == ({0: 1}, {}, {}, {})
    with pytest.raises(RefusedOperation, match="returned None, a NoneType"):
        step_bound(lambda force, q, v, h: (q, None))
    for wrong in (None, (1, 2, 3)):
        with pytest.raises(RefusedOperation, match=r"must return the pair \(q1, v1\)"):
            step_bound(lambda force, q, v, h, wrong=wrong: wrong)


def test_a_step_that_is_not_linear_in_the_state_has_a_bound_but_no_matrix():
    def duffing(q):
        return -q - q * q * q

    bound = step_bound(symplectic_euler, force=duffing)
    h, q, v = (Q(x) for x in (0.1, 0.7, -1.3))
    exact = symplectic_euler(duffing, q, v, h)
    floats = symplectic_euler(duffing, 0.7, -1.3, 0.1)
    errors = [abs(Q(x) - y) for x, y in zip(floats, exact, strict=True)]
    assert all(0 < e <= most < 10 * BINARY64.u for e, most in zip(errors, bound.error_of(h, q, v), strict=True))
    for of_matrix in ("entries", "error", "underflow", "first_order"):
        with pytest.raises(NotLinear, match=r"q\*\*3"):
            getattr(bound, of_matrix)
    with pytest.raises(NotLinear, match="adds a constant"):
        _ = step_bound(lambda force, q, v, h: (q + 1, v)).entries


def test_the_evaluated_bound_is_the_printed_one():
    bound = step_bound(forward_euler)
    u, eta = BINARY64.u, BINARY64.eta
    d, h, q, v = u / (1 + u), Q(1, 3), Q(-2), Q(5, 7)
    expected = d * (abs(q) + 2 * h * v) + d**2 * h * v + eta * (1 + d) / 2
    assert bound.error_of(h, q, v)[0] == bound.at(h).of(q, v)[0] == expected
    exact, error, underflow = envelope_of(bound)
    assert exact == (((1,), (0, 1)), ((0, -1), (1,)))
    assert error[0] == ((d,), (0, 2 * d + d**2))
    assert underflow[0] == (eta * (1 + d) / 2,)


# --- no float step leaves it ----------------------------------------------------------------------------------------


def _steps_of_every_state(step, fmt: FloatFormat, fusing: bool):
    """(h, q, v, [|dq|, |dv|]) of the float step from every third state of a coarse format; None after an overflow."""
    numbers = sorted({fmt.nearest(k * fmt.eta) for k in range(int(fmt.largest / fmt.eta) + 1)})
    lift = soft_lift(fmt, fusing)
    for h, q, v in product(numbers, [-x for x in numbers[:0:-1]] + numbers, numbers[::3]):
        try:
            floats = step(oscillator, lift(q), lift(v), lift(h))
            exact = step(oscillator, q, v, h)
            yield h, q, v, [abs(x.value - y) for x, y in zip(floats, exact, strict=True)]
        except OverflowError:
            yield h, q, v, None


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("fusing", [False, True])
@pytest.mark.parametrize("step", [forward_euler, symplectic_euler, leapfrog])
def test_no_state_of_a_coarse_format_leaves_the_bound(step, fusing):
    """3-bit floats, exhaustively: the bound holds, fused or not; not so without eta; and nothing safe overflows."""
    bound = step_bound(step, COARSE)
    at = cache(bound.at)
    checked = outside = 0
    for h, q, v, errors in _steps_of_every_state(step, COARSE, fusing):
        if errors is None:
            assert not bound.is_safe(h, q, v)
            continue
        checked += 1
        assert all_within(errors, at(h).of(q, v))
        outside += not all_within(errors, at(h)._replace(underflow=(Q(0), Q(0))).of(q, v))
    assert checked > 1000
    assert outside > 0


@NATIVE_FORMATS
@pytest.mark.parametrize("key", [*NINE, *IRRATIONAL])
def test_the_machine_lifts_each_coefficient_to_the_float_that_the_bound_assumes(key, fmt):
    """Exact -> float -> float16 rounds twice, which might differ from once; for our coefficients it does not."""
    seen = coefficients(METHODS[key]).values()
    assert seen
    assert all(Q(float(NATIVE[fmt](float(c)))) == decide_by_enclosure(c, fmt.nearest) for c in seen)


@pytest.mark.slow(keep=6)
@NATIVE_FORMATS
@pytest.mark.parametrize("key", PROGRAMS)
def test_no_step_of_a_search_that_climbs_exceeds_the_bound(key, fmt):
    """About 2 million steps in all, over all exponents and the subnormals, |h| up to 4."""
    found = search(in_floats(key), envelope(key, fmt), NATIVE[fmt], (0.0, 4.0), 3, generations=14, population=1 << 12)
    assert found.violations == 0
    assert found.checked - found.overflowed > 50_000
    assert 1 / 2 < found.ratio <= 1


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", IRRATIONAL)
def test_no_step_of_a_search_leaves_the_bound_around_the_exact_map_over_a_field(key: str):
    """The search measures against rationals next to M; the worst that it finds is measured again, in balls."""
    step, bound = in_floats(key), bound_of(key)
    found = search(step, envelope(key), np.float64, (0.01, 1.0), seed=1, generations=10, population=1 << 10)
    assert found.violations == 0
    errors = error_in_balls(key, step, found.h, *found.state)
    most = bound.error_of(Q(found.h), *map(Q, found.state))
    assert all_within(errors, map(enclose, most))
    assert any(e > enclose(x / 2) for e, x in zip(errors, most, strict=True)), found.ratio


# --- a missing underflow term is noticed ----------------------------------------------------------------------------
