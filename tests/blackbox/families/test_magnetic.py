"""Boris' step and its kin: the rotation by its angle, both half kicks, the drift, and every mistake by its name."""

from __future__ import annotations

import pytest

from driftproof import verify
from driftproof.blackbox.families.magnetic_step import read_magnetic
from driftproof.blackbox.judging.specification import NO_ALLOWANCE, Allowance
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import turning_steppers as codes

SOLVED = Allowance(solver_tolerance=1e-10)


# With the method, whether it is that, and what the verdict says.
HELD = [
    (codes.kinetic, "implicit_midpoint", True, "is implicit_midpoint"),
    (codes.kinetic, "rk4", False, "it is boris"),
    (codes.mass_squared, "implicit_midpoint", False, "gives h E times 1/2"),
    (codes.boris(), "implicit_midpoint", False, "by h v1, not as in implicit_midpoint for all of"),
    (codes.boris(drift=(0.5, 0.5)), "implicit_midpoint", True, "is implicit_midpoint"),
    (codes.runge_kutta("rk4"), "rk4", True, "is rk4 of v' = E + v x B"),
    (codes.runge_kutta("kutta3"), "rk4", False, "it is kutta3 of"),
    (codes.rk4_with_eulers_position, "rk4", False, "does not move as in a single method for all of x' = v"),
    (codes.boris(), "velocity_verlet", False, "it is boris"),
    (codes.boris(), "boris", True, "is boris; v is half a step behind x"),
    (codes.boris(), "Boris pusher", True, "is boris"),
    *((step, "boris", True, "is boris") for step in (codes.kinetic, codes.by_ratio, codes.drifting, codes.in_plane)),
    (codes.without_field, "boris", True, "is boris"),
    (codes.asked_at(0.0, 0.0, 1.0), "boris", True, "is boris; v is half a step behind x"),
    (codes.asked_at(1.0, 1.0, 0.0), "boris", True, "is boris"),
    (codes.asked_at(1.0, 0.0, 1.0), "boris", False, "the fields are evaluated at x + h v, not at x: order 1"),
    (codes.asked_at(0.0, 0.5, 0.5), "boris", False, "the fields are evaluated at x, not at x + 1/2 h v: order 1"),
    (codes.iterated, "implicit_midpoint", True, "is implicit_midpoint"),
    (codes.boris(codes.tangent), "boris", False, "boris except for its rotation, which is exact"),
    (codes.runge_kutta("rk4"), "boris", False, "is not boris; it is rk4"),
    *((step, "boris", False, "is not boris") for step, _ in codes.WRONG_PUSHES),
    (codes.moved_by_field, "boris", False, "the position moves differently than without E"),
    (lambda f, t, y, h: y + h * f(t, y), "boris", None, "it takes no magnetic field"),
    (codes.quaternion("rk4"), "boris", None, "it takes no magnetic field"),
]


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize(("step", "key", "passed", "words"), HELD, ids=range(len(HELD)))
def test_a_push_is_held_to_boris_step_or_to_a_method_for_the_whole(step, key, passed, words):
    found = verify(step, key, isolate=False, allowance=SOLVED if key == "implicit_midpoint" else NO_ALLOWANCE)
    assert found.passed is passed
    assert words in found.verdict


CAYLEY = "implicit_midpoint: it turns by 2 atan(h B/2) = h B - (h B)^3/12 + ...|"
KEPT = "|v| is preserved in steps with E = 0: off by 0.0e+00 at most|"
KEPT += "areas across B, and so volumes of velocities, are preserved"
RK4 = "rk4: it turns by h B - (h B)^5/120 + ...|its size is multiplied by 1 - (h B)^6/144 + ..."
HALVES, AT = "kick 1/2 h E, rotation, kick 1/2 h E", "the fields are evaluated at x"
BEHIND = "v is half a step behind x: as a step from x and v at the same time it has order 1"
AHEAD = BEHIND.replace("behind", "ahead of")
ORDER_1 = "order 1 where both fields act: a half kick on either side of the rotation has order 2"
WHOLE = "the electric field enters as in a single method for all of v' = E + v x B"
EVIDENCE = [
    (codes.boris(), "boris", f"{HALVES}|x1 = x + h v1|{BEHIND}"),
    (codes.drifting, "boris", f"{HALVES}|x1 = x + h (1/2 v + 1/2 v1)|{AT} + 1/2 h v"),
    (codes.asked_at(1, 1, 0), "boris", f"{HALVES}|x1 = x + h v|{AHEAD}|{AT} + h v"),
    (codes.fields_apart, None, f"{HALVES}|x1 = x + h v1|{BEHIND}|{AT} and at x + h v"),
    (codes.kinetic, "boris", HALVES),
    (codes.without_field, None, f"x1 = x + h v1|{BEHIND}"),
    (codes.boris(drift=(0.25, 0.75)), None, f"{HALVES}|x1 = x + h (1/4 v + 3/4 v1)"),
    (codes.boris(kicks=(1, 0)), None, f"kick 1 h E, rotation, kick 0 h E|{ORDER_1}|x1 = x + h v1|{BEHIND}"),
    (codes.boris(drift=(0.0, 0.0)), None, f"{HALVES}|x1 = x + 0"),
    (codes.runge_kutta("rk4"), None, WHOLE),
]


@pytest.mark.parametrize(("step", "key", "lines"), EVIDENCE, ids=range(len(EVIDENCE)))
def test_the_evidence_is_shown(step, key, lines):
    found = read_magnetic(opened(step))
    (_, rotation), (_, kicks), (_, position) = found.parts
    assert "|".join(rotation) == (RK4 if lines == WHOLE else CAYLEY + KEPT)
    assert ("|".join([*kicks, *position]), found.key) == (lines, key)


def test_a_position_is_held_to_no_splitting_and_a_step_that_leaves_b_out_kicks_last():
    refused = ("velocity_verlet is not defined for x' = v, v' = E + v x B: verify it as boris",)
    assert verify(codes.boris(), "velocity_verlet", isolate=False).section("Position: FAILED").lines == refused
    assert verify(codes.boris(drift=(0.25, 0.75)), "boris", isolate=False).section("Position: FAILED")
    found = read_magnetic(opened(lambda x, v, E, B, dt: (x + dt * v, v + dt * E)))
    assert (found.kick, found.faults[0]) == ((0.0, 1.0), "it turns by 0 times h B for short steps, not by h B")
