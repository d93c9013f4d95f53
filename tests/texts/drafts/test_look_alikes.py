"""A number looks like the values that are spelled so, those first whose names stand near; a strong one is no chance."""

from fractions import Fraction as Q

import pytest

from driftproof.texts.drafts.possible_values import KnownValue
from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import numbers_in
from tests.looping import exactly


def suggested(text):
    suggestions = Suggestions(text)
    return [suggestions.look_alikes(number) for number in numbers_in(text) if number.label is None]


@pytest.mark.parametrize(
    ("text", "best"),
    [
        ("one step of RK4 leads to the position 337/384", "rk4.first_step.q"),
        ("one step of RK4 leads to 0.877604", "rk4.first_step.q"),
        ("forward Euler, h = 1/4, t = 10: state error 2.390297", "forward_euler.default.state_error"),  # published
        ("forward Euler's state error is 2.390 at the end", "forward_euler.default.state_error"),
        ("with RK4, h = 1/8 and t = 2: energy change -1.26e-7", None),
        ("RK4, h = 1/5, t = 2: the state error is 2.7e-5", "run rk4 h=1/5 t=2 : state_error"),
        ("RK4 is stable up to 2.828", "imaginary_limit rk4"),
        ("Crank-Nicolson method, h = 1/5, t = 2: the state error is 6.63e-3", "run trapezoid h=1/5 t=2 : state_error"),
        ("forward Euler, h = 1/4: each step multiplies the energy by 1.0625", "energy_multiplier forward_euler h=1/4"),
        ("forward Euler's energy, N = 16, h = 1/4: 1.3190", "run forward_euler h=1/4 N=16 : energy"),
        ("after 16 time steps of h = 1/4 forward Euler's energy is 1.3190", "run forward_euler h=1/4 N=16 : energy"),
        ("16 of those of h = 1/4: forward Euler's energy is 1.3190", None),
        ("nothing like it: 0.123456", None),
        ("not a number 1/0", None),
    ],
)
def test_best_suggestion_is_the_value_whose_names_are_near(text, best):
    *_, last = suggested(text)
    assert (last[0].question if last else None) == best


def test_suggestion_is_strong_only_where_the_digits_or_the_names_say_so():
    for text, strong in (("RK4 with h = 1/2: 0.877604", [True, True]), ("about 0.877604", [False, False])):
        assert [candidate.strong for candidate in suggested(text)[-1]] == strong, "of which method?"
    for text, strong in (("0.5", False), ("2.4", False), ("2.39", False), ("0.090", False)):
        assert {candidate.strong for candidate in suggested(f"about {text}")[0]} == {strong}, text
    assert suggested("forward Euler's state error is 2.390 at the end")[-1][0].strong
    of_roots = [suggested(f"t = 2: the {name}q is -0.41614684")[-1][0].strong for name in ("", "exact ")]
    assert of_roots == [False, True], "a letter is no name"
    assert Suggestions("about 0.5", ["1/2"]).look_alikes(numbers_in("about 0.5")[0])[0].question == "1/2"
    exact = [value(candidate.question).exact == Q(1, 2) for candidate in suggested("about 0.5")[0]]
    assert exact == sorted(exact, reverse=True), "what is equal stands before what is rounded"
    assert {*exact} == {True, False}
    (candidates,) = suggested("the exact energy is 0.5")
    assert (candidates[0].question, candidates[0].strong) == ("exact.energy", True)


def test_names_of_a_value_are_near_within_a_line_of_the_number():
    for spaces, near in ((91, True), (92, False)):  # the number, and 100 characters before it
        alike = suggested(f"order rk4{' ' * spaces}4")[-1]
        assert [one.strong for one in alike if one.question == "order rk4"] == [near]


def test_suggested_value_is_spelled_as_the_number_is():
    text = "RK4 and forward Euler: 2.390, 3.3e-4, 337/384, 160, 0.8776"
    numbers = [n for n in numbers_in(text) if n.label is None]
    for number, candidates in exactly(5, zip(numbers, suggested(text), strict=True)):
        assert candidates
        assert all(number.text in candidate.form.spellings(value(candidate.question)) for candidate in candidates)


def test_round_numbers_say_no_more_than_their_digits_before_the_zeros():
    assert not any(one.strong for text in ("1.000000", "4.0000000", "40.00") for one in suggested(f"| {text} |")[0])
    assert suggested("RK4: the order is 4")[-1][0].strong
    assert not suggested("the first step: y + 0.5 k")[0][0].strong, "a step size of ours, which is no value"


NOTE = """\
Euler's method on y' = -2y, y(0) = 1 reaches 0.10737 at t = 1 with h = 0.1, which is off by 20.7% or 0.02796.
The solution there is 0.135335, and y = 0.1 is a start. Heun's method reaches 0.13748, and RK4 with h = 0.5 0.1406."""
OF_NOTE = "run {Euler,Heun} y'=-2y, y(0)=1, h={0.1,0.5}, t=1 : {y,error,relative_error,exact.y}"


def test_a_percentage_is_a_hundred_times_the_value_and_a_solution_is_exact():
    found = best_of(NOTE, "20.7")
    assert found == "percent(run Euler y'=-2y, y(0)=1, h=0.1, t=1 : relative_error, 1)"
    assert best_of(NOTE.replace("20.7%", "20.7"), "20.7") != found
    assert best_of(NOTE.replace("0.02796", "0.02796%"), "0.02796") is None
    assert best_of(NOTE, "0.135335").endswith("exact.y")
    assert not best_of(NOTE.replace("solution there is", "error with h = 0.5 is"), "0.135335").endswith("exact.y")


# Of 90 numbers of two digits one in 20 is asked for, or of 9000 of four digits one in 100 is usual, or one more.
@pytest.mark.parametrize(("x", "chosen", "most"), [("0.34", (), 4), ("0.337", (), 45), ("0.3371", None, 90)])
def test_so_many_values_leave_a_number_of_few_digits_strong_and_one_more_does_not(x, chosen, most):
    suggestions, (number,) = Suggestions(f"about {x}", ["0.3371"] if chosen == () else []), numbers_in(x)
    for count, strong in ((most, True), (most + 1, False)):
        questions = ["0.3371", *(f"{n}.5" for n in range(1, count))]
        suggestions.values.__dict__["known"] = [KnownValue(question, value(question), chosen) for question in questions]
        suggestions.values._spelled.clear()
        suggestions._alike.clear()
        assert [alike.strong for alike in suggestions.look_alikes(number)] == [strong]


def test_the_head_of_a_column_says_which_fact_a_digit_is():
    suggestions = Suggestions(text := "| Method | stages | order |\n| RK4 | 4 | 4 |")
    found = [suggestions.look_alikes(x)[0] for x in numbers_in(text) if x.label is None]
    assert [(one.question, one.strong) for one in found] == [("stages rk4", True), ("order rk4", True)]


def test_zeros_at_the_end_of_the_value_that_the_place_names_are_digits():
    """With h = 1/2, forward Euler has 0.25."""
    for h, strong in (("0.5", True), ("0.25", False)):
        text = f"y' = -y, y(0) = 1. Euler at t = 1:\n| h | y |\n| {h} | 0.2500 |\n| 0.5 | 0.1 |"
        number = next(x for x in numbers_in(text) if x.text == "0.2500")
        assert any(one.strong for one in Suggestions(text).look_alikes(number)) is strong


def test_a_row_at_time_t_is_of_the_run_of_as_many_steps_and_its_column_has_a_name():
    table = "| t | Euler | RK4 |\n| 0.2 | 0.8 | 0.829293 |\n| 0.4 | 1.152 | 1.214 |"
    suggestions = Suggestions(table, ["run {Euler,RK4} y'=y-t^2+1, y(0)=0.5, h=0.2, N={1,2} : y"])
    _, *values = [number for number in numbers_in(table) if number.label is None]
    found = {number.text: suggestions.look_alikes(number)[:1] for number in values}
    assert {text for text, alike in found.items() if alike and alike[0].strong} == {"0.8", "0.829293", "1.152", "1.214"}


def test_the_last_step_size_given_before_a_number_decides_between_equal_values():
    text = "RK4 with h = 0.2 to t = 2, and then RK4.\nNow h = 0.1, t = 1:\nRK4 needs 40 evaluations."
    assert suggested(text)[-1][0].question == "run rk4 h=1/10 t=1 : evaluations"


def best_of(text, spelled):
    (number,) = [each for each in numbers_in(text) if each.text == spelled]
    return next((alike.question for alike in Suggestions(text, [OF_NOTE]).look_alikes(number)), None)


@pytest.mark.parametrize("spelled", ["1.45722e-07", "1.45722E-7", "1.45722e-007", "1.45722×10^{-7}"])
def test_exponents_of_any_program_are_read(spelled):
    suggestions = Suggestions(spelled, ["run rk4 rates=(t*sqrt(y0)) from 1 h=1/10 t=1 : state_error"])
    assert suggestions.look_alikes(numbers_in(spelled)[0])[0].strong


def test_questions_are_asked_of_a_draft_only(refusal):
    assert "--ask needs --init" in refusal("check", "a.md", "--claims", "c.toml", "--ask", "pi")


NO_METHODS = """The tower is 2.828 m high and 1.414 m wide, a cup holds 1.0625 litres, the error rate was 2.390297
and the limit is 2.828. 337/384 of all guests came back, the state has 0.877604 of them. At t = 10 the energy is
0.499933."""


def test_a_text_without_methods_has_no_value_of_one_by_chance():
    suggestions, numbers = Suggestions(NO_METHODS), [x for x in numbers_in(NO_METHODS) if x.text != "10"]
    alike = {x.text: suggestions.look_alikes(x) for x in numbers}
    assert len(alike) == 7
    assert all(alike.values()), "each is a value of the lesson"
    assert not [one for some in alike.values() for one in some if one.strong]


def test_columns_for_numbers_of_steps_give_their_step_sizes_beside_one_in_the_text():
    text = "P' = 0.6 P (1 - P/100), P(0) = 10 with h = 0.5. Errors at t = 5:\n\n"
    text += "| method | N = 10 | N = 40 |\n| RK4 | {} | {} |"
    run = "run rk4 P'=0.6*P*(1-P/100), P(0)=10, t=5, N={} : error"
    text = text.format(*(value(run.format(n)).digits(4) for n in (10, 40)))
    suggestions, numbers = Suggestions(text), numbers_in(text)[-2:]
    assert [suggestions.look_alikes(x)[0].strong for x in numbers] == [True, True]
    assert ["h=0.5," in suggestions.look_alikes(x)[0].question for x in numbers] == [True, False]


def test_an_ambiguous_name_is_of_all_its_methods_and_no_slip_of_another():
    text = "For y' = t - y^2, y(0) = 1 and h = 0.1, the explicit midpoint method has y = {} at t = 2.\n"
    text += "Ralston's has y = {} at t = 2."
    run = "run {} y'=t - y^2, y(0)=1, h=0.1, t=2 : y"
    text = text.format(*(value(run.format(key)).places(6) for key in ("midpoint2", "ralston2")))
    suggestions, numbers = Suggestions(text), [x for x in numbers_in(text) if len(x.text) > 6]
    assert [suggestions.look_alikes(x)[0].strong for x in numbers] == [True, True]
    assert not any(map(suggestions.slips, numbers))


@pytest.mark.parametrize(
    "said",
    [
        "From h = 0.5 to h = 0.25 the error of RK4 falls by the factor {}",
        "Halving h from 0.5 to 0.25 divides the error of RK4 by {}",
    ],
)
def test_a_ratio_of_errors_is_known_by_its_two_step_sizes(said):
    text = f"y' = 0.8*y*(1 - y/5), y(0) = 0.5, to t = 5 with h = 1, 0.5 or 0.25. {said.format('15.7')}."
    suggestions = Suggestions(text)
    (best,) = [
        one for one in suggestions.look_alikes(next(x for x in numbers_in(text) if x.text == "15.7")) if one.strong
    ]
    assert best.question.startswith("ratio(run rk4 ")
    assert "h=0.5, t=5 : error, " in best.question


def test_a_time_in_its_column_is_no_value():
    """The trapezoidal rule has 1.50 at the time 1.5."""
    text = "y' = -0.8y, y(0) = 5 with h = 0.25 by Euler's method and the trapezoidal rule.\n"
    text += "| t | Euler |\n| 1.50 | 1.3107 |\n"
    suggestions = Suggestions(text)
    time, y = numbers_in(text)[-2:]
    assert suggestions.look_alikes(y)[0].strong
    assert suggestions.look_alikes(time)
    assert not any(one.strong for one in suggestions.look_alikes(time))
