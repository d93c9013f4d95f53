"""The numbers that the lesson prints are the correctly rounded values of the quantities that they stand for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import pytest

from driftproof.methods.numbers.number_field import square_root
from driftproof.symbolic.algebra.certified import CertifiableReal
from proofs.claims import CERTIFIED, claim
from proofs.printed import ROWS, TECHNIQUES, Printed, published


@pytest.mark.parametrize(
    "row",
    [
        pytest.param(
            row,
            marks=claim(row.claim, evidence=row.quantity.evidence, by=TECHNIQUES[row.quantity.evidence]),
            id=row.claim,
        )
        for row in ROWS
    ],
)
def test_printed_number_spells_the_value(row: Printed, publish: Any) -> None:
    """The printed digits are those of the exact value, equal or correctly rounded."""
    value = row.quantity.value()
    assert row.text == row.spelling(row.text)
    assert isinstance(value, Fraction) == (row.quantity.evidence != CERTIFIED)
    publish(row.id, row.text, value)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.claim)
def test_every_other_digit_is_noticed(row: Printed) -> None:
    """A number that differs from a printed one in a single digit or in its sign is rejected."""
    misprints = [text for text in _misprints(row.text) if text == row.spelling(text)]
    assert misprints == []


def _misprints(text: str) -> Iterator[str]:
    for i, character in enumerate(text):
        if character.isdigit():
            yield from (text[:i] + digit + text[i + 1 :] for digit in "0123456789" if _differs(digit, i, text))
    if any(character in "123456789" for character in text):
        yield text.removeprefix("-") if text.startswith("-") else f"-{text}"


def _differs(digit: str, i: int, text: str) -> bool:
    changed = text[:i] + digit + text[i + 1 :]
    return digit != text[i] and not changed.endswith("/0")


@pytest.mark.parametrize(
    ("text", "value"),
    [("√3", square_root(2)), ("4", Fraction(3)), ("0.6", Fraction(1, 2)), ("337/385", Fraction(337, 384))],
)
def test_a_text_that_is_not_the_value_is_not_published(text: str, value: CertifiableReal) -> None:
    """Neither a root, nor a count, nor a decimal, nor a ratio that was typed; the right ones of all proofs are."""
    with pytest.raises(ValueError, match=f"L005 prints {text}, and methods is "):
        published("L005", "PROVED", "methods", text, value)


def test_no_claim_prints_two_numbers() -> None:
    """Each row has a claim of its own."""
    assert [claim for claim, times in Counter(row.claim for row in ROWS).items() if times > 1] == []
    assert len(ROWS) >= 90
