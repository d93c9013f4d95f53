"""The ways in which a text may spell one answer, none of which another number can be spelled as."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from driftproof.methods.rationals import parse_rational

if TYPE_CHECKING:
    from driftproof.texts.questions.value import Value

MOST_DIGITS = 1000
# An exact form longer than this is nothing that a text prints.
LONGEST_FORM = 400
ROUNDINGS = ("half-even", "half-away", "tofixed", "away")
_DECIMAL = re.compile(r"(?P<sign>-?)(?P<whole>[0-9]+)(?:\.(?P<rest>[0-9]+))?(?:e(?P<exponent>-?[0-9]+))?")


@dataclass(frozen=True)
class Form:
    """How a number stands in a text: so many places, or digits, or exactly; with none of them as it is, in full."""

    places: int | None = None
    digits: int | None = None
    exact: bool = False
    rounding: str | None = None

    def spellings(self, value: Value) -> list[str]:
        """Every way to write the value so, in canonical spelling, the plainest first.

        Raises ValueError for a number that cannot be written so: an irrational one in full, a tie between two policies
        of rounding.
        """
        from driftproof.texts.questions.style import Style

        style = Style(rounding=self.rounding)
        if not value.is_number or self.exact:
            return _exact_spellings(value)
        if self.places is not None:
            return [value.places(self.places, style)]
        if self.digits is not None:
            return _digit_spellings(value.digits(self.digits, style))
        return [_in_full(value)]


def _exact_spellings(value: Value) -> list[str]:
    """3/8, or a formula: with * and ** as in a program, or as on paper."""
    text = value.exact_text
    if text is None:
        raise ValueError("the value has no exact form; say places or digits")
    if len(text) > LONGEST_FORM:
        raise ValueError(f"the exact form has {len(text)} characters; say places or digits")
    printed = re.sub(r"\*\*\(?(-?\w+)\)?", lambda power: _raised(power[1]), text)
    printed = re.sub(r"sqrt\((\w+)\)", r"√\1", printed).replace("sqrt(", "√(").replace("*", "")
    return list(dict.fromkeys((printed, text)))


def _raised(exponent: str) -> str:
    return f"^{exponent}" if len(exponent) == 1 else f"^{{{exponent}}}"


def _in_full(value: Value) -> str:
    """A whole number or a decimal that ends."""
    exact = value.exact
    if isinstance(exact, Fraction):
        places = _places_of(exact.denominator)
        if places is not None:
            return value.places(places)
    raise ValueError("the value has no decimal that ends; say places, digits or exact")


def _places_of(denominator: int) -> int | None:
    """The least n with denominator | 10**n, None where there is none up to MOST_DIGITS."""
    twos, fives = 0, 0
    while denominator % 2 == 0 and twos <= MOST_DIGITS:
        denominator, twos = denominator // 2, twos + 1
    while denominator % 5 == 0 and fives <= MOST_DIGITS:
        denominator, fives = denominator // 5, fives + 1
    places = max(twos, fives)
    return places if denominator == 1 and places <= MOST_DIGITS else None


def _digit_spellings(decimal: str) -> list[str]:
    """The same digits with and without an exponent: 0.00033, 3.3e-4 and 3.3×10^{-4}."""
    match = _DECIMAL.fullmatch(decimal)
    assert match is not None
    rest, exponent = match["rest"] or "", int(match["exponent"] or 0)
    digits = (match["whole"] + rest).lstrip("0")
    decade = len(match["whole"]) - 1 + exponent - (len(match["whole"] + rest) - len(digits)) if digits else 0
    if not digits:
        return [decimal]
    point = "." if len(digits) > 1 else ""
    scientific = f"{match['sign']}{digits[0]}{point}{digits[1:]}e{decade}"
    plain = [] if match["exponent"] and abs(decade) > MOST_DIGITS else [_plain(match["sign"], digits, decade)]
    return list(dict.fromkeys([*([] if match["exponent"] else [decimal]), *plain, scientific]))


def _plain(sign: str, digits: str, decade: int) -> str:
    if decade < 0:
        return f"{sign}0.{'0' * (-decade - 1)}{digits}"
    whole, rest = digits[: decade + 1].ljust(decade + 1, "0"), digits[decade + 1 :]
    return f"{sign}{whole}.{rest}" if rest else f"{sign}{whole}"


def pattern(spelling: str) -> str:
    """A regular expression for one spelling: groups of three digits may be set apart, × or · stand for e."""
    match = _DECIMAL.fullmatch(spelling)
    if match is None:
        return literal_pattern(spelling)
    whole, rest, exponent = match["whole"], match["rest"], match["exponent"]
    if len(whole) > 3:
        head = len(whole) % 3 or 3
        groups = [whole[:head], *(whole[i : i + 3] for i in range(head, len(whole), 3))]
        whole = f"(?:{whole}|{','.join(groups)}|{chr(39).join(groups)})"
    text = f"{match['sign']}{whole}" + (rf"\.{rest}" if rest else "")
    return text + (_exponent_pattern(int(exponent)) if exponent else "")


def _exponent_pattern(exponent: int) -> str:
    sign = "-" if exponent < 0 else r"\+?"
    raised = str(exponent) if 0 <= exponent < 10 else rf"\{{{exponent}\}}"
    return rf"(?:[eE]{sign}0?{abs(exponent)}| ?[×·] ?10\^{raised})"


def literal_pattern(text: str) -> str:
    """A regular expression for a text in canonical spelling, whose spaces may be ends of lines."""
    return re.sub(r"(?:\\?[ \n])+", lambda space: "[ \\n]", re.escape(text))


def parsed(text: str) -> Fraction:
    """The number that a given value spells, to see that it is one. Raises ValueError."""
    return parse_rational(text.replace(",", ""), "given")
