"""Figures of error against work: legible where runs blow up, words where there is nothing to draw, a legend for all."""

import re
from math import degrees, log10
from xml.etree import ElementTree

import pytest

from driftproof.numeric.reference_errors import ENERGY, PHASE, STATE, Size, U
from driftproof.numeric.work_precision.curves import Curve, Point
from driftproof.numeric.work_precision.timing import Timing
from driftproof.reports.page.plot import WIDE, Scale
from driftproof.reports.work_precision.figure import draw_study
from driftproof.reports.work_precision.study import Measured, measure
from tests.looping import exactly
from tests.reports.studies import study, unheard

SVG = "{http://www.w3.org/2000/svg}"


def points(*errors):
    return [Point(str(n), n, {"state": Size(e, 2 * e)}, scale=1.0) for n, e in errors]


def texts(path):
    return [text.text or "" for text in ElementTree.parse(path).iter(f"{SVG}text")]


def places(path, class_):
    """Of the lines of that class, the samples in the legend left out."""
    found = [x.get("d", "") for x in ElementTree.parse(path).iter(f"{SVG}path") if x.get("class") == class_]
    return [(float(x), float(y)) for d in found for x, y in re.findall(r"[ML]([\d.]+) ([\d.]+)", d) if "H" not in d]


def test_runs_that_blow_up_keep_the_others_legible(tmp_path):
    blown = Curve("rk4", "", 4, points((8, 1e90), (64, 1e60)))
    good = Curve("gauss2", "", 4, points((512, 1e-3), (1024, 1e-5)))
    asked = study(problem="dahlquist_1e3")
    both = draw_study(asked, Measured({"rk4": blown, "gauss2": good}), "state", tmp_path)
    assert not {"10⁶⁰", "10⁹⁰", "no run can be shown here", "rounding of the exact result"} & set(texts(both))
    # From 10² to 10⁴ evaluations, and from 10⁻⁵ to 1000 times the size of the solution, 1.
    x, y = Scale(2, 4, *WIDE[0]), Scale(-5, 3, *WIDE[1])
    for class_, size in (("path m1", 1), ("path m1 thin", 2)):
        wanted = [(float(x(log10(n))), float(y(log10(size * e)))) for n, e in ((512, 1e-3), (1024, 1e-5))]
        for drawn, place in exactly(2, zip(places(both, class_), wanted, strict=True)):
            assert drawn == pytest.approx(place, abs=0.006)  # hundredths, rounded
    assert places(both, "path m0") == []
    lost = draw_study(asked, Measured({"rk4": blown}), "state", tmp_path)
    assert "no run can be shown here" in texts(lost)
    nothing = draw_study(asked, Measured({"rk4": Curve("rk4", "", 4, [])}), "state", tmp_path)
    ticks = {x.text: x.get("y") for x in ElementTree.parse(nothing).iter(f"{SVG}text") if x.get("class") == "tick y"}
    assert (ticks["10⁻⁵"], ticks["1"]) == (str(26 + 228 * 5 / 16), "26"), "from 10⁻¹⁶ to 1"


def test_axes_reach_from_the_floor_to_a_thousand_times_the_size_of_the_solution(tmp_path):
    """Of the oscillator state and energy have the size 1, and the phase half a turn."""
    for quantity, rounding, low, high in ((STATE, U, -16, 3), (ENERGY, U, -16, 3), (PHASE, degrees(U), -15, 6)):
        blown = Curve("rk4", "", 4, [Point("8", 8, {quantity: Size(1e60, 1e90)}, scale=1.0)])
        drawn = draw_study(study(), Measured({"rk4": blown}), quantity, tmp_path)
        at = float(Scale(low, high, *WIDE[1])(log10(rounding)))
        assert [y for _, y in places(drawn, "floor")] == pytest.approx([at, at], abs=0.006)


def test_figure_has_a_panel_for_every_cost_and_a_legend_of_all_curves(tmp_path):
    asked = study("rk4", "heun3", "gauss2")
    measured = measure(asked, None, unheard)
    drawn = draw_study(asked, measured, "state", tmp_path)
    shown, before = texts(drawn), drawn.read_bytes()
    named = ("evaluations of f", "seconds, Python", "seconds per state, ensemble")
    assert {*named, "rounding of the exact result", asked.problem.title} <= set(shown)
    assert {curve.title for curve in measured.curves.values()} <= set(shown)
    assert "seconds, compiled" not in shown
    assert draw_study(asked, measured, "state", tmp_path).read_bytes() == before
    size = ElementTree.parse(drawn).getroot().get("viewBox", "").split()
    assert float(size[2]) == 2 * float(WIDE[0][1] + 16)  # two in a row, and a third below


def test_the_ninth_curve_is_the_first_again_broader_and_many_have_no_thin_lines(tmp_path):
    curves = {str(i): Curve(str(i), "", 4, points((8 << i, 1e-3), (16 << i, 1e-5))) for i in range(9)}
    drawn = draw_study(study(problem="dahlquist_1e3"), Measured(curves), "state", tmp_path)
    assert [len(places(drawn, f"path m0{again}")) for again in ("", " again", " thin")] == [2, 2, 0]
    assert "thin: largest on the way" not in texts(drawn)


def test_a_few_curves_that_are_also_timed_compiled_have_no_panel_of_their_own(tmp_path):
    curves = {key: Curve(key, "", 4, points((8, 1e-3), (16, 1e-5))) for key in "abc"}
    for more, shown in (((), False), (("b",), True)):
        keys = [*(f"{key} | compiled | 8" for key in "abc"), *(f"{key} | python | 8" for key in ("a", *more))]
        measured = Measured(curves, {key: Timing(samples=[1e-3]) for key in keys})
        drawn = texts(draw_study(study(problem="dahlquist_1e3"), measured, "state", tmp_path))
        assert ("seconds, Python" in drawn, "seconds, compiled" in drawn) == (shown, True)
