"""Exact numbers as decimals in a style: ties refused unless a policy is named, JavaScript's toFixed to the letter."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from driftproof.symbolic.algebra.certified import Exact, fixed, settle, significant
from driftproof.texts.questions.style import AWAY, HALF_AWAY, HALF_EVEN, TOFIXED, Style

# Number.prototype.toFixed refuses more digits after the point (ecma-262-2025, 21.1.3.3).
MOST_PLACES_OF_TOFIXED = 100
# From here on toFixed writes an exponent.
LARGEST_OF_TOFIXED = 10**21

# (number, digits, rounding) -> text.
Write = Callable[[Exact, int, str], str]


class Tie(ValueError):
    """The number is half-way between two decimals and no policy was named."""


def to_digits(x: Exact, digits: int, style: Style, default: str | None = None) -> str:
    """x to so many significant digits. `default` is the rounding where the style names none; None: ties are refused.

    Raises ValueError for a count below one, Tie, and Uncertified.
    """
    if style.rounding == TOFIXED:
        return style.written(significant(nearest_double(x), digits, HALF_AWAY))
    return style.written(_rounded(significant, x, digits, style.rounding or default))


def to_places(x: Exact, places: int, style: Style, default: str | None = None) -> str:
    """x to so many digits after the point. Raises ValueError for a count below zero, Tie, and Uncertified."""
    if style.rounding == TOFIXED:
        return style.written(_to_fixed(nearest_double(x), places))
    return style.written(_rounded(fixed, x, places, style.rounding or default))


def nearest_double(x: Exact) -> Fraction:
    """The binary64 number nearest to x, as a fraction; 0 where x underflows. Raises ValueError where it overflows."""
    try:
        return settle(x, lambda y: Fraction(float(y)))
    except OverflowError:
        raise ValueError("the number is beyond the largest double, and toFixed is for doubles") from None


def _rounded(write: Write, x: Exact, count: int, rounding: str | None) -> str:
    if rounding in (HALF_EVEN, HALF_AWAY, AWAY):
        return write(x, count, rounding)
    even = write(x, count, HALF_EVEN)
    # Irrational numbers lie on no tie; of an enclosed rational one, settle says that it is undecided.
    if isinstance(x, Fraction) and even != (away := write(x, count, HALF_AWAY)):
        raise Tie(f"the number is half-way: half-even gives {even}, half-away {away}; name a rounding")
    return even


def _to_fixed(x: Fraction, places: int) -> str:
    """x.toFixed(places) of a double x: half-away, "-0.00" for a negative number that rounds to 0."""
    if places > MOST_PLACES_OF_TOFIXED or abs(x) >= LARGEST_OF_TOFIXED:
        raise ValueError(f"toFixed takes at most {MOST_PLACES_OF_TOFIXED} places, and numbers below 10**21")
    text = fixed(abs(x), places, HALF_AWAY)
    return f"-{text}" if x < 0 else text
