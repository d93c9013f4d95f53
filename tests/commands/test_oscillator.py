"""`driftproof step`, `run` and `roundoff`: answers to the letter, exact fractions of any size, undefined as null."""

import json

import pytest

STEP = """\
Classical RK4 (rk4): one step of h = 1/2 from (1, 0)

final state q  0.877604166666667      exactly 337/384
final state v  -0.479166666666667     exactly -23/48
energy         0.499894883897569      exactly 147425/294912
energy change  -0.000105116102430556  exactly -31/294912

15 digits, rounded half-even, certified
"""
RUN = """\
Forward Euler (forward_euler): 40 steps of h = 1/4 from (1, 0) to t = 10

final state q  -3.12900713279485795083259563110
final state v  1.22937903463293923853576097167
exact state q  -0.839071529076452452258863947824         exactly cos(10)
exact state v  0.544021110889369813404747661851          exactly -sin(10)
state error    2.39029716830675147537827059350
energy         5.65102922393805771725009208643
energy change  5.15102922393805771725009208643
phase error    -11.5080564137640654522887417745 degrees
steps          40
evaluations    40

30 digits, rounded half-even, certified
"""
TO_TEN = ("run", "rk4", "--h", "1/4", "--t", "10")


@pytest.fixture
def found(answer):
    return lambda *words: json.loads(answer(*words, "--format", "json"))


def test_step_prints_fractions_with_decimals_and_run_every_certified_readout(answer):
    assert answer("step", "rk4", "--h", "1/2", "--state", "1,0") == STEP
    assert answer("run", "forward_euler", "--h", "1/4", "--t", "10", "--digits", "30") == RUN


def test_step_as_json_has_every_number_as_a_string(found):
    step = found("step", "rk4", "--h", "0.5")
    assert step["final_state"] == {
        "q": {"exact": "337/384", "decimal": "0.877604166666667"},
        "v": {"exact": "-23/48", "decimal": "-0.479166666666667"},
    }
    assert (step["h"], step["start"], step["digits"], step["rounding"]) == ("1/2", ["1", "0"], 15, "half-even")


def test_negative_values_are_values_and_not_options(answer):
    back = answer("step", "rk4", "--h", "-1/2", "--state", "-1,0")
    assert "one step of h = -1/2 from (-1, 0)" in back
    assert "exactly -337/384" in back
    assert answer("step", "rk4", "--h=\N{MINUS SIGN}1/2", "--state=-1,0") == back
    assert "h = -1/4" in answer("run", "rk4", "--h", "-.25", "--t", "-10", "--state", "-1/3,-2")


def test_rounding_of_a_tie_is_as_asked(answer):
    tie = ("step", "forward_euler", "--h", "1/8", "--state", "5/2,0", "--digits", "1")
    assert "final state q  2 " in answer(*tie)
    assert "final state q  3 " in answer(*tie, "--rounding", "half-away")


def test_huge_exact_fractions_are_printed_and_not_refused(found):
    energy = found("step", "rk4", "--h", "1/2", "--state", "1e1200,1e-1200")["energy"]
    assert len(energy["exact"]) > 4300  # Python's own limit for printing an integer
    assert energy["decimal"] == "4.99894883897569e2399"


def test_run_as_json_has_units_counts_and_undefined_as_null(found, answer):
    run = found(*TO_TEN)
    assert (run["steps"], run["evaluations"]) == (40, 160)
    assert run["phase_error"]["unit"] == "degrees"
    assert run["exact_state"]["q"]["exact"] == "cos(10)"
    assert run["state_error"]["exact"] is None
    assert found(*TO_TEN, "--state", "0,0")["phase_error"] is None
    assert "undefined at the origin" in answer(*TO_TEN, "--state", "0,0")


def test_no_time_and_the_origin_have_exact_answers(found):
    run = found("run", "rk4", "--h", "1", "--t", "0", "--state", "1/3,3/20")
    assert run["state_error"] == {"exact": "0", "decimal": "0"}
    assert run["phase_error"] == {"exact": "0", "decimal": "0", "unit": "degrees"}
    assert run["exact_state"]["q"] == run["final_state"]["q"]
    assert (run["steps"], run["evaluations"]) == (0, 0)


def test_ten_million_steps_and_far_more_are_answered(answer):
    million = answer("run", "symplectic_euler", "--h", "1/4", "--t", "2500000", "--digits", "20")
    assert "10000000 steps" in million
    assert "2.5e" not in million
    assert "1" + 44 * "0" in answer("run", "symplectic_euler", "--h", "1", "--t", "1e44")


def test_budget_stands_beside_the_run_in_both_forms(found, answer):
    text = answer("run", "forward_euler", "--h", "1/4", "--t", "10", "--digits", "30", "--budget")
    assert text.startswith(f"{RUN}\n")
    run = found(*TO_TEN)
    assert {**found(*TO_TEN, "--budget"), "budget": None} == {**run, "budget": None}


def test_question_without_an_answer_gives_one_line_and_its_own_exit(run):
    words = "driftproof run: the number is outside 10**-78000 .. 10**78000 and too long to write out\n"
    assert run("run", "forward_euler", "--h", "1/4", "--t", "1e100") == (3, "", words)


def test_bound_is_of_the_number_format_asked_for(found):
    for name, u in (("binary64", 53), ("binary32", 24), ("binary16", 11)):
        assert found("roundoff", "rk4", "--float", name)["format"].startswith(f"{name}: u = 2**-{u}")


RK4 = ("rk4", "--h", "1/2")
REFUSED = {
    ("step", "rk5", "--h", "1/2"): "unknown method 'rk5'; did you mean rk4 or ",
    ("step", *RK4, "--rounding", "up"): "invalid choice: 'up'",
    ("run", *RK4): "required: --t",
    ("run", "rk4", "--h", "1e-10", "--t", "1", "--budget"): "10000000000 steps; a float run takes at most 100000000",
    ("run", "rk4", "--h", "0.3", "--t", "10"): "h = 3/10 does not divide t = 10",
    ("run", "rk4", "--h", "1e-400", "--t", "1e-399", "--budget"): "h rounds to 0: the smallest positive binary64",
    ("roundoff", "gauss2"): "gauss2 is implicit",
    ("roundoff", "rk4", "--float", "binary8"): "invalid choice: 'binary8' (choose from 'binary64', 'binary32'",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)
