"""Calculations that a text prints are asked as they stand, and what is part of a longer formula or a date is not."""

import pytest

from driftproof.texts.drafts.drafting import draft
from driftproof.texts.drafts.members import SLIP
from driftproof.texts.readers.document import document_of
from driftproof.texts.words.calculations import calculations_in


@pytest.mark.parametrize(
    ("text", "question", "places"),
    [
        ("multiplies by 1/(1+0.2) = 0.8333", "1/(1+0.2)", "0.8333"),
        ("h < 2/0.8 = 2.5", "2/0.8", "2.5000"),
        ("y_1 = 5 - 0.25 · 4 = 4", "5 - 0.25 * 4", "4.0000"),
        ("√2/2 ≈ 0.7071", "sqrt(2)/2", "0.7071"),
        ("2π ≈ 6.2832", "2*pi", "6.2832"),
        ("2π √(1/4) ≈ 3.1416", "2*pi*sqrt(1/4)", "3.1416"),
        ("√(2 + 1) = 1.7321", "sqrt(2 + 1)", "1.7321"),
        ("log_2 2.028 = 1.0201", "log2(2.028)", "1.0201"),
        ("2^{10} = 1024", "2**(10)", "1024.0000"),
        ("multiplies by e^{-0.6} = 0.5488", "exp(-0.6)", "0.5488"),
    ],
)
def test_calculation_is_a_question(text, question, places):
    (found,) = calculations_in(text)
    assert (found.question, found.answer.places(4)) == (question, places)
    assert text[found.result :] in (places, places.rstrip("0").rstrip("."))


@pytest.mark.parametrize(
    "text",
    [
        "sin 30/2 = 0.5",
        "x - 2/3 = 5",
        "g 2/3 = 5",
        "2x/3 = 4",
        "h = 0.1",
        "(1, 2) = 3",
        "1/0 = 3",
        "2 + 1",
        "5/3 of it",
        "π ≈ 3.1415",  # cut off
    ],
)
def test_part_of_a_formula_is_none(text):
    assert not calculations_in(text)


def test_result_is_drafted_with_its_calculation_and_a_wrong_one_is_a_slip():
    right, wrong = (draft(document_of(f"The factor is 0.9/1.1 = {x}."), "a") for x in ("0.8182", "0.8128"))
    assert 'phrase = "0.9/1.1 = {value}"\nvalue = "0.9/1.1"\nplaces = 4\n' in right
    assert SLIP not in right
    assert f"0.8128 {SLIP} 0.9/1.1 is 0.8182\n" in wrong
    assert "{value}" not in wrong
