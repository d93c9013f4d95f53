"""Taylor models hold what they stand for on the whole disc, sharply, and refuse poles and branch points in it."""

from __future__ import annotations

import pytest
from flint import acb, acb_poly, arb, arb_mat, arb_poly, ctx

from driftproof.enclosure.arithmetic import models
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.arithmetic.functions import quotient_of
from driftproof.enclosure.arithmetic.models import TaylorModel, value_at
from tests.enclosure.mutants import mutant

LENGTH = 12
# Made from the model, and from a complex number.
FUNCTIONS = {
    "product": (lambda x: x * x * x, lambda z: z**3),
    "quotient": (lambda x: 2 / x, lambda z: 2 / z),
    **{
        name: (lambda x, name=name: getattr(x, name)(), lambda z, name=name: getattr(z, name)())
        for name in ("sqrt", "exp", "erf", "sin", "cos", "log", "atan", "asin", "acos")
    },
}


CURVE = (0.5, 1 / 16, 1 / 32)


def held(module, name, tail, curve=CURVE):
    """How near the function's values at twelve points of the circle come to the bound, 1 being on it.

    Of c_0 + c_1 σ + ... and, with a tail, that many σ¹² beyond the coefficients that are kept.
    """
    ours, theirs = FUNCTIONS[name]
    coefficients = [*map(arb, curve), *[arb(0)] * (LENGTH - len(curve))]
    found, x = ours(module.TaylorModel(coefficients, LENGTH, arb(tail))), acb_poly([*coefficients, tail])
    most = 0.0
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


# How near the bound is at least where little is left out: of what a function adds, and of a tail that it is given.
SHARP = {
    **{"quotient": (0.99, 0.99), "sqrt": (0.49, 0.49), "exp": (0.99, 0.99), "sin": (0.35, 0.87), "cos": (0.64, 0.47)},
    **{
        "log": (0.043, 0.99),
        "atan": (0.11, 0.99),
        "asin": (0.026, 0.78),
        "acos": (0.026, 0.78),
        "product": (0, 0.99),
        "erf": (0.9, 0.9),
    },
}


@pytest.mark.parametrize("name", SHARP)
def test_bound_of_what_is_small_is_nearly_attained(name):
    """So that a factor that makes it much smaller is noticed, whichever term it stands at."""
    with ctx.workprec(400):
        for least, tail, curve in ((SHARP[name][0], 0, (0.5, 2.0**-8)), (SHARP[name][1], 2.0**-20, (0.5,))):
            assert least == 0 or least < held(models, name, tail, curve) <= 1 + 2.0**-50
        # Of both at once, about as large and of either sign, so that they add up in one case: no difference of them.
        both = FUNCTIONS[name][0](TaylorModel([arb(x) for x in (0.5, 2.0**-8)], LENGTH)).tail
        assert (
            name == "product"
            or max(held(models, name, sign * both, (0.5, 2.0**-8)) for sign in (-1, 1)) <= 1 + 2.0**-50
        )


TAILS = {
    "product": "self.norm * other.tail + self.tail * other.norm",
    "quotient": 'a.norm * _geometric((self * a).tail, "divides by a number that may be 0")',
    "sqrt": 'a.norm * _geometric(error * inverse.norm * inverse.norm, "takes the root of a number that may be 0")',
    "log": '_geometric((self * (-a).exp()).tail, "takes the logarithm of a number that may be 0")',
    "exp": "(2 * w).exp() * error / self.length + first * whole.exp() * self.tail",
    "erf": "error / self.length + steepest * self.tail",
    "sin": "(2 * w).exp() * error / self.length + whole.exp() * self.tail",
    "atan": '_geometric(error, "takes an uncertain inverse tangent")',
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


@pytest.mark.parametrize("curve", [(0.0, 0.25), (0.3, 0.5, -0.25), (-0.5, 0.125), (3.0, 0.25)])
@pytest.mark.parametrize("tail", [0, 2.0**-6])
@pytest.mark.parametrize("name", ["exprel", "sinc"])
def test_quotient_of_a_model_is_held_on_the_disc_also_where_it_is_0_by_0(curve, tail, name):
    with ctx.workprec(128):
        coefficients = [*map(arb, curve), *[arb(0)] * (LENGTH - len(curve))]
        model, x = TaylorModel(coefficients, LENGTH, arb(tail)), acb_poly([*coefficients, tail])
        whole = lambda z: z.sin() / z if name == "sinc" else (z.exp() - 1) / z
        rate = lambda z: ((z.cos() if name == "sinc" else z.exp()) - whole(z)) / z
        for slope, theirs in ((False, whole), (True, rate)):
            found = quotient_of(model, name, slope=slope)
            points = [(acb(0, arb.pi() * (k + 0.5) / 6)).exp() for k in range(12)]
            away = [abs(theirs(x(z)) - acb_poly(found.polynomial.coeffs())(z)) for z in points]
            assert not any(each > found.tail for each in away)
            assert found.tail < 40 * (tail + 2.0**-20)
            assert not all(each < found.tail / 40 for each in away) or not tail


def test_sums_and_constants():
    x = TaylorModel([arb(1), arb(2)], 2, 0.5)
    found = 3 - (x + x) * 2 + x - 1
    assert (str(found.polynomial), found.tail) == (str(arb_poly([-1, -6])), arb(2.5))
    assert (found.norm, found.coefficient(1), found.is_finite()) == (9.5, -6, True)
    assert not TaylorModel([arb("nan")], 2).is_finite()


def test_value_of_a_polynomial_of_matrices():
    assert value_at([arb_mat([[k, 2**k]]) for k in range(5)], arb(-0.5)) == arb_mat([[-0.125, 1]])


def test_comparison_is_of_the_whole_step():
    x = TaylorModel([arb(1), arb(-0.5)], 2, 0.25)
    assert [x > 0.24, x < 1.76, x > 0.26, x < 1.74] == [True, True, False, False]
    assert x.range().contains(arb(0.75))
    assert x.range().rad() < 0.51


def test_coefficients_beyond_the_length_go_into_the_tail():
    x = TaylorModel([arb(1), arb(2), arb(-3), arb(4)], 2, 1)
    assert (x.polynomial.length(), x.tail) == (2, 8)


def test_mean_of_a_union_holds_that_of_what_changes_between_the_two():
    """1 + σ up to 1/2 and 3 - σ² from there on, each model with a tail: 5/8 + 3/2 - 7/24."""
    one, other = TaylorModel([arb(1), arb(1)], 4, 0), TaylorModel([arb(3), arb(0), arb(-1)], 4, arb(2) ** -10)
    mixed = one.union(other).mean()
    assert one.union(other).tail == other.union(one).tail == other.tail
    assert mixed.contains(arb(11) / 6)
    assert mixed.contains(arb(8) / 3 + arb(2) ** -10)
    assert not mixed.contains(3.6)
    assert (other.mean() - arb(8) / 3).contains(arb(2) ** -11)
