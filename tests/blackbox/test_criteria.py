"""What is asked, and not answered: a death or a time limit leaves it undecided, a refusal is no one's fault."""

import os
import signal
import time

import pytest

from driftproof import verify
from driftproof.blackbox.criteria import questions_of
from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.broken_steppers import hanging_at
from tests.looping import exactly


def dying_far_from_home(f, t, y, h):
    if t > 1000:
        os._exit(3)
    return codes.rk4(f, t, y, h)


def slow_far_from_home(f, t, y, h):
    time.sleep(20 * (t > 1000))
    return codes.rk4(f, t, y, h)


def stopped_once(f, t, y, h, calls=[]):  # noqa: B006
    """As one that a busy machine, or somebody at a terminal, has stopped."""
    calls.append(t)
    if len(calls) == 300:
        os.kill(os.getpid(), signal.SIGSTOP)
    return codes.rk4(f, t, y, h)


def forwards_only(f, t, y, h):
    if h < 0:
        raise ValueError("h has to be positive")
    return codes.rk4(f, t, y, h)


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "passed", "verdict", "section"), [
    (dying_far_from_home, None, "undecided whether it is rk4: steps elsewhere: the process ended ", "undecided"),
    (slow_far_from_home, None, "undecided whether it is rk4: steps elsewhere: step(t=1004.1, ", "undecided"),
    (stopped_once, None, "undecided whether it is rk4: ", "passed"),
    (forwards_only, True, "is rk4 to roundoff: 50 steps", "not tested"),
])  # fmt: skip
def test_what_a_further_question_comes_to(step, passed, verdict, section):
    report = verify(step, "rk4", examples=50, time_limit=4)
    assert report.passed is passed, report
    assert report.verdict.startswith(verdict), report
    marks = [part.title.rpartition(": ")[2] for part in report.sections if part.title.startswith("Steps ")]
    assert section in marks
    assert bool(report.section("What would decide it")) is (passed is None)


class HangingOnce:
    """A stepper one call of which had not come back, and is not made again: the nth after it was opened."""

    name, by_name = "hanging once", False

    def __init__(self, step, nth):
        self.step, self.nth = step, nth

    def open(self, before, after):
        subject = opened(self.step)
        subject.before = hanging_at(self.nth)
        return subject


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("nth", [0, 1, 12])
@pytest.mark.parametrize(("step", "key"), [(codes.rk4, "rk4"), (codes.velocity_verlet, "velocity_verlet")])
def test_a_call_that_does_not_come_back_refutes_nothing_and_is_no_refusal(step, key, nth):
    method = METHODS[key]
    for question in exactly(13, questions_of(Specification(method), 20)):
        marks = []
        for n in (nth, -1):
            target = HangingOnce(step, n)
            (outcome,) = IsolatedRunner(target, isolate=False).run([question.ask])
            marks.append(question.criterion(method, outcome).mark)
        assert marks[0] in ("undecided", marks[1]), question.title
        assert "FAILED" not in marks
