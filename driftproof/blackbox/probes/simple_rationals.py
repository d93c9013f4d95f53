"""Floats read as the rationals they stand for: the simplest one within an error, if that is no coincidence."""

from __future__ import annotations

from fractions import Fraction

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


def rational_text(x: Fraction) -> str:
    """The number as a short decimal where that is exact, else as a fraction, else as a float: 0.04, 1/3, 0.7390851."""
    if x.denominator == 1:
        return str(x)
    digits = f"{float(x):.6g}"
    if Fraction(digits) == x:
        return digits
    return str(x) if x.denominator < 10**6 else repr(float(x))
