"""The values that a text may have: usual ones of its methods and settings, and those asked for, of few steps each."""

from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.texts.drafts.possible_values import KnownValue, questions_in
from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.numbers import numbers_in
from tests.looping import exactly


def test_so_many_methods_steps_and_times_are_asked_of_and_no_more():
    given = ["h = 1/123456789012345678", "h = 1/12345678901234567"]  # of 20 characters, and of 19
    given += [f"{letter} = {'1/' * (letter == 'h')}{n}" for letter in "htN" for n in range(2, 9)]
    text = ". ".join([*METHODS, *given])
    asked = [question.split() for question in Suggestions(text).values._usual_questions()]
    assert [len({words[1] for words in asked if words[0] == kind}) for kind in ("order", "run")] == [20, 6]
    assert {words[2] for words in asked if words[0] == "step"} == {"h=1/12345678901234567", "h=1/2", "h=1/3", "h=1/4"}
    assert {words[3] for words in asked if words[0] == "run"} == {"t=2", "t=3", "N=2", "N=3"}
    after_n, at_t = ({words[-1] for words in asked if given in words} for given in ("N=2", "t=2"))
    assert after_n == at_t - {"steps"}
    asked = [question.split() for question in Suggestions("h = 1/2000, h = 3/10, N = 10001").values._usual_questions()]
    runs = {words[2] for words in asked if words[0] == "run"}
    assert runs == {"h=1/4", "h=1/2"}, "neither long ones, nor those that end beside t"


def test_an_asked_question_without_an_answer_is_refused():
    with pytest.raises(QuestionError, match="unknown method"):
        Suggestions("1.5", ["step {nope} h=1 : q"]).look_alikes(numbers_in("1.5")[0])
    with pytest.raises(QuestionError, match="does not divide"):
        Suggestions("1.5", ["run rk4 h={3,4} t=1 : q"]).look_alikes(numbers_in("1.5")[0])


def test_of_braces_a_branch_without_an_answer_is_said_and_the_others_are_asked():
    suggestions = Suggestions("RK4 takes 40 evaluations.", ["run {rk4,implicit_midpoint} h=1/4 N=10 : evaluations"])
    assert suggestions.look_alikes(numbers_in(suggestions.text)[-1])[0].question == "run rk4 h=1/4 N=10 : evaluations"
    assert [*suggestions.values.not_asked["the question has no answer"]] == [
        "run implicit_midpoint h=1/4 N=10 : evaluations"
    ]


def test_tie_of_a_solution_is_no_suggestion_and_takes_no_time():
    """y' = t sqrt(y), y(0) = 1 is 25/16 at t = 1, which balls do not tell from 1.562 or 1.563."""
    suggestions = Suggestions("1.563 or 1.5625", ["exact rates=(t*sqrt(y0)) from 1 t=1 : y0"])
    assert [len(suggestions.look_alikes(n)) for n in numbers_in(suggestions.text)] == [0, 1]


def test_a_draft_encloses_a_stated_solution_in_few_steps_and_says_which_it_did_not():
    lorenz = "x' = 10(y - x), y' = x(28 - z) - y, z' = xy - 8/3 z, x(0) = 1, y(0) = 1, z(0) = 1"
    suggestions = Suggestions(f"{lorenz}. At t = 1/4, x is 11.04284. At t = 200, x is 1.2345.")
    asked = [x for x in numbers_in(suggestions.text) if "." in x.text]
    assert [len(suggestions.look_alikes(x)) for x in exactly(2, asked)] == [1, 0]
    *_, (why, refused) = suggestions.values.not_asked.items()
    assert "few steps" in why
    assert sorted(one[-9:] for one in exactly(3, refused)) == ["t=200 : x", "t=200 : y", "t=200 : z"]


def test_number_of_six_hundred_places_is_suggested_and_one_of_seven_hundred_takes_too_many_bits():
    for places, count in ((600, 1), (700, 0)):
        text = value("exp(1)").places(places)
        assert len(Suggestions(text, ["exp(1)"]).look_alikes(numbers_in(text)[0])) == count


def test_braces_are_chosen_from_in_every_way_and_equal_braces_alike():
    every_way = [f"step rk4 h=1/{h} N={n} : q" for h in (2, 4) for n in (1, 2)]
    assert [*questions_in("step rk4 h=1/{2,4} N={1..2} : q")] == every_way
    assert questions_in("{1..2} - {1..2} + {a_b}") == {"1 - 1 + a_b": ("1", "a_b"), "2 - 2 + a_b": ("2", "a_b")}
    assert questions_in("1/3") == {"1/3": ()}
    assert len(questions_in("{1..2000}")) == 2000
    with pytest.raises(ValueError, match="expands to 2001 questions"):
        questions_in("{1..2001}")
    with pytest.raises(ValueError, match="expands to 0 questions"):
        questions_in("a - {3..1}")


def test_braces_of_one_setting_that_are_equally_long_go_together():
    halved = "run rk4 h={1/2,1/4} t={1,2} : q - run rk4 h={1/4,1/8} t={1,2} : q"
    pairs = [(h, half, t) for h, half in (("1/2", "1/4"), ("1/4", "1/8")) for t in (1, 2)]
    assert [*questions_in(halved)] == [f"run rk4 h={h} t={t} : q - run rk4 h={x} t={t} : q" for h, x, t in pairs]
    assert len(questions_in("h={1,2} h={1,2,3} t={4,5}")) == 12


def test_an_asked_value_of_one_digit_needs_two_names_nearby():
    for chosen, digits, fit, meant in ((("2",), 1, 1, False), (("2",), 2, 1, True), (("2", "3"), 1, 2, True)):
        assert KnownValue("", value("0.4"), chosen).is_meant(Q(2, 5), digits, fit, rivals=5) is meant


def test_the_numbers_of_a_value_are_those_chosen_and_the_time_of_so_many_of_the_first_steps():
    two = KnownValue("run rk4 h=1/2 N=3 : q - run rk4 h=1/4 N=6 : q", value("1"), ("3",))
    assert two.numbers == [{3, Q(3, 2)}]
