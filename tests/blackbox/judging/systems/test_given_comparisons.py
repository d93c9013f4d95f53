"""Steps of a built-in system beside those of a method on the system given: to rounding, everywhere, in every form."""

from dataclasses import dataclass
from math import cos, exp, pi, sin

import numpy as np
import pytest

from driftproof import Allowance, Domain, verify

G, KELVIN, EARTH = 9.81, 273.15, 6.371e6


def rk4(f, t, y, h, last=1 / 6):
    k1 = np.array(f(t, y))
    k2 = np.array(f(t + h / 2, y + h / 2 * k1))
    k3 = np.array(f(t + h / 2, y + h / 2 * k2))
    k4 = np.array(f(t + h, y + h * k3))
    return y + h * ((1 / 3 - last) * k1 + k2 / 3 + k3 / 3 + last * k4)


def on(f, change=lambda y, h: (y, h), **how):
    """RK4 of a system as step(y, h), after what is done to its arguments."""

    def step(y, h):
        y, h = change(y, h)
        return rk4(f, 0.0, y, h, **how)

    return step


def pendulum(t, y, g=G):
    return [y[1], -g * np.sin(y[0])]


def driven(t, y):
    return [y[1], np.cos(t) - y[0]]


def cubic(t, y):
    return [y[1], -y[0] - 1e-9 * y[0] ** 3]


def robertson(t, y):
    return [-0.04 * y[0] + 1e4 * y[1] * y[2], 0.04 * y[0] - 1e4 * y[1] * y[2] - 3e7 * y[1] ** 2, 3e7 * y[1] ** 2]


@dataclass
class Moving:
    t: float
    x: float
    v: float


def euler_of_a_record(s: Moving, dt: float) -> Moving:
    return Moving(s.t + dt, s.x + dt * s.v, s.v + dt * (cos(s.t) - s.x))


def with_its_clock_ignored(s: Moving, dt: float) -> Moving:
    return Moving(s.t + dt, s.x + dt * s.v, s.v + dt * (1.0 - s.x))


def two_springs(t, y):
    return [y[1], 0.5 * (y[2] - y[0]) - 2 * y[0], y[3], 0.5 * (y[0] - y[2]) - 1.5 * y[2]]


def in_turn(stale=False):
    """Symplectic Euler of x1, v1, x2, v2; a wrong one moves the positions by their old velocities."""

    def step(y, dt):
        kicked = y + dt * np.array(two_springs(0, y)) * [0, 1, 0, 1]
        return kicked + dt * np.array(two_springs(0, y if stale else kicked)) * [1, 0, 1, 0]

    return step


def spoiling(y, h):
    end = on(pendulum)(y.copy(), h)
    y[:] = 7.0
    return end


BUFFER = np.zeros(2)


def in_one_buffer(y, h):
    BUFFER[:] = on(pendulum)(y, h)
    return BUFFER


def only_near(y, h):
    if np.abs(y).max() > 50:
        raise ValueError("too far")
    return on(pendulum)(y, h)


def only_forth(y, h):
    if h < 0:
        raise ValueError("no way back")
    return on(pendulum)(y, h)


def turned_back(theta, omega, dt):
    omega = omega - dt * G * sin(theta)
    return (theta + dt * omega + pi) % (2 * pi) - pi, omega


def above_the_ground(z, v, dt):
    """With the distance from the centre of the Earth as it is computed."""
    r = z + EARTH
    v = v - dt * G * (EARTH / r) ** 2
    return (r + dt * v) - EARTH, v


def swung(x, v, dt):
    v = v + dt * 2 * (exp(-x) ** 2 - exp(-x))
    return x + dt * v, v


def iterated(y, h, enough=1e-10):
    end = y + h * np.array(pendulum(0, y))
    for _ in range(200):
        before, end = end, y + h * np.array(pendulum(0, end))
        if np.abs(end - before).max() < enough:
            break
    return end


def by_newton(y, h, rounds=30):
    """Backward Euler of Robertson's reaction, its equations solved by so many iterations of Newton's method."""
    end = np.array(y, dtype=float)
    for _ in range(rounds):
        away = 1e-7 * np.eye(3)
        rows = np.array([np.subtract(robertson(0, end + x), robertson(0, end - x)) / 2e-7 for x in away]).T
        end = end - np.linalg.solve(np.eye(3) - h * rows, end - y - h * np.array(robertson(0, end)))
    return end


PASSED = {
    "a pendulum": (on(pendulum), "rk4", pendulum, "is rk4 on the system given, to "),
    "driven": (lambda t, y, h: rk4(driven, t, y, h), "rk4", driven, "in 24 steps"),
    "driven, in a record": (euler_of_a_record, "forward_euler", driven, "in 24 steps"),
    "a velocity after each position": (
        in_turn(), "symplectic_euler", two_springs, "on the system given, with velocities between positions, to"),
    "rates of 1e7": (on(robertson), "rk4", robertson, "in 12 steps"),
    "degrees": (
        lambda y, h: y - 0.3 * h * ((y + KELVIN) - (21.5 + KELVIN)), "forward_euler", lambda y: [-0.3 * (y[0] - 21.5)],
        "in 1 number, to 6e-16"),
    "large numbers": (
        above_the_ground, "symplectic_euler", lambda y: [y[1], -G / (1 + y[0] / EARTH) ** 2],
        "with more rounding than sums of these slopes have"),
    "a cancellation": (
        swung, "symplectic_euler", lambda y: [y[1], -2 * (1 - exp(-y[0])) * exp(-y[0])], "symplectic_euler on the"),
    "binary32": (
        lambda y, h: on(pendulum)(np.float32(y), np.float32(h)).astype(np.float32), "rk4", pendulum,
        "remark: answers are rounded to binary32"),
    "one buffer": (in_one_buffer, "rk4", pendulum, "remark: an answer is overwritten by the next call"),
    "near": (only_near, "rk4", pendulum, "remark: no answer to 6 steps elsewhere: step(state=[-112."),
    "forth": (only_forth, "rk4", pendulum, "is rk4"),
    "an angle": (turned_back, "symplectic_euler", pendulum, "remark: angles come back without whole turns; 27 steps"),
    "iterated": (iterated, "backward_euler", pendulum, "is backward_euler", Allowance(solver_tolerance=1e-10)),
}  # fmt: skip
REFUTED = {
    "a constant": (on(lambda t, y: pendulum(t, y, G * (1 + 1e-12))), "rk4", pendulum, "is not rk4: a step of 0.0625"),
    "a weight": (on(pendulum, last=1 / 6 + 1e-10), "rk4", pendulum, "is not rk4: a step of"),
    "a small term": (on(lambda t, y: [y[1], -y[0]]), "rk4", cubic, "is not rk4: a step of"),
    "old velocities after positions": (in_turn(True), "symplectic_euler", two_springs, "symplectic_euler with one"),
    "a clock": (with_its_clock_ignored, "forward_euler", driven, "a step of 0.25 at t = 0.75 from"),
    "small states": (on(pendulum, lambda y, h: (y * (np.abs(y) > 1e-3), h)), "rk4", pendulum, "but not everywhere"),
    "long steps": (on(pendulum, lambda y, h: (y, min(h, 0.5))), "rk4", pendulum, "but not everywhere: a step of 0.8"),
    "backwards": (on(pendulum, lambda y, h: (y, abs(h))), "rk4", pendulum, "for h > 0 only: a step of -0.0625 from"),
    "arguments": (spoiling, "rk4", pendulum, "but not for every form of state: it changes its arguments to"),
    "decimals": (lambda y, h: np.round(on(pendulum)(y, h), 6), "rk4", pendulum, "is not rk4: a step of"),
    "not solved": (
        lambda y, h: iterated(y, h, 1e-6), "backward_euler", pendulum,
        " of 1 + its largest number; the solver tolerance is 1.0e-10 of that", Allowance(solver_tolerance=1e-10)),
}  # fmt: skip


@pytest.mark.parametrize("name", {**PASSED, **REFUTED})
def test_a_step_passes_if_it_is_right_to_its_rounding_wherever_it_is_seen(name):
    step, method, system, said, *allowed = {**PASSED, **REFUTED}[name]
    found = verify(step, method, system=system, isolate=False, **({"allowance": allowed[0]} if allowed else {}))
    assert found.passed is (name in PASSED), found.verdict
    assert said in found.verdict


def clipped(at):
    """Symplectic Euler of a pendulum whose angle is held at 1.2: after the step, before it, or for good."""
    held = lambda q: min(max(q, -1.2), 1.2)

    def step(q, w, h):
        if at == "for good" and abs(q) >= 1.2:
            return q, 0.0
        w = w - h * G * np.sin(q)
        return (held(q) + h * w if at == "before" else held(q + h * w)), w

    return step


@pytest.mark.parametrize("at", ["after", "before", "for good"])
def test_a_step_that_puts_states_to_a_limit_is_undecided_until_a_start_says_where_it_is_asked(at):
    swings = lambda y: (y[1], -G * np.sin(y[0]))
    found = verify(clipped(at), "symplectic_euler", system=swings, isolate=False)
    assert (found.passed, "; --start, in Python Domain(start=...), says" in found.verdict) == (None, True)
    assert " from (-3.989, 6.648) number " in found.verdict
    within = verify(clipped(at), "symplectic_euler", system=swings, domain=Domain(start="-1:1; -2:2"), isolate=False)
    assert (within.passed, "from states in -1:1, -2:2" in within.verdict) == (True, True)
    assert ("ends at -1.2, a limit" in within.verdict) == (at != "before")
    old = lambda q, w, h: (clipped(at)(q, w, h)[0] - h * h * G * np.sin(q), clipped(at)(q, w, h)[1])
    assert verify(old, "symplectic_euler", system=swings, isolate=False).passed is False


def test_a_bounce_is_named_and_other_states_are_compared():
    def fall(y, v, h, by=1.0):
        y, v = y + h * by * (v - G * h), v - G * h
        return (0.0, -0.8 * v) if y < 0 else (y, v)

    found = verify(fall, "symplectic_euler", system=lambda y: (y[1], -G), isolate=False)
    assert found.passed, found.verdict
    assert "number 0 ends at 0, a limit, where symplectic_euler goes on, and number 1 is changed there" in found.verdict
    wrong = lambda y, v, h: fall(y, v, h, 1.001)
    assert verify(wrong, "symplectic_euler", system=lambda y: (y[1], -G), isolate=False).passed is False


def test_a_tank_that_is_empty_is_a_state_like_others():
    rate = lambda h: 1.0 - 0.5 * max(h, 0.0) ** 0.5
    step = lambda h, dt: min(max(h + dt / 2 * (rate(h) + rate(h + dt * rate(h))), 0.0), 2.0)
    found = verify(step, "heun2", system=lambda y: [rate(y[0])], isolate=False)
    assert (found.passed, "number 0 ends at 2, a limit" in found.verdict) == (True, True)


@pytest.mark.parametrize(("rounds", "said"), [
    (30, "is backward_euler on the system given, to "),
    (1, "is not backward_euler; it is backward_euler with one mistake: the stages are solved by 1 iteration of"),
])  # fmt: skip
def test_stages_of_a_stiff_system_are_solved_where_iterations_run_away(rounds, said):
    asked = {"domain": Domain(start="0.9:1,1e-5:4e-5,0:0.1"), "allowance": Allowance(solver_tolerance=1e-12)}
    step = lambda y, h: by_newton(y, h, rounds)
    found = verify(step, "backward_euler", system=robertson, isolate=False, **asked)
    assert (found.passed, said in found.verdict) == (rounds > 1, True), found.verdict


@pytest.mark.parametrize(("method", "step"), [
    ("forward_euler", lambda y, h: y + h * np.array(driven(0.0, y))), ("rk4", on(driven)),
])  # fmt: skip
def test_a_step_without_t_is_undecided_on_a_system_with_t(method, step):
    found = verify(step, method, system=driven, isolate=False)
    assert found.passed is None
    assert f"which the step does not take: at t = 0, which alone is seen, it is {method} on" in found.verdict
    assert found.section("What would decide it").lines[0].endswith("a step that takes the time, such as step(t, y, h)")
    assert verify(on(lambda t, y: driven(0.0, y)), "rk4", system=driven, isolate=False).passed is False


def test_what_was_looked_at_is_told_and_how_far_it_is_to_be_right_can_be_said():
    capped = on(pendulum, lambda y, h: (np.clip(y, -3, 3), h))
    near = verify(capped, "rk4", system=pendulum, domain=Domain(0.5, 2.0), isolate=False)
    assert near.passed
    told = near.section("Steps elsewhere: passed").lines
    assert told == ("27 steps elsewhere agree, from states of 0.00061 to 2, of h up to 0.5",)
    forth = verify(only_forth, "rk4", system=pendulum, isolate=False).section("Steps back: not tested")
    assert forth.lines[0].startswith("h < 0 is refused: step(state=[-0.75, 1.25], h=-0.0625) raises ValueError: no way")


def test_a_step_that_ends_where_the_system_has_no_slopes_is_beside_it():
    """y0' = -sqrt(y0): a code that turns the sign of large y0 ends at none."""
    slopes = lambda t, y: np.array([-np.sqrt(y[0]) if y[0] >= 0 else np.nan, -y[1]])

    def turned(y, h):
        found = y + h * slopes(0.0, y)
        return found * [-1, 1] if y[0] > 20 else found

    rates = lambda t, y: [-(y[0] ** 0.5) if y[0] >= 0 else 1 / 0, -y[1]]
    report = verify(turned, "forward_euler", system=rates, isolate=False)
    assert report.passed is False
    assert "on the system given, but not everywhere" in report.verdict
