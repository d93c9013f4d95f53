"""Steppers that write into arrays, as C is written, or move objects in a list: opened as they stand."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.judging.specification import Domain
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.states.plain_forms import plain_forms
from tests.blackbox.transcripts import Asked, summed


def springs(bodies, dt):
    for b in bodies:
        b.vel = b.vel - dt * b.pos
        b.pos = b.pos + dt * b.vel


def of_one_body(bodies, force, dt):
    for b in bodies:
        b.vel = b.vel + dt / 2 * force(b) / b.mass
        b.pos = b.pos + dt * b.vel
    for b in bodies:
        b.vel = b.vel + dt / 2 * force(b) / b.mass


def of_all_bodies(bodies, accelerations, dt):
    for b, a in zip(bodies, accelerations(bodies), strict=True):
        b.vel = b.vel + dt * a if not hasattr(b, "charge") else 0.0
    for b in bodies:
        b.pos = b.pos + dt * b.vel
    return bodies


def among_bodies(bodies, force, dt):
    for b in bodies:
        b.v += dt * force(b, bodies) / b.m
    for b in bodies:
        b.x += dt * b.v


def one_after_the_other(bodies, force, dt):
    """Wrong: the force on a body sees those before it where they have moved to."""
    for b in bodies:
        b.v += dt * force(b, bodies) / b.m
        b.x += dt * b.v


def mass_forgotten(bodies, force, dt):
    for b in bodies:
        b.vel = b.vel + dt * force(b)
    for b in bodies:
        b.pos = b.pos + dt * b.vel


def first_mass(pos, vel, mass, get_force, dt):
    vel += dt * get_force(pos) / mass[0]
    pos += dt * vel


def divided_again(bodies, accelerations, dt):
    for b, a in zip(bodies, accelerations(bodies), strict=True):
        b.v += dt * a / b.m
        b.x += dt * b.v


def one_by_one(q, v, m, force, h):
    for i in range(len(q)):
        v[i] += h * force(q[i]) / m[i]
        q[i] += h * v[i]


def in_space(particles, dt, force):
    for p in particles:
        p.v[[0, 1, 2]] += dt * force(p.r) / p.mass
        p.r += dt * p.v


def halves_of_y(y, n, h, out):
    for i in range(n // 2):
        out[n // 2 + i] = y[n // 2 + i] - h * y[i]
        out[i] = y[i] + h * out[n // 2 + i]


def carried(N, x, v, a, dt):
    for i in range(N):
        v[i] += 0.5 * dt * a[i]
        x[i] += dt * v[i]
    for i in range(N):
        a[i] = -x[i]
        v[i] += 0.5 * dt * a[i]


def recipe(y, dydx, n, x, h, yout, derivs):
    """Heun's third order method with the slope at the start given, and slopes written into an array."""
    place, slope = [0.0] * n, [0.0] * n
    for i in range(n):
        place[i] = y[i] + h / 3 * dydx[i]
    derivs(x + h / 3, place, slope)
    for i in range(n):
        place[i] = y[i] + 2 * h / 3 * slope[i]
    derivs(x + 2 * h / 3, place, slope)
    for i in range(n):
        yout[i] = y[i] + h / 4 * (dydx[i] + 3 * slope[i])


def estimated(y, dydx, n, x, h, yerr, yout, derivs, sign=1.0):
    """Heun's method with the slope at the start given, and an estimate of its error by a step of Euler's method."""
    slope = [0.0] * n
    derivs(x + h, [y[i] + h * dydx[i] for i in range(n)], slope)
    for i in range(n):
        yout[i] = y[i] + h / 2 * (dydx[i] + slope[i])
        yerr[i] = sign * h / 2 * (slope[i] - dydx[i])


def pushes_written(n, y, v, acc, dt, compute_acc):
    for i in range(n):
        v[i] += dt / 2 * acc[i]
        y[i] += dt * v[i]
    compute_acc(n, y, acc)
    for i in range(n):
        v[i] += dt / 2 * acc[i]


def stale_pushes(n, x, v, acc, dt, compute_acc):
    """Wrong: the second kick is made with the first force."""
    for i in range(n):
        x[i] += dt * (v[i] + dt / 2 * acc[i])
        v[i] += dt * acc[i]
    compute_acc(n, x, acc)


def of_forces(positions, velocities, forces, masses, dt, compute_forces, left=1.0):
    heavy = masses.reshape(-1, *[1] * (positions.ndim - 1))
    velocities += dt / 2 * forces / heavy
    positions += dt * velocities
    forces[:] = compute_forces(positions)
    velocities += dt / 2 * forces / heavy
    forces *= left


def wrongly_left(positions, velocities, forces, masses, dt, compute_forces):
    of_forces(positions, velocities, forces, masses, dt, compute_forces, 0.5)


def returned(positions, velocities, accelerations, masses, dt, get_force, first=False):
    positions = positions + dt * velocities + dt**2 / 2 * accelerations
    new = get_force(positions) / masses.reshape(-1, *[1] * (positions.ndim - 1))
    return positions, velocities + dt / 2 * (accelerations + new), accelerations if first else new


def galaxy(pos, vel, acc, dt, mass, get_acc, stale=False):
    vel = vel + acc * dt / 2.0
    pos = pos + vel * dt
    new = get_acc(pos, mass)
    return pos, vel + new * dt / 2.0, acc if stale else new


def kicked_twice(x, v, m, dt, accel):
    v = v + accel(x, m) * dt / 2
    x = x + v * dt
    return x, v + accel(x, m) * dt / 2


def two_arrays(q, p, h, q_out, p_out):
    for i in range(len(q)):
        p_out[i] = p[i] - h * q[i]
        q_out[i] = q[i] + h * p_out[i]


def force_last(x, v, f, n, dt, force, kick=1.0):
    force(x, f, n)
    for i in range(n):
        v[i] += kick * dt * f[i]
        x[i] += dt * v[i]


def down(step, kick=-1.0):
    return lambda q, p, n, h, compute_grad: step(q, p, np.zeros(n), n, h, compute_grad, kick)


HELD = [
    (springs, "symplectic_euler", ""), (of_one_body, "velocity_verlet", ""), (of_all_bodies, "symplectic_euler", ""),
    (among_bodies, "symplectic_euler", ""), (in_space, "symplectic_euler", ""), (halves_of_y, "symplectic_euler", ""),
    (carried, "velocity_verlet", ""), (recipe, "heun3", ""), (pushes_written, "velocity_verlet", ""),
    (lambda out, y, f, t, h: out.__setitem__(slice(None), y + h * f(t, y)), "forward_euler", ""),
    (two_arrays, "symplectic_euler", ""), (one_by_one, "symplectic_euler", ""),
    (first_mass, "symplectic_euler", "its coefficients agree, but on a nonlinear q'' = F(q) of 3 positions"),
    (divided_again, "symplectic_euler", "kick 0: 1/2 instead of 1"),
    (one_after_the_other, "symplectic_euler", "its coefficients agree, but on a nonlinear q'' = F(q) of 3 positions"),
    (mass_forgotten, "symplectic_euler", "kick 0: 2 instead of 1"),
    (stale_pushes, "velocity_verlet", "is not velocity_verlet"), (of_forces, "velocity_verlet", ""),
    (returned, "velocity_verlet", ""), (wrongly_left, "velocity_verlet", "with the forces that the first one left"),
    (lambda x, v, a, masses, dt, get_force: returned(x, v, a, masses, dt, get_force, True), "velocity_verlet",
     "a second step with the a that the first one left is not"),
    (lambda force, x, v, a, m, dt: returned(x, v, a, np.array(m), dt, force), "velocity_verlet", ""),
    (lambda force, x, v, a, m, dt: returned(x, v, a, np.array(m), dt, force, True), "velocity_verlet", "passes on -1"),
    (force_last, "symplectic_euler", ""), (down(force_last), "symplectic_euler", ""),
    (lambda x, v, n, dt, force: force_last(x, v, np.zeros(n), n, dt, force), "symplectic_euler", ""),
    (lambda x, v, a, n, dt, force: force_last(x, v, a, n, dt, force, 2.0), "symplectic_euler", "kick 0: 2 instead of"),
    (down(force_last, 1.0), "symplectic_euler", "kick 0: -1 instead of 1"),
    (lambda get_grad, q, p, h: (q + h * (p - h * get_grad(q)), p - h * get_grad(q)), "symplectic_euler", ""),
    (galaxy, "velocity_verlet", ""), (kicked_twice, "velocity_verlet", ""),
    (lambda pos, vel, acc, dt, mass, get_acc: galaxy(pos, vel, acc, dt, mass, get_acc, True), "velocity_verlet",
     "a second step with the acc that the first one left is not"),
    (lambda x, v, a, m, dt, acceleration: galaxy(x, v, a, dt, m, acceleration), "velocity_verlet", ""),
    (lambda x, v, a, m, dt, accel: galaxy(x, v, a, dt, m, accel, True), "velocity_verlet", "passes on -1"),
    (lambda x, v, m, dt, accel: kicked_twice(x, v, m, dt, lambda x, m: accel(x) / m), "velocity_verlet",
     "kicks times 1/2"),
    (estimated, "heun_euler21", ""),
    (lambda y, dydx, n, x, h, yerr, yout, derivs: estimated(y, dydx, n, x, h, yerr, yout, derivs, 2.0), "heun_euler21",
     "is heun_euler21, but the error estimate is 2 times that of heun_euler21"),
]  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "key", "wrong"), HELD, ids=range(len(HELD)))
def test_a_step_is_opened_as_it_is_written_and_a_wrong_one_is_caught(step, key, wrong, as_before):
    asked = Asked(step)
    found = verify(asked.code, key, examples=30, isolate=False)
    assert found.section("Parameters: not tested") is None
    as_before(*summed(found), asked)
    assert found.passed is not bool(wrong)
    assert wrong in found.verdict


def heun(part=0.5, timed=True, copied=None):
    """Heun's method for the first n numbers, in place as in C, or in a new array that is `copied`."""

    def step(n, t, y, h, f):
        k1, later = f(t, y), 1.0 * y
        for i in range(n):
            later[i] += h * k1[i]
        k2 = f(t + h, later)
        y = copied(y, n) if copied else y
        for i in range(n):
            y[i] += h * (part * k1[i] + (1 - part) * k2[i])
        return y if copied else None

    return step if timed else lambda n, y, h, f: step(n, 0.0, y, h, lambda t, y: f(y))


def each_step(f, t, y, h, n):
    for i in range(n):
        y += h * f(t + i * h, y)


COPIES = [lambda y, n: np.array(y[:n]), lambda y, n: y.copy(), lambda y, n: [*y]]  # the first n numbers, or all


@pytest.mark.parametrize("form", [{}, {"timed": False}, *({"copied": each} for each in COPIES)])
def test_n_is_the_number_of_numbers_where_a_step_of_one_leaves_the_others_as_they_are(form):
    assert "is heun2 to roundoff" in verify(heun(**form), "heun2", examples=30, isolate=False).verdict
    assert verify(heun(0.25, **form), "heun2", examples=30, isolate=False).passed is False
    assert verify(each_step, "forward_euler", examples=30, isolate=False).passed


def gravity(bodies, dt):
    for a in bodies:
        for b in bodies:
            if a is not b:
                a.vel = a.vel + dt * b.mass * (b.pos - a.pos) / np.linalg.norm(b.pos - a.pos) ** 3
    for a in bodies:
        a.pos = a.pos + dt * a.vel


def unknown(y, n, h, out, alpha):
    out[:] = y


@pytest.mark.slow
def test_bodies_that_attract_each_other_are_three_in_space():
    found = verify(gravity, "symplectic_euler", isolate=False, examples=30)
    assert found.passed is None
    assert "is symplectic_euler on its own system (one of 18 numbers)" in found.verdict
    assert verify(gravity, "symplectic_euler_position_first", isolate=False, examples=30).passed is False


def test_what_cannot_be_opened_so_is_refused_with_what_to_write_for_each_word():
    assert [*plain_forms(lambda q, v, h: (q, v))] == []
    assert [*plain_forms(unknown)] == [*plain_forms(lambda v, m, h: {})] == []
    with pytest.raises(ValueError, match=r"of your own: what moves its bodies is built in: let their force be"):
        opened(lambda bodies, dt: [body.charge for body in bodies])
    with pytest.raises(
        ValueError, match=r"a step that takes its right-hand side, which no argument is: def unknown\(f, y, h\)"
    ):
        opened(unknown)


def planets(typo="vy", after=False, pull=0.0):
    """Coordinates one by one: each planet on a spring of its own, or drawn to the others."""

    def step(planets, dt):
        def kicks(p):
            others = [(q.x - p.x, q.y - p.y, q.mass) for q in planets if q is not p] if pull else [(-p.x, -p.y, 1.0)]
            weights = [m / (pull + x * x + y * y) ** 1.5 if pull else m for x, y, m in others]
            return [sum(w * each[i] for w, each in zip(weights, others, strict=True)) for i in (0, 1)]

        known = [kicks(p) for p in planets]
        for p, before in zip(planets, known, strict=True):
            ax, ay = kicks(p) if after else before
            p.vx += ax * dt
            p.vy += ay * dt
            p.x += p.vx * dt
            p.y += getattr(p, typo) * dt

    return step


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    ("step", "passed", "words"),
    [
        (planets(), True, "is symplectic_euler on q'' = -q"),
        (planets(pull=0.01), None, "is symplectic_euler on its own system (one of 12 numbers)"),
        (planets(typo="vx"), False, "one of 12 numbers: a step of"),
        (planets(after=True, pull=0.01), False, "one of 12 numbers: a step of"),
    ],
    ids=["springs", "drawn", "mixed up", "one after the other"],
)
def test_coordinates_one_by_one_are_told_apart(step, passed, words):
    found = verify(step, "symplectic_euler", examples=30, isolate=False)
    assert found.passed is passed
    assert words in found.verdict


def in_work_arrays(neq, t, dt, y, func, k1, k2, ytmp, half=0.5):
    """Heun's method in arrays that it is given; it returns a status."""
    func(neq, t, y, k1)
    for i in range(neq):
        ytmp[i] = y[i] + dt * k1[i]
    func(neq, t + dt, ytmp, k2)
    for i in range(neq):
        y[i] += half * dt * (k1[i] + k2[i])
    return 0


def accelerations_of(pos, mass):
    apart = pos[None] - pos[:, None]
    return (apart * ((apart**2).sum(-1, keepdims=True) + 0.01) ** -1.5 * mass[None]).sum(1)


def carried(pos, vel, acc, mass, dt, stale=False):
    """Velocity Verlet of bodies in space, whose masses are a column; it is given its accelerations and returns them."""
    vel = vel + dt / 2 * acc
    pos, before = pos + dt * vel, pos
    acc = accelerations_of(before if stale else pos, mass)
    return pos, vel + dt / 2 * acc, acc


def carried_force(pos, vel, F, dt, stale=False):
    vel = vel + dt / 2 * F
    pos, before = pos + dt * vel, pos
    return pos, vel - dt / 2 * (before if stale else pos), -pos


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    ("step", "method", "words", "wrong"),
    [
        (in_work_arrays, "heun2", "to roundoff", {"half": 0.4}),
        (carried, "velocity_verlet", "on its own system (one of 18 numbers)", {"stale": True}),
        (carried_force, "velocity_verlet", "on q'' = -q to roundoff", {"stale": True}),
    ],
    ids=lambda x: getattr(x, "__name__", ""),
)
def test_work_arrays_and_carried_slopes_are_read_and_their_mistakes_fail(step, method, words, wrong):
    assert f"is {method} {words}" in verify(step, method, examples=30, isolate=False).verdict
    assert verify(partial(step, **wrong), method, examples=30, isolate=False).passed is False


@pytest.mark.parametrize("late", [0.5, 0.0])
def test_an_acceleration_may_be_a_number_that_a_step_takes(late):
    slopes = lambda y, delta, a: np.array([y[3] * np.cos(y[2]), y[3] * np.sin(y[2]), y[3] * np.tan(delta), a])

    def vehicle(state, delta, a, dt):
        _x, _y, _heading, _speed = state
        k1 = slopes(state, delta, a)
        return state + dt * slopes(state + late * dt * k1, delta, a)

    found = verify(vehicle, "midpoint2", system=slopes, isolate=False)
    assert (found.passed, "with delta = 1.25; a = 0.875" in found.verdict) == (late > 0, late > 0), found.verdict
    start = Domain(start="0,0,0.2,5")
    assert verify(vehicle, "midpoint2", system=slopes, domain=start, isolate=False).passed is (late > 0)
