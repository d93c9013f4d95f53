"""Tables of plain text and of printed output, whose columns only spaces part: | is put between them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from driftproof.texts.readers.source_text import Insertion, SourceText, joined

CELL = re.compile(r"\S+(?: \S+)*")  # a tab parts cells as two spaces do
_NUMBER = re.compile(r"[-+−]?(?:[0-9]+/[0-9]+|[0-9]*\.?[0-9]+)(?:[eE][-+]?[0-9]+|[×·]10\S+)? ?%?|-|[Nn]a[Nn]|inf")
_RULE = re.compile(r"[ \t]*[-=+]{2,}[-=+ \t]*\n?")


def with_columns_parted(text: SourceText) -> SourceText:
    """The text with | before each column of a table, and without the rule below its heads.

    A table has rows of two cells or more, at least half of them numbers, that two spaces or a tab part, and above them
    as many heads; a row may end early. The first column may have no head, or one on a line below the others, as pandas
    prints an index.
    """
    return joined(_pieces(text)) if re.search("[0-9](?: {2,}|\t)", text.text) else text


def _pieces(text: SourceText) -> Iterator[SourceText | Insertion]:
    lines = text.text.splitlines(keepends=True)
    cells = [[] if "|" in line else [*CELL.finditer(line)] for line in lines]
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))
    in_table, rules, heads, indices = set[int](), set[int](), -1, dict[int, str]()
    for i, row in enumerate(cells):
        numbers = sum(_NUMBER.fullmatch(cell[0]) is not None for cell in row)
        if len(row) < 2 or 2 * numbers < len(row):
            continue
        above = i - 1 - (i > 1 and _RULE.fullmatch(lines[i - 1]) is not None)
        if i - 1 not in in_table and above >= 0 and cells[above] and _NUMBER.fullmatch(cells[above][0][0]):
            heads = -1  # a row of numbers without heads
        elif i - 1 not in in_table:
            named = above > 0 and len(cells[above]) == 1 and _ends_alike(row[1:], cells[above - 1])
            heads, name = (above - 1, cells[above][0][0]) if named else (above, "")
            if heads >= 0 and (named or (len(row) > 2 and _ends_alike(row[1:], cells[heads]))):
                indices[heads] = name
                rules |= {above} - {heads}
        if heads >= 0 and (heads in indices or len(cells[heads]) == len(row) or _begins(row, cells[heads])):
            in_table |= {heads, i}
            rules |= {i - 1} - {heads, *in_table}
    for i, row in enumerate(cells):
        if i in in_table:
            yield from [Insertion(f"| {indices[i]} ", text.origin(starts[i]))] if i in indices else []
            for cell in row:
                yield Insertion("| ", text.origin(starts[i] + cell.start()))
                yield text[starts[i] + cell.start() : starts[i] + cell.end()]
                yield Insertion(" ", text.origin(starts[i] + cell.end() - 1))
            yield Insertion("\n", text.origin(starts[i + 1] - 1))
        elif i not in rules:
            yield text[starts[i] : starts[i + 1]]


def _ends_alike(row: list[re.Match[str]], heads: list[re.Match[str]]) -> bool:
    """True if there are as many heads, each of which ends where its cell does."""
    return [cell.end() for cell in row] == [head.end() for head in heads]


def _begins(row: list[re.Match[str]], heads: list[re.Match[str]]) -> bool:
    """True if the row has the first columns of the heads: each cell stands below its own, and before the next one."""
    own = zip(row, heads, strict=False)
    return len(row) < len(heads) and all(
        head.start() < cell.end() and cell.start() < after.start()
        for (cell, head), after in zip(own, heads[1:], strict=False)
    )
