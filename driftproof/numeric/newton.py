"""Newton's method for the stage equations of implicit steps: loops over numbers, which Python runs and numba compiles.

What these loops find, when it is solved, and why, is said in `numeric.implicit`, whose words are used here. In Python
rows are lists of floats, compiled they are arrays; the operations and their order are the same, and so are the bits.
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp, isfinite, log
from typing import Any, NamedTuple, TypeAlias

import numpy as np

UNIT = float(np.finfo(np.float64).epsneg)  # u = 2⁻⁵³
ETA = float(np.finfo(np.float64).smallest_subnormal)
RATE_ROUNDINGS = 16
MOST_ITERATIONS = 128
SHRINKS, HALVES = 0.125, 0.5
# A correction of which no more than this part is a step forward leads nowhere.
SHORTEST = 2.0**-20
# A step is at most so many times as long or as short as the one before; most are SAFETY of what their error allows
# (hairer-norsett-wanner-1993, II.4). The logarithm is taken of no error below SMALLEST, which makes a step MOST_LONGER.
MOST_LONGER, MOST_SHORTER, SAFETY, SMALLEST = 5.0, 0.2, 0.9, 1e-10

# rate(t, y, f) writes f(t, y) into f, jacobian(t, y, matrix) the derivatives into rows.
RateWriter: TypeAlias = Callable[[float, Any, Any], None]
# steps(t, y, h, first, last, table, report): y becomes the state after steps first to last - 1, the i-th from t + i h.
Steps: TypeAlias = Callable[..., None]
# controlled(y, end, h, tolerances, table, report): y becomes the state at the end, in steps from t = 0, the first of h.
Controlled: TypeAlias = Callable[..., None]
# Places in a report, which holds what steps did: counts of all of them, the worst that was left in an equation, and
# of a step that fails the state, its number, and of its attempt without damping the iterations, what is left, the time.
ITERATIONS, EVALUATIONS, RESIDUAL, OVER_FLOOR, STATE, STEP, TRIED, LEFT, LEFT_OVER_FLOOR, TIME = range(10)
DONE, UNSOLVED, OVERFLOWS, TOO_SHORT = 0.0, 1.0, 2.0, 3.0
# How the new state is formed: the last stage, from the moves, or from the slopes.
LAST, MOVES, SLOPES = 0, 1, 2


class StepTable(NamedTuple):
    """A tableau as the loops read it: stages from `first` to `last` of a group are solved together."""

    a: Any
    weights: Any  # d or b
    c: Any
    groups: Any  # (first, last) of each
    way: int


class Tolerances(NamedTuple):
    """An error of a step is right that is at most `absolute` + `relative` |y| in every component.

    `ratio` is the difference between a step and two halves over the error of these, 2ᵖ - 1, and `power` p + 1.
    """

    relative: float
    absolute: float
    ratio: float
    power: float


class NumberKind(NamedTuple):
    """What makes numbers of one kind: `rows(n, m)` and `blocks(k, n, m)` of zeros, whole numbers 0 to n - 1."""

    compiled: Callable[[Any], Any]
    rows: Callable[[int, int], Any]
    blocks: Callable[[int, int, int], Any]
    numbers: Callable[[int], Any]


PYTHON_FLOATS = NumberKind(
    lambda function: function,
    lambda n, m: [[0.0] * m for _ in range(n)],
    lambda k, n, m: [[[0.0] * m for _ in range(n)] for _ in range(k)],
    lambda n: list(range(n)),
)


def residual_of(rate: RateWriter, kind: NumberKind = PYTHON_FLOATS) -> Callable[..., float]:
    """The function that writes what is left in the equations of one group, and says how much that is."""
    compiled, rows, _, _ = kind

    @compiled
    def residual(t: float, y: Any, h: float, a: Any, c: Any, moves: Any, known: Any, jacobians: Any, g: Any) -> float:
        """g = Z - w - h A f, and its largest part over the floor, 8E + 4R; infinite for what is not finite."""
        n, stages, size = len(y), len(a), abs(h)
        slopes, at_place, at_move, whole = rows(stages, n), rows(stages, n), rows(stages, n), rows(stages, n)
        place = rows(1, n)[0]
        for j in range(stages):
            for k in range(n):
                place[k] = y[k] + moves[j][k]
            rate(t + c[j] * h, place, slopes[j])
            for k in range(n):
                row = jacobians[j][k]
                for i in range(n):
                    entry = abs(row[i])
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
    rate: RateWriter, jacobian: RateWriter, kind: NumberKind = PYTHON_FLOATS
) -> tuple[Steps, Controlled]:
    """The loops over steps for a problem, given and controlled; the method comes with each call, as a `StepTable`."""
    compiled, rows, blocks, numbers = kind
    residual = residual_of(rate, kind)

    @compiled
    def factored(m: Any, order: Any) -> bool:
        """M = LU in place, with rows in this order, by the largest entry of a column; False for a zero pivot."""
        n = len(order)
        for k in range(n):
            order[k] = k
        for k in range(n):
            best = k
            for i in range(k + 1, n):
                if abs(m[order[i]][k]) > abs(m[order[best]][k]):
                    best = i
            order[k], order[best] = order[best], order[k]
            row = m[order[k]]
            if row[k] == 0:
                return False
            for i in range(k + 1, n):
                other = m[order[i]]
                if other[k] != 0:
                    other[k] = factor = other[k] / row[k]
                    for j in range(k + 1, n):
                        other[j] -= factor * row[j]
        return True

    @compiled
    def corrected(m: Any, order: Any, g: Any, x: Any) -> float:
        """x = M⁻¹ g, and its square."""
        n, width = len(order), len(g[0])
        for i in range(n):
            row = m[order[i]]
            value = g[order[i] // width][order[i] % width]
            for j in range(i):
                value -= row[j] * x[j]
            x[i] = value
        square = 0.0
        for i in range(n - 1, -1, -1):
            row = m[order[i]]
            value = x[i]
            for j in range(i + 1, n):
                value -= row[j] * x[j]
            x[i] = value / row[i]
            square += x[i] * x[i]
        return square

    @compiled
    def derivatives(t: float, y: Any, h: float, c: Any, moves: Any, found: Any) -> None:
        """f' at each stage."""
        place = rows(1, len(y))[0]
        for i in range(len(moves)):
            for k in range(len(y)):
                place[k] = y[k] + moves[i][k]
            jacobian(t + c[i] * h, place, found[i])

    @compiled
    def newton_matrix(h: float, a: Any, jacobians: Any, m: Any) -> None:
        """M = I - h (aᵢⱼ Jⱼ)."""
        n = len(jacobians[0])
        for i in range(len(a)):
            for j in range(len(a)):
                factor = h * a[i][j]
                for k in range(n):
                    row = m[i * n + k]
                    for column in range(n):
                        row[j * n + column] = -(factor * jacobians[j][k][column])
            for k in range(n):
                m[i * n + k][i * n + k] += 1.0

    @compiled
    def largest(g: Any) -> float:
        """The largest entry, in size."""
        found = 0.0
        for i in range(len(g)):
            for k in range(len(g[0])):
                if not abs(g[i][k]) <= found:
                    found = abs(g[i][k])
        return found

    @compiled
    def iterated(t: float, y: Any, h: float, a: Any, c: Any, known: Any, moves: Any, report: Any, damped: bool) -> bool:
        """The moves Z of one group of stages, from rest; what is left, and the iterations, into the report.

        Damped, the matrix is always made anew, and a correction taken in part where otherwise the next, by the same
        matrix, would not be shorter: the natural test (hairer-wanner-1996, IV.8).
        """
        n, stages = len(y), len(a)
        jacobians, m, order = blocks(stages, n, n), rows(stages * n, stages * n), numbers(stages * n)
        g, x, next_x = rows(stages, n), rows(1, stages * n)[0], rows(1, stages * n)[0]
        now, trial = rows(stages, n), rows(stages, n)
        for i in range(stages):
            for k in range(n):
                now[i][k] = moves[i][k] = known[i][k]
        for k in range(n):
            trial[0][k] = y[k] + now[0][k]
        jacobian(t + c[0] * h, trial[0], jacobians[0])
        for j in range(1, stages):
            for k in range(n):
                for i in range(n):
                    jacobians[j][k][i] = jacobians[0][k][i]
        newton_matrix(h, a, jacobians, m)
        regular = factored(m, order)
        ratio = residual(t, y, h, a, c, now, known, jacobians, g)
        best, left, iterations, evaluations = ratio, largest(g), 0, stages
        while regular and iterations < MOST_ITERATIONS and isfinite(ratio):
            square, part, before = corrected(m, order, g, x), 1.0, ratio
            while True:
                iterations += 1
                evaluations += stages
                for i in range(stages):
                    for k in range(n):
                        trial[i][k] = now[i][k] - part * x[i * n + k]
                ratio = residual(t, y, h, a, c, trial, known, jacobians, g)
                if not damped or ratio <= 1 or part < SHORTEST:
                    break
                if isfinite(ratio) and corrected(m, order, g, next_x) <= (1 - part / 4) ** 2 * square:
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
                newton_matrix(h, a, jacobians, m)
                regular = factored(m, order)
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
        """One step, in place."""
        n, moves, slopes = len(y), rows(len(table.c), len(y)), rows(len(table.c), len(y))
        place = rows(1, n)[0]
        for group in table.groups:
            first, stages, implicit = group[0], group[1] - group[0], False
            a, c, known, found = rows(stages, stages), rows(1, stages)[0], rows(stages, n), rows(stages, n)
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
                # h f, for the stages to come; not evaluated again, which in a stiff problem magnifies rounding
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
        """Steps first to last - 1, the i-th from t + i h; an end at the first that fails."""
        for i in range(first, last):
            report[STATE] = step(t + i * h, y, h, table, report)
            if report[STATE] != DONE:
                report[STEP] = i
                return

    @compiled
    def controlled(y: Any, end: float, h: float, given: Tolerances, table: StepTable, report: Any) -> None:
        """Steps from t = 0 to the end, each twice h/2, of which h tells the error; y becomes the last state."""
        n, t = len(y), 0.0
        whole, halves = rows(1, n)[0], rows(1, n)[0]
        while t < end:
            last = not t + h < end
            h = end - t if last else h
            for k in range(n):
                whole[k] = halves[k] = y[k]
            state = step(t, whole, h, table, report)
            for i in range(2):
                if state == DONE:
                    state = step(t + i * (h / 2), halves, h / 2, table, report)
            error = 0.0 if state == DONE else np.inf
            for k in range(n):
                size = given.absolute + given.relative * max(abs(y[k]), abs(halves[k]))
                if state == DONE and not abs(halves[k] - whole[k]) <= error * size:
                    error = abs(halves[k] - whole[k]) / size if size > 0 else np.inf
            if error <= given.ratio:
                t = end if last else t + h
                for k in range(n):
                    y[k] = halves[k]
                report[STEP] += 1
            factor = exp(-log(max(error / given.ratio, SMALLEST)) / given.power) if isfinite(error) else 0.0
            h *= min(MOST_LONGER, max(MOST_SHORTER, SAFETY * factor))
            if t < end and not t + h > t:
                report[STATE], report[TIME] = TOO_SHORT, t
                return
        report[STATE] = DONE

    return steps, controlled
