"""Problems of mechanics: energies drift or stay, orbits are thrown out, a pendulum goes over the top."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from driftproof.numeric.problems.catalogue import PROBLEMS
from tests.numeric.problems.runs_on_problems import drifts, energy_errors, states

# Conservative problems: steps for which the motion is resolved, so that eight energy errors tell a drift.
CHAIN = [("kepler", 400), ("pendulum", 40), ("henon_heiles", 200)]


@pytest.mark.parametrize(("name", "steps"), CHAIN)
def test_energy_drifts_with_explicit_methods_and_stays_bounded_with_symplectic_ones(name: str, steps: int) -> None:
    for key in ("velocity_verlet", "implicit_midpoint", "gauss2"):
        assert not drifts(energy_errors(key, name, steps)), key
    assert drifts(energy_errors("rk4", name, steps))


@pytest.mark.slow(keep=1)
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
