"""Digits in a style: every rounding policy against Python's decimal, toFixed against the standard and an engine."""

import json
import shutil
import subprocess
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, ROUND_HALF_UP, ROUND_UP, Context, Decimal, localcontext
from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.decimals import FIXED, PLAIN, PRINTED, SIGNIFICANT, Style, rounded
from driftproof.texts.questions.errors import AmbiguousRounding, QuestionError
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


def double_to_fixed(x, places):
    """ECMA-262, Number.prototype.toFixed, by its own words: let n be an integer for which n / 10ᶠ - x is as close to
    zero as possible; if there are two such n, pick the larger one; the sign of x is set aside first.
    """
    double = Q(float(x))
    sign, size = ("-", -double) if double < 0 else ("", double)
    floor = size * 10**places // 1
    n = min((floor, floor + 1), key=lambda n: (abs(Q(n, 10**places) - size), -n))
    digits = str(n).rjust(places + 1, "0")
    return sign + (f"{digits[:-places]}.{digits[-places:]}" if places else digits)


TO_FIXED = [
    (Q(1, 8), 2, "0.13"), (Q(-1, 8), 2, "-0.13"), (Q(5, 2), 0, "3"), (Q("1.005"), 2, "1.00"), (Q("0.615"), 2, "0.61"),
    (Q("1.45"), 1, "1.4"), (Q("8.345"), 2, "8.35"), (Q("-0.001"), 2, "-0.00"), (Q(0), 2, "0.00"),
    (Q("123456789012345680000"), 1, "123456789012345683968.0"),
    (Q(1, 10**7), 10, "0.0000001000"), (Q(1, 2**60), 100, ""), (Q(1, 10**400), 3, "0.000"),
]  # fmt: skip


@pytest.mark.parametrize(("x", "places", "text"), TO_FIXED)
def test_to_fixed_is_what_the_standard_says(x, places, text):
    found = rounded(x, FIXED, places, Style("tofixed"))
    assert found == double_to_fixed(x, places)
    assert text in ("", found)


@given(SHORT, st.integers(0, 20))
def test_to_fixed_rounds_the_nearest_double_and_a_tie_away_from_zero(x, places):
    assert rounded(x, FIXED, places, Style("tofixed")) == double_to_fixed(x, places)
    rounded_first = quantized(Q(float(x)), places, ROUND_HALF_UP) if places < 8 else None
    assert rounded_first is None or Decimal(double_to_fixed(x, places)) == rounded_first


NODE = shutil.which("node")


@pytest.mark.slow
@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_to_fixed_and_to_precision_are_those_of_a_javascript_engine():
    grid = [Q(n, 1000) for n in range(-3000, 3000, 5)] + [x for x, *_ in TO_FIXED]
    asked = [(float(x), places) for x in grid for places in (0, 1, 2, 3, 6)]
    program = (
        "const asked = JSON.parse(require('fs').readFileSync(0, 'utf8'));"
        "console.log(JSON.stringify(asked.map(([x, n]) => [x.toFixed(n), x === 0 ? '0' : x.toPrecision(n + 1)])));"
    )
    done = subprocess.run(
        [str(NODE), "-e", program], input=json.dumps(asked), capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    style = Style("tofixed")
    for (x, n), (fixed, precise) in zip(asked, json.loads(done.stdout), strict=True):
        assert rounded(Q(x), FIXED, n, style) == fixed, (x, n)
        assert Decimal(rounded(Q(x), SIGNIFICANT, n + 1, style)) == Decimal(precise), (x, n)


def test_digits_under_to_fixed_are_those_of_the_nearest_double():
    assert value("1.005").digits(3, Style("tofixed")) == "1.00"
    assert value("1.005").digits(3, Style("half-away")) == "1.01"


def test_to_fixed_of_an_enclosed_number_goes_through_its_nearest_double():
    root = value("sqrt(2)")
    assert root.places(20, Style("tofixed")) == double_to_fixed(Q(2**0.5), 20) == "1.41421356237309514547"
    assert root.places(20) == "1.41421356237309504880"


@pytest.mark.parametrize(
    ("question", "places"),
    [("10**21", 2), ("-10**21", 2), ("1/3", 101), ("10**60 * 10**60 * 10**60 * 10**60 * 10**60 * 10**60", 1)],
)
def test_to_fixed_is_refused_where_javascript_has_no_such_text(question, places):
    with pytest.raises(QuestionError, match="toFixed"):
        value(question).places(places, Style("tofixed"))


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
