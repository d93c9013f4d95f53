"""The machinery that measures error over bound: right against fractions, and not blind to a bound that is too small."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.steppers import forward_euler, rk4, symplectic_euler
from driftproof.symbolic.rounding.step_bound import step_bound
from tests.witnesses import worst_case
from tests.witnesses.soft_float import FORMATS
from tests.witnesses.worst_case import (
    Envelope,
    envelope_of,
    error_ratios,
    random_floats,
    random_steps,
    search,
    worst_of,
)


def envelope_for(step, dtype) -> Envelope:
    return envelope_of(step_bound(step, FORMATS[dtype]))


def shrunk(envelope: Envelope, factor: Q) -> Envelope:
    error = tuple(tuple(tuple(c * factor for c in entry) for entry in row) for row in envelope.error)
    return Envelope(envelope.exact, error, envelope.underflow)


def points(dtype, count: int, seed: int):
    rng = np.random.default_rng(seed)
    kind = np.dtype(dtype)
    return random_steps(rng, kind, (0.0, 2.0), count), random_floats(rng, kind, count), random_floats(rng, kind, count)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("step", [forward_euler, rk4])
@pytest.mark.parametrize("dtype", FORMATS)
def test_the_fast_ratio_encloses_the_ratio_in_fractions(step, dtype):
    bound, envelope = step_bound(step, FORMATS[dtype]), envelope_for(step, dtype)
    h, q, v = points(dtype, 300, seed=1)
    low, high = error_ratios(step, envelope, h, q, v)
    assert np.nanmax(high - low) < 2**-5
    for i in np.flatnonzero(np.isfinite(low)):
        floats = step(oscillator, q[i], v[i], h[i])
        exact_h, exact_q, exact_v = (Q(float(x[i])) for x in (h, q, v))
        exact = step(oscillator, exact_q, exact_v, exact_h)
        errors = [abs(Q(float(x)) - y) for x, y in zip(floats, exact, strict=True)]
        ratio = max(e / most for e, most in zip(errors, bound.error_of(exact_h, exact_q, exact_v), strict=True))
        # The two ends are rounded to at least 53 bits.
        assert Q(float(low[i])) - Q(1, 2**50) <= ratio <= Q(float(high[i])) + Q(1, 2**50)


def test_integers_take_over_where_there_is_no_wider_type(monkeypatch):
    envelope, (h, q, v) = envelope_for(rk4, np.float64), points(np.float64, 200, seed=2)
    fast = error_ratios(rk4, envelope, h, q, v)
    monkeypatch.setattr(worst_case, "_wider", lambda *of: None)
    slow = error_ratios(rk4, envelope, h, q, v)
    known = np.isfinite(slow.low)
    assert known.sum() > 100
    assert np.array_equal(slow.low, slow.high, equal_nan=True)
    assert (fast.low[known] <= slow.low[known]).all()
    assert (slow.high[known] <= fast.high[known]).all()


def test_a_bound_that_is_a_little_too_small_is_caught_and_no_honest_one_is():
    envelope = envelope_for(forward_euler, np.float32)
    honest = search(forward_euler, envelope, np.float32, (0.0, 0.25), seed=4, generations=24)
    too_small = search(forward_euler, shrunk(envelope, Q(19, 20)), np.float32, (0.0, 0.25), seed=4, generations=24)
    assert honest.violations == 0
    assert too_small.violations > 0
    assert too_small.ratio > 1


def test_a_violation_is_counted_exactly_and_equality_is_none():
    """In integers where in doubt: a bound equal to the error is kept, one less by 2**-80 of it is exceeded."""
    h, q, v = (np.array([x]) for x in (0.1, 1.0, 1.0))
    floats = forward_euler(oscillator, 1.0, 1.0, 0.1)
    exact = forward_euler(oscillator, Q(1), Q(1), Q(0.1))
    error_q, error_v = (abs(Q(x) - y) for x, y in zip(floats, exact, strict=True))
    tables = envelope_of(step_bound(forward_euler)).exact
    for factor, violations in ((Q(1), 0), (1 - Q(1, 2**80), 1)):
        envelope = Envelope(tables, (((), ()), ((), ())), ((error_q * factor,), (error_v,)))
        found = worst_of(error_ratios(forward_euler, envelope, h, q, v), h, q, v)
        assert found.violations == violations
        assert (found.ratio > 1) == (violations == 1)


def test_an_error_where_the_bound_is_zero_is_a_violation_and_no_error_is_none():
    nothing = Envelope((((1,), ()), ((), (1,))), (((), ()), ((), ())), ((), ()))
    h = np.array([0.5, 0.5])
    exact = error_ratios(lambda force, q, v, h: (q, v), nothing, h, h, h)
    wrong = error_ratios(lambda force, q, v, h: (q, v + v), nothing, h, h, h)
    assert list(exact.high) == [0, 0]
    assert list(wrong.low) == [np.inf, np.inf]


def test_overflow_is_counted_apart():
    envelope = envelope_for(rk4, np.float16)
    h = np.array([1.0, 60000.0], dtype=np.float16)
    ones = np.ones_like(h)
    low, high = error_ratios(rk4, envelope, h, ones, ones)
    assert list(np.isnan(low)) == list(np.isnan(high)) == [False, True]
    found = worst_of((low, high), h, ones, ones)
    assert (found.checked, found.overflowed, found.violations) == (2, 1, 0)
    all_over = worst_of((low[1:], high[1:]), h[1:], ones[1:], ones[1:])
    assert all_over.ratio == -np.inf
    assert found.merged(all_over).ratio == found.ratio
    assert found.merged(all_over).overflowed == 2


def test_a_search_is_repeatable_and_stays_in_its_range():
    envelope = envelope_for(rk4, np.float64)
    at = {"dtype": np.float64, "h_range": (0.25, 0.5), "seed": 6, "generations": 5, "population": 1 << 8}
    found = search(rk4, envelope, **at)
    assert search(rk4, envelope, **at) == found
    assert found.checked == 6 << 8
    assert 0.25 <= abs(found.h) <= 0.5


@pytest.mark.parametrize(("step", "h"), [(rk4, 2.5), (symplectic_euler, 1.0)])
def test_a_search_climbs_higher_than_as_many_random_steps(step, h):
    envelope = envelope_for(step, np.float64)
    at = {"dtype": np.float64, "h_range": (h, h), "seed": 1}
    climbing = search(step, envelope, generations=40, population=1 << 11, **at)
    random = search(step, envelope, generations=0, population=41 << 11, **at)
    assert climbing.checked == random.checked
    assert climbing.ratio > random.ratio


def test_the_type_that_checks_is_wide_enough_for_the_degree():
    """h**n q at the ends of the range of float32 is out of range for float64 from n = 5 on."""
    assert worst_case._wider(np.dtype(np.float32), 4) == np.float64
    assert worst_case._wider(np.dtype(np.float32), 5) != np.float64
    assert worst_case._wider(np.dtype(np.float32), 10**6) is None
    high = Envelope((((0,) * 5 + (1,), ()), ((), (1,))), (((), ()), ((), ())), ((), ()))
    h = np.array([2.0**-140, 2.0**30], dtype=np.float32)
    ones = np.full_like(h, 2.0**-120)
    low, _ = error_ratios(lambda force, q, v, h: (h * 0, v), high, h, ones, ones)
    assert list(low) == [np.inf, np.inf]  # the product is tiny, and not lost
