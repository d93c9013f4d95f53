"""Numbers from text are exact or refused, quickly, and the number of steps is an exact quotient."""

from __future__ import annotations

from fractions import Fraction as Q

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.methods.numbers.rationals import (
    brief,
    exact_number,
    exact_numbers,
    parse_rational,
    state_of,
    step_count,
    step_of,
    steps_of,
)
from driftproof.strategies import finite_floats, rational_steps, rationals

SPELLED = {
    "1/4": Q(1, 4), "0.25": Q(1, 4), "0.1": Q(1, 10), "-1/2": Q(-1, 2), "\N{MINUS SIGN}1/2": Q(-1, 2), " 3 ": Q(3),
    "2.5e-3": Q(1, 400), "1E3": Q(1000), "+7": Q(7), "-0": Q(0), ".5": Q(1, 2), "5.": Q(5), "1_000.5": Q(2001, 2),
    "1e1200": Q(10**1200), "1e-1200": Q(1, 10**1200), "1e1_0": Q(10**10),
}  # fmt: skip


@pytest.mark.parametrize(("text", "value"), SPELLED.items())
def test_text_is_read_exactly(text: str, value: Q) -> None:
    assert parse_rational(text) == value


@given(finite_floats())
def test_every_double_written_in_full_is_read_back(x: float) -> None:
    assert parse_rational(f"{x:.1074f}" if abs(x) < 1 else f"{x:.60f}") == Q(x)
    assert float(parse_rational(repr(x))) == x


CODE = ["__import__('os')", "1+1", "2**3", "h", "[1]", "1;1", "1 2", "lambda: 1", "0x10", "1j", "Fraction(1)"]
MALFORMED = ["", "  ", "abc", "1/", "/2", "1//2", "1/2/3", "1/2.5", "nan", "inf", "-inf", "1e", "1e_5", "--1", "½"]


@pytest.mark.parametrize("text", CODE + MALFORMED)
def test_anything_else_is_refused_in_one_line(text: str) -> None:
    assert refusal(text) == (
        f"h: {text.strip()!r} is not a rational number; write an integer, a fraction like 1/4 or a decimal like 0.25"
    )


@pytest.mark.parametrize(("text", "written"), [("0,1", "0.1"), ("-1,25", "-1.25")])
def test_decimal_comma_is_told_of_the_point(text: str, written: str) -> None:
    assert refusal(text).endswith(f"is not a rational number; write it with a point: {written}")
    if text.startswith("0"):  # two steps, of which one would be 0
        with pytest.raises(ValueError, match=r"write it with a point: 0\.1"):
            steps_of(text)


def test_step_sizes_are_a_list_or_halved_from_one_to_another() -> None:
    assert steps_of("1/4:1/16,-1,2:2") == [Q(1, 4), Q(1, 8), Q(1, 16), Q(-1), Q(2)]
    assert steps_of("-1:-0.5") == steps_of(["-1", "-1/2"]) == [Q(-1), Q(-1, 2)]
    assert len(steps_of(f"1:{Q(1, 2**64)}")) == 65
    for wrong in ("1/4:1/10", "1/16:1/4", "1:-1/2", f"1:{Q(1, 2**65)}"):
        with pytest.raises(ValueError, match=r"does not lead to .*; write a range like 1/4:1/64"):
            steps_of(wrong)
    for zero in ("1:0", "0:1", "1/4,0"):
        with pytest.raises(ValueError, match="the step size h must not be 0"):
            steps_of(zero)


TOO_LONG = ["1e999999999", "1e-999999999", "1e999_999_999", "1E+1201", "1e-1_201", "1" * 1201]
TOO_LONG += ["1e" + "9" * 1000, "2.5e1201 "]


@pytest.mark.parametrize("text", TOO_LONG, ids=lambda text: text[:20])
def test_short_text_for_a_huge_number_is_refused_at_once(text: str) -> None:
    assert refusal(text).endswith("is too long; at most 1200 characters, exponent 1200")


def test_refusal_shows_forty_characters_at_most_and_no_line_break() -> None:
    assert refusal("x" * 41).startswith(f"h: '{'x' * 37}...' is not")
    refusal("1\n2")
    assert refusal("1/0").startswith("h: '1/0' divides by zero; write")


def test_number_in_a_message_is_cut_where_it_is_too_long_and_only_there() -> None:
    longest = Q(10**39)
    assert (brief(longest), brief(-longest)) == (str(longest), f"-1{35 * '0'}...")
    assert parse_rational("0" * 1199 + "7") == 7


def refusal(text: str) -> str:
    with pytest.raises(ValueError, match=r"^h: ") as caught:
        parse_rational(text, "h")
    assert "\n" not in str(caught.value)
    return str(caught.value)


@given(rational_steps(), st.integers(0, 10**7))
def test_step_count_inverts_multiplication(h: Q, n: int) -> None:
    assert step_count(n * h, h) == n


@pytest.mark.slow
@given(rational_steps(), rationals())
def test_step_that_does_not_divide_names_the_two_nearest_that_do(h: Q, t: Q) -> None:
    quotient = t / h
    assume(quotient > 1 and quotient.denominator > 1)
    with pytest.raises(ValueError, match="does not divide") as caught:
        step_count(t, h)
    first, second = (Q(text) for text in str(caught.value).split("nearest that do: ")[1].split(" and "))
    n = step_count(t, first)
    assert step_count(t, second) == n + 1
    assert abs(second) < abs(h) < abs(first)


def test_step_count_messages_name_the_way_out() -> None:
    assert step_count_refusal(Q(1), Q(2)) == "h = 2 does not divide t = 1 (t / h = 1/2); nearest that do: 1"
    assert step_count_refusal(Q(1), Q(0)) == "h = 0 never reaches t = 1; choose h with t / h a whole number"
    assert step_count_refusal(Q(1), Q(-2)) == "h = -2 leads away from t = 1; give h the sign of t"
    assert step_count_refusal(Q(10), Q(3, 10)).endswith("(t / h = 100/3); nearest that do: 10/33 and 5/17")


def step_count_refusal(t: Q, h: Q) -> str:
    with pytest.raises(ValueError, match="h = ") as caught:
        step_count(t, h)
    return str(caught.value)


def test_number_that_is_given_is_taken_exactly() -> None:
    for number, value in ((0.25, Q(1, 4)), (-1048576.0, Q(-(2**20))), (7, Q(7)), (Q(1, 3), Q(1, 3)), ("0.1", Q(1, 10))):
        assert exact_number(number) == value
        assert type(exact_number(number)) is Q
    assert exact_numbers("1/4, 0.5", "h") == exact_numbers(["1/4", 0.5], "h") == [Q(1, 4), Q(1, 2)]
    assert steps_of(2) == exact_numbers(Q(2), "h") == [Q(2)]
    assert (steps_of("1,2"), steps_of("0.5,1")) == ([1, 2], [Q(1, 2), 1])
    assert state_of("1, -1/2") == state_of((1, Q(-1, 2))) == (1, Q(-1, 2))


@pytest.mark.parametrize(
    ("read", "wrong", "reason"),
    [
        (exact_number, 0.1, '^number: the double 0.1 is not 0.1 exactly; write "0.1" for the decimal'),
        (exact_number, True, "^number is 'True'; give a Fraction, an int, or text"),
        (exact_number, float("nan"), "^number is 'nan'; give"),
        (exact_number, 0.5j, "^number is '0.5j'; give"), (step_of, "0", "^the step size h must not be 0"),
        (steps_of, "1/4,0.0", "^the step size h must not be 0"),
        (steps_of, "1/4,x", "^h: 'x' is not"),
        (state_of, "1", "^'1' is not a state; write position,velocity like 1,0"),
        (state_of, (1, 0, 0), "is not a state"), (state_of, "x,0", "^q: 'x'"), (state_of, "0,x", "^v: 'x'"),
    ],
)  # fmt: skip
def test_number_that_is_not_plainly_meant_is_refused(read, wrong, reason) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError, match=reason):
        read(wrong)
