"""Boris' step and its kin: the rotation by its angle, both half kicks, the drift, and every mistake by its name."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import identify, verify
from driftproof.blackbox.families.magnetic import read_magnetic
from driftproof.blackbox.judging.tolerance import Allowance
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import turning_steppers as codes

SOLVED = Allowance(solver_tolerance=1e-10)


@pytest.mark.parametrize(("step", "verdict"), codes.RIGHT_PUSHES, ids=range(len(codes.RIGHT_PUSHES)))
def test_a_right_push_is_named_and_raises_no_alarm(step, verdict):
    report = identify(step, isolate=False)
    assert report.verdict == verdict
    assert report.section("Faults") is None


@pytest.mark.parametrize(("step", "words"), codes.WRONG_PUSHES, ids=range(len(codes.WRONG_PUSHES)))
def test_a_wrong_push_is_told_by_its_mistake(step, words):
    report = identify(step, isolate=False)
    assert any(words in line for line in report.section("Faults").lines)
    assert words in report.verdict


def test_the_angle_of_boris_step_is_2_atan_of_half_h_b_and_it_keeps_the_size_of_v():
    found = read_magnetic(opened(codes.boris()))
    assert found.turn.factors[0] == pytest.approx(np.exp(2j * np.arctan(1.0)), abs=1e-15)
    assert (found.kick, found.drift, found.turn.growth) == ((0.5, 0.5), (0.0, 1.0), None)
    assert found.turn.angle == pytest.approx((2, -1 / 12), rel=1e-3)
    lines = dict(found.parts)
    assert lines["Rotation"][0] == "implicit_midpoint: it turns by 2 atan(h B/2) = h B - (h B)^3/12 + ..."
    assert lines["Rotation"][1].startswith("|v| is kept in steps with E = 0")
    assert "order 1" in lines["Position"][1]
    assert found.data["method"] == "boris"


def test_where_fields_are_asked_is_read_where_they_are_functions():
    assert read_magnetic(opened(codes.drifting)).asked == 0.5
    assert read_magnetic(opened(codes.runge_kutta("rk4"))).asked == 0.0
    assert read_magnetic(opened(codes.boris())).asked is None


def test_a_velocity_in_constant_fields_is_held_to_a_method_and_a_position_is_not_decided():
    found = verify(codes.kinetic, "implicit_midpoint", isolate=False, allowance=SOLVED)
    assert found.passed
    assert verify(codes.kinetic, "rk4", isolate=False).passed is False
    assert verify(codes.mass_squared, "implicit_midpoint", isolate=False, allowance=SOLVED).passed is False
    moved = verify(codes.boris(), "implicit_midpoint", isolate=False, allowance=SOLVED)
    assert moved.passed is None
    assert "how the position moves is not held to a method" in moved.verdict
    assert verify(codes.boris(), "velocity_verlet", isolate=False).passed is False


def test_what_is_not_linear_or_remembers_is_refused():
    with pytest.raises(NotReadable, match="relativistic"):
        read_magnetic(opened(codes.relativistic))
    with pytest.raises(NotReadable, match="does not stay"):
        read_magnetic(opened(lambda x, v, B, dt: (x + dt * v, v + dt * np.cross(v, B) + dt)))
    seen = []

    def remembering(v, B, dt):
        seen.append(v)
        return v + dt * len(seen) * np.cross(v, B)

    with pytest.raises(NotReadable, match="taken twice"):
        read_magnetic(opened(remembering))
    with np.errstate(all="ignore"):
        undone = identify(codes.boris(lambda b, h: b / 0.0), isolate=False)
    assert undone.verdict.startswith("gives no answer: from ")
    assert identify(codes.relativistic, isolate=False).verdict.startswith("it is no method that is known here: twice")
