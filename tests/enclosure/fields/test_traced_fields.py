"""Functions become text that means the same, up to rounding; what text cannot say is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.fields.text_fields import field_function
from driftproof.enclosure.fields.traced_fields import field_of_function
from driftproof.numeric.advance import field_rate
from tests.enclosure.right_hand_sides import kepler
from tests.looping import exactly

CENTRE = np.array([[0.0, 1.0], [-1.0, 0.0]])


def forced(t, y):
    return [y[1], -math.sin(y[0]) + 0.3 * math.cos(2 * t) - 1e-3 * y[1] / (1 + y[0] * y[0])]


FUNCTIONS = {
    "kepler": (kepler, (0.75, -0.5, 0.25, 1.5)),
    "forced": (forced, (0.75, -0.5)),
    "matrix": (lambda t, y: CENTRE @ y + np.exp(-t), (0.75, -0.5)),
    "drag": (lambda t, y: [-y[0] * abs(y[0]), np.abs(y[1]) - abs(t - 1)], (0.75, -0.5)),
    "scales": (lambda t, y: [1e300 * y[0] * 2.0**40, np.sqrt(y[1]) / 3 - np.tanh(y[1]) + np.log(y[1])], (1e-320, 2.0)),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_text_means_what_the_function_means(name):
    f, y = FUNCTIONS[name]
    made = field_function(field_of_function(f, len(y)))
    # Some dozen roundings of numbers of size 3 at most.
    for found, wanted in exactly(len(y), zip(made(0.25, np.array(y)), f(0.25, np.array(y)), strict=True)):
        assert abs(found - wanted) <= 1e-14 * max(1, abs(wanted))


def test_second_order_is_seen_and_quotients_are_one_division():
    field = field_of_function(lambda t, y: [y[1], -y[0] / (1 + 0.5 * y[0])], 2)
    assert field.rates == ("y1", "((-y0) / ((y0 * double_0) + 1))")
    assert field.second_order() == (("y0",), ("y1",))
    assert [float(value) for _, value in field.parameters] == [0.5]


def test_same_double_is_one_parameter():
    field = field_of_function(lambda t, y: [0.1 * y[0] + 0.1, 0.1 + 3e9], 2)
    assert [(name, float(x)) for name, x in field.parameters] == [("double_0", 0.1), ("double_1", 0.1 + 3e9)]


def dose(t, y):
    return [(5.0 if t % 12 < 0.5 else 0.0) - 0.3 * y[0], y[0] // 0.25 - math.ceil(t / 2)]


CHOICES = {
    "dose": dose,
    "friction": lambda t, y: [y[1], -y[0] - 0.2 * np.sign(y[1])],
    "spring": lambda t, y: [y[1], -9.81 + 1e3 * max(-y[0], 0) + min(y[1], 2 * y[0], 0.5)],
    "tank": lambda t, y: [0.5 - math.sqrt(y[0]) if y[0] > 0 else 0.5, np.clip(y[1], -1, 1)],
    "data": lambda t, y: [-y[0] + np.interp(t, [0, 1, 2.5, 4], [0.0, 1.0, 0.5, 0.0]), y[0] * (y[1] >= 0.5)],
    "where": lambda t, y: np.array([y[1], np.where(y[0] > 0.5, -1.0, np.heaviside(y[1] - t, 0))]),
    "roots": lambda t, y: [
        max(y[0], 0.0) ** 0.5 - max(y[1], 0) ** 1.5,
        np.interp(y[0], [-1.3, 0.1, 0.7], [0.1, 0.3, 0.2]),
    ],
    "in order": lambda t, y: [1.0 if -1 < y[0] <= 1 else 2.0, 0.0 if y[0] == 0.5 else y[1]],
}
PLACES = [
    (t, q, v) for t in (0.25, 0.5, 1.0, 3.5, 13.0) for q in (-2.0, -1.0, 0.0, 0.5, 0.75) for v in (-1.5, 0.0, 0.5)
]


@pytest.mark.parametrize("name", CHOICES)
def test_all_outcomes_of_comparisons_are_in_the_text(name):
    f = CHOICES[name]
    made = field_of_function(f, 2)
    assert not made.smooth
    floats, balls = field_rate(made), field_function(made)
    for t, *y in exactly(75, PLACES):
        wanted = [*map(float, f(t, np.array(y)))]
        assert floats(t, y) == pytest.approx(wanted, rel=1e-15, abs=1e-15), (t, y)
        assert balls(t, np.array(y)) == pytest.approx(wanted, rel=1e-15, abs=1e-15), (t, y)


def test_a_comparison_that_is_asked_again_has_the_same_outcome_and_rates_without_it_have_no_choice():
    field = field_of_function(lambda t, y: [y[1], max(0, y[0]) * max(0, y[0]) + max(0, y[0])], 2)
    assert field.rates == ("y1", "(((y0 * y0) + y0) if y0 > 0 else ((0 * 0) + 0))")


def test_a_comparison_that_others_imply_is_no_choice():
    relay = field_of_function(lambda t, y: [1.0 * (y[0] < 1) + 0.25 * (y[0] >= 1) + 4 * (y[0] > 1) * (y[0] <= 1)], 1)
    assert relay.rates[0] == "(1 if 1 > y0 else double_0)"
    assert field_of_function(lambda t, y: [at_most_one(y[0])], 1).rates == ("(double_0 if 1 > y0 else y0)",)
    for t, *y in exactly(75, PLACES):
        assert field_rate(relay)(t, y[:1]) == [1.0 if y[0] < 1 else 0.25]


def at_most_one(x):
    if x < 1:
        found = 0.5
    elif x >= 1:
        found = x
    return found


def test_outcomes_are_counted():
    knots = np.arange(63.0)
    assert len(field_of_function(lambda t, y: [np.interp(t, knots, knots**2)], 1).rates) == 1
    with pytest.raises(Refused, match="compares numbers with more than 64 outcomes; certify takes such an f"):
        field_of_function(lambda t, y: [np.interp(t, np.arange(64.0), np.arange(64.0) ** 2)], 1)
    with pytest.raises(Refused, match="with more than 64 outcomes"):
        field_of_function(lambda t, y: [wrapped(y[0])], 1)


def wrapped(angle):
    while angle > 1:
        angle = angle - 2
    return angle


REFUSED = {
    "rounds a number to an integer; a problem may use math.floor, as of x": lambda t, y: [y[0] * int(t)],
    "a problem may use math.floor": lambda t, y: [y[0] * round(t)],
    "uses atan; a problem may use sin, cos, exp, log, sqrt, abs, and": lambda t, y: [np.arctan(y[0])],
    "uses exprel; a problem may use sin": lambda t, y: [pytest.importorskip("scipy.special").exprel(y[0])],
    "not a double": lambda t, y: [y[0] * np.radians(y[0])],
    "too long": lambda t, y: [y[0] ** 2**20],
    "returns 2 numbers for 1": lambda t, y: [y[0], y[0]],
}


@pytest.mark.parametrize("said", REFUSED)
def test_what_text_cannot_say_is_refused(said):
    with pytest.raises(Refused, match=said):
        field_of_function(REFUSED[said], 1)
