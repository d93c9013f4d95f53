"""The radius of absolute monotonicity (SSP coefficient) of a Runge-Kutta method, as an exact algebraic number."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.algebra.matrices import faddeev_leverrier, matrix_product
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    X,
    descend,
    dot,
    from_scalars,
    scalar,
)
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT as ZERO_LIMIT
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced_stages_of
from driftproof.symbolic.linear.stability_limits import Limit, nonnegative_limit, smallest


def ssp_coefficient(method: RungeKutta | Collocation) -> Limit:
    """The largest r with (I + ϱK)⁻¹ defined, K(I + ϱK)⁻¹ >= 0 and ϱK(I + ϱK)⁻¹e <= e for all ϱ in [0, r].

    K is the irreducible A with bᵀ as a further row (kraaijevanger-1991, section 4). If no step of forward Euler with
    h <= h₀ increases a convex functional, then no step of this method with h <= r h₀ does. A negative entry of K
    gives 0.
    """
    stages = _stages(method) if isinstance(method, Collocation) else reduced_stages_of(method)
    if stages is None or any(x < 0 for row in (*stages.a, *stages.weights) for x in row):
        return ZERO_LIMIT
    return smallest([nonnegative_limit(p) for p in monotonicity_conditions(stages)])


def _stages(method: Collocation) -> StageCoefficients | None:
    """The coefficients of collocation at one node, or at 0 and another; None for other nodes: K has a negative entry.

    Proof: let K >= 0 and s >= 2. No node is negative, as cᵢ = Σⱼ aᵢⱼ. Let c be the smallest positive node, in row i. If
    no node is 0, then c²/2 = Σⱼ aᵢⱼcⱼ >= c Σⱼ aᵢⱼ = c². If one is 0 and s >= 3, then c³/3 = Σⱼ aᵢⱼcⱼ² >= c Σⱼ aᵢⱼcⱼ =
    c³/2. The sums are those of the irreducible A, as it leaves out only zeros of the rows that it keeps.
    """
    constant, *others = method.node_polynomial
    if len(others) == 1:
        return _with_row_sums([(-constant,)], (Fraction(1),))
    if len(others) == 2 and not constant:
        x = -others[0]
        return _with_row_sums([(Fraction(0),) * 2, (x / 2,) * 2], (1 - 1 / (2 * x), 1 / (2 * x)))
    return None


def _with_row_sums(a: Sequence[tuple[Exact, ...]], weights: tuple[Exact, ...]) -> StageCoefficients:
    return StageCoefficients(tuple(a), (weights,), tuple(sum(row, Fraction(0)) for row in a))


def monotonicity_conditions(stages: StageCoefficients) -> list[Polynomial]:
    """The polynomials in r that must be >= 0: det(I + rA), and its multiples by K(I + rK)⁻¹ and e - rK(I + rK)⁻¹e."""
    a = [[scalar(x) for x in row] for row in stages.a]
    rows, size = [*a, [scalar(x) for x in stages.weights[0]]], range(len(a))
    found, matrices = faddeev_leverrier([[-x for x in row] for row in a])  # det(I + rA) and adj(I + rA), by powers of r
    common, terms = from_scalars(found), [matrix_product(rows, m) for m in matrices]
    entries = [[from_scalars([term[i][j] for term in terms]) for j in size] for i in range(len(rows))]
    slack = [common - (X * dot(row, [ONE] * len(row))) for row in entries]
    distinct = {str(p): descend(p) for p in (common, *(p for row in entries for p in row), *slack) if p}
    return list(distinct.values())
