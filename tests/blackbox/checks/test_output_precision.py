"""Answers that are rounded, or formed of rounded numbers, are told from those with all their digits."""

import pytest

from tests.blackbox.checks.habits import (
    FIXED_POINT,
    INTEGERS,
    ROUNDED_TO_SINGLE,
    SINGLE,
    SINGLE_INSIDE,
    SIX_DECIMALS,
    assert_fault,
    code,
    identified,
    result,
)

ROUNDED = [
    (INTEGERS, "answers are whole numbers"),
    (SIX_DECIMALS, "answers are rounded to 6 decimals"),
    (FIXED_POINT, "answers are multiples of 2**-16"),
    (SINGLE, "answers are rounded to binary32"),
    (ROUNDED_TO_SINGLE, "answers are rounded to binary32"),
    (SINGLE_INSIDE, "S(3z) is 3 S(z) to about 26 bits only"),
]


@pytest.mark.parametrize(("step", "words"), ROUNDED, ids=identified)
def test_a_rule_that_rounds_is_told(step, words):
    assert_fault(step, "full_precision", words)


@pytest.mark.parametrize(("times", "holds"), [(48, False), (100, True)])
def test_errors_of_other_parts_at_other_sizes_are_a_rule_about_sizes_and_no_rounding(times, holds):
    """Errors of two sizes are alike if one is no more than 64 times the other."""
    wrong = f"max(1e-7 * (abs(q) > 1e-9), 1e-7 / {times} * (abs(q) > 1e-18))"
    step = code(f"return q + h * v * (1 + {wrong}), v - h * q")
    assert result(step, "full_precision").holds is holds
