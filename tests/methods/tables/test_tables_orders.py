"""The order conditions that are written apart: how many there are, and that slack excuses no wrong digit."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.symbolic.trees.rooted_trees import rooted_trees
from tests.methods.tables.entries import by_key, entry, of_type
from tests.methods.tables.tables_orders import (
    UNITS,
    as_nystrom,
    force_tree_residuals,
    force_trees,
    hold,
    meets_claim,
    tree_residuals,
    word_residuals,
)


def test_there_are_as_many_conditions_as_there_are_trees() -> None:
    """Rooted trees, and special Nyström trees, whose root is a force (hairer-norsett-wanner-1993, II.2 and II.14)."""
    assert [len(rooted_trees(p)) for p in range(1, 7)] == [1, 1, 2, 4, 9, 20]
    assert [len(force_trees(p)) for p in range(8)] == [1, 1, 2, 3, 6, 10, 20, 36]


@pytest.mark.parametrize("method", [m for m in of_type(Splitting) if not m.decimal], ids=by_key)
def test_words_and_force_trees_agree_that_all_conditions_hold(method: Splitting) -> None:
    orders = range(1, method.claimed_order + 1)
    assert all(residual == 0 for p in orders for _, residual, _ in force_tree_residuals(method, p))
    assert not hold(word_residuals(method, method.claimed_order + 1))


@pytest.mark.parametrize("method", [m for m in of_type(Splitting) if m.quadratic_kinetic], ids=by_key)
def test_order_claimed_for_quadratic_kinetic_energy_holds_for_no_other(method: Splitting) -> None:
    # A symmetric one of order 4 meets the conditions of order 3 only, which both classes share.
    assert meets_claim(replace(method, quadratic_kinetic=False)) is (method.key == "blanes_moan_rkn4")


def test_order_of_rk4_is_lost_by_a_weight_that_no_float_can_tell() -> None:
    rk4 = entry("rk4")
    assert isinstance(rk4, RungeKutta)
    for tiny in (Q(1, 10**14), Q(1, 10**30)):
        off = replace(rk4, b=(rk4.b[0] + tiny, *rk4.b[1:]))
        assert [x for _, x, _ in tree_residuals(off, 1)] == [tiny]


def test_slack_is_no_excuse_for_a_wrong_digit() -> None:
    """One unit in the sixth digit of one weight breaks every rounded table; so does a digit copied wrongly."""
    for key in ("tsitouras54", "dop853", "prince_dormand87"):
        method = entry(key)
        wrong = replace(method, b=(method.b[0] + Q(1, 10**6), *method.b[1:]))
        assert not hold(tree_residuals(wrong, 1, UNITS[key]))
    right, wrong_digit = Q("0.7563200005156682911"), Q("0.7562300005156682911")
    parts = tuple((kind, wrong_digit if c == right else c) for kind, c in entry("mclachlan_atela4").parts)
    swapped = replace(entry("mclachlan_atela4"), parts=parts)
    assert swapped != entry("mclachlan_atela4")
    assert not hold(force_tree_residuals(swapped, 1, UNITS["mclachlan_atela4"]))


def test_splitting_as_nystrom_method_keeps_the_sums() -> None:
    table = as_nystrom(entry("ruth3"))
    assert (sum(table.b_velocity), sum(table.b_position)) == (1, Q(1, 2))
    assert table.inconsistencies() != {}  # its inner stages are of order 1 only
