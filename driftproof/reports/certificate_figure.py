"""The figure of a certificate: bounds of the error and of its two parts against time, on a logarithmic axis."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from math import ceil, floor, log10
from pathlib import Path

from flint import arb

from driftproof.enclosure.certificate import BallRows, Certificate, decimal
from driftproof.reports.page.figure import Figure
from driftproof.reports.page.plot import COLUMNS_OF_PIXELS, WIDE, Plot, decades, linear

# Up to this many points of a line also get a dot each.
_MOST_DOTS = 60
# At most this many decades below the largest error are shown: no double is that much better than another.
_DEEPEST = 40
# No more digits of an error are claimed: RADIUS_TO_ERROR of `enclosure.certify`, 2⁻⁴⁰, leaves twelve.
PROVED_DIGITS = 12
_MARKS = ("path m0", "path m1", "path m2")


def draw_certificate(found: Certificate, title: str, path: Path) -> Path:
    """Write the figure as an SVG file; return its path. Raises ValueError for another file name, or nothing to draw."""
    figure = certificate_figure(found, title)
    largest, at = found.largest_error, found.t[found.worst[0]]
    proved = min(PROVED_DIGITS, int(largest.rel_accuracy_bits() * log10(2)))
    return figure.write(path, f"largest {largest.str(4, radius=False)} at t = {at:.6g}, {proved} digits of it proved")


def certificate_figure(found: Certificate, title: str) -> Figure:
    """The largest component of error, truncation and rounding at each time, between its two proved bounds.

    Bounds that are 0 have no place on a logarithmic axis. Raises ValueError if all are.
    """
    parts: list[tuple[str, BallRows]] = [("error", found.errors)]
    if found.split is not None:
        parts += [("truncation", found.split.truncation), ("rounding", found.split.rounding)]
    bounds = {name: [_bounds(row) for row in rows] for name, rows in parts}
    every = [log10(x) for pairs in bounds.values() for pair in pairs for x in pair if x > 0]
    if not every:
        raise ValueError("there is no error to draw: all points are exact")
    low, high = max(floor(min(every)), ceil(max(every)) - _DEEPEST), ceil(max(every))
    low = min(low, high - 2)
    time = linear(Fraction(found.t[0]), Fraction(found.t[-1]), "t", WIDE[0])
    plot = Plot(time, decades(low, high, "error, the largest component", WIDE[1]))
    for (name, _), mark in zip(parts, _MARKS, strict=False):
        for side in (0, 1):
            places = [(t, log10(pair[side])) for t, pair in zip(found.t, bounds[name], strict=True) if pair[side] > 0]
            shown = [(t, max(y, float(low))) for t, y in places]
            if len(shown) > 1:
                plot.line(_thinned(shown, found.t), mark)
            if side and 0 < len(shown) <= _MOST_DOTS:
                plot.dots(shown, mark.replace("path", "dots"))
    return Figure(
        identity="certificate",
        kind="wide",
        title=title,
        description=f"The largest error of each point against t, logarithmic. {found.text().splitlines()[0]}",
        plot=plot,
        legend=[(f"line {mark}", name) for (name, _), mark in zip(parts, _MARKS, strict=False)],
        note="Where the proved lower and upper bounds visibly differ, a line becomes two.",
        data=_data(found, parts),
        data_title="Error against t",
    )


def _bounds(row: Sequence[arb]) -> tuple[float, float]:
    """Lower and upper bound of the largest component in the row, in size."""
    largest = reduce(arb.max, map(abs, row))
    return float(largest.lower()), float(largest.upper())


def _thinned(places: list[tuple[float, float]], t: Sequence[float]) -> list[tuple[float, float]]:
    """The largest and the smallest point of each column of pixels, in order of time."""
    columns: dict[int, list[tuple[float, float]]] = {}
    for place in places:
        columns.setdefault(int((place[0] - t[0]) / (t[-1] - t[0]) * COLUMNS_OF_PIXELS), []).append(place)
    ends = [(min(column, key=lambda p: p[1]), max(column, key=lambda p: p[1])) for column in columns.values()]
    return [place for pair in ends for place in sorted(set(pair))]


def _data(found: Certificate, parts: Sequence[tuple[str, BallRows]]) -> list[list[str]]:
    rows = [["t", *(name for name, _ in parts), "digits"]]
    for i, t in enumerate(found.t):
        sizes = [decimal(max((abs(x) for x in balls[i]), key=lambda x: float(x.mid()))) for _, balls in parts]
        rows.append([f"{t:.17g}", *sizes, str(found.digits_at[i])])
    return rows
