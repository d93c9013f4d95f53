"""The tables of a text: the row that a number stands in, and the heads of its columns."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import chain, dropwhile, pairwise, takewhile
from typing import NamedTuple

from driftproof.texts.claims.heads import STEP, is_head_of, is_of_steps
from driftproof.texts.readers.numbers import TextNumber

# What separates the cells of a row, also on a page of a wiki.
_CELL = re.compile(r"\|\|?|!!|^!")
# A line of cells: it begins with a sign of cells, or blanks are around one, unlike the bars of |x|.
_IS_ROW = re.compile(r"^[|!{]|!!|(?<=\s)\|\|?(?=\s|$)")
# A head in bold on a page of a wiki.
_BOLD = re.compile(r"\A'{2,3}(.*)'{2,3}\Z")

# A heading: a short line, with no sign of a sentence or an equation, between the end of one and the begin of another.
# It ends a section as a row of a table does.
_SECTION_ENDS = re.compile(
    r"(?m)^(?:[|!{].*|.*\S \|\|? .*|(?<=[^\w,(]\n)[#=* ]*[^\W_](?:[^|=.,;:\n]|[hH] ?= ?[0-9.]+){1,60}[=# ]*$"
    r"(?=\n[#*(]*[^a-z\s]))"
)

# Characters before a number that are searched for the head of its table.
_FARTHEST = 2000


class Cell(NamedTuple):
    """A cell of a table: the head of its column and its text, in lower case, where it stands, and both as written."""

    head: str
    text: str
    start: int
    end: int
    head_written: str
    written: str


class Address(NamedTuple):
    """The beginning of the row of a number, as in RK4 or RK4 | 0.1, and the head of its column; "" for any.

    Several numbers of one row have several `columns`.
    """

    row: str = ""
    column: str = ""
    columns: tuple[str, ...] = ()


ANYWHERE = Address()


@lru_cache(maxsize=4)
def tables_of(text: str) -> TextTables:
    """The tables of a text, read once."""
    return TextTables(text)


class TextTables:
    """The tables of a text in canonical spelling."""

    def __init__(self, text: str) -> None:
        self._written, self._text = text, text.lower()
        self._rows, self._beginnings = dict[int, list[Cell]](), dict[int, Counter[str]]()
        self._begins, self._read = dict[int, int](), set[int]()

    def column_of(self, number: TextNumber) -> str:
        """The head of the number's column in a table, in lower case; "" for other numbers."""
        return cell.head if (cell := self.cell_of(number)) else ""

    def cell_of(self, number: TextNumber) -> Cell | None:
        """The cell of a table that the number stands in, None outside tables."""
        return next((cell for cell in self.row_of(number) if cell.start <= number.start < cell.end), None)

    def row_of(self, number: TextNumber) -> list[Cell]:
        """The cells of the number's row in a table; [] outside tables."""
        start = self._text.rfind("\n", 0, number.start) + 1
        row = self._row(start)
        if row and (table := self._beginning(start)) not in self._read:
            self._read.add(table)
            self._mark_steps([*self._table(table)])
        return row

    def _mark_steps(self, rows: list[list[Cell]]) -> None:
        """Call the columns of a table so which have numbers of steps, each in the row of its step."""
        columns = defaultdict[int, list[Cell]](list)
        for i, cell in chain(*map(enumerate, rows)):
            columns[i] += [cell] * bool(cell.head and cell.written)
        heads = {cells[0].head_written for cells in columns.values() if cells}
        for i, cells in columns.items():
            if cells and is_of_steps(cells[0].head_written, [cell.written for cell in cells], heads):
                for row in rows:
                    row[i : i + 1] = [cell._replace(head=STEP) for cell in row[i : i + 1]]

    def _row(self, start: int) -> list[Cell]:
        row = self._line(start)
        if start not in self._rows:
            self._rows[start] = [*self._cells(row, start)] if _CELL.search(row) and _IS_ROW.search(row) else []
        return self._rows[start]

    def _line(self, start: int) -> str:
        return self._text[start : (self._text.find("\n", start) + 1 or len(self._text) + 1) - 1]

    def _begins_anew(self, start: int) -> bool:
        """True if the row that begins there has the heads of a table right below another one."""
        above = self._line(self._text.rfind("\n", 0, max(0, start - 1)) + 1) if start else ""
        return _is_heads_of_setting(_CELL.split(self._line(start))) and _has_numbers(_CELL.split(above))

    def address(self, number: TextNumber) -> Address:
        """The row of the number, as the text writes it: as much of it as no other one begins with; and its column.

        That is the first cell that is not empty, if others begin with all of the cells before the number, too.
        """
        row, (table, _) = self.row_of(number), self.column_place(number)
        if table not in self._beginnings:
            self._beginnings[table] = Counter(one for row in self._table(table) for one in _beginnings(row))
        own = _beginnings([cell for cell in row if cell.end <= number.start])
        label = next((one for one in own if self._beginnings[table][one] == 1), next(iter(own), ""))
        return Address(label, self.head_at(number.start))

    def head_at(self, start: int) -> str:
        """The head of the column of what begins there, as the text writes it; "" for a number and outside tables."""
        row = self._row(self._text.rfind("\n", 0, start) + 1)
        head = next((cell.head_written for cell in row if cell.start <= start < cell.end), "")
        return "" if re.match("[-+.]?[0-9]", head) else head

    def stands_at(self, address: Address, start: int) -> bool:
        """True if what begins there is in such a row and column."""
        row = self._row(self._text.rfind("\n", 0, start) + 1)
        heads = [cell.head_written.lower() for cell in row if cell.start <= start < cell.end]
        is_row = not address.row or address.row.lower() in map(str.lower, _beginnings(row))
        return is_row and (not address.column or heads == [address.column.lower()])

    def _table(self, start: int) -> Iterator[list[Cell]]:
        """The rows of the table that begins there."""
        first = start
        while start >= 0 and (row := self._row(start)) and (start == first or not self._begins_anew(start)):
            yield row
            start = self._text.find("\n", start) + 1 or -1

    def section_of(self, table: int) -> str:
        """The text around the table that begins there, up to the headings and tables before and after it."""
        above = self._written[:table]
        below = "\n".join(dropwhile(_IS_ROW.search, self._written[table:].split("\n")))
        starts = [end.start() for end in _SECTION_ENDS.finditer(above)][-1:] or [0]
        end = _SECTION_ENDS.search("\n" + below)
        return above[starts[0] :] + below[: end.start() if end else len(below)]

    def column_place(self, number: TextNumber) -> tuple[int, int]:
        """The place where the number's table begins, and its column there; (-1, -1) outside tables."""
        cell = self.cell_of(number)
        column = self.row_of(number).index(cell) if cell else -1
        start = self._text.rfind("\n", 0, number.start) + 1
        return (self._beginning(start), column) if column >= 0 else (-1, -1)

    def _beginning(self, start: int) -> int:
        """The place where the table with the row that begins there begins."""
        if start not in self._begins:
            begin, rows = start, [start]
            while begin not in self._begins and begin and not self._begins_anew(begin):
                if not self._row(above := self._text.rfind("\n", 0, begin - 1) + 1):
                    break
                rows.append(begin := above)
            self._begins |= dict.fromkeys(rows, self._begins.get(begin, begin))
        return self._begins[start]

    def _cells(self, row: str, start: int) -> Iterator[Cell]:
        heads, below, is_second = dict[int, str](), list[str](), False
        above = self._written[max(0, start - _FARTHEST) : max(0, start - 1)].split("\n")
        for cells in map(_CELL.split, takewhile(_IS_ROW.search, reversed(above))):
            if below and is_second and _has_numbers(cells):
                break  # of a table right above this one
            is_second = _is_heads_of_setting(cells)
            if cells[0] != "{" and not cells[1].startswith(("+", "-")):
                named = [_BOLD.sub(r"\1", cell.strip()) for cell in cells]
                named = [cell.replace("(3/8)", "(3/8 rule)") for cell in named]
                heads |= {i: cell or "".join(below[i : i + 1]) for i, cell in enumerate(named)}
                below = [] if any(cell[:1].isdigit() for cell in named) else named  # a second row of heads
        ends = [*(match.end() for match in _CELL.finditer(row)), len(row)]
        for column, (begin, end) in enumerate(pairwise([0, *ends])):
            head, cell = heads.get(column, ""), _CELL.sub("", self._written[start + begin : start + end]).strip()
            yield Cell(head.lower(), cell.lower(), start + begin, start + end, head, cell)


def _has_numbers(cells: Iterable[str]) -> bool:
    return any(cell.strip()[:1].isdigit() for cell in cells)


def _is_heads_of_setting(cells: Iterable[str]) -> bool:
    """True for a row of heads, the first that of a step size, a time or a number of steps."""
    shown = [cell.strip().lower() for cell in cells if cell.strip()]
    return len(shown) > 1 and is_head_of("htns", shown[0]) and not _has_numbers(shown)


def _beginnings(row: list[Cell]) -> list[str]:
    """The beginnings of a row: its first cell that is not empty, that with the next one, and so on."""
    texts = [*dropwhile(lambda text: not text, (cell.written for cell in row))]
    return [" | ".join(texts[:i]) for i in range(1, len(texts) + 1)]
