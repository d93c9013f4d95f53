"""Steppers as people write them, by hand and in floats: witnesses for the probes, none of them a step of ours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from driftproof.methods.schemes import RungeKutta

Code = Callable[..., Any]


def euler(f, t, y, h):
    return y + h * f(t, y)


def rk4(f, t, y, h):
    k1 = f(t, y)
    k2 = f(t + h / 2, y + h * k1 / 2)
    k3 = f(t + h / 2, y + h * k2 / 2)
    k4 = f(t + h, y + h * k3)
    return y + h * (k1 + 2 * k2 + 2 * k3 + k4) / 6


def rk4_without_time(f, y, h):
    return rk4(lambda t, y: f(y), 0.0, y, h)


def rk4_on_a_stopped_clock(f, t, y, h):
    return rk4(lambda _, y: f(t, y), 0.0, y, h)


def rk4_in_lists(f, t, y, h):
    def moved(k, w):
        return [a + w * b for a, b in zip(y, k, strict=True)]

    k1 = f(t, y)
    k2 = f(t + 0.5 * h, moved(k1, 0.5 * h))
    k3 = f(t + 0.5 * h, moved(k2, 0.5 * h))
    k4 = f(t + h, moved(k3, h))
    return [a + h / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(y, k1, k2, k3, k4, strict=True)]


def rk4_of_one_number(f, t, y, h):
    return rk4(lambda t, y: float(f(t, y)), t, float(y), h)


def rk38(f, t, y, h):
    k1 = f(t, y)
    k2 = f(t + h / 3, y + h * k1 / 3)
    k3 = f(t + 2 * h / 3, y + h * (k2 - k1 / 3))
    k4 = f(t + h, y + h * (k1 - k2 + k3))
    return y + h * (k1 + 3 * k2 + 3 * k3 + k4) / 8


def heun(f, t, y, h):
    k = f(t, y)
    return y + h / 2 * (k + f(t + h, y + h * k))


def midpoint(f, t, y, h):
    return y + h * f(t + h / 2, y + h / 2 * f(t, y))


def ralston(f, t, y, h):
    k1 = f(t, y)
    return y + h * (0.25 * k1 + 0.75 * f(t + 2 / 3 * h, y + 2 / 3 * h * k1))


def dopri5(f, t, y, h):
    """With the seventh call, at the result, which a next step would use."""
    k1 = f(t, y)
    k2 = f(t + h / 5, y + h * (k1 / 5))
    k3 = f(t + 3 * h / 10, y + h * (3 / 40 * k1 + 9 / 40 * k2))
    k4 = f(t + 4 * h / 5, y + h * (44 / 45 * k1 - 56 / 15 * k2 + 32 / 9 * k3))
    k5 = f(t + 8 * h / 9, y + h * (19372 / 6561 * k1 - 25360 / 2187 * k2 + 64448 / 6561 * k3 - 212 / 729 * k4))
    k6 = f(t + h, y + h * (9017 / 3168 * k1 - 355 / 33 * k2 + 46732 / 5247 * k3 + 49 / 176 * k4 - 5103 / 18656 * k5))
    y1 = y + h * (35 / 384 * k1 + 500 / 1113 * k3 + 125 / 192 * k4 - 2187 / 6784 * k5 + 11 / 84 * k6)
    f(t + h, y1)
    return y1


def ssprk33_in_convex_combinations(f, t, u, h):
    u1 = u + h * f(t, u)
    u2 = 3 / 4 * u + 1 / 4 * (u1 + h * f(t + h, u1))
    return 1 / 3 * u + 2 / 3 * (u2 + h * f(t + h / 2, u2))


def ssprk104_in_two_registers(f, t, y, h):
    first, clock = y, t
    for _ in range(5):
        first, clock = first + h * f(clock, first) / 6, clock + h / 6
    second = (y + 9 * first) / 25
    first, clock = 15 * second - 5 * first, t + h / 3
    for _ in range(4):
        first, clock = first + h * f(clock, first) / 6, clock + h / 6
    return second + 3 * first / 5 + h * f(t + h, first) / 10


def jameson(f, t, y, h):
    """Four stages at y + h k/4, h k/3, h k/2, h k: order 4 on linear problems, 2 on others."""
    k = f(t, y)
    for i in (4, 3, 2):
        k = f(t + h / i, y + h / i * k)
    return y + h * k


def midpoint_iterated(times: int, first: float = 0.0) -> Code:
    """The implicit midpoint rule with so many fixed-point iterations from f(t + first h, y), however far they come."""

    def step(f, t, y, h):
        k = f(t + first * h, y)
        for _ in range(times):
            k = f(t + h / 2, y + h / 2 * k)
        return y + h * k

    return step


def repeated(step: Code, times: int) -> Code:
    def several(f, t, y, h):
        for i in range(times):
            y = step(f, t + i * h / times, y, h / times)
        return y

    return several


def floats(method: RungeKutta) -> tuple[list[list[float]], list[float], list[float]]:
    """A, b, c as floats: the exact numbers, correctly rounded."""
    rows = [[float(x) for x in row] for row in method.a]
    return rows, [float(x) for x in method.b], [float(x) for x in method.c]


def tableau(a: Sequence[Sequence[float]], b: Sequence[float], c: Sequence[float]) -> Code:
    """Any explicit Runge-Kutta method, term by term."""

    def step(f, t, y, h):
        slopes: list[Any] = []
        for node, row in zip(c, a, strict=True):
            place = y
            for x, k in zip(row, slopes, strict=False):
                place = place + h * x * k
            slopes.append(f(t + node * h, place))
        for x, k in zip(b, slopes, strict=True):
            y = y + h * x * k
        return y

    return step


def in_precision(step: Code, kind: Any) -> Code:
    """The step with every number in it rounded to the kind: numpy.float32, numpy.float16."""

    def rounded(f, t, y, h):
        return step(lambda t, y: np.asarray(f(t, y), kind), kind(t), np.asarray(y, kind), kind(h))

    return rounded


def velocity_verlet(force, q, v, h):
    v = v + h / 2 * force(q)
    q = q + h * v
    return q, v + h / 2 * force(q)


def velocity_verlet_in_time(force, t, q, v, h):
    v = v + h / 2 * force(t, q)
    q = q + h * v
    return q, v + h / 2 * force(t + h, q)


def velocity_verlet_by_acceleration(force, q, v, h):
    a = force(q)
    q1 = q + h * v + h * h / 2 * a
    return q1, v + h / 2 * (a + force(q1))


def position_verlet_calling_twice(force, q, v, h):
    middle = q + h / 2 * v
    q1 = middle + h / 2 * (v + h * force(middle))
    return q1, v + h * force(middle)


def symplectic_euler(force, q, v, h):
    v = v + h * force(q)
    return q + h * v, v


def velocity_from_positions(force, q, v, h):
    q1 = q + h * (v + h * force(q))
    return q1, (q1 - q) / h


def half_moved(force, q, v, h):
    v = v + h * force(q)
    return q + h / 2 * v, v


def symplectic_euler_in_a_field(f, t, y, h):
    q, v = y
    v = v + h * f(t, [q, v])[1]
    return [q + h * f(t, [q, v])[0], v]


def composed(parts: Sequence[tuple[str, float]]) -> Code:
    """Any splitting."""

    def step(force, q, v, h):
        for kind, x in parts:
            if kind == "kick":
                v = v + x * h * force(q)
            else:
                q = q + x * h * v
        return q, v

    return step


def nystrom(
    c: Sequence[float], a: Sequence[Sequence[float]], b_position: Sequence[float], b_velocity: Sequence[float]
) -> Code:
    """Any explicit Nyström method, term by term."""

    def step(force, q, v, h):
        forces: list[float] = []
        for node, row in zip(c, a, strict=True):
            place = q + h * node * v
            for x, k in zip(row, forces, strict=False):
                place = place + h * h * x * k
            forces.append(force(place))
        q1, v1 = q + h * v, v
        for x, y, k in zip(b_position, b_velocity, forces, strict=True):
            q1, v1 = q1 + h * h * x * k, v1 + h * y * k
        return q1, v1

    return step


def wrongly_timed(times):
    """RK4 whose two middle stages ask at times(t, h)."""

    def step(f, t, y, h):
        k1 = f(*times(t, h, 0), y)
        k2 = f(*times(t, h, h / 2), y + h / 2 * k1)
        k3 = f(*times(t, h, h / 2), y + h / 2 * k2)
        return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(*times(t, h, h), y + h * k3))

    return step


def unlike(part):
    """RK4 that leaves a number of y, from the place `part` on."""

    def step(f, t, y, h):
        y1 = rk4(f, t, y, h)
        y1[part:] = y[part:]
        return y1

    return step


def rk4_in_lists_of_three(f, t, y, h):
    """Right, but for the third number, which is put back."""
    stepped = rk4(f, t, np.array(y), h)
    return [*stepped[:2], *y[2:3], *stepped[3:]]


RK4_AT_WRONG_TIMES = {
    "half a unit late": wrongly_timed(lambda t, h, part: (t + (0.5 if part == h / 2 else part),)),
    "h squared late": wrongly_timed(lambda t, h, part: (t + (h * h / 2 if part == h / 2 else part),)),
    "at time 0": wrongly_timed(lambda t, h, part: (0.0 * t,)),
    "a clock restarted": wrongly_timed(lambda t, h, part: (part,)),
    "a clock stopped": wrongly_timed(lambda t, h, part: (t,)),
    "the third number left": rk4_in_lists_of_three,
    "all but two left": unlike(2),
}
