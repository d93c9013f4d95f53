"""Families with a parameter: R(z) and the error constant as functions of it, stability as exact sets."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from flint import fmpq_poly

from driftproof.methods.catalogue import METHODS
from driftproof.methods.families import FAMILIES, Family
from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.schemes import MethodError
from driftproof.symbolic.algebra.bivariate import at_parameter
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.algebra.rational_functions import fraction, rational_function_text
from driftproof.symbolic.linear.a_stability import a_stability, i_stability, l_stability
from driftproof.symbolic.linear.families import (
    family_error_constant,
    family_stability,
    parameter_set,
)
from driftproof.symbolic.linear.phase import error_constant
from driftproof.symbolic.linear.stability_function import stability_function
from tests.symbolic.linear.family_examples import THETA, family

T = fmpq_poly([0, 1])
ROOT_3 = square_root(3)


def texts(family: Family, name: str) -> tuple[list[str], list[str]]:
    num, den = ([rational_function_text(f, name) for f in row] for row in family_stability(family).coefficients())
    return num, den


def test_r_of_the_sdirk_family_as_a_function_of_gamma() -> None:
    num, den = texts(FAMILIES["sdirk_order_2"], "g")
    assert num == ["1", "1 - 2*g", "1/2 - 2*g + g**2"]
    assert den == ["1", "-2*g", "g**2"]
    power, constant = family_error_constant(FAMILIES["sdirk_order_2"])
    assert (power, rational_function_text(constant, "g")) == (3, "-1/6 + g - g**2")
    assert exact(constant(scalar(Q(1, 2) + ROOT_3 / 6))) == 0  # order 3 there


def test_r_of_the_explicit_family_does_not_depend_on_its_parameter() -> None:
    assert texts(FAMILIES["explicit_order_2"], "a") == (["1", "1", "1/2"], ["1"])
    for value, key in ((Q(1), "heun2"), (Q(1, 2), "midpoint2")):
        member, known = FAMILIES["explicit_order_2"].member(value), METHODS[key]
        assert (member.a, member.b, member.c) == (known.a, known.b, known.c)
    with pytest.raises(MethodError, match="pole"):
        FAMILIES["explicit_order_2"].member(Q(0))


VALUES = [Q(1, 4), Q(-3), Q(7, 5), Q(1, 2), 1 - square_root(2) / 2]


@pytest.mark.parametrize("key", FAMILIES)
@pytest.mark.parametrize("value", VALUES)
def test_functions_of_the_parameter_are_those_of_each_member(key: str, value: Q) -> None:
    family, at = FAMILIES[key], scalar(value)
    r = family_stability(family)
    member = stability_function(family.member(value))
    num, den = (at_parameter(rows, at) for rows in (r.num, r.den))
    assert fraction(num, den) == member
    power, constant = family_error_constant(family)
    found = error_constant(member)
    assert exact(constant(at)) == (found.coefficient if found.power == power else 0)


SETS = {
    "sdirk_order_2": ("[1/4, oo)", "[1/4, oo)", "{1 - sqrt(2)/2} U {1 + sqrt(2)/2}"),
    "sdirk_stiffly_accurate": 3 * ("[1 - sqrt(2)/2, 1 + sqrt(2)/2]",),
    "explicit_order_2": 3 * ("empty",),
}


@pytest.mark.parametrize("key", SETS)
def test_stability_as_an_exact_set(key: str) -> None:
    found = tuple(str(parameter_set(FAMILIES[key], decide)) for decide in (a_stability, i_stability, l_stability))
    assert found == SETS[key]


@pytest.mark.parametrize("key", ["sdirk_order_2", "sdirk_stiffly_accurate"])
@pytest.mark.parametrize("offset", [Q(0), Q(1, 10**30), Q(-1, 10**30), Q(1, 7), Q(-1, 7)])
def test_members_near_the_ends_agree_with_the_set(key: str, offset: Q) -> None:
    (interval,) = parameter_set(FAMILIES[key], a_stability).intervals
    assert interval.low is not None
    value = (interval.low.rational or (1 - square_root(2) / 2)) + offset
    inside = offset >= 0
    assert bool(a_stability(stability_function(FAMILIES[key].member(value)))) == inside


def test_theta_method() -> None:
    assert str(parameter_set(THETA, a_stability)) == "[1/2, oo)"
    assert str(parameter_set(THETA, l_stability)) == "{1}"
    assert texts(THETA, "t")[0] == ["1", "1 - t"]


def test_a_factor_that_cancels_for_every_value_is_cancelled() -> None:
    """The second stage is never used: R = 1/(1 - z), not (1 - tz)/((1 - z)(1 - tz))."""
    idle = family("t", "1, 0; 1, t", "1, 0", "1, 1 + t")
    assert texts(idle, "t") == (["1"], ["1", "-1"])
    assert str(parameter_set(idle, a_stability)) == "(-oo, oo)"


def test_a_pole_and_a_bounded_set_are_cut_out() -> None:
    """gamma = 1/t: A-stable for 0 < t <= 4, and not defined at 0."""
    inverse = family("t", "1/t, 0; 1 - 2/t, 1/t", "1/2, 1/2", "1/t, 1")
    assert str(parameter_set(inverse, a_stability)) == "(0, 4]"


def test_a_cancellation_at_one_value_is_decided_there() -> None:
    """R = (1 + z)/(1 + tz) is 1 at t = 1, where the pole in the left half-plane cancels."""
    cancel = family("t", "-t", "1 - t", "-t")
    assert str(parameter_set(cancel, a_stability)) == "(-oo, -1] U {1}"
    assert str(parameter_set(cancel, i_stability)) == "(-oo, -1] U [1, oo)"


def test_a_pole_that_cancels_far_from_the_axis_is_found() -> None:
    """R = (1 + z)/((1 + tz)(1 - 2z)²), composed of three steps: I-stable for every t, and at t = 1 A-stable."""
    hidden = family("t", "-t, 0, 0; 1 - t, 2, 0; 1 - t, 2, 2", "1 - t, 2, 2", "-t, 3 - t, 5 - t")
    assert str(parameter_set(hidden, i_stability)) == "(-oo, oo)"
    assert str(parameter_set(hidden, a_stability)) == "(-oo, 0] U {1}"


def test_a_contact_that_opens_at_a_finite_point_of_the_axis_is_found() -> None:
    """R = (1 + tz²)/(1 - z)³: the margin is y²(3 + 2t + (3 - t²)y² + y⁴), with a double root y² = 3 at t = 3."""
    contact = family("t", "1, 0, 0; 1, 1, 0; 0, 1, 1", "-t, 2, 1 + t", "1, 2, 2")
    assert texts(contact, "t")[0] == ["1", "0", "t"]
    assert str(parameter_set(contact, a_stability)) == "[-3/2, 3]"
