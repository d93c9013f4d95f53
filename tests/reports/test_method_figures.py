"""Pictures of methods: drawn whole, the same bytes each time, with certified points on the boundary of the region."""

import re
from dataclasses import replace
from math import hypot, sqrt
from xml.etree import ElementTree

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.reports.method_figures import draw_method, region_of
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.region import boundary_points
from tests.looping import exactly, some


def test_picture_is_whole_and_the_same_bytes_each_time(tmp_path):
    first, second = (draw_method(METHODS["rk4"], tmp_path / name).read_bytes() for name in ("1.svg", "2.svg"))
    assert first == second
    assert ElementTree.fromstring(first).tag.endswith("svg")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1.svg", "2.svg"]


def test_splitting_has_no_picture_and_no_file_is_left(tmp_path):
    with pytest.raises(ValueError, match="symplectic_euler has no stability function to draw"):
        draw_method(METHODS["symplectic_euler"], tmp_path / "x.svg")
    assert list(tmp_path.iterdir()) == []


def test_name_of_a_picture_says_its_kind(tmp_path):
    with pytest.raises(ValueError, match=r"x\.png: a picture must be a \.svg file"):
        draw_method(METHODS["rk4"], tmp_path / "x.png")
    assert draw_method(METHODS["rk4"], tmp_path / "x.SVG").stat().st_size > 1000


def strokes(path):
    (shade,) = (x for x in ElementTree.parse(path).iter() if x.get("class") == "shade")
    return [tuple(map(float, found)) for found in re.findall(r"M([\d.]+) ([\d.]+)H([\d.]+)", shade.get("d", ""))]


def test_what_is_shaded_is_the_inside_of_the_region(tmp_path):
    """Forward Euler's region is the disc of radius 1 around -1, in a square of side 2.4, 264 units of the picture.

    A column is half a unit wide, and shaded from the first one inside to the last.
    """
    unit, middle, path = 264 / 2.4, 52 + 132, draw_method(METHODS["forward_euler"], tmp_path / "1.svg")
    seen = strokes(path)
    assert (len(seen), len({y for _, y, _ in seen})) == (pytest.approx(2 * unit, abs=1),) * 2
    for left, y, right in some(x for x in seen if abs(x[1] - 26 - 132) < 100):
        half = sqrt(unit**2 - (y - 26 - 132) ** 2)
        assert -0.03 < half - (middle - left) < 0.54 > half - (right - middle) > -0.03
    (dots,) = re.findall('class="dots m0" d="M(.*?)"', path.read_text(encoding="utf-8"))
    for x, y in exactly(2 * 49 - 2, (dot.split("h")[0].split() for dot in dots.split("M"))):
        assert hypot(float(x) - middle, float(y) - 26 - 132) == pytest.approx(unit, abs=0.02)


def test_a_picture_is_no_smaller_than_one_and_no_farther_than_twelve():
    """|1 + z + 100 z²| <= 1 is small; Gauss's region ends at an axis."""
    own = replace(METHODS["rk4"], a=((0, 0), (100, 0)), b=(0, 1), c=(0, 100))
    small = region_of(stability_function_of(own)).y.scale
    assert float(small.high - small.low) == pytest.approx(1.2)
    r = stability_function_of(METHODS["gauss2"])
    points = [abs(complex(point.z.mid())) for point in boundary_points(r, 24)]
    assert float(region_of(r).y.scale.high) == 1.2 * max(x for x in points if x < 12)
    assert 11 < max(x for x in points if x < 12) < 12 < min(x for x in points if x > 12) < 13
