"""What a stepper is compared with: domains and allowances that make no sense are refused."""

from fractions import Fraction
from math import inf, nan

import pytest

from driftproof.blackbox.judging.specification import Allowance, Domain


@pytest.mark.parametrize(
    "bad",
    [
        {"largest_step": 0.25, "smallest_step": 0.25},
        {"largest_state": inf},
        {"largest_step": nan},
        {"smallest_step": -1},
    ],
)
def test_a_domain_without_steps_or_states_is_refused(bad):
    with pytest.raises(ValueError, match="need 0 <= smallest < largest"):
        Domain(**bad)


def test_the_smallest_sizes_are_below_the_largest_if_only_these_are_given():
    assert Domain(largest_step=1e-7).smallest_step == 1e-7 * 2.0**-20
    assert Domain(largest_state=2.0**-61) == Domain(largest_state=2.0**-61, smallest_state=2.0**-121)
    assert Domain(largest_step=0.5).smallest_step == 2.0**-20


@pytest.mark.parametrize("refused", [0.0, -1e-9, inf, nan])
def test_a_tolerance_of_a_solver_is_a_finite_number_above_0(refused):
    with pytest.raises(ValueError, match="a finite number > 0"):
        Allowance(solver_tolerance=refused)


def test_a_tolerance_may_be_text():
    assert Allowance(solver_tolerance="1e-10") == Allowance(solver_tolerance=Fraction(1, 10**10))
    with pytest.raises(ValueError, match="solver_tolerance: 'small' is not a rational number"):
        Allowance(solver_tolerance="small")
