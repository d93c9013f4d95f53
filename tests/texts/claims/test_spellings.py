"""The form, the spelling and the telling digits of a number in a text, and its slips."""

import pytest

from driftproof.texts.claims.phrases import NumberForm
from driftproof.texts.claims.spellings import digits_of, form_of, slips, spelled
from driftproof.texts.readers.numbers import numbers_in


@pytest.mark.parametrize(
    ("text", "spelling", "form"),
    [
        ("337/384", "337/384", NumberForm(exact=True)),
        ("3.3×10^{-4}", "3.3e-4", NumberForm(digits=2)),
        ("1.5e-03", "1.5e-3", NumberForm(digits=2)),
        ("1.20", "1.20", NumberForm(places=2)),
        (".5", "0.5", NumberForm(places=1)),
        ("1,000", "1000", NumberForm()),
        ("159 %", "159", NumberForm(digits=3)),
    ],
)
def test_a_number_is_spelled_as_values_are(text, spelling, form):
    (number,) = numbers_in(text)
    assert (spelled(number), form_of(number, text)) == (spelling, form)


def test_telling_digits_are_those_before_the_zeros_of_a_round_value():
    assert [digits_of(text) for text in ("0.0120", "1.000", "2.5e-10", "-40")] == ["120", "1000", "25", "40"]
    assert [digits_of(text, telling=True) for text in ("1.000", "4.0", "0.50", "1000", "1.2300")] == [
        *("1", "4", "50", "1000", "123")
    ]


def test_slips_are_another_sign_first_then_neighbours_exchanged_and_each_other_digit():
    first, *others = slips("1.2")
    assert first == "-1.2"
    assert others[0] == "2.1"
    assert {*others} == {"2.1", *(f"{n}.2" for n in range(10)), *(f"1.{n}" for n in range(10))} - {"1.2"}
    assert next(slips("-1.2")) == "1.2"
