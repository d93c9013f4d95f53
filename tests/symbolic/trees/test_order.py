"""Rooted trees and order conditions, against counts in print and tableaux whose order is in print."""

from __future__ import annotations

from fractions import Fraction as Q
from math import factorial, prod
from typing import Any

import pytest
from hypothesis import given

from driftproof import strategies
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.derivation.convergence import local_error
from driftproof.symbolic.derivation.one_step import one_step_matrix
from driftproof.symbolic.trees.order import elementary_weight, failing_condition, order
from driftproof.symbolic.trees.rooted import Tree, density, rooted_trees, vertices


def test_numbers_of_trees_are_those_of_the_table() -> None:
    assert [len(rooted_trees(n)) for n in range(1, 11)] == [1, 1, 2, 4, 9, 20, 48, 115, 286, 719]


def test_trees_are_distinct_and_have_their_vertices() -> None:
    for n in range(1, 9):
        assert len(set(rooted_trees(n))) == len(rooted_trees(n))
        assert {vertices(tree) for tree in rooted_trees(n)} == {n}


def symmetry(tree: Tree) -> int:
    """σ(t), the number of automorphisms: typed here, as a witness for γ."""
    return prod(symmetry(child) for child in tree) * prod(factorial(tree.count(child)) for child in set(tree))


@pytest.mark.parametrize("n", range(1, 10))
def test_monotone_labellings_of_all_trees_add_up(n: int) -> None:
    """Σ n!/(σ γ) = (n-1)!: each labelling grows a tree by one of its vertices at a time."""
    assert sum(Q(factorial(n), symmetry(tree) * density(tree)) for tree in rooted_trees(n)) == factorial(n - 1)


def test_density_of_the_bush_and_the_tall_tree() -> None:
    bush: Tree = ((), (), (), ())
    tall: Tree = ((((),),),)
    assert (density(bush), density(tall), density(())) == (5, 24, 1)


def tableau(a: Any, b: Any, claimed: int) -> RungeKutta:
    return RungeKutta("printed", "Printed", claimed, "test", a, b, tuple(sum(map(Q, row)) for row in a))


PRINTED = {
    "explicit midpoint": tableau(((0, 0), (Q(1, 2), 0)), (0, 1), 2),
    "implicit midpoint": tableau(((Q(1, 2),),), (1,), 2),
    "backward Euler": tableau(((1,),), (1,), 1),
    "trapezoidal rule": tableau(((0, 0), (Q(1, 2), Q(1, 2))), (Q(1, 2), Q(1, 2)), 2),
    "Kutta's third order": tableau(((0, 0, 0), (Q(1, 2), 0, 0), (-1, 2, 0)), (Q(1, 6), Q(2, 3), Q(1, 6)), 3),
    "Radau IIA": tableau(((Q(5, 12), Q(-1, 12)), (Q(3, 4), Q(1, 4))), (Q(3, 4), Q(1, 4)), 3),
    "Lobatto IIIA": tableau(
        ((0, 0, 0), (Q(5, 24), Q(1, 3), Q(-1, 24)), (Q(1, 6), Q(2, 3), Q(1, 6))), (Q(1, 6), Q(2, 3), Q(1, 6)), 4
    ),
    "Butcher's fifth order": tableau(
        (
            (0, 0, 0, 0, 0, 0),
            (Q(1, 4), 0, 0, 0, 0, 0),
            (Q(1, 8), Q(1, 8), 0, 0, 0, 0),
            (0, Q(-1, 2), 1, 0, 0, 0),
            (Q(3, 16), 0, 0, Q(9, 16), 0, 0),
            (Q(-3, 7), Q(2, 7), Q(12, 7), Q(-12, 7), Q(8, 7), 0),
        ),
        (Q(7, 90), 0, Q(32, 90), Q(12, 90), Q(32, 90), Q(7, 90)),
        5,
    ),
    "nothing at all": tableau(((0,),), (0,), 0),
}


@pytest.mark.parametrize("name", PRINTED)
def test_order_of_a_printed_tableau_is_the_printed_one(name: str) -> None:
    method = PRINTED[name]
    assert order(method).order == method.claimed_order
    assert failing_condition(method, method.claimed_order + 1) is not None


def test_failing_condition_names_the_tree_and_the_residual() -> None:
    assert failing_condition(PRINTED["backward Euler"], 1) is None
    assert failing_condition(PRINTED["backward Euler"], 2) == (((),), Q(1, 2))


def test_elementary_weights_of_backward_euler_are_all_one() -> None:
    assert {elementary_weight(PRINTED["backward Euler"], tree) for n in range(1, 7) for tree in rooted_trees(n)} == {1}


def test_order_on_the_oscillator_can_exceed_the_order_and_is_not_mistaken_for_it() -> None:
    """R(z) = 1 + z + z²/2 + z³/6, but b·c² = 1/4, not 1/3: third order on linear problems only."""
    halves = tableau(((0, 0, 0), (Q(1, 3), 0, 0), (0, Q(1, 2), 0)), (0, 0, 1), 2)
    assert (order(halves).order, local_error(one_step_matrix(halves)).linear_order) == (2, 3)
    assert failing_condition(halves, 3) == (((), ()), Q(1, 4) - Q(1, 3))


@given(strategies.runge_kutta_methods())
def test_order_never_exceeds_the_order_on_the_oscillator(method: RungeKutta) -> None:
    assert 1 <= order(method).order <= local_error(one_step_matrix(method)).linear_order
