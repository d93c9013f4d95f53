"""A factor of a turn is named, at its angle and in its parts; its angle and its size are series with true powers."""

from __future__ import annotations

import cmath

import pytest

from driftproof.blackbox.families.rotations import TURN_ANGLES, turn_of
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.rounding.formats import BINARY64

ROUNDING = Rounding(BINARY64, 8)


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
        (lambda z: cayley(z / 2) ** 2, "implicit_midpoint in 2 equal parts", 2),
        (lambda z: (1 + z) / abs(1 + z), "forward_euler, made one of length 1 again", 2),
        (lambda z: 1 + z + z * z / 4, "forward_euler in 2 equal parts", 1),
        (lambda z: 1 + z + z * z / 5, "no rotation that is known here", 1),
    ],
)
def test_a_factor_is_named_with_its_order(factor, name, order):
    found = turn(factor)
    assert (found.name, found.order) == (name, order)


def test_series_of_angle_and_size_are_those_of_the_factor():
    assert turn(cayley).lines("x") == ["it turns by 2 atan(x/2) = x - x^3/12 + ...", "its size is kept to rounding"]
    assert turn(lambda z: 1 + 2 * z).lines("h B") == [
        "it turns by 2 times h B for short steps, not by h B",
        "its size is multiplied by 1 + 2 (h B)^2 + ...",
    ]
    assert turn(lambda z: 1 + z + z * z / 5).lines("x")[1] == "its size is multiplied by 1 + 0.3 x^2 + ..."


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
