"""Steppers with one planted habit each: symplectic Euler and a rule, and what else there is."""

import math
import random

import numpy as np


def plain(q, v, h):
    v = v - h * q
    return q + h * v, v


def then(rule):
    """Symplectic Euler, then the rule."""

    def step(q, v, h):
        return rule(*plain(q, v, h))

    step.__qualname__ = rule.__name__
    return step


def bounded(x, low, high):
    return max(low, min(high, x))


@then
def speed_capped(q, v):
    return q, bounded(v, -100.0, 100.0)


def speed_capped_before(q, v, h):
    return plain(q, bounded(v, -100.0, 100.0), h)


@then
def car_in_a_valley(q, v):
    return bounded(q, -1.2, 0.6), bounded(v, -0.07, 0.07)


@then
def floor(q, v):
    return max(q, 0.0), v


@then
def stop(q, v):
    return (3.0, 0.0) if q > 3.0 else (q, v)


@then
def wrapped(q, v):
    return (q + math.pi) % (2 * math.pi) - math.pi, v


@then
def wrapped_from_zero(q, v):
    return q % (2 * math.pi), v


@then
def wrapped_once(q, v):
    return (q - 2 * math.pi if q > math.pi else q + 2 * math.pi if q < -math.pi else q), v


@then
def episode(q, v):
    return (0.05, 0.0) if abs(q) > 2.4 else (q, v)


@then
def wall(q, v):
    return (-q, -v) if q < 0 else (q, v)


@then
def drained(q, v):
    size = math.hypot(q, v)
    return (q * 5 / size, v * 5 / size) if size > 5 else (q, v)


def fenced(q, v, h):
    if abs(q) >= 10:
        raise ValueError("out of range")
    return plain(q, v, h)


@then
def slow_speeds_rest(q, v):
    return q, 0.0 if abs(v) < 0.01 else v


@then
def small_states_rest(q, v):
    return (0.0, 0.0) if q * q + v * v < 1e-6 else (q, v)


def squares(q, v, h):
    size = math.sqrt(q * q + v * v)
    q1, v1 = plain(q / size, v / size, h) if size else (0.0, 0.0)
    return size * q1, size * v1


@then
def flushes(q, v):
    return tuple(0.0 if abs(x) < 2.0**-1022 else x for x in (q, v))


def force_limited(q, v, h):
    v = v + h * bounded(-q, -10.0, 10.0)
    return q + h * v, v


def speed_capped_at_60_hertz(q, v, h):
    return speed_capped(q, v, 1 / 60)


def pendulum(q, v, h):
    v = v - h * math.sin(q)
    return q + h * v, v


def wrapped_pendulum(q, v, h):
    return wrapped(q, v - h * (math.sin(q) - q), h)


def falls(q, v, h):
    return q + h * v, v - 9.81 * h


def one_sided(q, v, h):
    v = v - h * max(q, 0.0)
    return q + h * v, v


def coupled(q, v, h):
    return q + h * v, v - h * (q + 0.1 * math.sqrt(abs(q * v)))


def divides_by_h(q, v, h):
    return q + h * v, v - h * h * q / h


def divides_arrays_by_h(q, v, h):
    return q + h * v, v - np.float64(h * h * q) / np.float64(h)


def positive_steps_only(q, v, h):
    if h <= 0:
        raise ValueError("h must be positive")
    return plain(q, v, h)


def absolute_step(q, v, h):
    return plain(q, v, abs(h))


def no_negative_step(q, v, h):
    return plain(q, v, max(h, 0.0))


def fixed_step(q, v, h):
    return plain(q, v, 1 / 60)


def fixed_step_of_a_force(force, q, v, h):
    v = v + force(q) / 240
    return q + v / 240, v


def capped_step(q, v, h):
    return plain(q, v, min(h, 0.1))


def raised_step(q, v, h):
    return plain(q, v, max(h, 1e-4) if h > 0 else h)


def counted_steps(q, v, h):
    for _ in range(int(h / 0.01)):
        q, v = plain(q, v, 0.01)
    return q, v


def sub_steps(q, v, h):
    number = max(1, math.ceil(abs(h) / 0.05))
    for _ in range(number):
        q, v = plain(q, v, h / number)
    return q, v


def sub_steps_of_a_force(force, q, v, h):
    number = max(1, math.ceil(abs(h) / 0.05))
    for _ in range(number):
        v = v + h / number * force(q)
        q = q + h / number * v
    return q, v


def iterates(force, q, v, h):
    q1, v1 = q, v
    for _ in range(200):
        before = q1, v1
        q1, v1 = q + h * v1 / 8, v + h * force(q1) / 8
        if abs(q1 - before[0]) + abs(v1 - before[1]) <= 1e-15 * (abs(q1) + abs(v1)):
            break
    return q1, v1


def integers(q, v, h):
    return tuple(map(int, plain(q, v, h)))


def integer_storage(state, h):
    out = np.zeros_like(state)
    out[0], out[1] = plain(state[0], state[1], h)
    return out


def six_decimals(q, v, h):
    return tuple(round(x, 6) for x in plain(q, v, h))


def fixed_point(q, v, h):
    return tuple(round(x * 65536) / 65536 if math.isfinite(x) else x for x in plain(q, v, h))


def single(q, v, h):
    return plain(*map(np.float32, (q, v, h)))


def rounded_to_single(q, v, h):
    return tuple(float(np.float32(x)) for x in plain(q, v, h))


def single_inside(q, v, h):
    return q + h * float(np.float32(v)), v - h * float(np.float32(q))


def adds_into_its_arguments(q, v, h):
    v -= h * q
    q += h * v
    return q, v


_buffer = np.zeros(2)


def own_buffer(state, h):
    _buffer[:] = plain(state[0], state[1], h)
    return _buffer


def repairs_nan(q, v, h):
    return tuple(0.0 if math.isnan(x) else x for x in plain(q, v, h))


def repairs_infinity(q, v, h):
    return tuple(np.nan_to_num(x) for x in plain(q, v, h))


def divides_by_size(q, v, h):
    size = np.float64(q * q + v * v)
    q1, v1 = plain(q / size, v / size, h)
    return q1 * size, v1 * size


class Multistep:
    """Remembers the last force: each object its own."""

    def __init__(self):
        self.last = {}

    def step(self, q, v, h):
        before = self.last.get("force", -q)
        self.last["force"] = -q
        return q + h * v, v + h * (before - q) / 2


class SharedMultistep(Multistep):
    """Remembers the last force of all objects."""

    everybodys = {}  # noqa: RUF012

    def __init__(self):
        self.last = self.everybodys

    def __deepcopy__(self, memo):
        return type(self)()


class Counter:
    """Drifts with each call."""

    calls = 0

    def step(self, q, v, h):
        self.calls += 1
        return q + h * v + 1e-9 * self.calls, v - h * q


_source = random.SystemRandom()


def unrepeatable(q, v, h):
    return q + h * v + 1e-9 * _source.random(), v - h * q


def clocked(t, y, h):
    q, v = plain(y[0], y[1], h)
    return np.array([q, v + 1e-3 * h * math.sin(t)])


def told_the_time(f, t, y, h):
    return y + h * f(t, y)


def told_another_time(f, t, y, h):
    return y + h * f(0.0, y)
