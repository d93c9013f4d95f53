"""Adaptive steps of collocation methods: an error estimate, and stages solved to a tolerance with one matrix for all.

The stage increments, `moves` in the code, solve Z = h A F(y + Z). With J = f' at one point, a simplified iteration
corrects them by (A⁻¹/h - J)⁻¹ (F - A⁻¹ Z / h). T⁻¹ A⁻¹ T is diagonal, except for 2 x 2 blocks of complex eigenvalues,
so that systems of n and 2n equations are solved, and none of s n (hairer-wanner-1996, IV.8). T and the eigenvalues
enter the corrections only. They are rounded to binary32, so that they do not depend on the library that finds them.

The iteration starts on the polynomial of the previous step. It is done if the corrections still to come, taken as a
geometric series, are within a part of the tolerance, and given up if they will not be; then J is evaluated anew, unless
it is that of y already. The error of a step is estimated by (1 - h J/γ)⁻¹ h (f(t, y) + Σ eᵢ Zᵢ / h) / γ, the difference
from a formula of order s with the weight 1/γ at f(t, y), filtered as its stiff part demands.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from math import exp, inf, log
from typing import Any, NamedTuple

import numpy as np

from driftproof.methods.numbers.number_field import Exact, total
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta
from driftproof.numeric.steps.elimination import Band, factored, solve
from driftproof.numeric.steps.loops import FieldWriters
from driftproof.numeric.steps.newton import add_to, combined
from driftproof.numeric.steps.step_control import EVALUATIONS, StepControl, error_size
from driftproof.numeric.steps.tableaux import NODE_BITS

# The error that may be left in the moves: PART of the tolerance (chosen: less takes more iterations, more adds to the
# error estimate) or, if that is more, ROUNDINGS of |y|, some roundings.
PART, ROUNDINGS = 0.01, 2.0**-49
# The most iterations with one matrix. J is kept for the next step if two were enough, or if the last correction was at
# most SLOW times the previous one. Both numbers are those of the program RADAU5 (hairer-wanner-1996, IV.8).
MOST_ITERATIONS, SLOW = 7, 1e-3
# As long as the quotient of the series is not known, what an iteration leaves is taken as that of the previous step to
# the power WORSE, of which at least LEAST_LEFT, a roundoff, is assumed: as in RADAU5.
WORSE, LEAST_LEFT = 0.8, 1e-16
# Indices in `Work.memory`: h of the matrices, of the last attempt and of the last accepted step; whether J is that of
# y, and whether it is to be; and the ratio of the error left by the last iteration to its last correction.
FACTORED, TRIED, BEFORE, CURRENT, WANTED, LEFT = range(6)


class CollocationTable(NamedTuple):
    """A collocation method with s stages in the form that the loops read."""

    c: Any
    inverse: Any  # A⁻¹
    weights: Any  # d = A⁻ᵀ b: the step is y + Σ dᵢ Zᵢ
    estimate: Any  # e
    powers: Any  # p = `powers` Z: the polynomial Σ pₖ xᵏ⁺¹ is Zᵢ at cᵢ
    to_blocks: Any  # T⁻¹
    from_blocks: Any  # T
    blocks: Any  # (first row, number of rows) of each; the first block has γ, and may have no row
    eigenvalues: Any  # (real part, imaginary part) of each block


class Work(NamedTuple):
    """What is kept between attempts, and the workspace of one."""

    memory: Any
    jacobian: Any
    matrices: Any
    exchanged: Any
    moves: Any
    slopes: Any
    corrections: Any
    polynomial: Any
    x: Any
    slope: Any
    off: Any


def work_for(n: int, table: CollocationTable, writers: FieldWriters) -> Work:
    """Allocate the workspace for a system of n equations."""
    band, zeros, indices = writers.band, writers.zeros, writers.indices
    stages, count = len(table.c), len(table.blocks)
    width, wide = min(n, band.lower + band.upper + 1), min(2 * n, 4 * band.lower + 2 * band.upper + 4)
    of_stages, vectors = (zeros(stages, n) for _ in range(4)), (zeros(max(2 * n, stages)), zeros(n), zeros(n))
    matrices, exchanged = zeros(count, 2 * n, wide), indices(count, 2 * n)
    made = Work(*(zeros(6), zeros(n, width), matrices, exchanged, *of_stages, *vectors))
    made.memory[WANTED], made.memory[LEFT], made.memory[TRIED] = True, 1.0, inf
    return made


def _factor_blocks(h: float, table: CollocationTable, work: Work, band: Band) -> bool:
    """Factor [[α/h - J, β/h], [-β/h, α/h - J]] for each block, ordered by component so that bands remain."""
    n, regular = len(work.slope), True
    for b in range(len(table.blocks)):
        two = max(1, table.blocks[b][1])
        below, above, m = two * (band.lower + 1) - 1, two * (band.upper + 1) - 1, work.matrices[b]
        real, imaginary = table.eigenvalues[b][0] / h, table.eigenvalues[b][1] / h
        for k in range(n):
            derivatives, first = work.jacobian[k], max(0, k - band.lower)
            for i in range(two):
                row, start = m[two * k + i], max(0, two * k + i - below)
                for j in range(len(row)):
                    row[j] = 0.0
                for j in range(first, min(n, k + band.upper + 1)):
                    row[two * j + i - start] = -derivatives[j - first]
                row[two * k + i - start] += real
                if two == 2:
                    row[two * k + 1 - i - start] = imaginary if i == 0 else -imaginary
        regular = factored(m, work.exchanged[b], two * n, below, above) and regular
    return regular


def _multiply_rows(matrix: Any, rows: Any, x: Any) -> None:
    """Overwrite the rows with the matrix times them; x has room for an entry of each row."""
    for k in range(len(rows[0])):
        for i in range(len(matrix)):
            x[i] = combined(matrix[i], rows, len(matrix), k)
        for i in range(len(matrix)):
            rows[i][k] = x[i]


def _correct(table: CollocationTable, work: Work, band: Band) -> None:
    """Overwrite the corrections with T (blocks)⁻¹ T⁻¹ times them."""
    n, changes, x = len(work.slope), work.corrections, work.x
    _multiply_rows(table.to_blocks, changes, x)
    for b in range(len(table.blocks)):
        first, two = table.blocks[b][0], table.blocks[b][1]
        for k in range(n):
            for i in range(two):
                x[two * k + i] = changes[first + i][k]
        below, above = two * (band.lower + 1) - 1, two * (band.upper + 1) - 1
        solve(work.matrices[b], work.exchanged[b], two * n, x, below, above)
        for k in range(n):
            for i in range(two):
                changes[first + i][k] = x[two * k + i]
    _multiply_rows(table.from_blocks, changes, x)


def _iterated(writers: FieldWriters, t: float, y: Any, h: float, control: StepControl) -> float:
    """Correct the moves once; return the size of the correction."""
    given, table, work, report, _, _ = control
    moves, slopes, changes = work.moves, work.slopes, work.corrections
    for i in range(len(table.c)):
        add_to(y, moves[i], work.x)
        writers.rate(t + table.c[i] * h, work.x, slopes[i])
    report[EVALUATIONS] += len(table.c)
    for k in range(len(y)):
        for i in range(len(table.c)):
            changes[i][k] = slopes[i][k] - combined(table.inverse[i], moves, len(table.c), k) / h
    _correct(table, work, writers.band)
    largest = 0.0
    for i in range(len(table.c)):
        add_to(moves[i], changes[i], moves[i])
        largest = max(largest, error_size(changes[i], y, y, given))
    return largest


def _solved_stages(writers: FieldWriters, t: float, y: Any, h: float, control: StepControl) -> bool:
    """Iterate from the present moves; True if they end within a part of the tolerance."""
    relative, memory, before, rate_of_change = control.given.relative, control.work.memory, inf, inf
    part = max(PART, ROUNDINGS / relative) if relative > 0 else PART
    left = exp(WORSE * log(max(memory[LEFT], LEAST_LEFT)))
    for iteration in range(MOST_ITERATIONS):
        largest = _iterated(writers, t, y, h, control)
        if not largest < inf:
            return False
        if iteration > 0:
            rate_of_change = largest / before
            if not rate_of_change < 1:
                return False
            left = rate_of_change / (1 - rate_of_change)
            expected = left * largest
            for _ in range(iteration + 1, MOST_ITERATIONS):
                expected *= rate_of_change
            if expected > part:
                return False
        before = largest
        if left * largest <= part:
            memory[LEFT] = left
            memory[WANTED] = iteration >= 2 and rate_of_change > SLOW
            return True
    return False


def _extrapolate(h: float, table: CollocationTable, work: Work) -> None:
    """Set the moves by extrapolating the polynomial of the previous step, or of 0 if there is none."""
    ratio, polynomial = h / work.memory[BEFORE], work.polynomial
    for i in range(len(table.c)):
        x = 1 + ratio * table.c[i]
        for k in range(len(work.slope)):
            value = at_end = 0.0
            for j in range(len(table.c) - 1, -1, -1):
                value = (value + polynomial[j][k]) * x
                at_end += polynomial[j][k]
            work.moves[i][k] = value - at_end


def _estimated_error(y: Any, h: float, new: Any, slope: Any, band: Band, control: StepControl) -> float:
    """Write (γ/h - J)⁻¹ (slope + Σ eᵢ Zᵢ / h), by the first block, into `work.off`; return its size."""
    given, table, work, _, _, _ = control
    for k in range(len(y)):
        work.off[k] = slope[k] + combined(table.estimate, work.moves, len(table.c), k) / h
    solve(work.matrices[0], work.exchanged[0], len(y), work.off, band.lower, band.upper)
    return error_size(work.off, y, new, given)


def collocation_attempt(
    writers: FieldWriters, t: float, y: Any, h: float, moved: bool, new: Any, control: StepControl
) -> float:
    """Attempt a step; see `numeric.steps.step_control`."""
    _, table, work, report, _, _ = control
    n, memory, band = len(y), work.memory, writers.band
    if moved:
        memory[BEFORE], memory[CURRENT] = memory[TRIED], False
        writers.rate(t, y, work.slope)
        report[EVALUATIONS] += 1
        for i in range(len(table.c)):
            for k in range(n):
                work.polynomial[i][k] = combined(table.powers[i], work.moves, len(table.c), k)
    memory[TRIED] = h
    while True:
        if memory[WANTED] and not memory[CURRENT]:
            writers.jacobian(t, y, work.jacobian)
            memory[CURRENT], memory[FACTORED] = True, 0.0
        if memory[FACTORED] != h:
            memory[FACTORED] = h
            if not _factor_blocks(h, table, work, band):
                return inf
        _extrapolate(h, table, work)
        if _solved_stages(writers, t, y, h, control):
            break
        memory[LEFT] = 1.0
        if memory[CURRENT]:
            return inf
        memory[WANTED] = True
    for k in range(n):
        new[k] = y[k] + combined(table.weights, work.moves, len(table.c), k)
    error = _estimated_error(y, h, new, work.slope, band, control)
    if error > 1:
        add_to(y, work.off, work.x)
        writers.rate(t, work.x, work.slopes[0])
        report[EVALUATIONS] += 1
        error = _estimated_error(y, h, new, work.slopes[0], band, control)
    return error


@cache
def collocation_table(method: Method) -> CollocationTable:
    """The table of a collocation method without the node 0, as Gauss's and Radau IIA. Raises MethodError for others.

    The Lagrange polynomials through 0, Σ pₖᵢ xᵏ⁺¹ with the value 1 at cᵢ, give A⁻¹ as their slopes at the nodes and d
    as their values at 1. e, minus their slopes at 0, compares the slope of the stages' polynomial there with f(t, y).
    """
    c = method.tableau(NODE_BITS)[2] if isinstance(method, Collocation) else _nodes(method)
    if not c or 0 in c:
        raise MethodError(f"{method.key} has no error estimate: not a pair, nor collocation without the node 0")
    powers = [list(row) for row in zip(*[_basis_polynomial(x, c) for x in c], strict=True)]
    columns = list(zip(*powers, strict=True))
    inverse = [[total((k + 1) * x * node**k for k, x in enumerate(column)) for column in columns] for node in c]
    given = inverse, [[-x for x in powers[0]], list(map(total, columns)), c], powers
    slopes, (estimate, weights, nodes), polynomials = ([[float(x) for x in row] for row in matrix] for matrix in given)
    vectors, blocks, eigenvalues = _blocks(slopes)
    back = _rounded(np.linalg.inv(vectors))
    return CollocationTable(nodes, slopes, weights, estimate, polynomials, back, vectors.tolist(), blocks, eigenvalues)


def _nodes(method: Method) -> Sequence[Exact]:
    """The distinct c of a collocating Runge-Kutta method, else (): Σⱼ aᵢⱼ cⱼᵏ⁻¹ = cᵢᵏ/k, and 1/k with b, for k <= s."""
    if not isinstance(method, RungeKutta) or any(x == y for i, x in enumerate(method.c) for y in method.c[:i]):
        return ()
    c = method.c
    rows = zip((*method.a, method.b), (*c, Fraction(1)), strict=True)
    moments = [
        (total(x * y ** (k - 1) for x, y in zip(row, c, strict=True)), end**k / k)
        for row, end in rows
        for k in range(1, len(c) + 1)
    ]
    return c if all(x == y for x, y in moments) else ()


def _basis_polynomial(node: Exact, c: Sequence[Exact]) -> list[Exact]:
    """The polynomial without a constant term that is 1 at this node and 0 at the others, from x¹ on."""
    found: list[Exact] = [1 / node]
    for other in c:
        if other != node:
            shifted = zip([Fraction(0), *found], [*found, Fraction(0)], strict=True)
            found = [(low - other * high) / (node - other) for low, high in shifted]
    return found


def _blocks(inverse: list[list[float]]) -> tuple[Any, list[list[int]], list[list[float]]]:
    """T, its blocks and their eigenvalues, the real one first; if there is none, a modulus first, for no row."""
    values, vectors = np.linalg.eig(inverse)
    columns, blocks, eigenvalues = list[Any](), list[list[int]](), list[list[float]]()
    for i in sorted(np.flatnonzero(values.imag >= 0), key=lambda i: values.imag[i]):
        scaled, real = vectors[:, i] / vectors[-1, i], values.imag[i] == 0
        if not real and not blocks:
            blocks, eigenvalues = [[0, 0]], [_rounded([abs(values[i]), 0.0])]
        blocks.append([len(columns), 1 if real else 2])
        eigenvalues.append(_rounded([values[i].real, values[i].imag]))
        columns += [scaled.real] if real else [scaled.real, scaled.imag]
    return np.array(_rounded(columns)).T, blocks, eigenvalues


def _rounded(values: Any) -> Any:
    return np.asarray(values, np.float32).astype(np.float64).tolist()
