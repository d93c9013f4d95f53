"""The order of what was read: that of the method for every explicit one, lower where a digit is wrong, and why."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof.blackbox.matching.match import match_tableau
from driftproof.blackbox.matching.read_order import ReadOrder, read_order
from driftproof.blackbox.probes.force import read_forces
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.rounding.formats import BINARY64
from driftproof.symbolic.trees.order_conditions import order
from driftproof.symbolic.trees.partitioned_trees import nystrom_order
from driftproof.symbolic.trees.rooted_trees import to_brackets
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.matching.readings import EXPLICIT, SPLITTINGS, TABLEAUX, TOLD


def in_field(step):
    return read_order(read_tableau(opened(step, "field")))


def on_force(step):
    return read_order(read_forces(opened(step)))


@pytest.mark.slow(keep=15)
@pytest.mark.parametrize("key", EXPLICIT)
def test_the_forces_of_a_method_give_its_order(key):
    method, found = METHODS[key], on_force(stepper(METHODS[key], float))
    assert found.order == method.claimed_order
    assert found.linear_order >= found.order
    if not method.decimal and not isinstance(method, RungeKutta):
        exact = nystrom_order(method)
        assert found.failing_tree == to_brackets(exact.failing_tree)
        assert found.residual[0] <= exact.residual <= found.residual[1]


@pytest.mark.slow(keep=8)
@pytest.mark.parametrize("key", TABLEAUX)
def test_the_slopes_of_a_method_give_its_order_and_the_tree_that_fails(key, as_before):
    method = METHODS[key]
    reading = read_tableau(opened(codes.tableau(*codes.floats(method)), "field"))
    unknown, known = read_order(reading), read_order(reading, match_tableau(reading).matches[0])
    assert unknown.order == known.order == known.untimed_order == method.claimed_order
    if key in TOLD:
        as_before(*unknown.lines, *known.lines, (unknown.linear_order, known.linear_order))
    if not method.decimal:
        exact = order(method)
        for found in (unknown, known):
            assert found.failing_tree == to_brackets(exact.failing_tree)
            assert found.residual[0] <= exact.residual <= found.residual[1]


def rk4_off(*places):
    """RK4 with so much more in some places of its row of weights, or of that of its third stage."""
    rows, weights, nodes = codes.floats(METHODS["rk4"])
    for row, place, more in places:
        (weights if row is None else rows[row])[place] += more
    return codes.tableau(rows, weights, nodes)


ORDERS = {
    "rk4": codes.rk4, "rk38": codes.rk38, "in lists": codes.rk4_in_lists, "without time": codes.rk4_without_time,
    "a weight off": rk4_off((None, 0, 1e-10)),
    "made up for": rk4_off((None, 0, 1e-10), (None, 1, -1e-10)),
    "a last bit off": rk4_off((None, 0, 2.0**-55), (2, 1, -(2.0**-54))),
    "a stopped clock": codes.rk4_on_a_stopped_clock, "on linear problems": codes.jameson,
    "low storage": codes.ssprk104_in_two_registers,
    "low storage in binary32": codes.in_precision(codes.ssprk104_in_two_registers, np.float32),
} | {f"{times} iterations": codes.midpoint_iterated(times) for times in range(4)}  # fmt: skip


@pytest.mark.parametrize("name", ORDERS)
def test_the_order_of_a_code_is_that_of_what_it_does_and_not_of_its_rounding(name, as_before):
    found = in_field(ORDERS[name])
    as_before(found, *found.lines)


def test_the_order_on_linear_problems_is_looked_for_up_to_12():
    rows = tuple(tuple(1 / (14 - i) * (j == i - 1) for j in range(13)) for i in range(13))
    found = read_order(TableauReading(rows, (*[0.0] * 12, 1.0), tuple(map(sum, rows)), BINARY64))
    assert (found.order, found.linear_order) == (2, 12)


def test_an_order_of_which_no_condition_is_seen_to_fail_says_so():
    assert ReadOrder(12, None, None, 12, 12).lines == ["order 12: no condition up to order 12 fails"]


def test_a_position_that_moves_by_half_has_order_0():
    assert on_force(codes.half_moved).lines[0] == "order 0: the condition of tree τ_q fails by -1/2"
    assert on_force(codes.velocity_verlet).order == on_force(codes.position_verlet_calling_twice).order == 2


@pytest.mark.parametrize("key", SPLITTINGS[::4])
def test_a_splitting_with_a_wrong_sub_step_loses_its_order(key, as_before):
    parts = [(kind, float(x)) for kind, x in METHODS[key].parts]
    parts[1] = (parts[1][0], parts[1][1] + 1e-9)
    found = on_force(codes.composed(parts))
    assert found.order == 0
    as_before(*found.lines, found.linear_order)


def with_a_third(x):
    rows, weights, nodes = codes.floats(METHODS["rk38"])
    rows[1][0] = nodes[1] = x
    return codes.tableau(rows, weights, nodes)


AS_SUMS = [with_a_third(0.333333333333333), codes.ssprk104_in_two_registers, codes.ssprk33_in_convex_combinations]
AS_SUMS += [codes.dopri5, with_a_third(0.3333333333333), codes.jameson, codes.rk4_on_a_stopped_clock]


@pytest.mark.parametrize("place", range(len(AS_SUMS)))
def test_the_order_of_what_sums_make_is_what_it_was(place, as_before):
    reading = read_tableau(opened(AS_SUMS[place], "field"))
    matches = [None, *match_tableau(reading).matches]
    found = [read_order(reading, match) for match in matches]
    widths = [None if each.residual is None else f"{float(each.residual[1] - each.residual[0]):.6g}" for each in found]
    as_before(*(line for each in found for line in each.lines), *widths, *(match and match.summed for match in matches))
