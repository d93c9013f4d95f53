"""Rooted trees by their definitions, which share nothing with the tables: symmetry and the tree without a fork."""

from __future__ import annotations

from collections import Counter
from math import factorial, prod

from driftproof.symbolic.trees.rooted_trees import Tree


def sorted_tree(tree: Tree) -> Tree:
    """A canonical form of our own: branches sorted as nested tuples, not as the tables do."""
    return tuple(sorted(map(sorted_tree, tree)))


def symmetry(tree: Tree) -> int:
    """σ(t), the number of automorphisms."""
    copies = Counter(map(sorted_tree, tree))
    return prod(symmetry(branch) ** times * factorial(times) for branch, times in copies.items())


def tall(vertices: int) -> Tree:
    """The tree without a fork, [[...[τ]...]]: the condition b Aⁿ⁻¹ 1 = 1/n!, the only one on linear problems."""
    return (tall(vertices - 1),) if vertices > 1 else ()
