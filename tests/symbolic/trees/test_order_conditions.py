"""Order conditions of Runge-Kutta methods: exact, against sums written out, with every coefficient's control."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction as Q
from itertools import chain, product
from math import isqrt
from typing import Any

import pytest
from hypothesis import given

from driftproof import strategies
from driftproof.methods.numbers.number_field import Exact, square_root
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.trees.order_conditions import (
    elementary_weight,
    order,
    order_of,
    order_to_tolerance,
    principal_error,
    runge_kutta_conditions,
    simplifying_assumptions,
)
from driftproof.symbolic.trees.rooted_trees import Tree, density, rooted_trees, vertices
from tests.changes import moved, rows
from tests.looping import exactly, some
from tests.methods.tables.entries import entry
from tests.symbolic.trees.residuals import residuals
from tests.witnesses.trees import symmetry

RK4 = entry("rk4")


def weight_written_out(method: RungeKutta, tree: Tree) -> Exact:
    """Φ(t) as its definition: Σ over a stage for every vertex of b_root Π a_(parent)(vertex), nothing shared."""
    parents: list[int] = []

    def number(branches: Tree, parent: int) -> None:
        parents.append(parent)
        me = len(parents) - 1
        for branch in branches:
            number(branch, me)

    number(tree, -1)
    total: Exact = Q(0)
    for stages in product(range(method.stages), repeat=len(parents)):
        term: Exact = method.b[stages[0]]
        for vertex in range(1, len(parents)):
            term = term * method.a[stages[parents[vertex]]][stages[vertex]]
        total = total + term
    return total


@pytest.mark.parametrize("key", ["rk38", "gill4", "radau_iia3", "crouzeix3"])
def test_elementary_weights_are_the_sums_of_their_definition(key: str) -> None:
    method = entry(key)
    for tree in exactly(17, (tree for n in range(1, 6) for tree in rooted_trees(n))):
        assert elementary_weight(method, tree) == weight_written_out(method, tree)


def changed_in_one_place(method: Any, amount: Q) -> Iterator[RungeKutta]:
    """The methods with one coefficient of A's or b's pattern changed, c following A."""
    for place in chain.from_iterable(rows(method)):
        if place[0] != "b_embedded":
            off = moved(method, place, amount)
            yield replace(off, c=tuple(sum(r, Q(0)) for r in off.a))


@pytest.mark.parametrize("amount", [Q(1, 24), Q(1, 10**14), Q(1, 10**30)])
@pytest.mark.parametrize("key", ["rk4", "gill4", "gauss2", "cash_karp54"])
def test_order_notices_every_coefficient_changed(key: str, amount: Q) -> None:
    method = entry(key)
    for changed in some(changed_in_one_place(method, amount), 6):
        assert order(changed).order < method.claimed_order


def test_order_is_three_answers_that_are_not_confused() -> None:
    """Exactly 1; the residual that says why; and 4 for a user who calls 10**-12 zero, but 1 for one who does not."""
    tiny = Q(1, 10**14)
    method = replace(RK4, b=(RK4.b[0] + tiny, RK4.b[1] - tiny, *RK4.b[2:]))
    conditions = runge_kutta_conditions(method)
    assert (order(method).order, order(method).failing_tree, order(method).residual) == (1, ((),), -tiny / 2)
    assert [order_to_tolerance(conditions, Q(1, 10**k)) for k in (12, 16)] == [4, 1]
    assert order_to_tolerance(conditions, tiny / 2) == 4
    assert order_to_tolerance(conditions, tiny / 2 - Q(1, 10**40)) == 1
    assert order_to_tolerance(runge_kutta_conditions(RK4), 0) == order(RK4).order == 4
    by_nodes = Collocation("x", "Gauss of two stages", 0, "test", (Q(1, 6), Q(-1), Q(1)))
    assert order_to_tolerance(runge_kutta_conditions(by_nodes), 0) == 4


def test_tolerance_does_not_invent_an_order_that_so_few_stages_cannot_have() -> None:
    assert order_to_tolerance(runge_kutta_conditions(RK4), 1) == 4
    assert order_to_tolerance(runge_kutta_conditions(entry("gauss2")), 1) == 4
    assert order_to_tolerance(runge_kutta_conditions(entry("fehlberg78")), 1, limit=6) == 6


def test_algebraic_residuals_are_exact_and_compared_exactly() -> None:
    root = square_root(2)
    method = replace(RK4, b=(RK4.b[0] + root / 10**20, *RK4.b[1:]))
    assert (order(method).order, order(method).residual) == (0, root / 10**20)
    conditions = runge_kutta_conditions(method)
    assert order_to_tolerance(conditions, Q(isqrt(2 * 10**40) + 1, 10**40)) == 4
    assert order_to_tolerance(conditions, Q(isqrt(2 * 10**40), 10**40)) == 0


def test_order_uses_stages_alone_and_conditions_are_asked_in_any_order() -> None:
    conditions = runge_kutta_conditions(RK4)
    late = residuals(conditions, 5)
    assert residuals(conditions, 3) == tuple((tree, 0) for tree in rooted_trees(3))
    assert late == residuals(runge_kutta_conditions(RK4), 5)
    assert order_of(conditions) == order(RK4)


@pytest.mark.parametrize(
    ("key", "norm"), [("rk4", "0.0145"), ("dormand_prince54", "0.000399"), ("cash_karp54", "0.000948")]
)
def test_principal_error_norm_is_the_published_one_to_three_figures(key: str, norm: str) -> None:
    squared = principal_error(runge_kutta_conditions(entry(key)), 0).squared_norm
    last = Q(1, 10 ** (len(norm) - 2))
    assert (Q(norm) - last / 2) ** 2 < squared < (Q(norm) + last / 2) ** 2


@pytest.mark.parametrize("key", ["rk4", "gill4", "radau_iia2"])
def test_principal_error_is_residual_over_symmetry(key: str) -> None:
    method = entry(key)
    error = principal_error(runge_kutta_conditions(method), 0)
    assert error.vertices == method.claimed_order + 1
    assert [tree for tree, _ in error.coefficients] == list(rooted_trees(error.vertices))
    for tree, x in error.coefficients:
        assert x * symmetry(tree) == weight_written_out(method, tree) - Q(1, density(tree))
    total: Exact = Q(0)
    for _, x in error.coefficients:
        total = total + x * x
    assert (total, total != 0) == (error.squared_norm, True)


# hairer-norsett-wanner-1993, II.7 and hairer-wanner-1996, IV.5: B, C, D and stage order of the classical families.
ASSUMPTIONS = {
    "gauss2": (4, 2, 2, 2), "gauss3": (6, 3, 3, 3), "radau_ia3": (5, 2, 3, 2), "radau_iia3": (5, 3, 2, 3),
    "lobatto_iiia4": (6, 4, 2, 4), "lobatto_iiib4": (6, 2, 4, 2), "lobatto_iiic4": (6, 3, 3, 3), "rk4": (4, 1, 1, 1),
    "forward_euler": (1, None, 0, 1),
}  # fmt: skip


@pytest.mark.parametrize("key", ASSUMPTIONS)
def test_simplifying_assumptions_hold_as_far_as_in_print_and_no_further(key: str) -> None:
    method = entry(key)
    found = simplifying_assumptions(method)
    assert (found.b, found.c, found.d, found.stage_order) == ASSUMPTIONS[key]
    for p in range(1, found.b + 2):
        total: Exact = Q(0)
        for b, c in zip(method.b, method.c, strict=True):
            total = total + (b if p == 1 else b * c ** (p - 1))
        assert (total == Q(1, p)) == (p <= found.b)


def test_simplifying_assumptions_notice_every_node_changed() -> None:
    method = entry("radau_iia3")
    for i in range(3):
        off = moved(method, ("c", i), Q(1, 10**30))
        assert simplifying_assumptions(off).c == 0
        assert simplifying_assumptions(off).b < 5


@given(strategies.runge_kutta_methods())
def test_order_of_any_method_is_where_its_conditions_written_out_first_fail(method: RungeKutta) -> None:
    fact = order(method)
    assert vertices(fact.failing_tree) == fact.order + 1
    assert weight_written_out(method, fact.failing_tree) - Q(1, density(fact.failing_tree)) == fact.residual != 0
    for tree in (tree for n in range(1, min(fact.order, 3) + 1) for tree in rooted_trees(n)):
        assert weight_written_out(method, tree) == Q(1, density(tree))
