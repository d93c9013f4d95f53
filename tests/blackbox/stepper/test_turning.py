"""Steps that turn a vector are called as they want it: fields as vectors and as functions, charges and masses."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.findings import NotFinite, UnsupportedCall
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.turning import Push, step_in_fields, turn_quaternion
from tests.blackbox.families import turning_steppers as codes

PUSH = Push((1.0, 2.0, 3.0), (0.0, 1.0, -1.0), (0.5, 0.0, 1.0), (0.0, 2.0, 1.0), 0.5)


def timed(t, x, v, E, B, dt):
    return codes.boris()(x, v, E + t, B, dt)


def timed_turn(t, q, omega, dt):
    return codes.quaternion("rk4")(q, omega + t, dt)


@pytest.mark.parametrize("step", [timed, codes.by_ratio, codes.in_place, codes.in_rows])
def test_every_style_moves_as_the_plain_one(step):
    said, seen = step_in_fields(opened(codes.boris()), PUSH), step_in_fields(opened(step), PUSH)
    assert (seen.x, seen.v) == (pytest.approx(said.x, abs=1e-14), pytest.approx(said.v, abs=1e-14))


def test_a_call_is_told_with_all_that_is_given():
    pushed, turned = [], []
    step_in_fields(opened(codes.boris(), before=pushed.append), PUSH)
    turn_quaternion(opened(timed_turn, before=turned.append), [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.5)
    assert pushed[-1] == "x=[1.0, 2.0, 3.0], v=[0.0, 1.0, -1.0], E=[0.5, 0.0, 1.0], B=[0.0, 2.0, 1.0], h=0.5"
    assert turned[-1] == "q=[1.0, 0.0, 0.0, 0.0], omega=[0.0, 0.0, 1.0], h=0.5"


def test_an_end_that_is_not_finite_is_no_end():
    pushed = lambda subject: step_in_fields(subject, PUSH)
    turned = lambda subject: turn_quaternion(subject, [1.0] * 4, [1.0] * 3, 1.0)
    for right, lost, step in (
        (codes.boris(), lambda x, v, E, B, dt: (x, v * np.nan), pushed),
        (lambda v, B, dt: v + dt * np.cross(v, B), lambda v, B, dt: v * np.nan, pushed),
        (codes.quaternion("rk4"), lambda q, omega, dt: q * np.nan, turned),
    ):
        subject = opened(right)
        subject.function = lost
        with pytest.raises(NotFinite):
            step(subject)


def test_a_charge_and_a_mass_are_made_good_by_the_fields():
    said, seen = (step_in_fields(opened(step), PUSH).v for step in (codes.boris(), codes.kinetic))
    assert seen == pytest.approx(said, abs=1e-14)


def test_fields_are_functions_of_a_place_or_of_its_numbers():
    assert step_in_fields(opened(codes.drifting), PUSH).places == [pytest.approx((1.0, 2.25, 2.75))] * 2

    def by_numbers(x, v, E, B, dt):
        return codes.boris()(x, v, E(0.0) * 0 + E(*x), B(*x, 0.0), dt)  # no place is a time alone

    found = step_in_fields(opened(by_numbers), PUSH)
    assert found.places == [[1.0, 2.0, 3.0]] * 2
    assert found.v == step_in_fields(opened(codes.boris()), PUSH).v


def test_other_steppers_are_refused():
    with pytest.raises(UnsupportedCall, match="no magnetic field"):
        step_in_fields(opened(codes.quaternion("rk4")), PUSH)
    with pytest.raises(UnsupportedCall, match="no quaternion"):
        turn_quaternion(opened(codes.boris()), [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.5)
    turned = turn_quaternion(opened(codes.turned_by(lambda x: x)), [1, 0, 0, 0], [0, 0, np.pi], 1.0)
    assert turned == pytest.approx([0, 0, 0, 1])
