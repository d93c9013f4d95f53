"""A figure: its picture with title, description and numbers in a page, and the same picture as a file of its own."""

import re
from fractions import Fraction as Q
from xml.etree import ElementTree

import pytest

from driftproof.reports.page.figure import Figure, write_picture
from driftproof.reports.page.plot import SQUARE, WIDE, Axis, Plot, Scale, frame, linear


@pytest.fixture(params=[WIDE, SQUARE], ids=["wide", "square"])
def figure(request):
    across, up = request.param
    plot = Plot(Axis(Scale(Q(0), Q(1), *across), "x", [Q(0), Q(1)]), Axis(Scale(Q(0), Q(1), *up), "y", [Q(0), Q(1)]))
    plot.line([(0, 0), (1, 1)], "samples path")
    legend = [("line exact path", "<exact>"), ("dotted samples", "computed"), ("end samples end", "end")]
    return Figure("id", "wide", "A & B", "what is seen", plot, legend, "a note", [["x"], ["1"]], "the numbers")


def written(figure, folder):
    return figure.write(folder / "figure.svg", "h = 1/4").read_text(encoding="utf-8")


def test_figure_of_a_page_has_heading_legend_picture_note_and_numbers(figure):
    root = ElementTree.fromstring(figure.markup())
    assert [child.tag for child in root] == ["figcaption", "svg", "p", "details"]
    assert root.get("aria-labelledby") == "id-heading"
    assert [item[-1].tail for item in root.iter("li")] == ["<exact>", "computed", "end"]
    assert {root.findtext("figcaption/h4"), root.findtext("svg/title")} == {"A & B"}
    assert [cell.text for cell in root.iter("th")] == ["x", "1"]


def test_file_holds_the_same_marks_in_light_colours_and_asks_for_nothing(figure, tmp_path):
    shown = written(figure, tmp_path)
    root = ElementTree.fromstring(shown)
    assert all(mark in shown for mark in figure.plot.drawn)
    assert [text.text for text in root if text.tag.endswith("text")][:2] == ["A & B", "h = 1/4"]
    assert "svg .samples.path { stroke: #a85400;" in shown
    assert not re.search(r"var\(|href|url\(|@import", shown)


def test_plots_and_legend_of_a_file_stand_in_rows(tmp_path):
    """Three plots of 168 by 132, two in a row, and five entries of a legend, four in a row: all worked out by hand."""
    across, up = frame(100, 60)
    plot = Plot(linear(Q(0), Q(1), "x", across), linear(Q(0), Q(1), "y", up))
    path = write_picture(tmp_path / "a.svg", "A", "B", "C", [plot] * 3, [("line a", name) for name in "vwxyz"])
    root = ElementTree.fromstring(shown := path.read_text(encoding="utf-8"))
    assert [root.get(name) for name in ("viewBox", "width", "height")] == ["0 -44 336 356", "504", "534"]
    places = ["168 0", "0 132", "52 264", "123 264", "194 264", "265 264", "52 284"]
    assert re.findall(r"translate\((.*?)\)", shown) == places
    texts = [(x.get("x"), x.get("y")) for x in root.iter() if x.text in ("A", "B", "z")]
    assert texts[-3:] == [("52", "-24"), ("52", "-7"), ("36", "11")]
    assert '<rect y="-44" fill="#ffffff" width="336" height="356">' in shown
    # The words begin at 36 and take 7 units a character: 8 of them leave room for three of 92 units, 33 for one.
    for longest, columns in (("v" * 8, ["52", "146.67", "241.33"]), ("v" * 15, ["52", "194"]), ("v" * 33, ["52"])):
        write_picture(path, "A", "B", "C", [plot] * 2, [("line a", name) for name in (longest, *"wxyz")])
        found = re.findall(r"translate\((\S+) (1\d\d)\)", path.read_text(encoding="utf-8"))
        assert [x for x, y in found if y == "132"] == columns
