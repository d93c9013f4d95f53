"""One step of any method, over any kind of number: floats, arrays, fractions, polynomials, balls."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from methods.schemes import Method, MethodError, Nystrom, RungeKutta, Splitting, nonzero

# Any type with + and * (and what its force needs); the arithmetic is the type's own.
Number: TypeAlias = Any
Force: TypeAlias = Callable[[Number], Number]
Step: TypeAlias = Callable[[Force, Number, Number, Number], tuple[Number, Number]]
# From an Exact; not typed so, because an arithmetic may know rationals only and refuse the rest.
Lift: TypeAlias = Callable[[Any], Number]


def stepper(method: Method, lift: Lift) -> Step:
    """The step (force, q, v, h) → (q₁, v₁) of `method` for q' = v, v' = force(q).

    `lift` carries each exact coefficient into the number type of q, v and h. It is the only door: relying on
    coercion would turn `Fraction * ndarray` into an object array and `Fraction * float32` into a Python float.
    The step holds no literal and no branch on a value, and drops zero coefficients.
    Raises MethodError for an implicit method, whose stages are equations rather than formulas.
    """
    if isinstance(method, Splitting):
        return _splitting_stepper(method, lift)
    if not method.explicit or not isinstance(method, RungeKutta | Nystrom):
        raise MethodError(f"{method.key} is implicit: its stages are equations, so it has no explicit step")
    if isinstance(method, Nystrom):
        return _nystrom_stepper(method, lift)
    return _runge_kutta_stepper(method, lift)


def _splitting_stepper(method: Splitting, lift: Lift) -> Step:
    parts = [(kind, lift(c)) for kind, c in method.parts if c != 0]

    def step(force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        for kind, c in parts:
            if kind == "kick":
                v = v + (c * h) * force(q)
            else:
                q = q + (c * h) * v
        return q, v

    return step


def _runge_kutta_stepper(method: RungeKutta, lift: Lift) -> Step:
    rows = [[(j, lift(x)) for j, x in nonzero(row)] for row in method.a]
    weights = [(i, lift(x)) for i, x in nonzero(method.b)]

    def step(force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        slopes: list[tuple[Number, Number]] = []
        for row in rows:
            stage_q, stage_v = _advance(row, slopes, q, v, h)
            slopes.append((stage_v, force(stage_q)))
        return _advance(weights, slopes, q, v, h)

    return step


def _nystrom_stepper(method: Nystrom, lift: Lift) -> Step:
    rows = [[(j, lift(x)) for j, x in nonzero(row)] for row in method.a]
    nodes = [lift(c) if c != 0 else None for c in method.c]
    in_position = [(i, lift(x)) for i, x in nonzero(method.b_position)]
    in_velocity = [(i, lift(x)) for i, x in nonzero(method.b_velocity)]

    def step(force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        forces: list[Number] = []
        for node, row in zip(nodes, rows, strict=True):
            stage = q if node is None else q + (node * h) * v
            forces.append(force(_pushed(stage, row, forces, h * h)))
        return _pushed(q + h * v, in_position, forces, h * h), _pushed(v, in_velocity, forces, h)

    return step


def _pushed(start: Number, weights: list[tuple[int, Number]], forces: list[Number], h: Number) -> Number:
    """start + h Σ wᵢ kᵢ, the sum taken from the left."""
    if not weights:
        return start
    (i, w), *rest = weights
    total = w * forces[i]
    for i, w in rest:
        total = total + w * forces[i]
    return start + h * total


def _advance(
    weights: list[tuple[int, Number]], slopes: list[tuple[Number, Number]], q: Number, v: Number, h: Number
) -> tuple[Number, Number]:
    """(q, v) + h Σ wᵢ kᵢ, the sum taken from the left."""
    if not weights:
        return q, v
    (i, w), *rest = weights
    dq, dv = w * slopes[i][0], w * slopes[i][1]
    for i, w in rest:
        dq, dv = dq + w * slopes[i][0], dv + w * slopes[i][1]
    return q + h * dq, v + h * dv
