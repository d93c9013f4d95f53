"""Families with a parameter: entries are read as functions of it; members are refused at poles and without rows."""

from __future__ import annotations

import re
from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.families import FAMILIES, Family, parse_function
from driftproof.methods.schemes import MethodError
from tests.symbolic.linear.family_examples import THETA


def test_a_member_at_a_pole_is_refused() -> None:
    with pytest.raises(MethodError, match="explicit_order_2: no method at alpha = 0, a pole of its coefficients"):
        FAMILIES["explicit_order_2"].member(Q(0))
    with pytest.raises(MethodError, match="as many rows and columns"):
        Family("x", "X", "t", 0, "x", THETA.a, THETA.b[:1], THETA.c)


def refusal(expression: str) -> str | None:
    try:
        parse_function(expression, "t", "here")
    except ValueError as error:
        return str(error)
    return None


@given(st.text("0123456789./*+-() tx_", max_size=25))
def test_any_text_is_a_function_or_is_refused_in_one_line(expression: str) -> None:
    line = refusal(expression)
    assert line is None or (line.startswith("here: ") and "\n" not in line)


@given(st.text("0123456789t", min_size=1, max_size=9), st.data())
def test_a_function_has_the_values_that_arithmetic_gives_it(atoms: str, data: st.DataObject) -> None:
    """Atoms joined by drawn signs, so that most texts are functions; poles are skipped by the choice of the value."""
    signs = data.draw(st.lists(st.sampled_from(["+", "-", "*", "/"]), min_size=len(atoms), max_size=len(atoms)))
    expression = "".join(f"{sign} ({atom} + 1)" for sign, atom in zip(["+", *signs[1:]], atoms, strict=True))
    value = data.draw(st.fractions(0, 2, max_denominator=7))
    wanted = eval(re.sub(r"\d+", r"Q('\g<0>')", expression), {"Q": Q, "t": value})
    assert parse_function(expression, "t", "here")(value) == wanted
    assert parse_function(f"({expression})*t", "t", "here")(value) == value * wanted
