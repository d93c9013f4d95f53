"""All checks together: a planted habit is told and no other, clean steppers have no fault, examples can be run."""

import json
import math
import warnings

import numpy as np
import pytest

from driftproof.blackbox.checks.suite import CHECKS, checks_of
from driftproof.blackbox.checks.trials import CheckResult
from driftproof.blackbox.findings import NO_EVIDENCE, Outcome
from driftproof.blackbox.isolation import Serving
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.steppers import float_stepper
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.checks import habits
from tests.blackbox.checks.edges import EDGES, EDGES_IN_BINARY32
from tests.blackbox.transcripts import Asked, checksum
from tests.looping import some

CLEAN = {key: float_stepper(key) for key in ("forward_euler", "symplectic_euler", "rk4", "velocity_verlet", "yoshida8")}
CLEAN |= {"called as a map": habits.plain, "called with a field": habits.TOLD_THE_TIME}


@pytest.mark.parametrize("step", CLEAN.values(), ids=CLEAN)
def test_a_clean_stepper_has_no_fault_and_leaves_no_question_open(step):
    traits = {"symmetric", "reversible", "area_preserving", "norm_preserving"}
    found = habits.results_of(step)
    assert [seen.words for seen in found if not seen.holds and seen.key not in traits] == []
    assert len({seen.key for seen in found}) == len(found) >= len(CHECKS)


@pytest.mark.slow
def test_no_explicit_method_of_the_catalogue_has_a_fault():
    explicit = some([key for key, method in METHODS.items() if method.explicit][::3], 27)
    assert [key for key in explicit for seen in some(habits.results_of(float_stepper(key))) if seen.is_fault] == []


@pytest.mark.parametrize("step", [*CLEAN.values(), habits.PENDULUM, habits.SPEED_CAPPED], ids=[*CLEAN, "bent", "cap"])
def test_all_checks_take_a_few_hundred_calls(step):
    calls = []
    with warnings.catch_warnings(action="ignore"):
        subject = Target(step).open(calls.append)
        for check in CHECKS.values():
            check(subject)
    assert 300 < len(calls) < 500


REPEATED = [
    (habits.SPEED_CAPPED, "velocity_range"), (habits.WRAPPED, "position_range"), (habits.CAPPED_STEP, "step_size"),
    (habits.REPAIRS_NAN, "not_a_number"), (CLEAN["rk4"], "symmetric"), (CLEAN["rk4"], "large_states"),
    (habits.TOLD_THE_TIME, "area_preserving"),
]  # fmt: skip


@pytest.mark.parametrize(("step", "key"), REPEATED, ids=habits.identified)
def test_the_call_of_an_example_made_again_has_the_same_answer(step, key):
    example = habits.result(step, key).example
    assert example
    for trial in example:
        again = eval(trial.call, {"step": step, "numpy": np})
        assert list(map(repr, map(float, again))) == list(map(repr, trial.answer))


def test_clauses_are_json_with_numbers_as_strings():
    seen = habits.result(habits.SPEED_CAPPED, "velocity_range").as_dict()
    assert json.loads(json.dumps(seen, allow_nan=False)) == seen
    assert seen["example"][0] == {
        "call": "step(0.3125, 100.0, 5e-324)", "given": {"q": "0.3125", "v": "100.0", "h": "5e-324"},
        "answer": ["0.3125", "100.0"], "failure": None,
    }  # fmt: skip
    nan = habits.result(habits.REPAIRS_NAN, "not_a_number").as_dict()
    assert nan["example"][0]["given"]["q"] == "nan"


def test_a_step_without_an_answer_from_some_states_is_not_called_linear():
    seen = habits.result(lambda q, v, h: (q + h * v + 0 * math.sqrt(q), v - h * q), "linear")
    call = "step(-0.7390851332151607, 0.0, 0.25)"
    assert (seen.holds, seen.words) == (None, f"not tested everywhere: {call} -> raises ValueError: math domain error")


def test_outcomes_without_result_are_clauses_of_their_own():
    good, crash = Outcome((CheckResult("zero_step", True, "yes"),)), Outcome(kind="crashes", seen="exit status 3")
    shape, unsteady = Outcome(kind="wrong_shape", seen="3 came out"), Outcome(kind="unsteady", seen="not twice")
    outcomes = [good, crash, shape, unsteady] + [good] * (len(CHECKS) - 4)
    first, second, third, *rest = checks_of(outcomes)
    assert (second.is_fault, second.words) == (True, "arguments: the stepper crashes, exit status 3")
    assert first.key == "zero_step"
    assert (third.key, third.holds, third.words) == ("arguments", None, "arguments: undecided: the stepper crashes")
    assert rest[0].words == "types: not tested: 3 came out"
    assert rest[-1].words == "nothing else was tested: not twice"
    assert [(check.key, check.holds) for check in checks_of([crash] * len(CHECKS))] == [("answers", False)]


# A call, or the end of calls, that does not come back; the questions that it leaves open, by the check that asks them.
HANGING = {
    "q=0.7390851332151607, v=0.5671432904097838, h=0.2": set(CHECKS) - {"time_argument"},
    "q=[1.0, -0.625, 0.1], v=[0.75, 0.25, -1.3], h=0.2": {"several_states"},
    "q=3, v=1, h=0.25": {"types"}, "q=3.0, v=1.0, h=0.25": {"types"},
    f"q={1000 * 0.7390851332151607!r}, v={10 * 0.5671432904097838!r}, h=0.2": {"digits"},
    "h=0.0": {"zero_step"}, "h=-0.25": {"negative_step", "reversal"}, "h=-1.0": {"reversal"}, "h=16.0": {"step_size"},
    "q=0.7390851332151607, v=0.5671432904097838, h=8.0": {"sub_steps"},
    "h=5e-324": set(), "q=0.625, v=0.375, h=5e-324": {"domain"}, "q=0.0, v=0.0, h=0.25": {"area", "homogeneity"},
    "q=nan, v=0.75, h=0.25": {"not_a_number"}, "q=-inf, v=0.75, h=0.25": {"infinity"}, "h=nan": {"not_a_number_step"},
}  # fmt: skip


@pytest.mark.parametrize("hung", HANGING)
def test_a_call_that_hangs_leaves_its_question_open_and_is_nobodys_refusal(hung):
    serving = Serving(Target(habits.plain), list(CHECKS.values()), hung=[hung])
    outcomes = [serving.outcome(index) for index in range(len(CHECKS))]
    kinds = {key: outcome.kind for key, outcome in zip(CHECKS, outcomes, strict=True) if outcome.failed}
    assert kinds == dict.fromkeys(HANGING[hung], "time_limit")
    assert [check.words for check in checks_of(outcomes) if check.is_fault or "refused" in check.words] == []


@pytest.mark.parametrize("kind", NO_EVIDENCE)
def test_a_limit_an_end_from_outside_and_a_mistake_of_ours_leave_a_question_open(kind):
    silent, good = Outcome(kind=kind, seen="why"), Outcome((CheckResult("zero_step", True, "yes"),))
    (found, *_) = checks_of([silent] + [good] * (len(CHECKS) - 1))
    assert (found.key, found.holds, found.words) == ("repeats", None, "repeats: undecided: why")
    assert [(check.key, check.holds) for check in checks_of([silent] * len(CHECKS))] == [("answers", None)]


def said_of(step, **how):
    return [
        line
        for seen in habits.results_of(step, **how)
        for line in (f"{seen.key} {seen.holds}: {seen.words}", *(f"    {trial.line}" for trial in seen.example))
    ]


ORDINARY = set(said_of(habits.plain))
HABITS = {name: step for name, step in vars(habits).items() if name.isupper() and callable(step)} | {
    "plain": habits.plain
}
HABITS |= {f"the {name} of others": vars(codes)[name] for name in ("rk4", "velocity_verlet", "rk4_in_lists")}
UNREPEATABLE = HABITS.pop("UNREPEATABLE")
HABITS |= habits.RULES | EDGES | EDGES_IN_BINARY32


IN_BINARY32 = ("plain", "SPEED_CAPPED", "SLOW_SPEEDS_REST", "EPISODE", "WRAPPED", "FORCE_LIMITED", "PENDULUM")
IN_BINARY32 += ("SUB_STEPS", "ITERATES", "the rk4 of others")


@pytest.mark.slow(keep=4)
@pytest.mark.parametrize(
    ("name", "array"),
    [*((name, None) for name in HABITS), *((name, np.float32) for name in (*IN_BINARY32, *EDGES_IN_BINARY32))],
)
def test_all_that_is_asked_and_said_of_a_planted_habit_is_as_before(name, array, as_before):
    asked = Asked(HABITS[name])
    said = [line for line in said_of(asked.code, array=array) if line not in ORDINARY or name == "plain"]
    if array is None and name in IN_BINARY32:
        as_before(*said, asked)
    else:
        examples = "\n".join(line for line in said if line.startswith(" "))
        as_before(*(line for line in said if not line.startswith(" ")), checksum(examples), asked)
