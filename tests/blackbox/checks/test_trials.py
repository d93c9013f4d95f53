"""The runner sees what arithmetic a stepper has, makes each trial once, and says what came of it."""

import math

import pytest

from driftproof.blackbox.checks.trials import CheckResult, Trial, TrialRunner, Unsteady, same, steady_runner
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from tests.blackbox.checks import habits


@pytest.mark.parametrize(
    ("step", "fmt", "grain"),
    [
        (habits.plain, BINARY64, 0.0), (habits.SINGLE, BINARY32, 0.0), (habits.ROUNDED_TO_SINGLE, BINARY32, 0.0),
        (habits.SIX_DECIMALS, BINARY64, 1e-6), (habits.FIXED_POINT, BINARY64, 2.0**-16),
        (habits.INTEGERS, BINARY64, 1.0), (habits.CAR_IN_A_VALLEY, BINARY64, 0.0),
    ],
)  # fmt: skip
def test_the_arithmetic_of_a_stepper_is_seen(step, fmt, grain):
    runner = steady_runner(opened(step))
    assert (runner.format, runner.grain) == (fmt, grain)


def test_so_much_counts_as_rounding_as_a_format_and_a_grain_leave():
    runners = TrialRunner(None), TrialRunner(None, BINARY16), TrialRunner(None, grain=1.0)
    assert [runner.rounding for runner in runners] == [1024 * 2.0**-53, 2.0**-5, 1024 * 2.0**-53 + 4.0]


# A state of ordinary size is (0.739, 0.567).
@pytest.mark.parametrize(("limit", "size"), [(0.74, 1), (0.3, 0.125), (0.012, 2.0**-6), (0.0015, 2.0**-9), (1e-3, 1.0)])
def test_states_are_small_enough_for_a_limit_that_only_a_step_of_zero_shows(limit, size):
    def limited(q, v, h):
        if 0 < abs(h) < 1e-200:
            raise ValueError("the step is too short")
        return max(-limit, min(limit, q + h * v)), v - h * q

    assert steady_runner(opened(limited)).size == size


def test_no_trials_are_made_of_answers_that_vary():
    with pytest.raises(Unsteady, match="the same call does not give the same answer again"):
        steady_runner(opened(habits.UNREPEATABLE))
    with pytest.raises(Unsteady):
        steady_runner(opened(habits.Multistep().step))


def test_a_trial_is_made_once():
    subject = opened(habits.plain)
    runner = steady_runner(subject)
    calls = subject.log.calls
    assert runner.trial(1.0, 2.0, 0.5) is runner.trial(1.0, 2.0, 0.5)
    assert subject.log.calls == calls + 1


def test_numbers_are_the_same_with_their_signs_and_as_nan():
    assert same((0.0, math.nan), [0.0, math.nan])
    assert not same((0.0, 1.0), (-0.0, 1.0))
    assert same(None, None)
    assert not same(None, (0.0, 1.0))


def test_what_came_is_shown_on_one_line():
    assert Trial("step(1.0)", (1.0, 2.0, 3.0), (0.5, -0.0)).line == "step(1.0) -> (0.5, -0.0)"
    refused = Trial("step(1.0)", (1.0, 2.0, 3.0), failure="raises ValueError: no")
    assert refused.line == "step(1.0) -> raises ValueError: no"
    assert (refused.refusal, refused.finite) == ("it raises ValueError: no", False)


def test_what_does_not_hold_is_a_fault_unless_methods_differ_in_it():
    assert CheckResult("zero_step", False, "").is_fault
    assert not CheckResult("symmetric", False, "").is_fault
    assert not CheckResult("zero_step", None, "").is_fault
