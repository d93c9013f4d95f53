"""Implicit steps of any rate, what was left in a stage equation, and what rounding may do to one."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.problems.problem import EXACT, Problem, Reference
from driftproof.numeric.steps import newton
from driftproof.numeric.steps.implicit import NO_STEP, implicit_runner, require_done
from driftproof.numeric.steps.loops import FieldWriters
from driftproof.numeric.steps.tableaux import float_tableau

U = Fraction(1, 2**53)


class ImplicitStep(NamedTuple):
    """`residual` is the largest |g| left, in the units of y, and `over_floor` at most 1, its part of 8E + 4R."""

    y: Any
    residual: float
    over_floor: float
    iterations: int


def implicit_stepper(method, rate, jacobian=None):
    """Return step(t, y, h, steps) by the loops of any rate and any matrix, right or wrong; without one, by differences.

    Of several steps, residuals are the worst of one, iterations those of all.
    """
    table = implicit_runner(method, VectorField(("y0",))).table
    f, small = lambda t, y: np.asarray(rate(t, y), np.float64), 2.0**-20
    differences = lambda t, y: np.array([f(t, y + x) - f(t, y - x) for x in small * np.eye(len(y))]).T / (2 * small)

    def write(to, function, t, y):
        to[:] = np.asarray(function(t, np.array(y)), np.float64).tolist()

    writers = FieldWriters(
        lambda t, y, f: write(f, rate, t, y), lambda t, y, matrix: write(matrix, jacobian or differences, t, y)
    )

    def step(t, y, h, steps=1):
        state, report = np.array(y, np.float64).tolist(), list(NO_STEP)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            newton.run_steps(writers, t, state, h, 0, steps, table, report)
        require_done(method.key, report, t, h)
        found = report[newton.RESIDUAL], report[newton.OVER_FLOOR], int(report[newton.ITERATIONS])
        return ImplicitStep(np.array(state), *found)

    return step


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
