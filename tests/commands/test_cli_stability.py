"""`driftproof stability`: verdicts as proved beside what runs show, refusals with reasons, the list of problems."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from fractions import Fraction

import pytest

from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.reports.stability import stability_answer, stability_text

Answer = Callable[..., str]


def test_problems_are_listed(answer: Answer) -> None:
    listed = answer("stability")
    assert all(key in listed for key in PROBLEMS)


def test_limits_proved_and_seen_stand_side_by_side(answer: Answer) -> None:
    out = answer("stability", "stiff_oscillator", "--methods", "rk4,symplectic_euler,radau_iia2", "--h", "1/400")
    assert "h <= sqrt(2)/500 = 0.0028284271..." in out
    assert "h < 1/500 = 0.002" in out
    assert "every h > 0" in out


def test_powers_of_ten_are_not_cut_off(answer: Answer) -> None:
    out = answer("stability", "dahlquist_1e6", "--methods", "rk4,forward_euler", "--h", "1/4")
    assert "h <= 2.7852935634...e-6" in out
    assert "h <= 1/500000 = 2e-6" in out


def test_a_factor_close_to_one_says_on_which_side_it_is(answer: Answer) -> None:
    """|R|^2 is 1 - 10^-12/72 + ... for RK4 at 1/100, and (27/50)^2 + (101/120)^2 for Dormand and Prince's at 1."""
    keys = "rk4,dormand_prince54,velocity_verlet"
    out = answer("stability", "harmonic_oscillator", "--methods", keys, "--h", "1/100", "--h", "1")
    rows = {tuple(line.split()[:3]): line for line in out.splitlines()}
    assert "yes       1 - 6.9e-15" in rows["rk4", "0.01", "1000"]
    assert "no        1 + 1.4e-6" in rows["dormand_prince54", "1", "10"]
    assert "yes       1.00000" in rows["velocity_verlet", "1", "10"]


def test_a_run_that_ends_well_by_luck_does_not_follow(answer: Answer) -> None:
    """Backward Euler's one step ends close enough; what 512 steps meet at the jump, Newton's method does not solve."""
    found = json.loads(
        answer("stability", "van_der_pol_1e3", "--methods", "backward_euler", "--h", "2", "--format", "json")
    )
    (entry,) = found["methods"]
    assert not entry["runs"][0]["lost"]
    assert entry["fewest_steps"] is None


def test_a_run_that_has_come_to_rest_does_not_follow_a_pendulum(answer: Answer) -> None:
    keys = "backward_euler,rk4"
    found = json.loads(answer("stability", "pendulum", "--methods", keys, "--h", "20", "--format", "json"))
    damped, right = found["methods"]
    assert not damped["runs"][0]["lost"]  # no error is larger than the solution
    assert damped["fewest_steps"] is None
    assert right["fewest_steps"] < 64


def test_a_step_that_is_not_solved_is_named_in_a_few_words(answer: Answer) -> None:
    out = answer("stability", "robertson", "--methods", "radau_iia2", "--h", "1000000000")
    assert "ends at step 1: not solved after 128 iterations" in out
    assert "residual" not in out


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
            assert run["lost"] is not run["bounded"], (entry["method"], run["h"])
    assert verdicts == {True, False}


def test_a_non_finite_run_is_never_silent(answer: Answer) -> None:
    found = json.loads(answer("stability", "prothero_robinson", "--methods", "rk4", "--h", "1/10", "--format", "json"))
    (run,) = found["methods"][0]["runs"]
    assert run["failed_after"] == 17
    assert run["error"] is None
    assert run["lost"]


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


def test_errors_stand_beside_the_size_of_the_solution(answer: Answer) -> None:
    """On q'' = -10^6 q from (1, 0) the velocity is up to 1000; at t = 10 it is 305.6, of which nothing is left."""
    out = answer("stability", "stiff_oscillator", "--methods", "backward_euler", "--h", "1/100")
    (size,) = re.findall(r"which at the times of its reference reaches (\d+)$", out, re.MULTILINE)
    assert 900 < int(size) <= 1000
    assert "error 306\n" in out


def test_problems_are_listed_in_json_too(answer: Answer) -> None:
    listed = {entry["problem"]: entry for entry in json.loads(answer("stability", "--format", "json"))}
    assert list(listed) == list(PROBLEMS)
    kinds = {name: listed["stiff_oscillator"][name] for name in ("linear", "stiff", "second_order")}
    assert kinds == {"linear": True, "stiff": True, "second_order": True}


def test_steps_and_methods_may_be_listed_or_their_options_repeated(answer: Answer) -> None:
    listed = answer("stability", "kaps", "--methods", "rk4, heun2", "--h", "1/10,1/20")
    assert listed == answer("stability", "kaps", "--methods", "rk4", "--methods", "heun2", "--h", "1/10", "--h", "1/20")


def test_a_state_too_far_from_the_solution_for_floats_is_lost_and_no_crash() -> None:
    found = stability_answer(PROBLEMS["dahlquist_1e3"], ["rk4"], [])
    found["methods"][0]["runs"][0] |= {"failed_after": None, "error": None, "lost": True}
    assert "finite at t, but farther from the solution than floats tell: lost" in stability_text(found)
