"""The witnesses for rooted trees, counted out by hand."""

from __future__ import annotations

from itertools import permutations

from tests.witnesses.trees import sorted_tree, symmetry, tall


def test_symmetry_counts_the_exchanges_of_equal_branches() -> None:
    assert [symmetry(tree) for tree in ((), ((),), ((), ()), ((), ((),)), (((), ()), ((), ())))] == [1, 1, 2, 1, 8]
    assert symmetry(((),) * 5) == len(list(permutations(range(5))))


def test_tall_tree_has_one_branch_at_each_vertex_but_the_last() -> None:
    assert [tall(1), tall(2), tall(4)] == [(), ((),), ((((),),),)]


def test_canonical_form_forgets_the_order_of_branches_only() -> None:
    assert sorted_tree((((),), ())) == sorted_tree(((), ((),)))
    assert sorted_tree(((), ())) != sorted_tree((((),),))
