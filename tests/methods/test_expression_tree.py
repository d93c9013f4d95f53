"""The grammar of expressions: trees as they are written, a column for every refusal, and limits before any work."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.expression_tree import (
    DEEPEST_NESTING,
    LARGEST_POWER,
    LONGEST_EXPRESSION,
    CallNode,
    ChainNode,
    ExpressionError,
    ExpressionParser,
    NameNode,
    NegatedNode,
    NumberNode,
    PowerNode,
    parse_form,
)


def test_tree_is_as_written() -> None:
    tree = ExpressionParser("-a + 2*f(x, 1/4)**(2/3)").tree()
    assert tree == ChainNode(
        1,
        NegatedNode(1, NameNode(2, "a")),
        (
            (
                ExpressionParser("-a + 2").tokens[2],
                ChainNode(
                    6,
                    NumberNode(6, Q(2)),
                    (
                        (
                            ExpressionParser("-a + 2*f").tokens[4],
                            PowerNode(8, CallNode(8, "f", (NameNode(10, "x"), quarter())), Q(2, 3)),
                        ),
                    ),
                ),
            ),
        ),
    )
    assert (
        ExpressionParser("2^-3").tree()
        == ExpressionParser("2**(-3)").tree()
        == PowerNode(1, NumberNode(1, Q(2)), Q(-3))
    )


def quarter() -> ChainNode:
    text = ExpressionParser("            1/4")
    (sign,) = (token for token in text.tokens if token.text == "/")
    return ChainNode(13, NumberNode(13, Q(1)), ((sign, NumberNode(15, Q(4))),))


REFUSED = [
    ("", 1, "the expression is empty; write a number such as 1/4"),
    ("1 $", 3, "'$' has no place in an expression"),
    ("1 = 2", 3, "'=' has no place here; an operator + - * / or the end may follow"),
    ("(1", 3, "a bracket is not closed; the end stands there"),
    ("f(1", 4, "the bracket of f is not closed"),
    ("2**65", 4, "an exponent is an integer from -64 to 64"),
    ("2**0.001", 4, "or a decimal"),
    ("2**x", 4, "an exponent is an integer from -64 to 64"),
    ("2**1e999999999", 4, "an exponent is an integer from -64 to 64"),
    ("2**(1/0)", 8, "an exponent is an integer or a fraction of two"),
    ("1e9999", 1, "is too long"),
    ("\u0663", 1, "has no place in an expression"),
    ("(" * (DEEPEST_NESTING + 1) + "1", DEEPEST_NESTING + 2, "it is nested deeper than 40 levels"),
    ("1" * (LONGEST_EXPRESSION + 1), LONGEST_EXPRESSION + 1, "an expression has at most 2000 characters, not 2001"),
]


@pytest.mark.parametrize(("text", "column", "reason"), REFUSED, ids=range(len(REFUSED)))
def test_refusal_names_the_column_and_what_is_allowed(text: str, column: int, reason: str) -> None:
    with pytest.raises(ExpressionError, match=r"\A[^\n]*\Z") as caught:
        ExpressionParser(text).tree()
    assert reason in caught.value.reason
    assert (caught.value.column, caught.value.text) == (column, text)
    assert f"column {column}: " in str(caught.value)


def test_forms_of_ours_may_be_longer_and_have_larger_powers() -> None:
    power = LARGEST_POWER + 1
    assert ExpressionParser(f"2**{LARGEST_POWER}").tree() == PowerNode(1, NumberNode(1, Q(2)), Q(LARGEST_POWER))
    assert ExpressionParser("2**1.25").tree() == PowerNode(1, NumberNode(1, Q(2)), Q(5, 4))
    assert parse_form(f"h**{power}") == PowerNode(1, NameNode(1, "h"), Q(power))
    assert isinstance(parse_form("+".join(["h"] * LONGEST_EXPRESSION)), ChainNode)
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
