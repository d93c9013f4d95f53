"""`driftproof roundoff` and `run --budget`: formulas, bounds in u, and the error of a float run in its two parts."""

import json
import re
from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof import run
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.steppers import float_stepper
from driftproof.reports.rounding import budget_answer, budget_text, roundoff
from driftproof.symbolic.rounding.formats import BINARY32
from tests.looping import some


def decimal(answer):
    return Q(answer["decimal"])


def budget(key, h=Q(1, 4), t=Q(10), start=(Q(1), Q(0))):
    return budget_answer(run(key, h, t, state=start), 15, "half-even", range)


@pytest.mark.parametrize(
    ("key", "dq"),
    [
        ("forward_euler", "|dq| <= u (|q| + 2 h |v|)"),
        ("symplectic_euler", "|dq| <= u ((1 + 4 h**2) |q| + 3 h |v|)"),
        ("rk4", "|dq| <= u ((1 + 23/6 h**2 + 5/12 h**4) |q| + (37/6 h + 3/2 h**3) |v|)"),
    ],
)
def test_first_order_forms_are_those_derived_by_hand(key, dq):
    answer = roundoff(key, [])
    assert answer["first_order"][0] == dq
    assert answer["program"] == "hand-written"
    assert answer["differences_from_definition"] == []


def test_a_program_that_is_not_the_definition_is_reported(monkeypatch):
    monkeypatch.setitem(METHODS._methods, "rk4", replace(METHODS["midpoint2"], key="rk4"))
    assert "The program differs from the definition of the method:\n" in (text := str(roundoff("rk4", [])))
    assert "coefficient of h**3" in text.partition("differs")[2]


@pytest.mark.parametrize(("key", "most"), [("forward_euler", 200), ("symplectic_euler", 90), ("rk4", 115)])
def test_theorem_bounds_the_lesson_s_runs_in_few_units(key, most):
    answer = budget(key)
    assert decimal(answer["rounding_in_u"]) <= decimal(answer["bound"]["in_u"]) <= most


def test_irrational_coefficients_have_bounds_about_the_definition_and_about_the_program_and_say_which():
    answer = roundoff("yoshida4", [Q(1, 4)])
    assert answer["differences_from_definition"] == []
    assert answer["rounds_coefficients"]
    (at,) = answer["at"]
    assert set(at) == {"h", "plain", "sharp", "as_held", "per_step", "safe_state"}
    assert at["as_held"] != at["sharp"]
    assert at["per_step"]["norm"]["q2"] == "1"
    assert at["per_step"]["rho_squared"] == "1"
    text = str(answer)
    assert 'only those of "as held" are relative to the polynomial with the rounded coefficients' in text
    assert "as held" in text.splitlines()[-1]
    assert "Decimals in the formulas" in text


def test_a_program_that_holds_its_coefficients_exactly_has_no_bound_of_another_kind():
    answer = roundoff("rk4", [Q(1, 4)])
    assert not answer["rounds_coefficients"]
    assert "as_held" not in answer["at"][0]
    text = str(answer)
    assert "as held" not in text
    assert "Decimals" not in text
    generic = roundoff("rk4", [Q(1, 3)], float="binary32")
    assert generic["program"] == "generic"
    assert Q(generic["at"][0]["h"]) == BINARY32.nearest(Q(1, 3)) != Q(1, 3)
    assert generic["rounds_coefficients"]
    assert "as_held" in generic["at"][0]


def test_the_states_for_which_the_bounds_hold_are_said():
    (at,) = roundoff("rk4", [Q(1, 2)])["at"]
    safe = float(at["safe_state"])
    assert all(abs(x) < float("inf") for x in float_stepper("rk4")(oscillator, safe, safe, 0.5))
    assert float_stepper("rk4")(oscillator, 1e308, 1e308, 0.5)[0] == float("inf")
    assert safe == 1e307
    assert "for |q|, |v| <= 1e307: no operation of the step overflows" in str(roundoff("rk4", "1/2"))


def test_printed_bounds_are_rounded_up():
    (at,) = roundoff("gill4", [Q(1, 3)])["at"]
    numbers = [x for row in ("plain", "sharp", "as_held") for x in at[row]] + [at["per_step"]["c"]]
    assert all(Q(x["exact"]) <= decimal(x) <= Q(x["exact"]) * (1 + Q(1, 10**5)) for x in some(numbers, 9))
    assert any(Q(x["exact"]) < decimal(x) for x in numbers)


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("key", ["gill4", "cooper_verner8", "yoshida4", "suzuki4", "mclachlan2"])
def test_budget_of_an_irrational_method_is_within_its_proved_bound(key):
    answer = budget(key)
    assert 0 < decimal(answer["rounding"]) <= decimal(answer["bound"]["value"])


def test_budget_is_about_the_double_that_is_run():
    assert budget("rk4", Q(1, 10))["h_run"] == "0.1 (the double nearest to 1/10)"
    assert budget("rk4", Q(1, 4))["h_run"] == "1/4"


def test_without_a_norm_of_its_own_there_is_no_theorem_and_it_says_so():
    answer = budget("symplectic_euler", Q(2))
    assert answer["rounding"]["exact"] == "0"
    assert answer["bound"]["value"] is None
    assert "real eigenvalues" in answer["bound"]["reason"]
    last = [" ".join(line.split()) for line in budget_text(answer).splitlines()[-2:]]
    assert last[0] == "+ rounding 0 = 0 u"
    assert last[1].startswith("proved bound on the rounding: none: at h = 2: the step has real eigenvalues")
    assert "At h = 2, no c(h): at h = 2: the step has real eigenvalues" in str(roundoff("symplectic_euler", [Q(2)]))


def test_budget_is_shown_line_by_line():
    shown = budget_text(budget_answer(run("rk4", Q(1, 4), Q(10), state=(Q(1), Q(0))), 6, "half-even", range))
    assert [re.split(r"  +", line) for line in shown.splitlines()] == [
        ["Error budget of the binary64 run with h = 1/4"],
        [""],
        ["float final state", "-0.8391881716812657, 0.543717433320066"],
        ["state error", "0.000325308", "at most the sum of the next two"],
        ["= truncation", "0.000325308", "the error of the method in exact arithmetic"],
        ["+ rounding", "5.18170e-16", "= 4.66726 u"],
        ["proved bound", "1.06361e-14", "on the rounding: 95.8011 u"],
    ]


def test_run_whose_floats_overflow_is_answered_and_says_so(answer):
    """|1 + 4i|**1000 is about 1e615: no double, and no obstacle to the exact run."""
    asked = ("run", "forward_euler", "--h", "4", "--t", "4000", "--budget")
    text, found = answer(*asked), json.loads(answer(*asked, "--format", "json"))
    assert "e615" in text
    assert "overflow: the state is no longer finite after step 5" in text
    assert found["state_error"]["decimal"].endswith("e615")
    assert set(found["budget"]) == set(budget("rk4")) | {"reason"}
    assert found["budget"]["rounding"] is None
