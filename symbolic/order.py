"""The order of a Runge-Kutta method by rooted trees: exact conditions, and the first tree that fails."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement
from math import prod
from typing import TypeAlias

from methods.schemes import RungeKutta

# A rooted tree is the sorted tuple of the subtrees at its root; () is the single vertex.
Tree: TypeAlias = tuple["Tree", ...]


@cache
def rooted_trees(order: int) -> tuple[Tree, ...]:
    """All rooted trees with `order` vertices: 1, 1, 2, 4, 9, 20, ... (hairer-norsett-wanner-1993, II.2)."""
    return tuple(sorted(set(_forests(order - 1, order - 1))))


def _forests(vertices: int, largest: int) -> Iterator[Tree]:
    """Every multiset of trees with `vertices` vertices together, none of more than `largest`, as a sorted tuple."""
    if vertices == 0:
        yield ()
        return
    for size in range(min(vertices, largest), 0, -1):
        for copies in range(1, vertices // size + 1):
            for rest in _forests(vertices - copies * size, size - 1):
                for chosen in combinations_with_replacement(rooted_trees(size), copies):
                    yield tuple(sorted(chosen + rest))


def vertices(tree: Tree) -> int:
    """The number of vertices, r(t)."""
    return 1 + sum(vertices(child) for child in tree)


def density(tree: Tree) -> int:
    """γ(t) = r(t) Π γ(child): the exact solution's weight of the tree is 1/γ(t) (hairer-norsett-wanner-1993, II.2)."""
    return vertices(tree) * prod(density(child) for child in tree)


def elementary_weight(method: RungeKutta, tree: Tree) -> Fraction:
    """Φ(t) = Σᵢ bᵢ Π_children (A ...)ᵢ, the method's weight of the tree, exact (butcher-2016, 312).

    Uses A and b only; a c that disagrees with A's row sums is an inconsistency that the method itself reports.
    """
    return sum((b * x for b, x in zip(method.b, _stage_weights(method, tree), strict=True)), Fraction(0))


def _stage_weights(method: RungeKutta, tree: Tree) -> list[Fraction]:
    weights = [Fraction(1)] * method.stages
    for child in tree:
        inner = _stage_weights(method, child)
        for i, row in enumerate(method.a):
            weights[i] *= sum((a * x for a, x in zip(row, inner, strict=True)), Fraction(0))
    return weights


def failing_condition(method: RungeKutta, order: int) -> tuple[Tree, Fraction] | None:
    """The first tree with `order` vertices whose Φ(t) - 1/γ(t) is not zero, with that residual; None if all hold."""
    for tree in rooted_trees(order):
        residual = elementary_weight(method, tree) - Fraction(1, density(tree))
        if residual != 0:
            return tree, residual
    return None


def runge_kutta_order(method: RungeKutta) -> int:
    """The largest p such that Φ(t) = 1/γ(t) for every tree with at most p vertices: the order on any smooth problem."""
    order = 0
    while failing_condition(method, order + 1) is None:
        order += 1
    return order
