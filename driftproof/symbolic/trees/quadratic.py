"""The matrix bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ of a method, and algebraic stability, which it and the weights decide."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq_poly

from driftproof.symbolic.trees.scalars import Number, Scalars, scalars_for
from driftproof.symbolic.trees.semidefinite import Matrix, Semidefinite, semidefinite
from driftproof.symbolic.trees.weights import AnyMethod, NodePolynomial, NodeStages


@dataclass(frozen=True)
class AlgebraicStability:
    """Algebraically stable: all weights bᵢ >= 0, and the matrix bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ positive semidefinite.

    For an irreducible method that is B-stability: steps do not push two solutions of a contractive problem apart
    (hairer-wanner-1996, IV.12 Definition 12.5).
    """

    weights: Semidefinite
    matrix: Semidefinite

    @property
    def holds(self) -> bool:
        """Both conditions hold."""
        return self.weights.holds and self.matrix.holds


def quadratic_matrix(method: AnyMethod) -> Matrix:
    """M with entries mᵢⱼ = bᵢaᵢⱼ + bⱼaⱼᵢ - bᵢbⱼ, exact, over the stages (hairer-wanner-1996, IV.12 Definition 12.5).

    For collocation given by its nodes' polynomial: Vᵀ M V, V the Vandermonde matrix of the nodes, which is rational.
    """
    if isinstance(method, NodePolynomial):
        return _collocation_matrix(NodeStages(method.node_polynomial))
    scalars = scalars_for([*method.b, *(x for row in method.a for x in row)])
    weights = [scalars.lift(x) for x in method.b]
    rows = [[scalars.lift(x) for x in row] for row in method.a]
    return _symmetric(
        lambda i, j: weights[i] * rows[i][j] + weights[j] * rows[j][i] - weights[i] * weights[j], len(weights), scalars
    )


def algebraic_stability(method: AnyMethod) -> AlgebraicStability:
    """The decision, for the coefficients as they are given, with a certificate for each of the two conditions.

    The weights' one is the diagonal matrix of the bᵢ; for a nodes' polynomial with real roots, Vᵀ diag(b) V.
    """
    if isinstance(method, NodePolynomial):
        weights = _weight_matrix(NodeStages(method.node_polynomial))
    else:
        zero = Fraction(0)
        weights = tuple(tuple(x if i == j else zero for j in range(len(method.b))) for i, x in enumerate(method.b))
    return AlgebraicStability(semidefinite(weights), semidefinite(quadratic_matrix(method)))


def _collocation_matrix(stages: NodeStages) -> Matrix:
    powers = _powers(stages)
    integrals = [stages.inner(x) for x in powers]
    totals = [stages.weigh(x) for x in powers]

    def entry(i: int, j: int) -> Number:
        one, other = (stages.weigh(stages.times(powers[k], integrals[m])) for k, m in ((i, j), (j, i)))
        return one + other - totals[i] * totals[j]

    return _symmetric(entry, len(powers), stages.scalars)


def _weight_matrix(stages: NodeStages) -> Matrix:
    powers = _powers(stages)
    return _symmetric(lambda i, j: stages.weigh(stages.times(powers[i], powers[j])), len(powers), stages.scalars)


def _powers(stages: NodeStages) -> list[fmpq_poly]:
    return [fmpq_poly([0] * k + [1]) for k in range(stages.modulus.degree())]


def _symmetric(entry: Callable[[int, int], Number], size: int, scalars: Scalars) -> Matrix:
    return tuple(tuple(scalars.exact(entry(i, j)) for j in range(size)) for i in range(size))
