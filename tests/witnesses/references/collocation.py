"""Radau IIA collocation with many stages in long floats: one of two independent ways to the stiff references.

The stage equations are solved to the working precision: residuals are in long arithmetic, and Newton's corrections, by
the Jacobian matrices at every stage, in binary64, so that each gains about as many digits as those have. A step is
accepted where the stages' polynomial has a highest Legendre coefficient below the tolerance, in every component.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from flint import arb, arb_mat, arb_poly, ctx, fmpq, fmpq_poly

from driftproof.methods.vector_fields import VectorField
from tests.witnesses.references.closed_forms import ball
from tests.witnesses.references.functions import derivative, rate

STAGES, BITS = 24, 212
# The relative size of the highest coefficient that a step may leave.
TAIL = 1e-26
# The relative size of the correction after which a step is solved: the next would be smaller by some digits.
SETTLED = 1e-36
# A component smaller than this part of the largest is measured by that part: at the start, where some vanish.
LEAST = 1e-16


@dataclass(frozen=True)
class Nodes:
    c: list[arb]
    a: arb_mat
    # stage values at 0, c_1, ..., c_s -> the last two coefficients in Legendre polynomials
    tail: list[list[arb]]


@cache
def radau(stages: int, bits: int) -> Nodes:
    """The nodes, A with the integral of the j-th Lagrange polynomial to c_i, and what measures a tail."""
    with ctx.workprec(bits + 12 * stages):
        difference = fmpq_poly(_legendre(stages)) - fmpq_poly(_legendre(stages - 1))
        c = sorted((root.real for root, _ in difference.complex_roots()), key=float)
        powers = arb_mat([[x**k for k in range(stages)] for x in c])
        integrals = arb_mat([[x ** (k + 1) / (k + 1) for k in range(stages)] for x in c])
        a = integrals * powers.inv()
        legendre = [arb_poly(fmpq_poly(_legendre(k))) for k in range(stages + 1)]
        tail = arb_mat([[p(x) for p in legendre] for x in [arb(0), *c]]).inv().tolist()[-2:]
    with ctx.workprec(bits):
        return Nodes([x.mid() for x in c], a.mid(), [[x.mid() for x in row] for row in tail])


def _legendre(degree: int) -> list[fmpq]:
    """P(2x - 1), coefficients from the constant on."""
    one, x = fmpq_poly([1]), fmpq_poly([-1, 2])
    low, high = one, x
    if degree == 0:
        return list(one)
    for k in range(1, degree):
        low, high = high, ((2 * k + 1) * x * high - k * low) / (k + 1)
    return list(high)


class Unsolved(ArithmeticError):
    """Newton's method does not converge from there: a smaller step may."""


class Collocation:
    """Steps of the method for one field, y as a list of exact balls (midpoints)."""

    def __init__(self, field: VectorField, stages: int = STAGES, bits: int = BITS) -> None:
        self.bits, self.nodes = bits, radau(stages, bits)
        with ctx.workprec(bits):
            self.rate = rate(field, ball)
        self.matrix = derivative(field, float)
        self.a = np.array([[float(x) for x in row] for row in self.nodes.a.tolist()])

    def integrate(
        self, start: Sequence[arb], times: Sequence[Fraction], first: float, tail: float = TAIL
    ) -> list[list[arb]]:
        """y at the times, from t = 0, with a first step to try."""
        with ctx.workprec(self.bits):
            t, y, h, found = arb(0), list(start), arb(first), []
            for time in times:
                t, y, h = self._advance(t, y, h, ball(time).mid(), tail)
                found.append(y)
            return found

    def _advance(self, t: arb, y: list[arb], h: arb, end: arb, tail: float) -> tuple[arb, list[arb], arb]:
        while True:
            last = bool(t + h * arb(1.000001) >= end)
            size = end - t if last else h
            try:
                moves = self.step(t, y, size.mid())
            except Unsolved:
                h = (size / 4).mid()
                continue
            left = self.tail(y, moves)
            factor = min(3.0, max(0.1, 0.9 * (tail / max(left, 1e-60)) ** (1 / len(moves))))
            if left > tail:
                h = (size * factor).mid()
                continue
            t, y = (t + size).mid(), [(x + z).mid() for x, z in zip(y, moves[-1], strict=True)]
            if last:
                return end, y, h if factor < 1 else max(h, (size * factor).mid(), key=float)
            h = (size * factor).mid()

    def step(self, t: arb, y: list[arb], h: arb) -> list[list[arb]]:
        """The moves of the stages, the last of which is the step's. Raises Unsolved."""
        s, n = len(self.nodes.c), len(y)
        moves = [[arb(0)] * n for _ in range(s)]
        for _ in range(40):
            residual = self._residual(t, y, h, moves)
            points = [[float(x + z) for x, z in zip(y, move, strict=True)] for move in moves]
            short = np.array([[float(x) for x in row] for row in residual])
            scale = np.max(np.abs([*points, *short]), axis=0)
            scale = np.maximum(scale, LEAST * np.max(scale))
            scaled = short / scale
            change = self._correction(float(t), float(h), points, scaled, scale)
            moved = float(np.max(np.abs(change)))
            if not np.isfinite(moved) or moved > 1e6:
                raise Unsolved
            exact = [[arb(float(d)) * arb(float(w)) for d, w in zip(row, scale, strict=True)] for row in change]
            moves = [[(z - d).mid() for z, d in zip(a, b, strict=True)] for a, b in zip(moves, exact, strict=True)]
            if moved < SETTLED:
                return moves
        raise Unsolved

    def _residual(self, t: arb, y: list[arb], h: arb, moves: list[list[arb]]) -> list[list[arb]]:
        points = ([(x + z).mid() for x, z in zip(y, move, strict=True)] for move in moves)
        slopes = [self.rate(t + c * h, point) for c, point in zip(self.nodes.c, points, strict=True)]
        right = (self.nodes.a * arb_mat(slopes).mid()).tolist()
        return [[(z - h * f).mid() for z, f in zip(a, b, strict=True)] for a, b in zip(moves, right, strict=True)]

    def _correction(self, t: float, h: float, points: Any, scaled: Any, scale: Any) -> Any:
        s, n = scaled.shape
        jacobians = [np.array(self.matrix(t, point), float) * scale / scale[:, None] for point in points]
        matrix = np.eye(s * n)
        for j, jacobian in enumerate(jacobians):
            matrix[:, j * n : (j + 1) * n] -= h * np.kron(self.a[:, j : j + 1], jacobian)
        try:
            return np.linalg.solve(matrix, scaled.reshape(-1)).reshape(s, n)
        except np.linalg.LinAlgError:
            raise Unsolved from None

    def tail(self, y: list[arb], moves: list[list[arb]]) -> float:
        """The largest of the last two Legendre coefficients, relative to the component's largest value."""
        columns = [[arb(0), *(move[k] for move in moves)] for k in range(len(y))]
        sizes = [max(abs(float(start + z)) for z in values) for start, values in zip(y, columns, strict=True)]
        worst = 0.0
        for size, values in zip(sizes, columns, strict=True):
            for row in self.nodes.tail:
                last = sum((w * z for w, z in zip(row, values, strict=True)), arb(0))
                worst = max(worst, abs(float(last)) / max(size, LEAST * max(sizes)))
        return worst
