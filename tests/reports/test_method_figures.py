"""Pictures of methods: drawn whole, the same bytes each time, with certified points on the boundary of the region."""

from __future__ import annotations

import re
from math import sqrt
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.reports.method_figures import PICTURES, draw_method
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.region import boundary_points
from tests.looping import some


@pytest.mark.parametrize("kind", PICTURES)
def test_picture_is_whole_and_the_same_bytes_each_time(kind: str, tmp_path: Path) -> None:
    first, second = (draw_method(kind, METHODS["rk4"], tmp_path / name).read_bytes() for name in ("1.svg", "2.svg"))
    assert first == second
    assert ElementTree.fromstring(first).tag.endswith("svg")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1.svg", "2.svg"]


def test_splitting_has_no_picture_and_no_file_is_left(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="symplectic_euler has no stability function to draw"):
        draw_method("region", METHODS["symplectic_euler"], tmp_path / "x.svg")
    assert list(tmp_path.iterdir()) == []


def test_name_of_a_picture_says_its_kind(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"x\.png: a picture must be a \.svg file"):
        draw_method("phase", METHODS["rk4"], tmp_path / "x.png")
    assert draw_method("phase", METHODS["rk4"], tmp_path / "x.SVG").stat().st_size > 1000


def strokes(path: Path) -> list[tuple[float, float, float]]:
    (shade,) = (x for x in ElementTree.parse(path).iter() if x.get("class") == "shade")
    return [tuple(map(float, found)) for found in re.findall(r"M([\d.]+) ([\d.]+)H([\d.]+)", shade.get("d", ""))]


def test_what_is_shaded_is_the_inside_of_the_region(tmp_path: Path) -> None:
    """Forward Euler's region is the disc of radius 1 around -1, in a square of side 2.4, 264 units of the picture."""
    unit = 264 / 2.4
    for left, y, right in some(strokes(draw_method("region", METHODS["forward_euler"], tmp_path / "1.svg"))):
        half = sqrt(max(0, 1 - ((y - 26) / unit - 1.2) ** 2))
        middle = 52 + 1.2 * unit
        # A column is half a unit wide; rows are shaded from one inside to one inside.
        assert (middle - left, right - middle) == pytest.approx((half * unit, half * unit), abs=1.1)
    star = strokes(draw_method("order-star", METHODS["forward_euler"], tmp_path / "2.svg"))
    assert all(right - left < 264 for left, _, right in some(star))
    assert {round(left) for left, _, _ in star} >= {52}


def test_points_of_the_boundary_are_where_r_has_modulus_one() -> None:
    r = stability_function_of(METHODS["rk4"])
    assert r is not None
    z = np.array([complex(point.z.mid()) for point in boundary_points(r, 6)])
    value = 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24
    assert len(z) > 6
    assert np.all(np.abs(np.abs(value) - 1) < 1e-12)  # some hundred roundings of numbers below 10
