"""Elementary weights of collocation from its nodes, against the same methods as tableaux, trees, and Padé's table."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as Q

import pytest

from driftproof.methods.numbers.number_field import Exact, square_root
from driftproof.methods.schemes import Collocation
from driftproof.symbolic.algebra.polynomials import exact
from driftproof.symbolic.algebra.rational_functions import taylor
from driftproof.symbolic.linear.reduced_tableau import is_symmetric, is_symplectic
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.trees.algebraic_stability import is_algebraically_stable, quadratic_matrix
from driftproof.symbolic.trees.elementary_weights import EXACT, TableauStages
from driftproof.symbolic.trees.order_conditions import (
    collocation_order,
    elementary_weight,
    order,
    order_of,
    runge_kutta_conditions,
    simplifying_assumptions,
)
from driftproof.symbolic.trees.order_in_balls import Balls
from driftproof.symbolic.trees.rooted_trees import bush
from tests.methods.tables.entries import entry
from tests.symbolic.linear.linear_examples import gauss, lobatto_iiia, nodes_method, pade, radau_iia
from tests.symbolic.trees.residuals import residuals
from tests.witnesses.trees import tall


@pytest.mark.parametrize("s", range(1, 11))
def test_gauss_has_order_twice_its_stages(s: int) -> None:
    fact = collocation_order(gauss(s).node_polynomial)
    assert (fact.order, fact.residual != 0) == (2 * s, True)


@pytest.mark.parametrize("s", range(2, 11))
def test_radau_and_lobatto_have_their_orders_and_lobatto_its_place_in_pades_table(s: int) -> None:
    assert collocation_order(radau_iia(s).node_polynomial).order == 2 * s - 1
    assert collocation_order(lobatto_iiia(s).node_polynomial).order == 2 * s - 2
    assert stability_function(lobatto_iiia(s)) == pade(s - 1, s - 1)


@pytest.mark.parametrize("s", range(1, 6))
@pytest.mark.parametrize("family", [gauss, radau_iia, lobatto_iiia])
def test_order_by_orthogonality_is_the_order_by_trees(family: Callable[[int], Collocation], s: int) -> None:
    method = family(max(s, 2) if family is lobatto_iiia else s)
    assert order(method) == order_of(runge_kutta_conditions(method))


@pytest.mark.parametrize(
    ("key", "nodes"),
    [
        ("gauss2", gauss(2)), ("gauss3", gauss(3)), ("radau_iia2", radau_iia(2)), ("radau_iia3", radau_iia(3)),
        ("lobatto_iiia3", lobatto_iiia(3)), ("lobatto_iiia4", lobatto_iiia(4)),
    ],
)  # fmt: skip
def test_nodes_polynomial_and_tableau_are_one_method(key: str, nodes: Collocation) -> None:
    tableau = entry(key)
    for n in range(1, 8):
        assert residuals(runge_kutta_conditions(nodes, Balls()), n) == residuals(runge_kutta_conditions(tableau), n)
    assert simplifying_assumptions(nodes) == simplifying_assumptions(tableau)
    assert order(nodes) == order(tableau)
    assert quadratic_matrix(nodes) == in_powers(quadratic_matrix(tableau), tableau.c)
    assert is_algebraically_stable(nodes) == is_algebraically_stable(tableau)


def in_powers(matrix: tuple[tuple[Exact, ...], ...], nodes: tuple[Exact, ...]) -> tuple[tuple[Exact, ...], ...]:
    """Vᵀ M V for the Vandermonde matrix V of the nodes."""
    s = range(len(nodes))
    return tuple(
        tuple(sum((nodes[k] ** i * matrix[k][m] * nodes[m] ** j for k in s for m in s), Q(0)) for j in s) for i in s
    )


@pytest.mark.parametrize("s", [2, 3, 4])
def test_weights_of_tall_trees_are_the_series_of_the_stability_function(s: int) -> None:
    series = taylor(stability_function(radau_iia(s)), 9)
    assert list(map(exact, series)) == [1, *(elementary_weight(radau_iia(s), tall(n)) for n in range(1, 9))]


def test_stability_function_is_in_lowest_terms() -> None:
    """M = x² - 3x + 1: (2 + z)(1 - z) over (2 - z)(1 - z), the function of the implicit midpoint rule."""
    method = nodes_method((Q(1), Q(-3), Q(1)))
    assert stability_function(method) == pade(1, 1)
    assert collocation_order(method.node_polynomial).order == 2


def test_any_nodes_give_order_s_and_those_moved_by_little_give_no_more() -> None:
    """Nodes 1/4, 1/2 and 1: M has no moments that vanish. Gauss's, one moved by 10⁻³⁰, loses all it had above s."""
    assert collocation_order((Q(-1, 8), Q(7, 8), Q(-7, 4), Q(1))).order == 3
    for k in range(3):
        moved = tuple(x + Q(1, 10**30) * (k == j) for j, x in enumerate(gauss(3).node_polynomial))
        assert order(nodes_method(moved)).order == 3 == order_of(runge_kutta_conditions(nodes_method(moved))).order
        assert order(nodes_method(moved)).failing_tree == bush(4)


@pytest.mark.parametrize("nodes", [(), (Q(1),), (Q(1, 4), Q(-1), Q(1)), (Q(0), Q(0), Q(1))])
def test_nodes_that_coincide_or_are_none_are_refused(nodes: tuple[Q, ...]) -> None:
    with pytest.raises(ValueError, match="at least one node, all distinct"):
        collocation_order(nodes)


@pytest.mark.parametrize("s", range(2, 11))
def test_structure_of_the_families_for_any_number_of_stages(s: int) -> None:
    """Gauss is symplectic and symmetric, Radau IIA algebraically stable and neither, Lobatto IIIA only symmetric."""
    found = []
    for nodes in (gauss(s), radau_iia(s), lobatto_iiia(s)):
        method = Collocation("x", "X", 0, "test", nodes.node_polynomial)
        assert is_symplectic(method) == (not any(x for row in quadratic_matrix(nodes) for x in row))
        found.append((is_symplectic(method), is_symmetric(method), is_algebraically_stable(nodes)))
    assert found == [(True, True, True), (False, False, True), (False, True, False)]


def test_conditions_of_nodes_far_apart_fail_where_their_weights_are_negative() -> None:
    """Nodes 0, 1/10 and 1/5 extrapolate: weights of both signs, and nothing algebraically stable."""
    polynomial = (Q(0), Q(1, 50), Q(-3, 10), Q(1))
    assert not is_algebraically_stable(nodes_method(polynomial))
    assert elementary_weight(nodes_method(polynomial), bush(3)) == Q(1, 3)


def test_numbers_of_two_fields_are_not_mixed() -> None:
    assert EXACT.lift(Q(1, 2)) * 2 == 1
    with pytest.raises(TypeError, match=r"between sqrt\(3\) and sqrt\(2\)"):
        TableauStages(((square_root(2),),), (square_root(3),)).weigh([square_root(2)])
