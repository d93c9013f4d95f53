"""A figure of the page: its heading, a legend, the picture, a note, and the numbers behind it as a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from driftproof.reports.page.svg import Plot, element, text


@dataclass(frozen=True)
class Figure:
    """A plot with its words. `legend` pairs the class of a mark with what it stands for; `data` is headed by a row."""

    identity: str
    kind: str
    title: str
    description: str
    plot: Plot
    legend: Sequence[tuple[str, str]]
    note: str
    data: Sequence[Sequence[str]]
    data_title: str

    def markup(self) -> str:
        """The figure element."""
        heading = element("h4", text(self.title), id=f"{self.identity}-heading")
        return element(
            "figure",
            element("figcaption", heading, legend(self.legend)),
            self.plot.picture(self.identity, self.title, self.description),
            element("p", text(self.note), class_="note"),
            details(f"Numbers: {self.data_title}", table(self.data, self.data_title)),
            class_=self.kind,
            id=self.identity,
            aria_labelledby=f"{self.identity}-heading",
        )


SWATCHES = {
    "line": '<path class="{mark}" d="M1 7H27"/>',
    "dotted": '<path class="{mark} path" d="M1 7H27"/><path class="{mark} dots" d="M4 7h0M14 7h0M24 7h0"/>',
    "end": '<circle class="{mark}" cx="14" cy="7" r="5"/>',
}


def legend(marks: Sequence[tuple[str, str]]) -> str:
    """A list of marks with what they stand for; "line exact" is a line of class exact."""
    items = []
    for mark, words in marks:
        shape, _, name = mark.partition(" ")
        sample = element("svg", SWATCHES[shape].format(mark=text(name)), viewBox="0 0 28 14", aria_hidden="true")
        items.append(element("li", sample, text(words)))
    return element("ul", *items, class_="legend")


def table(rows: Sequence[Sequence[str]], title: str, class_: str | None = None) -> str:
    """A table with a header row, in a container that scrolls where it is too wide; its first column names the rows.

    An empty cell lets the one before it reach over its column.
    """
    header, *body = rows
    head = element("tr", *(element("th", text(cell), scope="col") for cell in header))
    return element(
        "div",
        element(
            "table",
            element("caption", text(title)),
            element("thead", head),
            element("tbody", *(element("tr", *_cells(row)) for row in body)),
        ),
        class_=f"scroll {class_}" if class_ else "scroll",
        tabindex=0,
        role="region",
        aria_label=title,
    )


def _cells(row: Sequence[str]) -> list[str]:
    first, *others = row
    cells = [element("th", text(first), scope="row")]
    for i, cell in enumerate(others):
        empty = next((k for k, later in enumerate(others[i + 1 :]) if later), len(others) - i - 1)
        if cell:
            cells.append(element("td", text(cell), colspan=empty + 1 if empty else None))
    return cells


def details(summary: str, content: str) -> str:
    """What is folded away until asked for."""
    return element("details", element("summary", text(summary)), content)
