"""Steps with a system built in are held to the system that they should have."""

import re

import numpy as np
import pytest

from driftproof import Allowance, Domain, assert_verified, stepper_of, verify
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from tests.looping import exactly

EXACT = Allowance(solver_tolerance=1e-12)


def companion(i, u, dt, R=0.5, L=0.1, C=0.2, source=1.0, share=2):
    """A coil, a resistance and a capacitor in series, the trapezoidal rule solved by hand."""
    g, r = dt / (share * L), dt / (2 * C)
    past, held = i + g * (source - R * i - u), u + r * i
    i = (past + g * (source - held)) / (1 + g * (R + r))
    return i, held + r * i


def with_a_whole_step(i, u, dt):
    return companion(i, u, dt, share=1)


def circuit(t, y):
    i, u = y
    return (1.0 - 0.5 * i - u) / 0.1, i / 0.2


def test_a_circuit_with_a_wrong_constant_is_another_circuit_only_if_it_is_said_which_is_meant():
    assert_verified(companion, "trapezoid", system=circuit, allowance=EXACT)
    with pytest.raises(AssertionError, match=r"is not the one given: from .* times h, and the system given as "):
        assert_verified(with_a_whole_step, "trapezoid", system=circuit, allowance=EXACT)
    assert verify(with_a_whole_step, "trapezoid", allowance=EXACT, isolate=False).passed is None
    with pytest.raises(AssertionError, match="companion\n  undecided: is trapezoid on its own system"):
        assert_verified(companion, "trapezoid", allowance=EXACT, isolate=False)
    found = verify(companion, "backward_euler", system=circuit, allowance=EXACT, isolate=False)
    assert "is backward_euler with one mistake: a[0][0]: 1/2 instead of 1; a step of " in found.verdict


class Body:
    drag = 0.1

    def __init__(self):
        self.pos, self.vel = np.zeros(2), np.array([3.0, 4.0])

    def integrate(self, dt):
        self.vel = self.vel + dt * (np.array([0.0, -9.81]) - self.drag * self.vel)
        self.pos = self.pos + dt * self.vel


class DampedPerStep(Body):
    def integrate(self, dt):
        self.vel = (self.vel + dt * np.array([0.0, -9.81])) * (1 - self.drag)
        self.pos = self.pos + dt * self.vel


class Mixed(Body):
    def integrate(self, dt):
        vel = self.vel + dt * (np.array([0.0, -9.81]) - self.drag * self.vel)
        self.pos, self.vel = self.pos + dt * np.array([self.vel[0], vel[1]]), vel


class Implicit(Body):
    def integrate(self, dt):
        self.vel = (self.vel + dt * np.array([0.0, -9.81])) / (1 + dt * self.drag)
        self.pos = self.pos + dt * self.vel


class DragLast(Body):
    def integrate(self, dt):
        self.vel = self.vel + dt * np.array([0.0, -9.81])
        self.pos = self.pos + dt * self.vel
        self.vel = self.vel * (1 - dt * self.drag)


class Predicted(Body):
    def integrate(self, dt, moved=0.5):
        force = lambda v: np.array([0.0, -9.81]) - self.drag * v
        a = force(self.vel)
        self.pos = self.pos + dt * self.vel + moved * dt**2 * a
        self.vel = self.vel + dt / 2 * (a + force(self.vel + dt * a))


class TooFar(Predicted):
    def integrate(self, dt):
        super().integrate(dt, 1.0)


def falling(y):
    return [*y[2:], *(np.array([0.0, -9.81]) - 0.1 * y[2:])]


ASKED = "on the system given, its force asked with the velocity "


@pytest.mark.parametrize(("cls", "method", "passed", "said"), [
    (Body, "symplectic_euler", True, f"{ASKED}before each kick, to "),
    (DampedPerStep, "symplectic_euler", False, "its system is not the one given"),
    (Mixed, "symplectic_euler", False, "whatever velocities its force is asked with, from ("),
    (Implicit, "symplectic_euler", True, f"{ASKED}before each kick but the last, and there with that after it, to "),
    (DragLast, "symplectic_euler", None, "with that before each kick a step of "),
    (Predicted, "velocity_verlet", True, f"{ASKED}that the first force predicts for each kick, to "),
    (TooFar, "velocity_verlet", False, "positions move by h v + h**2 ("),
])  # fmt: skip
def test_a_body_with_a_drag_is_judged_by_usual_readings_and_refuted_where_none_fits(cls, method, passed, said):
    step = stepper_of(cls, position="pos", velocity="vel", advance="integrate")
    found = verify(step, method, system=falling, isolate=False)
    assert found.passed is passed
    assert said in found.verdict
    assert ("a step that takes its force" in found.text()) is (passed is None)


def test_numbers_besides_positions_and_velocities_are_to_be_left_out():
    step = lambda x, v, d, h: (x + h * (v - h * x), v - h * x, d + h * abs(v))
    found = verify(step, "symplectic_euler", system=lambda y: [y[1], -y[0], abs(y[1])], isolate=False)
    assert found.passed is None
    assert "returns positions and velocities alone" in found.text()


class Thrown:
    """Heun's method with a drag whose speed is that of the step's start if `stale`."""

    stale = False

    def __init__(self):
        self.state = np.array([0.0, 0.0, 3.0, 4.0])

    def f(self, s):
        speed = self.speed if self.stale else np.hypot(*s[2:])
        return np.array([*s[2:], *-speed * s[2:]])

    def step(self, dt):
        self.speed = np.hypot(*self.state[2:])
        k1 = self.f(self.state)
        self.state = self.state + dt / 2 * (k1 + self.f(self.state + dt * k1))


class Stale(Thrown):
    stale = True


class Driven:
    """The midpoint rule with a clock that is set forward after a step, or before its last stage."""

    stale = False

    def __init__(self):
        self.t = self.v = 0.0

    def advance(self, dt):
        k1 = np.sin(2 * self.t) - self.v
        self.v = self.v + dt * (np.sin(2 * self.t + dt * (not self.stale)) - self.v - dt / 2 * k1)
        self.t += dt


class Early(Driven):
    stale = True


class DrivenSpring:
    """Heun's method on an array, with a clock that is set forward after a step, or before its slopes."""

    stale = False

    def __init__(self):
        self.t, self.y = 0.0, np.array([1.0, 0.0])

    def update(self, dt):
        self.t += dt * self.stale
        k1 = swinging(self.t, self.y)
        self.y = self.y + dt / 2 * (k1 + swinging(self.t + dt * (not self.stale), self.y + dt * k1))
        self.t += dt * (not self.stale)


class Hasty(DrivenSpring):
    stale = True


class Carrying:
    """Velocity Verlet of an object made in a state, whose force goes with it; or keeps the one that it began with."""

    stale = False

    def __init__(self, x, v, dt):
        self.x, self.v, self.dt, self.force = np.array(x, float), np.array(v, float), dt, -np.sin(x)

    def update(self):
        half = self.v + self.dt / 2 * self.force
        self.x = self.x + self.dt * half
        self.v = half - self.dt / 2 * np.sin(self.x)
        if not self.stale:
            self.force = -np.sin(self.x)


class Kept(Carrying):
    stale = True


def swinging(t, y):
    return np.array([y[1], np.cos(t) - np.sin(y[0])])


@pytest.mark.parametrize(("cls", "method", "system", "line"), [
    (DrivenSpring, "heun2", swinging, "def wrapped(t, y, h): made = {}(); made.t = t; made.y = 1.0 * y; made."),
    (Thrown, "heun2", lambda y: [*y[2:], *-np.hypot(*y[2:]) * y[2:]], 'stepper_of({}, state="state", advance="step")'),
    (Driven, "midpoint2", lambda t, y: [np.sin(2 * t) - y[0]], "def wrapped(t, y, h): import numpy; made = {}(); "),
    (Carrying, "velocity_verlet", lambda y: [y[1], -np.sin(y[0])], "def wrapped(q, v, h, n): made = {}(1.0 * q, "),
])  # fmt: skip
def test_a_wrapper_that_is_shown_beside_a_system_keeps_that_of_the_code(cls, method, system, line):
    for each in exactly(2, (cls, *cls.__subclasses__())):
        with pytest.raises(ValueError, match=re.escape(line.format(each.__name__))) as shown:
            verify(each, method, system=system, isolate=False)
        exec(str(shown.value).partition("write: ")[2], known := {**globals()})
        assert verify(known["wrapped"], method, system=system, isolate=False).passed is not each.stale
        assert verify(known["wrapped"], method, isolate=False).passed is (False if each.stale else None)


@pytest.mark.parametrize(("system", "said"), [
    (lambda t, y: y[:1], "has 1 slopes where a step has 2 numbers"), (lambda t, y: y[4], "given raises IndexError"),
    (lambda y, k: -k * y, "the system given takes k, which is no parameter of the step"),
    (lambda t, y: y * np.nan, "the system given is not finite there"),
])  # fmt: skip
def test_a_system_that_is_none_of_the_steps_is_wrong_input(system, said):
    with pytest.raises(ValueError, match=said):
        verify(companion, "trapezoid", system=system, allowance=EXACT, isolate=False)


def test_a_system_is_for_a_step_of_one_method_that_takes_none():
    assert verify(lambda q, v, h: (q + h * v, v - h * q), "forward_euler", system=lambda y: [y[1], -y[0]]).passed
    with pytest.raises(ValueError, match="takes its right-hand side: give a step that keeps"):
        verify(lambda f, t, y, h: y + h * f(t, y), "forward_euler", system=circuit, isolate=False)
    with pytest.raises(ValueError, match="bdf2 is no method of one step"):
        verify(companion, "bdf2", system=circuit)


@pytest.mark.parametrize(("option", "name"), [
    ({"examples": 9}, "examples=9"), ({"domain": Domain(smallest_step=0.0)}, "smallest_step=0.0"),
    ({"allowance": Allowance(flush_to_zero=True)}, "flush_to_zero=True"),
])  # fmt: skip
def test_what_has_no_effect_with_a_system_is_refused(option, name):
    with pytest.raises(ValueError, match=f"{name} has no effect with a system"):
        verify(lambda y, h: y - h * y, "forward_euler", system=circuit, **option)


def test_where_slopes_do_not_change_no_method_shows():
    for change, longer in ((0.0, ""), (1e-7, "; write --largest-step 1024, in Python domain=Domain(1024)")):
        step = lambda x, y, h, change=change: (x + h, y + h * (2 + change * x + change * h / 2))
        found = verify(step, "rk4", system=lambda t, y, x=change: [1.0, 2 + x * y[0]], isolate=False)
        assert found.passed is None
        assert f"steps of rk4 on it are not known: in a step of it slopes hardly change{longer}" in found.text()


def in_plane(x):
    """The accelerations of bodies in rows of a plane, each drawn to the next."""
    pulls = np.diff(x, axis=0) * (1 + x[:-1] ** 2)
    found = np.zeros_like(x)
    found[:-1] += pulls
    found[1:] -= pulls
    return found


@pytest.mark.parametrize("last", [0.5, 1.0])
def test_bodies_in_a_plane_are_tried_where_the_system_takes_none_in_space(last):
    def moved(dt, x, v):
        v += dt / 2 * in_plane(x)
        x += dt * v
        v += last * dt * in_plane(x)

    def system(y):
        q, v = np.reshape(y, (2, -1, 2))
        return [*v.ravel(), *in_plane(q).ravel()]

    found = verify(moved, "velocity_verlet", system=lambda y: system(y) if len(y) == 12 else 1 / 0, isolate=False)
    assert (found.passed, "in 12 numbers" in found.verdict) == (last == 0.5, last == 0.5), found.verdict


def test_a_method_of_the_same_order_that_it_is_instead_is_named():
    spring = lambda y: [y[1], -y[0] - y[0] ** 3]
    moved = stepper(METHODS["forest_ruth"], float)
    step = lambda q, v, h: moved(lambda x: -x - x**3, q, v, h)
    found = verify(step, "yoshida4", system=spring, isolate=False)
    assert (found.passed, found.verdict.endswith("; on it its steps are those of forest_ruth")) == (False, True)
