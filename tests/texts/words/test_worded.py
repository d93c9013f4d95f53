"""Words for what becomes of a value are read by the number beside them, and are slips where it became the opposite."""

import pytest

from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.words.worded import fact_in_word, gap_to_number, signed_by

DECAY = "We solve y' = -2y, y(0) = 1 up to t = 1 with h = 0.1 and h = 0.05. "
SPRING = "With x'' = -x, x(0) = 1, x'(0) = 0 and energy E = x'^2/2 + x^2/2 we take h = 0.1. "


CUP = "A cup cools by T' = -0.1 (T - 20), T(0) = 90. With h = 2, to t = 10, "
COLD = (
    "Euler is too cold, by 2.814.", "Euler's value is 2.814 below the exact one.", "Euler underestimates T by 2.814.",
    "Euler is lower than the exact solution by 2.814.", "Euler is 6.15 % too low.", "Euler underestimates T by 6.15 %.",
)  # fmt: skip
WARM = ((0, "cold", "warm"), (1, "below", "above"), (2, "under", "over"), (3, "lower", "higher"), (4, "low", "high"))
WARM = [(n, *(word + "estimates" * (n == 2) for word in words)) for n, *words in WARM]


@pytest.mark.parametrize(
    ("text", "slips"),
    [
        (f"{DECAY}At t = 1 Heun's method with h = 0.1 is 0.002113 too high, Euler 0.02796 too low.", {}),
        (f"{DECAY}At t = 1 Heun's method with h = 0.1 is 0.002113 too low.", {"low": "high"}),
        (f"{DECAY}From h = 0.1 to h = 0.05 the error of Heun's method falls by a factor of 4.34.", {}),
        (
            f"{DECAY}From h = 0.1 to h = 0.05 the error of Heun's method grows by a factor of 4.34.",
            {"grows": "shrinks"},
        ),
        (f"{DECAY}The error of Heun's method grows by a factor of 4.34 from h = 0.05 to h = 0.1.", {}),
        (f"{DECAY}The error of Heun's method falls by a factor of 4.34 from h = 0.05 to h = 0.1.", {"falls": "grows"}),
        (f"{DECAY}From h = 0.1 to h = 0.05 the accuracy of Heun's method grows by a factor of 4.34.", {}),
        (f"{DECAY}Halving the step, from h = 0.1, divides the error of Heun's method by 4.34.", {}),
        (f"{DECAY}Euler's method is of first order: halving the step halves the error.", {}),
        (f"{DECAY}Euler's method is of first order: halving the step doubles the error.", {"doubles": "halves"}),
        (f"{DECAY}Heun is of second order, so that halving the step makes the error about four times smaller.", {}),
        (f"{DECAY}Heun's method makes an error, and RK4 is of fifth order.", {"fifth": "fourth"}),
        (f"{SPRING}Forward Euler spirals outward: E grows by 0.852 until t = 10.", {}),
        (f"{SPRING}Forward Euler spirals outward: E shrinks by 0.852 until t = 10.", {"shrinks": "grows"}),
        (f"{SPRING}With RK4 the energy falls by 6.936e-7 until t = 10.", {}),
        *((f"{CUP}{said}", {}) for said in COLD),
        *((f"{CUP}{COLD[n].replace(word, other)}", {other: word}) for n, word, other in WARM),
    ],
)
def test_a_direction_is_that_of_the_number_beside_it(text, slips):
    suggestions = Suggestions(text)
    found = [(word.text, suggestions.slips(word)) for word in suggestions.words]
    assert {word: "".join(of.values()) for word, of in found if of} == slips
    assert found or "accuracy" in text


def test_which_of_two_methods_errs_less_is_told_of_the_subject_of_the_sentence():
    question = "ratio(run heun2 lambda=-1 h=0.1 t=1 : error, run rk4 lambda=-1 h=0.1 t=1 : error)"
    for named, sign in (("rk4 costs more than heun's method", f"1 - {question}"), ("heun's method", None)):
        assert signed_by(question, "", f"{named}, and its error is 155 times ", ".") == sign
    assert signed_by(question, "heun's method is like rk4; ", "its error is 155 times ", ".") == f"{question} - 1"


def test_a_number_is_beside_a_word_and_an_order_is_of_a_method():
    assert gap_to_number("", " the error of rk4\nby about ")
    assert not gap_to_number("", " and rises by ")
    assert gap_to_number(" mv too ", "")
    assert fact_in_word("third", "heun's method is not of ", " order.", None) is None
    assert fact_in_word("fifth", "heun's method has an error, and that of rk4 is of ", " order.", None) is None
