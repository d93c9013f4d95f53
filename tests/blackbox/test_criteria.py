"""What is asked, and not answered: a death fails, a time limit leaves it undecided, a refusal is no one's fault."""

import os
import signal
import time

import pytest

from driftproof import verify
from tests.blackbox import handwritten_steppers as codes


def dying_far_from_home(f, t, y, h):
    if t > 1000:
        os._exit(3)
    return codes.rk4(f, t, y, h)


def slow_far_from_home(f, t, y, h):
    time.sleep(60 * (t > 1000))
    return codes.rk4(f, t, y, h)


def stopped_once(f, t, y, h, calls=[]):  # noqa: B006
    """As one that a busy machine, or somebody at a terminal, has stopped."""
    calls.append(t)
    if len(calls) == 60:
        os.kill(os.getpid(), signal.SIGSTOP)
    return codes.rk4(f, t, y, h)


def forwards_only(f, t, y, h):
    if h < 0:
        raise ValueError("h has to be positive")
    return codes.rk4(f, t, y, h)


@pytest.mark.parametrize(
    ("step", "passed", "verdict", "section"),
    [
        (
            dying_far_from_home,
            False,
            "is rk4, but not everywhere: crashes: the process ended (exit status 3) ",
            "FAILED",
        ),
        (slow_far_from_home, None, "undecided whether it is rk4: steps elsewhere: step(t=1004.1, ", "undecided"),
        (stopped_once, None, "undecided whether it is rk4: ", "passed"),
        (forwards_only, True, "is rk4 to roundoff: 50 steps", "not asked"),
    ],
)
def test_what_a_further_question_comes_to(step, passed, verdict, section):
    report = verify(step, "rk4", examples=50, time_limit=10)
    assert report.passed is passed, report
    assert report.verdict.startswith(verdict), report
    marks = [part.title.rpartition(": ")[2] for part in report.sections if part.title.startswith("Steps ")]
    assert section in marks
    assert bool(report.section("What would decide it")) is (passed is None)
