"""A file as a text: which reader, how much of it, and where in it each character stands."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from driftproof.texts.readers.blocks import Block
from driftproof.texts.readers.canonical import canonical
from driftproof.texts.readers.mapped import At, Mapped, joined
from driftproof.texts.readers.markdown import markdown_blocks
from driftproof.texts.readers.markup import html_blocks
from driftproof.texts.readers.notebook import notebook_blocks
from driftproof.texts.readers.plain import plain_blocks
from driftproof.texts.readers.tex import tex_blocks

READERS: dict[str, Callable[[Mapped], list[Block]]] = {
    "plain": plain_blocks,
    "markdown": markdown_blocks,
    "html": html_blocks,
    "tex": tex_blocks,
    "notebook": notebook_blocks,
}
_ENDINGS = {
    **dict.fromkeys((".md", ".markdown", ".qmd", ".rmd", ".myst"), "markdown"),
    **dict.fromkeys((".html", ".htm", ".xhtml"), "html"),
    **dict.fromkeys((".tex", ".ltx", ".latex"), "tex"),
    ".ipynb": "notebook",
}
LARGEST_TEXT = 4 * 2**20


class Place(NamedTuple):
    """Where something stands in a file, both counted from 1."""

    line: int
    column: int


@dataclass(frozen=True)
class Reading:
    """What a reader sees of the file `source`: `text`, in canonical spelling, with the place of each character.

    `blocks` are the pieces as they were read, `spans` where each stands in `text`.
    """

    source: str
    text: Mapped
    blocks: tuple[Block, ...]
    spans: tuple[tuple[int, int], ...]

    @cached_property
    def _line_starts(self) -> list[int]:
        return [0, *(i + 1 for i, character in enumerate(self.source) if character == "\n")]

    def place(self, index: int) -> Place:
        """Line and column in the file of the character at `index` of the text."""
        return self.place_of_origin(self.text.origin(index))

    def place_of_origin(self, origin: int) -> Place:
        """Line and column of a place in the file."""
        line = bisect_right(self._line_starts, origin)
        return Place(line, origin - self._line_starts[line - 1] + 1)


def read_text(source: str, form: str = "plain") -> Reading:
    """The text `source`, read as `form`, one of READERS. Raises ValueError for what the reader cannot take."""
    if form not in READERS:
        raise ValueError(f"format: {form!r} is unknown; choose one of {', '.join(READERS)}")
    blocks = tuple(READERS[form](Mapped.of(source)))
    pieces: list[Mapped | At] = []
    spans, length = [], 0
    for block in blocks:
        text = _stripped(canonical(block.text))
        if text.text and length:
            pieces.append(At("\n", text.origin(0)))
            length += 1
        pieces.append(text)
        spans.append((length, length + len(text.text)))
        length += len(text.text)
    return Reading(source, joined(pieces), blocks, tuple(spans))


def _stripped(text: Mapped) -> Mapped:
    """The text without the space around it."""
    start = len(text.text) - len(text.text.lstrip())
    return text[start : max(start, len(text.text.rstrip()))]


def read_file(path: str | Path, form: str | None = None) -> Reading:
    """The file at `path`, read as `form` or as its ending says, plain if that says nothing.

    Raises OSError, and ValueError for a file of more than LARGEST_TEXT bytes, one that is not UTF-8, and for what the
    reader cannot take.
    """
    path = Path(path)
    with path.open("rb") as file:
        content = file.read(LARGEST_TEXT + 1)
    if len(content) > LARGEST_TEXT:
        raise ValueError(f"{path}: a text has at most {LARGEST_TEXT} bytes")
    try:
        return read_text(content.decode(), form or _ENDINGS.get(path.suffix.lower(), "plain"))
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: byte {error.start} is not UTF-8 text") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
