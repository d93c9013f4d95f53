"""Numbers that a right-hand side runs on: values and derivatives of every function, comparisons, refusals."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from flint import arb

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed


def ball(x, *partials, evaluation=None):
    return Enclosed(evaluation or Evaluation(), x, dict(enumerate(map(arb, partials))))


@pytest.mark.parametrize("power", [0, 1, 3, -2, 0.5, -1.5, Fraction(1, 3), np.float64(2.0), 1 / 3])
def test_power_and_its_derivative(power):
    found = ball(arb(0.7), 1) ** power
    exponent = float(power)
    assert abs(float(found.value.mid()) - 0.7**exponent) < 1e-14
    slope = exponent * 0.7 ** (exponent - 1)
    assert abs(float((found.partials or {0: arb(0)})[0].mid()) - slope) < 1e-14


def test_powers_by_halves_are_of_square_roots():
    assert [(ball(arb(4)) ** power).value for power in (0.5, 1.5, -1.5)] == [2, 8, 0.125]


def test_angles_and_hypotenuse():
    for y, x in product((0.5, 2.0, -0.5, -2.0), repeat=2):
        evaluation = Evaluation()
        up, right = ball(arb(y), 1, 0, evaluation=evaluation), ball(arb(x), 0, 1, evaluation=evaluation)
        assert abs(float(np.arctan2(up, right).value.mid()) - math.atan2(y, x)) < 1e-14
        assert abs(float(np.hypot(up, right).value.mid()) - math.hypot(y, x)) < 1e-14


@pytest.mark.parametrize("turned", [float, complex, lambda x: [1, 2][x]])
def test_number_does_not_become_a_float(turned):
    with pytest.raises(Refused, match="converts a number to a float"):
        turned(ball(arb(1)))


def test_zero_has_the_sign_plus():
    assert [np.copysign(ball(arb(x)), 0).value for x in (-2, 2)] == [2, 2]


def test_truth_values_of_comparisons_are_those_of_components():
    small, large, three = ball(arb(1)), ball(arb(2)), np.array([1.0, 2.0])
    for x, y in ((small, large), three):
        assert (x < y) + (y > x) == 1
        assert [~(x < y), ~(x >= y), (x == y) | (x <= y)] == [False, True, True]


def test_functions_that_are_refused_are_not_caught_as_other_errors():
    for function in (np.spacing, np.arcsinh):
        with pytest.raises(Refused, match=f"f uses {function.__name__}, which has no enclosure"):
            function(ball(arb(1)))


OF_TWO = {
    "fmod": math.fmod,
    "copysign": math.copysign,
    "remainder": lambda x, y: x % y,
    "floor_divide": lambda x, y: x // y,
}


@pytest.mark.parametrize("name", OF_TWO)
@pytest.mark.parametrize(("x", "y"), [(5.5, 2), (-5.5, 2), (5.5, -2), (-5.5, -2.25), (0, 2)])
def test_remainders_and_signs_are_those_of_floats(name, x, y):
    for one, other in ((ball(arb(x), 1), y), (x, ball(arb(y))), (ball(arb(x)), ball(arb(y)))):
        found = getattr(np, name)(one, other)
        assert float(found.value.mid() if isinstance(found, Enclosed) else found) == OF_TWO[name](x, y)


@pytest.mark.parametrize("x", [-2.5, -1.5, -0.25, 0.5, 1.5, 2.75, 3])
def test_integers_are_those_of_floats(x):
    turned = (math.floor, math.ceil, math.trunc, int, round, np.floor, np.ceil, np.trunc, np.rint)
    assert [turn(ball(arb(x))) for turn in turned] == [turn(x) for turn in turned]
    assert [float(round(ball(arb(x)), digits)) for digits in (1, -1)] == [round(x, 1), round(x, -1)]
