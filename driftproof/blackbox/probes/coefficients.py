"""Coefficients read from floating-point code, compared with exact numbers and shown as the fractions they stand for."""

from __future__ import annotations

from fractions import Fraction

from driftproof.methods.numbers.number_field import Exact
from driftproof.support.plain_text import counted
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.rounding.formats import FloatFormat, exponent, power_of_two

# The most characters of an exact number; a longer one is shown as a decimal.
_LONGEST_SHOWN = 24
# Chosen: as many units in the last place are counted; more of them show in a number of sixteen digits.
_UNITS_COUNTED = 100


def is_nearest(x: float, exact: Exact, fmt: FloatFormat) -> bool:
    """True if x is the number of the format nearest to `exact`, so that x is correctly rounded."""
    return bool(decide_by_enclosure(exact, fmt.nearest) == Fraction(x))


def half_spacing(x: float, fmt: FloatFormat) -> Fraction:
    """Half the spacing of the format at x: no number that is rounded to x is farther away. 0 for x = 0."""
    return power_of_two(max(exponent(Fraction(x)), fmt.emin) - fmt.precision) if x else Fraction(0)


def coefficient_text(x: float, fmt: FloatFormat, slack: float = 0.0) -> str:
    """The fraction that x rounds, such as "1/3", unless that may be a coincidence; otherwise its shortest decimals.

    `slack` is added to the distance allowed, for a number that was computed rather than read.
    """
    fraction = simple_rational(x, half_spacing(x, fmt) + Fraction(slack))
    return repr(x) if fraction is None else exact_shown(fraction)


def exact_shown(exact: Exact) -> str:
    """The exact number as text, a long one as a decimal."""
    text = str(exact)
    return text if len(text) <= _LONGEST_SHOWN else repr(float(exact))


def coefficient_difference(name: str, seen: float, exact: Exact, fmt: FloatFormat, slack: float = 0.0) -> str:
    """A line on one coefficient that is not the exact one; where that is hard to see, with how far it is away."""
    off, spacing = abs(seen - float(exact)), 2 * float(half_spacing(seen, fmt))
    close = 0 < spacing <= off <= _UNITS_COUNTED * spacing
    away = f" (about {counted(round(off / spacing), 'unit')} in its last place away)" if close else ""
    return f"{name}: {coefficient_text(seen, fmt, slack)} instead of {exact_shown(exact)}{away}"


# An interval of width w holds a rational of denominator up to d with a chance of about d² w; at most 1 in this many.
COINCIDENCE = 64


def simplest_in(low: Fraction, high: Fraction) -> Fraction:
    """The rational of least denominator in the closed interval, by continued fractions. Raises ValueError if empty."""
    if low > high:
        raise ValueError(f"no number is at least {low} and at most {high}")
    if low <= 0 <= high:
        return Fraction(0)
    if high < 0:
        return -simplest_in(-high, -low)
    whole = -(-low.numerator // low.denominator)
    if whole <= high:
        return Fraction(whole)
    return whole - 1 + 1 / simplest_in(1 / (high - whole + 1), 1 / (low - whole + 1))


def simple_rational(x: float | Fraction, error: float | Fraction) -> Fraction | None:
    """The rational of least denominator within `error` of x; None if it may well be a coincidence."""
    middle, width = Fraction(x), Fraction(error)
    found = simplest_in(middle - width, middle + width)
    return found if found.denominator**2 * 2 * width * COINCIDENCE <= 1 else None


def short_rational(x: Fraction) -> str:
    """The number as a short decimal if that is exact, else as a fraction, else as a float: 0.04, 1/3, 0.7390851."""
    if x.denominator == 1:
        return exact_shown(x)
    digits = f"{float(x):.6g}"
    if Fraction(digits) == x:
        return digits
    return str(x) if x.denominator < 10**6 else repr(float(x))
