"""Steps of Rosenbrock methods in floats: each stage solves one linear system with the Jacobian, without iteration.

An attempt of a pair is repeated with a shorter h by the same Jacobian and the same f(y); see `numeric.steps.step_control`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from itertools import pairwise
from math import inf, isfinite
from typing import Any, NamedTuple

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.numeric.steps import newton
from driftproof.numeric.steps.elimination import solve
from driftproof.numeric.steps.field_loops import field_writers
from driftproof.numeric.steps.implicit import ImplicitRun
from driftproof.numeric.steps.loops import FieldWriters, loop, maker_of_rows
from driftproof.numeric.steps.newton import Layout, combined, factored_newton_matrix
from driftproof.numeric.steps.step_control import EVALUATIONS, StepControl, error_size


class RosenbrockTable(NamedTuple):
    """The coefficients in the form that the loops read. If f reads t, then t is `timed`: one more component."""

    alpha: Any
    gamma: Any
    b: Any
    off: Any  # b - b_embedded, or nothing
    anew: Any  # whether the stage needs f at another place than the stage before
    timed: bool


class RosenbrockWork(NamedTuple):
    """What the stages of a step are computed in: J and f at its start, its slopes, and the workspace of one stage."""

    jacobian: Any
    begin: Any
    slopes: Any
    matrix: Any
    order: Any
    place: Any
    rate: Any
    mixed: Any


def rosenbrock_runner(method: Rosenbrock, field: VectorField, *, compiled: bool = False) -> ImplicitRun:
    """The loop of a Rosenbrock method on floats or, with the same bits, compiled; J and ∂f/∂t are exact formulas."""
    table = rosenbrock_table(method, (), field, compiled=compiled)
    steps = partial(loop(run_rosenbrock, compiled=compiled), autonomous_writers(field, compiled=compiled))
    return ImplicitRun(method.key, steps, table, maker_of_rows(compiled=compiled))


def rosenbrock_table(
    method: Rosenbrock, off: Sequence[Exact], field: VectorField, *, compiled: bool
) -> RosenbrockTable:
    """The stages that b or `off` weighs, those weights, and whether the field reads t."""
    made = maker_of_rows(compiled=compiled)
    stages = max((i for row in (method.b, off) for i, x in enumerate(row, 1) if x), default=1)
    rows = [[*map(float, row[:stages])] for row in (*method.alpha[:stages], *method.gamma[:stages], method.b, off)]
    anew = [False, *(before != row for before, row in pairwise(method.alpha[:stages]))]
    alpha, gamma = (made(rows[i : i + stages]) for i in (0, stages))
    return RosenbrockTable(alpha, gamma, made(rows[-2]), made(rows[-1]), anew, not field.autonomous)


def autonomous_writers(field: VectorField, *, compiled: bool) -> FieldWriters:
    """The functions of the field that the loops call; if it reads t, of the system with t as its last component."""
    return field_writers(field if field.autonomous else _made_autonomous(field), compiled=compiled)


def work_of_stages(n: int, table: RosenbrockTable, writers: FieldWriters) -> RosenbrockWork:
    """Allocate the workspace for a system of n equations."""
    band, zeros = writers.band, writers.zeros
    width = min(n, band.lower + band.upper + 1)
    vectors, matrix = [zeros(n) for _ in range(4)], zeros(n, min(n, width + band.lower))
    begin, place, rate, mixed = vectors
    stages = zeros(len(table.b), n)
    return RosenbrockWork(zeros(n, width), begin, stages, matrix, writers.indices(n), place, rate, mixed)


@cache
def _made_autonomous(field: VectorField) -> VectorField:
    """The same system with t as its last component, whose rate is 1."""
    return VectorField((*field.at({"t": f"y{len(field.rates)}"}), "1"), field.parameters)


def _begin_step(writers: FieldWriters, y: Any, work: RosenbrockWork) -> None:
    """Evaluate J and f at the start of a step."""
    writers.jacobian(0.0, y, work.jacobian)
    writers.rate(0.0, y, work.begin)


def _solve_stages(
    writers: FieldWriters, y: Any, h: float, table: RosenbrockTable, work: RosenbrockWork
) -> tuple[int, bool]:
    """Write the slopes of an autonomous system; return the calls of f, and False if a matrix is singular."""
    jacobian, begin, slopes, matrix, order, place, rate, mixed = work
    n, band, factor, calls = len(y), writers.band, 0.0, 0
    for k in range(n):
        rate[k] = begin[k]
    for i in range(len(table.b)):
        if table.anew[i]:
            for k in range(n):
                place[k] = y[k] + h * combined(table.alpha[i], slopes, i, k)
            writers.rate(0.0, place, rate)
            calls += 1
        for k in range(n):
            mixed[k] = combined(table.gamma[i], slopes, i, k)
        for k in range(n):
            total, first = 0.0, max(0, k - band.lower)
            for j in range(first, min(n, k + band.upper + 1)):
                total += jacobian[k][j - first] * mixed[j]
            slopes[i][k] = rate[k] + h * total
        diagonal = table.gamma[i][i]
        if diagonal != 0:
            if diagonal != factor:
                factor, layout = diagonal, Layout(n, 1, band.lower, band.upper)
                if not factored_newton_matrix(band, h, ((diagonal,),), (jacobian,), matrix, order, layout):
                    return calls, False
            solve(matrix, order, n, slopes[i], band.lower, band.upper)
    return calls, True


def run_rosenbrock(
    writers: FieldWriters, t: float, y: Any, h: float, first: int, last: int, table: RosenbrockTable, report: Any
) -> None:
    """Take steps first to last - 1, step i from t + i h; stop at the first that fails."""
    n = len(y)
    state = writers.zeros(n + 1 if table.timed else n)
    work = work_of_stages(len(state), table, writers)
    for k in range(n):
        state[k] = y[k]
    for i in range(first, last):
        if table.timed:
            state[n] = t + i * h
        _begin_step(writers, state, work)
        calls, regular = _solve_stages(writers, state, h, table, work)
        report[newton.EVALUATIONS] += 1 + calls
        report[newton.STATE] = newton.DONE if regular else newton.SINGULAR
        if regular:
            for k in range(len(state)):
                state[k] += h * combined(table.b, work.slopes, len(table.b), k)
                if not isfinite(state[k]):
                    report[newton.STATE] = newton.OVERFLOWS
        if report[newton.STATE] != newton.DONE:
            report[newton.STEP] = i
            break
    for k in range(n):
        y[k] = state[k]


def rosenbrock_attempt(
    writers: FieldWriters, t: float, y: Any, h: float, moved: bool, new: Any, control: StepControl
) -> float:
    """Attempt a step of an autonomous system; the error is h Σ (bᵢ - b̂ᵢ) kᵢ."""
    given, table, work, report, _, _ = control
    if moved:
        _begin_step(writers, y, work)
        report[EVALUATIONS] += 1
    calls, regular = _solve_stages(writers, y, h, table, work)
    report[EVALUATIONS] += calls
    if not regular:
        return inf
    for k in range(len(y)):
        new[k] = y[k] + h * combined(table.b, work.slopes, len(table.b), k)
        work.place[k] = h * combined(table.off, work.slopes, len(table.b), k)
    return error_size(work.place, y, new, given)
