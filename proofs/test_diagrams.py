"""The diagrams of the scenes, read back from the page and compared with the exact runs."""

from __future__ import annotations

import re
from fractions import Fraction as Q
from functools import cache
from html import unescape
from itertools import product

from driftproof.methods.catalogue import METHODS
from driftproof.methods.numbers.rationals import parse_rational
from driftproof.numeric.run import Readouts, run_method
from driftproof.numeric.scenes import PRESETS
from driftproof.reports.page.document import document
from driftproof.reports.page.figure import Figure
from driftproof.reports.page.plot import Plot, Scale, symmetric_limit, ticks
from driftproof.reports.page.trajectory import SampledRun, phase_plane, position
from driftproof.reports.scene_view import COMPARED_READOUTS, asking_for, comparison_rows, readout_rows, show_scene
from driftproof.symbolic.algebra.certified import CertifiableReal, enclose, is_less
from driftproof.symbolic.derivation.one_step import matrix_at
from driftproof.symbolic.runs import apply
from proofs.claims import COUNTED, claim
from proofs.printed import ROWS
from proofs.setting import END, EULER, LESSON_METHODS, RK4, START, M, run

# A unit of the last digit of a coordinate in a picture.
HUNDREDTH = Q(1, 100)
EVERY = tuple(product(PRESETS, LESSON_METHODS))
# What the lesson calls its readouts, above their values; the last two are named otherwise there and here.
LABELS = ["Numerical (q, v)", "Exact (q, v)", "State error", "Final energy", "Energy change"]
LABELS += ["Wrapped phase error (degrees)"]
TICK = re.compile(r'<text class="tick ([xy])"[^>]*>([^<]*)</text>')


@cache
def drawn(name: str, key: str) -> tuple[Figure, Figure]:
    """The two diagrams of a preset with the method `key` selected, from its float run."""
    times, states = run_method(asking_for(PRESETS[name], ("trajectory",)), key)["trajectory"]
    shown = SampledRun(PRESETS[name], key, times, states, "diagram")
    return position(shown), phase_plane(shown)


@cache
def exact_samples(name: str, key: str) -> list[tuple[Q, Q]]:
    """The states of the same run, exact, start included."""
    step, states = matrix_at(M(key), PRESETS[name].h), [START]
    for _ in range(PRESETS[name].steps):
        states.append(apply(step, *states[-1]))
    return states


def reach(plot: Plot) -> Q:
    """The limit L of a vertical axis from -L to L."""
    assert plot.y.scale.low == -plot.y.scale.high
    return plot.y.scale.high


def places(plot: Plot, class_: str) -> list[tuple[str, str]]:
    """The coordinates of the points of a path, as texts."""
    (path,) = re.findall(rf'<path class="{class_}" d="([^"]*)"', "".join(plot.drawn))
    return re.findall(r"(-?[\d.]+) (-?[\d.]+)", path)


def is_at(found: str, scale: Scale, x: CertifiableReal, within: Q = HUNDREDTH) -> bool:
    """True if the coordinate `found` is that of x to within a hundredth of a unit of the picture.

    Rounding to hundredths takes half of that; the other half is for the rounding of the run, so ties may go either way.
    """
    return is_less(lambda: abs(enclose(scale(Q(0)) - Q(found)) + enclose(x) * enclose(scale.per_unit)), within)


def is_near(found: str, scale: Scale, x: CertifiableReal) -> bool:
    """True if the coordinate is that of x to within two hundredths, as the coordinate of t is rounded as well.

    That rounding is at most half a hundredth, in which the curve of slope at most 1 moves by at most a whole one: a
    unit of q is shorter than two units of t.
    """
    return is_at(found, scale, x, within=2 * HUNDREDTH)


def are_drawn(samples: list[tuple[Q, Q]], plot: Plot) -> bool:
    """True if the dots of the plot are exactly these points, in this order."""
    dots = places(plot, "samples dots")
    return len(dots) == len(samples) and all(
        is_at(x, plot.x.scale, sample[0]) and is_at(y, plot.y.scale, sample[1])
        for (x, y), sample in zip(dots, samples, strict=True)
    )


def labels(figure: Figure, axis: str) -> list[str]:
    """The labels of the ticks of an axis, from left to right or upwards."""
    return [unescape(words) for name, words in TICK.findall(figure.markup()) if name == axis]


@claim("L095", evidence=COUNTED, by="marks read back")
def test_both_diagrams_show_the_selected_method_and_the_table_all_three() -> None:
    """Our two diagrams of a preset hold the selected method's samples, each once; our table has all three at one h."""
    for name, key in EVERY:
        over_time, plane = (figure.plot for figure in drawn(name, key))
        states, h = exact_samples(name, key), PRESETS[name].h
        for plot, samples in ((over_time, [(i * h, q) for i, (q, _) in enumerate(states)]), (plane, states)):
            assert are_drawn(samples, plot)
    assert not are_drawn(exact_samples("default", RK4), drawn("default", EULER)[1].plot)
    assert not are_drawn(exact_samples("default", EULER)[:-1], drawn("default", EULER)[1].plot)
    for scene in PRESETS.values():
        shown = document([scene])
        (selected,) = re.findall(r'id="scene-1-(\w+)-shown" checked', shown)
        (caption,) = re.findall(r"<caption>(At t = [^<]*)</caption>", shown)
        assert (selected, caption) == (scene.selected, f"At t = 10, each with h = {scene.h}")
        (table,) = re.findall(rf"{caption}.*?</table>", shown)
        rows = dict(re.findall(r'<th scope="row">([^<]*)</th><td>([^<]*)<', table))
        assert [*rows] == [METHODS[key].title for key in LESSON_METHODS]
        assert len({*rows.values()}) == len(rows)  # each has the error of a run of its own


@claim("L099", evidence=COUNTED, by="marks read back")
def test_default_diagram_compares_forty_one_samples_with_the_cosine() -> None:
    """Our default picture compares 41 samples of forward Euler with the cosine, both from t = 0 to t = 10."""
    scene, over_time = PRESETS["default"], drawn("default", EULER)[0].plot
    assert scene.selected == EULER
    samples = [(i * scene.h, q) for i, (q, _) in enumerate(exact_samples("default", EULER))]
    assert are_drawn(samples, over_time)
    assert (len(samples), samples[0][0], samples[-1][0]) == (41, 0, 10)
    curve = places(over_time, "exact path")
    assert abs(over_time.y.scale.per_unit) < 2 * over_time.x.scale.per_unit
    times = [(Q(x) - over_time.x.scale(Q(0))) / over_time.x.scale.per_unit for x, _ in curve]
    assert len(curve) > 41
    assert abs(times[0]) < Q(1, 1000) > abs(times[-1] - 10)
    for t, (_, y) in zip(times, curve, strict=True):
        assert is_near(y, over_time.y.scale, lambda t=t: enclose(t).cos())
    assert not is_near(curve[0][1], over_time.y.scale, Q(0))


@claim("L101", evidence=COUNTED, by="largest sample bounded")
def test_vertical_scale_follows_the_results() -> None:
    """In our drawings of the presets the q axis ends between 21/20 and 7/5 of the run's largest |qₙ|: it follows."""
    for name, key in EVERY:
        largest = max(abs(q) for q, _ in exact_samples(name, key))
        end = reach(drawn(name, key)[0].plot)
        assert end == symmetric_limit(largest)
        assert Q(21, 20) * largest <= end <= Q(7, 5) * largest
    assert reach(drawn("default", EULER)[0].plot) == 4
    assert reach(drawn("default", RK4)[0].plot) == Q(5, 4)


@claim("L102", evidence=COUNTED, by="largest sample bounded")
def test_ticks_of_the_position_diagram() -> None:
    """Our q axis of the default run is labelled -4, 0, 4, because 3 < 21/20 max |qₙ| <= 4; the t axis 0, 5, 10."""
    largest = max(abs(q) for q, _ in exact_samples("default", EULER))
    assert 3 < Q(21, 20) * largest <= 4
    assert (symmetric_limit(largest), ticks(Q(-4), Q(4)), ticks(Q(0), END)) == (4, [-4, 0, 4], [0, 5, 10])
    over_time = drawn("default", EULER)[0]
    assert (labels(over_time, "y"), labels(over_time, "x")) == (["−4", "0", "4"], ["0", "5", "10"])
    assert labels(drawn("compare", EULER)[0], "y") != ["−4", "0", "4"]


@claim("L105", evidence=COUNTED, by="scale factors equal")
def test_phase_plane_has_equal_scales() -> None:
    """In our phase plane, whatever preset is drawn, units of q and v are equal, so the exact path is a circle, round 0.

    Its radius is 1, as that of the solution, to a hundredth of a unit of the picture.
    """
    for name, key in EVERY:
        over_time, plane = (figure.plot for figure in drawn(name, key))
        assert plane.x.scale.per_unit == -plane.y.scale.per_unit > 0
        x, y, radius = map(Q, circle(plane, "exact path"))
        assert abs(x - plane.x.scale(Q(0))) <= HUNDREDTH >= abs(y - plane.y.scale(Q(0)))
        assert abs(radius - plane.x.scale.per_unit) <= HUNDREDTH
        assert over_time.x.scale.per_unit != -over_time.y.scale.per_unit


@claim("L109", evidence=COUNTED, by="largest sample bounded")
def test_ticks_of_the_phase_plane() -> None:
    """Both axes of the default run in our phase plane, q across and v up, are labelled -4, 0, 4."""
    largest = max(max(abs(q), abs(v)) for q, v in exact_samples("default", EULER))
    assert 3 < Q(21, 20) * largest <= 4
    plane = drawn("default", EULER)[1]
    assert labels(plane, "x") == labels(plane, "y") == ["−4", "0", "4"]
    assert (plane.plot.x.name[-1], plane.plot.y.name[-1]) == ("q", "v")
    assert labels(drawn("compare", EULER)[1], "y") != ["−4", "0", "4"]


@claim("L110", evidence=COUNTED, by="marks at exact states")
def test_final_states_are_marked_apart_on_one_scale() -> None:
    """In our drawings of the presets an open blue ring marks the exact end, a smaller amber disc the computed one.

    Of the exact state the place is certified, of the run it is computed in fractions.
    """
    for name, key in EVERY:
        plot = drawn(name, key)[1].plot
        q, v = plot.x.scale, plot.y.scale
        assert (q.low, q.high, q.per_unit) == (v.low, v.high, -v.per_unit)
        for class_, state in (
            ("exact end", run(key, PRESETS[name].h).exact_state),
            ("samples end", exact_samples(name, key)[-1]),
        ):
            x, y, _ = circle(plot, class_)
            assert is_at(x, q, state[0])
            assert is_at(y, v, state[1])
        assert Q(circle(plot, "exact end")[2]) > Q(circle(plot, "samples end")[2])
    plot, other = drawn("default", EULER)[1].plot, exact_samples("default", RK4)[-1]
    assert not is_at(circle(plot, "samples end")[0], plot.x.scale, other[0])
    page = document([PRESETS["default"]])
    fills = dict(re.findall(r"svg \.(exact|samples)\.end \{[^}]*fill: var\(--(\w+)\)", page))
    assert fills == {"exact": "sheet", "samples": "computed"}
    assert re.findall(r"svg \.exact\.end \{[^}]*stroke: var\(--(\w+)\)", page) == ["exact"]
    assert [hues(page, name) for name in ("exact", "computed")] == [["blue"] * 2, ["amber"] * 2]


def circle(plot: Plot, class_: str) -> tuple[str, str, str]:
    """The centre and radius of the only circle of this class."""
    ((x, y, radius),) = re.findall(
        rf'<circle class="{class_}" cx="([^"]*)" cy="([^"]*)" r="([^"]*)"', "".join(plot.drawn)
    )
    return x, y, radius


def hues(page: str, name: str) -> list[str]:
    """The hue of a colour of the style sheet, in the light and in the dark scheme."""
    colours = [[int(c[i : i + 2], 16) for i in (0, 2, 4)] for c in re.findall(rf"--{name}: #([0-9a-f]{{6}})", page)]
    return ["blue" if b > g > r else "amber" if r > g > b else "other" for r, g, b in colours]


@claim("L139", evidence=COUNTED, by="digits shown compared")
def test_readouts_have_finer_digits_than_the_table_of_large_values() -> None:
    """Our scales change with the method selected; in all scenes our readouts from 1/10000 on show finer digits.

    Six decimals against the table's three, or against its two digits below a thousandth. A smaller value may have the
    same digits in both: RK4's energy change at h = 1/4 is shown as -0.000067 and as -6.7e-5. What the default scene
    shows is what the lesson prints of it, in its readouts with their labels and in its table.
    """
    for name in PRESETS:
        assert len({reach(drawn(name, key)[0].plot) for key in LESSON_METHODS}) > 1
    for name, key in EVERY:
        values = run_method(asking_for(PRESETS[name], COMPARED_READOUTS), key)
        for compared, shown in shown_twice(values).items():
            if abs(Q(values[compared])) >= Q(1, 10**4):
                assert unit(shown[0]) < unit(shown[1])
    for exponent in range(-4, 9):  # one value for each decade, from the smallest that is claimed on
        shown = shown_twice(
            {"state_error": float(10**exponent), "energy_change": -float(10**exponent), "evaluations": 1}
        )
        assert all(unit(readout) < unit(cell) for readout, cell in shown.values())
    readout, cell = shown_twice(run_method(asking_for(PRESETS["default"], COMPARED_READOUTS), RK4))["energy_change"]
    assert (readout, cell) == ("-0.000067", "-6.7e-5")
    assert parse_rational(readout) == parse_rational(cell)
    default, printed = show_scene(PRESETS["default"]), {row.claim: row.text for row in ROWS}
    shown = dict(readout_rows(default["readouts"]))
    texts = [printed[f"L{n}"] for n in (*range(112, 122), *range(125, 134))]
    assert list(shown) == [*LABELS, "Steps", "Acceleration evaluations"]
    assert re.findall(r"-?[\d.]+", " ".join(shown.values())) == texts[:10]
    (heads, *rows), _ = comparison_rows(PRESETS["default"], default["table"])
    assert heads == ["Method", "State error", "Energy change", "Calls"]
    assert [cell for _, *cells in rows for cell in cells] == texts[10:]
    assert [title for title, *_ in rows] == [METHODS[key].title for key in LESSON_METHODS]


def shown_twice(values: Readouts) -> dict[str, tuple[str, str]]:
    """State error and energy change, each as text of the readouts and of the table."""
    (_, row), _ = comparison_rows(PRESETS["default"], {EULER: values})
    return {
        name: (readout_rows({name: values[name]})[0][1], cell)
        for name, cell in zip(COMPARED_READOUTS[:2], row[1:3], strict=True)
    }


def unit(text: str) -> Q:
    """One unit of the last digit shown."""
    mantissa, _, exponent = text.partition("e")
    return Q(10) ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


@claim("L149", evidence=COUNTED, by="all samples inside")
def test_each_diagram_rescales_to_include_its_trajectory() -> None:
    """Of each preset every (qₙ, vₙ) is inside the axes of both our diagrams, which end within 7/5 of what they show."""
    for name, key in EVERY:
        over_time, plane = (reach(figure.plot) for figure in drawn(name, key))
        qs, vs = zip(*exact_samples(name, key), strict=True)
        assert max(map(abs, qs)) < over_time <= Q(7, 5) * max(map(abs, qs))
        assert max(map(abs, qs + vs)) < plane <= Q(7, 5) * max(map(abs, qs + vs))
        t = drawn(name, key)[0].plot.x.scale
        assert (t.low, t.high) == (0, END)
    ends = [reach(drawn(name, EULER)[1].plot) for name in PRESETS]
    assert len(set(ends)) == len(PRESETS)
    assert max(abs(q) for q, _ in exact_samples("compare", EULER)) > reach(drawn("default", EULER)[0].plot)
