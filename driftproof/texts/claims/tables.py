"""The tables of a text: the row that a number stands in, and the heads of its columns."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise, takewhile
from typing import NamedTuple

from driftproof.texts.readers.numbers import TextNumber

# What separates the cells of a row, also on a page of a wiki.
_CELL = re.compile(r"\|\|?|!!|^!")
# A head in bold on a page of a wiki.
_BOLD = re.compile(r"\A'{2,3}(.*)'{2,3}\Z")

# Characters before a number that are searched for the head of its table.
_FARTHEST = 2000


class Cell(NamedTuple):
    """A cell of a table: the head of its column and its own text, in lower case, and where it stands."""

    head: str
    text: str
    start: int
    end: int


class TextTables:
    """The tables of a text in canonical spelling."""

    def __init__(self, text: str) -> None:
        self._text = text.lower()
        self._rows: dict[int, list[Cell]] = {}

    def column_of(self, number: TextNumber) -> str:
        """The head of the number's column in a table, in lower case; "" for other numbers."""
        return cell.head if (cell := self.cell_of(number)) else ""

    def cell_of(self, number: TextNumber) -> Cell | None:
        """The cell of a table that the number stands in, None outside tables."""
        return next((cell for cell in self.row_of(number) if cell.start <= number.start < cell.end), None)

    def row_of(self, number: TextNumber) -> list[Cell]:
        """The cells of the number's row in a table; [] outside tables."""
        return self._row(self._text.rfind("\n", 0, number.start) + 1)

    def rows(self) -> Iterator[list[Cell]]:
        """The cells of every row of every table."""
        yield from filter(None, (self._row(line.start()) for line in re.finditer("(?m)^", self._text)))

    def _row(self, start: int) -> list[Cell]:
        row = self._text[start : (self._text.find("\n", start) + 1 or len(self._text) + 1) - 1]
        if start not in self._rows:
            self._rows[start] = [*self._cells(row, start)] if _CELL.search(row) else []
        return self._rows[start]

    def column_place(self, number: TextNumber) -> tuple[int, int]:
        """The place where the number's table begins, and its column there; (-1, -1) outside tables."""
        cell = self.cell_of(number)
        column = self.row_of(number).index(cell) if cell else -1
        start = self._text.rfind("\n", 0, number.start) + 1
        while start and _CELL.search(self._text, begin := self._text.rfind("\n", 0, start - 1) + 1, start):
            start = begin
        return (start, column) if column >= 0 else (-1, -1)

    def _cells(self, row: str, start: int) -> Iterator[Cell]:
        heads, below = dict[int, str](), list[str]()
        above = self._text[max(0, start - _FARTHEST) : max(0, start - 1)].split("\n")
        for cells in takewhile(lambda cells: len(cells) > 1, map(_CELL.split, reversed(above))):
            if cells[0] != "{" and not cells[1].startswith(("+", "-")):
                named = [_BOLD.sub(r"\1", cell.strip()) for cell in cells]
                named = [cell.replace("(3/8)", "(3/8 rule)") for cell in named]
                heads |= {i: cell or "".join(below[i : i + 1]) for i, cell in enumerate(named)}
                below = [] if any(cell[:1].isdigit() for cell in named) else named  # a second row of heads
        ends = [*(match.end() for match in _CELL.finditer(row)), len(row)]
        for column, (begin, end) in enumerate(pairwise([0, *ends])):
            cell = _CELL.sub("", row[begin:end])
            yield Cell(heads.get(column, ""), cell.strip(), start + begin, start + end)
