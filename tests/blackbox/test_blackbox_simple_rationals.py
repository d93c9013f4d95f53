"""Floats are read as fractions only where that is no coincidence, and always as the one of least denominator."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.blackbox.probes.coefficients import short_rational, simple_rational, simplest_in

FRACTIONS = st.fractions(min_value=-50, max_value=50, max_denominator=400)


@given(FRACTIONS, FRACTIONS)
def test_the_simplest_rational_of_an_interval_is_the_first_that_a_search_by_denominators_meets(a, b):
    low, high = sorted((a, b))
    found = simplest_in(low, high)
    assert low <= found <= high
    for denominator in range(1, found.denominator):
        assert -(-low.numerator * denominator // low.denominator) > high * denominator


def test_an_empty_interval_is_refused():
    with pytest.raises(ValueError, match="no number"):
        simplest_in(Q(1), Q(0))


@pytest.mark.parametrize("x", [Q(1, 24), Q(-13649, 6), Q(35, 384), Q(22, 7), Q(0), Q(10**6)])
def test_a_double_is_read_as_the_fraction_that_it_was_rounded_from(x):
    assert simple_rational(float(x), abs(float(x)) * 2.0**-53) == x


@pytest.mark.parametrize("x", [2**0.5, 1 / 24 + 1e-10, 0.7390851332151607])
def test_a_double_that_is_no_simple_fraction_is_read_as_none(x):
    assert simple_rational(x, x * 2.0**-53) is None


def test_numbers_are_shown_as_people_write_them():
    shown = [short_rational(x) for x in (Q(1, 25), Q(1, 3), Q(10**6), Q(-2), Q(2**0.5))]
    assert shown == ["0.04", "1/3", "1000000", "-2", "1.4142135623730951"]
