"""Newton's method for the stage equations of implicit steps: loops over numbers, which Python runs and numba compiles.

`numeric.implicit` says what these loops solve and when a step counts as solved; its terms are used here. In Python rows
are lists of floats, compiled they are arrays; the operations and their order are the same, and so are the bits.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from driftproof.numeric.elimination import FULL, PYTHON_FLOATS, Band, NumberKind, elimination

UNIT = float(np.finfo(np.float64).epsneg)  # u = 2⁻⁵³
ETA = float(np.finfo(np.float64).smallest_subnormal)
# m, iterations and rates of convergence in `numeric.implicit`; m is chosen: a larger one accepts larger residuals.
RATE_ROUNDINGS = 16
MOST_ITERATIONS = 128
SHRINKS, HALVES = 0.125, 0.5
# Damping shortens no correction further than this: one that helps only in a smaller part leads nowhere.
SHORTEST = 2.0**-20

# rate(t, y, f) writes f(t, y) into f; jacobian(t, y, matrix) writes the derivatives into the rows of a band.
RateWriter: TypeAlias = Callable[[float, Any, Any], None]
# steps(t, y, h, first, last, table, report) overwrites y with that after steps first to last - 1, step i from t + i h.
Steps: TypeAlias = Callable[..., None]
# Indices in a report: counts over all steps, the largest residual, and, for a step that fails, its outcome, its number
# and the iterations, residual and time of its undamped attempt; the number of its system in an ensemble.
ITERATIONS, EVALUATIONS, RESIDUAL, OVER_FLOOR, STATE, STEP, TRIED, LEFT, LEFT_OVER_FLOOR, TIME, SYSTEM = range(11)
DONE, UNSOLVED, OVERFLOWS = range(3)
# How the new state is formed: it is the last stage, or is formed from the moves, or from the slopes.
LAST, MOVES, SLOPES = range(3)


class StepTable(NamedTuple):
    """A tableau in the form that the loops read; stages first to last - 1 of a group are solved together."""

    a: Any
    weights: Any  # d or b
    c: Any
    groups: Any  # (first, last) of each group
    way: int


def residual_of(rate: RateWriter, band: Band = FULL, kind: NumberKind = PYTHON_FLOATS) -> Callable[..., float]:
    """Return the function that computes the residual of the equations of one group, and its size."""
    (compiled, zeros, _), (lower, upper) = kind, band

    @compiled
    def residual(t: float, y: Any, h: float, a: Any, c: Any, moves: Any, known: Any, jacobians: Any, g: Any) -> float:
        """Write g = Z - w - h A f; return the largest |g| over its floor, 8E + 4R, or inf if one is not finite."""
        n, stages, size = len(y), len(a), abs(h)
        slopes, at_place, at_move, whole = zeros(stages, n), zeros(stages, n), zeros(stages, n), zeros(stages, n)
        place = zeros(n)
        for j in range(stages):
            for k in range(n):
                place[k] = y[k] + moves[j][k]
            rate(t + c[j] * h, place, slopes[j])
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
                    worst = part if isfinite(value) and isfinite(part) else np.inf
        return worst

    return residual  # type: ignore[no-any-return]


def implicit_steps(
    rate: RateWriter, jacobian: RateWriter, band: Band = FULL, kind: NumberKind = PYTHON_FLOATS
) -> Steps:
    """Return the loop over steps for a problem; the method comes with each call, as a `StepTable`."""
    (compiled, zeros, indices), (lower, upper), full = kind, band, band == FULL
    residual = residual_of(rate, band, kind)
    factored, solve = elimination(kind)

    @compiled
    def corrected(m: Any, order: Any, g: Any, x: Any, wide: Any) -> float:
        """Write x = M⁻¹ g; return |x|²."""
        stage, component, below, above = wide
        for i in range(len(g)):
            for k in range(len(g[0])):
                x[i * stage + k * component] = g[i][k]
        solve(m, order, len(x), x, below, above)
        square = 0.0
        for value in x:
            square += value * value
        return square

    @compiled
    def derivatives(t: float, y: Any, h: float, c: Any, moves: Any, found: Any) -> None:
        """Write f' at each stage into `found`."""
        place = zeros(len(y))
        for i in range(len(moves)):
            for k in range(len(y)):
                place[k] = y[k] + moves[i][k]
            jacobian(t + c[i] * h, place, found[i])

    @compiled
    def newton_matrix(h: float, a: Any, jacobians: Any, m: Any, wide: Any) -> None:
        """Write M = I - h (aᵢⱼ Jⱼ)."""
        n, (stage, component, below, _) = len(jacobians[0]), wide
        for row in m:
            for k in range(len(row)):
                row[k] = 0.0
        for i in range(len(a)):
            for k in range(n):
                at, first = i * stage + k * component, max(0, k - lower)
                row, start = m[at], max(0, at - below)
                for j in range(len(a)):
                    factor = h * a[i][j]
                    for column in range(first, min(n, k + upper + 1)):
                        row[j * stage + column * component - start] = -(factor * jacobians[j][k][column - first])
                row[at - start] += 1.0

    @compiled
    def largest(g: Any) -> float:
        """The largest entry in absolute value."""
        found = 0.0
        for i in range(len(g)):
            for k in range(len(g[0])):
                if not abs(g[i][k]) <= found:
                    found = abs(g[i][k])
        return found

    @compiled
    def iterated(t: float, y: Any, h: float, a: Any, c: Any, known: Any, moves: Any, report: Any, damped: bool) -> bool:
        """Solve for the moves Z of one group of stages, from Z = w; report residual and iterations. True if solved.

        Damped, the matrix is made anew in each iteration, and a correction is shortened until the next one, by the same
        matrix, is shorter than it: the natural test (hairer-wanner-1996, IV.8).
        """
        n, stages, width = len(y), len(a), min(len(y), lower + upper + 1)
        # The unknowns are ordered stage by stage or, for the matrix to be a band, component by component.
        wide = (n, 1, lower, upper) if full else (1, stages, stages * (lower + 1) - 1, stages * (upper + 1) - 1)
        (stage, component, below, above), size = wide, stages * n
        jacobians, m = zeros(stages, n, width), zeros(size, min(size, 2 * below + above + 1))
        order = indices(size)
        g, x, next_x = zeros(stages, n), zeros(size), zeros(size)
        now, trial = zeros(stages, n), zeros(stages, n)
        for i in range(stages):
            for k in range(n):
                now[i][k] = moves[i][k] = known[i][k]
        for k in range(n):
            trial[0][k] = y[k] + now[0][k]
        jacobian(t + c[0] * h, trial[0], jacobians[0])
        for j in range(1, stages):
            for k in range(n):
                for i in range(width):
                    jacobians[j][k][i] = jacobians[0][k][i]
        newton_matrix(h, a, jacobians, m, wide)
        regular = factored(m, order, size, below, above)
        ratio = residual(t, y, h, a, c, now, known, jacobians, g)
        best, left, iterations, evaluations = ratio, largest(g), 0, stages
        while regular and iterations < MOST_ITERATIONS and isfinite(ratio):
            square, part, before = corrected(m, order, g, x, wide), 1.0, ratio
            while True:
                iterations += 1
                evaluations += stages
                for i in range(stages):
                    for k in range(n):
                        trial[i][k] = now[i][k] - part * x[i * stage + k * component]
                ratio = residual(t, y, h, a, c, trial, known, jacobians, g)
                if not damped or ratio <= 1 or part < SHORTEST:
                    break
                if isfinite(ratio) and corrected(m, order, g, next_x, wide) < square:
                    break
                part /= 2
            now, trial = trial, now
            if ratio < best:
                best, left = ratio, largest(g)
                for i in range(stages):
                    for k in range(n):
                        moves[i][k] = now[i][k]
            if best <= 1 and not ratio < HALVES * before:
                break
            if damped or ratio > SHRINKS * before:
                derivatives(t, y, h, c, now, jacobians)
                newton_matrix(h, a, jacobians, m, wide)
                regular = factored(m, order, size, below, above)
        report[ITERATIONS] += iterations
        report[EVALUATIONS] += evaluations
        if not best <= 1:
            if not damped:
                report[TRIED], report[TIME] = iterations, t + c[len(c) - 1] * h
                report[LEFT], report[LEFT_OVER_FLOOR] = left, best
            return False
        report[RESIDUAL], report[OVER_FLOOR] = max(report[RESIDUAL], left), max(report[OVER_FLOOR], best)
        return True

    @compiled
    def step(t: float, y: Any, h: float, table: StepTable, report: Any) -> float:
        """Take one step in place; return DONE, UNSOLVED or OVERFLOWS."""
        n, moves, slopes = len(y), zeros(len(table.c), len(y)), zeros(len(table.c), len(y))
        place = zeros(n)
        for group in table.groups:
            first, stages, implicit = group[0], group[1] - group[0], False
            a, c, known, found = zeros(stages, stages), zeros(stages), zeros(stages, n), zeros(stages, n)
            for i in range(stages):
                c[i] = table.c[first + i]
                for j in range(stages):
                    a[i][j] = table.a[first + i][first + j]
                    implicit = implicit or a[i][j] != 0
                for k in range(n):
                    total = 0.0
                    for j in range(first):
                        total += table.a[first + i][j] * slopes[j][k]
                    found[i][k] = known[i][k] = total
            solved = not implicit
            for damped in range(2):
                solved = solved or iterated(t, y, h, a, c, known, found, report, damped > 0)
            if not solved:
                return UNSOLVED
            for i in range(stages):
                for k in range(n):
                    moves[first + i][k] = found[i][k]
            if stages == 1 and implicit:
                # h f for later stages, from the equation: evaluating a stiff f again would magnify rounding
                for k in range(n):
                    slopes[first][k] = (found[0][k] - known[0][k]) / a[0][0]
            elif stages == 1:
                for k in range(n):
                    place[k] = y[k] + found[0][k]
                rate(t + c[0] * h, place, slopes[first])
                report[EVALUATIONS] += 1
                for k in range(n):
                    slopes[first][k] *= h
        if table.way == SLOPES:
            for i in range(len(moves)):
                for k in range(n):
                    place[k] = y[k] + moves[i][k]
                rate(t + table.c[i] * h, place, slopes[i])
                report[EVALUATIONS] += 1
        finite = True
        for k in range(n):
            total = moves[len(moves) - 1][k] if table.way == LAST else 0.0
            for i in range(len(moves)):
                if table.way != LAST:
                    total += table.weights[i] * (slopes[i][k] if table.way == SLOPES else moves[i][k])
            y[k] += h * total if table.way == SLOPES else total
            finite = finite and isfinite(y[k])
        return DONE if finite else OVERFLOWS

    @compiled
    def steps(t: float, y: Any, h: float, first: int, last: int, table: StepTable, report: Any) -> None:
        """Take steps first to last - 1, step i from t + i h; stop at the first that fails."""
        for i in range(first, last):
            report[STATE] = step(t + i * h, y, h, table, report)
            if report[STATE] != DONE:
                report[STEP] = i
                return

    return steps  # type: ignore[no-any-return]


def ensemble_steps(steps: Steps, kind: NumberKind) -> Callable[..., None]:
    """Return the loop over columns begin to end - 1 of y, each of which takes these steps."""
    compiled, zeros, _ = kind

    @compiled
    def run(y: Any, h: float, first: int, last: int, table: StepTable, report: Any, begin: int, end: int) -> None:
        state = zeros(len(y))
        for system in range(begin, end):
            for k in range(len(y)):
                state[k] = y[k][system]
            steps(0.0, state, h, first, last, table, report)
            if report[STATE] != DONE:
                report[SYSTEM] = system
                return
            for k in range(len(y)):
                y[k][system] = state[k]

    return run  # type: ignore[no-any-return]
