"""What is said of pairs and of continuous extensions, beside the trees at single thetas and numbers in print."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from driftproof import Facts
from driftproof.methods.catalogue import EXTENSIONS, METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.facts import order_within
from driftproof.symbolic.linear.stability_limits import INFINITY
from driftproof.symbolic.pairs import facts_of_extension
from driftproof.symbolic.trees.order_conditions import order
from tests.looping import some

EXACT = [key for key, each in EXTENSIONS.items() if not each.decimal]


def step_to(extension, theta):
    """The method (A/θ, b(θ)/θ, c/θ), whose step of size θh ends at the value of the extension; θ is not 0."""
    b = tuple(sum(c * theta**k for k, c in enumerate(weight)) / theta for weight in extension.weights)
    a, c = tuple(tuple(x / theta for x in row) for row in extension.a), tuple(x / theta for x in extension.c)
    return RungeKutta("part", "Part", 0, "", a, b, c)


@pytest.mark.parametrize("key", EXACT)
def test_the_order_for_every_theta_is_that_of_steps_to_single_thetas(key):
    """Independent: for a theta, the extension is the method A/theta, b(theta)/theta, and has its order."""
    extension, found = EXTENSIONS[key], facts_of_extension(EXTENSIONS[key])
    orders = [order(step_to(extension, theta)).order for theta in (Fraction(1, 3), Fraction(1, 2), Fraction(9, 10))]
    assert min(some(orders, 3)) == found.order == extension.claimed_order
    assert (found.largest_residual, found.step_residual, found.slope_residual) == (0, 0, 0)
    assert order(step_to(extension, Fraction(1))).order == order(extension.method).order


@pytest.mark.parametrize(("key", "tolerance"), [("tsitouras54_quartic", 13), ("dop853_dense", 25)])
def test_decimal_extensions_hold_to_their_digits(key, tolerance):
    extension, small = EXTENSIONS[key], Fraction(1, 10**tolerance)
    found = facts_of_extension(extension)
    assert 0 < found.largest_residual < small
    assert max(found.step_residual, found.slope_residual) < small
    half = step_to(extension, Fraction(1, 2))
    assert order_within(half, 200 * small).order == extension.claimed_order


def test_a_wrong_digit_of_an_extension_shows():
    extension = EXTENSIONS["dormand_prince54_shampine"]
    wrong = (*extension.weights[:-1], (*extension.weights[-1][:-1], Fraction(69997946, 29380423)))
    found = facts_of_extension(replace(extension, weights=wrong))
    assert found.order == 0
    assert found.step_residual == found.largest_residual == Fraction(1, 29380423)
    assert found.slope_residual == Fraction(4, 29380423)
    hermite = EXTENSIONS["rk4_hermite"]
    flat = replace(hermite, claimed_order=1, weights=((Fraction(1),), *hermite.weights[1:]))
    assert facts_of_extension(flat).largest_residual == Fraction(3, 2)
    assert facts_of_extension(replace(hermite, c=(*hermite.c[:-1], Fraction(1, 2)))).slope_residual is None


def test_the_estimate_of_heun_euler_is_that_of_a_hand_calculation():
    """e = (-1/2, 1/2): E(z) = z²/2; the trees of two and three vertices give B² = 2/9 and C² = 1/4."""
    found = Facts(METHODS["heun_euler21"]).estimate
    assert (found.order, str(found.function), found.at_infinity) == (1, "z**2/2", INFINITY)
    assert found.c_ratio.rational == Fraction(1, 2)
    assert found.b_ratio.minimal == (-2, 0, 9)


def test_the_ratios_of_dormand_prince_are_those_in_print():
    """1.54 and 1.67 in the table of pairs of bogacki-shampine-1996."""
    found = Facts(METHODS["dormand_prince54"]).estimate
    assert round(float(found.b_ratio.ball()), 2) == 1.54
    assert round(float(found.c_ratio.ball()), 2) == 1.67


def test_every_estimate_is_of_the_lower_order_of_its_rows():
    pairs = [m for m in METHODS.values() if isinstance(m, RungeKutta) and m.b_embedded is not None and not m.decimal]
    for pair in some(pairs, 15):
        assert Facts(pair).estimate.order == min(pair.claimed_order, pair.embedded_order), pair.key


def test_what_is_no_pair_has_no_estimate_and_no_extension_is_none():
    facts = Facts(METHODS["heun2"])
    assert (facts.estimate, facts.continuous_extensions) == (None, None)
    assert [each.key for each in Facts(METHODS["rk4"]).continuous_extensions] == ["rk4_hermite"]
    bent = ("1", "-3/2", "2/3"), ("0", "1", "-2/3"), ("0", "1", "-2/3"), ("0", "-1/2", "2/3")
    for last, reached, step in (("2/3", 3, 0), ("1", 0, Fraction(1, 3))):  # the cubic of RK4's own stages, and another
        own = [(Fraction(0), *map(Fraction, weight)) for weight in (*bent[:-1], (*bent[-1][:-1], last))]
        found, cubic = Facts(replace(METHODS["rk4"], dense=tuple(own), title="Mine")).continuous_extensions
        assert (found.key, found.order, found.step_residual, cubic.key) == ("rk4_dense", reached, step, "rk4_hermite")
    assert Facts(METHODS["sdirk4"]).estimate.at_infinity == Fraction(10, 3)
