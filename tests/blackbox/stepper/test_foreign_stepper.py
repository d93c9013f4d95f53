"""Steppers of other people: what they take and give, in place or not, in whose arrays, and what they do instead."""

import math
from dataclasses import replace

import pytest

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.stepper import euler_steps
from tests.blackbox.transcripts import Asked

STATE, H = (1.0, 0.75), 0.25


@pytest.mark.parametrize("step", euler_steps.ALL.values(), ids=euler_steps.ALL)
def test_every_way_to_write_forward_euler_is_forward_euler(step, as_before):
    asked = Asked(step)
    subject = opened(asked.code)
    shown = call_text(subject, 1.0, 0.75, 0.25)
    as_before(subject.adapter.name, subject.convention.kind, subject.convention.order, shown, asked)
    assert subject.step(*STATE, H) == euler_steps.EULER
    assert all(type(x) is float for x in subject.step(*STATE, H))
    assert subject.format is BINARY64
    assert subject.step(*STATE, 0.0) == STATE
    assert subject.step(0.0, 0.0, H) == (0.0, 0.0)


def test_a_right_hand_side_of_one_number_may_be_all_it_takes():
    subject = opened(lambda f, t, y, h: math.fsum([y, h * f(t, y)]))
    assert subject.step_field(lambda t, y: [-y[0]], 0.0, [1.0], H) == [0.75]
    for other in (lambda y, *, f, t, h: math.fsum([y, h * f(t, y)]), lambda y, *, f, t, h: y + h * f(t, y)):
        assert opened(other).step_field(lambda t, y: [t - y[0]], 2.0, [1.0], H) == [1.25]  # called f(t, y) all the same
    with pytest.raises(UnsupportedCall, match="it takes one number, but"):
        subject.step(*STATE, H)


def test_the_right_hand_side_is_told_the_time():
    many = opened(lambda force, q, v, h: (q + h * v, v + h * force(q, *range(9))))  # of so many, the position is first
    assert (many.step(*STATE, H), many.log.asks) == (euler_steps.EULER, ("position",))
    for step in (
        euler_steps.field,
        euler_steps.field_state_first,
        euler_steps.field_with_the_time_back,
        euler_steps.field_of_lists,
    ):
        asked = []
        opened(step).step_field(lambda t, y, asked=asked: (asked.append(t), [0.0, 0.0])[1], 8.0, STATE, H)
        assert asked == [8.0]


def test_a_call_that_is_not_offered_is_refused():
    with pytest.raises(UnsupportedCall, match="'map', which takes no right-hand side"):
        opened(euler_steps.map_of_numbers).step_field(lambda t, y: y, 0.0, STATE, H)
    with pytest.raises(UnsupportedCall):
        opened(euler_steps.map_of_numbers).step_with(lambda q: -q, *STATE, H)
    with pytest.raises(UnsupportedCall, match="no velocity"):
        opened(euler_steps.force_of_numbers).step_dragged(lambda t, q, v: [0.0], 0.0, [1.0], [0.75], H)


def test_a_field_answers_a_force_and_both_another_than_the_oscillator():
    for step in (euler_steps.force_of_numbers, euler_steps.field):
        assert opened(step).step_with(lambda q: -4 * q, *STATE, H) == (1.1875, -0.25)


def forward_euler(asked):
    def step(f, t, y, h):
        asked.append([float(x) for x in y])
        return y + h * f(t, y)

    return step


@pytest.mark.parametrize(("interleaved", "start"), [(False, [1.0, 2.0, 0.75, 0.5]), (True, [1.0, 0.75, 2.0, 0.5])])
def test_positions_and_velocities_come_back_apart_in_whichever_order_the_code_has_them(interleaved, start):
    asked = []
    subject = opened(forward_euler(asked), "field")
    spring = lambda t, q: [-4 * q[0] - t, -8 * q[1]]
    found = subject.step_forced(spring, 8.0, [1.0, 2.0], [0.75, 0.5], H, **{"interleaved": True} if interleaved else {})
    assert (found, asked[-1]) == ([1.1875, 2.125, -2.25, -3.5], start)


def test_several_states_are_stepped_at_once_where_position_and_velocity_are_apart():
    def step(force, q, v, t, h):
        return q + h * v + t, v + h * force(q)

    ends = [(1.1875, 0.5), (2.125, 0.0)]
    assert opened(step).step_batch([1.0, 2.0], [0.75, 0.5], H) == ends
    assert opened(euler_steps.field).step_batch([1.0, 2.0], [0.75, 0.5], H) == ends
    with pytest.raises(UnsupportedCall, match="one array, which is one state"):
        opened(lambda state, h: [state[0] + h * state[1], state[1]]).step_batch([1.0, 2.0], [0.75, 0.5], H)


def by_mass(force, q, v, f0, mass, h):
    q1 = q + h * v + h**2 / 2 * f0 / mass
    return q1, v + h / 2 * (f0 + (f1 := force(q1))) / mass, f1


def by_gradient(grad, q, v, f0, h):
    return by_mass(lambda q: -grad(q), q, v, -f0, 1.0, h)[:2]


@pytest.mark.parametrize("step", [by_mass, by_gradient])
def test_several_states_are_handed_the_slopes_that_each_is_handed_alone(step):
    subject = opened(step)
    states = [(1.0, 0.75), (2.0, 0.5)]
    assert subject.step_batch([1.0, 2.0], [0.75, 0.5], H) == [subject.step(q, v, H) for q, v in states]


def test_a_copy_remembers_nothing_and_what_cannot_be_copied_is_refused():
    class Accelerating:
        pushed = 0.0

        def __call__(self, q, v, h):
            self.pushed += h
            return q + h * v, v - self.pushed * q

    subject = opened(Accelerating())
    first = subject.fresh().step(*STATE, H)
    assert first == subject.fresh().step(*STATE, H) == euler_steps.EULER != subject.step(*STATE, H)
    with pytest.raises(UnsupportedCall, match="no copy"):
        replace(subject, pristine=None).fresh()
