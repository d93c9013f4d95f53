"""Answers that are rounded, or formed of rounded numbers, are told from those with all their digits."""

import pytest

from tests.blackbox.checks.habits import code, result


@pytest.mark.parametrize(("times", "holds"), [(48, False), (100, True)])
def test_errors_of_other_parts_at_other_sizes_are_a_rule_about_sizes_and_no_rounding(times, holds):
    """Errors of two sizes are alike if one is no more than 64 times the other."""
    wrong = f"max(1e-7 * (abs(q) > 1e-9), 1e-7 / {times} * (abs(q) > 1e-18))"
    step = code(f"return q + h * v * (1 + {wrong}), v - h * q")
    assert result(step, "full_precision").holds is holds
