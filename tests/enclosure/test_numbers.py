"""Numbers that a right-hand side runs on: values and derivatives of every function, comparisons, refusals."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product

import mpmath
import numpy as np
import pytest
from flint import arb, arb_series, ctx

from driftproof.enclosure.evaluations import Evaluation, Refused, Replay
from driftproof.enclosure.models import TaylorModel
from driftproof.enclosure.numbers import Enclosed, series


def ball(x, *partials, evaluation=None):
    return Enclosed(evaluation or Evaluation(), x, tuple(map(arb, partials)) or None)


FUNCTIONS = {
    **dict.fromkeys(("sin", "cos", "tan", "exp", "log", "sqrt", "arctan", "arcsin", "arccos", "sinh", "cosh"), 0.3),
    **dict.fromkeys(("tanh", "expm1", "log1p", "log2", "log10", "cbrt", "radians", "degrees", "square"), 0.4),
    **{"reciprocal": 0.7, "absolute": -0.7, "negative": 0.2, "deg2rad": 0.3, "rad2deg": 0.3},
}


@pytest.mark.parametrize(("name", "x"), [*FUNCTIONS.items(), ("cbrt", -0.4), ("absolute", 0.7)])
def test_value_and_derivative_are_those_of_the_function(name, x):
    function = getattr(np, name)
    found = function(ball(arb(x), 1))
    # A double's function and a central difference at 2^-16: 1e-15 and (2^-16)^2 times a third derivative below 100.
    assert abs(float(found.value.mid()) - function(x)) < 1e-14 * (1 + abs(function(x)))
    slope = (function(x + 2**-16) - function(x - 2**-16)) / 2**-15
    assert abs(float(found.partials[0].mid()) - slope) < 1e-7 * (1 + abs(slope))
    assert found.value.rad() < 1e-12


@pytest.mark.parametrize("name", FUNCTIONS)
def test_series_are_those_of_the_values_near_by(name):
    decided, small = [FUNCTIONS[name] > 0], arb(2) ** -8
    x = arb(FUNCTIONS[name])
    along = getattr(np, name)(series(Replay(outcomes=decided), [x, arb(1)], 10)).value
    near = getattr(np, name)(ball(x + small, evaluation=Replay(outcomes=decided))).value
    total = sum((arb_series(along)[k] * small**k for k in range(10)), arb(0))
    assert abs(total - near) < 1e-12


@pytest.mark.parametrize("power", [0, 1, 3, -2, 0.5, -1.5, Fraction(1, 3), np.float64(2.0), 1 / 3])
def test_power_and_its_derivative(power):
    found = ball(arb(0.7), 1) ** power
    exponent = float(power)
    assert abs(float(found.value.mid()) - 0.7**exponent) < 1e-14
    slope = exponent * 0.7 ** (exponent - 1)
    assert abs(float((found.partials or (arb(0),))[0].mid()) - slope) < 1e-14


def test_powers_by_halves_are_of_square_roots():
    assert [(ball(arb(4)) ** power).value for power in (0.5, 1.5, -1.5)] == [2, 8, 0.125]


def test_whole_power_of_a_series_that_may_be_zero_is_finite():
    found = series(Evaluation(), [arb(0, 0.5), arb(1)], 5) ** 40
    assert all(arb_series(found.value)[k].is_finite() for k in range(5))
    assert (ball(arb(0, 1), 1) ** 40).value.is_finite()
    assert all(x.is_finite() for x in (ball(arb(0, 1), 1) ** 2).partials)


def test_angles_and_hypotenuse():
    for y, x in product((0.5, 2.0, -0.5, -2.0), repeat=2):
        evaluation = Evaluation()
        up, right = ball(arb(y), 1, 0, evaluation=evaluation), ball(arb(x), 0, 1, evaluation=evaluation)
        assert abs(float(np.arctan2(up, right).value.mid()) - math.atan2(y, x)) < 1e-14
        assert abs(float(np.hypot(up, right).value.mid()) - math.hypot(y, x)) < 1e-14


def test_exprel_is_enclosed_at_0_around_it_and_where_it_is_a_quotient():
    """(exp x - 1)/x and its derivative: 1 and 1/2 at 0; series of it are those of the values near by."""
    special = pytest.importorskip("scipy.special")
    exact = lambda x: mpmath.expm1(x) / x if x else mpmath.mpf(1)
    slope = lambda x: (mpmath.exp(x) - exact(x)) / x if x else mpmath.mpf(1) / 2
    with mpmath.workdps(40), ctx.workprec(100):
        for middle, radius in product((-3, -1, 0, 0.5, 1, 40), (0, 0.25, 2)):
            found = special.exprel(Enclosed(Evaluation(), arb(middle, radius), (arb(1),)))
            for x in (middle - radius, middle, middle + radius):
                assert found.value.overlaps(arb(mpmath.nstr(exact(x), 38), 1e-30))
                assert found.partials[0].overlaps(arb(mpmath.nstr(slope(x), 38), 1e-30))
            assert radius or abs(found.partials[0] - arb(mpmath.nstr(slope(middle), 38))) < 1e-10
            assert radius or found.value.rad() < 1e-10
        with pytest.raises(Refused, match="wide range"):
            special.exprel(Enclosed(Evaluation(), arb(0, 1000)))
        cap, ctx.cap = ctx.cap, 8
        for middle in (0, 0.75, 2):
            series_of = special.exprel(series(Evaluation(), [arb(middle), arb(1)], 8)).value
            at = sum((arb(series_of[k]) * arb("1e-3") ** k for k in range(8)), arb(0))
            assert abs(at - arb(mpmath.nstr(exact(middle + mpmath.mpf("1e-3")), 38))) < 1e-27
        ctx.cap = cap


def test_function_is_refused_where_it_is_not_analytic():
    with pytest.raises(Refused, match="f takes sqrt of a number where sqrt may not be analytic"):
        np.sqrt(Enclosed(Evaluation(), TaylorModel([arb(-1), arb(1)], 5)))
    with pytest.raises(Refused, match="f divides by a number that may be 0"):
        np.reciprocal(series(Evaluation(), [arb(0), arb(1)], 5))


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
