"""Documents: a file read in one of several formats, in canonical spelling, with the position of each character."""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from driftproof.support.files import read_utf8
from driftproof.texts.readers.canonical import canonical_spelling
from driftproof.texts.readers.columns import with_columns_parted
from driftproof.texts.readers.html import html_blocks
from driftproof.texts.readers.jupyter import lines_of_cells, notebook_blocks
from driftproof.texts.readers.markdown import markdown_blocks
from driftproof.texts.readers.mediawiki import WIKI_TABLE, mediawiki_blocks
from driftproof.texts.readers.restructured import restructured_blocks
from driftproof.texts.readers.source_text import PROSE, Block, Insertion, SourceText, joined
from driftproof.texts.readers.tex import tex_blocks

READERS: dict[str, Callable[[SourceText], list[Block]]] = {
    "plain": lambda source: mediawiki_blocks(source) if WIKI_TABLE.search(source.text) else [Block(PROSE, source)],
    "markdown": markdown_blocks,
    "html": html_blocks,
    "rst": restructured_blocks,
    "tex": tex_blocks,
    "notebook": notebook_blocks,
    "mediawiki": mediawiki_blocks,
}
_ENDINGS = {
    **dict.fromkeys((".md", ".markdown", ".qmd", ".rmd", ".myst"), "markdown"),
    **dict.fromkeys((".html", ".htm", ".xhtml"), "html"),
    **dict.fromkeys((".tex", ".ltx", ".latex"), "tex"),
    **dict.fromkeys((".rst", ".rest"), "rst"),
    **dict.fromkeys((".mediawiki", ".wiki"), "mediawiki"),
    ".ipynb": "notebook",
}
_CODE = re.compile(r"^[^\n#]*[^\s#]", re.MULTILINE)
# A decimal comma, outside of brackets and lists; 0,25 is nothing else, and says so of the others of its text.
_DECIMAL_COMMA = re.compile(r"(?<![\w.,(\[{])(-?[0-9]+),(?=[0-9]+(?![\w)\]}]|[.,][0-9]))")
_SURELY, _ENOUGH = re.compile(rf"{_DECIMAL_COMMA.pattern}(?<=0,)(?<![0-9]0,)[0-9]{{2}}"), 2
# Comments in TeX and MyST begin with a percent sign.
_COMMENT = re.compile(r"(?<!\\)%.*")
_TAKEN_IN = re.compile(
    r"\\(?:input|include|subfile|lstinputlisting)\b(?:\[[^\]\n]*\])?\s*\{([^{}\n]+)\}|"
    r"^[ \t]*[`~:]{3,}\{(?:include|literalinclude)\}[ \t]*(\S+)",
    re.MULTILINE,
)
# A long book has 2 MB of text; the patterns of the readers take seconds for twice as much.
LARGEST_DOCUMENT = 4 * 2**20


class Position(NamedTuple):
    """A position in a file, line and column counted from 1."""

    line: int
    column: int


@dataclass(frozen=True)
class Document:
    """A file with content `source`: its `blocks` as read, and `text`, all of them joined in canonical spelling.

    Every character of `text` keeps its place in the file.
    """

    source: str
    text: SourceText
    blocks: tuple[Block, ...]
    starts: tuple[int, ...]  # where each non-empty block begins in `text`
    cells: tuple[tuple[int, str], ...] = ()  # of a notebook, see `lines_of_cells`

    @cached_property
    def _ranges(self) -> list[tuple[int, int, int]]:
        """The origin in the file and the span in the text of each block, sorted: notebooks may store outputs first."""
        ends = (*self.starts, len(self.text.text))[1:]
        blocks = ((self.text.origin(start), start, end) for start, end in zip(self.starts, ends, strict=True))
        return [(-1, 0, 0), *sorted(blocks)]

    def span(self, piece: SourceText) -> tuple[int, int]:
        """The span of `text` that a piece of a block occupies."""
        start, end = (self._index(piece.origin(at)) for at in (0, len(piece.text)))
        return start, end

    def _index(self, origin: int) -> int:
        at = bisect_right(self._ranges, (origin, len(self.text.text))) - 1
        return bisect_left(self.text.origins, origin, *self._ranges[at][1:])

    @cached_property
    def code(self) -> tuple[tuple[int, int], ...]:
        """The spans of the lines of programs in the text, comments excluded: numbers there are inputs, not claims."""
        programs = (block.text for block in self.blocks if block.is_program)
        return tuple(self.span(text[slice(*m.span())]) for text in programs for m in _CODE.finditer(text.text))

    @cached_property
    def other_files(self) -> list[str]:
        r"""The files that the text includes, by \input{...} or an include directive; they are not read."""
        return list(dict.fromkeys(a or b for a, b in _TAKEN_IN.findall(_COMMENT.sub("", self.source))))

    @cached_property
    def _line_starts(self) -> list[int]:
        return [0, *(i + 1 for i, character in enumerate(self.source) if character == "\n")]

    def position(self, index: int) -> Position:
        """The position in the file of the character text[index]."""
        return self.position_of_origin(self.text.origin(index))

    def place(self, index: int) -> str:
        """The line of the character text[index] for readers: line 12, or in a notebook cell 3, line 2."""
        return self._line_shown(self.text.origin(index)) or f"line {self.position(index).line}"

    def shown(self, line: int, column: int) -> str:
        """A position in the file for readers: 12:5, or in a notebook cell 3, line 2."""
        return self._line_shown(self._line_starts[line - 1] + column - 1) or f"{line}:{column}"

    def _line_shown(self, origin: int) -> str:
        at = bisect_right(self.cells, origin, key=lambda line: line[0])
        return self.cells[at - 1][1] if at else ""

    def position_of_origin(self, origin: int) -> Position:
        """The position of an offset in the file."""
        line = bisect_right(self._line_starts, origin)
        return Position(line, origin - self._line_starts[line - 1] + 1)


def document_of(source: str, form: str = "plain") -> Document:
    """Read `source` in the format `form`, one of READERS. Raises ValueError if it is not in that format."""
    if form not in READERS:
        raise ValueError(f"format: {form!r} is unknown; choose one of {', '.join(READERS)}")
    blocks = tuple(READERS[form](SourceText.of(source)))
    pieces: list[SourceText | Insertion] = []
    starts, end = list[int](), 0
    commas = sum(len(_SURELY.findall(block.text.text)) for block in blocks if not block.is_program) >= _ENOUGH
    for block in blocks:
        text = block.text if block.is_program else with_columns_parted(block.text)
        text = canonical_spelling(text).stripped()
        if commas and not block.is_program:
            text = text.rewritten(_DECIMAL_COMMA, lambda match: [match.span(1), "."])
        if text.text:
            pieces += [Insertion("\n", text.origin(0)), text] if pieces else [text]
            starts.append(end)
            end += len(text.text) + 1  # one for the line break between blocks
    cells = tuple(lines_of_cells(source)) if form == "notebook" else ()
    return Document(source, joined(pieces), blocks, tuple(starts), cells)


def read_document(path: str | Path, form: str | None = None) -> Document:
    """Read the file at `path` in the format `form`, by default the one of its suffix, plain for unknown suffixes.

    Raises ValueError for no file, one of more than LARGEST_DOCUMENT bytes, not in UTF-8, or not in the format.
    """
    path = Path(path)
    source = read_utf8(path, LARGEST_DOCUMENT)
    try:
        return document_of(source, form or _ENDINGS.get(path.suffix.lower(), "plain"))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
