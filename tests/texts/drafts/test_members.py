"""The numbers that a text chooses are told from those that it works out, and neighbours share a phrase."""

import re
import tomllib

import pytest

from driftproof.texts.claims.checking import GIVEN
from driftproof.texts.drafts.drafting import draft
from driftproof.texts.drafts.members import problems_named_once
from driftproof.texts.readers.document import document_of
from tests.texts.sample import held


def test_numbers_of_an_equation_are_given_and_those_after_it_are_not():
    for text, count in (("x'' = -x/(x^2 + 4)^{3/2}; 2", 3), ("y' = -2y + 0.5, 25 of them", 2), ("3y = 2y + 0.5", 0)):
        assert held(document := document_of(text, "plain"), draft(document, "a"))[GIVEN] == count


@pytest.mark.parametrize(
    ("text", "phrases"),
    [
        ("from 1.5 " + "y" * 23 + " 2.5", ["from 1.5 " + "y" * 23 + " 2.5"]),
        ("from 1.5 " + "y" * 24 + " 2.5", ["from 1.5", "y" * 24 + " 2.5"]),
        ("RK4 at 0.5x is 0.877604", ["RK4 at 0.5x", "is {value}"]),
        ("from 1.5 to 0.33 % of it", ["from 1.5 to 0.33 %"]),
        ("at 1.5. Or 2.5", ["at 1.5", ". Or 2.5"]),
        ("rk4 2.828427125/3(17", ["rk4 {value}/", "/3(17"]),  # 3 belongs to the next phrase
        ("1.75 " * 9, ["1.75 " * 7 + "1.75", "1.75"]),
        ("5x. 7.5", ["5x", ". 7.5"]),  # no phrase begins within a word
    ],
)
def test_numbers_of_one_line_that_are_near_stand_in_one_phrase(text, phrases):
    assert re.findall(r'phrase = "(.*)"', draft(document_of(text), "a")) == phrases


def test_second_number_of_a_group_is_drafted_where_only_the_first_stands_in_an_earlier_phrase():
    text = "at 44.001\nat 44.001 | 59.727"
    phrases = re.findall(r'phrase = "(.*)"', draft(document_of(text), "a"))
    assert phrases == ["at 44.001", "| 59.727"]


SETTINGS = ["h = 0.3", "dt=0.3", "t_end =\n0.3", "step size of 0.3", "step size of 3", "λ = -9.47", "λ = -3e-144"]


@pytest.mark.parametrize("setting", SETTINGS)
def test_what_the_text_chooses_is_given_and_what_looks_like_a_value_is_not(setting):
    document = document_of(f"Of RK4 with {setting}, then {setting}, and h2 = 0.3; e = 0.3; h = 2.828.")
    text = draft(document, "a")
    assert held(document, text) == {"value": 1, "given": 2, "run": 0, "label": 2, "uncovered": 2}
    (chosen, limit) = tomllib.loads(text)["claim"]
    assert (chosen["phrase"], chosen["count"]) == (setting.replace("\n", " "), 2)
    assert limit["value"] == "imaginary_limit rk4"


def test_a_limit_of_the_step_size_is_found_not_chosen():
    for said, given in (
        *(("h = 1.414", 1), ("It is stable up to h = 1.414", 0), ("RK4 holds out to h = 1.414.", 0)),
        *(("With RK4 we may take h = 0.096", 0), ("RK4 tolerates\nh = 0.096 and Euler only h = 0.05", 0)),
        *(("For M = 3 that is\nh = 2.11e-8", 0), ("so u = 1. Then 2√u = 0.12 for y' = u y", 1)),
        *(("After 28 steps it is less", 1), ("it decays after 28 steps", 1), ("It has doubled after 28 steps", 0)),
        *(("How soon? (Answer: after 18.)", 0), ("With RK4 and h = 0.096 we take", 1)),
    ):
        assert held(document := document_of(said), draft(document, "a"))[GIVEN] == given, said


def test_a_chosen_cell_is_no_reason_for_the_same_number_in_another_column():
    text = "| z | R(z) Euler | note |\n|---|---|---|\n| -1 | 0 | a |\n| -2 | -1 | b |\n"
    claims = tomllib.loads(draft(document_of(text, "markdown"), "a"))["claim"]
    assert [one["column"] for one in claims if one["phrase"] == "| -1 |" and "value" not in one] in ([], ["z"])


@pytest.mark.parametrize(
    ("said", "given"),
    [
        ("Half of it is reached at t = 0.748 s", 0),
        ("The peak occurs at time t = 12.5", 0),
        ("The end is reached at t = 100", 1),
        ("The maximum is near; we stop at t = 0.748", 1),
        ("It falls, from the start to t = 0.748", 1),
    ],
)
def test_a_time_at_which_something_is_reached_is_found_unless_it_is_round(said, given):
    assert held(document := document_of(said), draft(document, "a"))[GIVEN] == given


def test_a_letter_of_an_equation_is_given_and_no_other():
    document = document_of("S' = -βS I - c_1 S, with β = 0.44, c_1 = 0.77 and q = 0.99; S = 0.33.")
    given = [claim["phrase"] for claim in tomllib.loads(draft(document, "a"))["claim"]]
    assert given == ["β = 0.44", "c_1 = 0.77"]


def test_a_start_in_brackets_is_given_as_one():
    document = document_of("It runs from (1, -0.3) with h = 0.3 to (1, -0.3), from 1 on.")
    text = draft(document, "a")
    assert held(document, text) == {"value": 0, "given": 3, "run": 0, "label": 0, "uncovered": 3}
    assert [claim["phrase"] for claim in tomllib.loads(text)["claim"]] == ["from (1, -0.3", "h = 0.3"]
    assert 'id = "line 1, column 41"' in text


def test_numbers_in_a_column_of_steps_or_times_are_given_if_they_stand_alone():
    table = "| $h$ | error |\n| --- | --- |\n| 0.1 | 0.3 |\n| 0.05 | 0.7 |\n| of 9 | 8 |\n\nand 0.1 too"
    drafted = draft(document_of(table, "markdown"), "a")
    assert [claim["phrase"] for claim in tomllib.loads(drafted)["claim"]] == ["| 0.1 |", "| 0.05 |"]
    assert 'phrase = "| 0.1"' in draft(document_of("error | h\n0.3 | 0.1\nend"), "a")
    for text in ("θ' = ω, ω' = -sin(θ)\n\n| ω |\n| --- |\n| -0.963 |\n\nω = -0.963", "eigenvalue λ = -9.373"):
        assert "\n[[claim]]" not in draft(document_of(text, "markdown"), "a"), "computed, and not chosen"


def test_two_other_values_are_named_and_the_rest_counted_unless_the_text_chooses_the_number():
    _, two, three, _ = asked = [f"0.1234567 + {k} - {k}" for k in range(4)]
    for count, said in ((1, []), (2, [two]), (3, [f"{two}, {three}"]), (4, [f"{two}, {three} and 1 more"])):
        drafted = draft(document_of("is 0.123457"), "a", asked[:count])
        assert re.findall("# 0.123457 looks also like (.*)", drafted) == said
    assert "0.5 looks" not in draft(document_of("is 0.5, and h = 0.5"), "a")  # like too much


def test_a_problem_is_written_out_once():
    of, energy = "x'=v, v'=-x, x(0)=1, v(0)=0", "energy=v^2/2 + x^2/2"
    lines = [f"run rk4 {of}, h=0.1, t=1 : x is 0.5; it looks like exact {of}, t=1 : x", f"run rk4 {of}, {energy}, t=2"]
    shown = [lines[0].replace(f"exact {of}", "exact ..."), f"run rk4 ..., {energy}, t=2", "run rk4 ..., ..., t=2"]
    assert [*problems_named_once([lines[0], lines[1], lines[1]])] == shown
