"""Rounding over N steps: the norm is found, the theorem holds for actual runs, each hypothesis can fail and be met."""

from __future__ import annotations

from fractions import Fraction as Q
from itertools import product

import numpy as np
import pytest
from flint import ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.numeric.steppers import forward_euler, rk4, symplectic_euler
from driftproof.symbolic.algebra.certified import enclose, endpoints, is_less
from driftproof.symbolic.error_budget import ErrorOfRun
from driftproof.symbolic.rounding.formats import BFLOAT16, BINARY16, BINARY64
from driftproof.symbolic.rounding.n_steps_bound import (
    HypothesisFails,
    RunBound,
    largest_safe_state,
    run_bound,
    safe_state_text,
)
from driftproof.symbolic.rounding.step_bound import LinearBound, step_bound
from driftproof.symbolic.runs import apply, exact_matrix_at, power
from tests.changes import first_weight, moved
from tests.symbolic.rounding.programs import IRRATIONAL, ONE_ZERO, PROGRAMS, as_step, float_run, matrix_at
from tests.witnesses.leapfrog import leapfrog
from tests.witnesses.soft_float import FORMATS, soft_lift

U = BINARY64.u


def plain_bound(step, h: Q, steps: int, start=ONE_ZERO, fmt=BINARY64) -> RunBound:
    return run_bound(step, h, steps, start, fmt, local=step_bound(step, fmt).at(h))


@pytest.mark.parametrize(
    ("step", "target", "reached"), [(forward_euler, 200, 164), (symplectic_euler, 90, 67), (rk4, 115, 96)]
)
def test_forty_steps_of_a_quarter_are_bounded_as_promised(step, target, reached):
    """In units of u, in the Euclidean distance, from (1, 0); the sharper one-step bound does better than the plain."""
    h = Q(1, 4)
    plain, sharp = plain_bound(step, h, 40), run_bound(step, h, 40, ONE_ZERO)
    assert sharp.euclidean <= reached * U
    assert sharp.euclidean < plain.euclidean <= target * U
    final = float_run(step, 0.25, 40, (1.0, 0.0))
    exact = apply(power(matrix_at(step_bound(step), h), 40), *ONE_ZERO)
    squared = sum((x - y) ** 2 for x, y in zip(final, exact, strict=True))
    assert 0 < squared <= sharp.euclidean**2


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", PROGRAMS)
@settings(max_examples=10)
@given(
    h=st.floats(-1.5, 1.5).filter(lambda h: abs(h) > 1e-3),
    start=st.tuples(*[st.floats(-4, 4, width=16)] * 2),
    steps=st.integers(0, 12),
    dtype=st.sampled_from([np.float64, np.float32, np.float16]),
)
def test_no_run_leaves_its_bound(key, h, start, steps, dtype):
    fmt, size = FORMATS[dtype], Q(float(dtype(h)))
    z = tuple(Q(x) for x in start)
    bound = run_bound(PROGRAMS[key], size, steps, z, fmt)
    final = float_run(as_step(PROGRAMS[key]), float(size), steps, start, dtype)
    exact = apply(power(matrix_at(step_bound(PROGRAMS[key], fmt), size), steps), *z)
    errors = [x - y for x, y in zip(final, exact, strict=True)]
    assert sum(e * e for e in errors) <= bound.euclidean**2
    assert max(abs(e) for e in errors) <= bound.norm.component_per_unit * bound.own
    assert bound.norm.length(*errors) <= bound.own * (1 + Q(1, 2**100))


def test_underflow_is_inside_the_theorem_and_would_break_it_outside():
    """Forward Euler from the smallest subnormal: h v rounds to nothing, step after step, and r N eta pays for it."""
    h, steps = Q(1, 4), 40
    start = (BINARY64.eta, Q(0))
    bound = run_bound(forward_euler, h, steps, start)
    final = float_run(forward_euler, 0.25, steps, (float(BINARY64.eta), 0.0))
    exact = apply(power(exact_matrix_at(METHODS["forward_euler"], h), steps), *start)
    squared = sum((x - y) ** 2 for x, y in zip(final, exact, strict=True))
    assert final == start
    error, _ = step_bound(forward_euler).at(h)
    without = run_bound(forward_euler, h, steps, start, local=LinearBound(error, (Q(0), Q(0))))
    assert without.euclidean**2 < squared <= bound.euclidean**2


def test_nothing_happens_in_no_steps_or_from_the_origin_but_underflow():
    assert run_bound(rk4, Q(1, 4), 0, ONE_ZERO).own == 0
    origin = run_bound(rk4, Q(1, 4), 10, (Q(0), Q(0)))
    assert 0 < origin.own < 100 * BINARY64.eta
    assert run_bound(lambda force, q, v, h: (-v, q), Q(1), 10, ONE_ZERO).own == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"h": Q(1, 10)}, "h = 1/10 is not a binary64 number; the nearest is 3602879701896397/36028797018963968"),
        ({"start": (Q(1), Q(1, 3))}, "the start's v = 1/3 is not a binary64 number"),
        ({"start": (Q(2) ** 1024, Q(0))}, "the start's q is larger than the largest binary64 number"),
        ({"h": Q(2)}, "at h = 2: the step has real eigenvalues"),
        ({"h": Q(5, 2)}, "at h = 5/2: the step has real eigenvalues"),
        ({"steps": -1}, "N = -1"),
        ({"start": (BINARY64.largest, Q(0))}, "overflow of binary64 cannot be excluded within 40 steps"),
        ({"start": (BINARY64.largest, BINARY64.largest / 2)}, "reach 1.922e308, but a step is safe only up to 1.438"),
        ({"subject": forward_euler, "start": (BINARY64.largest / 2, BINARY64.largest / 8)}, "might reach 3.115e308"),
        ({"subject": forward_euler, "steps": 10**12}, r"states might reach 2\*\*43731420\d{3}, but a step is safe"),
    ],
)
def test_each_hypothesis_that_fails_is_named(arguments, message):
    witness = {"subject": symplectic_euler, "h": Q(1, 4), "steps": 40, "start": ONE_ZERO}
    assert run_bound(**witness).own > 0
    with pytest.raises(HypothesisFails, match=message):
        run_bound(**(witness | arguments))


def test_a_run_that_the_theorem_admits_does_not_overflow_and_one_just_beyond_may():
    h, fmt = Q(3, 2), BINARY16
    safe = largest_safe_state(rk4, h, fmt)
    inside = fmt.nearest(safe * Q(9, 10))
    assert run_bound(rk4, h, 50, (inside, Q(0)), fmt).own > 0
    assert all(abs(x) <= safe for x in float_run(rk4, 1.5, 50, (float(inside), 0.0), np.float16))
    with pytest.raises(HypothesisFails, match="overflow of binary16"):
        run_bound(rk4, h, 50, (fmt.nearest(safe * Q(11, 10)), Q(0)), fmt)


def test_the_closed_form_is_the_recursion_solved():
    """b(n+1) = (rho + c) b(n) + c rho^n |z0| + r, stepped in balls, ends where the formula does."""
    steps, h = 40, Q(1, 4)
    bound = run_bound(forward_euler, h, steps, ONE_ZERO)
    with ctx.workprec(600):
        rho, b = enclose(bound.norm.rho), enclose(Q(0))
        for n in range(steps):
            b = (rho + enclose(bound.growth)) * b + enclose(bound.growth) * rho**n + enclose(bound.underflow)
        low, high = endpoints(b)
    assert low <= bound.own <= high * (1 + Q(1, 2**39))


# --- over a number field --------------------------------------------------------------------------------------------


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("key", IRRATIONAL)
def test_n_steps_over_a_field_stay_within_the_theorem_and_a_planted_error_of_1e_13_leaves_it(key: str):
    h, start, steps, method = Q(1, 4), (Q(1), Q(3, 8)), 12, METHODS[key]
    bound = run_bound(method, h, steps, start).euclidean
    both, exact = (method, moved(method, first_weight(method), Q(1, 10**13))), exact_matrix_at(method, h)
    runs = (float_run(stepper(m, float), 0.25, steps, (1.0, 0.375)) for m in both)
    right, wrong = (ErrorOfRun(exact, h, steps, start, run) for run in runs)
    assert is_less(right.rounding, bound)
    assert is_less(bound, wrong.rounding)


# --- overflow -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fmt", [BINARY64, BINARY16, BFLOAT16], ids=lambda fmt: fmt.name)
@pytest.mark.parametrize("key", PROGRAMS)
def test_nothing_overflows_at_the_guard_and_something_does_far_beyond_it(key, fmt):
    h, subject, lift = Q(3, 2), PROGRAMS[key], soft_lift(fmt)
    step = as_step(subject, lift)
    guard = largest_safe_state(subject, h, fmt)
    assert step_bound(subject, fmt).is_safe(h, Q(1), Q(1))
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
    with pytest.raises(OverflowError, match=r"leapfrog.py:\d+: `q1 = .*a constant is too large"):
        largest_safe_state(leapfrog, huge, BINARY16)
    bound = step_bound(leapfrog, BINARY16)
    assert not bound.is_safe(huge, Q(0), Q(0))
    assert bound.is_safe(Q(1), Q(0), Q(0))
    resting = step_bound(lambda force, q, v, h: (q, v), BINARY16)
    for more in ((0, 0), (0, 1), (1, 0)):
        assert resting.is_safe(Q(1), huge + more[0], huge + more[1]) == (more == (0, 0))
    pushed = largest_safe_state(lambda force, q, v, h: (q + 32, v), Q(1), BINARY16)
    assert pushed == BINARY16.largest / (1 + BINARY16.relative_error) - 32
    huge = Q(BINARY64.largest)
    with pytest.raises(OverflowError, match="may overflow binary64 from every state"):
        largest_safe_state(lambda force, q, v, h: (q + huge + huge, v), Q(1))


def test_a_safe_state_is_told_as_a_power_of_ten_below_it():
    shown = {Q(0): "0", Q(1): "1e0", Q(999, 1000): "1e-1", Q(99, 10): "1e0", Q(10): "1e1", Q(995 * 10**304): "1e306"}
    assert {x: safe_state_text(x) for x in shown} == shown


def test_a_step_may_grow_without_underflow_and_underflow_without_growth():
    """Sums have no underflow; halves are off by eta/2 a component, in two steps by (1/2 + 1/4) eta, times sqrt 2."""
    sums = plain_bound(lambda force, q, v, h: (q - v, q + v), Q(1), 2)
    assert sums.underflow == 0 < sums.growth < sums.own
    halves = plain_bound(lambda force, q, v, h: (q / 2, v / 2), Q(1), 2)
    assert halves.growth == 0
    assert Q(9, 8) <= (halves.own / BINARY64.eta) ** 2 < Q(9, 8) + U
