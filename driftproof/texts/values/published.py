"""The published values: every number that the lesson prints, by stable id, from values.json, which the proofs write."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from fnmatch import fnmatchcase
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

from driftproof.support.plain_text import as_json

# id -> {"exact": "337/384" or None, "decimal": digits, "printed": {claim id: text}, "evidence": ..., "statement": ...}
PublishedValues: TypeAlias = dict[str, dict[str, Any]]

VALUES_FILE = Path(__file__).with_name("values.json")
# The module for web pages; its line NO_VALUES is where the values go.
MODULE_FILE = Path(__file__).with_name("driftproof.mjs")
NO_VALUES = "export const values = {};"
# The LaTeX macros, whose text also names this number of digits.
MACROS_FILE = Path(__file__).with_name("driftproof.tex")
MOST_MACRO_DIGITS = 12


@cache
def _document() -> dict[str, Any]:
    return dict(json.loads(VALUES_FILE.read_text(encoding="utf-8")))


def published_values(pattern: str = "*") -> PublishedValues:
    """The published values whose id matches the shell pattern, e.g. "rk4.*". Raises ValueError if none does.

    >>> from driftproof import published_values
    >>> published_values("rk4.first_step.q")["rk4.first_step.q"]["exact"]
    '337/384'
    """
    values: PublishedValues = _document()["values"]
    chosen = {key: value for key, value in values.items() if fnmatchcase(key, pattern)}
    if not chosen:
        raise ValueError(f"no published value has an id that matches {pattern!r}; --only '*' lists them")
    return chosen


def _as_markdown(values: PublishedValues) -> str:
    lines = ["| id | exact | decimal | printed |", "|---|---|---|---|"]
    for key, value in values.items():
        exact = f"`{value['exact']}`" if value["exact"] else ""
        lines.append(f"| `{key}` | {exact} | {value['decimal']} | {', '.join(sorted({*value['printed'].values()}))} |")
    return "\n".join(lines)


def _as_tex(values: PublishedValues) -> str:
    """The LaTeX macros \\driftproof, \\driftproofdigits and \\driftproofexact, then one line of data per value."""
    from driftproof.texts.writing import markup

    lines = []
    for key, value in values.items():
        exact = markup.in_any_mode(markup.formula(value["exact"], markup.TEX)) if value["exact"] else ""
        # The printed form is the longest decimal without an exponent in any claim, else the certified decimal.
        decimals = [text for text in value["printed"].values() if text.lstrip("-").replace(".", "").isdigit()]
        printed, *rounded = (
            markup.in_any_mode(markup.decimal_markup(decimal, markup.TEX))
            for decimal in (max(decimals, key=len, default=str(value["decimal"])), *_rounded(key, value))
        )
        digits = "".join(f"\\or {text}" for text in rounded)
        lines.append(f"\\driftproofvalue{{{key}}}{{{exact}}}{{{printed}}}{{{digits}}}")
    return MACROS_FILE.read_text(encoding="utf-8") + "\n".join(lines)


def _rounded(key: str, value: Mapping[str, Any]) -> list[str]:
    """The number rounded to 1, 2, ... digits. Raises ValueError if the certified decimal does not decide them all."""
    from driftproof.methods.numbers.rationals import parse_rational
    from driftproof.symbolic.algebra.certified import HALF_AWAY, significant

    try:
        x, exact = parse_rational(value["exact"] or ""), True
    except ValueError:
        x, exact = Fraction(value["decimal"]), False
    found = [significant(x, digits) for digits in range(1, MOST_MACRO_DIGITS + 1)]
    for digits, text in enumerate(found, 1):
        if not exact and text != significant(x, digits, HALF_AWAY):
            raise ValueError(f"{key}: the certified decimal {value['decimal']} does not settle {digits} digits")
    return found


# Format -> what writes the values; JSON is the complete one.
VALUE_FORMATS: dict[str, Callable[[PublishedValues], str]] = {
    "json": lambda values: as_json({**_document(), "values": values}),
    "md": _as_markdown,
    "tex": _as_tex,
    # An ES module with the values and functions that round and show them.
    "js": lambda values: (
        MODULE_FILE.read_text(encoding="utf-8")
        .replace(NO_VALUES, f"export const values = {as_json(values)};")
        .rstrip("\n")
    ),
}
