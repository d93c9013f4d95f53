"""A text, rewritten any number of times, that knows from which place of its file each character came."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias


class At(NamedTuple):
    """New text that stands for the character at `at` of the text it replaces."""

    text: str
    at: int


# What a match becomes: a span of the old text copied, or new text, which stands for where the last part ended.
Part: TypeAlias = "str | tuple[int, int] | At"


@dataclass(frozen=True)
class Mapped:
    """`text`, whose run k begins at starts[k] and came from origins[k] of the file.

    In a run that moves, each next character came from the next place; otherwise the whole run stands for one place.
    """

    text: str
    starts: tuple[int, ...]
    origins: tuple[int, ...]
    moves: tuple[bool, ...]

    @classmethod
    def of(cls, source: str) -> Mapped:
        """A file's text as it stands."""
        return cls(source, (0,), (0,), (True,))

    def origin(self, index: int) -> int:
        """The place in the file from which the character at `index` came; of the end, that after the last one."""
        if index >= len(self.text) > 0:
            return self.origin(len(self.text) - 1) + 1
        run = bisect_right(self.starts, index) - 1
        return self.origins[run] + (index - self.starts[run] if self.moves[run] else 0)

    def index(self, origin: int) -> int:
        """The first character that came from `origin` or a later place, in a text whose order is the file's."""
        low, high = 0, len(self.text)
        while low < high:
            middle = (low + high) // 2
            low, high = (middle + 1, high) if self.origin(middle) < origin else (low, middle)
        return low

    def __getitem__(self, span: slice) -> Mapped:
        """The characters of a span, with their places."""
        writer = _Writer()
        start, stop, _ = span.indices(len(self.text))
        writer.copy(self, start, stop)
        return writer.written()

    def rewritten(self, pattern: re.Pattern[str], become: Callable[[re.Match[str]], Iterable[Part]]) -> Mapped:
        """The text with every match replaced by the parts that `become` gives for it, places kept."""
        writer, done = _Writer(), 0
        for match in pattern.finditer(self.text):
            writer.copy(self, done, match.start())
            at = match.start()
            for part in become(match):
                if isinstance(part, str):
                    writer.write(part, self.origin(at))
                elif isinstance(part, At):
                    at = part.at
                    writer.write(part.text, self.origin(at))
                else:
                    writer.copy(self, *part)
                    at = min(part[1], match.end() - 1)
            done = match.end()
        writer.copy(self, done, len(self.text))
        return writer.written()

    def removed(self, pattern: re.Pattern[str]) -> Mapped:
        """The text without what matches."""
        return self.rewritten(pattern, lambda match: ())


def joined(pieces: Iterable[Mapped | At]) -> Mapped:
    """Pieces one after the other; an `At` is new text that stands for a place of the file."""
    writer = _Writer()
    for piece in pieces:
        if isinstance(piece, At):
            writer.write(piece.text, piece.at)
        else:
            writer.copy(piece, 0, len(piece.text))
    return writer.written()


@dataclass
class _Writer:
    """Builds a mapped text from copies and new text."""

    texts: list[str] = field(default_factory=list)
    length: int = 0
    starts: list[int] = field(default_factory=list)
    origins: list[int] = field(default_factory=list)
    moves: list[bool] = field(default_factory=list)

    def write(self, text: str, origin: int, moves: bool = False) -> None:
        if not text:
            return
        self.starts.append(self.length)
        self.origins.append(origin)
        self.moves.append(moves)
        self.texts.append(text)
        self.length += len(text)

    def copy(self, source: Mapped, start: int, stop: int) -> None:
        if start >= stop:
            return
        run = bisect_right(source.starts, start) - 1
        while start < stop:
            end = min(stop, source.starts[run + 1]) if run + 1 < len(source.starts) else stop
            self.write(source.text[start:end], source.origin(start), source.moves[run])
            start, run = end, run + 1

    def written(self) -> Mapped:
        if not self.starts:
            return Mapped("", (0,), (0,), (True,))
        return Mapped("".join(self.texts), tuple(self.starts), tuple(self.origins), tuple(self.moves))
