"""Reports on families: what is not read is undecided or no answer, and programs are told what people are."""

import json
import re

import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.solvers.identify_solver import identify_solver
from driftproof.blackbox.verify import verify
from tests.blackbox import broken_steppers
from tests.blackbox.families import turning_steppers as codes
from tests.blackbox.families.remembering_steppers import Remembering
from tests.blackbox.handwritten_steppers import euler
from tests.blackbox.stepper.styles import PAGE, defined
from tests.looping import exactly


def _raising(f, t, y, h):
    raise RuntimeError("no")


def test_a_report_says_what_to_do_and_how_it_was_called():
    report = identify(Remembering("adams_bashforth2", euler).step, isolate=False)
    assert report.section("What to do").lines[0].endswith("--method adams_bashforth2")
    assert report.section("Stepper").lines[0].startswith("step(f, t, y, h)")


def test_a_stepper_that_hangs_is_undecided_and_one_that_raises_gives_no_answer():
    hanging = verify(broken_steppers.hangs, "bdf2", time_limit=1.0)
    assert hanging.passed is None
    assert hanging.section("What would decide it").lines == ("a longer time limit",)
    report = verify(_raising, "bdf2", isolate=False)
    assert report.passed is False
    assert report.verdict.startswith("gives no answer")


def test_two_functions_of_no_known_method_are_said_to_be_none():
    report = identify(lambda f, g, t, y, h: y + h * abs(f(t, y)) * g(t, y), calls="imex", isolate=False)
    assert report.verdict == "it is not a known method: no stage of it has a weight"
    assert json.loads(report.json())["not_answered"][0]["kind"] == "not_readable"


def test_a_stepper_that_is_not_there_is_refused():
    with pytest.raises(ValueError, match="no_such_module:step cannot be imported"):
        verify("no_such_module:step", "ars111", isolate=False)


@pytest.mark.slow
def test_each_example_of_the_page_gets_the_verdict_that_stands_below_it():
    examples = re.findall(r"```python\n([^`]*)```\n\nVerdict: (.*)", PAGE.read_text(encoding="utf-8"))
    for code, verdict in exactly(11, examples):
        ask = identify_solver if code.startswith("def solve(") else identify
        assert ask(defined(code), isolate=False).verdict == verdict


@pytest.mark.parametrize(("step", "verdict"), codes.RIGHT, ids=range(len(codes.RIGHT)))
def test_a_right_step_that_turns_is_named_and_raises_no_alarm(step, verdict):
    report = identify(step, isolate=False)
    assert report.verdict == verdict
    assert report.section("Faults") is None


@pytest.mark.parametrize(("step", "words"), codes.WRONG, ids=range(len(codes.WRONG)))
def test_a_wrong_step_that_turns_is_told_by_its_mistake_alone(step, words):
    report = identify(step, isolate=False)
    lines = report.section("Faults").lines
    assert len(lines) == 1 + (words == "gives h E times 1/2")  # which is one of half the angle, too
    assert words in lines[-1]
    assert lines[-1] in report.verdict
