"""Figures of runs: every sample where it belongs, long runs thinned and said to be, and the same pictures as files."""

import re
from fractions import Fraction as Q
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.numeric.run import run_method, times_of_steps
from driftproof.numeric.scenes import PRESETS, Scene
from driftproof.reports.page import trajectory as drawing
from driftproof.reports.page.document import document


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=400), st.integers(1, 20))
def test_thinned_samples_keep_the_extremes_of_every_column(values, columns):
    array = np.array(values)
    kept = drawing.downsample(array, columns)
    assert len(kept) <= 4 * columns
    assert (kept[0], kept[-1]) == (0, len(values) - 1)
    assert list(kept) == sorted(set(kept))
    if len(values) > 4 * columns:
        edges = np.linspace(0, len(values), columns + 1).astype(int)
        for start, end in pairwise(edges):
            inside = array[[i for i in kept if start <= i < end]]
            assert (inside.min(), inside.max()) == (array[start:end].min(), array[start:end].max())


def test_moved_keeps_the_ends_and_one_sample_for_each_square_entered():
    states = np.array([[0.1, 0.1], [0.2, 0.2], [1.1, 0.2], [1.2, 0.3], [0.1, 0.1], [0.1, 0.2]])
    assert list(drawing.one_per_square(states, 1.0)) == [0, 2, 4, 5]
    assert list(drawing.one_per_square(states, 10.0)) == [0, 5]


@given(st.integers(1, 10**5), st.integers(1, 300))
def test_spread_has_at_most_so_many_and_both_ends(count, most):
    kept = drawing.evenly_spaced(count, most)
    assert len(kept) <= most + 1
    assert (kept[0], kept[-1]) == (0, count - 1)


def run_of(key, h, t, start=(Q(1), Q(0))):
    scene = Scene("s", key, h, t, start, readouts=("trajectory",))
    return drawing.SampledRun(scene, key, *run_method(scene, key)["trajectory"], "id")


def marks(figure, class_):
    """The places of a path in the plot of a figure."""
    (d,) = re.findall(rf'<path class="{class_}" d="([^"]*)"', "".join(figure.plot.drawn))
    return [(Q(x), Q(y)) for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", d)]


def test_every_sample_of_a_short_run_has_a_dot_and_a_place_on_the_line():
    run = run_of("rk4", Q(1, 8), Q(10))
    for figure, name in ((drawing.position(run), "q"), (drawing.phase_plane(run), "v")):
        assert figure.data[0] == ["step", "t", f"computed {name}", f"exact {name}"]
        line = marks(figure, "samples path")
        assert len(line) == 81
        assert line == marks(figure, "samples dots")
        assert len(figure.data) == 82


def test_exact_circle_goes_through_the_start():
    scene = Scene("s", "rk4", Q(1, 8), Q(1), (Q(3, 5), Q(-4, 5)), readouts=("trajectory",))
    plot = drawing.phase_plane(drawing.SampledRun(scene, "rk4", *run_method(scene, "rk4")["trajectory"], "id")).plot
    ((x, y, radius),) = re.findall(r'class="exact path" cx="(.*?)" cy="(.*?)" r="(.*?)"', "".join(plot.drawn))
    start = Q(x) + plot.x.scale.per_unit * Q(3, 5), Q(y) + plot.x.scale.per_unit * Q(4, 5)
    assert (plot.x.scale(Q(3, 5)), plot.y.scale(Q(-4, 5))) == start
    assert Q(radius) == round(plot.x.scale.per_unit, 2)


@pytest.mark.parametrize(
    ("h", "steps", "class_", "said"),
    [(Q(1, 100), 3000, "samples path", "joined"), (Q(1, 2), 20_000, "samples specks", "not joined")],
)
def test_long_run_is_drawn_with_bounded_marks_and_said_to_be_thinned(h, steps, class_, said):
    run = run_of("symplectic_euler", h, steps * h)
    shown = drawing.phase_plane(run)
    assert drawing.MOST_DOTS < len(marks(shown, class_)) <= drawing.MOST_MARKS + 1
    assert said in shown.description
    larger = drawing.phase_plane(run_of("symplectic_euler", h, steps * h, (Q(1000), Q(0))))
    assert len(marks(larger, class_)) == len(marks(shown, class_)), "at any scale"
    over_time = drawing.position(run)
    assert "samples dots" not in "".join(over_time.plot.drawn)
    assert "extremes" in over_time.note
    assert len(over_time.data) <= drawing.MOST_ROWS + 2


def test_so_many_samples_are_dots_marks_and_rows_and_no_more():
    scene, there = Scene("s", "rk4", Q(1), Q(1), readouts=("trajectory",)), np.array([[1.0, 0.0], [-1.0, 0.0]])
    run_with = lambda count: drawing.SampledRun(scene, "rk4", np.arange(count), np.resize(there, (count, 2)), "id")
    assert [run_with(count).thin for count in (400, 401)] == [False, True]
    assert [len(run_with(count).data(0)) for count in (200, 201)] == [1 + 200, 1 + 101]
    for count, said in ((4000, "4000 computed samples, joined"), (4001, "Small dots: 2001 of 4001 computed samples")):
        assert said in drawing.phase_plane(run_with(count)).description
    for t, places in ((Q(1, 2), 24), (Q(2), 48)):
        assert len(marks(drawing.position(run_of("rk4", t, t)), "exact path")) == places + 1
    states = np.array([[1.0, 0.0], [2.0, 7.0]])  # of which the position is up to 2 and the velocity up to 7
    run = drawing.SampledRun(scene, "rk4", np.arange(2), states, "id")
    assert (drawing.position(run).plot.y.scale.high, drawing.phase_plane(run).plot.x.scale.high) == (Q(5, 2), 8)
    drawing.require_drawable(Scene("long", "rk4", Q(1), Q(10**6), panels=("position",)))


def test_long_exact_curve_still_reaches_both_sides_everywhere():
    """10^5 radians in 346 columns: the curve fills its band, and is not aliased into a slow wave."""
    run = run_of("symplectic_euler", Q(1, 2), Q(10**5))
    curve = marks(drawing.position(run), "exact path dense")
    ys = np.array([float(y) for _, y in curve])
    assert ys.max() - ys.min() > 100
    assert np.median(np.abs(np.diff(ys))) > 50


@pytest.mark.parametrize(("end", "axis"), [(Q(0), (0, 1)), (Q(3), (0, 3)), (Q(-3), (-3, 0))])
def test_times_go_from_zero_to_the_end_or_to_one_if_that_is_zero(end, axis, monkeypatch):
    scene, made = Scene("s", "rk4", Q(1) if end >= 0 else Q(-1), end, readouts=("trajectory",)), []
    run = drawing.SampledRun(scene, "rk4", times_of_steps(scene.h, 0), np.zeros((1, 2)), "id")
    linear = drawing.linear
    monkeypatch.setattr(drawing, "linear", lambda *given: made.append(given) or linear(*given))
    drawing.position(run)
    assert made[0][:2] == axis


def test_run_without_any_step_is_drawn():
    scene = Scene("s", "rk4", Q(1), Q(0), (Q(0), Q(0)), readouts=("trajectory",))
    run = drawing.SampledRun(scene, "rk4", times_of_steps(Q(1), 0), np.zeros((1, 2)), "id")
    assert "<svg" in drawing.position(run).markup()
    assert "<svg" in drawing.phase_plane(run).markup()


def test_figures_are_whole_files_and_the_same_bytes_each_time(tmp_path):
    one, two = (drawing.write_figures(PRESETS["compare"], tmp_path / name) for name in ("one", "two"))
    assert [path.name for path in one] == ["compare_position.svg", "compare_phase_plane.svg"]
    assert [path.read_bytes() for path in one] == [path.read_bytes() for path in two]
    assert sorted(path.name for path in (tmp_path / "one").iterdir()) == sorted(path.name for path in one)


def test_figure_in_the_readme_is_the_one_that_the_command_writes(tmp_path):
    _, phase = drawing.write_figures(PRESETS["default"], tmp_path)
    assert phase.read_bytes() == (Path(__file__).parents[3] / "docs" / "default_phase_plane.svg").read_bytes()


def test_run_too_long_to_be_drawn_is_refused_before_it_starts(tmp_path):
    long = Scene("long", "rk4", Q(1), Q(10**6 + 1), panels=("position",))
    for draw in (lambda: drawing.write_figures(long, tmp_path), lambda: document([long])):
        with pytest.raises(ValueError, match="1000001 steps are too many to draw; at most 1000000"):
            draw()
    assert list(tmp_path.iterdir()) == []
