"""Pictures of methods: drawn whole, the same bytes each time, with certified points on the boundary of the region."""

import re
from dataclasses import replace
from math import acosh, asin, atan, exp, hypot, log, sqrt
from xml.etree import ElementTree

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.reports.method_figures import PICTURES, _phase_of_matrix, draw_method
from driftproof.symbolic.algebra.polynomials import exact
from driftproof.symbolic.linear.oscillator import oscillator_matrix, stability_function_of
from driftproof.symbolic.linear.phase import angle_error_series, damping_series
from driftproof.symbolic.linear.region import boundary_points
from tests.looping import exactly, some


@pytest.mark.parametrize("kind", PICTURES)
def test_picture_is_whole_and_the_same_bytes_each_time(kind, tmp_path):
    first, second = (draw_method(kind, METHODS["rk4"], tmp_path / name).read_bytes() for name in ("1.svg", "2.svg"))
    assert first == second
    assert ElementTree.fromstring(first).tag.endswith("svg")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1.svg", "2.svg"]


def test_splitting_has_no_region_to_draw_and_no_file_is_left(tmp_path):
    assert "eigenvalues of M(h)" in draw_method("phase", METHODS["symplectic_euler"], tmp_path / "x.svg").read_text()
    (tmp_path / "x.svg").unlink()
    with pytest.raises(ValueError, match=r"symplectic_euler has no stability function to draw: .* --picture phase"):
        draw_method("region", METHODS["symplectic_euler"], tmp_path / "x.svg")
    assert list(tmp_path.iterdir()) == []


def test_name_of_a_picture_says_its_kind(tmp_path):
    with pytest.raises(ValueError, match=r"x\.png: a picture must be a \.svg file"):
        draw_method("phase", METHODS["rk4"], tmp_path / "x.png")
    assert draw_method("phase", METHODS["rk4"], tmp_path / "x.SVG").stat().st_size > 1000


def strokes(path):
    (shade,) = (x for x in ElementTree.parse(path).iter() if x.get("class") == "shade")
    return [tuple(map(float, found)) for found in re.findall(r"M([\d.]+) ([\d.]+)H([\d.]+)", shade.get("d", ""))]


def test_what_is_shaded_is_the_inside_of_the_region(tmp_path):
    """Forward Euler's region is the disc of radius 1 around -1, in a square of side 2.4, 264 units of the picture.

    A column is half a unit wide, and shaded from the first one inside to the last.
    """
    unit, middle, path = 264 / 2.4, 52 + 132, draw_method("region", METHODS["forward_euler"], tmp_path / "1.svg")
    seen = strokes(path)
    assert (len(seen), len({y for _, y, _ in seen})) == (pytest.approx(2 * unit, abs=1),) * 2
    for left, y, right in some(x for x in seen if abs(x[1] - 26 - 132) < 100):
        half = sqrt(unit**2 - (y - 26 - 132) ** 2)
        assert -0.03 < half - (middle - left) < 0.54 > half - (right - middle) > -0.03
    (dots,) = re.findall('class="dots m0" d="M(.*?)"', path.read_text(encoding="utf-8"))
    for x, y in exactly(2 * 49 - 2, (dot.split("h")[0].split() for dot in dots.split("M"))):
        assert hypot(float(x) - middle, float(y) - 26 - 132) == pytest.approx(unit, abs=0.02)


def test_order_star_is_where_the_step_is_longer_than_the_exponential(tmp_path):
    larger = lambda x, y: abs(1 + x + 1j * y) > exp(x)
    at = lambda left, y: ((left - 52 - 132) / 26.4, (26 + 132 - y) / 26.4)
    seen = strokes(draw_method("order-star", METHODS["forward_euler"], tmp_path / "2.svg"))
    assert (min(left for left, _, _ in seen), len({y for _, y, _ in seen})) == (52, 264)
    for left, y, right in some(seen):
        assert larger(*at(left, y))
        assert larger(*at(right, y))
        assert right > 52 + 264 - 1 or not larger(*at(right + 1, y))
        assert left < 53 or not larger(*at(left - 1, y))


def picture(kind, method):
    return PICTURES[kind](stability_function_of(method))[0]


def lines_are(plot, **curves):
    """Whether the lines of a phase picture are these functions of h, up to these of its 600 steps to h = 3."""
    for name, path in exactly(2, re.findall('class="path (.*?)" d="M(.*?)"', "".join(plot.drawn))):
        places, (curve, steps) = [tuple(map(float, place.split())) for place in path.split("L")], curves[name]
        h = [i / 200 for i in range(1, steps + 1)]
        assert [x for x, _ in places] == pytest.approx([52 + 346 * x / 3 for x in h], abs=0.006)
        assert [y for _, y in places] == pytest.approx([float(plot.y.scale(curve(x))) for x in h], abs=0.006)


def test_phase_and_growth_are_those_of_the_step():
    """Forward Euler's R(ih) = 1 + ih turns by atan h and is sqrt(1 + h²) long; up to h = 3."""
    plot = picture("phase", METHODS["forward_euler"])
    low, high = plot.y.scale.low, plot.y.scale.high
    assert (low, high) == (pytest.approx(atan(3) - 3 - 0.05, abs=1e-3), pytest.approx(log(10) / 2 + 0.05, abs=1e-3))
    lines_are(plot, m3=(lambda h: atan(h) - h, 600), m0=(lambda h: log(1 + h * h) / 2, 600))


def test_phase_of_a_splitting_is_drawn_while_it_turns_and_its_growth_beyond():
    """Verlet turns by 2 asin(h/2) up to h = 2; there its eigenvalues, -a ± sqrt(a² - 1), a = h²/2 - 1, become real."""
    plot = _phase_of_matrix(oscillator_matrix(METHODS["velocity_verlet"]))[0]
    growth = lambda h: acosh(max(1, h * h / 2 - 1))
    lines_are(plot, m3=(lambda h: 2 * asin(h / 2) - h, 399), m0=(growth, 600))


def test_phase_of_a_nystrom_method_is_that_of_its_series():
    """At h = 1, where thirty terms are enough, in units of the picture, of which its file has hundredths."""
    plot = _phase_of_matrix(m := oscillator_matrix(METHODS["nystrom4"]))[0]
    drawn = re.findall('class="path .*?" d="M(.*?)"', "".join(plot.drawn))
    for path, series in exactly(2, zip(drawn, (angle_error_series, damping_series), strict=True)):
        value = sum(float(exact(c)) for c in series(m, 30))
        places = [float(x) for x in path.split("L")[199].split()]
        assert places == pytest.approx([52 + 346 / 3, float(plot.y.scale(value))], abs=0.006)


def test_an_axis_of_phases_is_as_long_as_they_are_and_shows_zero():
    """Gauss's methods have |R(ih)| = 1, and turn by a little less than h."""
    scale = picture("phase", METHODS["gauss3"]).y.scale
    assert -1 < scale.low < -0.05 < 0 < scale.high < 0.1


def test_a_picture_is_no_deeper_than_ten_no_smaller_than_one_and_no_farther_than_twelve():
    """R = 1 + z + z² + z³ is 0 at i; |1 + z + 100 z²| <= 1 is small; Gauss's region ends at an axis."""
    own = lambda a, *weights: replace(METHODS["rk4"], a=a, b=weights, c=tuple(map(sum, a)))
    deep = picture("phase", own(((0, 0, 0), (1, 0, 0), (0, 1, 0)), 0, 0, 1)).y.scale
    assert float(deep.low) == pytest.approx(-10.05, abs=1e-3)
    small = picture("region", own(((0, 0), (100, 0)), 0, 1)).y.scale
    assert float(small.high - small.low) == pytest.approx(1.2)
    r = stability_function_of(METHODS["gauss2"])
    points = [abs(complex(point.z.mid())) for point in boundary_points(r, 24)]
    assert float(picture("region", METHODS["gauss2"]).y.scale.high) == 1.2 * max(x for x in points if x < 12)
    assert 11 < max(x for x in points if x < 12) < 12 < min(x for x in points if x > 12) < 13
