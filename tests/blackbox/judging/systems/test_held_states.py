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


def turning(q, w, right=True, steady=False, stages=False):
    q = q / np.linalg.norm(q) if stages else q
    turned, moments = np.cross(q[1:], w) if right else np.cross(w, q[1:]), np.array([4.0, 5.0, 7.0])
    return np.array([-w @ q[1:], *(w * q[0] + turned)]) / 2, np.cross(moments * w, w) * (not steady)


def attitude(q, w, dt, weight=1 / 2, **options):
    half = [x + weight * dt * k for x, k in zip((q, w), turning(q, w, **options), strict=True)]
    q, w = (x + dt * k for x, k in zip((q, w), turning(*half, **options), strict=True))
    return q / np.linalg.norm(q), w


@pytest.mark.parametrize(("options", "said"), [
    ({}, "is midpoint2 on the system given, with numbers 0 to 3 divided by their length at its end, to "),
    ({"right": False}, "is not midpoint2: its system is not the one given: from ("),
    ({"weight": 1 / 4}, "is not midpoint2"),
    ({"stages": True}, "undecided whether it is midpoint2: its stages are divided by their length as well; with a"),
])  # fmt: skip
@pytest.mark.parametrize("form", ["parts", "one", "by name", "kept"])
def test_a_part_that_is_divided_by_its_length_is_judged_along_the_sphere(options, said, form):
    one = lambda y, dt: np.concatenate(attitude(y[:4], y[4:], dt, **options))
    kept = lambda q, w, dt: attitude(q, w, dt, steady=True, **options)[0]
    step, start = partial(attitude, **options), "1,0,0,0; 0.1,0.2,0.3"
    step, start = {"one": (one, "1,0,0,0,0.1,0.2,0.3"), "kept": (kept, start)}.get(form, (step, start))
    rate = lambda y: np.concatenate(turning(y[:4], y[4:]))
    rate = {"by name": lambda q, w: turning(q, w), "kept": lambda t, y, w: turning(y, w)[0]}.get(form, rate)
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


def infected(s, i, r, dt, late=0):
    """Forward Euler of an epidemic that keeps its numbers above 0; `late` uses the new s for i."""
    caught, healed = 0.3 * s * i / (s + i + r), 0.1 * i
    new = max(s - dt * caught, 0.0)
    caught = 0.3 * new * i / (new + i + r) if late else caught
    return new, max(i + dt * (caught - healed), 0.0), r + dt * healed


def epidemic(t, y):
    return [-0.3 * y[0] * y[1] / sum(y), 0.3 * y[0] * y[1] / sum(y) - 0.1 * y[1], 0.1 * y[1]]


@pytest.mark.parametrize("options", [
    {"system": epidemic}, {"system": epidemic, "domain": Domain(start="900; 80; 20", largest_step=50.0)}, {},
])  # fmt: skip
def test_numbers_that_are_kept_above_0_are_seen_there(options):
    found = verify(infected, "forward_euler", isolate=False, **options)
    assert found.passed is (True if options else None)
    assert "is forward_euler on " in found.verdict
    late = lambda s, i, r, dt: infected(s, i, r, dt, late=1)
    assert verify(late, "forward_euler", isolate=False, **options).passed is False
