"""The modified equation, as a B-series: the vector field whose exact flow is the method."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import factorial

from flint import fmpq

from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.trees.elementary_weights import (
    EXACT,
    ElementaryWeights,
    RingElement,
    TreeMethod,
    stage_algebra,
)
from driftproof.symbolic.trees.rooted_trees import Tree, shapes, tree_table


@dataclass(frozen=True)
class BSeries:
    """The B-series Σ h^r(t)/σ(t) a(t) F(t)(y) over trees of at most `order` vertices, exact, without the term in y.

    The normalisation is that of hairer-lubich-wanner-2006, III.1.1 Definition 1.8: the exact flow has a(t) = 1/γ(t).
    `coefficients` are ring elements in the numbering of the tables.
    """

    order: int
    coefficients: tuple[RingElement, ...]

    def items(self) -> Iterator[tuple[Tree, Exact]]:
        """The pairs (t, a(t)), smallest trees first."""
        return zip(shapes(self.order), map(EXACT.exact, self.coefficients), strict=True)


def method_series(method: TreeMethod, order: int) -> BSeries:
    """The B-series y + Σ ... of one step of a Runge-Kutta method: a(t) = Φ(t) (hairer-lubich-wanner-2006, III.1.1)."""
    weights = ElementaryWeights(stage_algebra(method))
    coefficients = [x for n in range(1, order + 1) for x in weights.of_order(n)]
    return BSeries(order, tuple(coefficients))


def modified_equation(method: TreeMethod, order: int) -> BSeries:
    """The series b of the modified equation h y' = B(b, y), whose time-h flow is the method, for trees up to `order`.

    It is that on y' = f(y), where the nodes c of a table play no part. In y' = f + h f₂ + h² f₃ + ... the term of t is
    h^(r(t)-1) b(t)/σ(t) F(t). The method's series is a = Σⱼ ∂_bʲ⁻¹ b / j!. The terms with j > 1 need b on smaller trees
    only, so b(t) = a(t) - Σ_{j>1} ... follows tree by tree (hairer-lubich-wanner-2006, IX.9.1).
    """
    rows: list[list[RingElement]] = []  # for each tree, ∂_bʲ⁻¹ b for j = 1, 2, ... up to its number of vertices
    for a, cuts in zip(method_series(method, order).coefficients, tree_table(order).cuts, strict=True):
        higher = _higher_derivatives(cuts, rows)
        rows.append([a - sum((x * fmpq(1, factorial(j)) for j, x in enumerate(higher, start=2)), fmpq(0)), *higher])
    return BSeries(order, tuple(row[0] for row in rows))


def _higher_derivatives(cuts: Sequence[tuple[int, int, int]], rows: list[list[RingElement]]) -> list[RingElement]:
    """∂_bʲ⁻¹ b of the next tree for j = 2, 3, ..., from those of smaller trees.

    (∂_b a)(t) = Σ a(remaining) b(fallen) over the edges of t, since the derivative of F(s) in the direction of F(u)
    joins u to one vertex of s after another.
    """
    found: list[RingElement] = []
    for remaining, fallen, times in cuts:
        row, factor = rows[remaining], times * rows[fallen][0]
        found += [fmpq(0)] * (len(row) - len(found))
        if factor:
            for j, x in enumerate(row):
                found[j] += x * factor
    return found
