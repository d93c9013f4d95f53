"""The picture of an error: its parts by name, its axis in whole decades, few points drawn of many."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from flint import arb

from driftproof.enclosure.certificate import Certificate, Split
from driftproof.reports.certificate_figure import certificate_figure, draw_certificate

ERRORS = ((arb(0),), (arb("1e-9"),), (arb("-2e-7", "1e-7"),))
FOUND = Certificate((0.0, 1.0, 2.0), ((1.0,),) * 3, ERRORS, (17, 9, 6), 128, 3, ())
SPLIT = replace(FOUND, split=Split("rk4", ERRORS, ERRORS, ((arb(0),), (arb("1e-16"),), (arb("3e-16"),)), 2, 256))


def test_picture_is_written_whole(tmp_path):
    path = draw_certificate(SPLIT, "Error of <mine>", tmp_path / "error.svg")
    text = path.read_text(encoding="utf-8")
    ElementTree.fromstring(text)
    assert "Error of &lt;mine&gt;" in text
    assert all(word in text for word in (">error<", ">truncation<", ">rounding<", " at t = 2, 0 digits of it proved"))
    assert draw_certificate(SPLIT, "Error of <mine>", tmp_path / "again.svg").read_text(encoding="utf-8") == text


def test_bounds_are_two_lines_where_they_differ():
    lines = re.findall(r'class="path m0" d="M([^"]*)"', "".join(certificate_figure(FOUND, "x").plot.drawn))
    lower, upper = [[tuple(map(float, place.split())) for place in line.split("L")] for line in lines]
    assert [x for x, _ in lower] == [x for x, _ in upper]  # the first point, without an error, has no place
    assert len(upper) == 2
    assert upper[0] == lower[0]
    assert upper[1][1] < lower[1][1]  # higher up, in a picture


def test_of_many_points_the_extremes_are_drawn():
    many = 10_000
    rows = tuple((arb(2) ** (i % 7 - 60),) for i in range(many))
    found = replace(FOUND, t=tuple(map(float, range(many))), errors=rows, digits_at=(9,) * many)
    figure = certificate_figure(found, "x")
    assert len("".join(figure.plot.drawn)) < 50_000
    assert len(figure.data) == many + 1


def test_axis_reaches_no_deeper_than_forty_decades():
    found = replace(FOUND, errors=((arb(1),), (arb("1e-300"),), (arb(0),)))
    assert certificate_figure(found, "x").plot.y.scale.low == -40


def test_data_name_every_part():
    assert certificate_figure(SPLIT, "x").data[0] == ["t", "error", "truncation", "rounding", "digits"]
    assert certificate_figure(SPLIT, "x").data[2] == ["1", *["1.000000000e-9"] * 2, "1.000000000e-16", "9"]


def test_nothing_to_draw_and_other_names_are_refused(tmp_path):
    with pytest.raises(ValueError, match="no error to draw"):
        certificate_figure(replace(FOUND, errors=((arb(0),),) * 3), "x")
    with pytest.raises(ValueError, match=r"must be a \.svg file"):
        draw_certificate(FOUND, "x", tmp_path / "error.png")
