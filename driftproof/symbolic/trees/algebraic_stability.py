"""Algebraic stability, decided exactly: the signs of the weights and of the matrix bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ."""

from __future__ import annotations

from typing import TypeAlias

from flint import fmpq_poly

from driftproof.methods.numbers.number_field import Exact
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

_Matrix: TypeAlias = tuple[tuple[Exact, ...], ...]


def is_semidefinite(matrix: _Matrix) -> bool:
    """True if the symmetric M is positive semidefinite, by M = L D Lᵀ with positive pivots as long as there are any.

    The rest has no positive diagonal entry, or a negative one: it is 0, or x·Mx takes a negative value.
    """
    rest = [list(row) for row in matrix]
    while all(row[i] >= 0 for i, row in enumerate(rest)) and any(row[i] for i, row in enumerate(rest)):
        line, size = next((row, row[i]) for i, row in enumerate(rest) if row[i])
        rest = [
            [x - line[i] * y / size for x, y in zip(row, line, strict=True)] if line[i] else row
            for i, row in enumerate(rest)
        ]
    return not any(map(any, rest))


def quadratic_matrix(method: TreeMethod) -> _Matrix:
    """M with entries mᵢⱼ = bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ, exact, over the stages (hairer-wanner-1996, IV.12 Definition 12.5).

    For collocation given by its node polynomial it is the rational Vᵀ M V, V being the Vandermonde matrix of the nodes.
    """
    stages, basis = _basis(method)
    totals = [stages.weigh(u) for u in basis]
    mixed = _gram(stages, basis, [stages.inner(u) for u in basis])
    size = range(len(basis))
    return tuple(tuple(EXACT.exact(mixed[i][j] + mixed[j][i] - totals[i] * totals[j]) for j in size) for i in size)


def is_algebraically_stable(method: TreeMethod) -> bool:
    """True if all weights bᵢ >= 0, and the matrix bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ is positive semidefinite, as it stands.

    For an irreducible method this is B-stability: no step moves two solutions of a contractive problem further apart
    (hairer-wanner-1996, IV.12 Definition 12.5). The weights are those of diag(b) or, given a node polynomial with real
    roots, of Vᵀ diag(b) V.
    """
    stages, basis = _basis(method)
    weights = tuple(tuple(map(EXACT.exact, row)) for row in _gram(stages, basis, basis))
    return is_semidefinite(weights) and is_semidefinite(quadratic_matrix(method))


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
