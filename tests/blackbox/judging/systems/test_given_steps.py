"""One step beside the method's: how far rounding may take it, and how forces that depend on velocities are asked."""

import pytest

from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.judging.systems.given_steps import BEFORE, GivenSteps
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS

STATES = [(1.0, 0.5), (0.5, -0.75)]


def kicked(q, v, h, constant=1.0, drag=0.0):
    v = v - h * (constant * q**3 + drag * v)
    return q + h * v, v


def given(step, drag=0.0):
    return GivenSteps(opened(step), STATES, 1.0, lambda t, y: [y[1], -(y[0] ** 3) - drag * y[1]])


@pytest.mark.parametrize(("constant", "right"), [(1.0, True), (1 + 2.0**-52, True), (1 + 2.0**-40, False)])
def test_a_step_is_wrong_if_it_is_off_by_more_than_rounding_explains(constant, right):
    steps = given(lambda q, v, h: kicked(q, v, h, constant))
    one = steps.beside(Specification(METHODS["symplectic_euler"]), 0.0, STATES[0], 0.25)
    assert (one.fails == "") is right
    assert one.end == pytest.approx(one.told, rel=2.0**-38)
    assert (one.limit, one.period) == ("", 0.0)


@pytest.mark.parametrize("drag", [0.0, 0.125])
def test_forces_that_depend_on_a_velocity_are_asked_as_the_code_asks_them(drag):
    method, steps = METHODS["symplectic_euler"], given(lambda q, v, h: kicked(q, v, h, drag=drag), drag)
    assert steps.pushed is (drag > 0)
    assert not drag or steps.way(method) == BEFORE
    assert steps.step(method, 0.0, STATES[0], 0.25) == pytest.approx(kicked(*STATES[0], 0.25, drag=drag), rel=2.0**-48)


def test_a_clock_that_is_ahead_is_that_of_the_system():
    steps = GivenSteps(opened(kicked), STATES, 1.0, lambda t, y: [y[1], t - y[0]])
    assert steps.driven
    assert not given(kicked).driven
    assert steps.later(0.5).rates(1.0, (2.0, 0.0)) == [0.0, -0.5]
