"""Stiff problems: every method does what is expected of its class; orders are seen to be reduced."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.advance import advance, float_start
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.reference_errors import distance_from_digits
from driftproof.numeric.stability import observe
from tests.numeric.problems.runs_on_problems import ENDED, EXPLICIT, IMPLICIT, RIGHT, TABLEAUX, WRONG, fate, states
from tests.witnesses.stiff_error import stiff_error


def holds_for_any_stiffness(key: str) -> bool:
    """Stable, and with errors that do not grow with h |lambda|: those of Lobatto IIIB do."""
    try:
        return stiff_error(TABLEAUX[key]).decay >= 0
    except ValueError:
        return False


# 64 steps on kaps: h/epsilon = 15625, beyond every explicit method's limit, and small beside what the solution does.


@pytest.mark.parametrize("key", EXPLICIT)
def test_explicit_methods_overflow_or_are_refused_on_a_stiff_problem(key: str) -> None:
    assert fate(key, "kaps", 64, 0.01) == ENDED


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize("key", [key for key in IMPLICIT if holds_for_any_stiffness(key)])
def test_implicit_methods_are_right_on_a_stiff_problem(key: str) -> None:
    assert fate(key, "kaps", 64, 0.01) == RIGHT


def test_problems_whose_solution_does_not_tell_their_stiffness_have_that_of_their_titles() -> None:
    for name, given in (("kaps", ("stiffness", 10**6)), ("prothero_robinson", ("rate", -(10**6)))):
        assert PROBLEMS[name].field.parameters == (given,)
        assert f" = {'-' * (given[1] < 0)}10⁶, to t" in PROBLEMS[name].title


def test_lobatto_iiib_errs_the_more_the_stiffer_and_is_wrong_there() -> None:
    assert stiff_error(TABLEAUX["lobatto_iiib3"]).decay == -1
    assert fate("lobatto_iiib3", "kaps", 64, 0.01) == WRONG


def order_seen(key: str, coarse: int, fine: int) -> float:
    problem = PROBLEMS["prothero_robinson"]
    right = float(problem.reference.states[-1][0])
    errors = [abs(states(key, problem.key, steps, 1)[1][0] - right) for steps in (coarse, fine)]
    return float(np.log(errors[0] / errors[1]) / np.log(fine / coarse))


@pytest.mark.parametrize("key", ["implicit_midpoint", "gauss2", "gauss3", "radau_ia3", "radau_iia2", "radau_iia3"])
def test_order_seen_on_prothero_and_robinsons_equation_is_the_reduced_one(key: str) -> None:
    reduced, full = stiff_error(TABLEAUX[key]).order, TABLEAUX[key].claimed_order
    seen = order_seen(key, 20, 40)
    assert abs(seen - reduced) < 0.4
    assert full == reduced or seen < full - 0.5


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
