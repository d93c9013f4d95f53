"""Figures of error against work: legible where runs blow up, titles broken, words where there is nothing to draw."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from driftproof.numeric.reference_errors import Size
from driftproof.numeric.work_precision.curves import Curve, Point
from driftproof.reports.work_precision import figure as drawing
from driftproof.reports.work_precision.figure import draw_study
from driftproof.reports.work_precision.study import Measured, measure
from tests.reports.studies import study, unheard


def test_figure_of_runs_that_blow_up_keeps_the_others_legible(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figures: list[Any] = []
    monkeypatch.setattr(drawing, "save_picture", lambda figure, path: figures.append(figure))

    def points(*errors: tuple[int, float]) -> list[Point]:
        return [Point(str(n), n, {"state": Size(e, e)}, scale=1.0) for n, e in errors]

    blown = Curve("rk4", "", 4, points((8, 1e90), (64, 1e60)))
    good = Curve("gauss2", "", 4, points((512, 1e-3), (1024, 1e-5)))
    asked = study(problem="dahlquist_1e3")
    for curves_of in ([blown, good], [blown]):
        draw_study(asked, Measured({curve.key: curve for curve in curves_of}), "state", tmp_path)
    (both,), (lost,) = (figure.axes for figure in figures)
    assert both.get_ylim()[1] < 1e4
    assert (both.get_xlim(), list(both.texts)) == ((256, 2048), [])
    assert [text.get_text() for text in lost.texts] == ["no run to show here"]


def test_title_of_one_panel_is_broken_where_it_is_longer(tmp_path: Path) -> None:
    asked = study(problem="robertson")
    shown = draw_study(asked, Measured({"rk4": Curve("rk4", "", 4)}), "state", tmp_path).read_text(encoding="utf-8")
    assert f"<!-- {asked.problem.title} -->" not in shown
    assert all(len(line) < 60 for line in re.findall("<!-- (.*) -->", shown))


def test_figure_has_a_panel_for_every_cost_and_a_legend_of_all_curves(tmp_path: Path) -> None:
    asked = study("rk4", "heun3", "gauss2")
    measured = measure(asked, None, unheard)
    drawn = draw_study(asked, measured, "state", tmp_path)
    ElementTree.parse(drawn)
    before, shown = drawn.read_bytes(), drawn.read_text(encoding="utf-8")
    for words in ("evaluations of f", "seconds, Python", "seconds a state, ensemble", "rk4", "heun3", "gauss2"):
        assert f"<!-- {words} -->" in shown
    assert "<!-- rounding the exact result -->" in shown
    assert "<!-- seconds, compiled -->" not in shown
    assert draw_study(asked, measured, "state", tmp_path).read_bytes() == before
