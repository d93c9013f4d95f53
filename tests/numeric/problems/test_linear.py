"""Linear problems: methods are bounded within their limits and grow beyond, as the stability function says."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.advance import State, float_start
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.reports.fact_sheet import facts
from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.linear.oscillator import stability_function_of
from tests.numeric.problems.runs_on_problems import EXPLICIT, IMPLICIT, RIGHT, TABLEAUX, fate, growth, states


@pytest.mark.parametrize("key", ["forward_euler", "rk4"])
def test_explicit_methods_are_right_on_a_stiff_pair_within_their_limit_and_not_beyond(key: str) -> None:
    assert fate(key, "stiff_pair", 1024, 0.01) == RIGHT
    assert fate(key, "stiff_pair", 256, 0.01) != RIGHT


def predicted(key: str, z: Fraction, steps: int) -> tuple[float, float]:
    """log10 of |R(z)|^steps, and R(z), exactly until the last."""
    value = exact(stability_function_of(TABLEAUX[key])(scalar(z)))  # type: ignore[misc]
    low, _ = endpoints(enclose(value))
    size = abs(low)
    logarithm = (size.numerator.bit_length() - size.denominator.bit_length()) * math.log10(2) if size else -math.inf
    return steps * logarithm, float(low)


@pytest.mark.slow(keep=11)
@pytest.mark.parametrize("key", [*EXPLICIT, *IMPLICIT])
def test_decay_of_a_million_follows_the_stability_function_and_overflows_where_that_says_so(key: str) -> None:
    size, factor = predicted(key, Fraction(-1000000, 32), 32)
    _, *ends = states(key, "dahlquist_1e6", 32, 1)
    assert len(ends) == (abs(factor) <= 1 or size <= 330)
    assert all((abs(y) <= 1) == (abs(factor) <= 1) for (y,) in ends)


# Linear problems: the numbers of steps on either side of the limit, real_limit or imaginary_limit over |lambda|.
EDGES = [
    ("rk4", "dahlquist_1e3", "real", 1000.0),
    ("forward_euler", "overdamped_oscillator", "real", 100.0),
    ("dormand_prince54", "stiff_pair", "real", 1000.0),
    ("forward_euler", "critically_damped_oscillator", "real", 1.0),
    ("rk4", "heat_equation", "real", 4 * 256 * math.cos(math.pi / 32) ** 2),
    ("rk4", "stiff_oscillator", "imaginary", 1000.0),
    ("rk4", "separated_oscillators", "imaginary", 1000.0),
    ("velocity_verlet", "stiff_oscillator", "imaginary", 1000.0),
    ("yoshida4", "separated_oscillators", "imaginary", 1000.0),
    ("rk4", "fermi_pasta_ulam", "imaginary", 50.0),
    ("velocity_verlet", "fermi_pasta_ulam", "imaginary", 50.0),
]


@pytest.mark.parametrize(("key", "name", "axis", "rate"), EDGES)
def test_explicit_methods_are_bounded_within_their_limit_over_the_largest_rate_and_grow_beyond(
    key: str, name: str, axis: str, rate: float
) -> None:
    fact = f"{axis}_limit"
    limit = float(facts(METHODS[key], only=[fact]).data[fact]["decimal"])
    steps = float(PROBLEMS[name].t) * rate / limit
    # The soft springs add a little to the chain's 50, and near the limit Verlet's amplitudes are large.
    room = 1.1 if name == "fermi_pasta_ulam" else 1.01
    assert growth(key, name, math.ceil(steps * room), 4) < 10
    assert growth(key, name, math.floor(steps / room) - 1, 200) > 1e9


@pytest.mark.parametrize("name", ["harmonic_oscillator", "fermi_pasta_ulam"])
def test_forward_euler_has_no_limit_on_oscillations(name: str) -> None:
    steps = 40000 if name == "fermi_pasta_ulam" else 100
    assert growth("forward_euler", name, steps, 20) > 1e3
    assert growth("rk4", name, steps) < 2


def fast_part(y: State) -> float:
    """The amplitude of what the two masses do against each other, 2/1024 at the start."""
    return math.hypot(y[0] - y[1], (y[2] - y[3]) / 1000)


def test_l_stable_methods_kill_the_fast_oscillation_and_gauss_methods_keep_it() -> None:
    for key in ("radau_iia2", "backward_euler"):
        assert fast_part(states(key, "separated_oscillators", 64)[-1]) < 1e-12
    for key in ("gauss2", "implicit_midpoint"):
        assert fast_part(states(key, "separated_oscillators", 64)[-1]) == pytest.approx(2 / 1024, rel=1e-6)


def highest_mode(y: State) -> float:
    """The part of the fastest decay in the heat equation, which alternates from point to point."""
    return abs(sum(x * math.sin((i + 1) * 15 * math.pi / 16) for i, x in enumerate(y)) / 8)


@pytest.mark.parametrize(("name", "part"), [("heat_equation", highest_mode), ("dahlquist_1e6", lambda y: abs(y[0]))])
def test_what_is_fast_is_gone_at_once_if_r_tends_to_zero_and_stays_for_long_if_to_one(
    name: str, part: Callable[[State], float]
) -> None:
    before = part(float_start(PROBLEMS[name]))
    assert part(states("radau_iia2", name, 8)[2]) < 1e-2 * before
    assert part(states("trapezoid", name, 8)[2]) > 0.5 * before
