"""Whether a symmetric exact matrix is positive semidefinite: a sum of squares shows it, or a direction refutes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from driftproof.methods.number_field import Exact

Vector: TypeAlias = tuple[Exact, ...]
Matrix: TypeAlias = tuple[Vector, ...]


@dataclass(frozen=True)
class Semidefinite:
    """x·Mx = Σ d (l·x)² + (a remainder), over `squares` of (d, l) with d > 0; without remainder if M is semidefinite.

    Else `direction` is an x with x·Mx < 0. Either way, what is claimed is seen by multiplying out.
    """

    squares: tuple[tuple[Exact, Vector], ...]
    direction: Vector | None

    @property
    def holds(self) -> bool:
        """x·Mx >= 0 for all real x."""
        return self.direction is None


def semidefinite(matrix: Matrix) -> Semidefinite:
    """The decision by M = L D Lᵀ with positive pivots, while there are any. Raises ValueError if M is not symmetric.

    What is left then has no positive diagonal: it is zero, or x·Mx takes a negative value.
    """
    if matrix != tuple(zip(*matrix, strict=True)):
        raise ValueError("only a symmetric matrix has a sign; this one is not symmetric")
    rest = [list(row) for row in matrix]
    squares: list[tuple[int, Exact, Vector]] = []
    while (pivot := next((i for i, row in enumerate(rest) if row[i] > 0), None)) is not None:
        size, line = rest[pivot][pivot], tuple(x / rest[pivot][pivot] for x in rest[pivot])
        squares.append((pivot, size, line))
        for i, row in enumerate(rest):
            if line[i] == 0:
                continue
            rest[i] = [x - size * line[i] * line[j] for j, x in enumerate(row)]
    direction = _negative_direction(rest)
    if direction is not None:
        # Off the pivots it stays; on them it is chosen, last first, so that all squares vanish.
        for pivot, _, line in reversed(squares):
            direction[pivot] = -_dot(line, direction) + direction[pivot]
    certificate = tuple((d, line) for _, d, line in squares)
    return Semidefinite(certificate, None if direction is None else tuple(direction))


def _negative_direction(rest: Sequence[Sequence[Exact]]) -> list[Exact] | None:
    """An x with x·Mx < 0 and no component on an empty row, for an M without positive diagonal; None if M = 0."""
    found: list[Exact] = [Fraction(0)] * len(rest)
    for i, row in enumerate(rest):
        if row[i] != 0:
            found[i] = Fraction(1)
            return found
    for i, row in enumerate(rest):
        for j, x in enumerate(row):
            if x != 0:
                found[i], found[j] = Fraction(1), Fraction(-1 if x > 0 else 1)
                return found
    return None


def _dot(u: Sequence[Exact], v: Sequence[Exact]) -> Exact:
    total: Exact = Fraction(0)
    for x, y in zip(u, v, strict=True):
        total = total + x * y
    return total
