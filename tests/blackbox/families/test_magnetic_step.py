"""What is read of a push: where its fields are asked for; what is no push that turns, kicks and drifts is refused."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import identify
from driftproof.blackbox.families.magnetic_step import read_magnetic
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox.families import turning_steppers as codes
from tests.blackbox.families.bounds import U, parted


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
    assert identify(codes.relativistic, isolate=False).verdict.startswith("it is not a known method: doubling")


BORIS, RK4 = codes.boris(), codes.runge_kutta("rk4")
OTHER, LAW = "with both fields, and at other states, ", "the position moves by another law"


def beside(change, step=BORIS):
    """The step and k u times a change of what it makes of x and of v."""

    def made(k):
        def moved(x, v, E, B, dt):
            ends = step(x, v, E, B, dt) if step is BORIS else step(x, v, lambda y: E, lambda y: B, dt)
            return tuple(end + k * U * off for end, off in zip(ends, change(x, v, E, B, dt), strict=True))

        return moved

    return made


# Steps that are off by k u, what is said of one that is off too far, and k before and behind the bound. Rounding may
# carry 4 (8 + 2) = 40 roundings of numbers of size 4 (kicks, drifts, at rest), 8 (what is linear), 16 (at all angles)
# or 32 (elsewhere), times 1 + what it is held to; a change shows of some of that, as it is along B or across.
BOUNDS = [
    (lambda k: codes.boris(kicks=(0.5 + k * U, 0.5 - k * U)), "the rotation of boris, with other kicks", (158, 163)),
    (lambda k: codes.boris(kicks=(0.5 + k * U, 0.5)), "gives h E times 1.00000000000001", (158, 163)),
    (lambda k: codes.boris(drift=(0.0, 1.0 + k * U)), "moves by 1.00000000000001", (158, 163)),
    (lambda k: codes.boris(drift=(k * U, 1.0 - k * U)), "does not move as in a single method", (158, 163)),
    (lambda k: codes.boris(drift=(0.5 + k * U, 0.5 - k * U)), "does not move as in a single method", (95, 98)),
    (lambda k: codes.boris(lambda b, h: h / 2 * b * (1 + k * U)), "not a known rotation", (316, 325)),
    (beside(lambda x, v, E, B, dt: (0, dt * np.cross(E, B)), RK4), f"a rotation by rk4; {LAW}", (79, 82)),
    (beside(lambda x, v, E, B, dt: (dt * v, 0), RK4), "does not move as in a single method", (137, 142)),
    (beside(lambda x, v, E, B, dt: (dt * np.cross(v, B), 0), RK4), "does not move as in a single method", (68, 71)),
    (beside(lambda x, v, E, B, dt: (dt**2 * E, 0), RK4), "does not move as in a single method", (137, 142)),
    (beside(lambda x, v, E, B, dt: (dt**2 * E, 0)), "moves differently than without E", (538, 553)),
    (beside(lambda x, v, E, B, dt: (0, v * (not B.any()))), "with B = 0, the velocity 1 becomes 1", (158, 164)),
    (beside(lambda x, v, E, B, dt: (0, dt * np.cross(np.cross(E, B), B))), f"not a known step; {LAW}", (134, 139)),
    (beside(lambda x, v, E, B, dt: (0, v * (v @ v))), "doubling the velocity does not double", (52, 55)),
    (beside(lambda x, v, E, B, dt: (0, v * (dt == 0.25))), "rotation is not a function of h B: at h B = 1", (632, 650)),
    (beside(lambda x, v, E, B, dt: (0, v * (B[0] > 0))), "the rotation depends on the direction of B", (668, 686)),
    (beside(lambda x, v, E, B, dt: (0, x)), f"{OTHER}the step is not made of these kicks", (418, 431)),
    (beside(lambda x, v, E, B, dt: (x, 0)), f"{OTHER}the position moves in another way", (418, 431)),
]


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize(("made", "words", "places"), BOUNDS, ids=range(len(BOUNDS)))
def test_what_may_be_rounding_has_a_bound(made, words, places):
    assert parted(lambda subject: read_magnetic(subject).verdict, made, words, places)
