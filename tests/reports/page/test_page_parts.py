"""Parts of the page: text that closes nothing, points where they belong, long runs thinned, verdicts with a witness."""

from __future__ import annotations

import re
from fractions import Fraction as Q
from itertools import pairwise
from math import cos, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.run import run_method, times
from driftproof.numeric.scenes import Scene
from driftproof.reports.page.axes import Scale, ticks
from driftproof.reports.page.figure import Figure, table
from driftproof.reports.page.stability import beside, verdict
from driftproof.reports.page.svg import Axis, Plot, element, place, text
from driftproof.reports.page.thinning import extremes_by_column, moved, spread
from driftproof.reports.page.trajectory import MOST_DOTS, MOST_MARKS, MOST_ROWS, Run, phase_plane, position
from driftproof.reports.page.work import ladder, work_curves
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.derivation.one_step import one_step_matrix
from driftproof.symbolic.derivation.stability import bounded_at
from driftproof.symbolic.linear.facts import LinearFacts
from driftproof.symbolic.linear.spectral_radius import spectral_radius
from driftproof.symbolic.n_steps import exact_matrix_at


@given(st.text())
def test_text_opens_and_closes_nothing(content: str) -> None:
    shown = text(content)
    assert not set(shown) & set("<>\"'\x00\x0b\x7f")
    assert not re.search(r"&(?!amp;|lt;|gt;|quot;|#x27;)", shown)


def test_element_writes_attributes_in_order_and_drops_none() -> None:
    assert element("a", "b", class_="c d", data_x=1, hidden=None) == '<a class="c d" data-x="1">b</a>'
    assert element("a", title='"<') == '<a title="&quot;&lt;"></a>'


@given(st.fractions(min_value=-(10**6), max_value=10**6))
def test_place_is_within_half_a_hundredth(x: Q) -> None:
    assert abs(Q(place(x)) - x) <= Q(1, 200)
    assert place(x) != "-0"


def small_plot() -> Plot:
    x, y = Scale(Q(-1), Q(1), Q(0), Q(100)), Scale(Q(-1), Q(1), Q(100), Q(0))
    return Plot(Axis(x, "x", ticks(x.low, x.high)), Axis(y, "y", ticks(y.low, y.high)))


def test_marks_are_where_their_numbers_are() -> None:
    plot = small_plot()
    plot.line([(-1.0, -1.0), (0.5, 1.0)], "a")
    plot.dots([(0.0, 0.0)], "b")
    plot.disc((Q(1, 3), 0), 5, "c", "third")
    plot.circle(0.5, "d")
    assert plot.drawn == [
        '<path class="a" d="M0 100L75 0"></path>',
        '<path class="b" d="M50 50h0"></path>',
        '<circle class="c" cx="66.67" cy="50" r="5"><title>third</title></circle>',
        '<circle class="d" cx="50" cy="50" r="25"></circle>',
    ]


def test_cell_reaches_over_the_empty_ones_after_it() -> None:
    markup = table([["a", "b", "c", "d"], ["x", "stopped", "", ""], ["y", "1", "2", "3"]], "t")
    assert '<th scope="row">x</th><td colspan="3">stopped</td></tr>' in markup
    assert '<th scope="row">y</th><td>1</td><td>2</td><td>3</td></tr>' in markup


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=400), st.integers(1, 20))
def test_thinned_samples_keep_the_extremes_of_every_column(values: list[float], columns: int) -> None:
    array = np.array(values)
    kept = extremes_by_column(array, columns)
    assert len(kept) <= 4 * columns
    assert (kept[0], kept[-1]) == (0, len(values) - 1)
    assert list(kept) == sorted(set(kept))
    if len(values) > 4 * columns:
        edges = np.linspace(0, len(values), columns + 1).astype(int)
        for start, end in pairwise(edges):
            inside = array[[i for i in kept if start <= i < end]]
            assert (inside.min(), inside.max()) == (array[start:end].min(), array[start:end].max())


def test_moved_keeps_the_ends_and_one_sample_for_each_square_entered() -> None:
    states = np.array([[0.1, 0.1], [0.2, 0.2], [1.1, 0.2], [1.2, 0.3], [0.1, 0.1], [0.1, 0.2]])
    assert list(moved(states, 1.0)) == [0, 2, 4, 5]
    assert list(moved(states, 10.0)) == [0, 5]


@given(st.integers(1, 10**5), st.integers(1, 300))
def test_spread_has_at_most_so_many_and_both_ends(count: int, most: int) -> None:
    kept = spread(count, most)
    assert len(kept) <= most + 1
    assert (kept[0], kept[-1]) == (0, count - 1)


def run_of(key: str, h: Q, t: Q) -> Run:
    scene = Scene("s", key, h, t, readouts=("trajectory",))
    return Run(scene, key, *run_method(scene, key)["trajectory"], "id")


def marks(figure: Figure, class_: str) -> list[tuple[Q, Q]]:
    """The places of a path in the plot of a figure."""
    (d,) = re.findall(rf'<path class="{class_}" d="([^"]*)"', "".join(figure.plot.drawn))
    return [(Q(x), Q(y)) for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", d)]


def test_every_sample_of_a_short_run_has_a_dot_and_a_place_on_the_line() -> None:
    run = run_of("rk4", Q(1, 8), Q(10))
    for figure in (position(run), phase_plane(run)):
        line = marks(figure, "samples path")
        assert len(line) == 81
        assert line == marks(figure, "samples dots")
        assert len(figure.data) == 82


def test_exact_circle_goes_through_the_start() -> None:
    scene = Scene("s", "rk4", Q(1, 8), Q(1), (Q(3, 5), Q(-4, 5)), readouts=("trajectory",))
    plot = phase_plane(Run(scene, "rk4", *run_method(scene, "rk4")["trajectory"], "id")).plot
    ((x, y, radius),) = re.findall(r'class="exact path" cx="(.*?)" cy="(.*?)" r="(.*?)"', "".join(plot.drawn))
    start = Q(x) + plot.x.scale.per_unit * Q(3, 5), Q(y) + plot.x.scale.per_unit * Q(4, 5)
    assert (plot.x.scale(Q(3, 5)), plot.y.scale(Q(-4, 5))) == start
    assert Q(radius) == round(plot.x.scale.per_unit, 2)


@pytest.mark.parametrize(
    ("h", "steps", "class_", "said"),
    [(Q(1, 100), 3000, "samples path", "joined"), (Q(1, 2), 20_000, "samples specks", "not joined")],
)
def test_long_run_is_drawn_with_bounded_marks_and_said_to_be_thinned(h: Q, steps: int, class_: str, said: str) -> None:
    run = run_of("symplectic_euler", h, steps * h)
    shown = phase_plane(run)
    assert MOST_DOTS < len(marks(shown, class_)) <= MOST_MARKS + 1
    assert said in shown.description
    over_time = position(run)
    assert "samples dots" not in "".join(over_time.plot.drawn)
    assert "extremes" in over_time.note
    assert len(over_time.data) <= MOST_ROWS + 2


def test_long_exact_curve_still_reaches_both_sides_everywhere() -> None:
    """10^5 radians in 346 columns: the curve fills its band, and is not aliased into a slow wave."""
    run = run_of("symplectic_euler", Q(1, 2), Q(10**5))
    curve = marks(position(run), "exact path dense")
    ys = np.array([float(y) for _, y in curve])
    assert ys.max() - ys.min() > 100
    assert np.median(np.abs(np.diff(ys))) > 50


def test_run_without_any_step_is_drawn() -> None:
    scene = Scene("s", "rk4", Q(1), Q(0), (Q(0), Q(0)), readouts=("trajectory",))
    run = Run(scene, "rk4", times(Q(1), 0), np.zeros((1, 2)), "id")
    assert "<svg" in position(run).markup()
    assert "<svg" in phase_plane(run).markup()


VERDICTS = [
    ("forward_euler", Q(1, 4), False, "above"),
    ("symplectic_euler", Q(1, 4), True, "below"),
    ("symplectic_euler", Q(2), False, "at the limit"),
    ("symplectic_euler", Q(5, 2), False, "above"),
    ("rk4", Q(2828427124, 10**9), True, "below"),
    ("rk4", Q(2828427125, 10**9), False, "above"),
    ("implicit_midpoint", Q(10**6), True, "below"),
    ("backward_euler", Q(1), True, "below"),
    ("symplectic_euler", Q(-1), True, "backwards"),
]


@pytest.mark.parametrize(("key", "h", "bounded", "where"), VERDICTS)
def test_verdict_and_place_beside_the_limit(key: str, h: Q, bounded: bool, where: str) -> None:
    found = verdict(key, h)
    assert (found.bounded, beside(found.limit, h)) == (bounded, where)


@pytest.mark.parametrize("key", ["forward_euler", "symplectic_euler", "rk4", "velocity_verlet", "heun2"])
@pytest.mark.parametrize("h", [Q(1, 10), Q(1), Q(2), Q(5, 2), Q(3)])
def test_verdict_agrees_with_the_other_derivation(key: str, h: Q) -> None:
    """The witness works over Q[h] with SymPy's number fields, and with NumPy's eigenvalues; neither is used here."""
    found = verdict(key, h)
    assert found.bounded == bounded_at(one_step_matrix(METHODS[key]), h)
    a, b, c, d = map(float, exact_matrix_at(METHODS[key], h))
    seen = max(abs(np.linalg.eigvals([[a, b], [c, d]])))
    # A double eigenvalue is found to the square root of rounding only.
    assert abs(float(enclose(found.growth)) + 1 - seen) < 1e-6


def test_radius_of_one_is_known_to_be_one() -> None:
    """Where M keeps area and its powers are bounded, also with coefficients in a number field: no enclosure decides."""
    for key in ("symplectic_euler", "velocity_verlet", "yoshida4", "implicit_midpoint", "gauss2"):
        assert verdict(key, Q(1, 2)).growth == 0
    assert verdict("symplectic_euler", Q(2)).growth == 0
    assert spectral_radius((Q(1), Q(0), Q(0), Q(3))) == 3
    assert spectral_radius((Q(-5), Q(0), Q(0), Q(3))) == 5
    assert spectral_radius((Q(0), Q(4), Q(-4), Q(0))) == 4


def test_limit_of_the_verdict_is_the_fact() -> None:
    assert verdict("rk4", Q(1)).limit == LinearFacts(METHODS["rk4"]).imaginary_limit


def test_ladder_holds_the_scene_and_only_halves_and_doubles() -> None:
    assert ladder(40) == [5, 10, 20, 40, 80, 160, 320, 640, 1280, 2560, 5120]
    assert ladder(7)[0] == 7
    assert ladder(3)[0] == 3
    assert ladder(10**6)[-1] == 10**6
    assert all(b == 2 * a for a, b in pairwise(ladder(96)))


def test_work_is_measured_from_the_scene_s_own_start() -> None:
    """The error at the scene's own number of steps is the distance from the exact state that its start leads to."""
    scene = Scene("s", "rk4", Q(1, 2), Q(3), (Q(1, 3), Q(-2)), readouts=("final_state",))
    (curve,) = work_curves(scene)
    (own,) = [point for point in curve.points if point.steps == scene.steps]
    q, v = run_method(scene, "rk4")["final_state"]
    exact = (cos(3) / 3 - 2 * sin(3), -2 * cos(3) - sin(3) / 3)
    assert own.evaluations == 24
    assert own.error == pytest.approx(np.hypot(q - exact[0], v - exact[1]), rel=1e-9)


def test_work_of_a_scene_that_runs_backwards_is_refused() -> None:
    with pytest.raises(ValueError, match="up to a t above 0"):
        work_curves(Scene("back", "rk4", Q(-1), Q(-3), panels=("work_precision",)))
