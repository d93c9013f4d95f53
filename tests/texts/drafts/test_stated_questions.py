"""Questions about stated problems have the methods, step sizes, times and readouts that the text gives."""

import re

import pytest

from driftproof.texts.drafts.possible_values import questions_in
from driftproof.texts.drafts.stated_questions import stated_questions
from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.numbers import numbers_in
from tests.looping import some
from tests.texts.words.test_stated_problems import equations, stated

TWO_ROWS = """On y' = -y, y(0) = 1 to t = 1:
|     | Euler |  | Heun |  |
| h | y | error | y | error |
| 0.1 | 0.348678 | 0.0192 | 0.368541 | 6.61e-4 |
| 0.2 | 0.327680 | 0.0402 | 0.370740 | 2.86e-3 |
"""

BY_COUNTS = """Error at t = 2 for y' = -2*t*y, y(0) = 1:
| N | Euler | RK4 |
| 10 | 1.28e-2 | 1.42e-4 |
| 20 | 6.29e-3 | 6.81e-6 |
| 40 | 3.10e-3 | 3.73e-7 |
"""
BY_HEADS = """Error at t = 2 for y' = -2*t*y, y(0) = 1:
| Method | h = 0.2 | h = 0.1 | h = 0.05 |
| Euler | 1.28e-2 | 6.29e-3 | 3.10e-3 |
| Heun | 6.93e-3 | 1.26e-3 | 2.75e-4 |
| RK4 | 1.42e-4 | 6.81e-6 | 3.73e-7 |
"""


def test_methods_are_compared_in_the_order_of_the_text_in_every_process():
    pairs = [("heun2", "rk4"), ("forward_euler", "rk4"), ("forward_euler", "heun2"), ("midpoint2", "rk4")]
    said = "".join(f" {b} is 2 times as accurate as {a}." for a, b in pairs)
    asked = stated(f"y' = -y, y(0) = 1 to t = 1 with h = 0.1.{said}")
    assert [(*re.findall(r"run (\w+)", one),) for one in asked if one.startswith("ratio")] == pairs


def test_the_rate_of_an_equation_is_no_step_size():
    (_, run) = stated("dP/dt = 0.8 P, P(0) = 1: Euler takes h = 0.5 to t = 2.")
    assert "h={0.5}, t={2}" in run
    assert "h={0.8}" in stated("P' = P, P(0) = 1: Euler takes dt = 0.8 to t = 1.6.")[-1]


def test_methods_sizes_times_and_what_is_read_are_those_of_the_text():
    text = """A problem. y' = -y, y(0) = 1: Euler, the explicit midpoint method and RK4 with steps of 0.1 and 0.05.
| t | y | relative error |
| 0.5 | 0.59 | 2 % |
| 1.0 | 0.35 | 5 % |
The slopes k_1 = -1 and so on; 1/2 divides the error by 2. 40 evaluations. One step."""
    found = {one: chosen for asked in stated(text) for one, chosen in questions_in(asked).items()}
    assert {c[0] for one, c in some(found.items(), 40) if one.startswith("run")} == {
        "forward_euler",
        "midpoint2",
        "rk4",
    }
    for part in ("h=0.1, t=0.5 : error", "h=0.05, t=1 : relative_error", "h=0.05, t=0.05 : y", "evaluations"):
        assert any(part in one for one in found), part
    assert {one[-4:] for one in found if one.startswith("step")} == {"k1.y", "k2.y", "k3.y", "k4.y"}
    assert sum(one.startswith("ratio(run rk4 y'=-y, y(0)=1, h=0.1,") for one in found) == 3  # at 1/10, 1/2 and 1
    assert not [one for one in found if "h=0.1, t=0.05" in one], "h must divide t"
    for told, before in ((" relative", "h = 0.5. With "), ("", "(h = 0.5; it is odd) "), ("%", "")):
        asked = " ".join(stated(f"{before}h = 0.1 RK4 on y' = -y, y(0) = 1 has the{told} error 3e-7 at t = 1"))
        assert ("relative_error" in asked) == bool(told)
        assert re.findall("h={(.*?)}", asked) == ["0.1"], "of the sentence in which the equation stands"

    for said, times in (("h = 0.1 has y_3 = 0.729", "t={0.3}"), ("h = 0.1 has y(2) = 0.122", "t={2}")):
        assert f", {times} : " in stated(f"y' = -y, y(0) = 1: Euler with {said}")[0]
    for said in ("10 steps to t = 2", "10 steps with h = 0.2", "ten steps with Δt = 0.2"):
        assert ", h={0.2}, t={2} : " in stated(f"y' = -y, y(0) = 1: Euler takes {said}")[-1]
    for counts, times in (((0, 1, 2, 3), "0.1,0.2,0.3,1"), ((10, 20), "1")):  # numbers of steps, and of runs
        rows = "".join(f"| {n} | 0.5 |\n" for n in counts)
        asked = stated(f"y' = -y, y(0) = 1: Euler with h = 0.1 to t = 1.\n| n | y_n |\n{rows}")
        assert f", t={{{times}}} : " in asked[0]
    for who, sizes, longest in (
        ("Euler", "0.0003 to t = 9", ["0.0003"]),
        ("Euler", "0.00029 to t = 8.7", ["0.00029"]),
        ("Euler", "0.00029 to t = 8.70029", []),
        ("Euler and RK4", "0.001 to t = 15.001", []),
        ("Euler", "0.001, 0.002 and 0.0005 to t = 10", ["0.002", "0.001"]),
    ):
        asked = " ".join(stated(f"y' = -y, y(0) = 1: {who} with h = {sizes}"))
        assert re.findall(r"run .*? h={(.*?)}", asked) == longest, "30000 steps in all"
    assert [len(stated(f"y' = -y, y(0) = 1, t = 1.{'1' * n}")) for n in (17, 18)] == [1, 0]
    for said, count in (("explicit methods", 1), ("methods", 2), ("explicit and implicit methods", 2)):
        *_, run = stated(f"y' = -y, y(0) = 1 by {said} of midpoint type to t = 1 with h = 0.1")
        assert run.partition("}")[0].count(",") == count - 1, run


def test_a_draft_works_out_the_numbers_of_a_stated_problem_and_names_the_slips():
    text = """Heun's method on y' = y - t^2 + 1, y(0) = 0.5, with h = 0.2.

| t | y | error |
| 0.4 | 1.20692 | 0.00717 |
| 2.0 | 5.23305 | 0.0742 |
"""
    suggestions = Suggestions(text)
    found = {x.text: (suggestions.look_alikes(x), suggestions.slips(x)) for x in numbers_in(text)}
    run = "run heun2 y'=y - t^2 + 1, y(0)=0.5, h=0.2, t="
    for number, question in {"1.20692": "0.4 : y", "0.00717": "0.4 : error", "5.23305": "2 : y"}.items():
        (alike, *_), slips = found[number]
        assert (alike.question, alike.strong, slips) == (run + question, True, {})
    assert found["0.0742"][1] == {f"{run}2 : error": "0.0724"}
    assert not any(x.strong for x in found["0.0742"][0])


def test_a_head_of_two_rows_has_the_methods_above_and_what_is_read_below():
    suggestions = Suggestions(TWO_ROWS)
    for text, question in {"0.370740": "heun2 y'=-y, y(0)=1, h=0.2, t=1 : y", "0.0402": "forward_euler"}.items():
        number = next(x for x in numbers_in(TWO_ROWS) if x.text == text)
        assert suggestions.look_alikes(number)[0].question.startswith(f"run {question}")
        assert suggestions.tables.column_of(number) == ("heun" if question.endswith("y") else "error")
    corner = Suggestions(TWO_ROWS.replace("| h |", "| 5 |"))  # twin: no second row of heads, so no head but the first
    assert {corner.tables.column_of(x) for x in numbers_in(TWO_ROWS) if x.text in ("0.1", "0.2")} == {""}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("table", [BY_COUNTS, BY_HEADS])
def test_counts_of_steps_and_heads_of_columns_give_the_step_size_and_the_line_above_what_is_read(table):
    suggestions, read = Suggestions(table), [x for x in numbers_in(table) if "e-" in x.text]
    alike = {x.text: suggestions.look_alikes(x)[0] for x in read}
    assert all(one.strong and one.question.endswith(" : error") for one in alike.values())
    for text, question in {"1.42e-4": "rk4 {}, h=0.2,", "6.29e-3": "forward_euler {}, h=0.1,"}.items():
        assert question.format("y'=-2*t*y, y(0)=1") in alike[text].question
        exchanged = text[:2] + text[3] + text[2] + text[4:]
        wrong = table.replace(text, exchanged)
        slip = next(x for x in numbers_in(wrong) if x.text == exchanged)
        assert Suggestions(wrong).slips(slip) == {alike[text].question: text}


def test_a_question_is_asked_once():
    text = "y' = -y, y(0) = 1, h = 0.1, t = 1, Euler. Again y' = -y, y(0) = 1, h = 0.1, t = 1."
    asked = stated_questions(text, lambda number: "")
    assert len(asked) == len({*asked}) == 2
    assert len(stated("y' = -y, y(0) = 1, t = 1. " * 4 + "x' = x, x(0) = 1, t = 1.")) == 2
    other = "y' = -y, y(0) = 1, t = 1. x' = y, y' = -x from (1, 0) to t = 2."
    assert equations(other) == ["y'=-y, y(0)=1", "x'=y, y'=-x, x(0)=1, y(0)=0"]
    aside = "N' = -N, N(0) = 50. Now A = 3 N has A' = -A, A(0) = 150, and t = 1."
    assert equations(aside) == ["N'=-N, N(0)=50", "A'=-A, A(0)=150"]


@pytest.mark.parametrize(
    ("said", "started"),
    [
        ("The first step is one of RK4.", ["rk4"]),
        ("It is started with Heun's method; RK4 is for comparison.", ["heun2"]),
        ("We compare with RK4.", ["exact", "forward_euler", "heun2", "rk4"]),
        ("The first value is exact: we start from the exact solution. RK4 comes later.", ["exact"]),
    ],
)
def test_multistep_method_is_started_as_the_text_says_or_in_all_usual_ways(said, started):
    found = stated(f"y' = -y, y(0) = 1, by AB2 with h = 0.1. {said} At t = 1")
    runs = [one for one in found if "{adams_bashforth2}" in one]
    assert sorted({re.search(r"started=(\w+)", one)[1] for one in runs}) == started


def test_method_that_starts_another_one_is_not_that_of_the_numbers():
    text = (
        "y' = y (1 - y), y(0) = 0.5, with AB2 and h = 0.1; the first step is taken with RK4. At t = 2 we get y = {}, "
        "where the exact solution is 0.88080."
    )
    right, wrong = (Suggestions(text.format(x)) for x in ("0.88092", "0.88192"))
    (number,) = (x for x in numbers_in(right.text) if x.text == "0.88092")
    assert right.look_alikes(number)[0].strong
    assert not right.slips(number)
    assert " started=rk4 " in right.look_alikes(number)[0].question
    (number,) = (x for x in numbers_in(wrong.text) if x.text == "0.88192")
    assert [*wrong.slips(number).values()] == ["0.88092"]


@pytest.mark.parametrize(
    ("said", "sizes"),
    [
        ("h = 0.1", {"0.1"}),
        ("h in {0.1}, and steps of 0.2", {"0.2"}),
        ("y_1 = y_0 + h(3/2 f_0 - 1/2 f_1) and h = 0.1", {"0.1"}),
        ("h = 2√(u/M), smallest at h = 3 √u, or h = 4·x, or h = 5 f_n; step size 0.1", {"0.1"}),
        ("h = 0.1. RK4 allows h = 0.1393, Euler only up to h = 0.05", {"0.1"}),
    ],
)
def test_a_factor_of_a_formula_and_a_limit_are_no_step_sizes(said, sizes):
    asked = stated(f"y' = -2ty, y(0) = 1 to t = 60 with RK4, {said}.")
    assert {found[1] for one in asked if (found := re.search(r"h={(.*?)}", one))} == sizes


def test_the_steps_of_multistep_methods_are_no_counts_of_steps():
    asked = stated(
        "y' = -2ty, y(0) = 1, h = 0.1. Methods of two, three and four steps, none of more than six steps: t = 1"
    )
    assert [one for one in asked if one.startswith("exact")] == ["exact y'=-2t*y, y(0)=1, t={1} : {y}"]


def test_a_name_of_several_methods_is_that_of_the_one_whose_whole_name_the_text_has():
    problem = "x'' = -sin x, x(0) = 1, x'(0) = 0: Verlet's method with h = 0.1 leads to t = 1."
    for before, meant in (
        ("Velocity Verlet is popular. ", "{velocity_verlet}"),
        ("", "{velocity_verlet,position_verlet}"),
    ):
        assert f"run {meant} " in stated(before + problem)[1]
