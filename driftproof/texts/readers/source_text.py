"""A text whose characters keep their places in the file through any number of rewritings."""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

PROSE, LISTING, OUTPUT = "prose", "listing", "output"
# Names of languages that mark a listing as the output of a program.
OUTPUT_LANGUAGES = {"", "text", "txt", "output", "console", "stdout", "none", "plaintext", "default"}


class Insertion(NamedTuple):
    """New text in place of a character: `at` is its index in the old text or, in `joined`, its offset in the file."""

    text: str
    at: int


# Part of a replacement: a span of the old text to copy, or new text, whose place is the end of the last piece.
Piece: TypeAlias = "str | tuple[int, int] | Insertion"


@dataclass(frozen=True)
class SourceText:
    """A text whose character text[i] comes from the offset origins[i] of the file."""

    text: str
    origins: array[int]

    @classmethod
    def of(cls, source: str) -> SourceText:
        """The whole text of a file."""
        return cls(source, array("I", range(len(source))))

    def origin(self, index: int) -> int:
        """The offset in the file of the character at `index`; at the end, one more than the last offset."""
        if index < len(self.text):
            return self.origins[index]
        return self.origins[-1] + 1 if self.text else 0

    def __getitem__(self, span: slice) -> SourceText:
        """The slice of the text, with its places."""
        return SourceText(self.text[span], self.origins[span])

    def stripped(self) -> SourceText:
        """The text without leading and trailing white space."""
        start = len(self.text) - len(self.text.lstrip())
        return self[start : max(start, len(self.text.rstrip()))]

    def rewritten(self, pattern: re.Pattern[str], become: Callable[[re.Match[str]], Iterable[Piece]]) -> SourceText:
        """The text with each match replaced by the pieces that `become` returns for it, with places kept."""
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
        """The text without the matches of the pattern."""
        return self.rewritten(pattern, lambda match: ())


def joined(pieces: Iterable[SourceText | Insertion]) -> SourceText:
    """The concatenation of the pieces."""
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
    """A part of a document: prose, a listing or output, and the language that a listing names, "" if none."""

    kind: str
    text: SourceText
    language: str = ""

    @property
    def is_program(self) -> bool:
        """True for a listing that names a programming language and is not an interactive session."""
        return self.kind == LISTING and self.language not in OUTPUT_LANGUAGES and ">>>" not in self.text.text
