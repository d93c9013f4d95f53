"""A text that knows from which place of its file each character came, however often it was rewritten."""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

PROSE, LISTING, OUTPUT = "prose", "listing", "output"
# What a listing is called where it shows what a program prints.
OF_OUTPUT = {"", "text", "txt", "output", "console", "stdout", "none", "plaintext", "default"}


class Insertion(NamedTuple):
    """New text that stands for the character at `at`: of the text it replaces, or, when joined, of the file."""

    text: str
    at: int


# What a match becomes: a span of the old text copied, or new text, which stands for where the last piece ended.
Piece: TypeAlias = "str | tuple[int, int] | Insertion"


@dataclass(frozen=True)
class SourceText:
    """`text`, whose character i came from the place origins[i] of the file."""

    text: str
    origins: array[int]

    @classmethod
    def of(cls, source: str) -> SourceText:
        """A file's text as it stands."""
        return cls(source, array("I", range(len(source))))

    def origin(self, index: int) -> int:
        """The place in the file from which the character at `index` came; of the end, that after the last one."""
        if index < len(self.text):
            return self.origins[index]
        return self.origins[-1] + 1 if self.text else 0

    def __getitem__(self, span: slice) -> SourceText:
        """The characters of a span, with their places."""
        return SourceText(self.text[span], self.origins[span])

    def stripped(self) -> SourceText:
        """The text without the space around it."""
        start = len(self.text) - len(self.text.lstrip())
        return self[start : max(start, len(self.text.rstrip()))]

    def rewritten(self, pattern: re.Pattern[str], become: Callable[[re.Match[str]], Iterable[Piece]]) -> SourceText:
        """The text with every match replaced by the pieces that `become` gives for it, places kept."""
        found: list[SourceText | Insertion] = []
        done = 0
        for match in pattern.finditer(self.text):
            found.append(self[done : match.start()])
            at = match.start()
            for piece in become(match):
                if isinstance(piece, str):
                    found.append(Insertion(piece, self.origin(at)))
                elif isinstance(piece, Insertion):
                    at = piece.at
                    found.append(Insertion(piece.text, self.origin(at)))
                else:
                    found.append(self[slice(*piece)])
                    at = min(piece[1], match.end() - 1)
            done = match.end()
        return joined([*found, self[done:]])

    def removed(self, pattern: re.Pattern[str]) -> SourceText:
        """The text without what matches."""
        return self.rewritten(pattern, lambda match: ())


def joined(pieces: Iterable[SourceText | Insertion]) -> SourceText:
    """Pieces one after the other."""
    texts, origins = [], array("I")
    for piece in pieces:
        texts.append(piece.text)
        if isinstance(piece, Insertion):
            origins.extend([piece.at] * len(piece.text))
        else:
            origins.extend(piece.origins)
    return SourceText("".join(texts), origins)


@dataclass(frozen=True)
class Block:
    """A piece of a text: its kind, and of a listing its language as the text names it ("" where it names none)."""

    kind: str
    text: SourceText
    language: str = ""

    @property
    def is_program(self) -> bool:
        """Whether it is a listing in a language of programs, and no session with what it printed."""
        return self.kind == LISTING and self.language not in OF_OUTPUT and ">>>" not in self.text.text
