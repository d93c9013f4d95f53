"""Plain text and JSON for a terminal: aligned tables, floats in few digits, canonical JSON, hints for misspelt keys."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from typing import Any, TypeAlias

# A Python value that JSON can express.
Json: TypeAlias = Any
# A float of this size or more is shown with an exponent.
LARGEST_PLAIN = 1e9
# Significant digits of a decimal if the caller names no length.
DIGITS_UNASKED = 15

# Characters that a terminal obeys instead of showing them: control characters other than tab and newline, directions of
# writing, line separators; and lone surrogates, for bytes of file names that are not UTF-8, which no output accepts.
_UNPRINTABLE = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def printable(text: str) -> str:
    """The text with unprintable characters escaped as in JSON, so that it cannot control the terminal that shows it.

    >>> print(printable("RK4\\x1b[2J"))
    RK4\\u001b[2J
    """
    return _UNPRINTABLE.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def shortened(text: str, longest: int = 60) -> str:
    """The text as a message quotes it: cut to `longest` characters, of which the last are then "..."."""
    return text if len(text) <= longest else f"{text[: longest - 3]}..."


def counted(count: int, noun: str) -> str:
    """The count with its noun: "1 step", "2 steps"."""
    return f"{count} {noun}{'s' * (count != 1)}"


def as_json(answer: Any) -> str:
    """Canonical JSON: keys sorted, one line per value, byte-stable from run to run."""
    import json

    return json.dumps(answer, indent=1, sort_keys=True, ensure_ascii=False)


def table(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Rows as aligned columns, two spaces apart; the columns in `right` are aligned right."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    padded = (
        [cell.rjust(widths[i]) if i in right else cell.ljust(widths[i]) for i, cell in enumerate(row)] for row in rows
    )
    return "\n".join("  ".join(cells).rstrip() for cells in padded)


def with_digits(x: float, digits: int) -> str:
    """x to `digits` significant digits, zeros at the end included; as in 1.5e-7 below 1e-4 and from 10**digits on."""
    mantissa, _, exponent = f"{x:#.{digits}g}".partition("e")
    return mantissa.removesuffix(".") + (f"e{int(exponent)}" if exponent else "")


def short(x: float) -> str:
    """x to three decimals; to two digits with an exponent below 1e-3 and from LARGEST_PLAIN on."""
    if x == 0 or 1e-3 <= abs(x) < LARGEST_PLAIN:
        return f"{x:.3f}"
    mantissa, exponent = f"{x:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def did_you_mean(key: str, known: Iterable[str]) -> str:
    """The hint "; did you mean a or b?", or "" if no known name is like it, as with one wrong letter of three (2/3)."""
    from difflib import get_close_matches

    names = [*known]
    close = [x for x in names if x.lower() == key.lower()] or get_close_matches(key, names, n=2, cutoff=0.65)
    return f"; did you mean {' or '.join(close)}?" if close else ""


def unknown(what: str, name: object, known: Collection[str], listed: str = "") -> str:
    """The complaint about a name that is not known, with the nearest names; all are shown unless they are `listed`."""
    near = did_you_mean(str(name), known)
    all_known = f" ({listed})" if listed else f"{'' if near else ';'} choose from {', '.join(known)}"
    return f"unknown {what} {shortened(str(name))!r}{near}{all_known}"


def annotation(level: str, message: str, **properties: object) -> str:
    """A GitHub workflow command: a message of level error, warning or notice, with `properties` that say where."""
    listed = ",".join(f"{key}={_escaped(str(value), ':,')}" for key, value in properties.items())
    return f"::{level} {listed}::{_escaped(message)}"


def _escaped(text: str, more: str = "") -> str:
    for character in "%\r\n" + more:
        text = text.replace(character, f"%{ord(character):02X}")
    return text
