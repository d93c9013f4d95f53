"""TOML that users write: read within limits, decimals kept as written, each entry checked, each refusal one line.

A refusal is a ValueError that says what stands where, and what may: "count is -1; write a whole number from 0 to 9".
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

from driftproof.support.plain_text import shortened

TomlTable: TypeAlias = dict[str, Any]
_T = TypeVar("_T")

# tomllib takes the square of the time for a key of many parts, which are parted by dots: 1 ms for so many.
MOST_DOTS = 300
_DECIMAL = re.compile(rb"(?<![\w.])\d+\.\d+(?![\w.])")


def read_toml(
    path: str | Path, longest: int, make: Callable[[TomlTable], _T], refusal: type[ValueError] = ValueError
) -> _T:
    """What `make` makes of the file's table. Whatever is wrong is a `refusal`, one line that names the file."""
    try:
        with Path(path).open("rb") as file:
            content = file.read(longest + 1)
        return make(parse_toml(content, longest))
    except OSError as error:
        reason = error.strerror or "cannot be read"
    except ValueError as error:
        reason = str(error)
    raise refusal(" ".join(f"{path}: {reason}".split()))


def parse_toml(content: bytes, longest: int) -> TomlTable:
    """The table that the content spells, a decimal as the string that stands there: 0.1 is to mean 1/10.

    Raises ValueError for more than `longest` bytes, and for anything that is not TOML.
    """
    if len(content) > longest:
        raise ValueError(f"too large; at most {longest} bytes are read")
    if any(line.count(b".") > MOST_DOTS for line in _DECIMAL.sub(b"", content).splitlines()):
        raise ValueError(f"not TOML: more than {MOST_DOTS} dots in one line")
    try:
        return tomllib.loads(content.decode(), parse_float=str)
    except UnicodeDecodeError as error:
        raise ValueError(f"byte {error.start} is not UTF-8 text") from None
    except RecursionError:
        raise ValueError("nested too deeply") from None
    except ValueError as error:
        reason = str(error).replace("Cannot overwrite a value", "a key is given twice")
        hint = '; write a fraction in quotes, "1/2"' if _BARE_FRACTION.search(content) else ""
        raise ValueError(f"not TOML: {reason}{hint}") from None


# An entry such as [1/2, ...
_BARE_FRACTION = re.compile(rb"[\[,=]\s*-?\d+\s*/\s*\d")


def quoted(value: object) -> str:
    """The value as a refusal shows it."""
    try:
        return shortened(repr(value))
    except ValueError:  # an integer of more digits than Python will print
        return "a huge number"


def demand_keys(table: TomlTable, allowed: Collection[str], what: str, more: str = "") -> None:
    """Refuse a key that is not among those allowed in `what`; `more` says where one is shown."""
    if unknown := next((key for key in table if key not in allowed), None):
        shown = f" ({more})" if more else ""
        raise ValueError(f"{what} has no key {quoted(unknown)}; its keys are {', '.join(allowed)}{shown}")


def as_text(value: object, where: str) -> str:
    """Any text."""
    if isinstance(value, str):
        return value
    raise _refusal(value, where, "text in quotes")


def as_line(value: object, where: str, longest: int) -> str:
    """A text of one line, neither blank nor longer; blanks around it are dropped."""
    if isinstance(value, str) and value.strip() and len(value) <= longest and value.isprintable():
        return value.strip()
    raise _refusal(value, where, f"a line of text of 1 to {longest} characters, in quotes")


def as_texts(value: object, where: str) -> tuple[str, ...]:
    """A list of texts."""
    return tuple(as_text(x, f"{where}[{i}]") for i, x in enumerate(as_list(value, where)))


def as_flag(value: object, where: str) -> bool:
    """True or false."""
    if isinstance(value, bool):
        return value
    raise _refusal(value, where, "true or false")


def as_whole(value: object, where: str, least: int, most: int) -> int:
    """A whole number between the two."""
    if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
        return value
    raise _refusal(value, where, f"a whole number from {least} to {most}")


def as_choice(value: object, where: str, allowed: Collection[str]) -> str:
    """One of the words allowed."""
    if isinstance(value, str) and value in allowed:
        return value
    raise _refusal(value, where, " or ".join(map(repr, allowed)))


def as_table(value: object, where: str) -> TomlTable:
    """A table."""
    if isinstance(value, dict):
        return value
    raise _refusal(value, where, f"a table [{where}]")


def as_list(value: object, where: str, length: int | None = None, most: int | None = None) -> list[Any]:
    """A list of this length, or of at most so many entries; they are counted before any of them is looked at."""
    if not isinstance(value, list):
        raise _refusal(value, where, "a list")
    if most is not None and len(value) > most:
        raise ValueError(f"{where} has {len(value)} entries; at most {most} are allowed")
    if length is not None and len(value) != length:
        raise ValueError(f"{where} has {len(value)} entries, {length} are needed")
    return value


def _refusal(value: object, where: str, allowed: str) -> ValueError:
    """In one line; None, which TOML cannot spell, is an entry that is not there."""
    return ValueError(f"{where} is {'missing' if value is None else quoted(value)}; write {allowed}")
