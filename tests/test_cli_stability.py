"""`driftproof stability`: verdicts as proved beside what runs show, refusals with reasons, the list of problems."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction

import pytest

from numeric.problems.catalogue import PROBLEMS

Answer = Callable[..., str]


def test_problems_are_listed(answer: Answer) -> None:
    listed = answer("stability")
    assert all(key in listed for key in PROBLEMS)


def test_limits_proved_and_seen_stand_side_by_side(answer: Answer) -> None:
    out = answer("stability", "stiff_oscillator", "--methods", "rk4,symplectic_euler,radau_iia2", "--h", "1/400")
    assert "h <= sqrt(2)/500 = 0.0028284271..." in out
    assert "h < 1/500 = 0.002" in out
    assert "every h > 0" in out


def test_verdict_is_of_the_double_that_is_run(answer: Answer) -> None:
    found = json.loads(
        answer("stability", "dahlquist_1e3", "--methods", "forward_euler", "--h", "1/500", "--format", "json")
    )
    (run,) = found["methods"][0]["runs"]
    assert Fraction(float(run["h"])) > Fraction(1, 500)  # the double nearest to 1/500 is above it
    assert run["bounded"] is False
    assert found["methods"][0]["attained"] is True


def test_every_method_does_what_is_proved(answer: Answer) -> None:
    """Where the powers are bounded the run ends within the solution's size or its transient; else it leaves it."""
    keys = "forward_euler,rk4,backward_euler,implicit_midpoint,radau_iia2,sdirk2,gauss2"
    found = json.loads(answer("stability", "dahlquist_1e3", "--methods", keys, "--format", "json"))
    verdicts = set()
    for entry in found["methods"]:
        for run in entry["runs"]:
            verdicts.add(run["bounded"])
            assert run["follows"] is run["bounded"], (entry["method"], run["h"])
    assert verdicts == {True, False}


def test_a_non_finite_run_is_never_silent(answer: Answer) -> None:
    found = json.loads(answer("stability", "prothero_robinson", "--methods", "rk4", "--h", "1/10", "--format", "json"))
    (run,) = found["methods"][0]["runs"]
    assert run["failed_after"] == 17
    assert run["error"] is None
    assert not run["follows"]


def test_a_method_that_does_not_apply_says_why(answer: Answer) -> None:
    out = answer("stability", "dahlquist_1", "--methods", "rk4,symplectic_euler")
    assert "symplectic_euler does not apply: " in out


@pytest.mark.parametrize("key", PROBLEMS)
def test_every_problem_is_answered(answer: Answer, key: str) -> None:
    assert PROBLEMS[key].title in answer(
        "stability", key, "--methods", "backward_euler", "--h", str(PROBLEMS[key].t / 8)
    )


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["stability", "kepler_09"], "did you mean kepler"),
        (["stability", "kepler", "--methods", "rk5"], "unknown method 'rk5'"),
        (["stability", "kepler", "--h", "3/7"], "3/7"),
        (["stability", "kepler", "--h", "1/10000000"], "at most 1000000 are run here"),
    ],
)
def test_bad_questions_get_one_line(
    run: Callable[..., tuple[int, str, str]], arguments: list[str], complaint: str
) -> None:
    status, out, err = run(*arguments)
    assert (status, out) == (2, "")
    assert complaint in err
    assert err.count("\n") == 1
