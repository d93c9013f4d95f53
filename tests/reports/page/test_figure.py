"""A figure: its picture with title, description and numbers in a page, and the same picture as a file of its own."""

from __future__ import annotations

import re
from fractions import Fraction as Q
from pathlib import Path
from xml.etree import ElementTree

import pytest

from driftproof.reports.page.figure import Figure
from driftproof.reports.page.plot import SQUARE, WIDE, Axis, Plot, Scale


@pytest.fixture(params=[WIDE, SQUARE], ids=["wide", "square"])
def figure(request: pytest.FixtureRequest) -> Figure:
    across, up = request.param
    plot = Plot(Axis(Scale(Q(0), Q(1), *across), "x", [Q(0), Q(1)]), Axis(Scale(Q(0), Q(1), *up), "y", [Q(0), Q(1)]))
    plot.line([(0, 0), (1, 1)], "samples path")
    legend = [("line exact path", "<exact>"), ("dotted samples", "computed"), ("end samples end", "end")]
    return Figure("id", "wide", "A & B", "what is seen", plot, legend, "a note", [["x"], ["1"]], "the numbers")


def written(figure: Figure, folder: Path) -> str:
    return figure.write(folder / "figure.svg", "h = 1/4").read_text(encoding="utf-8")


def test_figure_of_a_page_has_heading_legend_picture_note_and_numbers(figure: Figure) -> None:
    root = ElementTree.fromstring(figure.markup())
    assert [child.tag for child in root] == ["figcaption", "svg", "p", "details"]
    assert root.get("aria-labelledby") == "id-heading"
    assert [item[-1].tail for item in root.iter("li")] == ["<exact>", "computed", "end"]
    assert {root.findtext("figcaption/h4"), root.findtext("svg/title")} == {"A & B"}
    assert [cell.text for cell in root.iter("th")] == ["x", "1"]


def test_file_holds_the_same_marks_in_light_colours_and_asks_for_nothing(figure: Figure, tmp_path: Path) -> None:
    shown = written(figure, tmp_path)
    root = ElementTree.fromstring(shown)
    assert all(mark in shown for mark in figure.plot.drawn)
    assert [text.text for text in root if text.tag.endswith("text")][:2] == ["A & B", "h = 1/4"]
    assert "svg .samples.path { stroke: #a85400;" in shown
    assert not re.search(r"var\(|href|url\(|@import", shown)


def test_file_is_as_large_as_what_stands_in_it(figure: Figure, tmp_path: Path) -> None:
    root = ElementTree.fromstring(written(figure, tmp_path))
    _, top, width, height = map(float, str(root.get("viewBox")).split())
    assert (float(root.get("width", 0)), float(root.get("height", 0))) == (1.5 * width, 1.5 * height)
    rows = [float(y) for y in re.findall(r"translate\(\S+ (\S+)\)", written(figure, tmp_path))]
    assert len(rows) == 3
    assert top + height >= rows[-1] + 14  # as high as a swatch
