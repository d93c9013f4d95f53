"""What a B-series says of a method, tree by tree, without its coefficients: symplectic, Hamiltonian, symmetric."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from driftproof.symbolic.trees.modified_equation import BSeries
from driftproof.symbolic.trees.rooted_trees import shapes, tree_table, vertices


def symplectic_to_order(series: BSeries) -> int:
    """The largest n up to the order with a(u∘v) + a(v∘u) = a(u) a(v) wherever u and v have at most n vertices together.

    For all n: every quadratic invariant of every problem is kept (hairer-lubich-wanner-2006, VI.7.2).
    """
    return _holds_to_order(series, lambda a, b: a * b)


def hamiltonian_to_order(field: BSeries) -> int:
    """The same with b(u∘v) + b(v∘u) = 0: for all n the vector field is Hamiltonian whenever f is (IX.9.2)."""
    return _holds_to_order(field, lambda a, b: 0)


def symmetric_to_order(field: BSeries) -> int:
    """The largest n up to the order to which the modified equation has trees of odd order only (IX.2 Theorem 2.2)."""
    even = [vertices(tree) for tree, x in field.items() if x and vertices(tree) % 2 == 0]
    return min(even, default=field.order + 1) - 1


def _holds_to_order(series: BSeries, expected: Callable[[Any, Any], Any]) -> int:
    table, a, sizes = tree_table(series.order), series.coefficients, [*map(vertices, shapes(series.order))]
    for n in range(2, series.order + 1):
        for u in range(table.first[n]):
            # Each pair once: v is the larger tree, or as large.
            for v in table.ids(n - sizes[u]) if 2 * sizes[u] <= n else ():
                if a[table.join(u, v)] + a[table.join(v, u)] != expected(a[u], a[v]):
                    return n - 1
    return series.order
