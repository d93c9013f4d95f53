"""Numbers from text have the value that exact arithmetic gives them, or are refused in one line with a column."""

from __future__ import annotations

import re
from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.formulas.expressions import parse_exact, parse_number, parse_system
from driftproof.methods.numbers.number_field import Exact, cube_root, square_root

S3 = square_root(3)


EXPRESSIONS: list[tuple[str, Exact]] = [
    ("1/4 - s3/6", Q(1, 4) - S3 / 6), ("(3 + s3)/6", (3 + S3) / 6), ("-s3**2", Q(-3)), ("(-s3)**3", -3 * S3),
    ("2 - -3", Q(5)), ("1/2/2", Q(1, 4)), ("1 - 2 - 3", Q(-4)), ("1 + 2*3", Q(7)), ("2*(1 + .5)", Q(3)),
    ("1e2/3", Q(100, 3)), ("2**-2", Q(1, 4)), ("1/s3", S3 / 3), ("\N{MINUS SIGN}1", Q(-1)), ("+ 1_000", Q(1000)),
    ("s3**0", Q(1)), ("0**0", Q(1)), ("(s3 - 1)**-1", (S3 + 1) / 2), ("((2**64)**52)**6 * 2**30", Q(2**19998)),
    ("2**-1/(((2**64)**52)**6 * 2**29)", Q(1, 2**19998)), ("1.5E-1", Q(3, 20)),
    ("1 - sqrt(2)/2", 1 - square_root(2) / 2), ("cbrt(2)**2", cube_root(2) ** 2),
    (f"sqrt({40 * '9'})", square_root(10**40 - 1)),
]  # fmt: skip


@pytest.mark.parametrize(("text", "value"), EXPRESSIONS, ids=range(len(EXPRESSIONS)))
def test_expression_has_the_value_that_arithmetic_gives_it(text: str, value: Exact) -> None:
    assert parse_exact(text, {"s3": S3}, "here") == value
    assert parse_exact(f" ( {text} ) ", {"s3": S3}, "here") != value + 1


@st.composite
def expressions(draw: st.DrawFn, depth: int = 3) -> tuple[str, Exact]:
    """A text and its value, by Python's own arithmetic on exact numbers."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        return draw(st.sampled_from([("2", Q(2)), ("0.7", Q(7, 10)), ("s3", S3), ("3/4", Q(3, 4)), ("11", Q(11))]))
    (left, x), (right, y) = draw(expressions(depth - 1)), draw(expressions(depth - 1))
    sign = draw(st.sampled_from("+-*/"))
    value = {"+": lambda: x + y, "-": lambda: x - y, "*": lambda: x * y, "/": lambda: x / y if y else x + y}[sign]()
    return f"({left}){sign if sign != '/' or y else '+'}({right})", value


@given(expressions())
def test_drawn_expression_has_the_value_that_arithmetic_gives_it(drawn: tuple[str, Exact]) -> None:
    text, value = drawn
    assert parse_exact(text, {"s3": S3}, "here") == value


def refusal(text: str) -> str | None:
    try:
        parse_exact(text, {"s3": S3}, "here")
    except ValueError as error:
        return str(error)
    return None


@given(st.text("0123456789.eE+-*/() s3_xyz,'\"", max_size=30))
def test_any_text_is_a_number_or_is_refused_in_one_line(text: str) -> None:
    line = refusal(text)
    assert line is None or (line.startswith("here: ") and "\n" not in line)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("gamma", "'gamma' is a name; write numbers, sqrt(n) and cbrt(n)"),
        ("sqrt", "'sqrt' is a name"),
        ("sqrt(4)", "the number must exceed 1 and not be a square"),
        ("sqrt(x)", "sqrt takes one integer above 0, as in sqrt(2)"),
        ("sqrt(2", "the bracket of sqrt is not closed; found the end"),
        ("sqrt(2 3)", "the bracket of sqrt is not closed; found '3'"),
        ("sqrt(2, 3)", "sqrt takes one integer"), ("sqrt(2.5)", "sqrt takes one integer"),
        (f"sqrt(1{40 * '0'})", "sqrt takes one integer"), (f"{61 * 'g'}(1)", f"'{57 * 'g'}...' is not a function"),
        (61 * "g", f"'{57 * 'g'}...' is a name"),
        ("((2**64)**52)**6 * 2**31", "column 18: its numbers are too large"),
        ("2**-1/(((2**64)**52)**6 * 2**30)", "column 6: its numbers are too large"),
        ("__import__('os')", "is not allowed"),
    ],
)  # fmt: skip
def test_other_numbers_are_refused_in_one_line(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match="here: ") as caught:
        parse_number(text, "here")
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


def test_system_is_read_by_rows_and_refused_with_its_place() -> None:
    assert parse_system("0 1; -1 -1/10") == parse_system("0, 1; -1, -0.1;") == ((0, 1), (-1, Q(-1, 10)))
    assert parse_system(";".join(12 * [12 * "2 "])) == 12 * (12 * (2,),)
    for text, reason in (
        ("0 1; 1", "the system is not square: row 2 of 2 has 1 entries"),
        ("sqrt(2)", "row 1, entry 1: sqrt(2) is irrational"),
        ("0 1; 1 (1", "row 2, entry 2: '(1', column 3: a bracket is not closed"),
        (";".join(["0"] * 13), "the system has 13 rows; at most 12 are read"),
    ):
        with pytest.raises(ValueError, match=re.escape(reason)):
            parse_system(text)
