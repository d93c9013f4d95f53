"""Pictures of a method: stability region with certified boundary, order star, dispersion and dissipation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from driftproof.methods.schemes import Method
from driftproof.support.files import atomic_write
from driftproof.symbolic.algebra.polynomials import coefficients
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.linear.oscillator import energy_multiplier_of, stability_function_of
from driftproof.symbolic.linear.region import boundary_points

_INSIDE, _LINE, _POINT = "#cfe3f4", "#1f6fb4", "#c87a00"
# Certified points on the boundary: 2 count + 1 values of Re R(z).
_POINTS = 24
_GRID = 601
# The boundary of an A-stable method goes to infinity; the picture does not.
_FARTHEST = 12


def draw_method(picture: str, method: Method, path: Path) -> Path:
    """Write the picture of the method to `path` and return it. Raises ValueError for a method without R(z)."""
    r = stability_function_of(method)
    if r is None:
        raise ValueError(f"{method.key} has no stability function to draw: it is no Runge-Kutta method")
    with matplotlib.rc_context({"svg.hashsalt": "driftproof", "font.size": 11}):
        figure = Figure(figsize=(6.4, 5.2), layout="constrained")
        axes = figure.add_subplot()
        PICTURES[picture](axes, r)
        axes.set_title(method.title)
        axes.grid(alpha=0.3)
        save_picture(figure, path)
    return path


def _region(axes: Any, r: RationalFunction) -> None:
    points = np.array([complex(point.z.mid()) for point in boundary_points(r, _POINTS)])
    points = points[np.abs(points) <= _FARTHEST]
    x, y = _around(points)
    axes.contourf(x, y, np.abs(_values(r, x + 1j * y)) <= 1, levels=[0.5, 1.5], colors=[_INSIDE])
    axes.plot(points.real, points.imag, ".", color=_POINT, markersize=4, label="certified: |R(z)| = 1")
    _complex_plane(axes)
    axes.figure.legend(loc="outside lower center", frameon=False)


def _order_star(axes: Any, r: RationalFunction) -> None:
    x, y = np.meshgrid(np.linspace(-5, 5, _GRID), np.linspace(-5, 5, _GRID))
    z = x + 1j * y
    axes.contourf(x, y, np.abs(_values(r, z)) > np.abs(np.exp(z)), levels=[0.5, 1.5], colors=[_INSIDE])
    _complex_plane(axes)
    axes.set_xlabel("Re z; shaded: |R(z)| > |exp z|")


def _phase(axes: Any, r: RationalFunction) -> None:
    h = np.linspace(0, 3, _GRID)[1:]
    value = _values(r, 1j * h)
    growth = np.sqrt(_values(energy_multiplier_of(r), h * h))
    axes.plot(h, np.unwrap(np.angle(value)) - h, color=_LINE, label="dispersion: arg R(ih) - h")
    axes.plot(h, np.log(growth), "--", color=_POINT, label="dissipation: log |R(ih)|")
    axes.set_xlabel("step h")
    axes.legend(loc="best")


PICTURES = {"region": _region, "order-star": _order_star, "phase": _phase}


def _values(r: RationalFunction, z: Any) -> Any:
    """R(z) in floats, for the eye; where it has a pole the value is infinite."""
    top, bottom = ([float(c) for c in coefficients(p)] for p in (r.num, r.den))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.polynomial.polynomial.polyval(z, top) / np.polynomial.polynomial.polyval(z, bottom)


def _around(points: Any) -> tuple[Any, Any]:
    """A square grid around the points, a fifth wider than they need."""
    ends = [(part.min(), part.max()) for part in (points.real, points.imag)]
    reach = 0.6 * max(1.0, *(high - low for low, high in ends))
    lines = [np.linspace((low + high) / 2 - reach, (low + high) / 2 + reach, _GRID) for low, high in ends]
    x, y = np.meshgrid(*lines)
    return x, y


def _complex_plane(axes: Any) -> None:
    axes.axhline(0, color="black", linewidth=0.6)
    axes.axvline(0, color="black", linewidth=0.6)
    axes.set_aspect("equal")
    axes.set_xlabel("Re z")
    axes.set_ylabel("Im z")


def save_picture(figure: Figure, path: Path) -> None:
    """Write the figure whole or not at all, as the kind that the suffix names. Raises ValueError for any other name."""
    known = figure.canvas.get_supported_filetypes()
    if path.suffix[1:].lower() not in known:
        raise ValueError(f"{path}: the name of a picture ends in one of {', '.join(f'.{kind}' for kind in known)}")
    with atomic_write(path) as draft:
        figure.savefig(draft, metadata={"Date": None})
