"""Problems on the page: an own one with an own method, a linear one with proved limits, the stiff ones in a table."""

import re
from dataclasses import replace
from fractions import Fraction

import pytest

from driftproof import METHODS, Scene, report, work_precision
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.reports import problem_page as page
from driftproof.reports.user_problem import problem_given
from tests.looping import exactly
from tests.reports.page.test_document import Read

PENDULUM = """
title = "A pendulum"
rates = ["y1", "-g * sin(y0)"]
start = ["1/2", "0"]
end = "1"
parameters.g = "9.8"
"""
RALSTON = 'family = "runge_kutta"\ntitle = "Mine"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n'


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(page, "FINEST", 100)
    monkeypatch.setattr(page, "FINEST_IMPLICIT", 20)


def cells(html):
    return [re.findall("<t[dh][^>]*>(.*?)</t[dh]>", row) for row in re.findall("<tr>(.*?)</tr>", html)]


def test_own_problem_and_own_method_are_shown_by_their_titles(tmp_path):
    (tmp_path / "pendulum.toml").write_text(PENDULUM)
    (tmp_path / "mine.toml").write_text(RALSTON)
    shown = report(tmp_path / "pendulum.toml", methods=["rk4", tmp_path / "mine.toml"]).html
    assert Read(shown).wrong == []
    assert "<p>What each method computes, next to the solution, which is exact or enclosed.</p>" in shown
    assert re.search("<section[^<>]*><h2>A pendulum</h2>", shown)
    assert "y0′ = y1, y1′ = -g * sin(y0), y0(0) = 1/2, y1(0) = 0, g = 49/5; to t = 1;" in shown
    assert re.findall("<h3>(.*?)</h3>", shown) == ["Work", "Stability"]
    rows = {row[0]: row[1:] for row in cells(shown) if len(row) == 2}
    assert "<caption>Observed: with N, 2N" in shown
    assert rows["Method"] == ["Step sizes that it can take"], "nothing is expected of it, so no column says so"
    assert rows.keys() == {"Method", "Classical RK4", "Mine"}
    assert re.fullmatch(r"from \d+ steps? on", rows["Mine"][0])
    orders = next(row for row in cells(shown) if row[0] == "Mine" and row[1] == "2")
    assert orders[2].startswith(("1.9", "2.0"))
    assert ["Method", "steps", "evaluations of f", "error", "largest on the way"] in cells(shown)
    assert "Steps are equal, and their fewest number is among those of the figure." in shown
    wanted = report(tmp_path / "pendulum.toml", methods="rk4,forward_euler", error="1e-5,1e-1")
    told = work_precision(tmp_path / "pendulum.toml", "rk4,forward_euler", error="1e-5,1e-1", time_limit=1e-4)
    for line in exactly(3, [x for x in str(told).splitlines() if x.startswith("For an error of at most")]):
        assert f"<p>{line}</p>" in wanted.html


def test_kinks_are_told_of_and_signs_are_written_as_such():
    block = {"rates": "x' = v, v' = -x - sign(v)/4", "start": [1, 0], "end": 4}
    shown = report(block, methods=["rk4"]).html
    assert "v′ = -x - sign(v) / 4" in shown
    assert '<p class="note">f has kinks or jumps at t = 3.14159: a method keeps its order only if' in shown
    assert "kinks" not in report("harmonic_oscillator", methods=["rk4"]).html


@pytest.mark.slow
def test_a_scene_on_a_problem_shows_its_readouts_and_its_table_at_its_step(tmp_path):
    """Of y' = -y a step of Euler's method leaves 3/4; two leave 9/16. A run that overflows has its reason."""
    euler = Scene("own", "forward_euler", Fraction(1, 4), Fraction(1, 2), readouts=("final_state", "evaluations"))
    problem = problem_given({"rates": {"x": "-x"}, "start": [1], "end": "1/2"})
    shown = report(replace(euler, problem=problem, methods=("forward_euler", "heun2"), panels=("table",))).html
    assert {("Numerical (x)", "(0.562500)"), ("Evaluations of f", "2")} < {tuple(row) for row in cells(shown)}
    assert next(row[-1] for row in cells(shown) if row[0].startswith("Heun")) == "4"
    problem = problem_given({"rates": ["-800 * y^2"], "start": [900], "end": "1/2"})
    assert "no longer finite" in report(replace(euler, problem=problem, h=Fraction(1, 20))).html


def test_linear_problem_has_its_proved_limits():
    part = page.problem_part(PROBLEMS["stiff_oscillator"], [METHODS["rk4"], METHODS["backward_euler"]])
    rows = {row[0]: row[1:] for row in cells(part.content("p")) if len(row) == 3}
    assert rows["Classical RK4"][0] == "h ≤ √2/500 = 0.0028284271..."
    assert rows["Backward Euler"][0] == "every h &gt; 0"
    assert "<caption>Proved: the step sizes h" in part.content("p")


def test_a_method_that_does_not_apply_has_the_reason_and_no_points():
    shown = report(PROBLEMS["dahlquist_1"], methods=["bdf2", "velocity_verlet", "ars222", "rk4"]).html
    why = "a second-order system has as many velocities as positions, not 1 rates"
    rows = [row for row in cells(shown) if row[0] == "Velocity Verlet"]
    assert [row[1] for row in exactly(2, rows)] == ["does not apply", f"does not apply: {why}"]
    assert f'<p class="note">Velocity Verlet: {why}</p>' in shown
    assert len([row for row in cells(shown) if row[1].startswith("does not apply: ars222 is an IMEX")]) == 1
    assert "First values of BDF, 2 steps: steps of radau_iia2" in shown
    assert "Jacobian matrices are computed by formulas" in shown
    assert "Jacobian" not in report(PROBLEMS["dahlquist_1"], methods="rk4").html
    assert ": none. Classical RK4: from " in shown


def test_stiff_problems_stand_in_a_table_with_verdicts(monkeypatch):
    few = {key: PROBLEMS[key] for key in ("dahlquist_1e3", "kepler", "prothero_robinson")}
    monkeypatch.setattr(page, "PROBLEMS", few)
    head, *rows = cells(report("stiff").html)
    assert head == ["Problem", "Classical RK4", "Backward Euler", "Trapezoidal rule", "Radau IIA, two stages"]
    linear, other = exactly(2, rows)
    assert linear[1:3] == ["h ≤ 0.0027852935...", "every h &gt; 0"]
    assert other[1:3] == ["not with 1048576 steps, stable from 3590286 on", "from 1 step on"]
    assert cells(report("stiff", methods="backward Euler").html)[0] == ["Problem", "Backward Euler"]
