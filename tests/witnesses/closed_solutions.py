"""Initial value problems whose solutions are formulas, in balls; nothing of driftproof is used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random

import numpy as np
from flint import arb, arb_series


@dataclass(frozen=True)
class Solved:
    """y' = f(t, y) from `start` at t0, solved by `solution(t)`, which takes balls and series; good up to `end`."""

    f: Callable
    start: tuple[float, ...]
    end: float
    solution: Callable
    t0: float = 0.0


# Of random doubles: a rate a, which may be negative, a frequency w, and y0 and an end, which are positive.
FAMILIES: dict[str, Callable[[float, float, float, float], Solved]] = {
    "growth": lambda a, w, y0, end: Solved(
        lambda t, y: a * y + w, (y0,), end, lambda t: [(y0 + arb(w) / a) * (a * t).exp() - arb(w) / a]),
    "spiral": lambda a, w, y0, end: Solved(
        lambda t, y: np.array([[a, w], [-w, a]]) @ y, (y0, 0.0), end,
        lambda t: [y0 * (a * t).exp() * (w * t).cos(), -y0 * (a * t).exp() * (w * t).sin()]),
    "logistic": lambda a, w, y0, end: Solved(
        lambda t, y: [a * y[0] * (1 - y[0])], (y0,), end if a > 0 else end / 8,
        lambda t: [y0 / (y0 + (1 - arb(y0)) * (-a * t).exp())]),
    "tangent": lambda a, w, y0, end: Solved(lambda t, y: 1 + y**2, (0.0,), end, lambda t: [t.sin() / t.cos()]),
    "swing": lambda a, w, y0, end: Solved(
        lambda t, y: a * np.cos(t) * y, (y0,), end, lambda t: [y0 * (a * t.sin()).exp()]),
    "hyperbola": lambda a, w, y0, end: Solved(
        lambda t, y: -2 * t * y * y, (y0,), end, lambda t: [y0 / (1 + y0 * t * t)]),
    "square": lambda a, w, y0, end: Solved(
        lambda t, y: np.sqrt(y), (y0,), end, lambda t: [(arb(y0).sqrt() + t / 2) * (arb(y0).sqrt() + t / 2)]),
    "decay": lambda a, w, y0, end: Solved(lambda t, y: np.abs(y), (-y0,), end, lambda t: [-y0 * (-t).exp()]),
    "double exponential": lambda a, w, y0, end: Solved(
        lambda t, y: y * np.log(y), (y0,), end, lambda t: [(arb(y0).log() * t.exp()).exp()]),
    "cube": lambda a, w, y0, end: Solved(
        lambda t, y: -(y**3), (y0,), end, lambda t: [y0 / (1 + 2 * arb(y0) ** 2 * t).sqrt()]),
    "homogeneous": lambda a, w, y0, end: Solved(
        lambda t, y: y / t, (y0,), w + end, lambda t: [y0 / arb(w) * t], t0=w),
    "powers": lambda a, w, y0, end: Solved(
        lambda t, y: y**1.5, (y0,), end / 2, lambda t: [(1 / arb(y0).sqrt() - t / 2) ** -2]),
}  # fmt: skip


def drawn(random: Random) -> tuple[str, Solved]:
    """The name of one of the families, and the problem with random doubles."""
    a, w = random.uniform(-2, 2), random.uniform(0.2, 3)
    y0, end = random.uniform(0.1, 2), random.uniform(0.1, 1.5)
    name = random.choice([*FAMILIES])
    return name, FAMILIES[name](a, w, y0, end)


def kepler(e: arb, t: arb) -> list[arb]:
    """(x, y, x', y') on the ellipse of eccentricity e and semi-axis 1, a time t after the perihelion.

    Kepler's equation E - e sin E = t by Newton in balls: N(E) = m - F(m)/F'(E), each a subset of the last, proves E.
    """
    E = arb(t.mid(), 2)
    for _ in range(300):
        m = arb(E.mid())
        better = m - (m - e * m.sin() - t) / (1 - e * E.cos())
        if not better.overlaps(E):
            raise AssertionError("no solution there")
        narrower = better.intersection(E)
        if narrower.rad() >= E.rad():
            break
        E = narrower
    b, rate = (1 - e * e).sqrt(), 1 / (1 - e * E.cos())
    return [E.cos() - e, b * E.sin(), -E.sin() * rate, b * E.cos() * rate]


def rates_by_series(problem: Solved, t: float) -> list[tuple[arb, arb]]:
    """(y'(t) from the formula's series, y(t)) of each component."""
    return [(y[1], y[0]) for y in problem.solution(arb_series([t, 1], 2))]


def relaxed(random: Random) -> Solved:
    """y0 - sin t and y1 - cos t decay, at two rates of which one is 10² to 10⁶; all numbers in f are exact."""
    slow, fast = -random.randint(1, 8) / 4, -float(random.randint(1, 9) * 10 ** random.randint(2, 5))
    u, w = random.uniform(-1, 1), random.uniform(-1, 1)

    def f(t, y):
        a, b = y[0] - np.sin(t), y[1] - np.cos(t)
        return [slow * a + (fast - slow) * b + np.cos(t), fast * b - np.sin(t)]

    def solution(t):
        b = (arb(w) - 1) * (fast * t).exp()
        return [(arb(u) - (arb(w) - 1)) * (slow * t).exp() + b + t.sin(), b + t.cos()]

    return Solved(f, (u, w), random.uniform(0.5, 5), solution)
