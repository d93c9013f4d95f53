"""Many implicit steps in a row, the worst that was left in a stage equation, and what rounding may do to one."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from driftproof.methods.vector_fields import VectorField
from driftproof.numeric.implicit import ImplicitStep, ImplicitStepper
from driftproof.numeric.problems.problem import EXACT, Problem, Reference
from driftproof.numeric.tableaux import float_tableau

U = Fraction(1, 2**53)


def implicit_run(step: ImplicitStepper, y: Any, h: float, steps: int) -> ImplicitStep:
    """So many steps from t = 0; the i-th from i h. Residuals are the worst of a step, iterations those of all."""
    found = []
    for i in range(steps):
        found.append(step(i * h, y, h))
        y = found[-1].y
    worst = (max((x.residual for x in found), default=0.0), max((x.over_floor for x in found), default=0.0))
    return ImplicitStep(y, *worst, sum(x.iterations for x in found))


def made_problem(rates: tuple[str, ...], start: tuple[float, ...]) -> Problem:
    """y' = f(t, y) from this start to t = 1, where the reference does not know the solution."""
    reference = Reference((Fraction(1),), (("0",) * len(rates),), EXACT, "none")
    return Problem("made", "Made", VectorField(rates), tuple(map(Fraction, start)), reference, "a test")


def oscillator(t, y):
    return [y[1], -y[0]]


def rounding_of_a_step(method, h):
    """A bound on the error of a step of the oscillator from the unit circle, to first order in u.

    A component of a residual is at most 8E + 4R, where |Z|, |w| <= 2hw, w being the largest sum of |A| in a row and at
    least 1, |f| and |y + Z| <= 2, |J| = 1: E <= u hw (8 + 2 (s + 20) + 34), R <= u (2hw + 2h²w²). Stage by stage, the
    slope (Z - w)/aⱼⱼ takes a residual into those that follow. (I - hA⊗J)⁻¹ makes an error of Z of it, d or b one of y₁,
    whose formula rounds s + 1 terms of at most 2hw and the sum, of at most 2.
    """
    table = float_tableau(method)
    a, s = np.abs(table.a), table.stages
    w = max(1.0, float(a.sum(axis=1).max()))
    floor = 8 * h * w * (8 + 2 * (s + 20) + 34) + 4 * (2 * h * w + 2 * h * h * w * w)
    if not np.triu(a, 1).any():
        floor *= 1 + max(sum(a[i, j] / a[j, j] for j in range(i) if a[j, j] > 0) for i in range(s))
    inverse = np.linalg.inv(np.eye(2 * s) - h * np.kron(table.a, [[0, 1], [-1, 0]]))
    weights = 1.0 if table.stiffly_accurate else float(np.abs(table.b if table.d is None else table.d).sum())
    return float(U) * (np.abs(inverse).sum(axis=1).max() * floor * weights + (s + 1) * 2 * h * w * weights + 4)
