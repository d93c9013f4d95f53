"""Steps of a velocity in a magnetic field, and of quaternions, in styles in use, right and wrong."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from driftproof.methods.catalogue import METHODS


def boris(
    vector: Callable[[Any, float], Any] = lambda b, h: h / 2 * b,
    size: Callable[[Any], Any] = lambda t: t @ t,
    *,
    kicks: tuple[float, float] = (0.5, 0.5),
    turns: int = 1,
    drift: tuple[float, float] = (0.0, 1.0),
):
    """Boris' step with these parts: t of B and h, |t|² of t, both kicks, and how much of either velocity moves x."""

    def step(x, v, E, B, dt):
        u, t = v + kicks[0] * dt * E, vector(B, dt)
        for _ in range(turns):
            u = u + np.cross(u + np.cross(u, t), 2 * t / (1 + size(t)))
        u = u + kicks[1] * dt * E
        return x + dt * (drift[0] * v + drift[1] * u), u

    return step


def kinetic(v, E, B, q, m, dt):
    """The velocity alone, with charge and mass."""
    half = q * dt / (2 * m)
    u, t = v + half * E, half * B
    u = u + np.cross(u + np.cross(u, t), 2 * t / (1 + np.dot(t, t)))
    return u + half * E


def charge_forgotten(v, E, B, q, m, dt):
    """The same, but for the charge at the magnetic field."""
    return boris()(0 * v, v, q / m * E, B / m, dt)[1]


def mass_squared(v, E, B, m, dt):
    """Divided by the mass twice."""
    return boris()(0 * v, v, E / m**2, B / m**2, dt)[1]


def by_ratio(pos, vel, e_field, b_field, q_over_m, dt):
    """Lists of numbers, and products written out."""
    a, (bx, by, bz) = q_over_m * dt / 2, b_field
    u, v, w = (x + a * e for x, e in zip(vel, e_field, strict=True))
    t, s = [a * bx, a * by, a * bz], 2 * a / (1 + a * a * (bx * bx + by * by + bz * bz))
    p, q, r = u + v * t[2] - w * t[1], v + w * t[0] - u * t[2], w + u * t[1] - v * t[0]
    u, v, w = u + s * (q * bz - r * by), v + s * (r * bx - p * bz), w + s * (p * by - q * bx)
    new = [x + a * e for x, e in zip((u, v, w), e_field, strict=True)]
    return [x + dt * y for x, y in zip(pos, new, strict=True)], new


def drifting(x, v, E, B, dt):
    """Half drifts on either side of the push, the fields being functions that are asked in the middle."""
    x = x + dt / 2 * v
    v = boris()(x, v, E(x), B(x), dt)[1]
    return x + dt / 2 * v, v


def in_place(x, v, E, B, dt):
    """Both arrays written into."""
    x1, v1 = boris()(x, v, E, B, dt)
    x[:], v[:] = x1, v1


def in_rows(x, v, E, B, dt):
    """Of a row for each particle."""
    v = v + dt / 2 * E
    t = dt / 2 * np.atleast_2d(B)
    v = v + np.cross(v + np.cross(v, t), 2 * t / (1 + (t * t).sum(axis=1, keepdims=True)))
    v = v + dt / 2 * E
    return x + dt * v, v


def in_plane(x, v, E, B, dt):
    """Two numbers across a B of one number."""
    u, w = v[0] + dt / 2 * E[0], v[1] + dt / 2 * E[1]
    t = dt / 2 * B
    p, q, s = u + w * t, w - u * t, 2 * t / (1 + t * t)
    u, w = u + q * s + dt / 2 * E[0], w - p * s + dt / 2 * E[1]
    return (x[0] + dt * u, x[1] + dt * w), (u, w)


def shown_as(form: Callable[[Any, Any], Any], dtype: type = np.float64):
    """Boris' step that works in this format, and returns position and velocity in this form."""

    def step(x, v, E, B, dt):
        return form(*boris()(*(np.asarray(part, dtype) for part in (x, v, E, B)), dtype(dt)))

    return step


def runge_kutta(key: str):
    """A Runge-Kutta method of x' = v, v' = E(x) + v x B(x)."""
    method: Any = METHODS[key]

    def step(x, v, E, B, dt):
        slopes: list[Any] = []
        for row in method.a:
            y, u = (
                z + dt * sum(float(a) * k[n] for a, k in zip(row, slopes, strict=False)) for n, z in ((0, x), (1, v))
            )
            slopes.append((u, E(y) + np.cross(u, B(y))))
        return tuple(
            z + dt * sum(float(b) * k[n] for b, k in zip(method.b, slopes, strict=True)) for n, z in ((0, x), (1, v))
        )

    return step


def rk4_with_eulers_position(x, v, E, B, dt):
    """RK4 of the velocity, and a position that moves with the old one."""
    return x + dt * v, runge_kutta("rk4")(x, v, lambda y: E, lambda y: B, dt)[1]


def asked_at(place: float, before: float, after: float):
    """Boris' step with fields of the position asked at x + place h v, and this drift."""

    def step(x, v, E, B, dt):
        at = x + place * dt * v
        return boris(drift=(before, after))(x, v, E(at), B(at), dt)

    return step


def iterated(x, v, E, B, dt):
    """The implicit midpoint rule of the whole, iterated for its position from x."""
    x1, v1 = x, v
    for _ in range(60):
        at = (x + x1) / 2
        v1 = boris()(x, v, E(at), B(at), dt)[1]
        x1 = x + dt / 2 * (v + v1)
    return x1, v1


def fields_apart(x, v, E, B, dt):
    """Boris' step with E where it belongs, and B at the end."""
    return boris()(x, v, E(x), B(x + dt * v), dt)


def tangent(b: Any, h: float):
    """t that makes Boris' rotation exact."""
    size = np.linalg.norm(b)
    return np.tan(h / 2 * size) * b / size if size else 0 * b


def without_field(x, v, B, dt):
    """A rotation with no electric field."""
    return boris()(x, v, np.zeros(3), B, dt)


def relativistic(x, v, E, B, dt):
    """With the factor of a velocity near that of light, 10."""
    return boris()(x, v, E, B / np.sqrt(1 + v @ v / 100), dt)


def moved_by_field(x, v, E, B, dt):
    """The position moved by the electric field once more."""
    x1, v1 = boris()(x, v, E, B, dt)
    return x1 + dt**2 / 2 * E, v1


LEAPFROG = "v is half a step behind x"
# With the verdict of `identify`; none of them has a fault.
RIGHT_PUSHES = [
    (boris(), f"it is boris; {LEAPFROG}"), (kinetic, "it is boris"), (by_ratio, f"it is boris; {LEAPFROG}"),
    (drifting, "it is boris"), (in_place, f"it is boris; {LEAPFROG}"),
    *((shown_as(form), f"it is boris; {LEAPFROG}") for form in (lambda *parts: np.concatenate(parts),
      lambda x, v: {"x": x, "v": v})), (shown_as(lambda *parts: parts, np.float32), f"it is boris; {LEAPFROG}"),
    (in_rows, f"it is boris; {LEAPFROG}"), (in_plane, f"it is boris in the plane, with B across it; {LEAPFROG}"),
    (boris(drift=(0.5, 0.5)), "it is boris; x and v are at the same time if the fields are those at x + 1/2 h v"),
    *((runge_kutta(key), f"it is {key} of v' = E + v x B") for key in ("rk4", "midpoint2", "kutta3")),
    (boris(tangent), f"it is boris except for its rotation, which is exact; {LEAPFROG}"),
    (boris(lambda b, h: h / 4 * b, turns=2),
     f"it is boris except for its rotation, which is implicit_midpoint in 2 equal parts; {LEAPFROG}"),
    (without_field, f"it is the rotation of boris; {LEAPFROG}"),
    (boris(kicks=(1.0, 0.0)), f"it is the rotation of boris, with the whole kick before it; {LEAPFROG}"),
    (boris(kicks=(0.0, 1.0)), f"it is the rotation of boris, with the whole kick after it; {LEAPFROG}"),
    (boris(kicks=(0.25, 0.75)), f"it is the rotation of boris, with other kicks; {LEAPFROG}"),
    (boris(lambda b, h: np.sin(h / 2 * np.linalg.norm(b)) * tangent(b, 1.0) / np.tan(np.linalg.norm(b) / 2 or 1.0),
           kicks=(1.0, 0.0)), f"it is not a known step; {LEAPFROG}"),
]  # fmt: skip
# With a fault that names the mistake.
WRONG_PUSHES = [
    (boris(lambda b, h: h * b), "h B for short steps, not by h B: of Boris' step, as with t = h B instead of h B/2"),
    (boris(lambda b, h: h / 4 * b), "it turns by 0.5 times h B for short steps, not by h B"),
    (boris(size=lambda t: 0.0), "as in Boris' step without 1/(1 + t^2): its size is multiplied by 1 + (h B)^4/8"),
    (boris(size=lambda t: t * t), "for B along (1, 2, 2) and h B = 1, |v| is multiplied by 1.05983"),
    (boris(size=lambda t: np.sqrt(t @ t)), "an electric field: its size is multiplied by 1 - 0.247 (h B)^3 + ..."),
    (boris(lambda b, h: -h / 2 * b), "it turns the other way: by B x v, not by v x B"),
    (boris(lambda b, h: b / 2), "the rotation is not a function of h B: at h B = 1, h = 0.25 and h = 1 differ"),
    (boris(kicks=(0.5, 0.0)), "gives h E times 1/2: one of two half kicks is missing"),
    (boris(kicks=(0.0, 0.5)), "gives h E times 1/2: one of two half kicks is missing"),
    (boris(kicks=(1.0, 1.0)), "gives h E times 2"),
    (boris(drift=(1.0, 0.0)), "x moves with the old velocity and fields at the old position: not a leapfrog"),
    (boris(drift=(0.0, 0.5)), "without fields the position moves by 1/2 h v"),
    (boris(turns=2), "2 times h B for short steps, not by h B: of Boris' step, as with t = h B instead of h B/2"),
    (boris(lambda b, h: h / 2 * b * (h * h * (b @ b) > 1e-12)), "it turns by 0 at h B = 5.96e-08"),
    (lambda x, v, E, B, q, dt: boris()(x, v, abs(q) * E, abs(q) * B, dt), "with a negative charge in fields that give"),
    (charge_forgotten, "it turns by 0.125 times h B for short"), (mass_squared, "gives h E times 1/2"),
    (boris(lambda b, h: np.tan(h / 2 * np.sqrt(b @ b)) * b / np.sqrt(b @ b)), "with B = 0, from "),
    (lambda x, v, E, B, dt: boris()(x, v, E * np.array([1.0, 1.0, 0.0]), B, dt),
     "with both fields, and at other states, the step is not made of these kicks and this rotation"),
    (lambda x, v, E, B, dt: boris()(np.clip(x, -1e5, 1e5), v, E, B, dt),
     "with both fields, and at other states, the position moves in another way"),
    (lambda x, v, E, B, dt: boris()(x, v, E, B, dt) if np.any(B) else (x + dt * v, v),
     "with B = 0 and E = 1, the velocity 1 becomes 1"),
    (boris(size=lambda t: t @ t if t @ t > 1e-5 else 1e-5), "it does not turn as at larger ones"),
    (moved_by_field, "the position moves differently than without E"),
    (lambda x, v, E, B, dt: tuple(np.subtract(boris()(x, v, E, B, dt), (dt**2 * x, 0 * v))),
     "with both fields, and at other states, the position moves in another way"),
    (rk4_with_eulers_position, "does not move as in a single method for all of x' = v, v' = E + v x B"),
    (fields_apart, "the fields are evaluated at x + h v, not at x: order 1"),
    (asked_at(1.0, 0.0, 1.0), "the fields are evaluated at x + h v, not at x: order 1"),
]  # fmt: skip


def product(a, b):
    """Of quaternions, scalar first."""
    return np.array([a[0] * b[0] - np.dot(a[1:], b[1:]), *(a[0] * np.array(b[1:]) + b[0] * np.array(a[1:])
                     + np.cross(a[1:], b[1:]))])  # fmt: skip


def body(q, w):
    """q' = q omega/2."""
    return 0.5 * product(q, [0.0, *w])


def space(q, w):
    """q' = omega q/2."""
    return 0.5 * product([0.0, *w], q)


def quaternion(key: str, rate: Callable[[Any, Any], Any] = body, *, unit: bool = False):
    """A Runge-Kutta method of a quaternion, made one of length 1 or not."""
    method: Any = METHODS[key]

    def step(q, omega, dt):
        slopes: list[Any] = []
        for c, row in zip(method.c, method.a, strict=True):
            at = omega(c) if callable(omega) else omega
            slopes.append(rate(q + dt * sum(float(a) * k for a, k in zip(row, slopes, strict=False)), at))
        q = q + dt * sum(float(b) * k for b, k in zip(method.b, slopes, strict=True))
        return q / np.linalg.norm(q) if unit else q

    return step


def of_function(key: str, late: float = 1.0, **how: Any):
    """The same with the angular velocity as a function of t, asked for at t + late c h."""
    step = quaternion(key, **how)
    return lambda q, t, dt, gyro=np.sin: step(q, lambda c: gyro(t + late * float(c) * dt), dt)


def turned_by(angle: Callable[[float], float], *, guarded: bool = True):
    """A rotation by a function of the angle |omega| dt/2; unguarded, it divides by the length 0."""

    def step(quat, gyro, dt):
        size = np.linalg.norm(gyro)
        phi = angle(size * dt / 2)
        axis = np.array(gyro) / size if size or not guarded else np.zeros(3)
        return product(quat, [np.cos(phi), *(np.sin(phi) * axis)])

    return step


def into(q, w, dt):
    """Written into the array."""
    q += dt * body(q, w)


def single(q, omega, dt):
    """Euler's step in binary32."""
    return (np.asarray(q, np.float32) + np.float32(dt) * body(q, omega).astype(np.float32)).astype(np.float32)


def one_sign(q, omega, dt):
    """Euler's step written out, one sign wrong."""
    w, x, y, z = q
    a, b, c = omega
    rate = [-x * a - y * b - z * c, w * a + y * c - z * b, w * b - x * c + z * a, w * c + x * b + y * a]
    return np.array(q) + dt / 2 * np.array(rate)


RIGHT_QUATERNIONS = [
    (quaternion("forward_euler"), "it is forward_euler of q' = q omega/2 (scalar first)"),
    (quaternion("rk4"), "it is rk4 of q' = q omega/2 (scalar first)"),
    (quaternion("midpoint2", space), "it is midpoint2 of q' = omega q/2 (scalar first)"),
    (quaternion("kutta3", lambda q, w: -space(q, w)), "it is kutta3 of q' = -omega q/2 (scalar first)"),
    (quaternion("forward_euler", unit=True),
     "it is forward_euler, normalised to length 1, of q' = q omega/2 (scalar first)"),
    (quaternion("rk4", unit=True), "it is rk4, normalised to length 1, of q' = q omega/2 (scalar first)"),
    (turned_by(lambda x: x), "it is the exact rotation of q' = q omega/2 (scalar first)"),
    (turned_by(lambda x: 2 * np.arctan(x / 2)), "it is implicit_midpoint of q' = q omega/2 (scalar first)"),
    (turned_by(np.arctan), "it is forward_euler, normalised to length 1, of q' = q omega/2 (scalar first)"),
    *((step, "it is forward_euler of q' = q omega/2 (scalar first)") for step in (into, single)),
    (turned_by(np.sin), "it is not a known rotation of q' = q omega/2 (scalar first), of order 2"),
]  # fmt: skip
RIGHT_QUATERNIONS = [(step, words.replace("first)", "first), omega constant")) for step, words in RIGHT_QUATERNIONS]
WRONG_QUATERNIONS = [
    (quaternion("forward_euler", lambda q, w: 2 * body(q, w)), "2 times as fast as omega: the factor 1/2 is missing"),
    (quaternion("rk4", lambda q, w: body(q, w) / 2), "0.5 times as fast as omega: the factor 1/2 appears twice"),
    (turned_by(lambda x: 2 * x), "the factor 1/2 is missing"),
    (turned_by(lambda x: 3 * x), "it turns 3 times as fast as omega"),
    (one_sign, "its rate is not a product of q and omega: at omega = (2, 3, 6)/7 the rate of q[3] takes 0.143 q[2]"),
    (turned_by(lambda x: x, guarded=False), "with omega = 0, from 0.5, 0.5, 0.5, 0.5 it returns nan, nan, nan, nan"),
    (turned_by(lambda x: x * x), "it turns 0 times as fast as omega"),
    (lambda q, omega, dt: np.array([1.0, 0, 0, 0]) if not any(omega) else quaternion("rk4")(q, omega, dt),
     "with omega = 0, (0.5, 0.5, 0.5, 0.5) becomes (1, 0, 0, 0)"),
    (lambda q, omega, dt: quaternion("rk4")(q, omega, dt if np.dot(omega, omega) > 1e-6 or dt < 1e-4 else 0.0),
     "with h |omega| = 0.000488 it does not turn as with larger ones"),
    (lambda q, omega, dt: quaternion("rk4")(q, omega, dt if np.dot(omega, omega) > 1e-12 or dt < 1e-4 else 0.0),
     "with h |omega| = 5.96e-08 it does not turn as with larger ones"),
    (lambda q, omega, dt: quaternion("rk4" if np.linalg.norm(omega) * dt > 1e-2 else "forward_euler")(q, omega, dt),
     "with h |omega| = 0.00391 it does not turn as with larger ones"),
    (lambda q, omega, dt: quaternion("rk4")(q, np.array(omega) * (1 + dt / 8), dt),
     "its angle depends on more than h |omega|: on the step or on the direction"),
]  # fmt: skip
RIGHT, WRONG = [*RIGHT_PUSHES, *RIGHT_QUATERNIONS], [*WRONG_PUSHES, *WRONG_QUATERNIONS]
