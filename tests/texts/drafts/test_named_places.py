"""What all numbers of a table say of each: its method, and that numbers of two digits are what they are meant to be."""

import pytest

from driftproof.texts.drafts.drafting import doubts_of, draft
from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.document import document_of
from driftproof.texts.readers.numbers import numbers_in

ERRORS = """The logistic equation is y' = y(1-y), y(0) = 0.1. Errors at t = 1:

| h | Euler | Heun | RK4 |
| 1/2 | 2.5e-02 | 3.3e-03 | 3.0e-05 |
| 1/4 | 1.4e-02 | 9.6e-04 | 2.2e-06 |
| 1/8 | 7.2e-03 | 2.6e-04 | 1.5e-07 |
"""
ORDERS = """We compare velocity Verlet and Euler's method for θ'' = -sin θ, θ(0) = 1, θ'(0) = 0.
It is not so with Euler. Halving the step divides the error at t = 1 by four:

| h | error | order |
| 0.2 | 2.449e-03 | |
| 0.1 | 6.111e-04 | 2.003 |
| 0.05 | 1.592e-04 | 2.001 |
| 0.025 | 3.817e-05 | 2.000 |
"""


def of_table(text):
    """The suggestions for a text, and the numbers in its table but for the step sizes."""
    suggestions = Suggestions(text)
    return suggestions, [x for x in numbers_in(text) if suggestions.tables.column_of(x) not in ("", "h")]


def strong(suggestions, number):
    return [one.question for one in suggestions.look_alikes(number)[:1] if one.strong]


@pytest.mark.parametrize(
    ("old", "new", "wrong", "slip"),
    [
        ("9.6e-04", "6.8e-04", ["6.8e-04"], ["9.6e-4"]),
        ("2.5e-02 | 3.3e-03", "3.3e-03 | 2.5e-02", ["3.3e-03", "2.5e-02"], ["2.5e-2", "3.3e-3"]),
        ("9.6e-04 |", "9.6e-04 |", [], []),
    ],
)
def test_numbers_of_two_digits_are_claims_where_half_of_their_table_agrees_and_no_wrong_one_is(old, new, wrong, slip):
    suggestions, numbers = of_table(ERRORS.replace(old, new))
    assert [x.text for x in numbers if not strong(suggestions, x)] == wrong
    assert [y for x in numbers for y in suggestions.slips(x).values()] == slip


def test_two_numbers_of_two_digits_that_agree_and_a_table_of_others_may_be_chance():
    few = "\n".join(ERRORS.split("\n")[:3]) + "\n| 1/2 | 2.5e-02 | 3.3e-03 | 3.1e-04 |"
    other = ERRORS.replace("1.4e-02 | 9.6e-04 | 2.2e-06", "1.5e-02 | 8.6e-04 | 3.3e-06").replace("7.2e", "6.1e")
    for text in (few, other.replace("2.6e-04 | 1.5e-07", "3.9e-04 | 2.5e-07")):
        suggestions, numbers = of_table(text)
        assert not [x.text for x in numbers if strong(suggestions, x)]


MIDPOINT = "y' = -2t y^2, y(0) = 1 and h = 0.2.\n\n| t | midpoint rule | RK4 |\n" + "".join(
    f"| {t} | {{}} | {rk4} |\n" for t, rk4 in (("0.2", "0.96153"), ("0.4", "0.86205"), ("0.6", "0.73528"))
)


@pytest.mark.parametrize(
    ("numbers", "methods", "claims"),
    [
        (("0.96000", "0.85774", "0.73010"), {"midpoint2"}, 3),
        (("0.96152", "0.86179", "0.73440"), {"implicit_midpoint"}, 3),
        (("0.96000", "0.85774", "0.73001"), {"midpoint2"}, 2),
        (("0.96000", "0.86179", "0.73010"), set(), 0),  # some of each
        (("0.12345", "0.23456", "0.34567"), {"midpoint2", "implicit_midpoint"}, 0),
    ],
)
def test_a_name_of_several_methods_means_the_one_that_has_the_numbers(numbers, methods, claims):
    suggestions = Suggestions(MIDPOINT.format(*numbers) + "\nThe midpoint rule has order 2.")
    found = [x for x in suggestions._numbers if x.text in numbers]
    held = [one for x in found for one in strong(suggestions, x)]
    assert suggestions.methods_at(found[0]) == methods
    assert len(held) == claims
    assert all(one.startswith(f"run {min(methods)} ") for one in held)
    order = suggestions.look_alikes(suggestions._numbers[-1])[0].question
    assert order == f"order {min(methods, default='implicit_midpoint')}"


def test_a_table_that_names_no_method_is_of_the_one_that_its_numbers_have():
    suggestions, numbers = of_table(ORDERS)
    slips = {x.text: [*suggestions.slips(x).values()] for x in numbers if not strong(suggestions, x)}
    assert slips == {"1.592e-04": ["1.527e-4"]}
    assert all(suggestions.methods_at(x) == {"velocity_verlet"} for x in numbers)
    other, numbers = of_table(ORDERS.replace("| h | error |", "| h | Euler |"))
    assert not [x.text for x in numbers if "." in x.text and "e-" in x.text and strong(other, x)]


@pytest.mark.parametrize(
    ("said", "live"),
    [
        ("At t = 2 Euler's method is off by 0.4397, or {8.3} %", True),
        ("At t = 2, Euler's method is {8.3} % too low", True),
        ("At t = 2, Euler's method takes {8.3} % of the time", False),
        ("At t = 2 Euler's method is off by 0.4397, or {8.4} %", False),
        ("Euler's method has an error of {8.3} %", False),  # at which time?
    ],
)
def test_a_percentage_of_two_digits_is_that_of_an_error_where_its_sentence_says_so(said, live):
    text = f"y' = y - t^2 + 1, y(0) = 0.5, h = 0.2, to t = 2. {said.replace('{', '').replace('}', '')}."
    suggestions = Suggestions(text)
    number = next(x for x in numbers_in(text) if x.text == said[said.index("{") + 1 : said.index("}")])
    assert bool(strong(suggestions, number)) is live


def test_a_doubt_of_a_number_in_words_stands_where_they_do():
    document = document_of("RK4 has five stages. Heun has two stages and order three.")
    claims = draft(document, "a")
    assert [(one.words, one.place(document, []).start) for one in doubts_of(claims)] == [("five", 8), ("three", 51)]
    assert 'spelled = "words"' in claims
