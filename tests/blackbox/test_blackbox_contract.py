"""Each planted habit is told in words with its threshold, and clean steppers have no fault."""

import json
import random
import warnings
from math import nextafter

import numpy as np
import pytest

from driftproof.blackbox.checks.suite import CHECKS, all_checks
from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.steppers import float_stepper
from tests.blackbox import planted


def checks_of(step, **how):
    return all_checks(IsolatedRunner(Target(step, **how), isolate=False))


def check(step, key):
    return next(check for check in checks_of(step) if check.key == key)


def identified(value):
    return getattr(value, "__qualname__", None)


FAULTS = [
    (planted.speed_capped, "velocity_range", "|v| is capped at 100"),
    (planted.speed_capped_before, "velocity_range", "|v| is capped at 100"),
    (planted.car_in_a_valley, "position_range", "q beyond 0.6 becomes 0.6; q below -1.2 becomes -1.2"),
    (planted.car_in_a_valley, "velocity_range", "|v| is capped at 0.07"),
    (planted.floor, "position_range", "q below 0 becomes 0"),
    (planted.stop, "position_range", "with q beyond 3 the state jumps to (3.0, 0.0)"),
    (planted.wrapped, "position_range", "with q below -pi the state is changed at once: (-3.14"),
    (planted.wrapped_from_zero, "position_range", "with q from 2 pi on the state is changed at once"),
    (planted.wrapped_once, "position_range", "with |q| beyond pi the state is changed at once"),
    (planted.episode, "position_range", "with |q| beyond 2.4 the state jumps to (0.05, 0.0)"),
    (planted.wall, "position_range", "with q below 0 the state is changed at once"),
    (planted.drained, "position_range", "the state is changed at once: (5.0, 0.375) becomes (4.98"),
    (planted.slow_speeds_rest, "small_states", "|v| below 0.01 becomes 0"),
    (planted.small_states_rest, "small_states", "becomes (0.0, 0.0)"),
    (planted.squares, "large_states", "overflows from q = 1.341e+154 on, where the answer is far from too large"),
    (planted.flushes, "subnormals", "subnormal numbers become 0: q below 2.37e-308"),
    (planted.wrapped_pendulum, "small_digits", "small states lose digits: the error stays at up to 4e-16"),
    (planted.divides_by_size, "rest", "(0, 0) has no answer: (nan, nan)"),
    (planted.divides_by_h, "zero_step", "h = 0 is divided by: it raises ZeroDivisionError"),
    (planted.divides_arrays_by_h, "zero_step", "h = 0 is divided by: (1.0, nan) comes back"),
    (planted.fixed_step, "zero_step", "h = 0 moves the state: (1.0, 0.75) becomes (1.0122222222222221, 0.73333333333"),
    (planted.absolute_step, "negative_step", "h < 0 acts as |h|"),
    (planted.no_negative_step, "negative_step", "h < 0 does nothing: the state comes back"),
    (planted.fixed_step, "step_size", "h is ignored: the step by which (0, 1) moves by 1/60 is always taken"),
    (planted.fixed_step_of_a_force, "step_size", "h is ignored: a step of 1/240 is always taken"),
    (planted.capped_step, "step_size", "h is capped at 0.1"),
    (planted.raised_step, "step_size", "h is raised to 0.0001"),
    (
        planted.counted_steps,
        "step_size",
        "h below 0.01 does nothing; h is taken in whole steps: every h from 0.25 to 0.26",
    ),
    (planted.sub_steps, "sub_steps", "above h = 0.05 it takes sub-steps"),
    (planted.sub_steps_of_a_force, "sub_steps", "above h = 0.05 it takes sub-steps: 1 of its force calls become 2"),
    (planted.integers, "returns", "returns integers: at h = 0, (1.0, 0.75) becomes (1.0, 0.0)"),
    (planted.integers, "full_precision", "answers are whole numbers"),
    (planted.integer_storage, "takes_integers", "integers cut the answer off: (3.0625, 0.25) becomes (3.0, 0.0)"),
    (planted.six_decimals, "full_precision", "answers are rounded to 6 decimals"),
    (planted.fixed_point, "full_precision", "answers are multiples of 2**-16"),
    (planted.single, "full_precision", "answers are rounded to binary32"),
    (planted.rounded_to_single, "full_precision", "answers are rounded to binary32"),
    (planted.single_inside, "full_precision", "S(3z) is 3 S(z) to about 26 bits only"),
    (planted.single_inside, "large_states", "overflows from q = 3.403e+38 on"),
    (planted.adds_into_its_arguments, "keeps_arguments", "given arrays, it changes its arguments, besides returning"),
    (planted.own_buffer, "keeps_answers", "an answer is overwritten by the next"),
    (planted.repairs_nan, "not_a_number", 'step(float("nan"), 0.75, 0.25) -> (0.0, 0.0)'),
    (planted.repairs_nan, "not_a_number_step", "h = NaN goes in and ordinary numbers come out"),
    (planted.repairs_infinity, "infinity", "an infinity goes in and ordinary numbers come out"),
    (planted.Multistep().step, "no_memory", "the answer depends on the call before"),
    (planted.SharedMultistep().step, "own_memory", "a second object shares the memory"),
    (planted.Counter().step, "same_answer_twice", "every call changes something that it remembers"),
    (planted.unrepeatable, "same_answer_twice", "noise, or something that it remembers outside"),
    (planted.clocked, "time", "the answer depends on t: from the same state, t = 0 gives"),
    (
        planted.told_another_time,
        "time",
        "the right-hand side is told another time: from t = 8.0 with h = 0.25 it is asked",
    ),
]


@pytest.mark.parametrize(
    ("step", "key", "words"), FAULTS, ids=lambda value: getattr(value, "__name__", str(value)[:20])
)
def test_a_planted_fault_is_told_in_words(step, key, words):
    seen = check(step, key)
    assert seen.is_fault
    assert words in seen.words


ALL_FAULTS = [
    (planted.car_in_a_valley, {"position_range", "velocity_range", "not_a_number", "not_a_number_step", "infinity"}),
    (planted.speed_capped, {"velocity_range"}),
    (planted.slow_speeds_rest, {"small_states"}),
    (planted.capped_step, {"step_size"}),
    (planted.sub_steps, {"sub_steps"}),
    (planted.divides_by_h, {"zero_step"}),
    (planted.absolute_step, {"negative_step"}),
    (planted.single, {"full_precision"}),
    (planted.six_decimals, {"full_precision", "small_digits"}),
    (planted.adds_into_its_arguments, {"keeps_arguments"}),
    (planted.own_buffer, {"keeps_answers"}),
    (planted.floor, {"position_range"}),
    (planted.wrapped, {"position_range", "small_digits"}),
    (planted.pendulum, set()),
    (planted.falls, set()),
    (planted.iterates, set()),
    (planted.positive_steps_only, set()),
]


@pytest.mark.parametrize(("step", "keys"), ALL_FAULTS, ids=identified)
def test_a_planted_fault_is_told_and_no_other(step, keys):
    assert {seen.key for seen in checks_of(step) if seen.is_fault} == keys


OPEN = [
    (planted.fenced, "position_range", "|q| from 10 on is refused: it raises ValueError: out of range"),
    (planted.positive_steps_only, "zero_step", "h = 0 is refused: it raises ValueError: h must be positive"),
    (planted.positive_steps_only, "negative_step", "h < 0 is refused: it raises ValueError: h must be positive"),
    (planted.iterates, "sub_steps", "it iterates, or adapts a step of its own"),
    (planted.falls, "rest", "(0, 0) does not stay at rest, it goes to (0.0, -2.4525)"),
    (planted.pendulum, "infinity", "an infinity is refused: it raises ValueError"),
]


@pytest.mark.parametrize(("step", "key", "words"), OPEN, ids=identified)
def test_a_refusal_is_no_fault_and_said(step, key, words):
    seen = check(step, key)
    assert seen.holds is None
    assert words in seen.words


TRAITS = [
    ("forward_euler", "symmetric", False, "S(-h) undoes S(h) up to a defect of 0.063 at h = 1/4 that falls as h**2"),
    ("forward_euler", "area_preserving", False, "areas grow by the factor 1.0625 in a step of h = 1/4"),
    ("forward_euler", "norm_preserving", False, "q**2 + v**2 grows by the factor 1.0625 in a step of h = 1/4"),
    ("symplectic_euler", "symmetric", False, "that falls as h**2"),
    ("symplectic_euler", "area_preserving", True, "areas are kept, to rounding"),
    ("symplectic_euler", "norm_preserving", False, "depending on the state"),
    ("rk4", "reversible", False, "up to a defect of 3.4e-06 at h = 1/4 that falls as h**6"),
    ("rk4", "area_preserving", False, "areas shrink by the factor 0.9999966356"),
    ("velocity_verlet", "symmetric", True, "S(-h) undoes S(h), to rounding"),
    ("velocity_verlet", "reversible", True, "a step with the velocity turned round undoes a step, to rounding"),
    ("prince_dormand87", "area_preserving", False, "areas grow by the factor 1.000000028 in a step of h = 1"),
]


@pytest.mark.parametrize(("method", "key", "holds", "words"), TRAITS)
def test_a_trait_of_a_method_is_seen(method, key, holds, words):
    seen = check(float_stepper(method), key)
    assert (seen.holds, seen.is_fault) == (holds, False)
    assert words in seen.words


NONLINEAR = [
    (planted.pendulum, "nonlinear: at q = 0.739 it departs from proportionality by 0.024"),
    (planted.wrapped_pendulum, "nonlinear: at q = 2.96 it departs from proportionality by 0.23"),
    (planted.force_limited, "linear up to q = 10 and no further; linear up to q = -10 and no further"),
    (planted.speed_capped_at_60_hertz, "linear up to v = 100 and no further; linear up to v = -100 and no further"),
    (planted.falls, "not proportional to the state, since (0, 0) moves"),
    (planted.one_sided, "not linear: S(-z) is not -S(z)"),
    (planted.coupled, "not linear: S(q, v) is not S(q, 0) + S(0, v)"),
]


@pytest.mark.parametrize(("step", "words"), NONLINEAR, ids=identified)
def test_a_nonlinear_step_is_told_from_one_that_is_cut_off(step, words):
    seen = check(step, "linear")
    assert seen.holds is False
    assert words in seen.words
    assert not seen.is_fault


def test_a_linear_step_with_a_domain_is_linear_in_it():
    seen = check(planted.speed_capped, "linear")
    assert (seen.holds, seen.words) == (True, "linear within its domain, to rounding")


CLEAN = {key: float_stepper(key) for key in ("forward_euler", "symplectic_euler", "rk4", "velocity_verlet", "yoshida8")}
CLEAN |= {"called as a map": planted.plain, "called with a field": planted.told_the_time}


@pytest.mark.parametrize("step", CLEAN.values(), ids=CLEAN)
def test_a_clean_stepper_has_no_fault_and_leaves_no_question_open(step):
    traits = {"symmetric", "reversible", "area_preserving", "norm_preserving"}
    found = checks_of(step)
    assert [seen.words for seen in found if not seen.holds and seen.key not in traits] == []
    assert len({seen.key for seen in found}) == len(found) >= len(CHECKS)


def test_no_explicit_method_of_the_catalogue_has_a_fault():
    explicit = [key for key, method in METHODS.items() if method.explicit]
    assert [key for key in explicit[::3] for seen in checks_of(float_stepper(key)) if seen.is_fault] == []


def test_the_same_clauses_hold_in_binary32_with_arrays_of_that_type():
    found = checks_of(planted.plain, array=np.float32)
    assert [seen.words for seen in found if seen.is_fault] == []
    assert "returns float32" in [seen.words for seen in found]


@pytest.mark.parametrize(
    ("step", "words"),
    [
        (planted.speed_capped, "|v| is capped at 100"),
        (planted.force_limited, "linear up to q = 10 and no further"),
        (planted.pendulum, "nonlinear: at q = 0.739 it departs from proportionality by 0.024"),
        (planted.slow_speeds_rest, "|v| below 0.01 in binary32 becomes 0"),
        (planted.episode, "with |q| beyond 2.4 in binary32 the state jumps to (0.05, 0.0)"),
    ],
    ids=identified,
)
def test_habits_are_told_in_binary32_as_in_binary64(step, words):
    assert any(words in seen.words for seen in checks_of(step, array=np.float32))


@pytest.mark.parametrize("step", [*CLEAN.values(), planted.pendulum, planted.speed_capped], ids=[*CLEAN, "bent", "cap"])
def test_all_checks_take_a_few_hundred_calls(step):
    calls = []
    with warnings.catch_warnings(action="ignore"):
        subject = Target(step).open(calls.append)
        for check in CHECKS.values():
            check(subject)
    assert 300 < len(calls) < 500


BORDERS = [
    (planted.speed_capped, "velocity_range", 1, 100.0),
    (planted.car_in_a_valley, "position_range", 0, 0.6),
    (planted.episode, "position_range", 0, 2.4),
    (planted.wrapped_once, "position_range", 0, np.pi),
    (planted.slow_speeds_rest, "small_states", 1, 0.01),
]


@pytest.mark.parametrize(("step", "key", "component", "limit"), BORDERS)
def test_a_border_is_found_to_the_float(step, key, component, limit):
    kept, beyond = (trial.given[component] for trial in check(step, key).example[:2])
    assert kept == limit
    assert beyond in (nextafter(limit, 0.0), nextafter(limit, np.inf))


@pytest.mark.parametrize("limit", [random.Random(seed).lognormvariate(0, 30) for seed in range(6)])
def test_a_cap_of_any_size_is_found_to_the_float(limit):
    def capped(q, v, h):
        q, v = planted.plain(q, v, h)
        return q, planted.bounded(v, -limit, limit)

    seen = check(capped, "velocity_range" if limit > 1e-3 else "domain")
    assert seen.words.startswith(f"|v| is capped at {limit!r}" if limit > 1e-3 else "not asked: there is no step")


REPEATED = [
    row[:2] for row in FAULTS if row[0] in (planted.speed_capped, planted.wall, planted.wrapped, planted.squares)
]
REPEATED += [(planted.capped_step, "step_size"), (planted.flushes, "subnormals"), (planted.repairs_nan, "not_a_number")]
REPEATED += [(CLEAN["rk4"], "symmetric"), (CLEAN["rk4"], "large_states"), (planted.told_the_time, "area_preserving")]


@pytest.mark.parametrize(("step", "key"), REPEATED, ids=identified)
def test_the_call_of_an_example_made_again_has_the_same_answer(step, key):
    example = check(step, key).example
    assert example
    for trial in example:
        again = eval(trial.call, {"step": step, "numpy": np})
        assert list(map(repr, map(float, again))) == list(map(repr, trial.answer))


def test_clauses_are_json_with_numbers_as_strings():
    seen = check(planted.speed_capped, "velocity_range").as_dict()
    assert json.loads(json.dumps(seen, allow_nan=False)) == seen
    assert seen["example"][0] == {
        "call": "step(0.3125, 100.0, 5e-324)",
        "given": {"q": "0.3125", "v": "100.0", "h": "5e-324"},
        "answer": ["0.3125", "100.0"],
        "failure": None,
    }
    nan = check(planted.repairs_nan, "not_a_number").as_dict()
    assert nan["example"][0]["given"]["q"] == "nan"


def test_of_an_unsteady_stepper_nothing_else_is_asked():
    keys = [seen.key for seen in checks_of(planted.unrepeatable)]
    assert keys == ["same_answer_twice", "no_memory", "unsteady"]


def test_random_numbers_of_everybody_are_put_back():
    random.seed(7)
    expected = [random.random(), random.random()]
    random.seed(7)
    random.random()
    checks_of(planted.unrepeatable)
    assert random.random() == expected[1]
