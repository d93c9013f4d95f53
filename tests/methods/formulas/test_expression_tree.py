"""The grammar of expressions: trees as they are written, a column for every refusal, and limits before any work."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.formulas.expression_tree import (
    CallNode,
    ChainNode,
    ExpressionError,
    ExpressionParser,
    NameNode,
    NegatedNode,
    NumberNode,
    PowerNode,
    Token,
    parse_form,
)
from tests.looping import exactly


def test_tree_is_as_written() -> None:
    tree = ExpressionParser("-a + 2*f(x, 1/4)**(2/3)").tree()
    quarter = ChainNode(13, NumberNode(13, Q(1)), ((Token("sign", "/", 14), NumberNode(15, Q(4))),))
    power = PowerNode(8, CallNode(8, "f", (NameNode(10, "x"), quarter)), Q(2, 3))
    product = ChainNode(6, NumberNode(6, Q(2)), ((Token("sign", "*", 7), power),))
    assert Token("sign", "**", 7).end == 9
    assert tree == ChainNode(1, NegatedNode(1, NameNode(2, "a")), ((Token("sign", "+", 4), product),))
    for text, exponent in (("^-3", Q(-3)), ("**(-3/1)", Q(-3)), ("**1.25", Q(5, 4)), ("**0.015625", Q(1, 64))):
        assert ExpressionParser(f"2{text}").tree() == PowerNode(1, NumberNode(1, Q(2)), exponent)


REFUSED = [
    ("", 1, "the expression is empty; write a number such as 1/4"),
    ("1 $", 3, "'$' is not allowed in an expression"),
    ("1 = 2", 3, "unexpected '='; expected an operator + - * / or the end"),
    ("216s", 4, "unexpected 's'; expected an operator + - * / or the end; numbers have no units"),
    ("(1", 3, "a bracket is not closed; found the end"),
    ("f(1", 4, "the bracket of f is not closed; found the end"),
    (f"{'f' * 600}(1", 603, f"the bracket of {'f' * 482}..."),
    (f"1 {'2' * 61}", 3, f"unexpected '{'2' * 57}...'; expected an operator + - * / or the end"),
    ("2**65", 4, "an exponent is an integer from -64 to 64, or a decimal"),
    ("2**0.001", 4, "an exponent is an integer from -64 to 64, or a decimal"),
    ("2**x", 4, "an exponent is an integer from -64 to 64, or a decimal"),
    ("2**1e999999999", 4, "an exponent is an integer from -64 to 64, or a decimal"),
    ("2**(1/0)", 8, "an exponent is an integer or a fraction of two integers"),
    ("1e9999", 1, "number: '1e9999' is too long; at most 1200 characters, exponent 1200"),
    ("\u0663", 1, "'\u0663' is not allowed in an expression"),
    ("(" * 41 + "1", 42, "it is nested deeper than 40 levels"),
    ("-" * 41 + "1", 42, "it is nested deeper than 40 levels"),
    ("1" * 2001, 2001, "an expression has at most 2000 characters, not 2001"),
]


@pytest.mark.parametrize(("text", "column", "reason"), REFUSED, ids=range(len(REFUSED)))
def test_refusal_names_the_column_and_what_is_allowed(text: str, column: int, reason: str) -> None:
    with pytest.raises(ExpressionError, match=r"\A[^\n]*\Z") as caught:
        ExpressionParser(text).tree()
    assert (caught.value.column, caught.value.text, caught.value.reason) == (column, text, reason)
    quoted = text if len(text) <= 60 else f"{text[:57]}..."
    assert str(caught.value) == f"{quoted!r}, column {column}: {reason}"


def test_forms_of_ours_may_be_longer_and_have_larger_powers() -> None:
    for text in exactly(4, ("2**64", "(" * 40 + "1" + ")" * 40, "+".join(41 * ["(1)"]), "1" + 1999 * " ")):
        assert ExpressionParser(text).tree()
    assert parse_form("h**9999" + " " * 99_993) == PowerNode(1, NameNode(1, "h"), Q(9999))
    for text, reason in (("h**10000", "an exponent is an integer"), ("h" + " " * 100_000, "at most 100000 characters")):
        with pytest.raises(ExpressionError, match=reason):
            parse_form(text)


@given(st.text("0123456789.eE+-*/^() ab_,=:'", max_size=40))
def test_any_text_is_a_tree_or_refused_in_one_line(text: str) -> None:
    try:
        ExpressionParser(text).tree()
    except ExpressionError as error:
        assert "\n" not in str(error)  # noqa: PT017 - whether there is a refusal is not the question
        assert 1 <= error.column <= len(text) + 1  # noqa: PT017
