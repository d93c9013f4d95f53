"""Floats are read as fractions only where that is no coincidence, and always as the one of least denominator."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.blackbox.probes.coefficients import (
    coefficient_difference,
    coefficient_text,
    exact_shown,
    half_spacing,
    is_nearest,
    short_rational,
    simple_rational,
    simplest_in,
)
from driftproof.methods.numbers.number_field import square_root
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64

FRACTIONS = st.fractions(min_value=-50, max_value=50, max_denominator=400)


@given(FRACTIONS, FRACTIONS)
def test_the_simplest_rational_of_an_interval_is_the_first_that_a_search_by_denominators_meets(a, b):
    low, high = sorted((a, b))
    found = simplest_in(low, high)
    assert low <= found <= high
    for denominator in range(1, found.denominator):
        assert -(-low.numerator * denominator // low.denominator) > high * denominator


@pytest.mark.parametrize(("low", "high"), [(Q(-3, 2), Q(0)), (Q(0), Q(3, 2)), (Q(0), Q(0)), (Q(-5, 2), Q(7, 3))])
def test_of_an_interval_with_0_in_it_or_at_its_end_0_is_the_simplest(low, high):
    assert simplest_in(low, high) == 0


def test_a_rational_is_a_coincidence_from_one_chance_in_64_on():
    assert [simple_rational(Q(x), x**2 * Q(1, 128)) for x in (Q(1), Q(1, 3))] == [1, Q(1, 3)]
    assert [simple_rational(Q(x), x**2 * Q(1, 127)) for x in (Q(1), Q(1, 3))] == [None, None]


def test_an_empty_interval_is_refused():
    with pytest.raises(ValueError, match="no number"):
        simplest_in(Q(1), Q(0))


def test_numbers_are_shown_as_people_write_them():
    million = 10**6
    numbers = Q(1, 25), Q(1, 3), Q(million), Q(-2), Q(2**0.5), Q(1234567, million - 1), Q(1234567, million)
    shown = ["0.04", "1/3", "1000000", "-2", "1.4142135623730951", "1234567/999999", "1.234567"]
    assert [short_rational(x) for x in numbers] == shown


NEAREST = [
    (1 / 3, Q(1, 3), BINARY64, True), (np.nextafter(1 / 3, 1), Q(1, 3), BINARY64, False),
    (float(np.float32(1 / 3)), Q(1, 3), BINARY32, True), (float(np.float32(1 / 3)), Q(1, 3), BINARY64, False),
    (2**0.5, square_root(2), BINARY64, True), (1.4142, square_root(2), BINARY64, False), (0.0, Q(0), BINARY16, True),
]  # fmt: skip


@pytest.mark.parametrize(("x", "exact", "fmt", "nearest"), NEAREST)
def test_the_nearest_number_of_a_format_is_told_from_its_neighbours(x, exact, fmt, nearest):
    assert is_nearest(x, exact, fmt) == nearest


def test_half_the_spacing_is_u_at_one_and_the_next_float_is_twice_as_far():
    for x in (1.0, 1.5, 0.1, 1e300, 5e-324):
        assert 2 * half_spacing(x, BINARY64) == Q(float(np.nextafter(x, np.inf))) - Q(x)
    assert half_spacing(1.0, BINARY16) == BINARY16.u


@pytest.mark.parametrize(
    ("seen", "exact", "line"),
    [
        (-3.4142135623731036, -2 - square_root(2), " (about 20 units in its last place away)"),
        (0.25 + 2.0**-54, Q(1, 4), " (about 1 unit in its last place away)"),
        (0.25 + 2.0**-20, Q(1, 4), ""),
        (0.5, Q(1, 4), ""),
    ],
)
def test_how_far_a_coefficient_is_away_is_told_where_that_is_hard_to_see(seen, exact, line):
    told = coefficient_difference("A[1][0]", seen, exact, BINARY64)
    assert told.partition(str(exact))[2] == line


def test_a_long_exact_number_is_shown_as_a_decimal():
    assert exact_shown(Q(1, 3)) == "1/3"
    assert exact_shown(Q(10**21, 3)) == f"{10**21}/3"
    assert exact_shown(Q(10**22, 3)) == repr(10**22 / 3)
    assert exact_shown(Q(10**30 + 1, 3 * 10**30)) == "0.3333333333333333"
    assert exact_shown(Q(1e300)) == short_rational(Q(1e300)) == coefficient_text(1e300, BINARY64) == "1e+300"


NUMBERS = [1 / 3, -2 / 7, 0.1, 1e-300, 5e-324, 1e22, 0.30000000000000004, 1 / 3 + 1e-12, 19 / 6561, 2**0.5, 0.0, -4.0]
NUMBERS += [1e-9, 19372 / 6561, -1 / 3, 1.0, 1e-10, 0.1234567890123456, 0.3333, float(np.float32(1 / 6))]


@pytest.mark.parametrize("fmt", [BINARY64, BINARY32, BINARY16], ids=lambda fmt: fmt.name)
def test_what_numbers_are_read_as_is_what_it_was(fmt, as_before):
    seen = [float(fmt.nearest(Q(x))) if abs(x) < 6e4 else x for x in NUMBERS]
    texts = [[coefficient_text(x, fmt, slack) for slack in (0.0, 1e-12, 1e-5)] for x in seen]
    read = [[simple_rational(x, error) for error in (0.0, 1e-16, 1e-9, 1e-4, 0.003, 0.2)] for x in NUMBERS]
    shown = [
        (str(half_spacing(x, fmt)), short_rational(Q(x)), exact_shown(Q(x)), is_nearest(x, Q(1, 3), fmt)) for x in seen
    ]
    as_before(*texts, *([str(y) for y in each] for each in read), *shown)
