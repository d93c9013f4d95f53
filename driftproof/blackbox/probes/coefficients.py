"""Coefficients read from float code: how far one is from an exact number, and which fraction it stands for."""

from __future__ import annotations

from fractions import Fraction

from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.certified import decide_by_enclosure
from driftproof.symbolic.rounding.formats import FloatFormat, exponent, power_of_two

# An exact number longer than this is shown as a decimal.
_LONGEST_SHOWN = 24


def is_nearest(x: float, exact: Exact, fmt: FloatFormat) -> bool:
    """True when x is the number of the format nearest to `exact`: correctly rounded."""
    return bool(decide_by_enclosure(exact, fmt.nearest) == Fraction(x))


def half_spacing(x: float, fmt: FloatFormat) -> Fraction:
    """How far the numbers that the format rounds to x may be from it: u times the power of two below |x|, at least."""
    return power_of_two(max(exponent(Fraction(x)), fmt.emin) - fmt.precision) if x else Fraction(0)


def coefficient_text(x: float, fmt: FloatFormat, slack: float = 0.0) -> str:
    """The fraction that x is the rounding of, as "1/3", if that is no coincidence; else its shortest decimals.

    With `slack`, the fraction may be so much farther away: of a number that was not read but computed.
    """
    fraction = simple_rational(x, half_spacing(x, fmt) + Fraction(slack))
    return repr(x) if fraction is None else str(fraction)


def exact_shown(exact: Exact) -> str:
    """The exact number as it is written; a long one as a decimal."""
    text = str(exact)
    return text if len(text) <= _LONGEST_SHOWN else repr(float(exact))


def coefficient_difference(name: str, seen: float, exact: Exact, fmt: FloatFormat, slack: float = 0.0) -> str:
    """One coefficient that is not what it should be, in words."""
    return f"{name}: {coefficient_text(seen, fmt, slack)} instead of {exact_shown(exact)}"


# An interval of width w holds a rational with a denominator up to d with a chance of about d² w: at most one in
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
    """The rational of least denominator within `error` of x; None where that may well be a coincidence."""
    middle, width = Fraction(x), Fraction(error)
    found = simplest_in(middle - width, middle + width)
    return found if found.denominator**2 * 2 * width * COINCIDENCE <= 1 else None


def short_rational(x: Fraction) -> str:
    """The number as a short decimal where that is exact, else as a fraction, else as a float: 0.04, 1/3, 0.7390851."""
    if x.denominator == 1:
        return str(x)
    digits = f"{float(x):.6g}"
    if Fraction(digits) == x:
        return digits
    return str(x) if x.denominator < 10**6 else repr(float(x))
