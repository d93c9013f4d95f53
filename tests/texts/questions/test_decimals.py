"""Digits in a style: every rounding policy against Python's decimal."""

from decimal import ROUND_DOWN, ROUND_HALF_EVEN, ROUND_HALF_UP, ROUND_UP, Context, Decimal, localcontext
from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.decimals import FIXED, PLAIN, PRINTED, SIGNIFICANT, Style, rounded
from driftproof.texts.questions.errors import AmbiguousRounding
from driftproof.texts.questions.evaluate import value

IN_DECIMAL = {"half-even": ROUND_HALF_EVEN, "half-away": ROUND_HALF_UP, "away": ROUND_UP}
# Decimals with few digits, so that ties are as frequent as they are in texts.
SHORT = st.builds(lambda n, k: Q(n, 10**k), st.integers(-(10**7), 10**7), st.integers(0, 6))


def quantized(x, places, rounding):
    with localcontext(Context(prec=60)):
        exact = Decimal(x.numerator) / x.denominator
        return exact.quantize(Decimal(1).scaleb(-places), rounding=rounding)


@given(SHORT, st.integers(0, 7), st.sampled_from(sorted(IN_DECIMAL)))
def test_places_are_rounded_as_decimal_rounds(x, places, rounding):
    found = rounded(x, FIXED, places, Style(rounding))
    assert Decimal(found) == quantized(x, places, IN_DECIMAL[rounding])
    assert len(found.partition(".")[2]) == places
    assert found.strip("-0.") or not found.startswith("-")


@given(SHORT.filter(bool), st.integers(1, 9), st.sampled_from(sorted(IN_DECIMAL)))
def test_digits_are_rounded_as_decimal_rounds(x, digits, rounding):
    with localcontext(Context(prec=digits, rounding=IN_DECIMAL[rounding])):
        expected = Decimal(x.numerator) / x.denominator
    assert Decimal(rounded(x, SIGNIFICANT, digits, Style(rounding))) == expected


@given(SHORT, st.integers(0, 7))
def test_tie_is_refused_exactly_where_the_policies_differ(x, places):
    even, away = (rounded(x, FIXED, places, Style(rounding)) for rounding in ("half-even", "half-away"))
    answer = Answer("a question", x)
    if even == away:
        assert answer.places(places) == even
    else:
        said = f"half-even gives {even}, half-away {away}; choose a rounding"
        with pytest.raises(AmbiguousRounding, match=said) as refused:
            answer.places(places)
        assert refused.value.column == 1


def test_styles_write_the_sign_and_the_exponent():
    small = value("-67/1000000 - 1/10**7")
    assert small.digits(2) == "-0.000067"
    assert small.digits(2, PRINTED) == "−0.000067"
    tiny = value("-1/30000000")
    assert [tiny.digits(2, style) for style in (PLAIN, PRINTED)] == ["-3.3e-8", "−3.3×10⁻⁸"]
    assert tiny.digits(2, Style(exponent="×10")) == "-3.3×10⁻⁸"
    assert tiny.digits(2, Style(minus="−")) == "−3.3e−8"
    assert value("12345678 * 10").digits(3, PRINTED) == "1.23×10⁸"
    assert value("0").digits(3, PRINTED) == "0"


@pytest.mark.parametrize("wrong", [{"rounding": "up"}, {"minus": "~"}, {"exponent": "E"}])
def test_unknown_style_is_refused(wrong):
    with pytest.raises(ValueError, match="is unknown; choose one of"):
        Style(**wrong)


@pytest.mark.parametrize("rounding", IN_DECIMAL)
def test_irrational_numbers_are_never_refused_and_never_tied(rounding):
    with localcontext(Context(prec=70, rounding=ROUND_DOWN)):
        root = Decimal(2).sqrt()
    for n in range(1, 50):
        expected = root.quantize(Decimal(1).scaleb(-n), rounding=IN_DECIMAL[rounding], context=Context(prec=70))
        assert Decimal(value("sqrt(2)").places(n, Style(rounding))) == expected
