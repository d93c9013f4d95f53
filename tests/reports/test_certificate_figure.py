"""The picture of an error: its parts by name, its axis in whole decades, few points drawn of many."""

import re
from dataclasses import replace
from math import log10
from xml.etree import ElementTree

import pytest
from flint import arb

from driftproof.enclosure.certificate import Certificate, Split
from driftproof.reports.certificate_figure import certificate_figure, draw_certificate
from tests.looping import exactly

ERRORS = ((arb(0),), (arb("1e-9"),), (arb("-2e-7", "1e-7"),))
FOUND = Certificate((0.0, 1.0, 2.0), ((1.0,),) * 3, ERRORS, (17, 9, 6), 128, 3, ())
SPLIT = replace(FOUND, split=Split("rk4", ERRORS, ERRORS, ((arb(0),), (arb("1e-16"),), (arb("3e-16"),)), 2, 256))


def found_with(sizes):
    rows = tuple((x,) for x in sizes)
    return replace(FOUND, t=tuple(map(float, range(len(rows)))), errors=rows, digits_at=(9,) * len(rows))


def places_drawn(figure):
    """The places of each line, in the order in which they are drawn."""
    lines = re.findall(r'class="path m0" d="M([^"]*)"', "".join(figure.plot.drawn))
    return [[tuple(map(float, place.split())) for place in line.split("L")] for line in lines]


def test_picture_is_written_whole(tmp_path):
    path = draw_certificate(SPLIT, "Error of <mine>", tmp_path / "error.svg")
    text = path.read_text(encoding="utf-8")
    ElementTree.fromstring(text)
    assert "Error of &lt;mine&gt;" in text
    assert all(word in text for word in (">error<", ">truncation<", ">rounding<", " at t = 2, 0 digits of it proved"))
    assert draw_certificate(SPLIT, "Error of <mine>", tmp_path / "again.svg").read_text(encoding="utf-8") == text


def test_bounds_are_two_lines_where_they_differ():
    lower, upper = places_drawn(certificate_figure(FOUND, "x"))
    assert [x for x, _ in lower] == [x for x, _ in upper]  # the first point, without an error, has no place
    assert len(upper) == 2
    assert upper[0] == lower[0]
    assert upper[1][1] < lower[1][1]  # higher up, in a picture


def test_of_many_points_the_extremes_of_each_column_of_pixels_are_drawn():
    """2⁻⁶⁰ and 2⁻⁵⁴ of the 28 or 29 points in each of 346 columns, and the last point, 2⁻⁵⁷, at the edge."""
    many = 10_000
    found = found_with([arb(2) ** (i % 7 - 60) for i in range(many)])
    figure = certificate_figure(replace(found, t=tuple(float(i + many) for i in range(many))), "x")
    for line in exactly(2, places_drawn(figure)):
        assert (len(line), len({y for _, y in line[:-1]}), line[-1][0]) == (2 * 346 + 1, 2, 398)
        assert line[:-1] == sorted(line[:-1])
    assert len(figure.data) == many + 1


@pytest.mark.parametrize(
    ("sizes", "marks"),
    [
        (["0", "1e-9", "0"], {"dots m0": [1]}),
        (["1e-9"] * 2, {"path m0": [2, 2], "dots m0": [2]}),
        (["1e-9"] * 60, {"path m0": [60, 60], "dots m0": [60]}),
        (["1e-9"] * 61, {"path m0": [61, 61]}),
    ],
)
def test_a_few_points_are_dots_and_several_are_lines(sizes, marks):
    nothing, found = ((arb(0),),) * len(sizes), found_with(map(arb, sizes))
    for split in (None, Split("rk4", nothing, nothing, nothing, 2, 256)):
        seen = {}
        for path in certificate_figure(replace(found, split=split), "x").plot.drawn:
            seen.setdefault(re.search('class="(.*?)"', path)[1], []).append(len(re.findall("[ML]", path)))
        assert seen == marks


# The largest and the smallest error, and the exponents of ten at the ends of the axis.
ENDS = [("1", "1e-300", -40, 0), ("0.5", "2e-39", -39, 0), ("2e-7", "2e-7", -8, -6), ("3e-8", "2e-10", -10, -7)]


@pytest.mark.parametrize(("largest", "smallest", "low", "high"), ENDS)
def test_axis_ends_at_whole_decades_of_which_there_are_from_two_to_forty(largest, smallest, low, high):
    figure = certificate_figure(found_with(map(arb, (largest, smallest, "0"))), "x")
    assert (figure.plot.y.scale.low, figure.plot.y.scale.high) == (low, high)
    bottom = 26 + 228  # where what is smaller still is drawn
    assert [line[1][1] for line in places_drawn(figure)] == [
        pytest.approx(bottom - 228 * max(0, (log10(float(smallest)) - low) / (high - low)), abs=0.01)
    ] * 2


@pytest.mark.parametrize(("radius", "digits"), [(2.0**-21, 6), (2.0**-35, 10), (0.0, 12)])
def test_as_many_digits_are_proved_as_the_radius_leaves_but_twelve_at_most(radius, digits, tmp_path):
    """2^-21 is less than 10^-6 and more than 10^-7, 2^-35 less than 10^-10 and more than 10^-11."""
    path = draw_certificate(found_with([arb(0), arb(1, radius)]), "x", tmp_path / "error.svg")
    assert f"largest 1.000 at t = 1, {digits} digits of it proved" in path.read_text(encoding="utf-8")


def test_the_error_of_a_point_is_that_of_its_largest_component():
    figure = certificate_figure(
        replace(FOUND, errors=((arb(2), arb(-8)), (arb(-1), arb("0.5")), (arb(0), arb(4)))), "x"
    )
    assert [row[1][:5] for row in figure.data[1:]] == ["8.000", "1.000", "4.000"]
    heights = [254 - 114 * (1 + log10(size)) for size in (8, 1, 4)]  # of 228 for two decades from 0.1 on
    assert places_drawn(figure)[0] == [
        (x, pytest.approx(y, abs=0.01)) for x, y in zip((52, 225, 398), heights, strict=True)
    ]


def test_data_name_every_part():
    legend = [("line path m0", "error"), ("line path m1", "truncation"), ("line path m2", "rounding")]
    assert certificate_figure(SPLIT, "x").legend == legend
    assert certificate_figure(SPLIT, "x").data[0] == ["t", "error", "truncation", "rounding", "digits"]
    assert certificate_figure(SPLIT, "x").data[2] == ["1", *["1.000000000e-9"] * 2, "1.000000000e-16", "9"]


def test_nothing_to_draw_and_other_names_are_refused(tmp_path):
    with pytest.raises(ValueError, match="no error to draw"):
        certificate_figure(replace(FOUND, errors=((arb(0),),) * 3), "x")
    with pytest.raises(ValueError, match=r"must be a \.svg file"):
        draw_certificate(FOUND, "x", tmp_path / "error.png")
