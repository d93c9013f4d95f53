"""The modified equation, as a B-series: the vector field whose exact flow is the method."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from flint import fmpq

from driftproof.methods.number_field import Exact
from driftproof.symbolic.trees.elementary_weights import (
    EXACT,
    ElementaryWeights,
    RingElement,
    TreeMethod,
    stage_algebra,
)
from driftproof.symbolic.trees.rooted_trees import Tree, TreeTable, shapes, tree_number, tree_table, vertices


@dataclass(frozen=True)
class BSeries:
    """Σ h^r(t)/σ(t) a(t) F(t)(y) for trees of at most `order` vertices, exact; what stands before y is left out.

    The normalisation is that of hairer-lubich-wanner-2006, III.1.1 Definition 1.8: the exact flow has a(t) = 1/γ(t).
    `coefficients` are in the numbering of the tables, as they compute; `coefficient` reads one as it is written.
    """

    order: int
    coefficients: tuple[RingElement, ...]

    def coefficient(self, tree: Tree) -> Exact:
        """a(t). Raises KeyError for a tree with more than `order` vertices."""
        if vertices(tree) > self.order:
            raise KeyError(f"a tree of {vertices(tree)} vertices in a B-series of order {self.order}")
        return EXACT.exact(self.coefficients[tree_number(tree)])

    def items(self) -> Iterator[tuple[Tree, Exact]]:
        """The pairs (t, a(t)), smallest trees first."""
        return zip(shapes(self.order), map(EXACT.exact, self.coefficients), strict=True)


def method_series(method: TreeMethod, order: int) -> BSeries:
    """The B-series y + Σ ... of one step of a Runge-Kutta method: a(t) = Φ(t) (hairer-lubich-wanner-2006, III.1.1)."""
    weights = ElementaryWeights(stage_algebra(method))
    coefficients = [x for n in range(1, order + 1) for x in weights.of_order(n)]
    return BSeries(order, tuple(coefficients))


def modified_equation(method: TreeMethod, order: int) -> BSeries:
    """The b such that the method is the time-h flow of h y' = B(b, y), for trees up to `order`.

    In y' = f + h f₂ + h² f₃ + ... the term of t is h^(r(t)-1) b(t)/σ(t) F(t). The method's a is Σⱼ ∂_bʲ⁻¹ b / j!, where
    the j-th Lie derivative of a tree needs b on smaller trees only, so b(t) = a(t) - Σ_{j>1} follows tree by tree
    (hairer-lubich-wanner-2006, IX.9.1).
    """
    series, derivatives, found = method_series(method, order), _LieDerivatives(tree_table(order)), []
    for t, a in enumerate(series.coefficients):
        higher = derivatives.higher(t)
        found.append(a - _exponential_sum(higher))
        derivatives.append(found[-1], higher)
    return BSeries(order, tuple(found))


class _LieDerivatives:
    """∂_bʲ⁻¹ b of one tree after another, j = 1, 2, ..., for a vector field b that is known as far as it is needed."""

    def __init__(self, table: TreeTable) -> None:
        self._cuts = table.cuts
        self._rows: list[list[RingElement]] = []  # of each tree, for j = 1, 2, ... up to its number of vertices

    def higher(self, t: int) -> list[RingElement]:
        """The derivatives j = 2, 3, ... of the next tree, which need b on smaller trees only.

        (∂_b a)(t) = Σ a(remaining) b(fallen) over the edges of t, since the derivative of F(s) in the direction of
        F(u) joins u to one vertex of s after another.
        """
        found: list[RingElement] = []
        for remaining, fallen, times in self._cuts[t]:
            row = self._rows[remaining]
            factor = times * self._rows[fallen][0]
            found += [fmpq(0)] * (len(row) - len(found))
            if factor:
                for j, x in enumerate(row):
                    found[j] += x * factor
        return found

    def append(self, b: RingElement, higher: list[RingElement]) -> None:
        """Record the next tree."""
        self._rows.append([b, *higher])


def _exponential_sum(higher: list[RingElement]) -> RingElement:
    """Σ xⱼ / j! over j = 2, 3, ..."""
    total, factorial = fmpq(0), 1
    for j, x in enumerate(higher, start=2):
        factorial *= j
        total += x * fmpq(1, factorial)
    return total
