"""The panel of work: numbers of steps are halved and doubled, and errors are measured from the scene's own start."""

from dataclasses import replace
from fractions import Fraction as Q
from itertools import pairwise
from math import cos, hypot, sin

import pytest

from driftproof.numeric.reference_errors import STATE, Size
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import Scene
from driftproof.numeric.work_precision.curves import Curve, Point
from driftproof.reports.page.work import halved_and_doubled, work_curves, work_figure, work_table


def test_numbers_of_steps_hold_the_scene_and_only_halve_and_doubles():
    assert halved_and_doubled(40) == [5, 10, 20, 40, 80, 160, 320, 640, 1280, 2560, 5120]
    assert [halved_and_doubled(n)[0] for n in (3, 7, 11)] == [3, 7, 11]
    assert halved_and_doubled(10**6)[-1] == 10**6
    assert all(b == 2 * a for a, b in pairwise(halved_and_doubled(96)))


def test_work_is_measured_from_the_scene_s_own_start():
    """The error at the scene's own number of steps is the distance from the exact state that its start leads to."""
    scene = Scene("s", "rk4", Q(1, 2), Q(3), (Q(1, 3), Q(-2)), readouts=("final_state",))
    (curve,) = work_curves(scene)
    (own,) = [point for point in curve.points if point.steps == scene.steps]
    q, v = run_method(scene, "rk4")["final_state"]
    exact = (cos(3) / 3 - 2 * sin(3), -2 * cos(3) - sin(3) / 3)
    assert own.evaluations == 24
    assert own.error == pytest.approx(hypot(q - exact[0], v - exact[1]), rel=1e-9)


def test_work_of_a_scene_that_runs_backwards_or_nowhere_is_refused():
    for h, t in ((Q(-1), Q(-3)), (Q(1), Q(0))):
        with pytest.raises(ValueError, match="comparing work needs t > 0"):
            work_curves(Scene("back", "rk4", h, t, panels=("work_precision",)))
    assert work_curves(Scene("short", "rk4", Q(1, 4), Q(1, 2), panels=("work_precision",)))[0].points[0].steps == 2


def test_the_fewest_evaluations_for_each_goal_and_the_first_and_last_error_are_told():
    seen = ((8, 1.2e-3), (16, 1e-3), (24, 1.2e-6), (32, 5e-7))
    found = [Curve("c", "C", 0, [Point(str(n), 4 * n, {STATE: Size(x, x)}, steps=n) for n, x in seen])]
    assert "<td>64 *</td><td>128 *</td>" in work_table(found)
    dearer = replace(found[0], key="d", points=[replace(p, evaluations=2 * p.evaluations) for p in found[0].points])
    assert "<td>64 *</td><td>128 *</td>" in (both := work_table([*found, dearer]))
    assert "<td>128</td><td>256</td>" in both
    assert "<td>3</td>" in work_table(found, {"c": 3})
    figure = work_figure(found, "id", Q(1), 16)
    assert figure.description.endswith("C: from 0.001 at 32 to 5.0e-7 at 128.")
    drawn = [figure.markup().count(f'class="{name} ') for name in ("path", "dots", "own")]
    assert drawn == [2, 1, 1]  # the path also in the legend
    among = replace(found[0], points=[*found[0].points, replace(found[0].points[0], between=True, steps=17)])
    assert work_figure([among], "id", Q(1), 16) == figure  # without the runs that a goal is looked for with


def test_errors_far_beyond_the_solution_are_counted_and_do_not_stretch_the_axis():
    seen = ((8, 1e150), (16, 1e40), (32, 1e-3), (64, 1e-5))
    points = [Point(str(n), n, {STATE: Size(x, x)}, scale=1.0, steps=n) for n, x in seen]
    figure = work_figure([Curve("c", "C", 0, points)], "id", Q(1))
    assert figure.description.endswith("C: from 0.001 at 32 to 1.0e-5 at 64. Above the figure, not stable: 2 points.")
    assert figure.plot.y.scale.high < 2
    assert len(figure.data) == 5
    assert "not settled (" in work_table(
        [Curve("c", "C", 2, [*points[2:], Point("128", 128, {STATE: Size(1e-6, 1e-6)}, scale=1.0, steps=128)])]
    )


def test_an_order_below_the_claim_is_said():
    points = [Point(str(n), n, {STATE: Size(1 / n, 1 / n)}, scale=1.0, steps=n) for n in (8, 16, 32, 64)]
    for claimed, said in ((2, "1.000 (1.000 to 1.000), below the claimed order 2"), (1, "1.000 (1.000 to 1.000)<")):
        assert said in work_table([Curve("c", "C", claimed, points)])


def test_methods_without_any_error_are_told_of():
    found = [Curve("a", "A", 2, refused="has no steps"), Curve("b", "B", 0, [Point("8", 8, remark="lost", steps=8)])]
    shown, figure = work_table(found), work_figure(found, "id", Q(1))
    assert '<td colspan="4">does not apply</td>' in shown
    assert '<p class="note">A: has no steps</p>' in shown
    assert figure.legend == []
    assert "<td>–</td><td>–</td><td>not with 8 steps</td><td>not with 8 steps</td>" in shown
    assert figure.description.endswith("A: none. B: none.")
    assert figure.data[1:] == [["B", "8", "8", "lost"]]
