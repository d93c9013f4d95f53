"""Every number of a text is found, whole, with its sign, and those that belong to names are told from the rest."""

from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.readers.document import document_of
from driftproof.texts.readers.numbers import numbers_in

# text in a file, its numbers, its labels
CASES = [
    ("q = −0.5, v = +1 and 3 − 2", ["-0.5", "+1", "3", "2"], []),
    ("(−3, −2), (5,4)", ["-3", "-2", "5", "4"], []), ("2.390297.", ["2.390297"], []),
    ("337/384 and ½(q² + v²)", ["337/384", "1/2", "2", "2"], []),
    ("3.3e-4, 3.3×10⁻⁴, 6.7·10^5", ["3.3e-4", "3.3×10^{-4}", "6.7·10^5"], []),
    ("1 − h⁶/72 + h⁸/576", ["1", "6", "72", "8", "576"], []),
    ("5,651 or 5 651 or 1'000'000", ["5,651", "5", "651", "1'000'000"], []),
    ("is 8/9. And 3.3e-4. Then 1/2/3, 2/3.5", ["8/9", "3.3e-4", "1", "2", "3", "2", "3.5"], []),
    ("12.5 %, 180°, 2√2, .5", ["12.5", "180", "2", "2", ".5"], []),
    ("RK4 float64 k1 atan2(v)", [], ["4", "64", "1", "2"]),
    ("q₁ = 1, vₙ₊₁, x_{12}", ["1"], ["1", "1", "12"]),
    ("Section 2, Figure 3 and Exercise 4; §5, eq. (6)", [], ["2", "3", "4", "5", "6"]),
    ("version 2.7.1 of 2024-05-01, see [12]", [], ["2.7.1", "2024-05-01", "12"]),
    ("1. first\n2) second, 3 things", ["3"], ["1", "2"]), ("https://x.org/4/v5 and 6", ["6"], ["4", "5"]),
    ("f'{x:.6f}' of 6, {: .3e}, {:5.1%}", ["6"], [".6", ".3", "5.1"]),
    ("RK4: 8.3e-6, Heun: 1.5 %, Euler: 20.7%", ["8.3e-6", "1.5", "20.7"], ["4"]),
    ("y(0) = 1, R(-1/2), θ'(1.5) in f(x, 2) and sin(3)", ["1", "2", "3"], ["0", "-1/2", "1.5"]),
    ("It ends.\n2.1 More of it\nIt is\n2.5 Volt at y.\n3.1 Volt.\n", ["2.5", "3.1"], ["2.1"]),
    ("# 2 Title\n## 2.1 More\n# 12. Last", [], ["2", "2.1", "12"]),
    ("x # 2.828427\n# 0.5 is left, issue #12\n# 3 steps #4.5", ["2.828427", "0.5", "3", "4.5"], ["12"]),
    ("k1[0] and [1, 2]", ["1", "2"], ["1", "0"]), ("2h, 4th and 0.5h", ["2", "4", "0.5"], []),
    ("two of four, ten", [], []),
    ("RK40.499895 is a cell that ran together", ["40.499895"], []),
]  # fmt: skip


@pytest.mark.parametrize(("text", "expected", "labels"), CASES)
def test_numbers_and_labels_of_a_text(text, expected, labels):
    found = numbers_in(document_of(text).text.text)
    assert [number.text for number in found if number.label is None] == expected
    assert [number.text for number in found if number.label is not None] == labels


@pytest.mark.parametrize(
    ("text", "value", "places"),
    [
        ("-0.50", Fraction(-1, 2), 2), ("337/384", Fraction(337, 384), None),
        ("3.3×10^{-4}", Fraction(33, 100_000), None), ("5,651", Fraction(5651), 0),
    ],
)  # fmt: skip
def test_number_spells_a_value(text, value, places):
    (number,) = numbers_in(text)
    assert (number.value, number.places) == (value, places)


@given(st.text(alphabet="0123456789.,-+/eE^_{}()[]' ×%hq\n"))
def test_every_digit_belongs_to_one_number(text):
    found = numbers_in(text)
    covered = {i for number in found for i in range(number.start, number.end)}
    assert {i for i, character in enumerate(text) if character.isdigit()} <= covered
    assert all(a.end <= b.start for a, b in pairwise(found))


@pytest.mark.parametrize(
    ("read", "refused"), [("1" * 1000, "1" * 1001), ("1e999", "1e1000"), ("1e-999", "1e-1000"), ("0/1", "1/0")]
)
def test_numbers_that_nobody_writes_have_no_value(read, refused):
    assert numbers_in(read)[0].value == Fraction(read)
    with pytest.raises((ValueError, ZeroDivisionError), match=r"is too long|, 0"):
        _ = numbers_in(refused)[0].value


def test_a_reference_is_known_by_the_longest_of_its_words():
    assert [number.label for number in numbers_in("Propositions (5) and (6")] == ["a reference", None]
