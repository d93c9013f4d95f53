"""What `Problem.expected` says, seen in runs: each sentence of a method that does so and of a twin that does not."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction as Q
from itertools import pairwise

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.advance import State, advance, float_start, step_times
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.stability import observe
from driftproof.numeric.work_precision.exact import decimal_energy, distance_from_digits, largest_state_size
from driftproof.texts.writing.records import facts_of

RIGHT, WRONG, ENDED = "right", "wrong", "ended"


def states(key: str, name: str, steps: int, pieces: int = 8, t: Q | None = None) -> list[State]:
    """The start and the states after each piece of a run to t; those up to where it ended."""
    problem = PROBLEMS[name]
    run, y, h = advance(METHODS[key], problem), float_start(problem), step_times(t or problem.t, steps).h
    found = [y]
    for first, last in pairwise(i * steps // pieces for i in range(pieces + 1)):
        try:
            y = run(y, h, first, last)
        except (ArithmeticError, ValueError):
            break
        if not all(map(math.isfinite, y)):
            break
        found.append(y)
    return found


def fate(key: str, name: str, steps: int, tolerance: float, t: Q | None = None) -> str:
    """RIGHT within the tolerance at t, a time of the reference's."""
    reference = PROBLEMS[name].reference
    found = states(key, name, steps, 1, t)
    if len(found) == 1:
        return ENDED
    digits = reference.states[reference.times.index(t or PROBLEMS[name].t)]
    return RIGHT if distance_from_digits(found[-1], digits) < tolerance else WRONG


def energy_errors(key: str, name: str, steps: int, pieces: int = 8) -> list[float]:
    problem = PROBLEMS[name]
    before = decimal_energy(problem, problem.start)
    return [float(decimal_energy(problem, y) - before) for y in states(key, name, steps, pieces)[1:]]


def growth(key: str, name: str, steps: int, times: int = 1) -> float:
    """The largest size of a state over `times` times the interval, over the solution's; infinite where it ends."""
    problem = PROBLEMS[name]
    seen = observe(advance(METHODS[key], problem), float_start(problem), step_times(problem.t, steps).h, times * steps)
    return math.inf if seen.failed_after is not None else seen.largest / largest_state_size(problem)


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
    limit = float(facts_of(METHODS[key], [fact])[fact]["decimal"])
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


# Conservative problems: steps for which the motion is resolved, so that eight energy errors tell a drift.
CHAIN = [("kepler", 400), ("pendulum", 40), ("henon_heiles", 200)]


def drifts(errors: list[float]) -> bool:
    """The last quarter is far worse than the first."""
    return max(map(abs, errors[-2:])) > 2 * max(map(abs, errors[:2]))


@pytest.mark.parametrize(("name", "steps"), CHAIN)
def test_energy_drifts_with_explicit_methods_and_stays_bounded_with_symplectic_ones(name: str, steps: int) -> None:
    for key in ("velocity_verlet", "implicit_midpoint", "gauss2"):
        assert not drifts(energy_errors(key, name, steps)), key
    assert drifts(energy_errors("rk4", name, steps))


@pytest.mark.parametrize(("name", "steps"), CHAIN)
def test_energy_drifts_down_with_l_stable_methods_and_not_with_symmetric_ones(name: str, steps: int) -> None:
    for key in ("radau_iia2", "radau_iia3"):
        errors = energy_errors(key, name, steps)
        assert drifts(errors), key
        assert errors[-1] < min(errors[:4]) < 0
    assert not drifts(energy_errors("trapezoid", name, steps))


def test_drift_falls_with_the_order() -> None:
    for key, order in (("rk4", 5), ("heun3", 3)):  # of the energy: one more than the method's, if that is even
        coarse, fine = (abs(energy_errors(key, "henon_heiles", steps)[-1]) for steps in (800, 1600))
        assert order - 0.5 < math.log2(coarse / fine) < order + 0.5


@pytest.mark.parametrize("key", ["rk4", "velocity_verlet"])
def test_planets_close_to_their_sun_are_thrown_out_unless_the_pericentre_is_resolved(key: str) -> None:
    far, near = ([math.hypot(*y[:2]) for y in states(key, "kepler_eccentric", steps)] for steps in (200, 8000))
    assert far[-1] > 4 > 2 > max(near)
    assert all(a < b for a, b in pairwise(far))


def test_an_eccentricity_of_099_needs_a_hundred_thousand_equal_steps() -> None:
    assert max(energy_errors("velocity_verlet", "kepler_extreme", 2000)) > 10
    errors = energy_errors("velocity_verlet", "kepler_extreme", 128000)
    assert max(map(abs, errors)) < 0.003
    assert not drifts(errors)


def farthest(key: str, steps: int) -> float:
    return max(abs(y[0]) for y in states(key, "pendulum_near_separatrix", steps, steps // 10))


def gained(key: str, steps: int) -> float:
    return max(energy_errors(key, "pendulum_near_separatrix", steps, 40))


@pytest.mark.parametrize(("key", "good", "bad"), [("ralston2", 4000, 1000), ("heun2", 20000, 16000)])
def test_a_pendulum_that_gains_two_to_the_minus_nineteen_goes_over_the_top(key: str, good: int, bad: int) -> None:
    assert gained(key, good) < 2**-19
    assert farthest(key, good) < math.pi
    assert gained(key, bad) > 2**-19
    assert farthest(key, bad) > 3 * math.pi


def test_an_error_of_the_energy_that_stays_bounded_may_carry_the_pendulum_over_the_top() -> None:
    errors = energy_errors("velocity_verlet", "pendulum_near_separatrix", 1000)
    assert not drifts(errors)
    assert min(errors) > 2**-19
    assert farthest("velocity_verlet", 1000) > 3 * math.pi


def test_a_pendulum_that_loses_energy_turns_too_early() -> None:
    exact = max(abs(float(q)) for q, _ in PROBLEMS["pendulum_near_separatrix"].reference.states)
    assert farthest("backward_euler", 400) < farthest("radau_iia2", 400) < exact
    assert farthest("radau_iia2", 2000) > exact - 1e-3


def springs(key: str, steps: int) -> list[float]:
    """The energy of the three stiff springs of the chain, at 64 times."""
    found = states(key, "fermi_pasta_ulam", steps, 64)
    return [sum(y[9 + i] ** 2 + 2500 * y[3 + i] ** 2 for i in range(3)) / 2 for y in found]


def test_energy_of_the_stiff_springs_is_kept_by_symplectic_methods_and_lost_by_others() -> None:
    kept, lost = springs("velocity_verlet", 8192), springs("rk4", 8192)
    assert max(kept) < 1.3 * min(kept)
    assert lost[-1] < 0.5 * lost[0]
    assert springs("backward_euler", 256)[-1] < 1e-6


# Stiff and nonlinear: to the middle of a slow branch, and over the jump.
HALF = Q(1, 2)


@pytest.mark.parametrize("mu", ["1e3", "1e4", "1e5", "1e6"])
def test_slow_branch_is_followed_by_l_stable_methods_and_by_no_explicit_one(mu: str) -> None:
    name = f"van_der_pol_{mu}"
    for key, tolerance in (("backward_euler", 0.01), ("radau_iia2", 1e-6), ("radau_iia3", 1e-10), ("sdirk2", 1e-4)):
        assert fate(key, name, 32, tolerance, HALF) == RIGHT
    for key in ("forward_euler", "rk4", "dormand_prince54"):
        assert fate(key, name, 32, 1, HALF) == ENDED


def test_explicit_methods_start_on_van_der_pols_oscillator_within_their_limit_over_three_mu_squared() -> None:
    problem, step = PROBLEMS["van_der_pol_1e3"], 2.785 / 3e6
    for h, ends in ((0.98 * step, False), (1.1 * step, True)):
        seen = observe(advance(METHODS["rk4"], problem), float_start(problem), h, 4000)
        fell = abs(seen.state[1] + 2 / 3) < 0.01  # from 0 to the slow branch, where y1 = y0 / (1 - y0^2)
        assert fell is not ends


def test_the_jump_at_the_start_stays_if_r_tends_to_one_and_dies_out_if_not() -> None:
    right = [float(x) for x in PROBLEMS["van_der_pol_1e6"].reference.states[1]]
    for key, swing in (("gauss2", 2 / 3), ("implicit_midpoint", 2 / 3), ("crouzeix3", 0)):
        y = states(key, "van_der_pol_1e6", 32, 1, HALF)[-1]
        assert abs(y[0] - right[0]) < 1e-5
        assert abs(abs(y[1] - right[1]) - swing) < 1e-3


@pytest.mark.parametrize("key", ["backward_euler", "radau_iia2", "radau_iia3", "sdirk2", "gauss2"])
def test_a_step_over_the_jump_is_refused_or_wrong(key: str) -> None:
    assert fate(key, "van_der_pol_1e6", 256, 0.1) in (ENDED, WRONG)


@pytest.mark.parametrize("key", ["radau_iia3", "sdirk4", "dormand_prince54"])
def test_steps_know_their_time_also_in_a_run_of_several_pieces(key: str) -> None:
    """The equation of Prothero and Robinson reads t, and its solution is cos t; here less stiff, for all methods."""
    problem = PROBLEMS["prothero_robinson"]
    field = replace(problem.field, parameters=(("rate", Q(-2)),))
    run, y = advance(METHODS[key], replace(problem, field=field)), float_start(problem)
    for first, last in ((0, 50), (50, 51), (51, 160)):
        y = run(y, 1 / 32, first, last)
    assert abs(y[0] - math.cos(5)) < 1e-6 < 1e-2 < abs(y[0] - math.cos(5 + 1 / 32))


def test_robertsons_reactions_are_right_at_short_first_steps_and_refused_at_long_ones() -> None:
    for key in ("radau_iia2", "radau_iia3", "sdirk2", "gauss2", "implicit_midpoint"):
        assert fate(key, "robertson", 64, 1e-4, Q(10)) == RIGHT
        assert abs(sum(states(key, "robertson", 64, 1, Q(10))[-1]) - 1) < 1e-14
        assert fate(key, "robertson", 100, 1) == ENDED
    assert fate("backward_euler", "robertson", 100, 1e-8) == RIGHT
    assert fate("rk4", "robertson", 64, 1, Q(10)) == ENDED


@pytest.mark.parametrize(("share", "runs_away"), [(-0.9, False), (-1.1, True)])
def test_robertsons_reactions_run_away_from_below_minus_a_three_thousandth(share: float, runs_away: bool) -> None:
    run = advance(METHODS["rk4"], PROBLEMS["robertson"])
    seen = observe(run, (1e-6, share / 3000, 1.0), 1e-6, 4000)
    assert (seen.failed_after is not None) is runs_away


def test_hires_is_right_up_to_the_limit_over_212_and_wrong_on_the_way_beyond() -> None:
    problem, rate = PROBLEMS["hires"], 212
    steps = float(problem.t) * rate / 2.785
    errors = [
        [
            distance_from_digits(y, x)
            for y, x in zip(states("rk4", "hires", 8 * round(n / 8))[1:], problem.reference.states, strict=True)
        ]
        for n in (1.02 * steps, 0.9 * steps)
    ]
    assert max(errors[0]) < 1e-10
    assert errors[1][0] > 0.01 > errors[1][-1]


def test_the_oregonator_is_right_between_pulses_and_a_step_over_one_is_refused() -> None:
    problem = PROBLEMS["oregonator"]
    at = dict(zip(problem.reference.times, problem.reference.states, strict=True))
    for key, tolerance in (("radau_iia3", 1e-8), ("gauss2", 1e-6), ("sdirk2", 0.01)):
        y = advance(METHODS[key], problem)(tuple(map(float, at[Q(60)])), 0.5, 0, 60)
        assert distance_from_digits(y, at[Q(90)]) < tolerance
        seen = observe(advance(METHODS[key], problem), float_start(problem), 0.5, 60)
        assert seen.failed_after in range(38, 43)
    assert fate("rk4", "oregonator", 60, 1, Q(30)) == ENDED
