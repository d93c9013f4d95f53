"""Implicit Runge-Kutta steps with the nonlinear solvers in use, as people write them: steps (f, t, y, h)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.matching.tables import exact_tableau
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from tests.plain_algebra import product, solved

Array: TypeAlias = "np.ndarray[Any, Any]"
# From a residual and a first guess to where the residual is about 0.
Solver: TypeAlias = Callable[[Callable[[Array], Array], Array], Array]
Table: TypeAlias = tuple[Sequence[Sequence[float]], Sequence[float], Sequence[float]]
# Nodes, A, and the weights of positions and of velocities.
Nystrom: TypeAlias = tuple[Any, Any, Any, Any]
G = 1 - 2**-0.5


def table(key: str) -> Table:
    """A, b and c of a method of the catalogue, as the nearest floats."""
    method = METHODS[key]
    assert isinstance(method, RungeKutta | Collocation)
    a, b, c = exact_tableau(method)
    return [[float(x) for x in row] for row in a], [float(x) for x in b], [float(x) for x in c]


def with_entry(key: str, row: int, column: int, value: float) -> Table:
    """The table of a method with another number in A."""
    a, b, c = table(key)
    changed = [list(entries) for entries in a]
    changed[row][column] = value
    return changed, b, c


def _jacobian(residual: Callable[[Array], Array], x: Array) -> Array:
    """By differences."""
    at = residual(x)
    return np.array([(residual(x + 2.0**-20 * e) - at) * 2.0**20 for e in np.eye(len(x))]).T


def _iterated(change_at: Callable[[Array], Array], x: Array, most: int, tolerance: float) -> Array:
    for _ in range(most):
        change = change_at(x)
        x = x - change
        if not np.abs(change).max() >= tolerance:
            break
    return x


def newton(residual: Callable[[Array], Array], x: Array, *, most: int = 50, tolerance: float = 1e-12) -> Array:
    """Newton's method until a change is below the tolerance, or after so many iterations; so the others."""
    return _iterated(lambda x: solved(_jacobian(residual, x), residual(x)), x, most, tolerance)


def simplified(residual: Callable[[Array], Array], x: Array, *, most: int = 50, tolerance: float = 1e-12) -> Array:
    """Newton's method with the first Jacobian kept."""
    jacobian = _jacobian(residual, x)
    return _iterated(lambda x: solved(jacobian, residual(x)), x, most, tolerance)


def fixed_point(residual: Callable[[Array], Array], x: Array, *, most: int = 200, tolerance: float = 1e-12) -> Array:
    """x ← x - residual, which is the map of the equation x = F(x)."""
    return _iterated(residual, x, most, tolerance)


def broyden(residual: Callable[[Array], Array], x: Array, *, tolerance: float = 1e-8) -> Array:
    """Broyden's method from a Jacobian by differences, to a relative tolerance: what MINPACK's hybrd does."""
    jacobian, at = _jacobian(residual, x), residual(x)
    for _ in range(100):
        change = -solved(jacobian, at)
        x, after = x + change, residual(x + change)
        jacobian, at = jacobian + np.outer(after, change) / max(product(change, change), 1e-300), after
        if not np.abs(change).max() > tolerance * np.abs(x).max():
            break
    return x


SOLVERS: dict[str, Solver] = {
    "Newton's method": newton,
    "Newton's method to 1e-6": partial(newton, tolerance=1e-6),
    "a Jacobian that is kept": simplified,
    "a Jacobian that is kept, to 1e-6": partial(simplified, tolerance=1e-6),
    "fixed-point iteration": fixed_point,
    "fixed-point iteration to 1e-6": partial(fixed_point, tolerance=1e-6),
    "Broyden's method": broyden,
}


def all_at_once(coefficients: Table, solver: Solver = newton) -> Callable[..., Array]:
    """One system for the slopes of all stages."""
    a, b, c = (np.array(x) for x in coefficients)

    def step(f: Callable[..., Any], t: float, y: Any, h: float) -> Array:
        start = np.asarray(y, dtype=float)
        shape = (len(b), len(start))

        def residual(k: Array) -> Array:
            places = start + h * product(a, k.reshape(shape))
            return k - np.array([f(t + node * h, place) for node, place in zip(c, places, strict=True)]).ravel()

        slopes: Array = solver(residual, np.zeros(shape[0] * shape[1])).reshape(shape)
        return start + h * product(b, slopes)

    return step


def one_by_one(coefficients: Table, solver: Solver = newton) -> Callable[..., Array]:
    """A system for the place of each stage, or none where it is explicit."""
    a, b, c = coefficients

    def step(f: Callable[..., Any], t: float, y: Any, h: float) -> Array:
        start, slopes = np.asarray(y, dtype=float), list[Array]()
        for i, node in enumerate(c):
            known = start + h * sum((a[i][j] * slopes[j] for j in range(i)), 0 * start)
            if not a[i][i]:
                slopes.append(np.asarray(f(t + node * h, known)))
                continue
            at: Callable[[Array], Array] = lambda x, i=i, node=node, known=known: (
                x - known - h * a[i][i] * np.asarray(f(t + node * h, x))
            )
            slopes.append((solver(at, known.copy()) - known) / (h * a[i][i]))
        return start + h * sum((x * k for x, k in zip(b, slopes, strict=True)), 0 * start)

    return step


def untimed(step: Callable[..., Array]) -> Callable[..., Array]:
    """The same for y' = f(y)."""
    return lambda f, y, h: step(lambda t, x: f(x), 0.0, y, h)


def of_force(table: Nystrom, solver: Solver = newton, *, timed: bool = True) -> Callable[..., tuple[Array, Array]]:
    """One system for the forces of all stages, of a force of position and time."""
    c, a, b_position, b_velocity = (np.array(x, dtype=float) for x in table)

    def step(force: Callable[..., Any], x: Any, v: Any, t: float, dt: float) -> tuple[Array, Array]:
        q, w = np.atleast_1d(x), np.atleast_1d(v)
        shape = (len(c), len(q))

        def residual(k: Array) -> Array:
            places = q + np.outer(c, dt * w) + dt**2 * product(a, k.reshape(shape))
            asked = (force(y, t + node * dt) if timed else force(y) for node, y in zip(c, places, strict=True))
            return k - np.array([*asked]).ravel()

        pushes = solver(residual, np.zeros(shape[0] * shape[1])).reshape(shape)
        return q + dt * w + dt**2 * product(b_position, pushes), w + dt * product(b_velocity, pushes)

    return step if timed else lambda force, x, v, dt: step(force, x, v, 0.0, dt)


def induced(key: str) -> Nystrom:
    """A Runge-Kutta method as one of q'' = F(t, q)."""
    a, b, c = (np.array(x) for x in table(key))
    return c, product(a, a), product(b, a), b
