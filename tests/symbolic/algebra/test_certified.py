"""Certified decimals: ties, hard cases, refusals, an independent witness, and broken enclosures that are noticed."""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_HALF_EVEN, ROUND_HALF_UP, ROUND_UP, Context, Decimal
from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb, ctx, fmpq
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof.strategies import finite_floats, rationals
from driftproof.symbolic.algebra import certified
from driftproof.symbolic.algebra.certified import (
    FIRST_BITS,
    HALF_AWAY,
    LAST_BITS,
    Uncertified,
    certified_sign,
    enclose,
    endpoints,
    fixed,
    is_less,
    scientific,
    sign_of_ball,
    significant,
)

TIES = [
    (Q(1, 8), 2, "0.12", "0.13"), (Q(3, 8), 2, "0.38", "0.38"), (Q(1, 2), 0, "0", "1"), (Q(3, 2), 0, "2", "2"),
    (Q(5, 2), 0, "2", "3"), (Q(-1, 2), 0, "0", "-1"), (Q(-5, 2), 0, "-2", "-3"), (Q(3, 20), 1, "0.2", "0.2"),
    (Q(1, 20), 1, "0.0", "0.1"), (Q(-1, 20), 1, "0.0", "-0.1"), (Q(1999, 2000), 2, "1.00", "1.00"),
]  # fmt: skip


@pytest.mark.parametrize(("value", "places", "even", "away"), TIES)
def test_tie_of_a_rational_goes_as_named(value: Q, places: int, even: str, away: str) -> None:
    assert fixed(value, places) == even
    assert fixed(value, places, HALF_AWAY) == away


@pytest.mark.parametrize(
    ("rounding", "ours"), [(ROUND_HALF_EVEN, "half-even"), (ROUND_HALF_UP, "half-away"), (ROUND_UP, "away")]
)
@given(value=finite_floats(-60, 60), digits=st.integers(1, 20))
def test_rationals_round_as_the_decimal_module_rounds(value: float, digits: int, rounding: str, ours: str) -> None:
    expected = Context(prec=digits, rounding=rounding).plus(Decimal(value))
    assert Decimal(significant(Q(value), digits, ours)) == expected
    assert Decimal(scientific(Q(value), digits, ours)) == expected


@given(value=rationals(), places=st.integers(0, 30))
def test_fixed_is_within_half_a_unit_and_has_the_places_asked_for(value: Q, places: int) -> None:
    text = fixed(value, places)
    assert abs(Q(text) - value) <= Q(1, 2 * 10**places)
    assert len(text.partition(".")[2]) == places
    assert text.startswith("-") == (Q(text) < 0)


SHOWN = [
    (Q(0), 5, "0"),
    (Q(9995, 1000), 3, "10.0"),  # half-even: 9.995 is a tie between 9.99 and 10.0, and 1000 is even
    (Q(9994, 1000), 3, "9.99"), (Q(99999, 100000), 3, "1.00"), (Q(-9999, 1000), 2, "-10"),
    (Q(1, 10**5), 2, "0.000010"), (Q(99999, 10**10), 3, "0.0000100"), (Q(99, 10**7), 2, "9.9e-6"),
    (Q(12345), 5, "12345"), (Q(123456), 5, "1.2346e5"), (Q(99999), 4, "1.000e5"), (Q(10**300), 1, "1e300"),
    (Q(-1, 3), 1, "-0.3"), (Q(337, 384), 6, "0.877604"),
]  # fmt: skip


@pytest.mark.parametrize(("value", "digits", "text"), SHOWN)
def test_significant_digits_near_powers_of_ten(value: Q, digits: int, text: str) -> None:
    assert significant(value, digits) == text


def test_scientific_always_has_an_exponent_except_for_zero() -> None:
    assert scientific(Q(-67, 10**6), 2) == "-6.7e-5"
    assert scientific(Q(9995, 1000), 3) == "1.00e1"
    assert scientific(Q(5), 1) == "5e0"
    assert scientific(Q(0), 3) == "0"


def test_no_places_is_an_integer_and_fewer_or_no_digits_or_an_unknown_rounding_are_refused() -> None:
    assert fixed(Q(7, 3), 0) == "2"
    few = [(ask, (digits,), "must be at least 1") for ask in (significant, scientific) for digits in (0, -1)]
    unknown = (fixed, (2, "half-up"), "unknown rounding 'half-up'; choose from half-even, half-away")
    for ask, asked, message in (*few, unknown, (fixed, (-1,), "places = -1; must be at least 0")):
        with pytest.raises(ValueError, match=message):
            ask(Q(3), *asked)


def near_tie(numerator: int, exponent: int) -> Callable[[], arb]:
    """(numerator + 10^-exponent) / 2 as balls, so that nothing can be read off a fraction."""
    return lambda: (arb(numerator) + arb(10) ** -exponent) / 2


@pytest.mark.parametrize("exponent", [30, 200, 3000])
def test_number_extremely_near_a_tie_is_decided(exponent: int) -> None:
    above, below = near_tie(1, exponent), lambda: 1 - near_tie(1, exponent)()
    assert (fixed(above, 0), fixed(below, 0)) == ("1", "0")
    assert (fixed(lambda: -above(), 0), fixed(lambda: -below(), 0)) == ("-1", "0")
    assert significant(lambda: above() + 2, 1) == "3"
    assert significant(lambda: below() + 2, 1) == "2"
    assert is_less(below, above)
    assert not is_less(above, below)


def test_precision_is_raised_only_as_far_as_needed() -> None:
    used: list[int] = []

    def value() -> arb:
        used.append(ctx.prec)
        return near_tie(1, 200)()

    before = ctx.prec
    fixed(value, 0)
    assert used[0] == FIRST_BITS
    assert used[-2] < 200 * 3.33 < used[-1]  # 10^-200 takes 200 log2(10), about 664 bits
    assert ctx.prec == before


def half_by_root() -> arb:
    return arb(2).sqrt() ** 2 / 4


def half_by_sixths() -> arb:
    return arb(1) / 6 * 3


@pytest.mark.parametrize("value", [half_by_root, half_by_sixths])
def test_tie_that_no_ball_shows_is_uncertified(value: Callable[[], arb]) -> None:
    with pytest.raises(Uncertified, match=f"undecided with {LAST_BITS} bits"):
        fixed(value, 0)
    assert fixed(value, 1) == "0.5"  # the same number, away from a decision


def test_zero_that_no_ball_shows_is_uncertified_and_an_exact_zero_is_not() -> None:
    with pytest.raises(Uncertified):
        certified_sign(lambda: arb(2).sqrt() ** 2 - 2)
    with pytest.raises(Uncertified):
        is_less(lambda: arb(2).sqrt(), lambda: arb(2).sqrt())
    assert not is_less(Q(1, 3), Q(1, 3))
    assert certified_sign(lambda: arb(0)) == certified_sign(Q(0)) == 0
    assert [sign_of_ball(x) for x in (arb(0.5), arb(-0.5), arb(0), arb(0, 0.1))] == [1, -1, None, None]
    assert [certified_sign(lambda x=x: arb(x, 4.5)) for x in (5, -5)] == [1, -1]
    assert fixed(lambda: arb(2).sqrt() ** 2 - 2, 3) == "0.000"
    assert significant(lambda: arb(0), 5) == "0"


def test_number_without_an_enclosure_is_uncertified() -> None:
    with pytest.raises(Uncertified):
        fixed(lambda: arb("nan"), 2)
    with pytest.raises(Uncertified):
        fixed(lambda: arb(-2).sqrt(), 2)


@pytest.mark.parametrize("exponent", [2**19, 2**60, -(2**19), -(2**60)])
def test_number_too_long_to_write_out_is_refused_at_once(exponent: int) -> None:
    for read in (lambda x: fixed(x, 2), lambda x: significant(x, 3)):
        with pytest.raises(Uncertified, match="too long to write out"):
            read(lambda: arb(2) ** exponent)
    longest = 2**18 if exponent > 0 else -(2**18)
    assert endpoints(arb(2) ** longest)[0] == Q(2) ** longest
    with pytest.raises(Uncertified, match="too long to write out"):
        endpoints(arb(2) ** (longest + (1 if longest > 0 else -1)))


def test_vague_ball_with_a_huge_radius_only_asks_for_more_precision() -> None:
    """As in a run of 10^45 steps: at few bits the ends have exponents beyond all writing, later they do not."""
    assert fixed(lambda: arb(0.125, (1, 2**20 if ctx.prec < 500 else -20)), 3) == "0.125"


def test_endpoints_bracket_a_ball_exactly() -> None:
    with ctx.workprec(64):
        third = enclose(Q(1, 3))
    low, high = endpoints(third)
    assert low < Q(1, 3) < high < low + Q(1, 2**60)
    assert endpoints(arb(0.75)) == (Q(3, 4), Q(3, 4))


def test_reading_the_middle_of_a_ball_would_print_digits_that_are_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    def wide() -> arb:
        return arb(0.52, 0.1)

    with pytest.raises(Uncertified):
        fixed(wide, 1)
    monkeypatch.setattr(certified, "endpoints", lambda ball: certified.ends_of(ball.mid()))
    assert fixed(wide, 1) == "0.5"


@given(rationals(max_denominator=10**6))
def test_ball_of_a_rational_reads_as_the_rational_away_from_decisions(value: Q) -> None:
    assume(10**41 % value.denominator)  # else a decision point of 40 places could be hit
    ball = lambda: arb(fmpq(3 * value.numerator, value.denominator)) / 3
    assert fixed(ball, 40) == fixed(value, 40)
    assert significant(ball, 40) == significant(value, 40)


@pytest.mark.parametrize("foreign", [0.5, "1", None])
def test_what_is_not_exact_is_refused(foreign: Any) -> None:
    with pytest.raises(TypeError, match="exact arithmetic takes int or Fraction"):
        fixed(foreign, 3)
