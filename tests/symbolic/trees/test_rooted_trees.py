"""Rooted trees: each once, with γ, σ, cuts and products, against counts in print and against brute force."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction as Q
from itertools import product
from math import factorial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.symbolic.trees import rooted_trees as tables
from driftproof.symbolic.trees.rooted_trees import (
    TooManyTrees,
    Tree,
    alternately_coloured,
    canonical_tree,
    coloured_shapes,
    density,
    rooted_trees,
    shapes,
    to_brackets,
    tree_number,
    tree_table,
    vertices,
)
from tests.looping import some
from tests.witnesses.trees import sorted_tree, symmetry

# hairer-norsett-wanner-1993, II.2: the numbers of rooted trees, there to order 10.
COUNTS = [1, 1, 2, 4, 9, 20, 48, 115, 286, 719, 1842, 4766]


def trees_of_parent_lists(n: int) -> Counter[Tree]:
    """Every rooted tree on 0 ... n-1 in which parents have smaller labels, by shape, and how often."""
    found: Counter[Tree] = Counter()
    for parents in product(*(range(i) for i in range(1, n))):
        branches: list[list[Tree]] = [[] for _ in range(n)]
        for vertex in range(n - 1, 0, -1):
            branches[parents[vertex - 1]].append(sorted_tree(tuple(branches[vertex])))
        found[sorted_tree(tuple(branches[0]))] += 1
    return found


def test_numbers_of_trees_are_those_of_the_table() -> None:
    table = tree_table(12)
    assert [len(table.ids(n)) for n in range(1, 13)] == COUNTS
    assert [len(rooted_trees(n)) for n in range(1, 13)] == COUNTS
    assert table.order == 12


@pytest.mark.parametrize("n", range(1, 9))
def test_trees_are_those_of_all_parent_lists_and_each_occurs_once(n: int) -> None:
    assert Counter(map(sorted_tree, rooted_trees(n))) == Counter(set(trees_of_parent_lists(n)))


@pytest.mark.parametrize("n", range(1, 9))
def test_density_and_symmetry_count_the_monotone_labellings(n: int) -> None:
    """A tree is n!/(σ γ) of the (n - 1)! parent lists (hairer-norsett-wanner-1993, II.2)."""
    found = trees_of_parent_lists(n)
    for tree in some(rooted_trees(n)):
        assert found[sorted_tree(tree)] == Q(factorial(n), symmetry(tree) * density(tree))


def test_columns_agree_with_the_trees_they_are_about() -> None:
    table = tree_table(9)
    assert table.density == tuple(map(density, shapes(9)))
    assert table.symmetry == tuple(map(symmetry, shapes(9)))
    assert shapes(9) == tuple(map(canonical_tree, shapes(9)))
    assert [tree_number(tree) for tree in shapes(9)] == list(range(len(shapes(9))))


def test_larger_table_extends_the_smaller() -> None:
    for small, large in ((tree_table(4), tree_table(9)), (tree_table(3, 2, 1), tree_table(5, 2, 1))):
        size = len(small.rest)
        for column in ("rest", "branch", "density", "symmetry", "kind"):
            assert getattr(small, column) == getattr(large, column)[:size]


# Of at most 12 vertices, as many as have a table: few leaves may carry long chains.
trees = st.recursive(st.just(()), lambda inner: st.lists(inner, max_size=4).map(tuple), max_leaves=7)
trees = trees.filter(lambda tree: vertices(tree) <= 12)


@given(trees)
def test_canonical_tree_is_one_of_the_table_whatever_the_order_of_its_branches(tree: Tree) -> None:
    assert shapes(vertices(tree))[tree_number(tree)] == canonical_tree(tree)
    assert sorted_tree(canonical_tree(tree)) == sorted_tree(tree)


def test_trees_as_they_are_written() -> None:
    assert [to_brackets(tree) for tree in rooted_trees(4)] == ["[τ,τ,τ]", "[τ,[τ]]", "[[τ,τ]]", "[[[τ]]]"]
    coloured = alternately_coloured(((), ((),)), "v", "q")
    assert to_brackets(coloured) == "[τ_q,[τ_v]_q]_v"


small = trees.filter(lambda tree: vertices(tree) <= 6)


@given(small, small)
def test_join_adds_a_branch_at_the_root(root: Tree, branch: Tree) -> None:
    joined = tree_table(vertices(root) + vertices(branch)).join(tree_number(root), tree_number(branch))
    assert shapes(vertices(root) + vertices(branch))[joined] == canonical_tree((*root, branch))


def test_join_beyond_the_table_is_an_error() -> None:
    for order, root, branch in ((3, 1, 1), (2, 1, 0)):
        with pytest.raises(KeyError, match=f"exceeds the table, which ends at order {order}"):
            tree_table(order).join(root, branch)


def cut_once(tree: Tree) -> Counter[tuple[Tree, Tree]]:
    """What remains and what falls off, edge by edge."""
    found: Counter[tuple[Tree, Tree]] = Counter()
    for i, branch in enumerate(tree):
        others = (*tree[:i], *tree[i + 1 :])
        found[canonical_tree(others), canonical_tree(branch)] += 1
        for (remaining, fallen), times in cut_once(branch).items():
            found[canonical_tree((*others, remaining)), fallen] += times
    return found


def test_cuts_are_those_of_every_edge() -> None:
    trees, cuts = shapes(7), tree_table(7).cuts
    for tree, found in some(zip(trees, cuts, strict=True), 48):
        assert {(trees[r], trees[f]): times for r, f, times in found} == cut_once(tree)
        assert sum(times for *_, times in found) == vertices(tree) - 1


def test_trees_of_two_colours_are_distinct_and_keep_the_second_kind_of_leaf_a_leaf() -> None:
    both = tree_table(7, 2, 2)
    assert [len(both.ids(n)) for n in range(1, 8)] == [2, 4, 14, 52, 214, 916, 4116]
    shapes_of_both = coloured_shapes(5, ("q", "v"), 2)
    assert len(set(shapes_of_both)) == len(shapes_of_both) == sum([2, 4, 14, 52, 214])
    leaves = coloured_shapes(4, ("y", "t"), 1)
    assert len(leaves) == len(set(leaves)) == 2 + 2 + 5 + 13
    assert any("τ_t" in to_brackets(tree) for tree in leaves)
    assert not any("]_t" in to_brackets(tree) for tree in leaves)


def test_symmetry_of_coloured_trees_respects_colours() -> None:
    """Σ n!/σ = nⁿ⁻¹ 2ⁿ: labelled trees with a colour at every vertex."""
    for n in range(1, 7):
        table = tree_table(n, 2, 2)
        assert sum(Q(factorial(n), table.symmetry[t]) for t in table.ids(n)) == n ** (n - 1) * 2**n


def test_an_order_without_end_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "MOST_TREES", 1000)
    tables.tree_table.cache_clear()
    assert len(tree_table(10).ids(10)) == 719
    with pytest.raises(TooManyTrees, match="more than 1000 trees of order 11"):
        tree_table(11)
