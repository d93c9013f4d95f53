"""Steppers whose system is built in and is not q'' = -q: right ones are undecided, and wrong ones fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import cos, sin
from typing import Any

import numpy as np
import pytest

from driftproof import Allowance, identify, stepper_of, verify

SOLVED = {"allowance": Allowance(solver_tolerance=Fraction(1, 10**12))}


def rk4_of(rate: Callable[..., Any], *, last: float = 1.0, of: int = 3, late: float = 1.0) -> Callable[..., Any]:
    """RK4 of a rate(t, y); in a wrong one, k4 takes another part of h, another slope or another time."""

    def advance(y: Any, t: float, dt: float) -> Any:
        slopes = [rate(t, y)]
        for part in (0.5, 0.5):
            slopes.append(rate(t + dt / 2, y + part * dt * slopes[-1]))
        slopes.append(rate(t + late * dt, y + last * dt * slopes[of - 1]))
        return y + dt / 6 * (slopes[0] + 2 * (slopes[1] + slopes[2]) + slopes[3])

    return advance


def on(rate: Callable[..., Any], **wrong: Any) -> Callable[..., Any]:
    """RK4 as step(x, v, t, dt)."""
    advance = rk4_of(lambda t, y: np.array(rate(t, *y)), **wrong)
    return lambda x, v, t, dt: tuple(advance(np.array([x, v]), t, dt).tolist())


def springs(t, x, v):
    return v, -15 * x - 0.1 * v


def driven(t, x, v):
    return v, -4 * x - 0.3 * v + cos(2 * t)


def hunters(t, x, v):
    return 1.1 * x - 0.4 * x * v, 0.1 * x * v - 0.4 * v


def falling(t, x, v):
    return v, -9.81 - 0.2 * v * abs(v)


def rubbing(t, x, v):
    return v, -4 * x - 0.5 * np.sign(v)


def circuit(t, x, v):
    """Of 1 mH, 1 µF and 10 ohms."""
    return (1.0 - 10 * x - v) / 1e-3, x / 1e-6


def leapfrog(kicks=(0.5, 0.5)):
    def step(x, v, dt):
        v = v - kicks[0] * dt * 9.81 * sin(x)
        x = x + dt * v
        return x, v - kicks[1] * dt * 9.81 * sin(x)

    return step


def backward(x, v, dt):
    rows = np.array([[1, -dt], [15 * dt, 1 + 0.1 * dt]])
    return tuple(np.linalg.solve(rows, [x, v]).tolist())


def dragged(x, v, dt):
    v = v - dt * (15 * x + 0.1 * v)
    return x + dt * v, v


def attracted(x, v, dt):
    """The midpoint rule of x'' = -1/x^2, which has no slope in 0."""
    rate = lambda y: np.array([y[1], -1 / y[0] ** 2])
    y = np.array([x, v])
    return tuple((y + dt * rate(y + dt / 2 * rate(y))).tolist())


class Lorenz:
    """Three numbers, of which a wrapper for two sets the first two."""

    def __init__(self, of: int = 3) -> None:
        self.state, self.dt, self.advance = np.ones(3), 0.01, rk4_of(self.rate, of=of)

    def rate(self, t: float, y: Any) -> Any:
        x, v, z = y
        return np.array([10 * (v - x), x * (28 - z) - v, x * v - 8 / 3 * z])

    def step(self) -> None:
        self.state = self.advance(self.state, 0.0, self.dt)


def lorenz(of=3):
    advance = rk4_of(Lorenz().rate, of=of)
    return lambda s, dt: advance(s, 0.0, dt)


def heat(part=1.0):
    """Euler's method between two ends at which nothing moves."""

    def step(u, dt):
        slopes = np.zeros_like(u)
        slopes[1:-1] = u[2:] - 2 * u[1:-1] + u[:-2]
        return u + part * dt * slopes * (1 + 50 * (part != 1) * dt)

    return step


def attraction(pos, mass):
    apart = pos[None] - pos[:, None]
    return (apart * ((apart**2).sum(-1) + 1e-4)[..., None] ** -1.5 * mass[None, :, None]).sum(1)


def galaxy(stale=False, masses=1.0):
    def step(pos, vel, mass, dt):
        acc = attraction(pos, mass)
        vel = vel + 0.5 * dt * acc
        pos = pos + dt * vel
        return pos, vel + 0.5 * dt * (acc if stale else attraction(pos, mass**masses))

    return step


class Bodies:
    """Two in space, whose accelerations are kept from the last step."""

    def __init__(self, unit, kept):
        self.unit, self.kept, self.vel = unit, kept, np.zeros((2, 3))
        self.pos = np.array([[0.0, 0.0, 0.0], [unit, 0.5 * unit, 0.0]])
        self.acc = self.accelerations()

    def accelerations(self):
        return attraction(self.pos / self.unit, np.array([1.0, 0.25])) / self.unit**2

    def step(self, dt):
        self.vel = self.vel + dt / 2 * self.acc
        self.pos = self.pos + dt * self.vel
        acc = self.accelerations()
        self.vel = self.vel + dt / 2 * acc
        self.acc = self.kept(self, acc)


def bodies(kept=lambda made, acc: acc, unit=1.0, **how):
    return stepper_of(lambda: Bodies(unit, kept), position="pos", velocity="vel", **how)


def coupled(stale=False):
    """Two masses between three springs; one of them alone is on two springs."""
    springs = np.array([[2.0, -1.0], [-1.0, 2.0]])

    def step(x, v, dt):
        pull = -springs @ x
        v = v + dt / 2 * pull
        x = x + dt * v
        return x, v + dt / 2 * (pull if stale else -springs @ x)

    return step


def together(stale=False):
    """Two masses on one spring, whose difference moves as one of them alone does not."""

    def pull(x):
        apart = x[1] - x[0]
        return np.array([apart, -apart])

    def step(x, v, dt):
        first = pull(x)
        v = v + dt / 2 * first
        x = x + dt * v
        return x, v + dt / 2 * (first if stale else pull(x))

    return step


def galaxy_of_ones(stale=False):
    return lambda pos, vel, dt: galaxy(stale)(pos, vel, np.ones(len(pos)), dt)


def by_index(stale=False):
    """Bodies in space whose masses are asked for by number; a single body feels no force."""

    def pull(pos, mass):
        slopes = np.zeros_like(pos)
        for i in range(len(pos)):
            for j in range(len(pos)):
                if i != j:
                    apart = pos[j] - pos[i]
                    slopes[i] += mass[j] * apart / (apart @ apart + 0.01) ** 1.5
        return slopes

    def step(pos, vel, mass, dt):
        first = pull(pos, mass)
        vel = vel + dt / 2 * first
        pos = pos + dt * vel
        return pos, vel + dt / 2 * (first if stale else pull(pos, mass))

    return step


@dataclass
class Aged:
    x: float
    v: float
    elapsed: float = 0.0


def clocked(rate=driven, late=1.0, make=dict, clock="t"):
    """RK4 of a dict or a record that carries its clock."""
    advance = rk4_of(lambda t, y: np.array(rate(t, *y)), late=late)

    def step(state, dt):
        held = state if make is dict else vars(state)
        x, v = advance(np.array([held["x"], held["v"]]), held[clock], dt).tolist()
        return make(x=x, v=v, **{clock: held[clock] + dt})

    step.__annotations__ = {"state": make}
    return step


def with_its_path(x, v, s, dt):
    v = v - dt * 4 * x
    return x + dt * v, v, s + dt * v


def moved(made, h):
    made.dt = h
    made.step()


RIGHT = {
    "a fast circuit": (on(circuit), "rk4", "q' = -"),
    "a fall": (on(lambda t, x, v: (v, -9.81)), "rk4", "q' = v, v' = -9.81, a constant force"),
    "a weight on a spring": (on(lambda t, x, v: (v, -x - 9.81)), "rk4", "q' = v, v' = -q - 9.81"),
    "a spring with a drag": (on(springs), "rk4", "q' = v, v' = -15 q - 0.1 v"),
    "driven": (on(driven), "rk4", "q' = v, v' = -4 q - 0.3 v + 1 at t = 0"),
    "driven, with its clock in a dict": (clocked(), "rk4", "q' = v, v' = -4 q - 0.3 v + 1 at t = 0"),
    "driven after t = 0": (clocked(lambda t, x, v: (v, t * t - x)), "rk4", "another one"),
    "driven by a clock of no name": (clocked(make=Aged, clock="elapsed"), "rk4", "one of 3 numbers"),
    "a path beside": (with_its_path, "symplectic_euler", "on it are not known: 3 numbers are not as many positions as"),
    "not linear": (on(hunters), "rk4", "q' = 1.1 q, v' = -0.4 v near (0, 0)"),
    "not at rest": (on(falling), "rk4", "q' = v, v' = -9.81 near (0, 0)"),
    "not smooth": (on(rubbing), "rk4", "another one"),
    "a pendulum": (leapfrog(), "velocity_verlet", "q' = v, v' = -9.81 q near (0, 0)"),
    "implicit": (backward, "backward_euler", "q' = v, v' = -15 q - 0.1 v", SOLVED),
    "three numbers": (lorenz(), "rk4", "one of 3 numbers"),
    "a grid": (heat(), "forward_euler", "one of 4 numbers"),
    "three bodies": (galaxy(), "velocity_verlet", "one of 18 numbers"),
    "singular": (attracted, "midpoint2", "another one"),
    "a drag in a splitting": (
        dragged,
        "symplectic_euler",
        "v' = -15 q - 0.1 v: steps of symplectic_euler on it are not",
    ),
    "all numbers of an object": (stepper_of(Lorenz, state="state", advance=moved), "rk4", "one of 3 numbers"),
    "bodies of an object": (bodies(), "velocity_verlet", "one of 12 numbers"),
    "bodies made anew": (bodies(anew=True), "velocity_verlet", "one of 12 numbers"),
    "too slow to see": (
        bodies(unit=1e4),
        "velocity_verlet",
        "on it are not known: in a step of it slopes hardly change",
    ),
    "two coupled masses": (coupled(), "velocity_verlet", "one of 4 numbers"),
    "two bodies that attract": (together(), "velocity_verlet", "one of 4 numbers"),
    "one body or more": (galaxy_of_ones(), "velocity_verlet", "one of 18 numbers"),
    "bodies by mass[j]": (by_index(), "velocity_verlet", "one of 18 numbers"),
}
WRONG = {
    "a slope of a fast circuit": (on(circuit, of=2), "rk4", "where rk4 ends in"),
    "a slope of a spring": (on(springs, of=2), "rk4", "v' = -15 q - 0.1 v: a step of"),
    "h halved at the end": (on(hunters, last=0.5), "rk4", "where rk4 ends in"),
    "the time of the last slope": (on(driven, late=0.5), "rk4", "where rk4 ends in"),
    "the time of the last slope in a dict": (clocked(late=0.5), "rk4", "+ 1 at t = 0: a step of"),
    "the time of a slope of a record": (
        clocked(late=0.5, make=Aged, clock="elapsed"),
        "rk4",
        "of 3 numbers: a step of",
    ),
    "not smooth": (on(rubbing, last=0.5), "rk4", "where rk4 ends in"),
    "a slope of a fall": (on(falling, of=1), "rk4", "where rk4 ends in"),
    "one kick": (leapfrog((1.0, 0.0)), "velocity_verlet", "judging by one system only, it is symplectic_euler"),
    "implicit": (backward, "trapezoid", "is not trapezoid", SOLVED),
    "another method": (attracted, "heun2", "where heun2 ends in"),
    "of three numbers": (stepper_of(lambda: Lorenz(2), state="state", advance=moved), "rk4", "where rk4 ends in"),
    "a slope of three numbers": (lorenz(2), "rk4", "one of 3 numbers: a step of"),
    "a grid": (heat(0.5), "forward_euler", "one of 4 numbers: a step of"),
    "three bodies": (galaxy(True), "velocity_verlet", "one of 18 numbers: a step of"),
    "bodies of an object": (bodies(lambda made, acc: made.acc), "velocity_verlet", "of 12 numbers: a step of"),
    "bodies by another method": (bodies(), "symplectic_euler", "of 12 numbers: a step of"),
    "three masses": (galaxy(masses=0.5), "velocity_verlet", "one of 18 numbers: a step of"),
    "two coupled masses": (coupled(True), "velocity_verlet", "one of 4 numbers: a step of"),
    "two bodies that attract": (together(True), "velocity_verlet", "one of 4 numbers: a step of"),
    "one body or more": (galaxy_of_ones(True), "velocity_verlet", "one of 18 numbers: a step of"),
    "bodies by mass[j]": (by_index(True), "velocity_verlet", "one of 18 numbers: a step of"),
    "a drag per step": (lambda x, v, dt: (x + dt * v, 0.99 * v - 15 * dt * x), "forward_euler", "halving h doubles it"),
    "no slopes": (lambda x, v, dt: (x + dt * v, v - x), "forward_euler", "h is missing"),
    "q'' = -q": (on(lambda t, x, v: (v, -x), of=2), "rk4", "is not rk4"),
}


@pytest.mark.slow(keep=12)
@pytest.mark.parametrize("name", RIGHT)
def test_a_right_step_of_another_system_is_undecided_and_told_which_system_it_is(name):
    step, method, words, *options = RIGHT[name]
    report = verify(step, method, examples=50, isolate=False, **next(iter(options), {}))
    assert report.passed is None
    assert words in report.verdict
    if "on it are not" not in words:
        assert report.verdict.startswith(f"is {method} on its own system ({words}")
    assert "a right-hand side or a force among its arguments" in report.section("What would decide it").lines[0]


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize("name", WRONG)
def test_a_step_that_is_wrong_on_its_own_system_fails(name):
    step, method, words, *options = WRONG[name]
    report = verify(step, method, examples=50, isolate=False, **next(iter(options), {}))
    assert report.passed is False
    assert words in report.verdict


def test_a_right_step_with_the_system_as_an_argument_passes():
    assert verify(lambda f, t, y, h: rk4_of(lambda t, y: f(t, y))(y, t, h), "rk4", examples=50, isolate=False).passed


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    ("step", "answered", "words"),
    [
        (heat(), None, "one of 4 numbers: on it its steps are those of forward_euler"),
        (on(hunters), None, "v' = -0.4 v near (0, 0): on it its steps are those of rk4"),
        (bodies(), None, "one of 12 numbers: on it its steps are those of velocity_verlet"),
        (heat(0.5), None, "one of 4 numbers: verify shows more"),
        (galaxy(True), False, "one of 18 numbers, and on it its steps are those of no method"),
        (on(lambda t, x, v: (v, -9.81)), None, "a constant force: on it its steps are those of velocity_verlet"),
    ],
)
def test_identify_tells_which_system_is_built_in_and_whose_steps_it_takes_there(step, answered, words):
    report = identify(step, isolate=False)
    assert report.answered is answered
    assert words in report.verdict
    if "those of" in words and answered is None:
        assert f"--method {words.split()[-1]}" in report.section("What to do").lines[0]


class Thrown:
    """A body of a game in the plane, with a drag: per unit of time, or wrongly per step."""

    def __init__(self, per_step, swept=0.0):
        self.pos, self.vel, self.per_step, self.swept = np.zeros(2), np.array([3.0, 4.0]), per_step, swept

    def integrate(self, dt):
        drag = 0.0 if self.per_step else 0.1
        self.vel = self.vel + dt * (np.array([0.0, -9.81]) - drag * self.vel)
        self.vel = self.vel * (1 - self.per_step) + self.swept
        self.pos = self.pos + dt * self.vel


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ((0.0,), None),
        ((0.1,), "is not symplectic_euler: the area in phase space is multiplied by 0.9 in each step, however short"),
        ((0.0, 0.25), "is not symplectic_euler: h = 0 moves the state"),
    ],
)
def test_what_no_method_does_fails_though_the_system_is_not_seen(wrong, words):
    body = stepper_of(lambda: Thrown(*wrong), position="pos", velocity="vel", advance="integrate")
    report = verify(body, "symplectic_euler", isolate=False)
    assert report.passed is (None if words is None else False)
    assert report.verdict.startswith(words or "undecided whether it is symplectic_euler: its system is built in")
    assert (report.section("What would decide it") is None) is (words is not None)
