"""A step that raises where it is not meant to be asked is judged by the states that a start gives."""

import re
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from driftproof import Domain, verify
from driftproof.blackbox.stepper.starts import Start
from tests.looping import exactly

TABLE = np.linspace(280.0, 400.0, 13)


def midpoint(f, y, h, part=0.5):
    return y + h * f(y + part * h * f(y))


def heated(temperature):
    if not TABLE[0] <= temperature <= TABLE[-1]:
        raise ValueError("outside of the table")
    return 0.5 * np.interp(temperature, TABLE, TABLE**2 / 9e4) - 0.02 * (temperature - 293.0)


def kepler(y):
    if (distance := np.linalg.norm(y[:3])) < 6.378e6:
        raise ValueError("below the ground")
    return np.concatenate([y[3:], -3.986e14 * y[:3] / distance**3])


def swung(theta, omega, dt, late=0):
    if abs(theta) > pi / 2:
        raise ValueError("beyond the stops")
    moved = omega - dt * 9.81 * sin(theta) / cos(theta)
    return theta + dt * (omega if late else moved), moved


def tumbling(y):
    w, x, y, z, p, q, r = y
    turned = -x * p - y * q - z * r, w * p + y * r - z * q, w * q + z * p - x * r, w * r + x * q - y * p
    return np.array([*(each / 2 for each in turned), 0.6 * q * r, -0.5 * p * r, 0.1 * p * q])


SPIN = np.array([1.0, 2.0, 3.0])


def half_product(q, w):
    """The slope of a quaternion that turns by w."""
    return np.array([-q[1:] @ w, *(q[0] * w + np.cross(w, q[1:]))]) / 2


def turned(q, w, dt, part=0.5):
    end = midpoint(tumbling, np.array([*q, *w]), dt, part)
    q[:], w[:] = end[:4], end[4:]


ORBIT, ROOM, TUMBLE = "8e6, 0, 0, 10, 7e3, 1", "280:400", "1,0,0,0; 0.1,0.2,0.3"
RIGHT = {
    "table": (lambda T, dt: midpoint(heated, T, dt), "midpoint2", lambda y: heated(y[0]), ROOM),
    "orbit": (lambda y, dt: midpoint(kepler, y, dt), "midpoint2", kepler, ORBIT),
    "stops": (swung, "symplectic_euler", lambda y: (y[1], -9.81 * sin(y[0]) / cos(y[0])), "-1.2:1.2; -2:2"),
    "parts": (turned, "midpoint2", tumbling, TUMBLE),
    "clock": (lambda x, t, dt: x + dt * sqrt(x) * cos(t), "forward_euler", lambda t, y: sqrt(y[0]) * cos(t), "4"),
    "gain": (lambda x, gain, dt: x + dt * gain * sqrt(x), "forward_euler", lambda y, gain: gain * sqrt(y[0]), "4"),
}
WRONG = {
    "table": lambda T, dt: midpoint(heated, T, dt, 0.75),
    "orbit": lambda y, dt: midpoint(kepler, y, dt, 1.0),
    "stops": lambda theta, omega, dt: swung(theta, omega, dt, late=1),
    "parts": lambda q, w, dt: turned(q, w, dt, 0.25),
    "clock": lambda x, t, dt: x + dt * sqrt(x) * cos(t + dt),
    "gain": lambda x, gain, dt: x + dt * gain * sqrt(x) / 2,
}


def judged(step, method, system, start, **limits):
    return verify(step, method, system=system, domain=Domain(largest_step=600.0, start=start, **limits), isolate=False)


@pytest.mark.parametrize("name", RIGHT)
def test_a_step_is_judged_where_it_may_be_asked(name):
    step, *meant = RIGHT[name]
    found = judged(step, *meant)
    assert found.passed, found.verdict
    assert f", from states in {Start.of(meant[-1]).words}" in found.verdict
    assert judged(WRONG[name], *meant).passed is False


def test_a_step_that_a_start_gives_no_answer_to_is_told_and_is_no_pass():
    step, *meant, _ = RIGHT["table"]
    found = judged(step, *meant, "240:400")
    assert "; the system given has no slopes at 2 of 6 states there" in found.verdict
    found = judged(step, meant[0], lambda y: heated(min(max(y[0], 280.0), 400.0)), "240:400")
    assert " steps cannot be compared: step(state=[" in found.verdict
    with pytest.raises(ValueError, match=r"has no answer at the start: step.* outside of the table"):
        judged(step, *meant, "2")


def test_states_lie_within_the_ranges():
    start = Start.of("0:1; 2, -4, 0")
    for y in exactly(9, [*start.states, *start.corners]):
        assert all(low <= x <= high for x, (low, high) in exactly(4, zip(y, start.ranges, strict=True)))


def falling(pos, vel, quat, omega, dt, first=True):
    """Semi-implicit Euler of a body that falls and tumbles: velocities first, or each part with the old ones."""
    new = vel + dt * np.array([0.0, 0.0, -9.81])
    spun = omega + dt * -np.cross(omega, omega * SPIN) / SPIN
    pos = pos + dt * (new if first else vel)
    quat = quat + dt * half_product(quat, spun if first else omega)
    return pos, new, quat / np.linalg.norm(quat), spun


@pytest.mark.parametrize("first", [True, False])
def test_a_splitting_moves_the_parts_that_are_called_velocities_before_others(first):
    def system(y):
        _, v, q, w = np.split(y, [3, 6, 10])
        return np.concatenate([v, [0.0, 0.0, -9.81], half_product(q, w), -np.cross(w, w * SPIN) / SPIN])

    step = lambda pos, vel, quat, omega, dt: falling(pos, vel, quat, omega, dt, first)
    found = judged(step, "symplectic_euler", system, "0,0,1; 1,2,0.5; 1,0.1,0.2,0.3; 0.5,0.3,0.2")
    said = "its velocities being vel and omega" if first else "; on it its steps are those of forward_euler"
    assert (found.passed, said in found.verdict) == (first, True), found.verdict
    with pytest.raises(ValueError, match=r"if pos, vel, quat, omega are its state, say so: verify --system MODULE:f"):
        verify(step, "symplectic_euler", system=system, isolate=False)


def test_a_0_without_other_numbers_in_its_part_is_held_there():
    def moved(x, y, heading, speed, dt):
        return x + dt * speed * cos(heading), y + dt * speed * sin(heading), heading + dt * speed / 3, speed

    slopes = lambda y: (y[3] * cos(y[2]), y[3] * sin(y[2]), y[3] / 3, 0.0)
    found = judged(moved, "forward_euler", slopes, "0; 0; 0.2; 5")
    assert (found.passed, "from states in 0, 0, 0.175:0.225, 4.375:5.625" in found.verdict) == (True, True)


def repelled(x, box):
    """The forces of bodies that repel each other, through the walls of a periodic box, too."""
    apart = x[:, None] - x
    apart -= box * np.round(apart / box)
    return (apart / (1 + (apart**2).sum(-1, keepdims=True)) ** 2).sum(1)


def molecules(x, v, f, dt, *, masses=np.ones(3), box=6.0, stale=False):  # noqa: B008
    """Velocity Verlet as codes of molecular dynamics have it: in rows, in a box, its forces handed on."""
    v = v + dt / 2 * f / masses[:, None]
    x = (x + dt * v) % box
    new = repelled(x, box)
    return x, v + dt / 2 * (f if stale else new) / masses[:, None], new


@pytest.mark.parametrize("stale", [False, True])
def test_bodies_of_three_masses_in_a_periodic_box_are_judged_with_the_forces_that_they_hand_on(stale):
    def system(t, y):
        return [*y[9:], *repelled(np.reshape(y[:9], (3, 3)), 6.0).ravel()]

    step = lambda x, v, f, dt: molecules(x, v, f, dt, stale=stale)
    found = judged(step, "velocity_verlet", system, "0,1,2,2,1,0,1,3,2; 0.2,0.1,0,0.1,0.3,0,0,0.1,0.1")
    assert found.passed is not stale
    assert ("number 9 becomes" if stale else "whole periods of 6") in found.verdict
    with pytest.raises(ValueError, match="if these are its state, say so: verify --system MODULE:f --start"):
        verify(step, "velocity_verlet", system=system, isolate=False)


REFUSED = {
    "x": "'x' is no number, nor a range such as 280:400",
    "1:2:3": "'1:2:3' is no number",
    "inf": "'inf' is no number",
    "0": "'0' is one state, which shows little; write such as -1:1",
    "2:1": "'2:1' is no range",
    "1; 2": "and keeps its own system; <lambda>(y, dt): the start has 2",
}


@pytest.mark.parametrize("start", REFUSED)
def test_a_start_that_is_none_is_refused(start):
    with pytest.raises(ValueError, match=re.escape(REFUSED[start])):
        judged(*RIGHT["orbit"][:3], start)


@pytest.mark.parametrize(("step", "options", "said"), [
    (RIGHT["table"][0], {}, "a start has no effect without a system"),
    (RIGHT["table"][0], {"system": kepler, "calls": "map"}, "calls=map has no effect with a start"),
    (lambda f, y, h: y, {"system": kepler}, "f would be a function"),
    (lambda y, h: 0.0 * y[:2], {"system": kepler}, "it returns parts of 2 numbers, which are not those of the start"),
    (lambda y, h: None, {"system": kepler}, "no answer at the start: it returns None"),
])  # fmt: skip
def test_a_start_has_no_effect_on_other_steps(step, options, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        verify(step, "rk4", domain=Domain(start="1" if "None" in said else "1,2,3"), isolate=False, **options)
    with pytest.raises(ValueError, match="parts of 4, 3 numbers; if these are its state, say so: verify --system"):
        verify(lambda q, w, dt: (np.resize(q, 4), np.resize(w, 3)), "rk4", isolate=False)
    with pytest.raises(ValueError, match=r"largest_state=5.0 has no effect with a start"):
        judged(*RIGHT["orbit"], largest_state=5.0)


def test_a_step_that_rests_at_0_is_not_said_never_to_move():
    reacted = lambda conc, dt: np.maximum(conc + dt * conc[0] * conc[1] * np.array([-2.0, -1.0, 2.0]), 0.0)
    assert verify(reacted, "forward_euler", isolate=False).passed is None
