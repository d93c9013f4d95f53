"""Taylor models hold what they stand for on the whole disc, sharply, and refuse poles and branch points in it."""

from __future__ import annotations

import pytest
from flint import acb, acb_poly, arb, arb_poly, ctx

from driftproof.enclosure import models
from driftproof.enclosure.models import TaylorModel
from driftproof.enclosure.numbers import Refused
from tests.enclosure.mutants import mutant

LENGTH = 12
# Made from the model, and from a complex number.
FUNCTIONS = {
    "product": (lambda x: x * x * x, lambda z: z**3),
    "quotient": (lambda x: 2 / x, lambda z: 2 / z),
    **{
        name: (lambda x, name=name: getattr(x, name)(), lambda z, name=name: getattr(z, name)())
        for name in ("sqrt", "exp", "sin", "cos", "log", "atan", "asin", "acos")
    },
}


def given(module, tail):
    """1/2 + σ/16 + σ²/32 and, with a tail, σ¹²/64 beyond the coefficients that are kept."""
    coefficients = [arb(1) / 2, arb(1) / 16, arb(1) / 32, *[arb(0)] * (LENGTH - 3)]
    return module.TaylorModel(coefficients, LENGTH, arb(tail)), acb_poly([*coefficients, tail])


def held(module, name, tail):
    """How near the function's values at twelve points of the circle come to the bound, 1 being on it."""
    ours, theirs = FUNCTIONS[name]
    model, x = given(module, tail)
    found, most = ours(model), 0.0
    for k in range(12):
        point = (acb(0, arb.pi() * k / 6)).exp()
        away = abs(theirs(x(point)) - acb_poly(found.polynomial.coeffs())(point))
        most = max(most, float((away / found.tail).abs_upper()) if found.tail > 0 else 0 if away == 0 else 1e99)
    return most


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("tail", [0, 2.0**-6])
def test_model_holds_the_function_on_the_disc_and_is_sharp(name, tail):
    with ctx.workprec(128):
        # Norms of quotients are taken several times over for angles. Cubes have no tail at all.
        assert (0.05 if tail else 0.005) < held(models, name, tail) <= 1 or (name, tail) == ("product", 0)


TAILS = {
    "product": "self.norm * other.tail + self.tail * other.norm",
    "quotient": 'a.norm * _geometric((self * a).tail, "divides by")',
    "sqrt": 'a.norm * _geometric(error * inverse.norm * inverse.norm, "takes the root of")',
    "log": '_geometric((self * (-a).exp()).tail, "takes the logarithm of")',
    "exp": "(2 * w).exp() * error / self.length + first * whole.exp() * self.tail",
    "sin": "(2 * w).exp() * error / self.length + whole.exp() * self.tail",
    "atan": '_geometric(error, "takes the angle of")',
}


@pytest.mark.parametrize("name", TAILS)
def test_tail_that_is_omitted_is_caught(name):
    with ctx.workprec(128):
        assert not held(mutant("models", (TAILS[name], "0")), name, 2.0**-6) <= 1


@pytest.mark.parametrize(
    ("function", "coefficients"),
    [
        *[("sqrt", (1, 1.25)), ("log", (1, 0, -1.25)), ("atan", (0.1, 1.25)), ("asin", (0.5, 0.75))],
        *[("acos", (-0.5, -0.75)), ("log", (-1, 0.5)), ("sqrt", (-1, 0.5))],
    ],
)
def test_branch_point_in_the_disc_is_refused(function, coefficients):
    with pytest.raises((Refused, ValueError)):
        getattr(TaylorModel(coefficients, LENGTH), function)()


def test_pole_in_the_disc_is_refused():
    with pytest.raises(Refused, match="divides by a number that may be 0 within the step"):
        _ = 1 / TaylorModel([arb(1), arb(1.25)], LENGTH)


def test_sums_and_constants():
    x = TaylorModel([arb(1), arb(2)], 2, 0.5)
    found = 3 - (x + x) * 2 + x - 1
    assert (str(found.polynomial), found.tail) == (str(arb_poly([-1, -6])), arb(2.5))
    assert (found.norm, found.coefficient(1), found.is_finite()) == (9.5, -6, True)
    assert not TaylorModel([arb("nan")], 2).is_finite()


def test_comparison_is_of_the_whole_step():
    x = TaylorModel([arb(1), arb(-0.5)], 2, 0.25)
    assert [x > 0.24, x < 1.76, x > 0.26, x < 1.74] == [True, True, False, False]
    assert x.range().contains(arb(0.75))
    assert x.range().rad() < 0.51


def test_coefficients_beyond_the_length_go_into_the_tail():
    x = TaylorModel([arb(1), arb(2), arb(-3), arb(4)], 2, 1)
    assert (x.polynomial.length(), x.tail) == (2, 8)
