"""The runner sees what arithmetic a stepper has, makes each trial once, and says what came of it."""

import gc
import math
from dataclasses import replace
from weakref import ref

import numpy as np
import pytest

from driftproof.blackbox.checks import trials
from driftproof.blackbox.checks.arguments import zero_step
from driftproof.blackbox.checks.trials import CheckResult, TrialRunner, Unsteady, same, steady_runner
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
    assert steady_runner(subject) is runner
    assert steady_runner(replace(subject)) is not runner
    gone = ref(subject)
    del subject, runner
    gc.collect()
    assert gone() is None


def test_what_is_raised_is_told_by_its_class_not_by_its_words():
    def refusing(q, v, h):
        if h == 0:
            raise ValueError("h = 0 would be a ZeroDivisionError")
        return habits.plain(q, v, h)

    (result,) = zero_step(opened(refusing))
    assert (result.holds, result.what) == (None, "")


def test_numbers_are_the_same_with_their_signs_and_as_nan():
    assert same((0.0, math.nan), [0.0, math.nan])
    assert not same((0.0, 1.0), (-0.0, 1.0))
    assert same(None, None)
    assert not same(None, (0.0, 1.0))


def test_what_does_not_hold_is_a_fault_unless_methods_differ_in_it():
    assert CheckResult("zero_step", False, "").is_fault
    assert not CheckResult("symmetric", False, "").is_fault
    assert not CheckResult("zero_step", None, "").is_fault


STATES = [0.7390851332151607, -123.45678901234567, 0.0009876543210987654, 5.551234567890123]


RULES = [
    (float, None, None),
    (round, 1.0, "answers are whole numbers"),
    (lambda x: round(x, 1), 0.1, "answers are rounded to 1 decimal"),
    (lambda x: round(x, 9), 1e-9, "answers are rounded to 9 decimals"),
    (lambda x: round(x, 11), 1e-11, "answers are rounded to 11 decimals"),
    (lambda x: round(x, 12), None, None),
    (lambda x: round(x * 2**20) / 2**20, 2.0**-20, "answers are multiples of 2**-20"),
    (lambda x: round(x * 2**40) / 2**40, 2.0**-40, "answers are multiples of 2**-40"),
    (lambda x: round(x * 2**41) / 2**41, None, None),
    (lambda x: float(np.float32(x)), None, None),
    (lambda x: float(np.float16(x)), None, None),
]


@pytest.mark.parametrize(("rule", "size", "words"), RULES, ids=range(len(RULES)))
def test_a_rule_that_rounds_is_seen_in_the_numbers(rule, size, words):
    grain = trials.quantisation_of([float(rule(x)) for x in STATES])
    assert (grain and grain.size, grain and grain.words) == (size, words)


# Of four numbers with so many bits, 20 behind the point, the second says how many a small one has; zeros are left out.
BITS = [((19, 19, 24, 24), None), ((18, 19, 24, 24), None), ((18, 18, 24, 24), 2.0**-20), ((0, 0, 24), None)]


@pytest.mark.parametrize(("bits", "size"), BITS)
def test_small_numbers_with_as_many_bits_as_large_ones_are_those_of_a_format(bits, size):
    grain = trials.quantisation_of([(2**n - 1) * 2.0**-20 for n in bits])
    assert (grain and grain.size) == size
    assert trials.quantisation_of([2.0**23, -(2.0**1000)]) is None  # whole, as every float of such a size
    assert trials.quantisation_of([2.0**23 - 1, -(2.0**40)]).size == 1
    assert (
        trials.quantisation_of([x * 1e5 for x in STATES]) is None
    )  # with eleven decimals, as every float of such a size


def test_a_narrower_format_is_seen_in_the_numbers():
    assert trials.narrow_format([float(np.float32(x)) for x in STATES]) is BINARY32
    assert trials.narrow_format([float(np.float16(x)) for x in STATES]) is BINARY16
    assert trials.narrow_format(STATES) is None
    assert trials.narrow_format([1.0, 2.0]) is None
    numbers = (0.0, 1.0, -0.75, 0.1, 2.0**-1074, 3 * 2.0**1000)
    assert [*map(trials.significant_bits, numbers)] == [0, 1, 2, 52, 1, 2]
