"""Every entry of the tables has the order its source claims, and not the next: exactly, or to the digits printed."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from fractions import Fraction as Q
from math import factorial
from typing import Any

import pytest

from methods.catalogue import METHODS
from methods.polynomials import product
from methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from symbolic.trees.rooted import rooted_trees
from tests.tables_orders import (
    as_nystrom,
    by_key,
    entry,
    force_tree_residuals,
    force_trees,
    of_type,
    quadrature_residual,
    stability_function,
    stability_series,
    tree_residuals,
    word_residuals,
)

PAIRS = [method for method in of_type(RungeKutta) if method.b_embedded is not None]
EXACT_SPLITTINGS = [method for method in of_type(Splitting) if not method.decimal]

# How far each non-zero coefficient may be from the one that was rounded.
# Fractions: a convergent p/q of a number is within 1/q² of it, and q > 1.5e8 in every rounded one of this table.
UNITS = {"prince_dormand87": Q(1, 150_000_000**2)}
# 15 and more digits, the largest entry 12.9; the first column is what is left of c after at most four of them.
UNITS["tsitouras54"] = 5 * Q("0.5e-14")
# 30 digits, the largest entry 43.5; the embedded rows are differences of two such.
UNITS["dop853"] = UNITS["dop853_third"] = 2 * Q("0.5e-28")
# As recomputed in test_tables_facts.py, Table 1 is right to within 2e-14, Table 2 to 1.1e-12, not to all 15 digits;
# the middle weight is 1 minus twice all others.
UNITS |= dict.fromkeys(["yoshida6", "yoshida6_position_first", "yoshida6_b", "yoshida6_c"], 2 * 3 * Q("2e-14"))
UNITS |= dict.fromkeys(["yoshida8", "yoshida8_position_first", "yoshida8_a"], 2 * 7 * Q("1.1e-12"))
UNITS |= dict.fromkeys(["kahan_li6", "kahan_li8", "suzuki_umeno8"], Q("1e-26"))
UNITS |= dict.fromkeys(["mclachlan_atela3", "mclachlan_atela4", "mclachlan_atela5"], Q("1e-18"))
# 15 decimal places, the middle one 1 minus twice all (7 at most) others.
UNITS |= {method.key: 2 * 7 * Q("0.5e-15") for method in of_type(Splitting) if method.key[:7] in ("pefrl", "blanes_")}
UNITS["vefrl"] = 2 * 2 * Q("0.5e-14")


def test_every_rounded_table_has_its_unit_and_no_other() -> None:
    rounded = {
        method.key for family in (RungeKutta, Splitting, Nystrom) for method in of_type(family) if method.decimal
    }
    assert rounded == set(UNITS)


def hold(residuals: Iterable[tuple[str, Any, Q]]) -> bool:
    """All conditions hold, exactly where the table is not rounded, else up to what rounding can do."""
    return all(residual == 0 or -slack <= residual <= slack for _, residual, slack in residuals)


@pytest.mark.parametrize("method", of_type(RungeKutta), ids=by_key)
def test_runge_kutta_method_has_the_claimed_order_and_not_the_next(method: RungeKutta) -> None:
    unit = UNITS.get(method.key, Q(0))
    assert all(hold(tree_residuals(method, p, unit)) for p in range(1, method.claimed_order + 1))
    assert not hold(tree_residuals(method, method.claimed_order + 1, unit))


@pytest.mark.parametrize("method", PAIRS, ids=by_key)
def test_embedded_row_has_the_claimed_order_and_not_the_next(method: RungeKutta) -> None:
    unit, order = UNITS.get(method.key, Q(0)), method.embedded_order
    assert order is not None
    assert all(hold(tree_residuals(method, p, unit, embedded=True)) for p in range(1, order + 1))
    assert not hold(tree_residuals(method, order + 1, unit, embedded=True))


@pytest.mark.parametrize("method", of_type(RungeKutta), ids=by_key)
def test_trees_notice_a_changed_coefficient(method: RungeKutta) -> None:
    """In a row with a weight it moves Σ bᵢ aᵢⱼ, the condition of order 2; a weight moves Σ bᵢ, the one of order 1."""
    unit = UNITS.get(method.key, Q(0))
    change = 10**6 * unit or Q(1, 10**30)
    i = max((i for i in range(method.stages) if method.b[i]), key=lambda i: sum(x != 0 for x in method.a[i]))
    rows = [list(given) for given in method.a]
    rows[i][0] += change
    assert method.claimed_order < 2 or not hold(tree_residuals(dataclasses.replace(method, a=rows), 2, unit))
    weights = (method.b[0] + change, *method.b[1:])
    assert not hold(tree_residuals(dataclasses.replace(method, b=weights), 1, unit))


@pytest.mark.parametrize("method", of_type(RungeKutta), ids=by_key)
def test_stability_function_agrees_with_exp_up_to_the_claimed_order(method: RungeKutta) -> None:
    """R(z) by powers of A, where it may well agree further: order on linear problems is not order."""
    tolerance = Q(1, 10**12) if method.key in UNITS else Q(0)
    series = stability_series(method, method.claimed_order)
    assert all(abs(x - Q(1, factorial(k))) <= tolerance for k, x in enumerate(series) if x != Q(1, factorial(k)))


@pytest.mark.parametrize("method", of_type(Splitting), ids=by_key)
def test_splitting_has_the_claimed_order_and_not_the_next(method: Splitting) -> None:
    unit, order = UNITS.get(method.key, Q(0)), method.claimed_order
    conditions = force_tree_residuals if method.quadratic_kinetic else word_residuals
    assert all(hold(conditions(method, p, unit)) for p in range(1, order + 1))
    assert not hold(force_tree_residuals(method, order + 1, unit))


@pytest.mark.parametrize("method", [m for m in of_type(Splitting) if m.quadratic_kinetic], ids=by_key)
def test_order_claimed_for_quadratic_kinetic_energy_holds_for_no_other(method: Splitting) -> None:
    holds = all(hold(word_residuals(method, p, UNITS[method.key])) for p in range(1, method.claimed_order + 1))
    # A symmetric one of order 4 meets the conditions of order 3 only, which both classes share.
    assert holds is (method.key == "blanes_moan_rkn4")


@pytest.mark.parametrize("method", EXACT_SPLITTINGS, ids=by_key)
def test_words_and_force_trees_agree_that_all_conditions_hold(method: Splitting) -> None:
    orders = range(1, method.claimed_order + 1)
    assert all(residual == 0 for p in orders for _, residual, _ in force_tree_residuals(method, p))
    assert not hold(word_residuals(method, method.claimed_order + 1))


def kicks(method: Splitting) -> int:
    return sum(kind == "kick" for kind, _ in method.parts)


@pytest.mark.parametrize("method", [m for m in of_type(Splitting) if kicks(m) > 1], ids=by_key)
def test_words_notice_a_coefficient_that_is_changed_while_the_sums_stay(method: Splitting) -> None:
    unit = UNITS.get(method.key, Q(0))
    change = 10**6 * unit or Q(1, 10**30)
    parts = list(method.parts)
    first, second = [i for i, (kind, _) in enumerate(parts) if kind == "kick"][:2]
    parts[first] = ("kick", parts[first][1] + change)
    parts[second] = ("kick", parts[second][1] - change)
    changed = dataclasses.replace(method, parts=tuple(parts))
    assert hold(word_residuals(changed, 1, unit))
    assert not hold(word_residuals(changed, 2, unit))


@pytest.mark.parametrize("method", [m for m in of_type(Splitting) if m.decimal], ids=by_key)
def test_conditions_of_a_rounded_table_hold_nearly_and_not_exactly(method: Splitting) -> None:
    conditions = force_tree_residuals if method.quadratic_kinetic else word_residuals
    residuals = [x for p in range(1, method.claimed_order + 1) for _, x, _ in conditions(method, p)]
    assert any(residuals)


@pytest.mark.parametrize("method", [m for m in of_type(RungeKutta) if m.decimal], ids=by_key)
def test_order_of_a_rounded_pair_is_zero_when_taken_exactly(method: RungeKutta) -> None:
    assert all(residual != 0 for _, residual, _ in tree_residuals(method, 1))
    assert all(residual != 0 for _, residual, _ in tree_residuals(method, 1, embedded=True))


@pytest.mark.parametrize("method", of_type(Nystrom), ids=by_key)
def test_nystrom_method_has_the_claimed_order_and_not_the_next(method: Nystrom) -> None:
    assert all(hold(force_tree_residuals(method, p)) for p in range(1, method.claimed_order + 1))
    assert not hold(force_tree_residuals(method, method.claimed_order + 1))


@pytest.mark.parametrize("name", ["a", "b_position", "b_velocity", "c"])
@pytest.mark.parametrize("method", of_type(Nystrom), ids=by_key)
def test_force_trees_notice_a_changed_coefficient(method: Nystrom, name: str) -> None:
    tiny, values = Q(1, 10**30), [list(x) if name == "a" else x for x in getattr(method, name)]
    if name == "a":
        values[-1][-2] += tiny
    else:
        place = next(i for i, x in enumerate(values) if x)
        values[place] += tiny
    changed = dataclasses.replace(method, **{name: values})
    assert not all(hold(force_tree_residuals(changed, p)) for p in range(1, method.claimed_order + 1))


@pytest.mark.parametrize("method", of_type(Collocation), ids=by_key)
def test_collocation_method_has_the_claimed_order_and_not_the_next(method: Collocation) -> None:
    """The order is that of the quadrature: M is orthogonal to the powers below p - s, not to the next one."""
    beyond = method.claimed_order - method.stages
    assert all(quadrature_residual(method, power) == 0 for power in range(beyond))
    assert quadrature_residual(method, beyond) != 0


@pytest.mark.parametrize("method", of_type(Collocation), ids=by_key)
def test_quadrature_notices_a_changed_node_polynomial(method: Collocation) -> None:
    moved = tuple(x + Q(1, 10**40) if k == 0 else x for k, x in enumerate(method.node_polynomial))
    assert quadrature_residual(dataclasses.replace(method, node_polynomial=moved), 0) != 0


@pytest.mark.parametrize("method", of_type(Collocation), ids=by_key)
def test_stability_function_of_collocation_agrees_with_exp_to_the_order_exactly(method: Collocation) -> None:
    above, below = stability_function(method)
    exponential = [Q(1, factorial(k)) for k in range(method.claimed_order + 2)]
    shifted = product(below, exponential)
    difference = [(above[k] if k < len(above) else Q(0)) - shifted[k] for k in range(method.claimed_order + 2)]
    assert difference[:-1] == [Q(0)] * (method.claimed_order + 1)
    assert difference[-1] != 0


def test_there_are_as_many_conditions_as_there_are_trees() -> None:
    """Rooted trees, and special Nyström trees, whose root is a force (hairer-norsett-wanner-1993, II.2 and II.14)."""
    assert [len(rooted_trees(p)) for p in range(1, 7)] == [1, 1, 2, 4, 9, 20]
    assert [len(force_trees(p)) for p in range(8)] == [1, 1, 2, 3, 6, 10, 20, 36]


def test_order_of_rk4_is_lost_by_a_weight_that_no_float_can_tell() -> None:
    rk4 = METHODS["rk4"]
    assert isinstance(rk4, RungeKutta)
    assert all(hold(tree_residuals(rk4, p)) for p in range(1, 5))
    for tiny in (Q(1, 10**14), Q(1, 10**30)):
        off = dataclasses.replace(rk4, b=(rk4.b[0] + tiny, *rk4.b[1:]))
        assert [x for _, x, _ in tree_residuals(off, 1)] == [tiny]


def test_slack_is_no_excuse_for_a_wrong_digit() -> None:
    """One unit in the sixth digit of one weight breaks every rounded table; so does a digit copied wrongly."""
    for key in ("tsitouras54", "dop853", "prince_dormand87"):
        method = entry(key)
        wrong = dataclasses.replace(method, b=(method.b[0] + Q(1, 10**6), *method.b[1:]))
        assert not hold(tree_residuals(wrong, 1, UNITS[key]))
    right, wrong_digit = Q("0.7563200005156682911"), Q("0.7562300005156682911")
    parts = tuple((kind, wrong_digit if c == right else c) for kind, c in entry("mclachlan_atela4").parts)
    swapped = dataclasses.replace(entry("mclachlan_atela4"), parts=parts)
    assert swapped != entry("mclachlan_atela4")
    assert not hold(force_tree_residuals(swapped, 1, UNITS["mclachlan_atela4"]))


def test_splitting_as_nystrom_method_keeps_the_sums() -> None:
    table = as_nystrom(entry("ruth3"))
    assert (sum(table.b_velocity), sum(table.b_position)) == (1, Q(1, 2))
    assert table.inconsistencies() != {}  # its inner stages are of order 1 only
