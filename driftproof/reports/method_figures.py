"""Pictures of a method: stability region with certified boundary, order star, dispersion and dissipation."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from driftproof.methods.schemes import Method
from driftproof.reports.page.figure import write_picture
from driftproof.reports.page.markup import element
from driftproof.reports.page.plot import SQUARE, WIDE, Plot, linear, place
from driftproof.symbolic.algebra.matrices import StepMatrix
from driftproof.symbolic.algebra.polynomials import coefficients
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.linear.oscillator import (
    area_factor,
    energy_multiplier_of,
    matrix_trace,
    oscillator_matrix,
    stability_function_of,
)
from driftproof.symbolic.linear.region import boundary_points

# Certified points on the boundary: 2 count + 1 values of Re R(z).
_POINTS = 24
# Rows and columns of a shaded square: a row is one unit of the picture high, a column half a unit wide.
_ROWS, _COLUMNS = 264, 528
# Values of h at which phase and growth are computed.
_H = np.linspace(0, 3, 601)[1:]
# The boundary of an A-stable method goes to infinity; points farther from 0 than this are not drawn.
_FARTHEST = 12
# Lines of the phase picture are cut off at this size; log |R(ih)| is infinite at a zero of R(ih).
_DEEPEST = 10.0

_Legend = list[tuple[str, str]]


def draw_method(picture: str, method: Method, path: Path) -> Path:
    """Write the picture of the method to `path`, an SVG file. Raises ValueError for a method without R(z).

    The phase picture of such a method is that of the eigenvalues of its one-step matrix M(h).
    """
    r = stability_function_of(method)
    if r is None and picture != "phase":
        why = "it is not a Runge-Kutta method; --picture phase draws the eigenvalues of its one-step matrix"
        raise ValueError(f"{method.key} has no stability function to draw: {why}")
    plot, words, legend = _phase_of_matrix(oscillator_matrix(method)) if r is None else PICTURES[picture](r)
    return write_picture(path, method.title, words, f"{method.title}: {words}", [plot], legend)


def _region(r: RationalFunction) -> tuple[Plot, str, _Legend]:
    points = np.array([complex(point.z.mid()) for point in boundary_points(r, _POINTS)])
    points = points[np.abs(points) <= _FARTHEST]
    ends = [(part.min(), part.max()) for part in (points.real, points.imag)]
    reach = 0.6 * max(1.0, *(high - low for low, high in ends))
    plot = _plane([(low + high) / 2 for low, high in ends], reach)
    _shade(plot, lambda z: np.abs(_values(r, z)) <= 1)
    plot.dots([(z.real, z.imag) for z in points], "dots m0")
    return plot, "stability region: |R(z)| <= 1", [("dotted m0", "certified: |R(z)| = 1")]


def _order_star(r: RationalFunction) -> tuple[Plot, str, _Legend]:
    plot = _plane([0, 0], 5)
    _shade(plot, lambda z: np.abs(_values(r, z)) > np.abs(np.exp(z)))
    return plot, "order star: shaded where |R(z)| > |exp z|", []


def _phase(r: RationalFunction) -> tuple[Plot, str, _Legend]:
    with np.errstate(divide="ignore"):
        growth = np.log(_values(energy_multiplier_of(r), _H * _H)) / 2
    dispersion = np.unwrap(np.angle(_values(r, 1j * _H))) - _H
    return _lines((dispersion, growth), "dispersion: arg R(ih) - h", "dissipation: log |R(ih)|")


def _phase_of_matrix(m: StepMatrix) -> tuple[Plot, str, _Legend]:
    """The angle of the eigenvalues up to the first h at which they are real, and the size of the larger one."""
    half, area = _values(matrix_trace(m), _H) / 2, _values(area_factor(m), _H)
    off = half * half - area
    turning = np.logical_and.accumulate(off < 0)
    angle = np.arctan2(np.sqrt(np.maximum(-off, 0)), half)
    with np.errstate(divide="ignore"):
        growth = np.log(np.where(off < 0, np.sqrt(np.abs(area)), np.abs(half) + np.sqrt(np.maximum(off, 0))))
    words = "dispersion: angle of the eigenvalues of M(h) - h", "dissipation: log |larger eigenvalue of M(h)|"
    return _lines((np.where(turning, angle - _H, np.nan), growth), *words)


def _lines(curves: Sequence[Any], *labels: str) -> tuple[Plot, str, _Legend]:
    lines = [np.clip(line, -_DEEPEST, _DEEPEST) for line in curves]
    every = np.concatenate([*lines, [0.0]])
    ends = np.nanmin(every) - 0.05, np.nanmax(every) + 0.05
    low, high = (Fraction(float(x)).limit_denominator(1000) for x in ends)
    plot = Plot(linear(Fraction(0), Fraction(3), "step size h", WIDE[0]), linear(low, high, "radians; log", WIDE[1]))
    marks = ("path m3", "path m0")
    for line, mark in zip(lines, marks, strict=True):
        plot.line([(x, y) for x, y in zip(_H, line, strict=True) if np.isfinite(y)], mark)
    legend = [(f"line {mark}", label) for mark, label in zip(marks, labels, strict=True)]
    return plot, "on q' = v, v' = -q", legend


PICTURES = {"region": _region, "order-star": _order_star, "phase": _phase}


def _plane(middle: Sequence[float], reach: float) -> Plot:
    """A plot of the square of the complex plane with this middle, from -reach to reach around it."""
    (left, right), (low, high) = ([Fraction(float(c + d)) for d in (-reach, reach)] for c in middle)
    return Plot(linear(left, right, "Re z", SQUARE[0]), linear(low, high, "Im z", SQUARE[1]))


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
