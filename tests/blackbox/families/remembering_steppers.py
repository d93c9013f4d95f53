"""Multistep methods as people write them: objects with a history, runs, generators; right ones, and wrong twins."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from driftproof.methods.catalogue import FURTHER_METHODS
from tests.blackbox.handwritten_steppers import rk4
from tests.blackbox.implicit_steppers import newton

# Weights of the slopes, the newest first.
BASHFORTH4 = [55 / 24, -59 / 24, 37 / 24, -9 / 24]


def implicit_euler(f, t, y, h):
    return newton(lambda x: x - y - h * f(t + h, x), y)


class Remembering:
    """Σ ρⱼ y = h Σ σⱼ F of a method of the catalogue, or with other numbers; `begin` makes the first steps."""

    def __init__(self, key, begin, *, sigma=None, most=50):
        """Nothing remembered yet."""
        method = FURTHER_METHODS[key]
        self.rho = [float(x / method.rho[-1]) for x in method.rho]
        self.sigma = [float(x / method.rho[-1]) for x in method.sigma] if sigma is None else sigma
        self.begin, self.most = begin, most
        self.states, self.slopes = [], []

    def step(self, f, t, y, h):
        """One step."""
        self.states.append(y)
        self.slopes.append(f(t, y))
        k = len(self.rho) - 1
        if len(self.states) < k:
            return self.begin(f, t, y, h)
        last = zip(self.rho, self.sigma, self.states[-k:], self.slopes[-k:], strict=False)
        known = sum((h * s * slope - r * state for r, s, state, slope in last), 0 * y)
        if not self.sigma[-1]:
            return known
        return newton(lambda x: x - known - h * self.sigma[-1] * f(t + h, x), y, most=self.most, tolerance=1e-14)


class Corrected(Remembering):
    """Adams-Moulton, from what an explicit method with these weights predicts, corrected so many times."""

    def __init__(self, key, begin, weights, times=1):
        """Nothing remembered yet."""
        super().__init__(key, begin)
        self.weights, self.times = weights, times

    def step(self, f, t, y, h):
        """One step; the slopes are taken at the states that are returned."""
        after, k = super().step(f, t, y, h), len(self.rho) - 1
        if len(self.states) < max(k, len(self.weights)):
            return after
        value = y + h * sum(b * slope for b, slope in zip(self.weights, reversed(self.slopes), strict=False))
        known = y + h * sum(b * slope for b, slope in zip(self.sigma, self.slopes[-k:], strict=False))
        for _ in range(self.times):
            value = known + h * self.sigma[-1] * f(t + h, value)
        return value


class OfLengths:
    """Adams-Bashforth of two steps of any lengths, started by Heun; `power` is -1 if their ratio is turned over.

    If `restarts`, it begins anew after a change of h.
    """

    def __init__(self, power=1, restarts=False):
        """Nothing remembered yet."""
        self.power, self.restarts, self.before = power, restarts, None

    def step(self, f, t, y, h):
        """One step."""
        slope, (old, length) = f(t, y), self.before or (None, None)
        self.before = slope, h
        if old is None or (self.restarts and h != length):
            return y + h / 2 * (slope + f(t + h, y + h * slope))
        ratio = (h / length) ** self.power
        return y + h * ((1 + ratio / 2) * slope - ratio / 2 * old)


class Predicted:
    """The trapezoid, corrected once from a prediction with these weights of the last two slopes."""

    def __init__(self, *weights):
        """Nothing remembered yet."""
        self.weights, self.slopes = weights, []

    def step(self, f, t, y, h):
        """One step, the first of which is Heun's."""
        self.slopes.insert(0, f(t, y))
        weights = self.weights if len(self.slopes) > 1 else [1.0]
        value = y + h * sum(b * slope for b, slope in zip(weights, self.slopes, strict=False))
        return y + h / 2 * (self.slopes[0] + f(t + h, value))


def without_times(made):
    """The same of y alone, for an f without t."""
    return lambda y, f, h: made.step(lambda t, x: f(x), 0.0, y, h)


class Displaced(Remembering):
    """Its right-hand side is asked beside the states that it returns."""

    def step(self, f, t, y, h):
        """One step."""
        return super().step(lambda at, x: f(at, x + h / 4), t, y, h)


class Stormer:
    """q' = v, v' = force(q) by differences of positions; its first step is right, or leaves the force out.

    In place of differences, its velocities may be the kept ones of half a step before, and `kick` h times the force.
    """

    def __init__(self, right=True, kick=None):
        """Nothing remembered yet."""
        self.right, self.kick, self.before, self.begins = right, kick, None, True

    def step(self, force, q, v, h):
        """One step."""
        push = h * h * force(q)
        after = q + h * v + self.right * push / 2 if self.before is None else 2 * q - self.before + push
        self.before = q
        if self.kick is None:
            return after, (after - q) / h
        self.speed = v + h / 2 * force(q) if self.begins else self.speed + h * force(q)
        self.begins, after = False, q + h * self.speed
        return after, self.speed + self.kick * h * force(after)


def run_of_adams_bashforth3(f, y0, ts):
    """A run, written so that it has three times at least."""
    h, ys = ts[1] - ts[0], np.zeros((len(ts), len(y0)))
    ys[0] = y0
    for n in range(2):
        ys[n + 1] = rk4(f, ts[n], ys[n], h)
    for n in range(2, len(ts) - 1):
        slopes = [f(ts[m], ys[m]) for m in (n, n - 1, n - 2)]
        ys[n + 1] = ys[n] + h / 12 * (23 * slopes[0] - 16 * slopes[1] + 5 * slopes[2])
    return ys


def run_of(weights):
    """A run whose step of length h takes the newest slopes with a row of weights(h): the last, or as far as it is."""

    def run(f, y0, ts):
        ys, slopes = [np.array(y0)], []
        for t, after in pairwise(ts):
            slopes.insert(0, f(t, ys[-1]))
            row = weights(after - t)[: len(slopes)][-1]
            ys.append(ys[-1] + (after - t) * sum(b * k for b, k in zip(row, slopes, strict=False)))
        return np.array(ys)

    return run


run_of_adams_bashforth2 = run_of(lambda h: [[1.0], [1.5, -0.5]])
run_of_three_methods = run_of(lambda h: [[1.0], [1.5, -0.5], [23 / 12, -16 / 12, 5 / 12]])
# No linear multistep method: its weights are those of Adams and Bashforth at h = 1 only.
run_of_weights_that_change_with_h = run_of(lambda h: [[1.0], [1 + h / 2, -h / 2]])


def generated_adams_bashforth2(f, t, y, h):
    """A generator of states."""
    y, old = np.array(y), None
    yield y
    while True:
        slope = f(t, y)
        y, t, old = y + h * (slope if old is None else 1.5 * slope - 0.5 * old), t + h, slope
        yield y


def in_a_closure():
    """A function that remembers, of y alone."""
    before = []

    def step(y, f, h):
        before.append(f(y))
        return y + h * (1.5 * before[-1] - 0.5 * before[-2] if len(before) > 1 else before[-1])

    return step


_outside: list = []


def in_the_module(f, t, y, h, outside=_outside):
    """A function that remembers in its module, out of the reach of copies."""
    outside.append(f(t, y))
    known = len(outside) > 1 and np.shape(outside[-2]) == np.shape(outside[-1])
    return y + h * (1.5 * outside[-1] - 0.5 * outside[-2] if known else outside[-1])


def in_a_default(f, t, y, h, seen=[]):  # noqa: B006
    """A function that remembers in a default, which all runs of a process share."""
    return in_the_module(f, t, y, h, seen)
