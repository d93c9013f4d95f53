"""Algebraic stability, decided with certificates: the signs of the weights and of bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from flint import fmpq_poly

from driftproof.methods.number_field import Exact, total
from driftproof.methods.schemes import Collocation
from driftproof.symbolic.trees.elementary_weights import (
    EXACT,
    NodeStages,
    RingElement,
    StageAlgebra,
    StageValues,
    TableauStages,
    TreeMethod,
)

_Vector: TypeAlias = tuple[Exact, ...]
_Matrix: TypeAlias = tuple[_Vector, ...]


@dataclass(frozen=True)
class Semidefinite:
    """Whether M is positive semidefinite: x·Mx = Σ d (l·x)² + a remainder, over `squares` (d, l) with d > 0.

    M is semidefinite if the remainder is 0; else `direction` is an x with x·Mx < 0. Multiplying out checks either.
    """

    squares: tuple[tuple[Exact, _Vector], ...]
    direction: _Vector | None

    @property
    def holds(self) -> bool:
        """True if x·Mx >= 0 for all real x."""
        return self.direction is None


def semidefinite(matrix: _Matrix) -> Semidefinite:
    """Decide whether M is positive semidefinite, by M = L D Lᵀ with positive pivots as long as there are any.

    The rest has no positive diagonal entry: it is 0, or x·Mx takes a negative value. Raises ValueError unless M = Mᵀ.
    """
    if matrix != tuple(zip(*matrix, strict=True)):
        raise ValueError("the matrix must be symmetric for its sign to be defined")
    rest = [list(row) for row in matrix]
    squares: list[tuple[int, Exact, _Vector]] = []
    while (pivot := next((i for i, row in enumerate(rest) if row[i] > 0), None)) is not None:
        size, line = rest[pivot][pivot], tuple(x / rest[pivot][pivot] for x in rest[pivot])
        squares.append((pivot, size, line))
        for i, row in enumerate(rest):
            rest[i] = [x - size * line[i] * line[j] for j, x in enumerate(row)]
    direction = _negative_direction(rest)
    if direction is not None:
        # Components off the pivots stay; those on the pivots are chosen, last first, so that all squares vanish.
        for pivot, _, line in reversed(squares):
            direction[pivot] = direction[pivot] - total(x * y for x, y in zip(line, direction, strict=True))
    certificate = tuple((d, line) for _, d, line in squares)
    return Semidefinite(certificate, None if direction is None else tuple(direction))


def _negative_direction(rest: Sequence[Sequence[Exact]]) -> list[Exact] | None:
    """An x with x·Mx < 0, zero where M has a zero row, for an M without positive diagonal entries; None if M = 0."""
    found: list[Exact] = [Fraction(0)] * len(rest)
    for i, row in enumerate(rest):
        if row[i]:
            found[i] = Fraction(1)
            return found
    for i, row in enumerate(rest):
        for j, x in enumerate(row):
            if x:
                found[i], found[j] = Fraction(1), Fraction(-1 if x > 0 else 1)
                return found
    return None


@dataclass(frozen=True)
class AlgebraicStability:
    """Algebraic stability: all weights bᵢ >= 0, and the matrix bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ is positive semidefinite.

    For an irreducible method this is B-stability: no step moves two solutions of a contractive problem further apart
    (hairer-wanner-1996, IV.12 Definition 12.5).
    """

    weights: Semidefinite
    matrix: Semidefinite

    @property
    def holds(self) -> bool:
        """True if both conditions hold."""
        return self.weights.holds and self.matrix.holds


def quadratic_matrix(method: TreeMethod) -> _Matrix:
    """M with entries mᵢⱼ = bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ, exact, over the stages (hairer-wanner-1996, IV.12 Definition 12.5).

    For collocation given by its node polynomial it is the rational Vᵀ M V, V being the Vandermonde matrix of the nodes.
    """
    stages, basis = _basis(method)
    totals = [stages.weigh(u) for u in basis]
    mixed = _gram(stages, basis, [stages.inner(u) for u in basis])
    size = range(len(basis))
    return tuple(tuple(EXACT.exact(mixed[i][j] + mixed[j][i] - totals[i] * totals[j]) for j in size) for i in size)


def algebraic_stability(method: TreeMethod) -> AlgebraicStability:
    """Decide both conditions for the coefficients as given, each with a certificate.

    The certificate of the weights is for diag(b) or, given a node polynomial with real roots, for Vᵀ diag(b) V.
    """
    stages, basis = _basis(method)
    weights = tuple(tuple(map(EXACT.exact, row)) for row in _gram(stages, basis, basis))
    return AlgebraicStability(semidefinite(weights), semidefinite(quadratic_matrix(method)))


def _basis(method: TreeMethod) -> tuple[StageAlgebra, list[StageValues]]:
    """The stage algebra and a basis of its values: unit vectors or, for a node polynomial, the powers of x."""
    if isinstance(method, Collocation):
        nodes = NodeStages(method.node_polynomial)
        return nodes, [fmpq_poly([0] * k + [1]) for k in range(nodes.modulus.degree())]
    size = range(len(method.b))
    return TableauStages(method.a, method.b), [[EXACT.lift(int(i == j)) for j in size] for i in size]


def _gram(stages: StageAlgebra, left: list[StageValues], right: list[StageValues]) -> list[list[RingElement]]:
    """The matrix of the b · (uᵢ vⱼ)."""
    return [[stages.weigh(stages.times(u, v)) for v in right] for u in left]
