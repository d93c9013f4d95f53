"""A figure: a plot with heading, legend, note and numbers as part of a page; and plots as SVG files."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib.resources import files
from itertools import chain
from pathlib import Path

from driftproof.reports.page.markup import details, element, escaped, html_table
from driftproof.reports.page.plot import LEFT, Plot, place
from driftproof.support.files import atomic_write

# Units of the picture that a file has above its plots for two lines, below them for each row of the legend, and at the
# foot; in an entry of the legend, before its words, and at most for each of their characters in common fonts.
_HEADING, _LEGEND_ROW, _FOOT, _WORDS, _CHARACTER = 44, 20, 8, 36, 7
_SWATCHES = {
    "line": '<path class="{mark}" d="M1 7H27"/>',
    "dotted": '<path class="{mark} path" d="M1 7H27"/><path class="{mark} dots" d="M4 7h0M14 7h0M24 7h0"/>',
    "end": '<circle class="{mark}" cx="14" cy="7" r="5"/>',
}


@dataclass(frozen=True)
class Figure:
    """A plot with its words. `legend` pairs the class of a mark with its meaning; `data` begins with a header row."""

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
        """The figure element of a page: heading, legend, picture, note, and the numbers behind it as a table."""
        heading = element("h4", escaped(self.title), id=f"{self.identity}-heading")
        items = [
            element("li", element("svg", _swatch(mark), viewBox="0 0 28 14", aria_hidden="true"), escaped(words))
            for mark, words in self.legend
        ]
        return element(
            "figure",
            element("figcaption", heading, element("ul", *items, class_="legend")),
            self.plot.picture(self.identity, self.title, self.description),
            element("p", escaped(self.note), class_="note"),
            details(f"Numbers: {self.data_title}", html_table(self.data, self.data_title)),
            class_=self.kind,
            id=self.identity,
            aria_labelledby=f"{self.identity}-heading",
        )

    def write(self, path: Path, setting: str) -> Path:
        """Write the same picture as a file, with `setting` below its title, as `write_picture` does."""
        return write_picture(path, self.title, setting, self.description, [self.plot], self.legend)


def write_picture(
    path: Path, title: str, setting: str, description: str, plots: Sequence[Plot], legend: Sequence[tuple[str, str]]
) -> Path:
    """Write the plots, all of one size, two in a row, as an SVG file, whole or not at all; return its path.

    Title and `setting` stand above, the legend below, in light colours. Raises ValueError unless the name ends in .svg.
    """
    if path.suffix.lower() != ".svg":
        raise ValueError(f"{path}: a picture must be a .svg file")
    with atomic_write(path) as draft:
        content = _file(title, setting, description, plots, legend)
        Path(draft).write_text(f"{content}\n", encoding="utf-8", newline="\n")
    return path


def _file(title: str, setting: str, description: str, plots: Sequence[Plot], legend: Sequence[tuple[str, str]]) -> str:
    across, (one, high) = min(2, len(plots)), plots[0].size
    width, height = across * one, -(-len(plots) // across) * high
    longest = max((len(words) for _, words in legend), default=0)
    entries = max(1, min(2 * across, int((width - LEFT) // (_WORDS + _CHARACTER * longest))))
    below = height + _LEGEND_ROW * -(-len(legend) // entries) + _FOOT
    shown = [[*plot.axes(), *plot.drawn] for plot in plots]
    shown[1:] = ([_group(i % across * one, i // across * high, parts)] for i, parts in enumerate(shown[1:], 1))
    for i, (mark, words) in enumerate(legend):
        x, y = LEFT + i % entries * (width - LEFT) / entries, height + i // entries * _LEGEND_ROW
        shown.append([_group(x, y, [_swatch(mark), element("text", escaped(words), x=_WORDS, y=11)])])
    size = {"width": place(width), "height": place(below + _HEADING)}
    return element(
        "svg",
        element("title", escaped(title)),
        element("desc", escaped(description)),
        element("style", _style_of_pictures()),
        element("rect", y=-_HEADING, fill="#ffffff", **size),
        element("text", escaped(title), class_="name", x=LEFT, y=-24, style="font-size: 14px"),
        element("text", escaped(setting), x=LEFT, y=-7),
        *chain.from_iterable(shown),
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 {-_HEADING} {size['width']} {size['height']}",
        font_family="Segoe UI, Noto Sans, DejaVu Sans, sans-serif",
        **{name: place(length * Fraction(3, 2)) for name, length in (("width", width), ("height", below + _HEADING))},
    )


def _group(x: Fraction, y: Fraction, parts: list[str]) -> str:
    return element("g", *parts, transform=f"translate({place(x)} {place(y)})")


def _swatch(mark: str) -> str:
    """A sample of a mark, 28 units by 14; "line exact" is a line of class exact."""
    shape, _, name = mark.partition(" ")
    return _SWATCHES[shape].format(mark=escaped(name))


def style_sheet() -> str:
    """The style sheet of the page."""
    return files("driftproof.reports.page").joinpath("style.css").read_text(encoding="utf-8")


def _style_of_pictures() -> str:
    """The rules of the style sheet that are about pictures, with the names of colours replaced by the light colours."""
    sheet = style_sheet()
    colours = dict(re.findall(r"(--\w+): (#\w+);", sheet.partition("@media")[0]))
    rules = "\n".join(re.findall(r"^svg .*", sheet, re.MULTILINE))
    return re.sub(r"var\((--\w+)\)", lambda name: colours[name[1]], rules)
