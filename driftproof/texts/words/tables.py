"""The tables of a text: the row that a number stands in, and the heads of its columns."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import chain, dropwhile, pairwise
from typing import NamedTuple

from driftproof.texts.readers.numbers import TextNumber
from driftproof.texts.words.heads import PAIR, STEP, is_head_of, is_of_steps

# What separates the cells of a row, also on a page of a wiki.
_CELL = re.compile(r"\|\|?|!!|^!")
# A line of cells: it begins with a sign of cells, or blanks are around one, unlike the bars of |x|.
_IS_ROW = re.compile(r"^[|!{]|!!|(?<=\s)\|\|?(?=\s|$)")
_NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+|/[0-9]+)?")
# A head in bold on a page of a wiki.
_BOLD = re.compile(r"\A'{2,3}(.*)'{2,3}\Z")

# A heading: a short line, with no sign of a sentence or an equation, between the end of one and the begin of another.
# It ends a section as a row of a table does.
_SECTION_ENDS = re.compile(
    r"(?m)^(?:[|!{].*|.*\S \|\|? .*|(?<=[^\w,(]\n)[#=* ]*[^\W_](?:[^|=.,;:\n]|[hH] ?= ?[0-9.]+){1,60}[=# ]*$"
    r"(?=\n[#*(]*[^a-z\s]))"
)


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
        self._text, self._tables = text, defaultdict[int, list[list[Cell]]](list)
        self._rows, self._beginnings = dict[int, tuple[int, list[Cell]]](), dict[int, Counter[str]]()
        table, start, above = -1, 0, list[str]()
        for line in text.split("\n"):
            cells = _CELL.split(line)
            if not (cells[1:] and _IS_ROW.search(line)):
                table = -1
            else:
                if table < 0 or (_is_heads_of_setting(cells) and _has_numbers(above)):
                    table, heads = start, _Heads()
                self._tables[table].append([*heads.above(line, start)])
                self._rows[start] = table, self._tables[table][-1]
                heads.read(cells)
            above, start = cells, start + len(line) + 1
        for rows in self._tables.values():
            _mark_steps(rows)
            _mark_settings(rows)

    def _at(self, place: int) -> tuple[int, list[Cell]]:
        """The place where the table begins that has this place in it, and its row there; -1 and [] outside tables."""
        return self._rows.get(self._text.rfind("\n", 0, place) + 1, (-1, []))

    def column_of(self, number: TextNumber) -> str:
        """The head of the number's column in a table, in lower case; "" for other numbers."""
        return cell.head if (cell := self.cell_of(number)) else ""

    def cell_of(self, number: TextNumber) -> Cell | None:
        """The cell of a table that the number stands in, None outside tables."""
        return next((cell for cell in self.row_of(number) if cell.start <= number.start < cell.end), None)

    def row_of(self, number: TextNumber) -> list[Cell]:
        """The cells of the number's row in a table; [] outside tables."""
        return self._at(number.start)[1]

    def address(self, number: TextNumber) -> Address:
        """The row of the number, as the text writes it: as much of it as no other one begins with; and its column.

        That is the first cell that is not empty, if others begin with all of the cells before the number, too.
        """
        table, row = self._at(number.start)
        if table not in self._beginnings:
            self._beginnings[table] = Counter(one for row in self._tables.get(table, ()) for one in _beginnings(row))
        own = _beginnings([cell for cell in row if cell.end <= number.start])
        label = next((one for one in own if self._beginnings[table][one] == 1), next(iter(own), ""))
        return Address(label, self.head_at(number.start))

    def head_at(self, start: int) -> str:
        """The head of the column of what begins there, as the text writes it; "" for a number and outside tables."""
        head = next((cell.head_written for cell in self._at(start)[1] if cell.start <= start < cell.end), "")
        return "" if re.match("[-+.]?[0-9]", head) and not PAIR.fullmatch(head) else head

    def stands_at(self, address: Address, start: int) -> bool:
        """True if what begins there is in such a row and column."""
        _, row = self._at(start)
        heads = [cell.head_written.lower() for cell in row if cell.start <= start < cell.end]
        is_row = not address.row or address.row.lower() in map(str.lower, _beginnings(row))
        return is_row and (not address.column or heads == [address.column.lower()])

    def section_of(self, table: int) -> str:
        """The text around the table that begins there, up to the headings and tables before and after it."""
        above = self._text[:table]
        below = "\n".join(dropwhile(_IS_ROW.search, self._text[table:].split("\n")))
        starts = [end.start() for end in _SECTION_ENDS.finditer(above)][-1:] or [0]
        end = _SECTION_ENDS.search("\n" + below)
        return above[starts[0] :] + below[: end.start() if end else len(below)]

    def column_place(self, number: TextNumber) -> tuple[int, int]:
        """The place where the number's table begins, and its column there; (-1, -1) outside tables."""
        (table, row), cell = self._at(number.start), self.cell_of(number)
        return (table, row.index(cell)) if cell else (-1, -1)


class _Heads:
    """The heads of the columns of one table, by the rows that have been read; a second row may fill empty ones."""

    def __init__(self) -> None:
        self.of, self.empty = dict[int, str](), set[int]()

    def above(self, row: str, start: int) -> Iterator[Cell]:
        """The cells of the row, which begins there in the text."""
        ends = [*(match.end() for match in _CELL.finditer(row)), len(row)]
        for column, (begin, end) in enumerate(pairwise([0, *ends])):
            head, cell = self.of.get(column, ""), _CELL.sub("", row[begin:end]).strip()
            yield Cell(head.lower(), cell.lower(), start + begin, start + end, head, cell)

    def read(self, cells: list[str]) -> None:
        """Take the cells of a row, which is neither the beginning of a table on a wiki nor what parts its rows."""
        if cells[0] != "{" and not cells[1].startswith(("+", "-")):
            named = [_BOLD.sub(r"\1", cell.strip()).replace("(3/8)", "(3/8 rule)") for cell in cells]
            fills = set[int]() if any(cell[:1].isdigit() for cell in named) else self.empty
            found = {i: cell for i, cell in enumerate(named) if i in fills or i not in self.of}
            self.empty = {i for i, cell in found.items() if not cell and i not in self.of}
            self.of |= found


def _mark_steps(rows: list[list[Cell]]) -> None:
    """Call the columns of a table so which have numbers of steps, each in the row of its step."""
    columns = defaultdict[int, list[Cell]](list)
    for i, cell in chain(*map(enumerate, rows)):
        columns[i] += [cell] * bool(cell.head and cell.written)
    heads = {cells[0].head_written for cells in columns.values() if cells}
    for i, cells in columns.items():
        if cells and is_of_steps(cells[0].head_written, [cell.written for cell in cells], heads):
            for row in rows:
                row[i : i + 1] = [cell._replace(head=STEP) for cell in row[i : i + 1]]


def _mark_settings(rows: list[list[Cell]]) -> None:
    """Call the columns of a table "t = 1", "t = 2" whose first row begins with t and has numbers behind it."""
    label, *given = [(i, cell) for i, cell in enumerate(rows[0]) if cell.written] or enumerate(rows[0])
    letter = next((x for x in "htz" if is_head_of(x, label[1].text)), "")
    if letter and len(given) > 1 and all(_NUMBER.fullmatch(cell.text) for _, cell in given):
        for i, cell in given:
            rows[0][i] = cell._replace(head=letter, head_written=letter)
            for row in rows[1:]:
                head = f"{letter} = {cell.text}"
                row[i : i + 1] = [one._replace(head=head, head_written=head) for one in row[i : i + 1]]


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
