"""The bound of one step: derived by running it, equal to the first order derived by hand, refused with a place."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction as Q
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.methods.problems import oscillator
from driftproof.methods.stepping import stepper
from driftproof.numeric.leapfrog import leapfrog
from driftproof.numeric.steppers import HAND_WRITTEN, forward_euler, rk4, symplectic_euler
from driftproof.symbolic.algebra.polynomials import ONE as CONSTANT
from driftproof.symbolic.algebra.polynomials import X
from driftproof.symbolic.algebra.rational_functions import fraction
from driftproof.symbolic.derivation.one_step import RING, H, rational
from driftproof.symbolic.linear.oscillator import one_step_matrix
from driftproof.symbolic.rounding.formats import BFLOAT16, BINARY16, BINARY32, BINARY64, FloatFormat
from driftproof.symbolic.rounding.number import RefusedOperation
from driftproof.symbolic.rounding.overflow import largest_safe_state
from driftproof.symbolic.rounding.polynomials import ETA, D
from driftproof.symbolic.rounding.polynomials import H as STEP
from driftproof.symbolic.rounding.polynomials import Q as STATE
from driftproof.symbolic.rounding.polynomials import V as VELOCITY
from driftproof.symbolic.rounding.soft_float import soft_lift
from driftproof.symbolic.rounding.step import StepBound, step_bound
from driftproof.symbolic.rounding.text import first_order_text, format_text, full_text
from driftproof.symbolic.rounding.trace import NotLinear
from tests.nine import NINE

ZERO, ONE = RING.zero, RING.one
# Derived by hand for the lesson's order of operations: the coefficient of u in |dq| and |dv|, of |q| and |v|.
BY_HAND = {
    "forward_euler": ((ONE, 2 * H), (2 * H, ONE)),
    "symplectic_euler": ((1 + 4 * H**2, 3 * H), (2 * H, ONE)),
    "rk4": (
        (1 + 23 * H**2 / 6 + 5 * H**4 / 12, 37 * H / 6 + 3 * H**3 / 2),
        (37 * H / 6 + 3 * H**3 / 2, 1 + 23 * H**2 / 6 + 5 * H**4 / 12),
    ),
}
# So coarse that every power of d counts, and small enough to try every state.
COARSE = FloatFormat("coarse", 3, -1, 1)


@pytest.mark.parametrize("key", HAND_WRITTEN)
def test_first_order_form_equals_the_one_derived_by_hand(key):
    assert step_bound(HAND_WRITTEN[key]).first_order == BY_HAND[key]


def test_first_order_form_notices_another_order_of_operations():
    def rk4_divided_first(force, q, v, h):
        return rk4(force, q, v, h / 6 * 6)

    assert step_bound(rk4_divided_first).first_order != BY_HAND["rk4"]


@pytest.mark.parametrize("key", NINE)
def test_the_same_run_proves_the_formula_of_every_method(key):
    definition = one_step_matrix(NINE[key])
    assert step_bound(NINE[key]).differences(definition) == []
    if key in HAND_WRITTEN:
        assert step_bound(HAND_WRITTEN[key]).differences(definition) == []


def test_a_step_with_another_polynomial_is_reported_with_the_coefficient():
    def rk4_with_a_fifth(force, q, v, h):
        q1, v1 = rk4(force, q, v, h)
        return q1 + h * h * h * v / 30, v1

    (line,) = step_bound(rk4_with_a_fifth).differences(one_step_matrix(NINE["rk4"]))
    assert line == "M_qv, coefficient of h**3: the program has -2/15, the definition -1/6"
    assert len(step_bound(forward_euler).differences(one_step_matrix(NINE["symplectic_euler"]))) == 1
    assert step_bound(leapfrog).differences(one_step_matrix(NINE["velocity_verlet"])) == []


def test_a_decimal_constant_is_the_double_that_it_is_and_not_the_fraction_that_it_means():
    def euler_times_a_tenth(force, q, v, h):
        return q + 0.1 * h * v, v + 0.1 * h * force(q)

    one, tenth = fraction(CONSTANT), fraction(X / 10)
    meant = ((one, tenth), (-tenth, one))
    assert f"the program has {Q(0.1)}, the definition 1/10" in step_bound(euler_times_a_tenth).differences(meant)[0]


@pytest.mark.parametrize("fmt", [BINARY64, BINARY32, BINARY16, BFLOAT16])
def test_a_lifted_coefficient_owns_up_to_its_distance_from_the_float(fmt):
    """q + (c h) v: for c = 1/6 that is c's own error, and u/6 for c*h, (c h)*v and the sum each; 1/4 has only two."""
    own = rational(abs(fmt.nearest(Q(1, 6)) - Q(1, 6)) / fmt.u)
    assert own > 0
    assert _drift_by(Q(1, 6), fmt) == (own + rational(Q(3, 6))) * H
    assert _drift_by(Q(1, 4), fmt) == rational(Q(2, 4)) * H


def _drift_by(c: Q, fmt: FloatFormat):
    """The first-order bound on |dq| per |v| of the sub-step q + (c h) v."""
    drift = replace(NINE["symplectic_euler"], parts=(("drift", c),))
    return step_bound(drift, fmt).first_order[0][1]


def test_bounds_of_all_formats_are_one_polynomial_where_every_constant_is_a_float():
    assert {step_bound(rk4, fmt).error for fmt in (BINARY64, BINARY32, BINARY16, BFLOAT16)} == {step_bound(rk4).error}
    at = Q(1, 4), Q(1), Q(1)
    wide, narrow = (step_bound(rk4, fmt).error_of(*at)[0] / fmt.u for fmt in (BINARY64, BFLOAT16))
    assert wide < narrow < wide * (1 + 16 * BFLOAT16.u)  # the powers of d beyond the first


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


def _with_only(bound: StepBound, kept) -> StepBound:
    """The bound without the terms whose powers (d, eta, h, q, v) are not `kept`."""
    errors = [type(x.error)(x.error.ring, {p: c for p, c in x.error.terms() if kept(p)}) for x in bound.outputs]
    outputs = [SimpleNamespace(exact=x.exact, error=e) for x, e in zip(bound.outputs, errors, strict=True)]
    return replace(bound, outputs=tuple(outputs))


@pytest.mark.parametrize("fusing", [False, True])
@pytest.mark.parametrize("step", [forward_euler, symplectic_euler, leapfrog])
def test_no_state_of_a_coarse_format_leaves_the_bound(step, fusing):
    """3-bit floats, exhaustively: the bound holds, fused or not; not so without eta; and nothing safe overflows."""
    bound = step_bound(step, COARSE)
    without_eta = _with_only(bound, lambda powers: powers[1] == 0)
    checked = outside = 0
    for h, q, v, errors in _steps_of_every_state(step, COARSE, fusing):
        if errors is None:
            assert not bound.is_safe(h, q, v)
            continue
        checked += 1
        assert all(e <= most for e, most in zip(errors, bound.error_of(h, q, v), strict=True))
        outside += any(e > most for e, most in zip(errors, without_eta.error_of(h, q, v), strict=True))
    assert checked > 1000
    assert outside > 0


def test_every_power_of_d_is_kept():
    """n products in a row: exactly ((1 + d)^n - 1)|h^n q|, and eta/2 at each, carried on by the factors that follow."""
    n = 6

    def multiply(force, q, v, h):
        for _ in range(n):
            q = q * h
        return q, v

    error = step_bound(multiply).outputs[0].error
    underflow = sum(((1 + D) * STEP) ** k for k in range(n)) * ETA / 2
    assert error == ((1 + D) ** n - 1) * STEP**n * STATE + underflow


def test_the_product_of_two_rounded_numbers_counts_both_errors_and_their_product():
    """(h h)(h v): exactly (1 + d)(h² + e)(|h v| + e') - |h³ v| + eta/2, where e and e' are the factors' errors."""
    error = step_bound(lambda force, q, v, h: ((h * h) * (h * v), v)).outputs[0].error
    first, second = ((1 + D) * x + ETA / 2 for x in (STEP**2, STEP * VELOCITY))
    assert error == (1 + D) * first * second - STEP**3 * VELOCITY + ETA / 2


PROGRAMS = {**NINE, **HAND_WRITTEN, "leapfrog": leapfrog}


def _as_step(program, fmt: FloatFormat):
    return program if callable(program) else stepper(program, soft_lift(fmt))


@pytest.mark.parametrize("fmt", [BINARY64, BINARY16, BFLOAT16])
@pytest.mark.parametrize("key", PROGRAMS)
def test_nothing_overflows_at_the_guard_and_something_does_far_beyond_it(key, fmt):
    h, step, lift = Q(3, 2), _as_step(PROGRAMS[key], fmt), soft_lift(fmt)
    guard = largest_safe_state(PROGRAMS[key], h, fmt)
    assert step_bound(PROGRAMS[key], fmt).is_safe(h, Q(1), Q(1))
    inside = fmt.nearest(guard * (1 - 2 * fmt.u))
    for q, v in product((inside, -inside), repeat=2):
        step(oscillator, lift(q), lift(v), lift(h))
    largest = lift(fmt.largest)
    with pytest.raises(OverflowError):
        step(oscillator, largest, largest, lift(h)) and step(oscillator, largest, -largest, lift(h))
    # The guard is not idle: it gives away less than a factor of 16.
    assert guard > fmt.largest / 16


def test_a_step_size_that_overflows_by_itself_leaves_no_safe_state():
    huge = BINARY16.largest
    with pytest.raises(OverflowError, match=r"leapfrog.py:\d+: `q1 = .*constant is out of range"):
        largest_safe_state(leapfrog, huge, BINARY16)
    bound = step_bound(leapfrog, BINARY16)
    assert not bound.is_safe(huge, Q(0), Q(0))
    assert bound.is_safe(Q(1), Q(0), Q(0))


REFUSED = {
    "a comparison of a value": lambda force, q, v, h: (q, v) if q > v else (v, q),
    "a branch on a value": lambda force, q, v, h: (q, v) if q else (v, q),
    "division by something that depends on q, v or h": lambda force, q, v, h: (q / h, v),
    "a function of math": lambda force, q, v, h: (math.sin(q), v),
    "a call of sin": lambda force, q, v, h: (np.sin(q), v),
    "a call of sqrt": lambda force, q, v, h: (q.sqrt(), v),
    "a conversion to int": lambda force, q, v, h: (int(q), v),
    "a power, a library call": lambda force, q, v, h: (q**2, v),
    "a floor division": lambda force, q, v, h: (q // 2, v),
    "rounding a value": lambda force, q, v, h: (round(q), v),
    "abs()": lambda force, q, v, h: (abs(q), v),
    "division by zero": lambda force, q, v, h: (q / 0, v),
    "a look-up by value": lambda force, q, v, h: ({q: 1}[q], v),
    "not a finite number": lambda force, q, v, h: (q + math.inf, v),
    "which is str": lambda force, q, v, h: (q * "2", v),
    "which is bool": lambda force, q, v, h: (q * True, v),
    "which is complex": lambda force, q, v, h: (q * 1j, v),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_bounded_is_refused_with_the_line_that_does_it(what):
    with pytest.raises(RefusedOperation) as refusal:
        step_bound(REFUSED[what])
    message = str(refusal.value)
    place = f"{__file__}:{REFUSED[what].__code__.co_firstlineno}: `"
    assert message.startswith(place)
    assert what in message
    assert "lambda force, q, v, h:" in message


def test_a_refusal_points_into_the_force_when_the_force_is_to_blame():
    def pendulum(q):
        return -math.sin(q)

    with pytest.raises(RefusedOperation, match=r"test_roundoff.py:\d+: `return -math.sin\(q\)`"):
        step_bound(symplectic_euler, force=pendulum)


def test_a_step_that_returns_something_else_is_refused():
    with pytest.raises(RefusedOperation, match="returned None, which is NoneType"):
        step_bound(lambda force, q, v, h: (q, None))
    for wrong in (None, (1, 2, 3)):
        with pytest.raises(RefusedOperation, match=r"must return the pair \(q1, v1\)"):
            step_bound(lambda force, q, v, h, wrong=wrong: wrong)


def test_constants_of_every_exact_kind_are_taken_and_plain_uses_of_zero_and_one_are_free():
    def step(force, q, v, h):
        half = np.float32(0.5)
        return sum([q, Q(1, 2) * h * v, half * h * v]), np.int64(1) * v + 0 + 1.0 * h * force(q)

    bound = step_bound(step)
    assert bound.differences(one_step_matrix(NINE["forward_euler"])) == []
    assert bound.first_order[1] == BY_HAND["forward_euler"][1]


def test_a_step_that_is_not_linear_in_the_state_has_a_bound_but_no_matrix():
    def duffing(q):
        return -q - q * q * q

    bound = step_bound(symplectic_euler, force=duffing)
    h, q, v = (Q(x) for x in (0.1, 0.7, -1.3))
    exact = symplectic_euler(duffing, q, v, h)
    floats = symplectic_euler(duffing, 0.7, -1.3, 0.1)
    errors = [abs(Q(x) - y) for x, y in zip(floats, exact, strict=True)]
    assert all(0 < e <= most < 10 * BINARY64.u for e, most in zip(errors, bound.error_of(h, q, v), strict=True))
    for of_matrix in ("matrix", "error", "underflow", "first_order", "coefficients"):
        with pytest.raises(NotLinear, match=r"q\*\*3"):
            getattr(bound, of_matrix)


def test_a_step_that_adds_a_constant_of_its_own_has_no_matrix_either():
    with pytest.raises(NotLinear, match="adds a constant"):
        _ = step_bound(lambda force, q, v, h: (q + 1, v)).matrix


def test_a_reader_sees_the_formula():
    assert first_order_text(step_bound(rk4)) == [
        "|dq| <= u ((1 + 23/6 h**2 + 5/12 h**4) |q| + (37/6 h + 3/2 h**3) |v|)",
        "|dv| <= u ((37/6 h + 3/2 h**3) |q| + (1 + 23/6 h**2 + 5/12 h**4) |v|)",
    ]
    assert full_text(step_bound(forward_euler)) == [
        "|dq|: d (|q| + 2 h |v|)",
        "|dq|: d**2 (h |v|)",
        "|dq|: eta (1/2)",
        "|dq|: eta d (1/2)",
        "|dv|: d (2 h |q| + |v|)",
        "|dv|: d**2 (h |q|)",
        "|dv|: eta (1/2)",
        "|dv|: eta d (1/2)",
    ]
    assert full_text(step_bound(rk4))[-1].startswith("and 30 lines")
    assert len(full_text(step_bound(rk4), powers=None)) == len(full_text(step_bound(rk4))) - 1 + 30
    assert format_text(step_bound(rk4, BINARY16)) == "binary16: u = 2**-11, d = u/(1 + u), eta = 2**-24"


def test_the_evaluated_bound_is_the_printed_one():
    bound = step_bound(forward_euler)
    u, eta = BINARY64.u, BINARY64.eta
    d, h, q, v = u / (1 + u), Q(1, 3), Q(-2), Q(5, 7)
    expected = d * (abs(q) + 2 * h * v) + d**2 * h * v + eta * (1 + d) / 2
    assert bound.error_of(h, q, v)[0] == bound.at(h).of(q, v)[0] == expected
    exact, error, underflow = bound.coefficients
    assert exact == (((1,), (0, 1)), ((0, -1), (1,)))
    assert error[0] == ((d,), (0, 2 * d + d**2))
    assert underflow[0] == (eta * (1 + d) / 2,)
