"""Plain text and JSON for a terminal: aligned tables, floats in few digits, canonical JSON, names nearly right."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

# What JSON can say, as Python has it.
Json: TypeAlias = Any
# A float of this size or more is shown with an exponent.
LARGEST_PLAIN = 1e9

# What a terminal obeys instead of showing it: controls but for tab and end of line, directions of writing, separators
# of lines. Halves of pairs, too, as in names of files that are no UTF-8: no output takes them.
_UNPRINTABLE = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def printable(text: str) -> str:
    """The text with such characters spelled as in JSON: whoever wrote it has no say over the terminal that shows it.

    >>> print(printable("RK4\\x1b[2J"))
    RK4\\u001b[2J
    """
    return _UNPRINTABLE.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def shortened(text: str, longest: int = 60) -> str:
    """The text, cut off where it is too long to be read: as a message quotes it."""
    return text if len(text) <= longest else f"{text[: longest - 3]}..."


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
    """So many significant digits, zeros at the end among them; an exponent as in 1.5e-7, below 1e-4 and above them."""
    mantissa, _, exponent = f"{x:#.{digits}g}".partition("e")
    return mantissa.removesuffix(".") + (f"e{int(exponent)}" if exponent else "")


def short(x: float) -> str:
    """Three decimals as the lesson's table has them; two digits and an exponent below 1e-3, beyond LARGEST_PLAIN."""
    if x == 0 or 1e-3 <= abs(x) < LARGEST_PLAIN:
        return f"{x:.3f}"
    mantissa, exponent = f"{x:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def did_you_mean(key: str, known: Iterable[str]) -> str:
    """ "; did you mean a or b?" with the names nearest to `key`, or "" where none is near."""
    from difflib import get_close_matches

    close = get_close_matches(key, known, n=2, cutoff=0.4)
    return f"; did you mean {' or '.join(close)}?" if close else ""


def annotation(level: str, message: str, **properties: object) -> str:
    """A workflow command of GitHub's, shown beside a line of a file: error, warning or notice, and where it belongs."""
    listed = ",".join(f"{key}={_escaped(str(value), ':,')}" for key, value in properties.items())
    return f"::{level} {listed}::{_escaped(message)}"


def _escaped(text: str, more: str = "") -> str:
    for character in "%\r\n" + more:
        text = text.replace(character, f"%{ord(character):02X}")
    return text
