"""The parts that matching is made of: sizes beside exact sums, tables of variants, and the quick test before them."""

from __future__ import annotations

from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.blackbox.matching.candidates import field_methods, force_methods
from driftproof.blackbox.matching.tables import (
    bounded,
    induced_by_tableau,
    induced_repeated,
    tableau_of,
    tableau_repeated,
)
from driftproof.blackbox.probes.coefficients import coefficient_text, exact_shown, half_spacing, is_nearest
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.catalogue import METHODS
from driftproof.methods.number_field import square_root
from driftproof.symbolic.linear.reduced_tableau import Stages, reduced
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64


def test_sizes_add_up_where_values_cancel():
    x = bounded(Q(1, 3)) * bounded(Q(3)) - bounded(Q(1))
    assert not x
    assert x == 0
    assert (x.value, x.size) == (0, 2.0)


def test_reduction_keeps_sizes():
    third, rest = bounded(Q(1, 3)), bounded(Q(-1, 3))
    stages = Stages(((bounded(0), bounded(0)), (bounded(0), bounded(0))), ((third, rest),), (bounded(0), bounded(0)))
    ((merged,),) = reduced(stages).weights
    assert (merged.value, merged.size) == (0, 2 * (1 / 3))


def test_a_table_repeated_and_then_squared_is_one_squared_and_then_repeated():
    tableau = tableau_of(METHODS["kutta3"], Q)
    assert induced_by_tableau(tableau_repeated(tableau, 3)) == induced_repeated(induced_by_tableau(tableau), 3)


def test_the_quick_test_lets_a_method_pass_for_itself_and_for_hardly_any_other():
    for methods in (field_methods(True), force_methods()):
        for one in methods:
            rounding = Rounding(BINARY64, one.fingerprint.calls)
            passed = [other.key for other in methods if one.fingerprint.may_be(other.fingerprint, rounding)]
            assert one.key in passed
            assert len(passed) <= 4  # such as rk4, zonneveld43, gill4 and england45


def test_the_stages_that_count_are_counted_in_floats_as_they_are_exactly():
    for candidate in (*field_methods(True), *force_methods()):
        assert candidate.fingerprint.used == candidate.small.calls


NEAREST = [
    (1 / 3, Q(1, 3), BINARY64, True),
    (np.nextafter(1 / 3, 1), Q(1, 3), BINARY64, False),
    (float(np.float32(1 / 3)), Q(1, 3), BINARY32, True),
    (float(np.float32(1 / 3)), Q(1, 3), BINARY64, False),
    (2**0.5, square_root(2), BINARY64, True),
    (1.4142, square_root(2), BINARY64, False),
    (0.0, Q(0), BINARY16, True),
]


@pytest.mark.parametrize(("x", "exact", "fmt", "nearest"), NEAREST)
def test_the_nearest_number_of_a_format_is_told_from_its_neighbours(x, exact, fmt, nearest):
    assert is_nearest(x, exact, fmt) == nearest


SHOWN = [
    (19372 / 6561, BINARY64, "19372/6561"),
    (-1 / 3, BINARY64, "-1/3"),
    (0.0, BINARY64, "0"),
    (1.0, BINARY64, "1"),
    (1e-10, BINARY64, "1/10000000000"),
    (0.1234567890123456, BINARY64, "0.1234567890123456"),
    (0.3333, BINARY64, "3333/10000"),
    (float(np.float32(1 / 6)), BINARY32, "1/6"),
    (float(np.float32(1 / 6)), BINARY64, repr(float(np.float32(1 / 6)))),
]


@pytest.mark.parametrize(("x", "fmt", "text"), SHOWN)
def test_a_float_is_shown_as_the_fraction_that_it_rounds_if_that_is_no_coincidence(x, fmt, text):
    assert coefficient_text(x, fmt) == text


def test_half_the_spacing_is_u_at_one_and_the_next_float_is_twice_as_far():
    for x in (1.0, 1.5, 0.1, 1e300, 5e-324):
        assert 2 * half_spacing(x, BINARY64) == Q(float(np.nextafter(x, np.inf))) - Q(x)
    assert half_spacing(1.0, BINARY16) == BINARY16.u


def test_a_long_exact_number_is_shown_as_a_decimal():
    assert exact_shown(Q(1, 3)) == "1/3"
    assert exact_shown(Q(10**30 + 1, 3 * 10**30)) == "0.3333333333333333"
