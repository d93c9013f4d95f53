"""Right-hand sides from text: exact numbers, powers written out as products, one line for what has no place."""

from __future__ import annotations

from fractions import Fraction

import pytest

from driftproof.methods.field_text import field_of_table, field_of_text, rate_of_text

WRITTEN = {
    "-sin(y0)": "-sin(y0)",
    "0.1*y0 - 3e-2": "((1 / 10) * y0) - (3 / 100)",
    "y0^3": "(y0 * y0 * y0)",
    "-y0**2": "-(y0 * y0)",
    "(-y0)^2": "((-y0) * (-y0))",
    "1/y0^(3/2)": "1 / (y0 * sqrt(y0))",
    "y0^-1": "(1 / (y0))",
    "y0^0 + t": "1 + t",
    "sqrt(1 + y0)*(2 - t)": "sqrt(1 + y0) * (2 - t)",
}


@pytest.mark.parametrize("text", WRITTEN)
def test_expression_is_written_in_products(text):
    assert rate_of_text(text) == WRITTEN[text]
    assert field_of_text([text]).rates == (WRITTEN[text],)


def test_components_are_parted_by_semicolons_or_listed():
    assert field_of_text("y1; -y0") == field_of_text(["y1", "-y0"])


REFUSED = {
    "tan(y0)": r"column 1: there are the functions sin, cos, exp, log, sqrt, of one number",
    "sin(y0, t)": r"column 1: there are the functions",
    "y0^(1/3)": r"column 1: an exponent is a whole number, or half of one",
    "y0; ": r"the right-hand side is empty",
    "y7": r"rate 0, 'y7': 'y7' has no place",
    "__import__('os')": r"has no place in a right-hand side",
    "((y0 + t)^64)^64*(y0^64)^64*(y0^64)^64*(y0^64)^64*(y0^64)^64": r"written out it has more than 100000 characters",
}


@pytest.mark.parametrize("text", REFUSED)
def test_other_text_is_refused_in_one_line(text):
    with pytest.raises(ValueError, match=REFUSED[text]) as caught:
        field_of_text(text)
    assert "\n" not in str(caught.value)


def test_table_holds_rates_and_exact_parameters():
    made = field_of_table({"rates": ["y1", "-k*y0"], "parameters": {"k": "0.1", "m": 3, "r": "1/3"}})
    assert dict(made.parameters) == {"k": Fraction(1, 10), "m": 3, "r": Fraction(1, 3)}
    for wrong, said in (({}, "rates is missing"), ({"rates": ["y0"], "parameters": {"k": "x"}}, "parameters.k")):
        with pytest.raises(ValueError, match=said):
            field_of_table(wrong)
