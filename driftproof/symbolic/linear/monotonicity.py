"""The radius of absolute monotonicity (SSP coefficient) of a Runge-Kutta method, as an exact algebraic number."""

from __future__ import annotations

from fractions import Fraction

from flint import fmpq, fmpq_mat

from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.matrices import (
    MatrixRows,
    characteristic_and_adjugate,
    matrix_determinant,
    matrix_product,
)
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    X,
    coefficients,
    descend,
    dot,
    evaluate,
    from_scalars,
    scalar,
    sign,
)
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT as ZERO_LIMIT
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced_stages_of
from driftproof.symbolic.linear.stability_limits import Limit, first_failure, smallest


def ssp_coefficient(method: RungeKutta | Collocation) -> Limit:
    """The largest r with (I + ϱK)⁻¹ defined, K(I + ϱK)⁻¹ >= 0 and ϱK(I + ϱK)⁻¹e <= e for all ϱ in [0, r].

    K is the irreducible A with bᵀ as a further row (kraaijevanger-1991, section 4). A step that keeps a convex
    functional from growing for forward Euler with h <= h₀ does so for this method with h <= r h₀. A negative entry of
    K gives 0.
    """
    if isinstance(method, Collocation):
        found = _tableau(method)
        return ZERO_LIMIT if found is None else ssp_coefficient(found)
    stages = reduced_stages_of(method)
    if any(x < 0 for row in (*stages.a, *stages.weights) for x in row):
        return ZERO_LIMIT
    return smallest([_nonnegative_limit(p) for p in monotonicity_conditions(stages)])


def _tableau(method: Collocation) -> RungeKutta | None:
    """The tableau of collocation at one node, or at 0 and another; None for the others, where K has a negative entry.

    For if K >= 0, no node is negative, as cᵢ = Σⱼ aᵢⱼ. Let c be the smallest positive node, in the row i. If no node is
    0, then c²/2 = Σⱼ aᵢⱼcⱼ >= c Σⱼ aᵢⱼ = c². If one is 0 and s >= 3, then c³/3 = Σⱼ aᵢⱼcⱼ² >= c Σⱼ aᵢⱼcⱼ = c³/2. Stages
    that do not count meet only zeros of A, and leaving them out changes nothing.
    """
    constant, *others = method.node_polynomial
    if len(others) == 1:
        rows, weights, nodes = [[-constant]], [Fraction(1)], [-constant]
    elif len(others) == 2 and constant == 0:
        x = -others[0]
        rows, weights, nodes = [[Fraction(0)] * 2, [x / 2] * 2], [1 - 1 / (2 * x), 1 / (2 * x)], [Fraction(0), x]
    else:
        return None
    a = tuple(map(tuple, rows))
    return RungeKutta(method.key, method.title, 0, method.source, a, tuple(weights), tuple(nodes))


def monotonicity_conditions(stages: StageCoefficients) -> list[Polynomial]:
    """What must be >= 0: det(I + rA), and times it the entries of K(I + rK)⁻¹ and of e - rK(I + rK)⁻¹e, in Q[r]."""
    a = [[scalar(x) for x in row] for row in stages.a]
    rows = [*a, [scalar(x) for x in stages.weights[0]]]
    if any(x != 0 for i, row in enumerate(a) for x in row[i:]):
        common, inverse = _scaled_inverse(a)
        entries = matrix_product([[ONE * x for x in row] for row in rows], inverse)
    else:
        common, entries = ONE, _series_of_nilpotent(rows, a)
    slack = [common - (X * dot(row, [ONE] * len(row))) for row in entries]
    distinct = {coefficients(p): descend(p) for p in (common, *(p for row in entries for p in row), *slack) if p != 0}
    return list(distinct.values())


def _scaled_inverse(a: MatrixRows) -> tuple[Polynomial, list[list[Polynomial]]]:
    """(det(I + rA), adj(I + rA))."""
    shifted = [[X * x + int(i == j) for j, x in enumerate(row)] for i, row in enumerate(a)]
    return matrix_determinant(shifted), characteristic_and_adjugate(shifted)[1]


def _series_of_nilpotent(rows: MatrixRows, a: MatrixRows) -> list[list[Polynomial]]:
    """K(I + rA)⁻¹ = Σ K(-rA)ᵏ, k < s, for strictly lower triangular A; over Q by FLINT's matrices."""
    if all(isinstance(x, fmpq) for row in rows for x in row):
        current, step = fmpq_mat([list(row) for row in rows]), -fmpq_mat([list(row) for row in a])
        powers = [current.tolist()]
        for _ in range(len(a) - 1):
            current = current * step
            powers.append(current.tolist())
    else:
        negative = [[-x for x in row] for row in a]
        powers = [[list(row) for row in rows]]
        for _ in range(len(a) - 1):
            powers.append(matrix_product(powers[-1], negative))
    return [[from_scalars([p[i][j] for p in powers]) for j in range(len(a))] for i in range(len(rows))]


def _nonnegative_limit(p: Polynomial) -> Limit:
    return first_failure([p], lambda r: sign(evaluate(p, r)) >= 0)
