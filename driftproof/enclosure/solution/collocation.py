"""Implicit steps in any precision: collocation polynomials that nearly solve y' = f(t, y), however stiff.

Nothing here is proved, and nothing has to be: the defect of the polynomials is enclosed elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from flint import arb, arb_mat, arb_poly

from driftproof.enclosure.arithmetic.clocks import Clock
from driftproof.enclosure.arithmetic.evaluations import Evaluation, in_bits
from driftproof.enclosure.fields.fields import RightHandSide, linearised
from driftproof.symbolic.algebra.certified import enclose

# From the third correction on, each has to be at most half of the one before.
FREE_CORRECTIONS = 2
# The Jacobians are evaluated anew until corrections are this small; from then on they are accurate enough.
FROZEN = 1e-7
# A correction then gains at most this factor: a few digits are lost if components are of different sizes.
GAINED = 1e-8
# Components are accurate relative to their sizes, or to this part of the largest one, or of their largest size so far.
NEGLIGIBLE = 2.0**-40


@dataclass(frozen=True)
class CollocationMatrices:
    """Radau stages -1 < σ_1 < ... < σ_m = 1, to double precision, and matrices for values at -1 and the stages.

    `slopes` maps these values to the derivatives at the stages, `coefficients` to the coefficients of σ^k. `chebyshev`
    maps rows of such coefficients, of any degree below its size, to those of Chebyshev polynomials, in doubles.
    """

    stages: tuple[float, ...]
    slopes: arb_mat
    coefficients: arb_mat
    chebyshev: Any


@cache
def collocation(m: int, bits: int, length: int) -> CollocationMatrices:
    """The matrices for m stages, accurate to `bits` bits, with the first `length` Chebyshev polynomials."""
    legendre = [0.0] * (m - 1) + [-1.0, 1.0]
    stages = [*np.sort(np.polynomial.legendre.legroots(legendre).real)[:-1].tolist(), 1.0]
    with in_bits(2 * bits):
        nodes = [arb(x) for x in (-1.0, *stages)]
        inverse = arb_mat([[x**k for k in range(m + 1)] for x in nodes]).inv().mid()
        slopes = arb_mat([[k * x ** max(k - 1, 0) for k in range(m + 1)] for x in nodes[1:]]) * inverse
        rows = [[arb(0)] * length for _ in range(length)]
        rows[0][0] = arb(1)
        for k in range(1, length):  # 2 σ T_j = T_(j+1) + T_|j-1|
            for j, c in enumerate(rows[k - 1][:k]):
                rows[k][j + 1] += c / 2
                rows[k][abs(j - 1)] += c / 2
    return CollocationMatrices(
        tuple(stages), slopes.mid(), inverse, np.array([[float(x) for x in row] for row in rows])
    )


@dataclass(frozen=True)
class Stages:
    """Values of y at -1 and at the stages, by rows; and Newton's matrix, which also solves the variational equation."""

    method: CollocationMatrices
    values: arb_mat
    matrix: Any

    def polynomials(self) -> list[arb_poly]:
        """The polynomial v, with thin coefficients, of each component."""
        rows = (self.method.coefficients * self.values).transpose().tolist()
        return [arb_poly([x.mid() for x in row]) for row in rows]

    def flow(self, start: arb_mat) -> list[arb_mat]:
        """The V_k of V = Σ V_k σ^k, which nearly solves V' = JV, V(-1) = start; computed in doubles, which they are."""
        n, m = start.nrows(), len(self.method.stages)
        first = np.array([[float(x) for x in row] for row in start.tolist()])
        from_start = np.array([float(row[0]) for row in self.method.slopes.tolist()])
        found = self.solved(-np.kron(from_start[:, None], first)).reshape(m, *first.shape)
        columns = arb_mat([[float(x) for x in values.ravel()] for values in [first, *found]])
        rows = (self.method.coefficients * columns).tolist()
        return [arb_mat(n, start.ncols(), [float(x) for x in row]) for row in rows]

    def solved(self, right: Any) -> Any:
        """The solution of the linear system with Newton's matrix for each column of `right`."""
        matrix, rows, scale = self.matrix
        return np.linalg.solve(matrix, right / rows[:, None]) * scale[:, None]


def solved_stages(
    f: RightHandSide,
    method: CollocationMatrices,
    span: tuple[Fraction, Fraction],
    guess: Sequence[Sequence[arb]],
    accuracy: float,
) -> Stages | None:
    """y and its stages in the step over the span, by Newton's method: matrices in doubles, residuals in all bits.

    None if it does not converge; `accuracy` is relative to each component's size.
    """
    t, step = enclose(span[0]), enclose(span[1] - span[0])
    m, n = len(method.stages), len(guess[0])
    slopes = np.kron(np.array([[float(x) for x in row[1:]] for row in method.slopes.tolist()]), np.eye(n))
    values, before, k = arb_mat([list(row) for row in guess]), 1.0, 0
    while True:
        at_stages = [
            linearised(f, Clock(Evaluation(span=span), t + step * (1 + arb(sigma)) / 2), row, slopes=before > FROZEN)
            for sigma, row in zip(method.stages, values.tolist()[1:], strict=True)
        ]
        residual = method.slopes * values - arb_mat([rates for rates, _ in at_stages]) * (step / 2)
        right = np.array([float(x) for x in residual.entries()])
        if before > FROZEN:
            largest = _largest(values)
            scale = np.tile(np.maximum(largest, max(largest.max() * NEGLIGIBLE, 1e-290)), m)
            matrix = slopes.copy()
            for i, (_, jacobian) in enumerate(at_stages):
                block = slice(i * n, i * n + n)
                matrix[block, block] -= float(step) / 2 * np.array([[float(x) for x in row] for row in jacobian])
            matrix *= scale
            rows = np.abs(matrix).max(axis=1)
            found = (matrix / rows[:, None], rows, scale)
        correction = Stages(method, values, found).solved(right[:, None]).reshape(m, n)
        values = (values - arb_mat([[0.0] * n, *correction.tolist()])).mid()
        moved = float(np.max(np.abs(correction).max(axis=0) / np.maximum(scale[:n], _largest(values))))
        if not moved <= before * (2 if k < FREE_CORRECTIONS else 0.5):  # not even a number, beyond the doubles
            return None
        if moved * max(moved / before, GAINED) < accuracy:  # the next correction will not be larger
            return Stages(method, values, found)
        before, k = moved, k + 1


def _largest(values: arb_mat) -> Any:
    """The largest size in each column."""
    return np.array([max(abs(float(x)) for x in column) for column in values.transpose().tolist()])
