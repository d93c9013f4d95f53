"""Steppers of other people: what they take and give, in place or not, in whose arrays, and what they do instead."""

import math
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from driftproof.blackbox.findings import NotANumber, NotFinite, StepRaised, UnsupportedCall, WrongShape
from driftproof.blackbox.stepper.foreign_stepper import call_text
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.checks.habits import plain
from tests.blackbox.stepper.euler_steps import (
    ALL,
    EULER,
    both,
    field,
    field_of_lists,
    field_state_first,
    field_with_the_time_back,
    force_of_numbers,
    list_in_place,
    map_of_a_state,
    map_of_numbers,
    numbers_in_place,
    state_in_place,
)
from tests.blackbox.transcripts import Asked

STATE, H = (1.0, 0.75), 0.25


@pytest.mark.parametrize("step", ALL)
def test_every_way_to_write_forward_euler_is_forward_euler(step, as_before):
    asked = Asked(step)
    subject = opened(asked.code)
    as_before(
        subject.adapter.name,
        subject.convention.kind,
        subject.convention.order,
        call_text(subject, 1.0, 0.75, 0.25),
        asked,
    )
    assert subject.step(*STATE, H) == EULER
    assert all(type(x) is float for x in subject.step(*STATE, H))
    assert subject.format is BINARY64


@pytest.mark.parametrize("step", ALL)
def test_h_of_0_and_rest_are_answered_however_the_step_is_written(step):
    subject = opened(step)
    assert subject.step(*STATE, 0.0) == STATE
    assert subject.step(0.0, 0.0, H) == (0.0, 0.0)


@pytest.mark.parametrize("step", [numbers_in_place, state_in_place, list_in_place])
def test_a_step_in_place_is_seen_by_the_log(step):
    subject = opened(step)
    subject.step(*STATE, H)
    assert subject.log.works_in_place
    assert subject.log.changes_its_arguments


def test_the_log_tells_changed_arguments_from_a_step_in_place():
    subject = opened(both, array=np.array)
    subject.step(*STATE, H)
    assert (subject.log.changes_its_arguments, subject.log.works_in_place) == (True, False)
    clean = opened(map_of_a_state)
    clean.step(*STATE, H)
    assert (clean.log.changes_its_arguments, clean.log.works_in_place) == (False, False)
    assert (clean.log.calls, clean.log.types) == (1, {"float64"})


def test_nan_in_an_argument_is_no_change_of_it():
    subject = opened(map_of_a_state)
    assert str(subject.step(float("nan"), 0.75, H)) == "(nan, nan)"
    assert not subject.log.changes_its_arguments


@pytest.mark.parametrize(
    ("answer", "kind", "seen"),
    [
        (None, WrongShape, "it returns None, not a pair (q1, v1)"),
        (1.0, WrongShape, "it returns 1.0, not a pair (q1, v1)"),
        (np.array(1.0), WrongShape, "it returns array(1.), not a pair (q1, v1)"),
        ((1.0, 2.0, 3.0), WrongShape, "it returns (1.0, 2.0, 3.0), not a pair (q1, v1)"),
        ((1.0, [2.0, 3.0]), WrongShape, "1 number went in, 2 came out"),
        (np.zeros(100), WrongShape, "..."),
        ("ab", NotANumber, "it returns str with entries of type <U1, not real numbers"),
        ((1.0, None), NotANumber, "it returns None"),
        ((1.0, 2j), NotANumber, "entries of type complex128, not real numbers"),
        ((1.0, object()), NotANumber, "entries of type object, not real numbers"),
        ((1.0, float("nan")), NotFinite, "from 1.0, 0.75, 0.25 it returns 1.0, nan"),
        ((1.0, float("-inf")), NotFinite, "from 1.0, 0.75, 0.25 it returns 1.0, -inf"),
    ],
)
def test_what_is_no_answer_is_named_in_one_line(answer, kind, seen, as_before):
    with pytest.raises(kind) as caught:
        opened(lambda q, v, h: answer)
    assert seen in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200
    if "object at" not in str(answer):
        as_before(caught.value)


def test_numbers_that_are_not_finite_come_with_the_finding():
    with pytest.raises(NotFinite) as caught:
        opened(lambda q, v, h: (q, float("inf")))
    assert caught.value.answer == (1.0, float("inf"))


# What is returned, of a time, a state and an error, and how many numbers of it are kept beside the state.
ANSWERS = [
    (lambda t, y1, error: (y1, error), 2),
    (lambda t, y1, error: (y1, y1 + error), 2),
    (lambda t, y1, error: (t, y1, error), 2),
    (lambda t, y1, error: (y1, error, "accepted"), 2),
    (lambda t, y1, error: (y1, max(error)), 1),
    (lambda t, y1, error: (t, y1), 0),
    (lambda t, y1, error: (y1, "accepted"), 0),
    (lambda t, y1, error: y1, 0),
]


@pytest.mark.parametrize("case", range(len(ANSWERS)))
def test_what_is_returned_beside_the_state_is_kept_and_not_taken_for_the_state(case):
    answer, numbers = ANSWERS[case]
    subject = opened(lambda f, t, y, h: answer(t + h, y + h * f(t, y), np.array([-0.5, 0.25])))
    assert subject.step(1.0, 0.75, H) == (1.1875, 0.5)
    assert len(subject.log.beside or []) == numbers


def test_of_one_number_too_the_time_is_told_from_the_state():
    def with_time(f, t, y, h):
        return t + h, math.fsum([y, h * f(t, y)])

    assert opened(with_time).step_field(lambda t, y: [-y[0]], 2.0, [1.0], H) == [0.75]
    subject = replace(opened(with_time), function=lambda f, t, y, h: (y + h * f(t, y), 0.0))
    assert subject.step_field(lambda t, y: [-y[0]], 2.0, [1.0], H) == [0.75]
    assert subject.log.beside == [0.0]
    near = replace(opened(with_time), function=lambda f, t, y, h: (1.02 * (t + h), 0.5))  # a state, beside its error
    assert near.step_field(lambda t, y: [-y[0]], 2.0, [1.0], H) == [1.02 * (2 + H)]


def test_exceptions_of_the_stepper_come_in_one_line():
    def fails(q, v, h):
        raise RuntimeError("two\nlines")

    with pytest.raises(StepRaised, match=r"^step\(q=1.0, v=0.75, h=0.25\) raises RuntimeError: two lines$"):
        opened(fails)


def test_a_right_hand_side_of_one_number_may_be_all_it_takes():
    subject = opened(lambda f, t, y, h: math.fsum([y, h * f(t, y)]))
    assert subject.step_field(lambda t, y: [-y[0]], 0.0, [1.0], H) == [0.75]
    with pytest.raises(WrongShape, match="a scalar holds one number, not 2"):
        subject.step(*STATE, H)


def test_the_right_hand_side_is_told_the_time():
    for step in (field, field_state_first, field_with_the_time_back, field_of_lists):
        asked = []
        opened(step).step_field(lambda t, y, asked=asked: (asked.append(t), [0.0, 0.0])[1], 8.0, STATE, H)
        assert asked == [8.0]


def test_a_call_that_is_not_offered_is_refused():
    with pytest.raises(UnsupportedCall, match="'map', which takes no right-hand side"):
        opened(map_of_numbers).step_field(lambda t, y: y, 0.0, STATE, H)
    with pytest.raises(UnsupportedCall):
        opened(map_of_numbers).step_with(lambda q: -q, *STATE, H)


def test_a_field_answers_a_force_and_both_another_than_the_oscillator():
    for step in (force_of_numbers, field):
        assert opened(step).step_with(lambda q: -4 * q, *STATE, H) == (1.1875, -0.25)


def test_each_call_is_told_before_it_is_made():
    told = []
    opened(map_of_numbers, before=told.append).step(2.0, 0.0, 0.5)
    opened(field, before=told.append)
    opened(map_of_a_state, before=told.append)
    assert told == [
        *("q=1.0, v=0.75, h=0.25", "q=2.0, v=0.0, h=0.5"),
        *("t=0.0, y=[1.0, 0.75], h=0.25", "state=[1.0, 0.75], h=0.25"),
    ]


def of_lists(f, y, t, h):
    return [y.index(y[0]), *f(y, t)[1:]]


WRITTEN = {
    "step(1.0, 0.75, 0.25)": plain,
    "step(numpy.array([1.0, 0.75]), 0.25)": lambda state, dt: state,
    "step([1.0, 0.75], 0.25)": lambda y, h: [y.index(y[0]), y[1]],
    "step(0.0, 1.0, 0.75, 0.25)": lambda t, x, v, dt: (x, v),
    "step(q=1.0, v=0.75, h=0.25, k=1.0)": lambda q, v, h, k: (q, k * v),
    "step(lambda q: -q, 1.0, 0.75, 0.25)": lambda force, q, v, h: (q, force(v)),
    "step(lambda t, y: numpy.array([y[1], -y[0]]), numpy.array([1.0, 0.75]), 0.25)": lambda f, y, h: f(0.0, y),
    "step(lambda y, t: [y[1], -y[0]], [1.0, 0.75], 0.0, 0.25)": of_lists,
}


@pytest.mark.parametrize("call", WRITTEN)
def test_a_call_is_written_as_it_is_made(call):
    assert call_text(opened(WRITTEN[call]), 1.0, 0.75, 0.25) == call


def test_a_call_is_written_with_the_maker_of_its_numbers():
    subject = opened(plain, array=np.float32)
    assert call_text(subject, 1.0, 0.75, 0.25) == "step(numpy.float32([1.0]), numpy.float32([0.75]), 0.25)"
    of_scalars = opened(lambda q, v, h: (q, v - h * math.sin(q)), array=np.float32)
    assert call_text(of_scalars, 1.0, 0.75, 0.25) == "step(numpy.float32(1.0), numpy.float32(0.75), 0.25)"


def test_nan_and_infinity_are_written_as_python_reads_them():
    subject = opened(plain)
    assert call_text(subject, math.nan, -inf, 0.1) == 'step(float("nan"), float("-inf"), 0.1)'


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
    found = subject.step_forced(spring, 8.0, [1.0, 2.0], [0.75, 0.5], H, interleaved=interleaved)
    assert (found, asked[-1]) == ([1.1875, 2.125, -2.25, -3.5], start)


def test_several_states_are_stepped_at_once_where_position_and_velocity_are_apart():
    def step(force, q, v, t, h):
        return q + h * v + t, v + h * force(q)

    ends = [(1.1875, 0.5), (2.125, 0.0)]
    assert opened(step).step_batch([1.0, 2.0], [0.75, 0.5], H) == ends
    with pytest.raises(UnsupportedCall, match="one array, which is one state"):
        opened(field).step_batch([1.0, 2.0], [0.75, 0.5], H)


def test_each_call_is_said_to_be_over_also_where_it_raises():
    told = []

    def step(q, v, h):
        if q > 1:
            raise RuntimeError("large")
        return map_of_numbers(q, v, h)

    subject = opened(step, before=lambda call: told.append(1), after=lambda: told.append(-1))
    with pytest.raises(StepRaised):
        subject.step(2.0, 0.0, H)
    assert told == [1, -1, 1, -1]


def test_a_copy_remembers_nothing_and_what_cannot_be_copied_is_refused():
    class Accelerating:
        pushed = 0.0

        def __call__(self, q, v, h):
            self.pushed += h
            return q + h * v, v - self.pushed * q

    subject = opened(Accelerating())
    first = subject.fresh().step(*STATE, H)
    assert first == subject.fresh().step(*STATE, H) == EULER != subject.step(*STATE, H)
    with pytest.raises(UnsupportedCall, match="no copy"):
        replace(subject, pristine=None).fresh()


def test_a_line_that_calls_a_force_of_more_names_each_argument_once():
    def step(force, q, v, h):
        return q + h * v, v + h * force(q, 2.0, None)

    assert call_text(opened(step), 1.0, 0.5, 0.25) == "step(lambda q, _1, _2: -q, 1.0, 0.5, 0.25)"
