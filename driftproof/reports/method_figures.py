"""The picture of a method: its stability region with certified boundary."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from driftproof.methods.schemes import Method
from driftproof.reports.page.figure import write_picture
from driftproof.reports.page.markup import element
from driftproof.reports.page.plot import SQUARE, Plot, linear, place
from driftproof.symbolic.algebra.polynomials import coefficients
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.region import boundary_points

# Certified points on the boundary: 2 count + 1 values of Re R(z).
_POINTS = 24
# Rows and columns of a shaded square: a row is one unit of the picture high, a column half a unit wide.
_ROWS, _COLUMNS = 264, 528
# The boundary of an A-stable method goes to infinity; points farther from 0 than this are not drawn.
_FARTHEST = 12


def draw_method(method: Method, path: Path) -> Path:
    """Write the stability region of the method to `path`, an SVG file. Raises ValueError for a method without R(z)."""
    r = stability_function_of(method)
    if r is None:
        raise ValueError(f"{method.key} has no stability function to draw: it is not a Runge-Kutta method")
    words, legend = "stability region: |R(z)| <= 1", [("dotted m0", "certified: |R(z)| = 1")]
    return write_picture(path, method.title, words, f"{method.title}: {words}", [region_of(r)], legend)


def region_of(r: RationalFunction) -> Plot:
    """The stability region, shaded, with its certified points."""
    points = np.array([complex(point.z.mid()) for point in boundary_points(r, _POINTS)])
    points = points[np.abs(points) <= _FARTHEST]
    ends = [(part.min(), part.max()) for part in (points.real, points.imag)]
    reach = 0.6 * max(1.0, *(high - low for low, high in ends))
    middle = [(low + high) / 2 for low, high in ends]
    (left, right), (low, high) = ([Fraction(float(c + d)) for d in (-reach, reach)] for c in middle)
    plot = Plot(linear(left, right, "Re z", SQUARE[0]), linear(low, high, "Im z", SQUARE[1]))
    _shade(plot, lambda z: np.abs(_values(r, z)) <= 1)
    plot.dots([(z.real, z.imag) for z in points], "dots m0")
    return plot


def _shade(plot: Plot, inside: Any) -> None:
    """Shade the points z of the square with `inside(z)` by horizontal strokes, and draw the axes through 0 on top."""
    x, y = (
        np.linspace(float(axis.scale.low), float(axis.scale.high), n)
        for axis, n in ((plot.x, _COLUMNS), (plot.y, _ROWS))
    )
    strokes = []
    for im in y:
        edges = np.flatnonzero(np.diff(inside(x + 1j * im).astype(int), prepend=0, append=0))
        for start, end in edges.reshape(-1, 2):
            left, at = plot.at((x[start], im))
            strokes.append(f"M{left} {at}H{place(plot.x.scale(x[end - 1]))}")
    plot.drawn.append(element("path", class_="shade", d="".join(strokes)))
    across, up = plot.x.scale, plot.y.scale
    plot.line([(across.low, 0), (across.high, 0)], "axis")
    plot.line([(0, up.low), (0, up.high)], "axis")


def _values(r: RationalFunction, z: Any) -> Any:
    """R(z) in floats, for drawing only; not finite at a pole."""
    top, bottom = ([float(c) for c in coefficients(p)] for p in (r.num, r.den))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.polynomial.polynomial.polyval(z, top) / np.polynomial.polynomial.polyval(z, bottom)
