"""What is in print of the references differs from ours only in the last digits, and the page says in which."""

from __future__ import annotations

from fractions import Fraction

from tests.witnesses.references.literature import DOCS, page, published, right_digits, rows


def test_page_is_what_the_numbers_give() -> None:
    assert (DOCS / "reference_digits.md").read_text(encoding="utf-8") == page()


def test_published_numbers_are_right_to_thirteen_digits_and_not_all_to_sixteen() -> None:
    right = [row[5] for row in rows()]
    assert min(right) == 13
    assert max(right) == 16


def test_every_published_state_has_all_components() -> None:
    assert all(len(entry["y"]) in (2, 3, 8) for entry in published())


def test_right_digits_are_counted_to_half_a_unit() -> None:
    assert right_digits("0.1234E+01", Fraction("1.2344")) == 4
    assert right_digits("0.1234E+01", Fraction("1.2346")) == 3
    assert right_digits("0.1234E+01", Fraction("9")) == 0
