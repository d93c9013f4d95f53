"""Steps of a dataclass, a dict or an object, with a force or without, are opened as they are written."""

from dataclasses import dataclass
from typing import TypedDict

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.states.records import record_forms
from tests.looping import exactly


@dataclass(slots=True)
class Slotted:
    q: float
    v: float


def moved(q, v, h):
    return Slotted(q + h * v, v - h * (q + h * v))


def returned(state: Slotted, h):
    return moved(state.q, state.v, h)


def in_place(state: Slotted, h):
    new = moved(state.q, state.v, h)
    state.q, state.v = new.q, new.v


def of_a_particle(p: Slotted, h):
    return returned(p, h)


@pytest.mark.parametrize("step", [moved, returned, in_place, of_a_particle])
def test_a_dataclass_with_slots_is_a_state_as_well(step):
    assert opened(step).step(1.0, 0.5, 0.25) == (1.125, 0.21875)


@dataclass
class State:
    x: float
    v: float
    m: float = 1.0
    t: float = 0.0


@dataclass(frozen=True)
class Phase:
    q: float
    p: float
    t: float = 0.0


@dataclass
class Slopes:
    dx: float = 0.0
    dv: float = 0.0


def slopes(state, t, dt, before, acceleration):
    moved = State(state.x + dt * before.dx, state.v + dt * before.dv)
    return Slopes(moved.v, acceleration(moved, t + dt))


def integrate(state, t, dt, acceleration, last=1 / 6):
    """Classical RK4 as games write it, in place."""
    a = slopes(state, t, 0.0, Slopes(), acceleration)
    b = slopes(state, t, dt / 2, a, acceleration)
    c = slopes(state, t, dt / 2, b, acceleration)
    d = slopes(state, t, dt, c, acceleration)
    state.x += dt * (a.dx / 6 + b.dx / 3 + c.dx / 3 + last * d.dx)
    state.v += dt * (a.dv / 6 + b.dv / 3 + c.dv / 3 + last * d.dv)


def integrate_wrongly(state, t, dt, acceleration):
    integrate(state, t, dt, acceleration, last=1 / 3)


def verlet_of_a_dict(particle, force, dt):
    particle["vel"] += dt / 2 * force(particle["pos"])
    particle["pos"] += dt * particle["vel"]
    particle["vel"] += dt / 2 * force(particle["pos"])


def euler_of_a_dict(state, t, dt, rhs):
    rate = rhs(state, t)
    return {"x": state["x"] + dt * rate["x"], "v": state["v"] + dt * rate["v"]}


def kick_and_drift(state: Phase, grad_U, eps: float) -> Phase:
    p = state.p - eps * grad_U(state.q)
    return Phase(state.q + eps * p, p, state.t + eps)


def divided(body, force, dt=0.01):
    body.v += dt * force(body.x) / body.m
    body.x += dt * body.v


def undivided(body, force, dt):
    body.v += dt * force(body.x)
    body.x += dt * body.v * body.m / body.m


def accelerated(body, acc, dt):
    undivided(body, acc, dt)


class Named(TypedDict):
    position: float
    velocity: float


def of_a_named_dict(p: Named, force, dt):
    v = p["velocity"] + dt * force(p["position"])
    return Named(position=p["position"] + dt * v, velocity=v)


def without_a_force(sim, dt):
    sim["v"] = sim["v"] - dt * sim["x"]
    sim["x"] = sim["x"] + dt * sim["v"]
    sim["t"] += dt


@dataclass(frozen=True)
class WithSlope:
    position: float
    momentum: float
    grad: float


def with_its_gradient(state: WithSlope, grad_U, eps, kept=False):
    p = state.momentum - eps / 2 * state.grad
    q = state.position + eps * p
    grad = grad_U(q)
    return WithSlope(q, p - eps / 2 * grad, state.grad if kept else grad)


def with_an_old_gradient(state: WithSlope, grad_U, eps):
    return with_its_gradient(state, grad_U, eps, kept=True)


@dataclass
class Accelerated:
    x: float
    v: float
    acc: float = 0.0


def with_its_acceleration(body: Accelerated, force, dt):
    """A record whose acceleration has a default, which no step should begin with."""
    v = body.v + dt / 2 * body.acc
    x = body.x + dt * v
    acc = force(x)
    return Accelerated(x, v + dt / 2 * acc, acc)


def with_a_slope_for_show(body: Accelerated, force, dt):
    """What is not read may be old."""
    acc = force(body.x)
    v = body.v + dt * acc
    return Accelerated(body.x + dt * v, v, acc)


def with_a_sum_of_forces(body: Accelerated, force, dt):
    body.acc += force(body.x)
    body.v += dt * body.acc
    body.x, body.acc = body.x + dt * body.v, 0.0


def of_a_pair(*, h, state, force):
    q, v = state
    v = v + h * force(q)
    return q + h * v, v


def of_a_pair_wrongly(*, h, state, force):
    q, v = state
    return q + h * v, v + h / 2 * force(q)


HELD = [
    (with_its_gradient, "velocity_verlet", ""), (with_its_acceleration, "velocity_verlet", ""),
    (with_an_old_gradient, "velocity_verlet", "it passes on -1 as the slope at its end, not -1.15625"),
    (with_a_slope_for_show, "symplectic_euler", ""), (with_a_sum_of_forces, "symplectic_euler", ""),
    (of_a_pair, "symplectic_euler", ""), (of_a_pair_wrongly, "symplectic_euler", "1/2 instead of 1"),
    (of_a_named_dict, "symplectic_euler", ""), (without_a_force, "symplectic_euler", ""),
    (integrate, "rk4", ""), (integrate_wrongly, "rk4", "b[3]: 1/3 instead of 1/6"),
    (verlet_of_a_dict, "velocity_verlet", ""), (euler_of_a_dict, "forward_euler", ""),
    (kick_and_drift, "symplectic_euler", ""), (divided, "symplectic_euler", ""),
    (undivided, "symplectic_euler", "kick 0: 2 instead of 1"), (accelerated, "symplectic_euler", ""),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "key", "wrong"), HELD, ids=[step.__name__ for step, _, _ in HELD])
def test_a_step_of_a_record_is_opened_as_it_is_written_and_a_wrong_one_is_caught(step, key, wrong):
    found = verify(step, key, examples=50, isolate=False)
    assert found.passed is not bool(wrong), found.text
    assert wrong in found.verdict


class Plain:
    """A record of plain Python, whose fields nothing but its use tells."""

    def __init__(self, pos, vel, acc):
        self.pos, self.vel, self.acc = pos, vel, acc


def of_a_plain_object(body, dt, *, stale=False):
    vel = body.vel + dt / 2 * body.acc
    pos = body.pos + dt * vel
    acc = -np.sin(body.pos if stale else pos)
    return Plain(pos, vel + dt / 2 * acc, acc)


def test_a_plain_object_that_hands_on_its_acceleration_is_a_record_and_a_stale_one_is_told():
    pendulum = lambda t, y: [y[1], -np.sin(y[0])]
    assert verify(of_a_plain_object, "velocity_verlet", system=pendulum, isolate=False).passed
    late = lambda body, dt: of_a_plain_object(body, dt, stale=True)
    found = verify(late, "velocity_verlet", system=pendulum, isolate=False)
    assert not found.passed
    assert "hands on as that at its end is that of where its step began" in found.verdict


def test_the_force_sees_the_record_as_it_is_and_the_time_and_a_step_with_other_arguments_has_no_form():
    seen = []
    (form,) = exactly(1, [*record_forms(integrate)][:1])
    form(lambda *asked: seen.append(asked) or -asked[0], 1.0, 0.5, 8.0, 0.5)
    assert seen[:2] == [(1.0, 0.5, 8.0), (1.125, 0.25, 8.25)]
    assert [*record_forms(lambda state, force, mesh, dt: state)] == []
    assert [*record_forms(lambda state, force: state)] == [*record_forms(lambda state, force, h: state)] == []
    assert [*record_forms(lambda sim, mesh, h: sim)] == [*record_forms(lambda sim, h: sim)] == []


def test_a_step_whose_state_cannot_be_made_is_no_wrong_step_but_asks_for_another_one():
    with pytest.raises(ValueError, match=r"asks what it is given for \.swirl, .*; write a step\(f, t, y, h\), or"):
        opened(lambda state, force, dt: state.swirl)


@dataclass
class Cell:
    """A battery: its charge, a voltage and a clock."""

    soc: float
    v1: float
    t: float = 0.0


class Bath:
    """A temperature, which is no time, between two others."""

    def __init__(self, t, inner, outer):
        self.t, self.inner, self.outer = t, inner, outer


def loaded(t, y):
    return np.array([-(0.5 + 0.25 * t) / 3, 0.5 + 0.25 * t - y[1] / 2])


def cooled(y):
    return np.array([y[1] - y[0], y[0] + y[2] - 2 * y[1], y[1] * y[1] - y[2]])


def heun_of_a_cell(state: Cell, dt, late=1.0):
    y = np.array([state.soc, state.v1])
    k1 = loaded(state.t, y)
    return Cell(*(y + dt / 2 * (k1 + loaded(state.t + late * dt, y + dt * k1))).tolist(), state.t + dt)


def heun_of_a_bath(state, dt, late=1.0):
    y = np.array([state.t, state.inner, state.outer])
    k1 = cooled(y)
    return Bath(*(y + dt / 2 * (k1 + cooled(y + late * dt * k1))).tolist())


@pytest.mark.parametrize(("step", "system"), [(heun_of_a_cell, loaded), (heun_of_a_bath, cooled)])
def test_records_of_any_names_are_held_to_the_system_given_with_their_clocks(step, system):
    assert verify(step, "heun2", system=system, isolate=False).passed
    assert verify(lambda state, dt: step(state, dt, 0.0), "heun2", system=system, isolate=False).passed is False


class Held:
    """Made from an object whose attributes are its own: another form of a call must not be blamed for what it lacks."""

    def __init__(self, atoms, force_fn, timestep):
        self.atoms, self.force_fn, self.dt = atoms, force_fn, timestep
        atoms.forces = force_fn(atoms.positions)

    def step(self):
        self.atoms.positions += self.dt * self.atoms.velocities


def test_a_form_that_cannot_be_given_what_it_asks_for_leaves_the_wrapper_to_be_shown():
    with pytest.raises(ValueError, match=r"Held\(ATOMS, force, 0\.1\), position="):
        opened(Held)


@dataclass
class Shot:
    x: float
    vx: float
    y: float
    vy: float


@pytest.mark.parametrize("declared", [False, True])
def test_a_record_has_its_declared_order_and_a_dict_that_is_changed_positions_first(declared):
    def thrown(s, dt):
        s["vx"] -= 0.4 * s["vx"] * dt
        s["vy"] -= 9.81 * dt
        s["x"] += s["vx"] * dt
        s["y"] += s["vy"] * dt
        return s

    def shot(s: Shot, dt: float) -> Shot:
        vx, vy = s.vx - 0.4 * s.vx * dt, s.vy - 9.81 * dt
        return Shot(s.x + vx * dt, vx, s.y + vy * dt, vy)

    pairs = lambda y: [y[1], -0.4 * y[1], y[3], -9.81]
    system = pairs if declared else lambda y: [y[2], y[3], -0.4 * y[2], -9.81]
    found = verify(shot if declared else thrown, "symplectic_euler", system=system, isolate=False)
    assert found.passed, found.verdict


@dataclass
class Swing:
    x: float
    v: float
    acc: float = 0.0


@pytest.mark.parametrize(("late", "said"), [
    (False, "is velocity_verlet on the system given"), (True, "is that of where its step began")
])  # fmt: skip
def test_an_acceleration_with_a_default_is_that_of_the_own_system_of_a_record(late, said):
    def moved(s: Swing, dt: float) -> Swing:
        v = s.v + dt / 2 * s.acc
        x = s.x + dt * v
        acc = -np.sin(s.x if late else x)
        return Swing(x, v + dt / 2 * acc, acc)

    found = verify(moved, "velocity_verlet", system=lambda y: [y[1], -np.sin(y[0])], isolate=False)
    assert (found.passed, said in found.verdict) == (not late, True), found.verdict
