"""Steps of Rosenbrock methods in floats: each stage solves one linear system with the Jacobian, without iteration."""

from __future__ import annotations

from functools import cache, partial
from itertools import pairwise
from math import isfinite
from typing import Any, NamedTuple

from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.vector_fields import VectorField
from driftproof.numeric import newton
from driftproof.numeric.elimination import Band, factored, solve
from driftproof.numeric.field_loops import field_writers
from driftproof.numeric.implicit import ImplicitRun
from driftproof.numeric.loops import FieldWriters, loop, maker_of_rows


class RosenbrockTable(NamedTuple):
    """The coefficients in the form that the loops read. If f reads t, then t is `timed`: one more component."""

    alpha: Any
    gamma: Any
    b: Any
    anew: Any  # whether the stage needs f at another place than the stage before
    timed: bool


def rosenbrock_runner(method: Rosenbrock, field: VectorField, *, compiled: bool = False) -> ImplicitRun:
    """The loop of a Rosenbrock method on floats or, with the same bits, compiled; J and ∂f/∂t are exact formulas."""
    made = maker_of_rows(compiled=compiled)
    stages = max((i for i, x in enumerate(method.b, 1) if x), default=1)  # those behind are for an error estimate
    alpha, gamma = ([[*map(float, row)] for row in rows[:stages]] for rows in (method.alpha, method.gamma))
    anew = [True, *(before != row for before, row in pairwise(method.alpha[:stages]))]
    b = [*map(float, method.b[:stages])]
    table = RosenbrockTable(made(alpha), made(gamma), made(b), anew, not field.autonomous)
    writers = field_writers(field if field.autonomous else _made_autonomous(field), compiled=compiled)
    return ImplicitRun(method.key, partial(loop(run_rosenbrock, compiled=compiled), writers), table, made)


@cache
def _made_autonomous(field: VectorField) -> VectorField:
    """The same system with t as its last component, whose rate is 1."""
    return VectorField((*field.at({"t": f"y{len(field.rates)}"}), "1"), field.parameters)


def _factored_stage_matrix(matrix: Any, order: Any, step: float, jacobian: Any, band: Band) -> bool:
    """Overwrite the matrix with the factors of I - hγJ, `step` = hγ; False if it is singular."""
    n = len(jacobian)
    for i in range(n):
        row, first = matrix[i], max(0, i - band.lower)
        for j in range(len(row)):
            row[j] = 0.0
        for j in range(first, min(n, i + band.upper + 1)):
            row[j - first] = -(step * jacobian[i][j - first])
        row[i - first] += 1.0
    return factored(matrix, order, n, band.lower, band.upper)


def _add_weighted(weights: Any, rows: Any, count: int, k: int) -> float:
    """Σ wⱼ times the k-th entry of row j, over the first `count` rows."""
    total = 0.0
    for j in range(count):
        total += weights[j] * rows[j][k]
    return total


def _take_step(writers: FieldWriters, y: Any, h: float, table: RosenbrockTable, report: Any) -> int:
    """Take one step of an autonomous system in place; return DONE, SINGULAR or OVERFLOWS."""
    n, stages, zeros, band = len(y), len(table.b), writers.zeros, writers.band
    width = min(n, band.lower + band.upper + 1)
    jacobian, matrix, order = zeros(n, width), zeros(n, min(n, width + band.lower)), writers.indices(n)
    slopes, place, rate, mixed, factor = zeros(stages, n), zeros(n), zeros(n), zeros(n), 0.0
    writers.jacobian(0.0, y, jacobian)
    for i in range(stages):
        if table.anew[i]:
            for k in range(n):
                place[k] = y[k] + h * _add_weighted(table.alpha[i], slopes, i, k)
            writers.rate(0.0, place, rate)
            report[newton.EVALUATIONS] += 1
        for k in range(n):
            mixed[k] = _add_weighted(table.gamma[i], slopes, i, k)
        for k in range(n):
            total, first = 0.0, max(0, k - band.lower)
            for j in range(first, min(n, k + band.upper + 1)):
                total += jacobian[k][j - first] * mixed[j]
            slopes[i][k] = rate[k] + h * total
        diagonal = table.gamma[i][i]
        if diagonal != 0:
            if diagonal != factor and not _factored_stage_matrix(matrix, order, h * diagonal, jacobian, band):
                return newton.SINGULAR
            factor = diagonal
            solve(matrix, order, n, slopes[i], band.lower, band.upper)
    finite = True
    for k in range(n):
        y[k] += h * _add_weighted(table.b, slopes, stages, k)
        finite = finite and isfinite(y[k])
    return newton.DONE if finite else newton.OVERFLOWS


def run_rosenbrock(
    writers: FieldWriters, t: float, y: Any, h: float, first: int, last: int, table: RosenbrockTable, report: Any
) -> None:
    """Take steps first to last - 1, step i from t + i h; stop at the first that fails."""
    n = len(y)
    state = writers.zeros(n + 1 if table.timed else n)
    for k in range(n):
        state[k] = y[k]
    for i in range(first, last):
        if table.timed:
            state[n] = t + i * h
        report[newton.STATE] = _take_step(writers, state, h, table, report)
        if report[newton.STATE] != newton.DONE:
            report[newton.STEP] = i
            break
    for k in range(n):
        y[k] = state[k]
