"""What is asked of a code and what is said of it, word for word, held to what it was: the transcripts beside the tests.

An answer depends on every question before it: so the questions are held, too, by their number and a checksum. Where a
change is meant, WRITE_TRANSCRIPTS=1 in the environment writes the new ones, to be read before they are committed.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterable
from functools import wraps
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

_TITLE = re.compile(r"(?m)^== (.*)\n")


class Asked:
    """The questions that a code is asked: `code` is the code itself, but for that they are noted."""

    def __init__(self, code: Callable[..., Any]) -> None:
        """Note what it is given, and what the functions that it is given are asked in turn."""
        self.count, self.checksum = 0, 0

        def noted(function: Callable[..., Any]) -> Callable[..., Any]:
            @wraps(function)
            def asked(*given: Any, **named: Any) -> Any:
                shown = [_shown(x) for x in (*given, *named.values())]
                self.count, self.checksum = self.count + 1, crc32(" ".join(shown).encode(), self.checksum)
                return function(*(noted(x) if _is_function(x) else x for x in given), **named)

            return asked

        self.code = noted(code)

    def __str__(self) -> str:
        return f"asked {self.count} times, {self.checksum:08x}"


def _is_function(x: Any) -> bool:
    return callable(x) and not isinstance(x, type) and not hasattr(x, "__array__")


def _shown(x: Any) -> str:
    """Numbers to the last bit; of a ball, whose last digits are nobody's promise, only what it is."""
    if isinstance(x, int | float | np.floating | np.integer):
        return f"{type(x).__name__} {float(x)!r}"
    if isinstance(x, np.ndarray) and x.ndim == 1 and x.dtype == float:  # the usual case, at once
        return f"{type(x).__name__}[{' '.join([f'float64 {each!r}' for each in x.tolist()])}]"
    if isinstance(x, list | tuple | np.ndarray):
        parts = [x.item()] if isinstance(x, np.ndarray) and x.ndim == 0 else x
        return f"{type(x).__name__}[{' '.join(map(_shown, parts))}]"
    return type(x).__name__


def checksum(text: str) -> str:
    """Of what is too long to be read."""
    return f"{len(text)} letters, {crc32(text.encode()):08x}"


def shortened(lines: Iterable[object], told: bool) -> list[object]:
    """What is told, and the checksum of what is like it."""
    return [*lines] if told else [checksum("\n".join(map(str, lines)))]


def summed(report: Any) -> tuple[str, ...]:
    """The verdict of a report, and checksums of all that it says: of a code that calls no library for its sums."""
    text = report.text(everything=True).partition("\n")[2]
    return report.verdict, checksum(text), checksum(report.json())


def to_twelve_digits(text: str) -> str:
    """What was fitted, without the digits that other machines' linear algebra has otherwise."""
    return re.sub(r"\d+\.\d{12,}", lambda match: f"{float(match[0]):.12g}", text)


def titles(report: Any) -> tuple[str, ...]:
    """The titles of a report's sections, which say what passed."""
    return tuple(section.title for section in report.sections)


def assert_as_before(place: Path, title: str, said: Iterable[object], tests: Collection[str] = ()) -> None:
    """The lines are those under the title in the file, and each of its titles is one of `tests`, if these are known."""
    parts = _TITLE.split(place.read_text(encoding="utf-8") if place.exists() else "")[1:]
    kept = dict(zip(parts[::2], parts[1::2], strict=True))
    text = "".join(f"{line}\n" for line in "\n".join(map(str, said)).splitlines())
    if os.environ.get("WRITE_TRANSCRIPTS"):
        kept[title] = text
        kept = {name: kept[name] for name in kept if not tests or name in tests}
        place.write_text("".join(f"== {name}\n{kept[name]}" for name in kept), encoding="utf-8")
    again = f"not as in {place.name}; where it is meant: WRITE_TRANSCRIPTS=1, and read the change"
    assert kept.get(title) == text, again
    assert not tests or kept.keys() <= set(tests), again
