"""Orders of uncertain coefficients: exact ones where nothing is uncertain, and no failure that an error may explain."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Nystrom, RungeKutta
from driftproof.symbolic.trees.order_conditions import order, order_of
from driftproof.symbolic.trees.order_in_balls import (
    Ball,
    BallNystrom,
    Balls,
    BallTableau,
    ball_order,
    linear_ball_order,
)
from driftproof.symbolic.trees.partitioned_trees import conditions_with_nodes, nystrom_order

U = Q(1, 2**53)
RATIONAL = [k for k, m in METHODS.items() if isinstance(m, RungeKutta) and m.explicit and not m.field and not m.decimal]


def row(numbers, unit):
    """Balls of relative radius `unit` around the doubles next to the numbers; around the numbers if it is 0."""
    centers = [Q(float(x)) if unit else x for x in numbers]
    return tuple(Ball(x, unit * abs(x)) if x else 0 for x in centers)


def balls(method, unit):
    return BallTableau(tuple(row(a, unit) for a in method.a), row(method.b, unit), row(method.c, unit))


@pytest.mark.parametrize("key", RATIONAL[::3])
@pytest.mark.parametrize(("unit", "width"), [(0, Q(1, 2**200)), (U, Q(1, 2**40))])
def test_numbers_and_doubles_within_a_rounding_have_the_order_of_the_method_and_a_residual_around_its_own(
    key, unit, width
):
    exact, found = order(METHODS[key]), ball_order(balls(METHODS[key], unit), 12)
    assert (found.order, found.failing_tree) == (exact.order, exact.failing_tree)
    low, high = found.residual
    assert low <= exact.residual <= high
    assert high - low < width


def test_doubles_taken_for_exact_numbers_fail_by_their_rounding():
    method = METHODS["kutta3"]
    doubles = replace(method, b=tuple(Q(float(x)) for x in method.b))
    assert order(doubles).order == 0
    assert ball_order(balls(doubles, 0), 12).order == 0
    assert ball_order(balls(doubles, U), 12).order == 3


def test_a_weight_off_by_less_than_its_radius_is_no_failure_and_one_off_by_more_is():
    method, tiny = METHODS["rk4"], Q(1, 2**40)
    off = replace(method, b=(method.b[0] + tiny, *method.b[1:]))
    assert ball_order(balls(off, tiny * 8), 12).order == 4
    found = ball_order(balls(off, tiny / 8), 12)
    assert (found.order, found.failing_tree) == (0, ())
    assert found.residual[0] <= tiny <= found.residual[1]


def test_nodes_that_are_not_the_sums_of_their_rows_fail_where_the_exact_ones_do():
    method = METHODS["rk4"]
    stopped = replace(method, c=(Q(0),) * 4)
    exact, found = order_of(conditions_with_nodes(stopped)), ball_order(balls(stopped, U), 12, timed=True)
    assert (found.order, found.failing_tree) == (exact.order, exact.failing_tree) == (1, ("y", (("t", ()),)))
    assert ball_order(balls(method, U), 12, timed=True).order == 4
    assert ball_order(balls(stopped, U), 12).order == 4


def nystrom_balls(method, unit, drift=1):
    rows = (method.c, method.b_position, method.b_velocity)
    c, b_position, b_velocity = (row(numbers, unit) for numbers in rows)
    return BallNystrom(c, tuple(row(a, unit) for a in method.a), b_position, b_velocity, Ball(Q(drift), Q(0)))


@pytest.mark.parametrize("key", [key for key, method in METHODS.items() if isinstance(method, Nystrom)])
@pytest.mark.parametrize("unit", [0, U])
def test_a_nystrom_method_has_its_order(key, unit):
    exact, found = nystrom_order(METHODS[key]), ball_order(nystrom_balls(METHODS[key], unit), 12)
    assert (found.order, found.failing_tree) == (exact.order, exact.failing_tree)
    assert found.residual[0] <= exact.residual <= found.residual[1]


def test_a_nystrom_method_that_drifts_by_half_has_order_0():
    found = ball_order(nystrom_balls(METHODS["nystrom4"], U, Q(1, 2)), 12)
    assert (found.order, found.failing_tree) == (0, ("q", ()))
    assert linear_ball_order(nystrom_balls(METHODS["nystrom4"], U, Q(1, 2)), 12) == 0
    assert linear_ball_order(nystrom_balls(METHODS["nystrom4"], U), 12) == 4


def test_the_linear_order_asks_for_trees_without_a_fork_only():
    a = ((0, 0, 0, 0), (Q(1, 4), 0, 0, 0), (0, Q(1, 3), 0, 0), (0, 0, Q(1, 2), 0))
    jameson = RungeKutta("jameson", "Jameson", 2, "x", a, (0, 0, 0, 1), (0, Q(1, 4), Q(1, 3), Q(1, 2)))
    assert ball_order(balls(jameson, U), 12).order == order(jameson).order == 2
    assert linear_ball_order(balls(jameson, U), 12) == 4
    assert [linear_ball_order(balls(METHODS["rk4"], U), limit) for limit in (3, 4, 5, 12)] == [3, 4, 4, 4]


def test_where_nothing_fails_up_to_the_limit_no_tree_is_named():
    found = ball_order(balls(METHODS["rk4"], U), 3)
    assert (found.order, found.failing_tree, found.residual) == (3, None, None)
    assert linear_ball_order(balls(METHODS["rk4"], U), 3) == 3


def test_a_ball_is_lifted_around_its_centre_and_is_no_exact_number():
    lifted = Balls().lift(Ball(Q(1, 3), Q(1, 8)))
    assert lifted.contains(Balls().lift(Q(1, 3)))
    assert not lifted.contains(Balls().lift(Q(1, 2)))
    with pytest.raises(TypeError, match="ball"):
        Balls().exact(lifted)
