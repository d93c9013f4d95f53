"""Boris' step and its kin: the rotation by its angle, both half kicks, the drift, and every mistake by its name."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.families.magnetic_step import read_magnetic
from driftproof.blackbox.judging.agreement import NO_ALLOWANCE
from driftproof.blackbox.judging.tolerance import Allowance
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import turning_steppers as codes

SOLVED = Allowance(solver_tolerance=1e-10)


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


# With the method, whether it is that, and what the verdict says.
HELD = [
    (codes.kinetic, "implicit_midpoint", True, "is implicit_midpoint"),
    (codes.kinetic, "rk4", False, "it is boris"),
    (codes.mass_squared, "implicit_midpoint", False, "gives h E times 1/2"),
    (codes.boris(), "implicit_midpoint", False, "by h v1, not as in implicit_midpoint for the whole"),
    (codes.boris(drift=(0.5, 0.5)), "implicit_midpoint", True, "is implicit_midpoint"),
    (codes.runge_kutta("rk4"), "rk4", True, "is rk4 of v' = E + v x B"),
    (codes.runge_kutta("kutta3"), "rk4", False, "it is kutta3 of"),
    (codes.rk4_with_eulers_position, "rk4", False, "moves otherwise than in one method for the whole of x' = v"),
    (codes.boris(), "velocity_verlet", False, "it is boris"),
    (codes.boris(), "boris", True, "is boris; v stands half a step behind x"),
    (codes.boris(), "Boris pusher", True, "is boris"),
    *((step, "boris", True, "is boris") for step in (codes.kinetic, codes.by_ratio, codes.drifting, codes.in_plane)),
    (codes.without_field, "boris", True, "is boris"),
    (codes.asked_at(0.0, 0.0, 1.0), "boris", True, "is boris; v stands half a step behind x"),
    (codes.asked_at(1.0, 1.0, 0.0), "boris", True, "is boris"),
    (codes.asked_at(1.0, 0.0, 1.0), "boris", False, "the fields are asked at x + h v, not at x: order 1"),
    (codes.asked_at(0.0, 0.5, 0.5), "boris", False, "the fields are asked at x, not at x + 1/2 h v: order 1"),
    (codes.iterated, "implicit_midpoint", True, "is implicit_midpoint"),
    (codes.boris(codes.tangent), "boris", False, "boris but for its rotation, which is exact"),
    (codes.runge_kutta("rk4"), "boris", False, "is not boris; it is rk4"),
    *((step, "boris", False, "is not boris") for step, _ in codes.WRONG_PUSHES),
    (codes.moved_by_field, "boris", False, "the position moves in another way than without E"),
    (lambda f, t, y, h: y + h * f(t, y), "boris", None, "it takes no magnetic field"),
    (codes.quaternion("rk4"), "boris", None, "it takes no magnetic field"),
]


@pytest.mark.parametrize(("step", "key", "passed", "words"), HELD, ids=range(len(HELD)))
def test_a_push_is_held_to_boris_step_or_to_a_method_for_the_whole(step, key, passed, words):
    found = verify(step, key, isolate=False, allowance=SOLVED if key == "implicit_midpoint" else NO_ALLOWANCE)
    assert found.passed is passed
    assert words in found.verdict


KEPT = (
    "|v| is kept in steps with E = 0: off by 0.0e+00 at most",
    "areas across B, and so volumes of velocities, are kept",
)
CAYLEY = ("implicit_midpoint: it turns by 2 atan(h B/2) = h B - (h B)^3/12 + ...", *KEPT)
HALVES, AT_ONE_TIME = "kick 1/2 h E, rotation, kick 1/2 h E", "as a step from x and v at one time it has order 1"
BEHIND, AHEAD = (f"v stands half a step {where} x: {AT_ONE_TIME}" for where in ("behind", "ahead of"))
EVIDENCE = [
    (codes.boris(), "boris", CAYLEY, (HALVES,), ("x1 = x + h v1", BEHIND)),
    (
        codes.drifting,
        "boris",
        CAYLEY,
        (HALVES,),
        ("x1 = x + h (1/2 v + 1/2 v1)", "the fields are asked at x + 1/2 h v"),
    ),
    (codes.asked_at(1, 1, 0), "boris", CAYLEY, (HALVES,), ("x1 = x + h v", AHEAD, "the fields are asked at x + h v")),
    (
        codes.fields_apart,
        None,
        CAYLEY,
        (HALVES,),
        ("x1 = x + h v1", BEHIND, "the fields are asked at x and at x + h v"),
    ),
    (codes.kinetic, "boris", CAYLEY, (HALVES,), ()),
    (codes.without_field, None, CAYLEY, (), ("x1 = x + h v1", BEHIND)),
    (codes.boris(drift=(0.25, 0.75)), None, CAYLEY, (HALVES,), ("x1 = x + h (1/4 v + 3/4 v1)",)),
    (
        codes.boris(kicks=(1, 0)),
        None,
        CAYLEY,
        (
            "kick 1 h E, rotation, kick 0 h E",
            "order 1 where both fields act: a half kick on either side of the rotation has order 2",
        ),
        ("x1 = x + h v1", BEHIND),
    ),
    (
        codes.runge_kutta("rk4"),
        None,
        ("rk4: it turns by h B - (h B)^5/120 + ...", "its size is multiplied by 1 - (h B)^6/144 + ..."),
        ("the electric field enters as in one method for the whole of v' = E + v x B",),
        (),
    ),
]


@pytest.mark.parametrize(("step", "key", "rotation", "kicks", "position"), EVIDENCE, ids=range(len(EVIDENCE)))
def test_the_evidence_is_shown(step, key, rotation, kicks, position):
    found = read_magnetic(opened(step))
    assert {title: tuple(lines) for title, lines in found.parts} == {
        "Rotation": rotation,
        "Kicks": kicks,
        "Position": position,
    }
    assert found.key == key
