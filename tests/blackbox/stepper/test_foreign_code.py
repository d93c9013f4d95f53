"""What somebody's code gives back: in place or not, beside what else, and what it does instead of answering."""

import math
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.blackbox.findings import (
    Misbehaviour,
    NotANumber,
    NotFinite,
    NothingReturned,
    StaleSlope,
    StepRaised,
    WrongShape,
)
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from tests.blackbox.stepper import euler_steps
from tests.looping import exactly

STATE, H = (1.0, 0.75), 0.25


def test_the_log_tells_changed_arguments_from_a_step_in_place():
    clean = opened(euler_steps.map_of_a_state)
    for subject, seen in (
        (opened(euler_steps.list_in_place), (True, True)),
        (opened(euler_steps.both, array=np.array), (True, False)),
        (clean, (False, False)),
    ):
        subject.step(*STATE, H)
        assert (subject.log.changes_its_arguments, subject.log.works_in_place) == seen
    assert (clean.log.calls, clean.log.types) == (1, {"float64"})


def test_a_jacobian_by_complex_steps_is_answered_and_other_complex_states_are_not():
    seen = []

    def step(f, t, y, h, by=1e-30j):
        seen.append(np.imag([f(t, y + by * e) for e in np.eye(len(y))]).T / abs(by))
        return y + h * np.real(f(t, y))

    subject = opened(step, "field")
    subject.step_field(lambda t, y: [y[0] * y[1], t - 3 * y[0]], 2.0, [4.0, 5.0], H)
    assert np.abs(seen[-1] - [[5.0, 4.0], [-3.0, 0.0]]).max() < 1e-5
    with pytest.raises(NotANumber, match="at ndarray with entries of type complex128"):
        opened(lambda f, t, y, h: step(f, t, y, h, by=1e-3j), "field")


def test_nan_in_an_argument_is_no_change_of_it():
    subject = opened(euler_steps.map_of_a_state)
    assert str(subject.step(float("nan"), 0.75, H)) == "(nan, nan)"
    assert not subject.log.changes_its_arguments


@pytest.mark.parametrize(("answer", "kind", "seen"), [
    (None, NothingReturned, "it returns None, not a pair (q1, v1)"),
    (1.0, WrongShape, "it returns 1.0, not a pair (q1, v1)"),
    ((1.0, 2.0, 3.0), WrongShape, "it returns (1.0, 2.0, 3.0), not a pair (q1, v1)"),
    ((1.0, [2.0, 3.0]), WrongShape, "it returns (1.0, [2.0, 3.0]), not a pair (q1, v1)"),
    (np.zeros(100), WrongShape, "..."),
    ([1.0] * 12, WrongShape, "1.0], not a pair"),  # of 60 letters, all of which are shown
    ("ab", NotANumber, "it returns str with entries of type <U1, not real numbers"),
    ((1.0, None), NotANumber, "it returns None"),
    ((1.0, 2j), NotANumber, "entries of type complex128, not real numbers"),
    ((1.0, object()), NotANumber, "entries of type object, not real numbers"),
    ((1.0, float("nan")), NotFinite, "from 1.0, 0.75, 0.25 it returns 1.0, nan"),
])  # fmt: skip
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
    (lambda t, y1, error: (y1, np.zeros(3)), 0),
    (lambda t, y1, error: (y1, "accepted"), 0),
    (lambda t, y1, error: [t, y1], 0),
    (lambda t, y1, error: (t, 0.25, y1), 0),
    (lambda t, y1, error: ("accepted", t, y1, error), 2),
    (lambda t, y1, error: {"t_new": t, "y": y1 - error, "y_new": y1, "err": error}, 2),
    (lambda t, y1, error: SimpleNamespace(y=y1, t=t), 0),
    (lambda t, y1, error: iter([(t, y1)]), 0),
    (lambda t, y1, error: y1, 0),
]


@pytest.mark.parametrize("case", range(len(ANSWERS)))
def test_what_is_returned_beside_the_state_is_kept_and_not_taken_for_the_state(case):
    answer, numbers = ANSWERS[case]
    subject = opened(lambda f, t, y, h: answer(t + h, y + h * f(t, y), np.array([-0.5, 0.25])))
    assert subject.step(1.0, 0.75, H) == (1.1875, 0.5)
    assert len(subject.log.beside or []) == numbers


# What is returned, of the time, the position, the velocity and the force at the end.
PAIRS = [
    lambda t, q, v, a: (q, v, a),
    lambda t, q, v, a: (q, v, t),
    lambda t, q, v, a: (t, q, v, a),
    lambda t, q, v, a: [a, v, q],
    lambda t, q, v, a: (q, v, (q * q + v * v) / 2, "accepted", None, True),
    lambda t, q, v, a: ((q, v), a),
    lambda t, q, v, a: (t, (q, v)),
    lambda t, q, v, a: np.array([q, v, a]),
    lambda t, q, v, a: {"t": t, "v": v, "x_new": q, "x": q - t * v},
    lambda t, q, v, a: SimpleNamespace(energy=q, x1=q, v1=v),
    lambda t, q, v, a: iter([(q, v, a)]),
]


@pytest.mark.parametrize("case", range(len(PAIRS)))
def test_position_and_velocity_are_found_among_whatever_a_step_returns(case):
    for step in exactly(3, (
        lambda force, q, v, h: PAIRS[case](h, q + h * v, v + h * force(q), force(q)),
        lambda q, v, h: PAIRS[case](h, q + h * v, v - h * q, -q),
        lambda t, q, v, h: PAIRS[case](t + h, q + h * v, v - h * q, -q),
    )):  # fmt: skip
        assert opened(step).step(1.0, 0.75, H) == (1.1875, 0.5)


@pytest.mark.parametrize("answer", [
    lambda t, q, v, a: (q, v, a, t),
    lambda t, q, v, a: (t, q, v, a, "accepted"),
    lambda t, q, v, a: ((q, v), a, t),
    lambda t, q, v, a: (a, q, v),
], ids=range(4))  # fmt: skip
def test_the_slope_that_is_handed_on_is_found_too_unless_it_is_not_that_at_the_end(answer):
    def step(force, q, v, acc, h, stale=0.0):
        q = q + h * v
        return answer(h, q, v + h * acc, force(q - stale))

    assert opened(step).step(1.0, 0.75, H) == (1.1875, 0.5)
    with pytest.raises((StaleSlope, NotANumber)):
        opened(partial(step, stale=0.5))


def test_a_time_is_no_slope_that_is_handed_on():
    assert opened(lambda force, q, v, acc, h: (q + h * v, v + h * acc, h)).step(1.0, 0.75, H) == (1.1875, 0.5)


def test_a_step_in_place_may_return_something_else():
    def step(f, t, y, h):
        y += h * np.array(f(t, y))
        return t + h

    assert opened(step).step(1.0, 0.75, H) == (1.1875, 0.5)


def test_of_one_number_too_the_time_is_told_from_the_state():
    def with_time(f, t, y, h):
        return t + h, math.fsum([y, h * f(t, y)])

    known = opened(with_time)
    assert known.step_field(lambda t, y: [-y[0]], 2.0, [1.0], H) == [0.75]
    unknown = replace(known, convention=replace(known.convention, timed=None))
    subject = replace(unknown, function=lambda f, t, y, h: (y + h * f(t, y), 0.0))
    assert subject.step_field(lambda t, y: [-y[0]], 2.0, [1.0], H) == [0.75]
    assert subject.log.beside == [0.0]
    for off, y1 in exactly(2, ((1.02, [1.02 * (2 + H)]), (1.01, [0.5]))):  # a state, beside its error; or a time
        near = replace(unknown, function=lambda f, t, y, h, off=off: (off * (t + h), 0.5))
        assert near.step_field(lambda t, y: [-y[0]], 2.0, [1.0], H) == y1


def test_each_call_is_told_before_it_is_made():
    told = []
    opened(euler_steps.map_of_numbers, before=told.append).step(2.0, 0.0, 0.5)
    opened(euler_steps.field, before=told.append)
    opened(euler_steps.map_of_a_state, before=told.append)
    assert told == [
        *("q=1.0, v=0.75, h=0.25", "q=2.0, v=0.0, h=0.5"),
        *("t=0.0, y=[1.0, 0.75], h=0.25", "state=[1.0, 0.75], h=0.25"),
    ]


def test_each_call_is_said_to_be_over_also_where_it_raises():
    told = []

    def step(q, v, h):
        if q > 1:
            raise RuntimeError("large")
        return euler_steps.map_of_numbers(q, v, h)

    subject = opened(step, before=lambda call: told.append(1), after=lambda: told.append(-1))
    with pytest.raises(StepRaised):
        subject.step(2.0, 0.0, H)
    assert told == [1, -1, 1, -1]


@pytest.mark.parametrize("run", [
    lambda q, v, h, n: ([0.0, h], [q, q + h * v], [v, v - h * q]),
    lambda q, v, h, n: [(q, v), (q + h * v, v - h * q)],
    lambda q, v, h, n: [(q * (1 + 2.0**-11), v), (q + h * v, v - h * q)],
    lambda q, v, h, n: ([q, q + h * v], [v, v - h * q]),
    lambda q, v, h, n: (q + h * v, v - h * q),
    lambda f, y0, h, n: ([0.0, h], [[*y0], [*(y0 + h * f(0.0, y0))]]),
    lambda f, y0, ts: [[a, b] for a, b in zip(y0, y0 + ts[1] * f(0.0, y0), strict=True)],
], ids=range(7))  # fmt: skip
def test_the_end_of_a_run_is_found_in_rows_and_columns_with_and_without_times(run):
    subject = opened(run)
    assert (subject.shortest, subject.step(1.0, 0.75, 0.25)) == (1, (1.1875, 0.5))


def test_a_run_of_no_fewer_than_eight_steps_is_opened_with_eight():
    def run(q, v, h, n):
        if n < 8:
            raise ValueError("too few")
        states = [(q, v)]
        for _ in range(n):
            states.append(euler_steps.map_of_numbers(*states[-1], h))
        return states

    def solved(func, y, t, h, n):
        states = [y] if n >= 8 else []
        for i in range(n):
            states.append(states[-1] + h * func(states[-1], t + i * h))
        return states

    subject = opened(run)
    assert (subject.shortest, subject.convention.steps) == (8, 1)
    subject = opened(solved)
    assert (subject.shortest, subject.convention.steps, subject.convention.asks) == (8, 1, ("state", "time"))


def test_a_run_that_is_not_of_one_step_is_refused_in_words():
    with pytest.raises(Misbehaviour, match="not two states"):
        opened(lambda q, v, h, n: [(q, v)] * 3)
    with pytest.raises(Misbehaviour, match="whose rows are all equal, as of one array appended again and again"):
        opened(lambda f, y0, ts: [y0 + 0.25 * f(ts[0], y0)] * len(ts))
    with pytest.raises(Misbehaviour, match=r"shape \(2, 2\), not from the start on"):
        opened(lambda f, y0, ts: [y0 + 0.25 * n * f(ts[0], y0) for n in (1, 2)])
    with pytest.raises(Misbehaviour, match="ends before it yields a state"):
        opened(lambda q, v, h: iter(()))


def test_a_right_hand_side_that_gets_too_few_numbers_and_no_time_is_asked_in_a_wrong_shape():
    subject = opened(lambda f, y, t, h: y + h * f(y, t))
    subject.function = lambda f, y, t, h: y + h * f(y[:1])
    with pytest.raises(WrongShape):
        subject.step_field(lambda t, y: y, 0.0, [1.0, 2.0], 0.5)


def test_one_call_with_its_arguments_exchanged_is_named_and_is_no_step_of_one_number():
    def midpoint(f, y, t, h):
        return y + h * f(t + h / 2, y + h / 2 * f(y, t))

    found = verify(midpoint, "midpoint2", examples=20, isolate=False)
    assert found.passed is False
    assert found.verdict.endswith("of the calls in a step one is f(t, y), others are f(y, t)")
