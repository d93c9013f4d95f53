"""Arithmetic on answers is what Python's Fractions make of it."""

from dataclasses import dataclass
from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value


@dataclass(frozen=True)
class Sum:
    """A text of the language's grammar, and the number that it should be: None where something divides by zero."""

    text: str
    number: Q | None


def combined(a, b, sign):
    text = f"({a.text} {sign} {b.text})"
    if a.number is None or b.number is None or (sign == "/" and not b.number):
        return Sum(text, None)
    found = {"+": a.number + b.number, "-": a.number - b.number, "*": a.number * b.number}
    return Sum(text, a.number / b.number if sign == "/" else found[sign])


def powered(a, n):
    return Sum(f"({a.text})**{n}", None if a.number is None or (n < 0 and not a.number) else a.number**n)


NUMBERS = st.one_of(
    st.integers(0, 99).map(lambda n: Sum(str(n), Q(n))),
    st.decimals(0, 99, places=3).map(lambda x: Sum(f"{x:f}", Q(x))),
    st.builds(lambda p, q: Sum(f"({p}/{q})", Q(p, q)), st.integers(0, 9), st.integers(1, 9)),
    st.just(Sum("(step rk4 h=1/2 : q)", Q(337, 384))),
    st.just(Sum("order rk4", Q(4))),
)
SUMS = st.recursive(
    NUMBERS,
    lambda inner: st.one_of(
        st.builds(combined, inner, inner, st.sampled_from("+-*/")),
        st.builds(powered, inner, st.integers(-3, 3)),
        inner.map(lambda a: Sum(f"-{a.text}", None if a.number is None else -a.number)),
        inner.map(lambda a: Sum(f"abs({a.text})", None if a.number is None else abs(a.number))),
    ),
    max_leaves=8,
)


@given(SUMS)
def test_arithmetic_is_that_of_fractions(made):
    if made.number is None:
        with pytest.raises(QuestionError, match="division by zero"):
            value(made.text)
    else:
        assert value(made.text).exact == made.number


def test_units_follow_the_arithmetic():
    angle = "run rk4 h=1/4 t=10 : phase_error"
    assert value(f"2 * ({angle})").unit == "degrees"
    assert value(f"{angle} + 180").unit == "degrees"
    assert value(f"({angle}) / ({angle} deg)").unit is None
    assert value(f"percent({angle}, {angle})").unit == "%"
    assert value(f"-({angle} rad)").unit == "radians"
    assert value(f"({angle}) ** 1").unit == "degrees"


def test_roots_of_different_fields_are_enclosed():
    for question, wanted in {
        "sqrt(2) + 2**(1/3)": 2.6741346,
        "5**(1/5)": 1.3797297,
        "sqrt(2) * sqrt(3)": 2.4494897,
        "(3**65) ** (1/65)": "3.0000000",
        "log2(3)": 1.5849625,
    }.items():
        assert (value(question).evidence, value(question).digits(8)) == ("CERTIFIED", str(wanted))


def test_evidence_is_the_weakest_of_the_parts():
    assert value("1 + order rk4").evidence == "DERIVED"
    assert value("stages rk4 * order rk4").evidence == "COUNTED"
    assert value("stages rk4 * cos(1)").evidence == "CERTIFIED"
    assert [value(f"0 * 2**{n}").evidence for n in (2**17, 2**17 + 1)] == ["DERIVED", "CERTIFIED"], "of 2**18 bits"
    assert value("claimed_order rk4 + stages rk4").evidence == "STATED"


@pytest.mark.slow
def test_remarks_stay_with_what_is_computed_and_are_not_repeated():
    order = "order dormand_prince853"
    asked = [text.format(order, order) for text in ("2 * {}", "1 - {}", "-({})", "sqrt({})", "({}) ** 2", "{} + {}")]
    assert {value(question).remark for question in asked} == {value(order).remark} != {None}
    assert value("2 * order rk4").remark is None
