"""A factor of a turn is named, at its angle and in its parts; its angle and its size are series with true powers."""

from __future__ import annotations

import cmath
from math import atan

import pytest

from driftproof.blackbox.families.rotations import TURN_ANGLES, turn_of
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.rounding.formats import BINARY64

ROUNDING, U = Rounding(BINARY64, 8), 2.0**-53


def turn(factor):
    return turn_of([factor(1j * x) for x in TURN_ANGLES], ROUNDING)


def cayley(z):
    return (1 + z / 2) / (1 - z / 2)


@pytest.mark.parametrize(
    ("factor", "name", "order"),
    [
        (cmath.exp, "exact", None),
        (cayley, "implicit_midpoint", 2),
        (lambda z: 1 + z, "forward_euler", 1),
        (lambda z: 1 / (1 - z), "backward_euler", 1),
        (lambda z: 1 + z + z * z / 2, "midpoint2", 2),
        (lambda z: cayley(2 * z), "implicit_midpoint at twice the angle", 0),
        (lambda z: cmath.exp(z / 2), "exact at half the angle", 0),
        (lambda z: cayley(4 * z), "implicit_midpoint at four times the angle", 0),
        (lambda z: cayley(-z), "implicit_midpoint", 0),
        (lambda z: cayley(-2 * z), "implicit_midpoint at twice the angle the other way", 0),
        (lambda z: cayley(-z / 2), "implicit_midpoint at half the angle the other way", 0),
        (lambda z: cayley(z / 2) ** 2, "implicit_midpoint in 2 equal parts", 2),
        (lambda z: (1 + z) / abs(1 + z), "forward_euler, normalised to length 1", 2),
        (lambda z: 1 + z + z * z / 4, "forward_euler in 2 equal parts", 1),
        (lambda z: 1 + z + z * z / 5, "not a known rotation", 1),
        (lambda z: 1 - z * z, "not a known rotation", 0),
        # What rounding may carry is (4 (8 + 2) 4 u) (1 + |R|): 320 u.
        (lambda z: cmath.exp(z) * (1 + 310 * U), "exact", None),
        (lambda z: cmath.exp(z) * (1 + 330 * U), "not a known rotation", None),
    ],
)
def test_a_factor_is_named_with_its_order(factor, name, order):
    found = turn(factor)
    assert (found.name, found.order) == (name, order)


def grown(power, coefficient):
    """An exact rotation times 1 + c θ^p, p even."""
    return lambda z: cmath.exp(z) * (1 + coefficient * (-z * z).real ** (power // 2))


@pytest.mark.parametrize(
    ("factor", "angle", "size"),
    [
        (cayley, "2 atan(x/2) = x - x^3/12 + ...", None),
        (lambda z: 1 + z, "atan(x) = x - x^3/3 + ...", "1 + x^2/2 + ..."),
        (lambda z: cayley(z / 2) ** 2, "x - x^3/48 + ...", None),
        (lambda z: 1 + 2 * z, "2 times x for short steps, not by x", "1 + 2 x^2 + ..."),
        (lambda z: cayley(0.3 * z), "0.3 times x for short steps, not by x", None),
        (lambda z: 1 + z + z * z / 5, "x - 0.133 x^3 + ...", "1 + 0.3 x^2 + ..."),
        (grown(2, 1.0), "x", "1 + x^2 + ..."),
        (grown(2, -0.335), "x", "1 - x^2/3 + ..."),
        (grown(2, 0.3366), "x", "1 + 0.337 x^2 + ..."),
        # From two angles above the noise, 64 (4 (8 + 2) 4 u) = 1.1e-12, and not from one.
        (grown(8, 2.0**-36), "x", "1 + x^8/68719476736 + ..."),
        (grown(8, 2.0**-41), "x", None),
        # Of angles two halvings apart, where the error between them is 0.
        (lambda z: grown(2, 0.5 * (abs(z) != 2.0**-6))(z), "x", "1 + x^2/2 + ..."),
    ],
)
def test_series_of_angle_and_size_are_those_of_the_factor(factor, angle, size):
    turns = f"it turns by {angle}"
    assert turn(factor).lines("x") == [turns, f"its size is {f'multiplied by {size}' if size else 'kept to rounding'}"]


def test_a_series_stands_in_brackets_where_the_angle_is_a_product_and_scale_is_of_the_shortest_step():
    assert turn(lambda z: 1 + 2 * z).lines("h B")[1] == "its size is multiplied by 1 + 2 (h B)^2 + ..."
    assert turn(cayley).angle == pytest.approx((2, -1 / 12), rel=2e-5)
    assert turn(lambda z: cayley(0.3 * z)).scale == pytest.approx(2 * atan(0.15 / 128) * 128, rel=1e-14)


@pytest.mark.parametrize("key", ["rk4", "implicit_midpoint", "gauss2", "forward_euler"])
def test_a_factor_is_held_to_a_methods_own_and_to_no_other(key):
    factors = {
        "rk4": lambda z: 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24,
        "implicit_midpoint": cayley,
        "gauss2": lambda z: (1 + z / 2 + z * z / 12) / (1 - z / 2 + z * z / 12),
        "forward_euler": lambda z: 1 + z,
    }
    assert turn(factors[key]).held_to(METHODS[key]).passed is True
    for other in factors.keys() - {key}:
        assert turn(factors[other]).held_to(METHODS[key]).passed is False
    assert turn(factors[key]).held_to(METHODS["velocity_verlet"]).passed is False


def test_how_far_a_factor_is_from_a_methods_own_is_told_at_the_worst_angle():
    """What rounding may carry is 4 (4 + 8 + 2) 4 u, of the least of |R|/(1 + |R|) = 1/2 at most."""
    rk4 = lambda z: 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24
    assert turn(lambda z: rk4(z) * (1 + 435 * U)).held_to(METHODS["rk4"]).passed
    assert not turn(lambda z: rk4(z) * (1 + 462 * U)).held_to(METHODS["rk4"]).passed
    assert turn(lambda z: 1 + z).held_to(METHODS["rk4"]).lines == (
        "forward_euler: off the factor of rk4 by 1.1 at the angle 2",
    )
    (line,) = turn(lambda z: rk4(z) * (1 + 100 * U)).held_to(METHODS["rk4"]).lines
    assert line == "rk4's factor at all of 9 angles, off by 5.6e-15 at most"
