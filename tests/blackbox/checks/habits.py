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


class Counter:
    """Drifts with each call."""

    calls = 0

    def step(self, q, v, h):
        self.calls += 1
        return q + h * v + 1e-9 * self.calls, v - h * q


# By what is said of them, or nearly.
RULES = {
    # What is done to arguments and answers.
    "integers truncate the answer": code(
        "out = np.zeros_like(state); out[0], out[1] = plain(state[0], state[1], h); return out", "state, h"
    ),
    "an answer is overwritten by the next call": own_buffer,
    # Rules about large and small states.
    "|v| is capped at 100": code("return plain(q, bounded(v, -100.0, 100.0), h)"),
    "q below 0 becomes 0": then("q = max(q, 0.0)"),
    "with q beyond 3 the state jumps to (3.0, 0.0)": then("q, v = (3.0, 0.0) if q > 3.0 else (q, v)"),
    "q beyond 9.25 becomes -9.25; q below -9.25 becomes -9.25": then("q = -9.25 if abs(q) > 9.25 else q"),
    "with q from 2 pi on the state changes even as h -> 0": then("q = q % (2 * math.pi)"),
    "with |q| beyond pi the state changes even as h -> 0": then(
        "q = q - 2 * math.pi if q > math.pi else q + 2 * math.pi if q < -math.pi else q"
    ),
    "with q below 0 the state changes even as h -> 0": then("q, v = (-q, -v) if q < 0 else (q, v)"),
    "the state changes even as h -> 0: (5.0, 0.375) becomes (4.98, ...)": then(
        "size = math.hypot(q, v); q, v = (q * 5 / size, v * 5 / size) if size > 5 else (q, v)"
    ),
    "becomes (0.0, 0.0)": then("q, v = (0.0, 0.0) if q * q + v * v < 1e-6 else (q, v)"),
    "with q from 5 on the state changes even as h -> 0": code(
        "if q > 5.0: raise ValueError('far')\nreturn plain(7.0 if q == 5.0 else q, v, h)"
    ),
    "overflows from q = 1.341e+154 on": code(
        "size = math.sqrt(q * q + v * v); q, v = plain(q / size, v / size, h) if size else (0.0, 0.0); "
        "return size * q, size * v"
    ),
    # What becomes of the smallest numbers.
    "subnormal numbers become 0": then("q, v = (0.0 if abs(x) < 2.0**-1022 else x for x in (q, v))"),
    "near 3.2e-311 the answer does not scale": then("q, v = (1.5 * x if abs(x) < 2.0**-1022 else x for x in (q, v))"),
    "small states lose digits, and nonlinear at q = 2.96": code(
        "q, v = plain(q, v - h * (math.sin(q) - q), h); return (q + math.pi) % (2 * math.pi) - math.pi, v"
    ),
    "(0, 0) has no answer": code(
        "size = np.float64(q * q + v * v); q, v = plain(q / size, v / size, h); return q * size, v * size"
    ),
    # Linear, linear up to a border, or bent.
    "nonlinear at q = 0.739": code("v = v - h * q * (1 + abs(q) ** 7.5); return q + h * v, v"),
    "linear up to q = 0.0": code("v = v - h * q * (1 + abs(q) ** 7.75); return q + h * v, v"),
    "linear only up to v = 100": code("q, v = plain(q, v, 1 / 60); return q, bounded(v, -100.0, 100.0)"),
    "S(-z) is not -S(z)": code("v = v - h * max(q, 0.0); return q + h * v, v"),
    "S(q, v) is not S(q, 0) + S(0, v)": code("return q + h * v, v - h * (q + 0.1 * math.sqrt(abs(q * v)))"),
    # Steps of 0, back in time and of infinity, and the time that a stepper is told.
    "h = 0 is divided by": code("return q + h * v, v - np.float64(h * h * q) / np.float64(h)"),
    "h < 0 does nothing": code("return plain(q, v, max(h, 0.0))"),
    "h < 0 does something other than step back": code(
        "if abs(h) < 0.01: raise ValueError('too short')\nreturn plain(q, v, h) if h > 0 else (q + h * h, v)"
    ),
    "an infinity gives finite numbers": code("return tuple(np.nan_to_num(x) for x in plain(q, v, h))"),
    "the answer depends on t": code(
        "q, v = plain(y[0], y[1], h); return np.array([q, v + 1e-3 * h * math.sin(t)])", "t, y, h"
    ),
    "the right-hand side gets a time outside the step": code("return y + h * f(0.0, y)", "f, t, y, h"),
    # Another step than h, and long steps that are made of shorter ones.
    "h is ignored": code("v = v + force(q) / 240; return q + v / 240, v", "force, q, v, h"),
    "h is raised to 0.0001": code("return plain(q, v, max(h, 1e-4) if h > 0 else h)"),
    "h is raised to 0.3": code("return plain(q, v, max(h, 0.3))"),
    "h is taken in whole steps": code("for _ in range(int(h / 0.01)): q, v = plain(q, v, 0.01)\nreturn q, v"),
    "above h = 0.05 it takes sub-steps": code(
        "n = max(1, math.ceil(abs(h) / 0.05))\n"
        "for _ in range(n):\n    v = v + h / n * force(q)\n    q = q + h / n * v\nreturn q, v",
        "force, q, v, h",
    ),
}
