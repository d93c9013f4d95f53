"""How well stages are solved is seen beside our own solution: to rounding, to a tolerance, or not at all."""

from dataclasses import replace
from functools import partial

import pytest

from driftproof.blackbox.probes.implicit_tableau import read_implicit_tableau
from driftproof.blackbox.probes.marked_stages import MarkedSteps
from driftproof.blackbox.probes.scripted_answers import BACKWARD, CONTROLS, NotReadable
from driftproof.blackbox.probes.stage_solutions import StageEquations, _power
from driftproof.blackbox.probes.tableau import NO_POWER
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.implicit_steppers import all_at_once, fixed_point, newton, one_by_one, simplified, table
from tests.looping import some


def equations(step):
    subject = opened(step)
    return StageEquations(MarkedSteps(subject), read_implicit_tableau(subject))


def test_a_solver_that_goes_on_solves_to_rounding():
    seen = equations(all_at_once(table("radau_iia3"))).solved()
    assert max(seen.linear, seen.curved) < 1e-14
    assert not seen.power
    assert seen.words.startswith("its stages are solved to ")


@pytest.mark.parametrize("tolerance", [1e-5, 1e-8, 1e-11])
@pytest.mark.parametrize(("solver", "contraction"), [(simplified, 1e-3), (fixed_point, 1e-1)])
def test_a_tolerance_on_a_change_is_seen_times_the_contraction_of_the_iteration(solver, contraction, tolerance):
    seen = equations(one_by_one(table("sdirk2"), partial(solver, tolerance=tolerance))).solved()
    assert tolerance * contraction / 10 < seen.curved < tolerance
    assert not seen.power


# The power is 2^k - 1 after k iterations with a new Jacobian each, k with the first kept.
ITERATIONS = {
    "Newton 1": (partial(newton, most=1, tolerance=0), 1),
    "Newton 2": (partial(newton, most=2, tolerance=0), 3),
    "kept 2": (partial(simplified, most=2, tolerance=0), 2),
    "kept 4": (partial(simplified, most=4, tolerance=0), 4),
}


def test_iterations_that_are_fixed_are_told_where_too_little_is_left_for_a_power():
    seen = equations(one_by_one(table("backward_euler"), partial(newton, most=3, tolerance=0))).solved()
    assert seen.power == NO_POWER
    assert seen.words.endswith("and the number of calls does not depend on the nonlinearity")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("solver", "power"), ITERATIONS.values(), ids=ITERATIONS)
def test_a_number_of_iterations_that_is_fixed_shows_in_a_power(solver, power):
    seen = equations(all_at_once(table("trapezoid"), solver)).solved()
    assert seen.power == power
    assert seen.curved > 1e-7
    assert f"power {power} of the nonlinearity" in seen.words


def test_a_power_is_that_of_both_last_halvings_of_the_strength():
    assert [_power([1.0, 1 / 2, 1 / 16, last]) for last in (1 / 128, 1 / 64)] == [3, NO_POWER]


def test_so_many_iterations_that_nothing_is_left_are_no_finding():
    assert not equations(all_at_once(table("trapezoid"), partial(newton, most=8, tolerance=0))).solved().power


def test_other_coefficients_than_those_read_are_noticed_by_every_control():
    right = equations(one_by_one(table("crouzeix3")))
    (first, *rest) = right.reading.a
    wrong = replace(right, reading=replace(right.reading, a=((first[0] + 0.1, *first[1:]), *rest)))
    for control in some([*CONTROLS, BACKWARD]):
        assert right.require_solved(control) < 1e-13
        with pytest.raises(NotReadable, match=f"with {control.name}, the step is off by "):
            wrong.require_solved(control)
