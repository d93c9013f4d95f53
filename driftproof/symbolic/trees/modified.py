"""The modified equation: the vector field whose exact flow is the method, and the flow of a given one, as B-series."""

from __future__ import annotations

from flint import fmpq

from driftproof.symbolic.trees.scalars import Number
from driftproof.symbolic.trees.series import BSeries, method_series
from driftproof.symbolic.trees.table import TreeTable, tree_table
from driftproof.symbolic.trees.weights import AnyMethod


def modified_equation(method: AnyMethod, order: int) -> BSeries:
    """The b with b(∅) = 0 such that the method is the time-h flow of h y' = B(b, y), for trees up to `order`.

    In y' = f + h f₂ + h² f₃ + ... the term of t is h^(r(t)-1) b(t)/σ(t) F(t) (hairer-lubich-wanner-2006, IX.9.1).
    """
    return logarithm(method_series(method, order))


def logarithm(series: BSeries) -> BSeries:
    """The vector field b whose flow over one step is the B-series a with a(∅) = 1: a = Σⱼ ∂_bʲ⁻¹ b / j!.

    The j-th Lie derivative of a tree needs b on smaller trees only, so b(t) = a(t) - Σ_{j>1} follows tree by tree
    (hairer-lubich-wanner-2006, IX.9.1). Raises ValueError if a(∅) is not 1.
    """
    if series.empty != 1:
        raise ValueError(f"only a series near the identity is a flow: a(∅) is {series.empty}, not 1")
    table, field = tree_table(series.order), _LieDerivatives(tree_table(series.order))
    for t, a in enumerate(series.coefficients):
        higher = field.higher(t)
        field.append(a - _exponential_sum(higher), higher)
    return BSeries(table.order, fmpq(0), tuple(field.of(1)), series.scalars)


def flow(field: BSeries) -> BSeries:
    """The B-series of the flow of h y' = B(b, y) over one step, b(∅) = 0: the inverse of `logarithm`."""
    if field.empty != 0:
        raise ValueError(f"a vector field has no coefficient of the empty tree, this one has {field.empty}")
    derivatives, found = _LieDerivatives(tree_table(field.order)), []
    for t, b in enumerate(field.coefficients):
        higher = derivatives.higher(t)
        derivatives.append(b, higher)
        found.append(b + _exponential_sum(higher))
    return BSeries(field.order, fmpq(1), tuple(found), field.scalars)


class _LieDerivatives:
    """∂_bʲ⁻¹ b of one tree after another, j = 1, 2, ..., for a vector field b that is known as far as it is needed."""

    def __init__(self, table: TreeTable) -> None:
        self._cuts = table.cuts
        self._rows: list[list[Number]] = []  # of each tree, for j = 1, 2, ... up to its number of vertices

    def higher(self, t: int) -> list[Number]:
        """The derivatives j = 2, 3, ... of the next tree, which need b on smaller trees only.

        (∂_b a)(t) = Σ a(remaining) b(fallen) over the edges of t, since the derivative of F(s) in the direction of
        F(u) joins u to one vertex of s after another.
        """
        found: list[Number] = []
        for remaining, fallen, times in self._cuts[t]:
            row = self._rows[remaining]
            factor = times * self._rows[fallen][0]
            found += [fmpq(0)] * (len(row) - len(found))
            if factor:
                for j, x in enumerate(row):
                    found[j] += x * factor
        return found

    def append(self, b: Number, higher: list[Number]) -> None:
        """Record the next tree."""
        self._rows.append([b, *higher])

    def of(self, j: int) -> list[Number]:
        """The j-th derivatives of all trees so far; the first are b itself."""
        return [row[j - 1] for row in self._rows]


def _exponential_sum(higher: list[Number]) -> Number:
    """Σ xⱼ / j! over j = 2, 3, ..."""
    total, factorial = fmpq(0), 1
    for j, x in enumerate(higher, start=2):
        factorial *= j
        total += x * fmpq(1, factorial)
    return total
