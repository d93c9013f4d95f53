"""The published values as definitions for a LaTeX document: printed decimal, exact form, and rounded to some digits."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from driftproof.methods.rationals import parse_rational
from driftproof.texts.writing import markup

MACROS_FILE = Path(__file__).with_name("driftproof.tex")
# driftproof.texts.writing.tex says this number in words, too.
MOST_DIGITS = 12


def values_tex(values: Mapping[str, Mapping[str, Any]]) -> str:
    """The macros \\driftproof, \\driftproofdigits and \\driftproofexact, and one line per value, which they look up."""
    macros = MACROS_FILE.read_text(encoding="utf-8")
    return macros + "\n".join(_definition(key, value) for key, value in values.items())


def _definition(key: str, value: Mapping[str, Any]) -> str:
    exact = _mathematics(markup.formula(value["exact"], markup.TEX)) if value["exact"] else ""
    digits = "".join(f"\\or {text}" for text in _rounded(key, value))
    return f"\\driftproofvalue{{{key}}}{{{exact}}}{{{_number(_printed(value))}}}{{{digits}}}"


def _mathematics(formula: str) -> str:
    """What reads the same in text and in mathematics stays; the rest is mathematics wherever it stands."""
    return formula if formula.replace(".", "").isdigit() else rf"\ensuremath{{{formula}}}"


def _number(decimal: str) -> str:
    return _mathematics(markup.decimal(decimal, markup.TEX))


def _printed(value: Mapping[str, Any]) -> str:
    """The longest decimal without an exponent that a claim prints; the certified decimal where none does."""
    decimals = [text for text in value["printed"].values() if text.lstrip("-").replace(".", "").isdigit()]
    return max(decimals, key=len) if decimals else str(value["decimal"])


def _rounded(key: str, value: Mapping[str, Any]) -> list[str]:
    """To 1, 2, ... MOST_DIGITS digits. Raises ValueError where the certified decimal does not settle a digit."""
    from driftproof.symbolic.algebra.certified import HALF_AWAY, significant

    try:
        x, exact = parse_rational(value["exact"] or ""), True
    except ValueError:
        x, exact = Fraction(value["decimal"]), False
    found = []
    for digits in range(1, MOST_DIGITS + 1):
        text = significant(x, digits)
        if not exact and text != significant(x, digits, HALF_AWAY):
            raise ValueError(f"{key}: the certified decimal {value['decimal']} does not settle {digits} digits")
        found.append(_number(text))
    return found
