"""Multistep methods by their definitions, and their steps in floats: interpolation, companion matrices, plain loops."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction as Q

import numpy as np

from driftproof.methods.multistep import Multistep
from tests.methods.tables.entries import product

Numbers = Sequence[Q]


def lagrange(nodes: Sequence[Q | int]) -> list[Numbers]:
    """Lagrange's polynomials of the nodes, constant term first."""
    found = []
    for node in nodes:
        basis: Numbers = (Q(1),)
        for other in nodes:
            if other != node:
                basis = product(basis, (Q(-other, node - other), Q(1, node - other)))
        found.append(basis)
    return found


def integral(p: Numbers, end: Q) -> Q:
    """The integral of a polynomial from 0."""
    return sum((c * end ** (j + 1) / (j + 1) for j, c in enumerate(p)), Q(0))


def adams(steps: int, *, implicit: bool, back: int = 1) -> Multistep:
    """y(k) - y(k - back) = the integral of the polynomial through the slopes at 0, ..., k - 1, and k if implicit."""
    rho = [Q(0)] * (steps - back) + [Q(-1)] + [Q(0)] * (back - 1) + [Q(1)]
    made = [integral(p, Q(steps)) - integral(p, Q(steps - back)) for p in lagrange(range(steps + implicit))]
    sigma = made + [Q(0)] * (not implicit)
    return Multistep("adams", "", 0, "", tuple(rho), tuple(sigma))


def bdf(steps: int) -> Multistep:
    """The derivative at k of the polynomial through the values at 0, ..., k is the slope there."""
    rho = [sum((j * c * Q(steps) ** (j - 1) for j, c in enumerate(p) if j), Q(0)) for p in lagrange(range(steps + 1))]
    return Multistep("bdf", "", 0, "", tuple(rho), (*[Q(0)] * steps, Q(1)))


def roots(method: Multistep, z: complex) -> np.ndarray:
    """The ζ with ρ(ζ) = zσ(ζ), in floats."""
    coefficients = [complex(r) - z * complex(s) for r, s in zip(method.rho, method.sigma, strict=True)]
    return np.roots(coefficients[::-1])


def largest(method: Multistep, z: complex) -> float:
    """The largest |ζ| at z."""
    return float(max(abs(roots(method, z))))


def error_at_one(method: Multistep, steps: int) -> float:
    """|y - exact| at t = 1 on y' = -y², or y'' = 2y³, y = 1/(1 + t), from exact starting values."""
    h, k, d = 1 / steps, method.steps, method.derivative
    rho, sigma = ([float(x) for x in row] for row in (method.rho, method.sigma))
    force: Callable[[float], float] = (lambda y: -y * y) if d == 1 else (lambda y: 2 * y**3)
    values = [1 / (1 + j * h) for j in range(k)]
    for _ in range(steps - k + 1):
        known = sum(-r * y + h**d * s * force(y) for r, s, y in zip(rho, sigma, values[-k:], strict=False))
        y = values[-1]
        for _ in range(60):  # a contraction for these h
            y = (known + h**d * sigma[k] * force(y)) / rho[k]
        values.append(y)
    return abs(values[-1] - 0.5)
