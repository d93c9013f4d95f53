"""Rational numbers from users' text, and the number of steps as an exact quotient."""

from __future__ import annotations

import re
from fractions import Fraction
from math import ceil, floor

# Enough for every binary64 written out in full (1074 fractional digits); beyond it a short string such as
# "1e999999999" would ask for gigabytes.
LONGEST_TEXT = 1200
LARGEST_EXPONENT = 1200
# Of a number in a message.
LONGEST_SHOWN = 40

_EXPONENT = re.compile(r"[eE]([+-]?\d[\d_]*)\s*$")


def parse_rational(text: str, what: str = "number") -> Fraction:
    """The rational number that `text` spells: an integer, a fraction `1/4` or a decimal `0.25`, `2.5e-3`.

    Exact: "0.1" is 1/10, not the double nearest to it. The text is parsed, never evaluated.
    Raises ValueError with one line that names `what` if the text spells no rational number or is too long.
    """
    allowed = "write an integer, a fraction like 1/4 or a decimal like 0.25"
    text = text.strip().replace("\N{MINUS SIGN}", "-")
    exponent = _EXPONENT.search(text)
    shown = text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."
    if len(text) > LONGEST_TEXT or (exponent and abs(int(exponent[1].replace("_", ""))) > LARGEST_EXPONENT):
        raise ValueError(
            f"{what}: {shown!r} is too long; at most {LONGEST_TEXT} characters, exponent {LARGEST_EXPONENT}"
        )
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError(f"{what}: {shown!r} divides by zero; {allowed}") from None
    except ValueError:
        raise ValueError(f"{what}: {shown!r} is not a rational number; {allowed}") from None


def step_count(t: Fraction, h: Fraction) -> int:
    """N = t / h, the exact number of steps of size h from time 0 to time t.

    Exact on purpose: in floats `int(t / h)` is one short for many decimal h. Raises ValueError if h is zero, if
    h and t have opposite signs, or if N is not whole; the message then names the two nearest h that divide t.
    """
    if h == 0:
        raise ValueError(f"h = 0 never reaches t = {brief(t)}; choose h with t / h a whole number")
    quotient = t / h
    if quotient < 0:
        raise ValueError(f"h = {brief(h)} leads away from t = {brief(t)}; give h the sign of t")
    if quotient.denominator == 1:
        return int(quotient)
    nearest = [brief(t / n) for n in (floor(quotient), ceil(quotient)) if n > 0]
    raise ValueError(
        f"h = {brief(h)} does not divide t = {brief(t)} (t / h = {brief(quotient)}); nearest that do: "
        f"{' and '.join(nearest)}"
    )


def brief(x: Fraction | int) -> str:
    """The number for a message: cut off where it is too long to be read."""
    text = str(x)
    return text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."
