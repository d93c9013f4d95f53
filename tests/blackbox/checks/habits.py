"""Steppers with one planted habit each, most of them symplectic Euler and a line of code, and what is asked of them."""

from __future__ import annotations

import math
import random

import numpy as np

from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.stepper.opening import Target

_source = random.SystemRandom()


def bounded(x, low, high):
    return max(low, min(high, x))


def plain(q, v, h):
    v = v - h * q
    return q + h * v, v


NAMES = {"bounded": bounded, "plain": plain, "math": math, "np": np, "noise": _source.random}


def code(body, arguments="q, v, h"):
    """The stepper with this body, in lines or with `; ` between simple statements."""
    lines = [line for part in body.split("\n") for line in ([part] if ":" in part else part.split("; "))]
    names = dict(NAMES)
    exec("\n    ".join([f"def step({arguments}):", *lines]), names)
    names["step"].__name__ = names["step"].__qualname__ = "; ".join(map(str.strip, lines))
    return names["step"]


def then(rule):
    """Symplectic Euler, and then the rule: assignments to q and v."""
    return code(f"q, v = plain(q, v, h)\n{rule}\nreturn q, v")


def all_checks(runner):
    return checks_of(runner.run([*CHECKS.values()]))


def results_of(step, **how):
    return all_checks(IsolatedRunner(Target(step, **how), isolate=False))


def result(step, key, **how):
    return next(check for check in results_of(step, **how) if check.key == key)


def assert_fault(step, key, words, **how):
    """The stepper has this fault, told in these words."""
    seen = result(step, key, **how)
    assert seen.is_fault
    assert words in seen.words


def identified(value):
    """The code of a stepper as the name of a test."""
    return getattr(value, "__qualname__", None) or (value if isinstance(value, str) else None)


SPEED_CAPPED = then("v = bounded(v, -100.0, 100.0)")
CAR_IN_A_VALLEY = then("q, v = bounded(q, -1.2, 0.6), bounded(v, -0.07, 0.07)")
WRAPPED = then("q = (q + math.pi) % (2 * math.pi) - math.pi")
EPISODE = then("q, v = (0.05, 0.0) if abs(q) > 2.4 else (q, v)")
SLOW_SPEEDS_REST = then("v = 0.0 if abs(v) < 0.01 else v")
FORCE_LIMITED = code("v = v + h * bounded(-q, -10.0, 10.0); return q + h * v, v")
PENDULUM = code("v = v - h * math.sin(q); return q + h * v, v")
FALLS = code("return q + h * v, v - 9.81 * h")
POSITIVE_STEPS_ONLY = code("if h <= 0: raise ValueError('h must be positive')\nreturn plain(q, v, h)")
INTEGERS = code("return tuple(map(int, plain(q, v, h)))")
SIX_DECIMALS = code("return tuple(round(x, 6) for x in plain(q, v, h))")
FIXED_POINT = code("return tuple(round(x * 65536) / 65536 if math.isfinite(x) else x for x in plain(q, v, h))")
SINGLE = code("return plain(*map(np.float32, (q, v, h)))")
HALF = code("return plain(*map(np.float16, (q, v, h)))")
ROUNDED_TO_SINGLE = code("return tuple(float(np.float32(x)) for x in plain(q, v, h))")
SINGLE_INSIDE = code("return q + h * float(np.float32(v)), v - h * float(np.float32(q))")
REPAIRS_NAN = code("return tuple(0.0 if math.isnan(x) else x for x in plain(q, v, h))")
UNREPEATABLE = code("return q + h * v + 1e-9 * noise(), v - h * q")
TOLD_THE_TIME = code("return y + h * f(t, y)", "f, t, y, h")
CAPPED_STEP = code("return plain(q, v, min(h, 0.1))")
FIXED_STEP = code("return plain(q, v, 1 / 60)")
ABSOLUTE_STEP = code("return plain(q, v, abs(h))")
DIVIDES_BY_H = code("return q + h * v, v - h * h * q / h")
ADDS_INTO_ITS_ARGUMENTS = code("v -= h * q; q += h * v; return q, v")
SUB_STEPS = code("n = max(1, math.ceil(abs(h) / 0.05))\nfor _ in range(n): q, v = plain(q, v, h / n)\nreturn q, v")
ITERATES = code(
    "q1, v1 = q, v\n"
    "for _ in range(200):\n"
    "    before = q1, v1\n"
    "    q1, v1 = q + h * v1 / 8, v + h * force(q1) / 8\n"
    "    if abs(q1 - before[0]) + abs(v1 - before[1]) <= 1e-15 * (abs(q1) + abs(v1)): break\n"
    "return q1, v1",
    "force, q, v, h",
)
IN_PLACE = code("state[:] = plain(state[0], state[1], h)", "state, h")
NAN_BACKWARDS = code("return (math.nan, v) if h < 0 else plain(q, v, h)")
SOMETHING_ELSE_BACKWARDS = code("return plain(q, v, h) if h > 0 else (q + h * h, v - q * h * h)")
THREE_AT_ZERO = code("return plain(q, v, h) if h else (q, v, h)")
WORDS_AT_ZERO = code("return plain(q, v, h) if h else ('q', 'v')")
NEARLY_STILL = code("return plain(q * (1 + 1e-15 * (h == 0)), v, h)")
OVERFLOWS_EARLY = code("return q + h * v, v - h * q * 1e20 * 1e-20 * (1 if abs(q) < 1e200 else math.inf)")
RAISES_WHEN_LARGE = code("if max(abs(q), abs(v)) > 1e3: raise ValueError('too far')\nreturn plain(q, v, h)")
RAISES_WHEN_SMALL = code("if 0 < abs(v) < 1e-3: raise ValueError('too slow')\nreturn plain(q, v, h)")
JUMPS_BEYOND = then("q, v = (q - 8.0, v) if q >= 4.0 else (q, v)")
SHIFTED_WHEN_SMALL = then("q, v = (q, 0.5) if 0 < abs(v) < 0.25 else (q, v)")
ROUNDS_SMALL_ONES = code("q, v = plain(q, v, h); return q + 1e-3 - 1e-3, v + 1e-3 - 1e-3")
NOT_ODD = code("v = v - h * (q + 0.01 * abs(q)); return q + h * v, v")
THREE_TIMES_WRONG = code("return q + h * v * (1 + 1e-7 * (abs(q) > 1)), v - h * q")
WHOLE_STEPS_ONLY = code("n = max(1, round(h / 0.01))\nfor _ in range(n): q, v = plain(q, v, 0.01)\nreturn q, v")
EVERY_OTHER_STEP = code("n = 2 if abs(h) > 0.5 else 1\nfor _ in range(n): q, v = plain(q, v, h / n)\nreturn q, v")
BY_KEYWORDS = code("return q + h * v, v - h * q", "t, q, *, v, h")
TELLS_THE_TIME_BY_KEYWORDS = code("return q + h * v + 1e-3 * t * h, v - h * q", "q, *, v, t, h")
COARSE = code("q, v = plain(q, v, h); return round(q, 1), round(v, 1)")
QUARTERS = code("q, v = plain(q, v, h); return round(4 * q) / 4, round(4 * v) / 4")
DAMPED = code("v = v - h * (q + 0.1 * v); return q + h * v, v")
TURNED_OVER = code("return v, q")
CHAOTIC = code("return q + h * v, v - h * q ** 3")
_buffer = np.zeros(2)


def own_buffer(state, h):
    _buffer[:] = plain(state[0], state[1], h)
    return _buffer


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
