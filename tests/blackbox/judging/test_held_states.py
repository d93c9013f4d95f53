"""A code that clips numbers, wraps them into a box or divides them by their length is judged beside that."""

import re
from functools import partial

import numpy as np
import pytest

from driftproof import Domain, verify


def test_a_limit_of_a_step_is_no_other_system():
    rate = lambda c: np.array([-2 * c[0] * c[1], 0.1 - c[0] * c[1]])
    clipped = lambda x, dt: np.maximum(x + dt / 2 * (rate(x) + rate(x + dt * rate(x))), 0.0)
    for domain in (Domain(), Domain(largest_step=0.5, start="0.5:1, 0.5:1")):
        assert verify(clipped, "heun2", system=rate, domain=domain, isolate=False).passed
    cooled = lambda x, dt: np.clip(x + dt * (290 - x), 280.0, 350.0)
    found = verify(cooled, "forward_euler", system=lambda x: 290 - x, isolate=False)
    assert found.passed is None
    assert "states jump, or end at a limit, however short the step" in found.verdict
    assert "the states that it is for: --start" in found.text()
    low = Domain(start="281:282")
    near = verify(cooled, "forward_euler", system=lambda x: 290 - x, domain=low, isolate=False)
    assert "forward_euler goes on; 0 steps with h < 0 agree" in near.verdict
    reset = lambda x, v, dt: (x + dt * v, 0.0)
    assert verify(reset, "symplectic_euler", system=lambda y: [y[1], -y[0]], isolate=False).passed is False


def turning(q, w, right=True):
    turned = np.cross(q[1:], w) if right else np.cross(w, q[1:])
    return np.array([-w @ q[1:], *(w * q[0] + turned)]) / 2, np.cross(np.array([4.0, 5.0, 7.0]) * w, w)


def attitude(q, w, dt, weight=1 / 2, right=True):
    half = [x + weight * dt * k for x, k in zip((q, w), turning(q, w, right), strict=True)]
    q, w = (x + dt * k for x, k in zip((q, w), turning(*half, right), strict=True))
    return q / np.linalg.norm(q), w


@pytest.mark.parametrize(("options", "said"), [
    ({}, "is midpoint2 on the system given, with numbers 0 to 3 divided by their length at its end, to "),
    ({"right": False}, "is not midpoint2: its system is not the one given: from ("),
    ({"weight": 1 / 4}, "is not midpoint2; it is midpoint2 with one mistake: a[1][0]: 1/4 instead of 1/2; a step of"),
])  # fmt: skip
@pytest.mark.parametrize("apart", [True, False])
def test_a_part_that_is_divided_by_its_length_is_judged_along_the_sphere(options, said, apart):
    one = lambda y, dt: np.concatenate(attitude(y[:4], y[4:], dt, **options))
    step, start = (partial(attitude, **options), "1,0,0,0; 0.1,0.2,0.3") if apart else (one, "1,0,0,0,0.1,0.2,0.3")
    rate = lambda y: np.concatenate(turning(y[:4], y[4:]))
    assert said in verify(step, "midpoint2", system=rate, domain=Domain(start=start), isolate=False).verdict


@pytest.mark.parametrize(("step", "said"), [
    (lambda y, dt: np.array([(y[0] + dt * y[1]) % 8.0, y[1] + dt * np.sin(np.pi / 4 * y[0])]),
     "is forward_euler on the system given, to .*; numbers come back without whole periods of 8$"),
    (lambda y, dt: np.array([(y[0] + dt * y[1]) % 8.0, y[1] + dt * np.sin(np.pi / 4 * (y[0] + dt * y[1]))]),
     "is not forward_euler"),
    (lambda y, dt: np.array([y[0] + dt * y[1] + 1.0, y[1] + dt * np.sin(np.pi / 4 * y[0])]), "is not the one given"),
])  # fmt: skip
def test_a_box_is_no_other_system_and_what_is_wrong_from_all_states_is(step, said):
    found = verify(step, "forward_euler", system=lambda y: [y[1], np.sin(np.pi / 4 * y[0])], isolate=False)
    assert re.search(said, found.verdict), found.verdict
