"""Steps whose force is one of position and velocity, in styles in use, right and wrong."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from driftproof.methods.catalogue import METHODS


def of_stages(key: str, velocity: Callable[[int, Any, Any], Any] = lambda i, stage, v: stage):
    """The step of a Runge-Kutta method on (x, v); stage i asks for the force at the velocity that is given for it."""
    method: Any = METHODS[key]
    a, b, c = [[float(x) for x in row] for row in method.a], [*map(float, method.b)], [*map(float, method.c)]

    def step(acc, x, v, t, dt):
        slopes: list[Any] = []
        for i, node in enumerate(c):
            x_i, v_i = (y + dt * sum(a[i][j] * k[n] for j, k in enumerate(slopes)) for n, y in enumerate((x, v)))
            slopes.append((v_i, acc(x_i, velocity(i, v_i, v), t + node * dt)))
        return tuple(y + dt * sum(w * k[n] for w, k in zip(b, slopes, strict=True)) for n, y in enumerate((x, v)))

    return step


def verlet(given: Callable[[Any, Any, float], Any], last: float = 1.0):
    """Velocity Verlet that asks for its second force at the velocity given(v, a, dt), at the time t + last dt."""

    def step(force, x, v, t, dt):
        a = force(x, v, t)
        x = x + dt * v + dt * dt / 2 * a
        return x, v + dt / 2 * (a + force(x, given(v, a, dt), t + last * dt))

    return step


def gaffer(x, v, a, dt):
    """The recipe of rk4 whose acceleration is asked with the time since the start of the step."""
    a1 = a(x, v, 0)
    v2 = v + 0.5 * a1 * dt
    a2 = a(x + 0.5 * v * dt, v2, dt / 2)
    v3 = v + 0.5 * a2 * dt
    a3 = a(x + 0.5 * v2 * dt, v3, dt / 2)
    v4 = v + a3 * dt
    a4 = a(x + v3 * dt, v4, dt)
    return x + dt / 6 * (v + 2 * v2 + 2 * v3 + v4), v + dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


def semi_implicit(force, x, v, h):
    """Symplectic Euler, the force being asked before anything moves."""
    v = v + h * force(x, v)
    return x + h * v, v


def position_first(force, x, v, h):
    """Symplectic Euler with the position first."""
    x = x + h * v
    return x, v + h * force(x, v)


def velocity_before_position(force, pos, vel, dt):
    """Forward Euler of a force(v, x) that is told by its arguments alone."""
    return pos + dt * vel, vel + dt * force(vel, pos)


def time_before_both(force, t, x, v, h):
    """The midpoint rule of a force(t, x, v)."""
    x2, v2 = x + h / 2 * v, v + h / 2 * force(t, x, v)
    return x + h * v2, v + h * force(t + h / 2, x2, v2)


def with_mass(force, x, v, m, dt):
    """Heun's method, the force divided by the mass."""
    a = force(x, v) / m
    v2 = v + dt * a
    return x + dt / 2 * (v + v2), v + dt / 2 * (a + force(x + dt * v, v2) / m)


def in_arrays(accel, pos, vel, dt):
    """Velocity Verlet with a predicted velocity, of arrays, each written into anew."""
    a = np.asarray(accel(pos, vel))
    new = np.array(pos) + dt * np.array(vel) + 0.5 * dt**2 * a
    return new, np.array(vel) + 0.5 * dt * (a + np.asarray(accel(new, vel + dt * a)))


def with_parameters(more: tuple[Any, ...], *, moving: bool = False):
    """Symplectic Euler whose force is given more than it is asked for here, a velocity among it or none."""

    def step(force, x, v, dt):
        v = v + dt * (force(x, v, *more) if moving else force(x, *more))
        return x + dt * v, v

    return step


def carrying(force, x, v, a, dt):
    """Velocity Verlet that is handed its acceleration, and predicts the velocity."""
    x = x + dt * v + dt * dt / 2 * a
    new = force(x, v + dt * a)
    return x, v + dt / 2 * (a + new), new


def drifting(force, x, v, h):
    """Position Verlet, the force in the middle being asked at the velocity of the start."""
    x = x + h / 2 * v
    v = v + h * force(x, v)
    return x + h / 2 * v, v


def drifting_predicted(force, x, v, h):
    """Position Verlet whose force in the middle is asked at a velocity that is predicted to be there."""
    middle = x + h / 2 * v
    v1 = v + h * force(middle, v + h / 2 * force(x, v))
    return middle + h / 2 * v1, v1


def kicks_of_half(force, x, v, h):
    """Leapfrog of kicks and drifts, the second kick at the velocity after the first one."""
    v = v + h / 2 * force(x, v)
    x = x + h * v
    return x, v + h / 2 * force(x, v)


def composed(force, x, v, h):
    """Yoshida's three leapfrogs, in each of which kicks ask for the velocities that there are."""
    w1 = 1 / (2 - 2 ** (1 / 3))
    for w in (w1, 1 - 2 * w1, w1):
        x, v = kicks_of_half(force, x, v, w * h)
    return x, v


VV, PV = "velocity_verlet", "position_verlet"
RIGHT = [
    *((of_stages(key), key) for key in ("forward_euler", "heun2", "midpoint2", "kutta3", "ssprk33", "rk4", "rk38")),
    (verlet(lambda v, a, dt: v + dt * a), VV), (gaffer, "rk4"), (semi_implicit, "symplectic_euler"),
    (position_first, "symplectic_euler_position_first"), (velocity_before_position, "forward_euler"),
    (time_before_both, "midpoint2"), (with_mass, "heun2"), (in_arrays, VV), (drifting_predicted, PV), (carrying, VV),
    *((with_parameters(more), "symplectic_euler") for more in ((None,), ({"k": 1.0},), (1.0,), (0.75,), (2.0, 1.0))),
    *((with_parameters(more, moving=True), "symplectic_euler") for more in ((), ({"k": 1.0},), (0.0, None), (2.0,))),
]  # fmt: skip
# With the words of the verdict that name the mistake.
_STALE = "order 1 where the force depends on the velocity, not {}: call {}"
WRONG = [
    (verlet(lambda v, a, dt: v + dt / 2 * a), VV, "the position of t + h and the velocity v + 1/2 h F[0]"),
    (verlet(lambda v, a, dt: v), VV, "the position of t + h and the velocity v"),
    (verlet(lambda v, a, dt: v + 2 * dt * a), VV, "the velocity v + 2 h F[0]"),
    (verlet(lambda v, a, dt: v - dt * a), VV, "the velocity v - h F[0]"),
    (verlet(lambda v, a, dt: v + a), VV, "order 0 is observed on a nonlinear q'' = F(t, q, v)"),
    (verlet(lambda v, a, dt: v + dt * a, last=0.0), VV, "called at wrong times"),
    (kicks_of_half, VV, _STALE.format(2, 1)), (drifting, PV, _STALE.format(2, 0)),
    (composed, "yoshida4", "order 1 where the force depends on the velocity, not 4"),
    (of_stages("rk4", lambda i, stage, v: v), "rk4", "the velocity of call 1 holds F[0]: 0 instead of 1/2"),
    (of_stages("rk4", lambda i, stage, v: v if i == 3 else stage), "rk4", "the velocity of call 3 holds F[2]: 0"),
    (of_stages("midpoint2", lambda i, stage, v: v), "midpoint2", "the velocity of call 1 holds F[0]: 0"),
    (of_stages("heun2", lambda i, stage, v: (stage + v) / 2), "heun2", "velocity of call 1 holds F[0]: 1/2 instead"),
    (of_stages("kutta3", lambda i, stage, v: v + (stage - v) * (1 if i < 2 else 2)), "kutta3", "velocity of call 2"),
]  # fmt: skip
