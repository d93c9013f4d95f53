"""Rational numbers, step sizes and states from users' text, and the number of steps as an exact quotient."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor, isfinite
from numbers import Rational
from typing import TypeAlias

from driftproof.support.plain_text import shortened

# A number that is taken exactly; a float is accepted only if it equals the decimal that it prints as.
ExactNumber: TypeAlias = Fraction | int | float | str
# Position and velocity, as two numbers or as a text such as "1,0".
GivenState: TypeAlias = str | Sequence[ExactNumber]

# Enough for every binary64 written out in full (1074 fractional digits); beyond it a short string such as
# "1e999999999" would need gigabytes.
LONGEST_TEXT = 1200
LARGEST_EXPONENT = 1200
# Characters of a number in a message.
LONGEST_SHOWN = 40

_EXPONENT = re.compile(r"[eE]([+-]?\d[\d_]*)\s*$")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+")
# Halvings in a range of step sizes: a double cannot tell 1 + 2⁻⁶⁴ from 1.
MOST_HALVINGS = 64


def parse_rational(text: str, what: str = "number") -> Fraction:
    """The rational number that `text` spells: an integer, a fraction `1/4` or a decimal `0.25`, `2.5e-3`.

    Exact: "0.1" is 1/10, not the double nearest to it. The text is parsed, never evaluated.
    Raises ValueError with one line that names `what` if the text spells no rational number or is too long.
    """
    allowed = "write an integer, a fraction like 1/4 or a decimal like 0.25"
    text = text.strip().replace("\N{MINUS SIGN}", "-")
    exponent = _EXPONENT.search(text)
    shown = brief(text)
    if len(text) > LONGEST_TEXT or (exponent and abs(int(exponent[1].replace("_", ""))) > LARGEST_EXPONENT):
        raise ValueError(
            f"{what}: {shown!r} is too long; at most {LONGEST_TEXT} characters, exponent {LARGEST_EXPONENT}"
        )
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError(f"{what}: {shown!r} divides by zero; {allowed}") from None
    except ValueError:
        allowed = f"write it with a point: {shown.replace(',', '.')}" if _DECIMAL_COMMA.fullmatch(shown) else allowed
        raise ValueError(f"{what}: {shown!r} is not a rational number; {allowed}") from None


def exact_number(given: ExactNumber, what: str = "number") -> Fraction:
    """The exact value of a number or text; a float is accepted only if it equals the decimal that it prints as.

    The double 0.25 is a quarter, but the double 0.1 is not a tenth: the caller has to say which of the two is meant.
    Raises ValueError with one line that names `what`.

    >>> exact_number("0.1"), exact_number(0.25)
    (Fraction(1, 10), Fraction(1, 4))
    >>> exact_number(0.1, "h")
    Traceback (most recent call last):
    ValueError: h: the double 0.1 is not 0.1 exactly; write "0.1" for the decimal, or Fraction(0.1) for the double
    """
    if isinstance(given, str):
        return parse_rational(given, what)
    if isinstance(given, float) and isfinite(given):
        if Fraction(given) == Fraction(text := float.__repr__(given)):
            return Fraction(given)
        meant = f'write "{text}" for the decimal, or Fraction({text}) for the double'
        raise ValueError(f"{what}: the double {text} is not {text} exactly; {meant}")
    if isinstance(given, Rational) and str(given) not in ("True", "False"):
        return Fraction(int(given.numerator), int(given.denominator))
    raise ValueError(f"{what} is {brief(given)!r}; give a Fraction, an int, or text such as '1/4'")


def step_of(given: ExactNumber) -> Fraction:
    """A step size, exact and not zero. Raises ValueError."""
    h = exact_number(given, "h")
    if h == 0:
        raise ValueError("the step size h must not be 0")
    return h


def exact_numbers(given: ExactNumber | Sequence[ExactNumber], what: str) -> list[Fraction]:
    """A list of one number or several, which may be given in one text such as "1/4,1/8". Raises ValueError."""
    if isinstance(given, str):
        given = given.split(",")
    return [exact_number(x, what) for x in (given if isinstance(given, Sequence) else [given])]


def steps_of(given: ExactNumber | Sequence[ExactNumber]) -> list[Fraction]:
    """A list of one step size or several, none of them 0; "1/4:1/64" halves down to the last. Raises ValueError."""
    if not isinstance(given, str):
        return [step_of(h) for h in exact_numbers(given, "h")]
    if _DECIMAL_COMMA.fullmatch(given.strip()) and given.strip().startswith("0"):
        return [parse_rational(given, "h")]  # raises: 0,1 is a decimal comma rather than a list
    return [h for part in given.split(",") for h in (_halvings(part) if ":" in part else [step_of(part)])]


def _halvings(text: str) -> list[Fraction]:
    """The step sizes of a range such as 1/4:1/64. Raises ValueError."""
    first, _, last = text.partition(":")
    found, end = [step_of(first)], step_of(last)
    while abs(found[-1]) > abs(end) and len(found) <= MOST_HALVINGS:
        found.append(found[-1] / 2)
    if found[-1] != end:
        raise ValueError(f"h: halving {brief(found[0])} does not lead to {brief(end)}; write a range like 1/4:1/64")
    return found


def state_of(given: GivenState) -> tuple[Fraction, Fraction]:
    """A state (q, v) from a pair or from the text "position,velocity". Raises ValueError."""
    parts = given.split(",") if isinstance(given, str) else given
    if len(parts) != 2:
        raise ValueError(f"{brief(given)!r} is not a state; write position,velocity like 1,0")
    return exact_number(parts[0], "q"), exact_number(parts[1], "v")


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


def brief(x: object) -> str:
    """The number, or whatever was given in its place, shortened for a message."""
    return shortened(str(x), LONGEST_SHOWN)
