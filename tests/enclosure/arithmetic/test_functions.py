"""Functions of enclosed numbers: values, derivatives and series, and where they are refused."""

from __future__ import annotations

from itertools import product

import mpmath
import numpy as np
import pytest
from flint import arb, arb_series, ctx

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused, Replay
from driftproof.enclosure.arithmetic.functions import quotient_of
from driftproof.enclosure.arithmetic.models import TaylorModel
from driftproof.enclosure.arithmetic.numbers import Enclosed, series
from tests.enclosure.arithmetic.test_numbers import ball

FUNCTIONS = {
    **dict.fromkeys(("sin", "cos", "tan", "exp", "log", "sqrt", "arctan", "arcsin", "arccos", "sinh", "cosh"), 0.3),
    **dict.fromkeys(("tanh", "expm1", "log1p", "log2", "log10", "cbrt", "radians", "degrees", "square"), 0.4),
    **{"erf": 0.3, "erfc": 0.3, "reciprocal": 0.7, "absolute": -0.7, "negative": 0.2, "deg2rad": 0.3, "rad2deg": 0.3},
    "exprel": 0.3,
}


def of(name):
    """The function of NumPy or SciPy."""
    return getattr(np, name, None) or getattr(pytest.importorskip("scipy.special"), name)


@pytest.mark.parametrize(("name", "x"), [*FUNCTIONS.items(), ("cbrt", -0.4), ("absolute", 0.7)])
def test_value_and_derivative_are_those_of_the_function(name, x):
    function = of(name)
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
    along = of(name)(series(Replay(outcomes=decided), [x, arb(1)], 10)).value
    near = of(name)(ball(x + small, evaluation=Replay(outcomes=decided))).value
    total = sum((arb_series(along)[k] * small**k for k in range(10)), arb(0))
    assert abs(total - near) < 1e-12


def test_whole_power_of_a_series_that_may_be_zero_is_finite():
    found = series(Evaluation(), [arb(0, 0.5), arb(1)], 5) ** 40
    assert all(arb_series(found.value)[k].is_finite() for k in range(5))
    assert (ball(arb(0, 1), 1) ** 40).value.is_finite()
    assert all(x.is_finite() for x in (ball(arb(0, 1), 1) ** 2).partials.values())


QUOTIENTS = {
    "exprel": (
        lambda x: mpmath.expm1(x) / x if x else mpmath.mpf(1),
        lambda x: (x * mpmath.exp(x) - mpmath.expm1(x)) / x**2 if x else mpmath.mpf(1) / 2,
    ),
    "sinc": (
        lambda x: mpmath.sin(x) / x if x else mpmath.mpf(1),
        lambda x: (x * mpmath.cos(x) - mpmath.sin(x)) / x**2 if x else mpmath.mpf(0),
    ),
}


@pytest.mark.parametrize("name", QUOTIENTS)
def test_quotients_are_enclosed_at_0_around_it_and_where_they_are_quotients(name):
    """Their series are those of the values near by."""
    exact, slope = QUOTIENTS[name]
    with mpmath.workdps(40), ctx.workprec(100):
        for middle, radius in product((-3, -1, 0, 0.5, 1, 40), (0, 0.25, 2)):
            found, rate = (quotient_of(arb(middle, radius), name, slope=each) for each in (False, True))
            for x in (middle - radius, middle, middle + radius):
                assert found.overlaps(arb(mpmath.nstr(exact(x), 38), 1e-30))
                assert rate.overlaps(arb(mpmath.nstr(slope(x), 38), 1e-30))
            assert radius or abs(rate - arb(mpmath.nstr(slope(middle), 38))) < 1e-10
            assert radius or found.rad() < 1e-10
        with pytest.raises(Refused, match="wide range"):
            quotient_of(arb(0, 1000), name)
        cap, ctx.cap = ctx.cap, 8
        for middle in (0, 0.75, 2):
            series_of = quotient_of(series(Evaluation(), [arb(middle), arb(1)], 8).value, name)
            at = sum((arb(series_of[k]) * arb("1e-3") ** k for k in range(8)), arb(0))
            assert abs(at - arb(mpmath.nstr(exact(middle + mpmath.mpf("1e-3")), 38))) < 1e-27
        ctx.cap = cap


def test_function_is_refused_where_it_is_not_analytic():
    with pytest.raises(Refused, match="f takes sqrt of a number where sqrt may not be analytic"):
        np.sqrt(Enclosed(Evaluation(), TaylorModel([arb(-1), arb(1)], 5)))
    with pytest.raises(Refused, match="f divides by a number that may be 0"):
        np.reciprocal(series(Evaluation(), [arb(0), arb(1)], 5))
