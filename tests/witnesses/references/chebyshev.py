"""Collocation at Chebyshev's points in decimal arithmetic: the other of two independent ways to the stiff references.

Other nodes, other numbers, another linear algebra, another error estimate than in `collocation`, and no line in common
but the text of the field. y' on a step is a Chebyshev series, integrated term by term; it is zero at no node but those
where it equals f, cᵢ = (1 - cos(iπ/s))/2 for i = 1, ..., s. Simplified Newton iteration, with the derivative at the
start and at the end of a step in between, both in binary64: only how fast it converges depends on that.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import numpy as np

from driftproof.methods.vector_fields import VectorField
from tests.witnesses.references.functions import derivative, rate

STAGES, DIGITS = 32, 52
TAIL = Decimal("1e-25")
SETTLED = Decimal("1e-34")
# A component smaller than this part of the largest is measured by that part.
LEAST = Decimal("1e-16")

Vector = list[Decimal]


class Unsolved(ArithmeticError):
    """The iteration does not converge from there: a smaller step may."""


class Chebyshev:
    """Steps for one field; its rates may read t."""

    def __init__(self, field: VectorField, stages: int = STAGES, digits: int = DIGITS) -> None:
        self.digits, self.stages = digits, stages
        with localcontext(prec=digits + 10):
            cosine = cosines(stages)
            self.c = [(1 - x) / 2 for x in cosine[1 : stages + 1]]
            self.a = integrals(cosine)
            self.last = [_coefficient_weights(cosine, k) for k in (stages, stages - 1)]
        with localcontext(prec=digits):
            self.rate = rate(field, _decimal)
        self.matrix = derivative(field, float)
        self.rough = np.array(self.a, float)

    def integrate(
        self, start: Sequence[Fraction], times: Sequence[Fraction], first: str, tail: Decimal = TAIL
    ) -> list[Vector]:
        """y at the times, from t = 0, with a first step to try."""
        with localcontext(prec=self.digits):
            t, y, h, found = Decimal(0), [_decimal(x) for x in start], Decimal(first), []
            for time in times:
                t, y, h = self._until(_decimal(time), (t, y, h), tail)
                found.append(y)
            return found

    def _until(self, end: Decimal, state: tuple[Decimal, Vector, Decimal], tail: Decimal) -> Any:
        t, y, h = state
        while t < end:
            taken = min(h, end - t)
            try:
                values = self.step(t, y, taken)
            except Unsolved:
                h = taken / 5
                continue
            left = self.left(y, values)
            wanted = taken * Decimal(
                min(2.5, max(0.2, 0.8 * float(tail / (left + tail / 10**20)) ** (1 / self.stages)))
            )
            if left > tail:
                h = wanted
                continue
            t, y, h = t + taken, values[-1], max(wanted, h) if taken < h else wanted
        return end, y, h

    def step(self, t: Decimal, y: Vector, h: Decimal) -> list[Vector]:
        """The values at the nodes, the last of which is at the end of the step. Raises Unsolved."""
        values = [y] * self.stages
        for _ in range(50):
            slopes = [self.rate(t + c * h, value) for c, value in zip(self.c, values, strict=True)]
            columns = list(zip(*slopes, strict=True))
            wrong = [
                [v - x - h * sum(map(_times, row, column)) for v, x, column in zip(value, y, columns, strict=True)]
                for value, row in zip(values, self.a, strict=True)
            ]
            change = self._change(float(t), float(h), values, wrong)
            values = [[v - d for v, d in zip(a, b, strict=True)] for a, b in zip(values, change, strict=True)]
            if self._size(change, values) < SETTLED:
                return values
        raise Unsolved

    def _size(self, change: list[Vector], values: list[Vector]) -> Decimal:
        scales = _scales(values)
        return max(abs(d) / s for row in change for d, s in zip(row, scales, strict=True))

    def _change(self, t: float, h: float, values: list[Vector], wrong: list[Vector]) -> list[Vector]:
        scales = _scales([*values, *wrong])
        weight, (s, n) = np.array(scales, float), (self.stages, len(scales))
        derivatives = np.array([self.matrix(t, list(map(float, value))) for value in values], float)
        derivatives *= weight / weight[:, None]
        blocks = np.einsum("ij,jkl->ikjl", h * self.rough, derivatives).reshape(s * n, s * n)
        right = np.array([[float(x / w) for x, w in zip(row, scales, strict=True)] for row in wrong])
        try:
            found = np.linalg.solve(np.eye(s * n) - blocks, right.reshape(-1)).reshape(s, n)
        except np.linalg.LinAlgError:
            raise Unsolved from None
        if not np.isfinite(found).all() or np.max(np.abs(found)) > 1e6:
            raise Unsolved
        return [[Decimal(float(x)) * w for x, w in zip(row, scales, strict=True)] for row in found]

    def left(self, y: Vector, values: list[Vector]) -> Decimal:
        """The larger of the last two Chebyshev coefficients of y, relative to the component."""
        columns = list(zip(y, *values, strict=True))
        return max(
            abs(sum(map(_times, row, column))) / scale
            for column, scale in zip(columns, _scales([y, *values]), strict=True)
            for row in self.last
        )


def _scales(values: list[Vector]) -> Vector:
    sizes = [max(map(abs, column)) for column in zip(*values, strict=True)]
    return [max(size, LEAST * max(sizes)) for size in sizes]


def _times(a: Decimal, b: Decimal) -> Decimal:
    return a * b


def integrals(cosine: Vector) -> list[Vector]:
    """A, row i and column j the integral from 0 to cᵢ of the polynomial that is 1 at cⱼ and 0 at the other nodes.

    That has degree s - 1, so its s-th divided difference over 0, c₁, ..., c_s vanishes, which gives its value at 0.
    """
    s = len(cosine) // 2
    rows = [[Decimal(0)] * s for _ in range(s)]
    weights = [_coefficient_weights(cosine, k) for k in range(s + 1)]
    for j in range(1, s + 1):
        at_zero = (-1) ** (j + 1) * (Decimal(1) if j == s else Decimal(2))
        series = [w[j] + w[0] * at_zero for w in weights]
        for i in range(1, s + 1):
            upper = lambda k, i=i: (-1) ** k * cosine[k * i % (2 * s)]
            rows[i - 1][j - 1] = sum(
                (
                    a * (_primitive(k, upper) - _primitive(k, lambda m: Decimal((-1) ** m))) / 2
                    for k, a in enumerate(series)
                ),
                Decimal(0),
            )
    return rows


def _coefficient_weights(cosine: Vector, k: int) -> Vector:
    """Values at -cos(iπ/s), i = 0, ..., s -> the coefficient of T_k of the polynomial through them."""
    s = len(cosine) // 2
    half = lambda i: 2 if i in (0, s) else 1
    return [(-1) ** k * 2 * cosine[k * i % (2 * s)] / (s * half(i) * half(k)) for i in range(s + 1)]


def _primitive(k: int, chebyshev: Any) -> Decimal:
    """A primitive of T_k where T_m is `chebyshev`(m)."""
    if k == 0:
        return chebyshev(1)
    if k == 1:
        return chebyshev(2) / 4
    return chebyshev(k + 1) / (2 * (k + 1)) - chebyshev(k - 1) / (2 * (k - 1))


def _decimal(x: Fraction) -> Decimal:
    return Decimal(x.numerator) / Decimal(x.denominator)


def cosines(stages: int) -> Vector:
    """cos(iπ/s) for i = 0, ..., 2s - 1: powers of the first, which is a root of the half-angle formula's series."""
    angle = _pi() / stages
    cosine, sine = _cosine(angle), _cosine(_pi() / 2 - angle)
    real, imaginary, found = Decimal(1), Decimal(0), []
    for _ in range(2 * stages):
        found.append(real)
        real, imaginary = real * cosine - imaginary * sine, real * sine + imaginary * cosine
    return found


def _pi() -> Decimal:
    """Machin's formula, 16 arctan(1/5) - 4 arctan(1/239)."""
    return 16 * _inverse_arctangent(5) - 4 * _inverse_arctangent(239)


def _inverse_arctangent(n: int) -> Decimal:
    return sum(((-1) ** k * Decimal(1) / ((2 * k + 1) * Decimal(n) ** (2 * k + 1)) for k in range(60)), Decimal(0))


def _cosine(x: Decimal) -> Decimal:
    term, total = Decimal(1), Decimal(0)
    for k in range(1, 60):
        total += term
        term *= -x * x / ((2 * k - 1) * (2 * k))
    return total
