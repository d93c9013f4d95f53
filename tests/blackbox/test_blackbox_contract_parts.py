"""The parts of the checks on their own: borders to the float, their names, grains, and steps that keep still."""

import math
from math import inf, nextafter, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driftproof.blackbox.checks.borders import edge, named, negligible_step, rounder
from driftproof.blackbox.checks.quantisation import narrow_format, quantisation_of, significant_bits
from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.checks.trials import CheckResult, Trial, TrialRunner, Unsteady, same, steady_runner
from driftproof.blackbox.findings import Outcome
from driftproof.blackbox.stepper.foreign_stepper import call_text
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from tests.blackbox import planted

BENCH = TrialRunner(opened(planted.plain))
# Halving in magnitude takes 11 tries from one end of the exponents to the other, 52 more the digits; and a round number
# is tried, with its neighbour, at up to 20 of them.
MOST_TRIES = 110


def tries_and_edge(limit, kept, gone, runner=BENCH):
    tried = []

    def changed(x):
        tried.append(x)
        return (x > limit) == (gone > limit)

    return len(tried), edge(changed, kept, gone, runner), tried


@given(st.floats(1e-300, 1e300))
@settings(max_examples=50)
def test_a_border_anywhere_is_found_between_two_neighbours(limit):
    _, (kept, gone), tried = tries_and_edge(limit, 1e-305, 1e305)
    assert (kept, gone) == (limit, nextafter(limit, inf))
    assert len(tried) < MOST_TRIES


@given(st.floats(1e-300, 1e300))
@settings(max_examples=50)
def test_a_border_is_found_downwards_and_below_0(limit):
    assert tries_and_edge(limit, 1e305, 1e-305)[1] == (nextafter(limit, inf), limit)
    assert tries_and_edge(-limit, -1e-305, -1e305)[1] == (nextafter(-limit, 0.0), -limit)


@pytest.mark.parametrize("limit", [0.01, 100.0, 1e-7, 2.4, 1e6, pi, 2 * pi])
def test_a_border_with_a_short_name_is_found_soon(limit):
    _, ends, tried = tries_and_edge(limit, 1e-9, 1e9)
    assert ends[0] == limit
    assert len(tried) < 30


def test_a_border_at_0_is_found_next_to_it():
    assert tries_and_edge(0.0, 0.0, 1.0)[1] == (0.0, 5e-324)


@pytest.mark.parametrize(("fmt", "kind"), [(BINARY32, np.float32), (BINARY16, np.float16)])
def test_neighbours_are_those_of_the_format(fmt, kind):
    runner = TrialRunner(BENCH.subject, fmt)
    kept, gone = tries_and_edge(math.e, 1.0, 1000.0, runner)[1]
    assert kept == float(kind(kept)) < math.e < gone
    assert gone == float(np.nextafter(kind(kept), kind(10)))


def test_hints_are_tried_first_and_left_if_they_are_wrong():
    tried = []

    def changed(x):
        tried.append(x)
        return x > 1 / 3

    right = (1 / 3, nextafter(1 / 3, 1.0))
    assert edge(changed, 0.1, 1.0, BENCH, [right]) == right
    assert len(tried) == 2
    assert edge(changed, 0.1, 1.0, BENCH, [(0.5, nextafter(0.5, 1.0)), (7.0, 8.0)]) == right


@pytest.mark.parametrize(
    ("x", "name"),
    [
        *((100.0, "100"), (0.01, "0.01"), (-2.4, "-2.4"), (1e300, "1e+300"), (0.0, "0"), (-0.0, "0")),
        *((pi, "pi"), (-pi, "-pi"), (2 * pi, "2 pi"), (-pi / 2, "-pi/2")),
        (nextafter(pi, 4.0), "3.1415926535897936"),
        *((float(np.float32(0.1)), "0.1 in binary32"), (float(np.float16(-0.1)), "-0.1 in binary16"), (0.625, "0.625")),
        *((2.0**-1074, "5e-324"), (65536.0, "65536"), (2.0**100, "1.2676506e+30 in binary32")),
    ],
)
def test_numbers_go_by_their_shortest_name(x, name):
    assert named(x) == name


def test_of_two_neighbours_the_one_with_the_shorter_name_is_the_border():
    assert rounder(nextafter(2.4, 3.0), 2.4) == 2.4
    assert rounder(pi, nextafter(pi, 0.0)) == pi
    assert rounder(1.0, 2.0) == 1.0


STATES = [0.7390851332151607, -123.45678901234567, 0.0009876543210987654, 5.551234567890123]


@pytest.mark.parametrize(
    ("rule", "size", "words"),
    [
        (float, None, None),
        (round, 1.0, "answers are whole numbers"),
        (lambda x: round(x, 1), 0.1, "answers are rounded to 1 decimal"),
        (lambda x: round(x, 9), 1e-9, "answers are rounded to 9 decimals"),
        (lambda x: round(x * 2**20) / 2**20, 2.0**-20, "answers are multiples of 2**-20"),
        (lambda x: float(np.float32(x)), None, None),
        (lambda x: float(np.float16(x)), None, None),
    ],
    ids=["doubles", "whole", "1 decimal", "9 decimals", "fixed point", "binary32", "binary16"],
)
def test_a_rule_that_rounds_is_seen_in_the_numbers(rule, size, words):
    grain = quantisation_of([float(rule(x)) for x in STATES])
    assert (grain and grain.size, grain and grain.words) == (size, words)


def test_a_narrower_format_is_seen_in_the_numbers():
    assert narrow_format([float(np.float32(x)) for x in STATES]) is BINARY32
    assert narrow_format([float(np.float16(x)) for x in STATES]) is BINARY16
    assert narrow_format(STATES) is None
    assert narrow_format([1.0, 2.0]) is None
    assert [significant_bits(x) for x in (0.0, 1.0, -0.75, 0.1, 2.0**-1074, 3 * 2.0**1000)] == [0, 1, 2, 52, 1, 2]


@pytest.mark.parametrize(
    ("step", "fmt", "grain"),
    [
        (planted.plain, BINARY64, 0.0),
        (planted.single, BINARY32, 0.0),
        (planted.rounded_to_single, BINARY32, 0.0),
        (planted.six_decimals, BINARY64, 1e-6),
        (planted.fixed_point, BINARY64, 2.0**-16),
        (planted.integers, BINARY64, 1.0),
        (planted.car_in_a_valley, BINARY64, 0.0),
    ],
)
def test_the_bench_sees_what_arithmetic_it_has_on_it(step, fmt, grain):
    runner = steady_runner(opened(step))
    assert (runner.format, runner.grain) == (fmt, grain)


def test_no_bench_is_made_for_answers_that_vary():
    with pytest.raises(Unsteady, match="the same call does not give the same answer again"):
        steady_runner(opened(planted.unrepeatable))
    with pytest.raises(Unsteady):
        steady_runner(opened(planted.Multistep().step))


def test_a_trial_is_made_once():
    subject = opened(planted.plain)
    runner = steady_runner(subject)
    calls = subject.log.calls
    assert runner.trial(1.0, 2.0, 0.5) is runner.trial(1.0, 2.0, 0.5)
    assert subject.log.calls == calls + 1


def test_numbers_are_the_same_with_their_signs_and_as_nan():
    assert same((0.0, math.nan), [0.0, math.nan])
    assert not same((0.0, 1.0), (-0.0, 1.0))
    assert same(None, None)
    assert not same(None, (0.0, 1.0))


def of_lists(f, y, t, h):
    return [y.index(y[0]), *f(y, t)[1:]]


CALLS = {
    "step(1.0, 0.75, 0.25)": planted.plain,
    "step(numpy.array([1.0, 0.75]), 0.25)": lambda state, dt: state,
    "step([1.0, 0.75], 0.25)": lambda y, h: [y.index(y[0]), y[1]],
    "step(0.0, 1.0, 0.75, 0.25)": lambda t, x, v, dt: (x, v),
    "step(q=1.0, v=0.75, h=0.25, k=1.0)": lambda q, v, h, k: (q, k * v),
    "step(lambda q: -q, 1.0, 0.75, 0.25)": lambda force, q, v, h: (q, force(v)),
    "step(lambda t, y: numpy.array([y[1], -y[0]]), numpy.array([1.0, 0.75]), 0.25)": lambda f, y, h: f(0.0, y),
    "step(lambda y, t: [y[1], -y[0]], [1.0, 0.75], 0.0, 0.25)": of_lists,
}


@pytest.mark.parametrize("call", CALLS)
def test_a_call_is_written_as_it_is_made(call):
    assert call_text(opened(CALLS[call]), 1.0, 0.75, 0.25) == call


def test_a_call_is_written_with_the_maker_of_its_numbers():
    subject = opened(planted.plain, array=np.float32)
    assert call_text(subject, 1.0, 0.75, 0.25) == "step(numpy.float32([1.0]), numpy.float32([0.75]), 0.25)"
    of_scalars = opened(planted.pendulum, array=np.float32)
    assert call_text(of_scalars, 1.0, 0.75, 0.25) == "step(numpy.float32(1.0), numpy.float32(0.75), 0.25)"


def test_nan_and_infinity_are_written_as_python_reads_them():
    subject = opened(planted.plain)
    assert call_text(subject, math.nan, -inf, 0.1) == 'step(float("nan"), float("-inf"), 0.1)'


@pytest.mark.parametrize(
    ("step", "slack"),
    [
        (planted.plain, 0.0),
        (planted.car_in_a_valley, 0.0),
        (planted.wrapped, 16 * 2.0**-53),
        (planted.divides_by_h, 0.0),
    ],
)
def test_a_step_that_keeps_still_is_found(step, slack):
    found = negligible_step(steady_runner(opened(step)))
    assert found.slack == slack
    assert found.keeps(found.along(0, found.state[0]))
    assert found.h < 1e-15


def test_a_step_that_is_always_taken_has_no_still_one():
    assert negligible_step(steady_runner(opened(planted.fixed_step))) is None


def test_what_came_is_shown_on_one_line():
    assert Trial("step(1.0)", (1.0, 2.0, 3.0), (0.5, -0.0)).line == "step(1.0) -> (0.5, -0.0)"
    refused = Trial("step(1.0)", (1.0, 2.0, 3.0), failure="raises ValueError: no")
    assert refused.line == "step(1.0) -> raises ValueError: no"
    assert (refused.refusal, refused.finite) == ("it raises ValueError: no", False)


def test_what_does_not_hold_is_a_fault_unless_methods_differ_in_it():
    assert CheckResult("zero_step", False, "").is_fault
    assert not CheckResult("symmetric", False, "").is_fault
    assert not CheckResult("zero_step", None, "").is_fault


def test_outcomes_without_result_are_clauses_of_their_own():
    good, hang = Outcome((CheckResult("zero_step", True, "yes"),)), Outcome(kind="hangs", seen="no answer within 1 s")
    shape, unsteady = Outcome(kind="wrong_shape", seen="3 came out"), Outcome(kind="unsteady", seen="not twice")
    outcomes = [good, hang, shape, unsteady] + [good] * (len(CHECKS) - 4)
    first, second, third, *rest = checks_of(outcomes)
    assert first.key == "zero_step"
    assert (second.key, second.holds, second.words) == (
        "arguments",
        False,
        "arguments: the stepper hangs, no answer within 1 s",
    )
    assert (third.key, third.holds, third.words) == ("types", None, "types: not asked: 3 came out")
    assert rest[-1].words == "nothing else was asked: not twice"
    assert [check.key for check in checks_of([hang] * len(CHECKS))] == ["answers"]
