"""Certified decimals: an exact number is enclosed by Arb balls until every digit asked for is settled."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import ceil
from typing import TypeAlias, TypeVar

from flint import arb, ctx, fmpz

from driftproof.methods.numbers.flint_rationals import as_fmpq, ends_of
from driftproof.methods.numbers.number_field import Algebraic
from driftproof.support.plain_text import unknown

# A real number, known exactly: a rational, an element of a number field, or a procedure that returns an Arb ball around
# the number, which shrinks as Arb's current precision grows.
CertifiableReal: TypeAlias = Fraction | Algebraic | Callable[[], arb]
T = TypeVar("T")


class EnclosedReal:
    """A real number known by enclosures: a call returns a ball at Arb's precision, `repr` fifteen digits."""

    def __init__(self, ball: Callable[[], arb]) -> None:
        """Keep the procedure that returns a ball; nothing is enclosed yet."""
        self._ball = ball

    def __call__(self) -> arb:
        """A ball around the number, at Arb's current precision."""
        return self._ball()

    def __float__(self) -> float:
        """The double nearest to the number."""
        return decide_by_enclosure(self, float)

    def __repr__(self) -> str:
        """The number correctly rounded to fifteen significant digits, or a ball if no enclosure settles them."""
        try:
            return significant(self, 15)
        except Uncertified:
            return str(self())


HALF_EVEN = "half-even"
HALF_AWAY = "half-away"
AWAY = "away"
ROUNDINGS = (HALF_EVEN, HALF_AWAY, AWAY)

# First precisions in bits, doubled until they suffice. Chosen: 64 to isolate roots and wherever no digits are printed;
# 128, or 38 digits, where they are, as most numbers are printed to 31.
ISOLATING_BITS, FIRST_BITS = 64, 128
# The precision at which `settled` gives up. Of the numbers that this project prints, only ties are undecided there.
LAST_BITS = 1 << 17
# Binary exponents beyond this are refused rather than written out as fractions of gigabytes.
LARGEST_BINARY_EXPONENT = 1 << 18


class Uncertified(ArithmeticError):
    """No enclosure up to LAST_BITS settled the question: the number is on the decision point, or has no enclosure."""


def enclose(value: CertifiableReal) -> arb:
    """An Arb ball that contains `value`, at Arb's current precision. Raises TypeError if `value` is not exact."""
    if callable(value):
        return value()
    return value.ball() if isinstance(value, Algebraic) else arb(as_fmpq(value))


def decide_by_enclosure(value: CertifiableReal, read: Callable[[Fraction], T]) -> T:
    """Return read(value) for a monotone `read` that is constant between jumps, by Ziv's loop (ziv-1991, section 2).

    The precision doubles until `read` agrees at both ends of the enclosure; a rational is passed to `read` directly, so
    ties of rationals are exact. Raises Uncertified if LAST_BITS do not separate the number from a jump of `read`.
    If the number is irrational and the jumps are rational, more bits always would.
    """
    if isinstance(value, int | Fraction):
        return read(Fraction(value))

    def at_both_ends() -> T | None:
        ball = enclose(value)
        if not ball.is_finite() or (ball.rad() > 1 and ball.contains(0)):
            return None  # it settles nothing, and its ends may be too long to write out
        at_low, at_high = map(read, endpoints(ball))
        if at_low != at_high and 2 * ctx.prec > LAST_BITS and (near := near_zero(ball)):
            raise Uncertified(f"undecided with {LAST_BITS} bits: {near}")
        return at_low if at_low == at_high else None

    return settled(at_both_ends, FIRST_BITS)


def near_zero(ball: arb) -> str:
    """What a ball around 0 shows of its number; "" for another ball, and for one as wide as 1.

    >>> near_zero(arb("0 +/- 1e-30")), near_zero(arb(2))
    ('0, which no enclosure shows, or below 1e-29 in size', '')
    """
    if not (ball.contains(0) and 0 < ball.abs_upper() < 1):
        return ""
    power = (arb(ball.abs_upper()).log() / arb(10).log()).ceil().unique_fmpz()
    return f"0, which no enclosure shows, or below 1e{power} in size"


def settled(read: Callable[[], T | None], bits: int = ISOLATING_BITS, last: int = LAST_BITS) -> T:
    """Return the first result of `read` that is not None, as Arb's precision doubles from `bits` to `last`.

    `read` returns None while its balls are too wide to decide. Raises Uncertified if they are at every precision.
    """
    while bits <= last:
        with ctx.workprec(bits):
            answer = read()
        if answer is not None:
            return answer
        bits *= 2
    raise Uncertified(f"undecided with {last} bits: the number is on a rounding boundary, or too close to one")


def sign_of_ball(ball: arb) -> int | None:
    """The common sign of all numbers in the ball, 1 or -1; None if the ball contains 0."""
    return (ball > 0) - (ball < 0) or None


def endpoints(ball: arb) -> tuple[Fraction, Fraction]:
    """The two ends of a finite ball, as exact rationals."""
    for part in (ball.mid(), ball.rad()):
        if abs(int(part.man_exp()[1])) > LARGEST_BINARY_EXPONENT:
            raise Uncertified("the number is outside 10**-78000 .. 10**78000 and too long to write out")
    return ends_of(ball)


def certified_sign(value: CertifiableReal) -> int:
    """The sign -1, 0 or 1, certified. Raises Uncertified for a zero that is neither rational nor enclosed exactly."""
    return decide_by_enclosure(value, lambda x: (x > 0) - (x < 0))


def is_less(a: CertifiableReal, b: CertifiableReal) -> bool:
    """True if a < b, certified by disjoint enclosures. Raises Uncertified if a = b, unless both are rationals."""
    if isinstance(a, int | Fraction) and isinstance(b, int | Fraction):
        return a < b
    return certified_sign(lambda: enclose(a) - enclose(b)) == -1


def fixed(value: CertifiableReal, places: int, rounding: str = HALF_EVEN) -> str:
    """`value` correctly rounded to `places` digits after the point, e.g. "-0.479167". A zero has no sign.

    Raises ValueError if places < 0, Uncertified if the number is too close to where the rounding changes.

    >>> from fractions import Fraction
    >>> from driftproof import fixed
    >>> fixed(Fraction(-23, 48), 6)
    '-0.479167'
    """
    if places < 0:
        raise ValueError(f"places = {places}; must be at least 0")
    return decide_by_enclosure(value, lambda x: _fixed(x, places, rounding))


def significant(value: CertifiableReal, digits: int, rounding: str = HALF_EVEN) -> str:
    """`value` correctly rounded to `digits` significant digits: plain from 1e-5 up to 10**digits, else like "3.3e-4".

    Zero is "0". Raises ValueError if digits < 1, Uncertified if the number is too close to where the rounding changes.

    >>> from fractions import Fraction
    >>> from driftproof import significant
    >>> significant(Fraction(1, 300000), 2)
    '3.3e-6'
    """
    _require_a_digit(digits)

    def read(x: Fraction) -> str:
        if not x:
            return "0"
        decade = _decade(_rounded(x, digits, rounding))
        if -5 <= decade < digits:
            return _fixed(x, digits - 1 - decade, rounding)
        return _scientific(x, digits, rounding)

    return decide_by_enclosure(value, read)


def scientific(value: CertifiableReal, digits: int, rounding: str = HALF_EVEN) -> str:
    """`value` correctly rounded to `digits` significant digits, always with an exponent, e.g. "-6.7e-5"; zero is "0".

    Raises ValueError if digits < 1.
    """
    _require_a_digit(digits)
    return decide_by_enclosure(value, lambda x: _scientific(x, digits, rounding))


def _require_a_digit(digits: int) -> None:
    if digits < 1:
        raise ValueError(f"digits = {digits}; must be at least 1")


def _round_to_integer(x: Fraction, rounding: str) -> int:
    """|x| rounded to an integer: up for AWAY, else to the nearest, ties up for HALF_AWAY and to even for HALF_EVEN."""
    if rounding not in ROUNDINGS:
        raise ValueError(unknown("rounding", rounding, ROUNDINGS))
    x = abs(x)
    if rounding == AWAY:
        return ceil(x)
    return round(x) if rounding == HALF_EVEN else int(x + Fraction(1, 2))


def _decade(x: Fraction) -> int:
    """The largest e with 10**e <= |x|, for x != 0."""
    e = len(str(fmpz(abs(x.numerator)))) - len(str(fmpz(x.denominator)))
    return e if Fraction(10) ** e <= abs(x) else e - 1


def _rounded(x: Fraction, digits: int, rounding: str) -> Fraction:
    unit = Fraction(10) ** (_decade(x) - digits + 1)
    return _round_to_integer(x / unit, rounding) * unit


def _fixed(x: Fraction, places: int, rounding: str) -> str:
    # fmpz prints integers of any length; Python's own str() refuses beyond 4300 digits.
    digits = str(fmpz(_round_to_integer(x * 10**places, rounding))).zfill(places + 1)
    text = f"{digits[:-places]}.{digits[-places:]}" if places else digits
    return f"-{text}" if x < 0 and text.strip("0.") else text


def _scientific(x: Fraction, digits: int, rounding: str) -> str:
    if not x:
        return "0"
    rounded = _rounded(x, digits, rounding)
    decade = _decade(rounded)
    mantissa = str(fmpz(int(rounded / Fraction(10) ** (decade - digits + 1))))
    point = f".{mantissa[1:]}" if digits > 1 else ""
    return f"{'-' if x < 0 else ''}{mantissa[0]}{point}e{decade}"
