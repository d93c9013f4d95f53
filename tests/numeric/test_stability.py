"""What float runs show of stability: the step of the overflow, growth of powers, bisection; each with a twin."""

from __future__ import annotations

from math import inf, isfinite, nextafter, sqrt

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.advance import Advance, State, advance, float_start
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.stability import fewest_steps, largest_bounded, observe, stays_bounded

STIFF = PROBLEMS["stiff_oscillator"]


def on(key: str, problem: str) -> Advance:
    return advance(METHODS[key], PROBLEMS[problem])


def euler(y: State, h: float) -> State:
    return y[0] + h * y[1], y[1] + h * (-1000.0 * 1000.0 * y[0])


@pytest.mark.parametrize("h", [0.5, 0.01, 1 / 128, 0.003])
def test_overflow_is_found_at_the_very_step(h: float) -> None:
    y, count = float_start(STIFF), 0
    while all(map(isfinite, y)):
        y, count = euler(y, h), count + 1
    seen = observe(on("forward_euler", "stiff_oscillator"), float_start(STIFF), h, 10**5)
    assert (seen.failed_after, seen.remark) == (count, "not finite")
    short = observe(on("forward_euler", "stiff_oscillator"), float_start(STIFF), h, count - 1)
    assert short.failed_after is None


def test_a_run_that_raises_says_after_which_step() -> None:
    def fragile(y: State, h: float, first: int, last: int) -> State:
        if last > 1234:
            raise ZeroDivisionError("float division by zero")
        return y

    seen = observe(fragile, (1.0,), 0.1, 10**4)
    assert (seen.failed_after, seen.remark) == (1235, "float division by zero")
    assert observe(fragile, (1.0,), 0.1, 1234).failed_after is None


def test_the_largest_size_is_kept_and_a_run_that_is_large_enough_ends() -> None:
    def pulse(y: State, h: float, first: int, last: int) -> State:
        return (5.0 if last == 7 else 1.0,)

    assert observe(pulse, (1.0,), 0.1, 1000).largest == 5
    assert observe(pulse, (1.0,), 0.1, 1000, 5.0).state == (1.0,)
    assert observe(pulse, (1.0,), 0.1, 7, 5.0).state == observe(pulse, (1.0,), 0.1, 1000, 4.9).state == (5.0,)


def test_looks_do_not_change_the_state() -> None:
    runs = on("rk4", "harmonic_oscillator")
    assert observe(runs, (1.0, 0.0), 0.1, 12345).state == runs((1.0, 0.0), 0.1, 0, 12345)


def test_an_l_stable_step_falls_through_subnormals_to_zero() -> None:
    seen = observe(on("radau_iia3", "stiff_oscillator"), float_start(STIFF), 1 / 128, 1280)
    assert seen.failed_after is None
    assert abs(seen.state[0]) < 1e-300


LIMITS = {
    ("rk4", "harmonic_oscillator"): 2 * sqrt(2),
    ("symplectic_euler", "harmonic_oscillator"): 2.0,
    ("forward_euler", "dahlquist_1e3"): 0.002,
    ("rk4", "stiff_oscillator"): sqrt(2) / 500,
}


@pytest.mark.parametrize(("key", "problem"), LIMITS)
def test_bisection_finds_the_limit(key: str, problem: str) -> None:
    runs, wanted, components = on(key, problem), LIMITS[key, problem], len(PROBLEMS[problem].start)
    low, high = largest_bounded(lambda h: stays_bounded(runs, components, h), wanted / 3)
    assert high == nextafter(low, inf)
    assert wanted * (1 - 1e-12) < low < wanted * (1 + 1e-12)


def test_bisection_says_where_nothing_grows_and_where_all_does() -> None:
    assert largest_bounded(lambda h: True, 1.0) == (2.0**30, inf)
    assert largest_bounded(lambda h: False, 1.0) == (0.0, 2.0**-20)
    assert largest_bounded(lambda h: h <= 0.7, 1.0) == (0.7, nextafter(0.7, 1.0))


def test_weak_growth_is_seen_only_above_what_so_many_steps_show() -> None:
    runs = on("forward_euler", "harmonic_oscillator")  # |R| = sqrt(1 + h^2)
    assert not stays_bounded(runs, 2, 1e-6)
    assert stays_bounded(runs, 2, 1e-7)


def test_the_linear_growth_of_a_double_eigenvalue_is_seen() -> None:
    assert not stays_bounded(on("symplectic_euler", "harmonic_oscillator"), 2, 2.0)
    assert stays_bounded(on("implicit_midpoint", "harmonic_oscillator"), 2, 2.0)


def test_fewest_steps_are_found_and_missed() -> None:
    assert fewest_steps(lambda n: n >= 777, 1024) == 777
    assert fewest_steps(lambda n: True, 8) == 1
    assert fewest_steps(lambda n: n >= 777, 512) is None


def test_what_is_good_by_luck_is_not_taken() -> None:
    assert fewest_steps(lambda n: n >= 777 or n == 8, 1024) == 777
    assert fewest_steps(lambda n: n == 8, 1024) is None
