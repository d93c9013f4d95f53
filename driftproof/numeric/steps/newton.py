"""Newton's method for the stage equations of implicit steps: loops over numbers, as `numeric.steps.loops` says.

`numeric.steps.implicit` says what these loops solve and when a step counts as solved; its terms are used here.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import Any, NamedTuple

import numpy as np

from driftproof.numeric.steps.elimination import FULL, Band, factored, sign_of_determinant, solve
from driftproof.numeric.steps.loops import FieldWriters

UNIT = float(np.finfo(np.float64).epsneg)  # u = 2⁻⁵³
ETA = float(np.finfo(np.float64).smallest_subnormal)
# m, iterations and rates of convergence in `numeric.steps.implicit`; m is chosen: a larger one accepts larger residuals.
RATE_ROUNDINGS = 16
MOST_ITERATIONS = 128
SHRINKS, HALVES = 0.125, 0.5
# Damping shortens no correction further than this: one that helps only in a smaller part leads nowhere.
SHORTEST = 2.0**-20

# Indices in a report: counts over all steps, the largest residual, and, for a step that fails, its outcome, its number
# and the iterations, residual and time of its undamped attempt; the number of its system in an ensemble; and the end of
# the first step past a singular matrix, as `numeric.steps.implicit` says, 0 for none.
ITERATIONS, EVALUATIONS, RESIDUAL, OVER_FLOOR, STATE, STEP, TRIED, LEFT, LEFT_OVER_FLOOR, TIME, SYSTEM, PAST = range(12)
DONE, UNSOLVED, OVERFLOWS, SINGULAR = range(4)
# How the new state is formed: it is the last stage, or is formed from the moves, or from the slopes.
LAST, MOVES, SLOPES = range(3)


class StepTable(NamedTuple):
    """A tableau in the form that the loops read; stages first to last - 1 of a group are solved together."""

    a: Any
    weights: Any  # d or b
    c: Any
    groups: Any  # (first, last) of each group
    way: int


class Equations(NamedTuple):
    """The equations Z = w + h A f(t + c h, y + Z) of one group of stages; w is `known`."""

    t: float
    y: Any
    h: float
    a: Any
    c: Any
    known: Any


class Layout(NamedTuple):
    """The order of the unknowns: component k of stage i has the number i `stage` + k `component`; and the band of M."""

    stage: int
    component: int
    lower: int
    upper: int


def _copy_rows(rows: Any, to: Any) -> None:
    """Overwrite rows with others."""
    for i in range(len(rows)):
        for k in range(len(rows[i])):
            to[i][k] = rows[i][k]


def add_to(y: Any, move: Any, place: Any) -> None:
    """Write y + Z into `place`."""
    for k in range(len(y)):
        place[k] = y[k] + move[k]


def combined(weights: Any, rows: Any, count: int, k: int) -> float:
    """Σ wⱼ times the k-th entry of row j, over the first `count` rows."""
    total = 0.0
    for j in range(count):
        total += weights[j] * rows[j][k]
    return total


def _largest_entry(rows: Any) -> float:
    """The largest entry in absolute value."""
    found = 0.0
    for row in rows:
        for value in row:
            if not abs(value) <= found:
                found = abs(value)
    return found


def residual(writers: FieldWriters, equations: Equations, moves: Any, jacobians: Any, g: Any) -> float:
    """Write g = Z - w - h A f; return the largest |g| over its floor, 8E + 4R, or inf if one is not finite."""
    t, y, h, a, c, known = equations
    zeros, (lower, upper) = writers.zeros, writers.band
    n, stages, size = len(y), len(a), abs(h)
    slopes, at_place, at_move, whole = zeros(stages, n), zeros(stages, n), zeros(stages, n), zeros(stages, n)
    place = zeros(n)
    for j in range(stages):
        add_to(y, moves[j], place)
        writers.rate(t + c[j] * h, place, slopes[j])
        for k in range(n):
            row, first = jacobians[j][k], max(0, k - lower)
            for i in range(first, min(n, k + upper + 1)):
                entry = abs(row[i - first])
                at_place[j][k] += entry * abs(place[i])
                at_move[j][k] += entry * abs(moves[j][i])
                whole[j][k] += entry
    worst = 0.0
    for i in range(stages):
        for k in range(n):
            total = flow = of_place = of_move = of_whole = 0.0
            for j in range(stages):
                weight = abs(a[i][j])
                total += a[i][j] * slopes[j][k]
                flow += weight * abs(slopes[j][k])
                of_place += weight * at_place[j][k]
                of_move += weight * at_move[j][k]
                of_whole += weight * whole[j][k]
            move = moves[i][k]
            g[i][k] = value = move - known[i][k] - h * total
            flow *= (stages + 4 + RATE_ROUNDINGS) * size
            e = UNIT * (2 * abs(move) + 2 * abs(known[i][k]) + flow + (RATE_ROUNDINGS + 1) * (size * of_place))
            r = UNIT * (abs(move) + size * of_move) + ETA * (1 + size * of_whole)
            part = abs(value) / (8 * (e + (stages + 1) * (1 + size) * ETA) + 4 * r)
            if part > worst or not isfinite(value) or not isfinite(part):
                worst = part if isfinite(value) and isfinite(part) else inf
    return worst


def _layout(band: Band, n: int, stages: int) -> Layout:
    """Order the unknowns stage by stage or, for the matrix to be a band, component by component."""
    lower, upper = band
    if lower == FULL.lower:
        return Layout(n, 1, lower, upper)
    return Layout(1, stages, stages * (lower + 1) - 1, stages * (upper + 1) - 1)


def _corrections(m: Any, order: Any, layout: Layout, g: Any, x: Any) -> float:
    """Write x = M⁻¹ g; return |x|²."""
    for i in range(len(g)):
        for k in range(len(g[0])):
            x[i * layout.stage + k * layout.component] = g[i][k]
    solve(m, order, len(x), x, layout.lower, layout.upper)
    square = 0.0
    for value in x:
        square += value * value
    return square


def _derivatives_at(writers: FieldWriters, equations: Equations, moves: Any, jacobians: Any) -> None:
    """Write f' at each stage into `jacobians`."""
    t, y, h, _, c, _ = equations
    place = writers.zeros(len(y))
    for i in range(len(moves)):
        add_to(y, moves[i], place)
        writers.jacobian(t + c[i] * h, place, jacobians[i])


def factored_newton_matrix(band: Band, h: float, a: Any, jacobians: Any, m: Any, order: Any, layout: Layout) -> bool:
    """Overwrite M with the factors of I - h (aᵢⱼ Jⱼ); False if it is singular."""
    n = len(jacobians[0])
    for row in m:
        for k in range(len(row)):
            row[k] = 0.0
    for i in range(len(a)):
        for k in range(n):
            at, first = i * layout.stage + k * layout.component, max(0, k - band.lower)
            row, start = m[at], max(0, at - layout.lower)
            for j in range(len(a)):
                factor = h * a[i][j]
                for column in range(first, min(n, k + band.upper + 1)):
                    place = j * layout.stage + column * layout.component - start
                    row[place] = -(factor * jacobians[j][k][column - first])
            row[at - start] += 1.0
    return factored(m, order, len(m), layout.lower, layout.upper)


def _factored_at(writers: FieldWriters, equations: Equations, moves: Any, jacobians: Any, m: Any, order: Any) -> bool:
    """Overwrite M with the factors of Newton's matrix at these moves; False if it is singular."""
    band, layout = writers.band, _layout(writers.band, len(equations.y), len(equations.a))
    _derivatives_at(writers, equations, moves, jacobians)
    for j in range(len(moves), len(equations.a)):
        _copy_rows(jacobians[0], jacobians[j])
    return factored_newton_matrix(band, equations.h, equations.a, jacobians, m, order, layout)


def _moved(now: Any, part: float, x: Any, layout: Layout, trial: Any) -> None:
    """Write Z less this part of the correction x into `trial`."""
    for i in range(len(now)):
        for k in range(len(now[0])):
            trial[i][k] = now[i][k] - part * x[i * layout.stage + k * layout.component]


def _solved_group(
    writers: FieldWriters, equations: Equations, start: Any, moves: Any, report: Any, damped: bool
) -> bool:
    """Solve for the moves Z of one group of stages, from Z = start; report residual and iterations. True if solved.

    Damped, the matrix is made anew in each iteration, and a correction is shortened until the next one, by the same
    matrix, is shorter than it: the natural test (hairer-wanner-1996, IV.8).
    """
    n, stages, zeros, band = len(equations.y), len(equations.a), writers.zeros, writers.band
    layout, size = _layout(band, n, stages), stages * n
    jacobians = zeros(stages, n, min(n, band.lower + band.upper + 1))
    m, order = zeros(size, min(size, 2 * layout.lower + layout.upper + 1)), writers.indices(size)
    g, x, next_x = zeros(stages, n), zeros(size), zeros(size)
    now, trial = zeros(stages, n), zeros(stages, n)
    for i in range(stages):
        for k in range(n):
            moves[i][k] = now[i][k] = start[k]
    regular = _factored_at(writers, equations, now[:1], jacobians, m, order)
    ratio = residual(writers, equations, now, jacobians, g)
    best, left, iterations = ratio, _largest_entry(g), 0
    while regular and iterations < MOST_ITERATIONS and isfinite(ratio):
        square, part, before, good = _corrections(m, order, layout, g, x), 2.0, ratio, False
        while not good:
            iterations += 1
            part /= 2
            _moved(now, part, x, layout, trial)
            ratio = residual(writers, equations, trial, jacobians, g)
            good = not damped or ratio <= 1 or part < SHORTEST
            good = good or (isfinite(ratio) and _corrections(m, order, layout, g, next_x) < square)
        now, trial = trial, now
        if ratio < best:
            best, left = ratio, _largest_entry(g)
            _copy_rows(now, moves)
        if best <= 1 and not ratio < HALVES * before:
            break
        if damped or ratio > SHRINKS * before:
            regular = _factored_at(writers, equations, now, jacobians, m, order)
    report[ITERATIONS] += iterations
    report[EVALUATIONS] += stages * (1 + iterations)
    solved = best <= 1
    if solved:
        report[RESIDUAL], report[OVER_FLOOR] = max(report[RESIDUAL], left), max(report[OVER_FLOOR], best)
        if report[PAST] == 0 and sign_of_determinant(m, order, size, layout.lower) < 0:  # perhaps not so at the root
            regular = _factored_at(writers, equations, moves, jacobians, m, order)
            if regular and sign_of_determinant(m, order, size, layout.lower) < 0:
                report[PAST] = equations.t + equations.h
    elif not damped:
        report[TRIED], report[TIME] = iterations, equations.t + equations.c[stages - 1] * equations.h
        report[LEFT], report[LEFT_OVER_FLOOR] = left, best
    return solved


def solved_group(writers: FieldWriters, equations: Equations, start: Any, moves: Any, report: Any) -> bool:
    """Solve for the moves Z from Z = start, damped if it fails without damping; True if solved."""
    plain = _solved_group(writers, equations, start, moves, report, damped=False)
    return plain or _solved_group(writers, equations, start, moves, report, damped=True)


def _group_equations(
    writers: FieldWriters, t: float, y: Any, h: float, table: StepTable, first: int, last: int, slopes: Any
) -> Equations:
    """The equations of stages first to last - 1, given h f at the stages before them."""
    stages = last - first
    a, c, known = writers.zeros(stages, stages), writers.zeros(stages), writers.zeros(stages, len(y))
    for i in range(stages):
        row, c[i] = table.a[first + i], table.c[first + i]
        for j in range(stages):
            a[i][j] = row[first + j]
        for k in range(len(y)):
            known[i][k] = combined(row, slopes, first, k)
    return Equations(t, y, h, a, c, known)


def _take_step(writers: FieldWriters, t: float, y: Any, h: float, table: StepTable, report: Any) -> int:
    """Take one step in place; return DONE, UNSOLVED or OVERFLOWS."""
    n, stages = len(y), len(table.c)
    moves, slopes, place = writers.zeros(stages, n), writers.zeros(stages, n), writers.zeros(n)
    for group in table.groups:
        first, last = group[0], group[1]
        found, slope = moves[first:last], slopes[first]
        equations = _group_equations(writers, t, y, h, table, first, last, slopes)
        if _largest_entry(equations.a) > 0:
            # from the stage before: w may lie, where f is stiff, beyond another solution
            start = moves[first - 1] if first else writers.zeros(n)
            if not solved_group(writers, equations, start, found, report):
                return UNSOLVED
            # h f for later stages, from the equation: evaluating a stiff f again would magnify rounding
            if last - first == 1:
                for k in range(n):
                    slope[k] = (found[0][k] - equations.known[0][k]) / equations.a[0][0]
        else:
            _copy_rows(equations.known, found)
            add_to(y, found[0], place)
            writers.rate(t + equations.c[0] * h, place, slope)
            report[EVALUATIONS] += 1
            for k in range(n):
                slope[k] *= h
    if table.way == SLOPES:
        for i in range(stages):
            add_to(y, moves[i], place)
            writers.rate(t + table.c[i] * h, place, slopes[i])
        report[EVALUATIONS] += stages
    finite = True
    for k in range(n):
        total = moves[stages - 1][k] if table.way == LAST else 0.0
        for i in range(stages):
            if table.way != LAST:
                total += table.weights[i] * (slopes[i][k] if table.way == SLOPES else moves[i][k])
        y[k] += h * total if table.way == SLOPES else total
        finite = finite and isfinite(y[k])
    return DONE if finite else OVERFLOWS


def run_steps(
    writers: FieldWriters, t: float, y: Any, h: float, first: int, last: int, table: StepTable, report: Any
) -> None:
    """Take steps first to last - 1, step i from t + i h; stop at the first that fails."""
    for i in range(first, last):
        report[STATE] = _take_step(writers, t + i * h, y, h, table, report)
        if report[STATE] != DONE:
            report[STEP] = i
            return


def run_ensemble(writers: FieldWriters, y: Any, h: float, first: int, last: int, table: StepTable, report: Any) -> None:
    """Take steps first to last - 1 of every column; stop at the first system that fails."""
    state = writers.zeros(len(y))
    for column in range(len(y[0])):
        for k in range(len(y)):
            state[k] = y[k][column]
        run_steps(writers, 0.0, state, h, first, last, table, report)
        if report[STATE] != DONE:
            report[SYSTEM] = column
            return
        for k in range(len(y)):
            y[k][column] = state[k]
