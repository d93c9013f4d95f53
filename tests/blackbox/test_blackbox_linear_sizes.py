"""The bound of a candidate is its definition's for any order of evaluation, or wider; its tally is right."""

from __future__ import annotations

from fractions import Fraction as Q
from math import exp

import pytest

from driftproof.blackbox.linear.arithmetics import BALLS, FLOATS, SIZES
from driftproof.blackbox.linear.classes import Rates, class_named
from driftproof.blackbox.linear.relatives import (
    DAMPED_EXACT,
    EXACT,
    damped_in_substeps,
    whole_methods,
    with_drag_in_the_force,
)
from driftproof.blackbox.linear.sizes import COEFFICIENT_ROUNDINGS, Sized, exponential, matrix_sizes
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.rounding.any_order import any_order_bound
from driftproof.symbolic.rounding.formats import BINARY64


@pytest.mark.parametrize("key", ["symplectic_euler", "velocity_verlet", "midpoint2", "rk4", "heun3", "nystrom4"])
@pytest.mark.parametrize("h", [0.25, 2.0])
def test_the_bound_of_a_method_is_nowhere_below_its_any_order_bound(key, h):
    sizes = [size(h) for size in matrix_sizes(METHODS[key])]
    counts = [size.roundings for size in matrix_sizes(METHODS[key])]
    allowed = [Sized(0.0, size, count).allowance(BINARY64) for size, count in zip(sizes, counts, strict=True)]
    bound = any_order_bound(METHODS[key])
    columns = bound.error_of(Q(h), Q(1), Q(0)), bound.error_of(Q(h), Q(0), Q(1))
    for mine, its in zip(allowed, (columns[0][0], columns[1][0], columns[0][1], columns[1][1]), strict=True):
        assert its <= mine


def test_a_bound_is_not_wide_for_nothing():
    allowed = matrix_sizes(METHODS["rk4"])[0](0.25)
    assert allowed < 1.05


X, Y = Sized(0.5, 0.75, count=3, additions=2), Sized(-2.0, 4.0, count=1)


@pytest.mark.parametrize(
    ("made", "value", "size", "roundings"),
    [
        (X + Y, -1.5, 4.75, 3 + 2 + 0 + 1),
        (X - Y, 2.5, 4.75, 6),
        (X * Y, -1.0, 3.0, 5 + 1 + 1),
        (X / Y, -0.25, 0.75 / 2 * 2, 7),
        (-X, -0.5, 0.75, 5),
        (exponential(X), exp(0.5), exp(0.5) * 1.75, 7),
        (X + Sized(0.0, 0.0), 0.5, 0.75, 5),
        (X * Sized(-1.0, 1.0), -0.5, 0.75, 5),
    ],
)
def test_each_operation_adds_up_sizes_and_roundings(made, value, size, roundings):
    assert (made.value, made.size, made.roundings) == (value, size, roundings)


def test_a_quotient_by_zero_has_no_bound():
    assert (X / Sized(0.0, 1.0)).size == float("inf")


def test_a_coefficient_that_is_worked_out_counts_more_than_one_that_is_1():
    assert SIZES.number(Q(1, 3)).roundings == COEFFICIENT_ROUNDINGS
    assert SIZES.number(Q(1)).roundings == SIZES.number(Q(-1)).roundings == 0


MODELS = (*whole_methods(), *with_drag_in_the_force(), *damped_in_substeps(), EXACT, DAMPED_EXACT)


def test_every_model_has_sizes_above_its_values_and_the_same_values_in_floats_and_balls():
    h, a, k, g = Q(1, 4), Q(1), Q(5, 4), Q(1, 8)
    for model in MODELS:
        in_floats, in_balls, sizes = (
            model.matrix(arithmetic, Rates(*(arithmetic.number(x) for x in (h, a, k, g))))
            for arithmetic in (FLOATS, BALLS, SIZES)
        )
        for x, ball, size in zip(in_floats, in_balls, sizes, strict=True):
            assert abs(x - float(ball.mid())) <= size.allowance(BINARY64)
            assert abs(x) <= size.size * (1 + 2.0**-40)


def test_a_class_knows_its_methods():
    assert class_named("rk38").keys[0] == "rk4"
    assert class_named("rk38") is class_named("rk4")
