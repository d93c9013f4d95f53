"""Users' TOML files: read within limits, with decimals kept as written, entries checked and errors of one line.

Each function `as_...` returns the value of the entry `where` if it is of the right kind; otherwise it raises ValueError
with what the entry is and what it may be: "count is -1; write a whole number from 0 to 9".
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

from driftproof.support.files import read_utf8
from driftproof.support.plain_text import did_you_mean, shortened

TomlTable: TypeAlias = dict[str, Any]
_T = TypeVar("_T")

# The time that tomllib takes for a key grows with the square of the number of its dots: 1 ms for this many.
MOST_DOTS = 300
_DECIMAL = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])", re.ASCII)
# An entry such as [1/2, ...
_BARE_FRACTION = re.compile(r"[\[,=]\s*-?\d+\s*/\s*\d")


def read_toml(
    path: str | Path, longest: int, make: Callable[[TomlTable], _T], refusal: type[ValueError] = ValueError
) -> _T:
    """Return make(table) for the table in the file. Raises `refusal` for any error, in one line that names the file."""
    text = read_utf8(path, longest, refusal)
    try:
        return make(parse_toml(text))
    except ValueError as error:
        raise refusal(" ".join(f"{path}: {error}".split())) from None


def parse_toml(text: str) -> TomlTable:
    """Parse TOML, with each decimal kept as it is written, because 0.1 is to mean 1/10. Raises ValueError."""
    if any(line.count(".") > MOST_DOTS for line in _DECIMAL.sub("", text).split("\n")):
        raise ValueError(f"not TOML: more than {MOST_DOTS} dots in one line")
    try:
        return tomllib.loads(text, parse_float=str)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    except ValueError as error:
        reason = str(error).replace("Cannot overwrite a value", "a key is given twice").partition("; use sys.")[0]
        hint = '; write a fraction in quotes, "1/2"' if _BARE_FRACTION.search(text) else ""
        raise ValueError(f"not TOML: {reason}{hint}") from None


def quoted(value: object) -> str:
    """The value as an error message shows it."""
    try:
        return shortened(repr(value))
    except ValueError:  # an integer of more digits than Python will print
        return "a huge number"


def require_keys(table: TomlTable, allowed: Collection[str], what: str, more: str = "") -> None:
    """Raise ValueError for a key that is not allowed in `what`; `more` says where an example is shown."""
    if unknown := next((key for key in table if key not in allowed), None):
        shown = f" ({more})" if more else ""
        near = did_you_mean(unknown, allowed)
        raise ValueError(f"{what} has no key {quoted(unknown)}{near or ';'} its keys are {', '.join(allowed)}{shown}")


def as_text(value: object, where: str) -> str:
    """The value if it is a string."""
    if isinstance(value, str):
        return value
    raise _refusal(value, where, "text in quotes")


def as_line(value: object, where: str, longest: int) -> str:
    """The value, without blanks around it, if it is one line of text of 1 to `longest` characters."""
    if isinstance(value, str) and value.strip() and len(value) <= longest and value.isprintable():
        return value.strip()
    raise _refusal(value, where, f"a line of text of 1 to {longest} characters, all printable, in quotes")


def as_texts(value: object, where: str) -> tuple[str, ...]:
    """The value, as a tuple, if it is a list of strings."""
    return tuple(as_text(x, f"{where}[{i}]") for i, x in enumerate(as_list(value, where)))


def as_flag(value: object, where: str) -> bool:
    """The value if it is true or false."""
    if isinstance(value, bool):
        return value
    raise _refusal(value, where, "true or false")


def as_whole(value: object, where: str, least: int, most: int) -> int:
    """The value if it is a whole number from `least` to `most`."""
    if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
        return value
    raise _refusal(value, where, f"a whole number from {least} to {most}")


def as_choice(value: object, where: str, allowed: Collection[str]) -> str:
    """The value if it is one of the words allowed."""
    if isinstance(value, str) and value in allowed:
        return value
    near = did_you_mean(value, allowed) if isinstance(value, str) else ""
    raise _refusal(value, where, " or ".join(map(repr, allowed)) + near)


def as_table(value: object, where: str) -> TomlTable:
    """The value if it is a table."""
    if isinstance(value, dict):
        return value
    raise _refusal(value, where, f"a table [{where}]")


def as_list(value: object, where: str, length: int | None = None, most: int | None = None) -> list[Any]:
    """The value if it is a list of `length` entries, or of at most `most`, which are counted before any is read."""
    if not isinstance(value, list):
        raise _refusal(value, where, "a list")
    if most is not None and len(value) > most:
        raise ValueError(f"{where} has {len(value)} entries; at most {most} are allowed")
    if length is not None and len(value) != length:
        raise ValueError(f"{where} has {len(value)} entries, {length} are needed")
    return value


def _refusal(value: object, where: str, allowed: str) -> ValueError:
    """The error for a wrong value; None, which TOML cannot express, stands for a missing entry."""
    return ValueError(f"{where} is {'missing' if value is None else quoted(value)}; write {allowed}")
