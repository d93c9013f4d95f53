"""The figures of error against work: one for each quantity, a panel for evaluations and for each kind of time."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from driftproof.numeric.reference_errors import ENERGY, PHASE, STATE, U, floors, half_unit, largest_state_size
from driftproof.numeric.work_precision.curves import Curve
from driftproof.numeric.work_precision.integrators import COMPILED, ENSEMBLE, PYTHON
from driftproof.reports.method_figures import save_picture
from driftproof.reports.work_precision.study import EVALUATIONS, Measured, Study

_WHAT = {STATE: "error of the state", ENERGY: "error of the energy", PHASE: "error of the phase, degrees"}
_COSTS = {
    EVALUATIONS: "evaluations of f",
    COMPILED: "seconds, compiled",
    PYTHON: "seconds, Python",
    ENSEMBLE: "seconds a state, ensemble",
}
# Eight hues that stay apart for most eyes (Okabe and Ito's, black last), and what tells their repetitions apart.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c510a", "#000000")
_MARKERS, _DASHES = "os^Dv<>P", ("-", "--", ":")
_FARTHEST = 1000
# What fits above a panel.
_CHARACTERS = 55
_FLOOR = {"color": "#555555", "linewidth": 1.2, "linestyle": (0, (6, 2, 1, 2))}


def draw_study(study: Study, measured: Measured, quantity: str, folder: Path) -> Path:
    """Write the figure of the quantity as an SVG file and return its path. Points without error or cost have no place.

    Lines with markers are errors at the end, thin ones the largest at the reference's times. The floor is what rounding
    the exact result may cost, `exact.floors`; where the reference's own digits say less than that, they are the floor.
    """
    costs = [EVALUATIONS, *measured.kinds]
    columns = min(2, len(costs))
    rows = -(-len(costs) // columns)
    with matplotlib.rc_context({"svg.hashsalt": "driftproof", "font.size": 11}):
        figure = Figure(figsize=(5.4 * columns, 4.2 * rows + 0.9), layout="constrained")
        grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
        for axes, cost in zip(grid.flat, costs, strict=False):
            _panel(axes, study, measured, quantity, cost)
        for axes in list(grid.flat)[len(costs) :]:
            axes.remove()
        for row in grid:
            row[0].set_ylabel(_WHAT[quantity])
        figure.suptitle(fill(study.problem.title.replace("to t = ", "to\u00a0t\u00a0=\u00a0"), _CHARACTERS * columns))
        _legend(figure, [*measured.curves])
        path = folder / f"work_precision_{quantity}.svg"
        save_picture(figure, path)
    return path


def _legend(figure: Figure, keys: list[str]) -> None:
    """One legend for all panels: heyoka, say, has times and no evaluations. Lines that are no curves come last."""
    found: dict[str, Any] = {}
    for axes in figure.axes:
        found |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    labels = [*(key for key in keys if key in found), *(label for label in found if label not in keys)]
    figure.legend([found[x] for x in labels], labels, loc="outside lower center", ncols=4, frameon=False)


def _panel(axes: Any, study: Study, measured: Measured, quantity: str, cost: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    drawn: list[tuple[float, float, float]] = []
    for i, (key, curve) in enumerate(measured.curves.items()):
        again, hue = divmod(i, len(_COLOURS))
        marker = _MARKERS[(hue + 3 * again) % len(_MARKERS)]
        style = {"color": _COLOURS[hue], "linestyle": _DASHES[again % len(_DASHES)]}
        places = _places(measured, curve, quantity, cost)
        if places:
            drawn += places
            x, final, largest = zip(*places, strict=True)
            axes.plot(x, largest, **style, linewidth=0.6, alpha=0.6)
            axes.plot(x, final, **style, marker=marker, markersize=4, linewidth=1.4, label=key)
    _limits(axes, study, measured, quantity)
    _width(axes, drawn)
    axes.plot([], [], color="#555555", linewidth=0.6, label="thin: the largest on the way")
    _floor(axes, study, quantity)
    axes.set_xlabel(_COSTS[cost])
    axes.grid(alpha=0.3)


def _limits(axes: Any, study: Study, measured: Measured, quantity: str) -> None:
    """What leaves at the top has blown up, to _FARTHEST times the scale, and at the bottom decayed below u² of it."""
    found = [point.errors[quantity] for c in measured.curves.values() for point in c.points if point.errors]
    lows = [x for x in (*(size.final for size in found), floors(study.problem)[quantity]) if x > 0]
    if lows and found:
        whole = _scale(study, quantity)
        low = min(whole, max(min(lows), whole * float(U) ** 2))
        axes.set_ylim(low / 2, 2 * max(low, min(_FARTHEST * whole, max(size.largest for size in found))))


def _width(axes: Any, places: list[tuple[float, float, float]]) -> None:
    """As wide as the points that the panel is high enough for; words where there are none."""
    _, top = axes.get_ylim()
    shown = [x for x, final, _ in places if final <= top]
    if shown:
        axes.set_xlim(min(shown) / 2, 2 * max(shown))
    else:
        axes.text(0.5, 0.5, "no run to show here", transform=axes.transAxes, ha="center")


def _scale(study: Study, quantity: str) -> float:
    """The size of the solution, of an energy the sum of |yᵢ ∂E/∂yᵢ|, or half a turn."""
    if quantity == ENERGY:
        return floors(study.problem)[ENERGY] / float(U)
    return 180.0 if quantity == PHASE else largest_state_size(study.problem)


def _places(measured: Measured, curve: Curve, quantity: str, cost: str) -> list[tuple[float, float, float]]:
    """Cost, final and largest error of the points that have a place on logarithmic axes."""
    costs, found = measured.costs(curve, cost), []
    for point in curve.points:
        size, x = point.errors.get(quantity), costs.get(point.setting)
        if size is not None and x and size.final > 0:
            found.append((x, size.final, size.largest))
    return found


def _floor(axes: Any, study: Study, quantity: str) -> None:
    floor, digits = floors(study.problem).get(quantity, 0.0), half_unit(study.problem.reference.states[-1])
    if floor > 0:
        axes.axhline(floor, **_FLOOR, label="rounding the exact result")
    if quantity == STATE and digits > floor:
        axes.axhline(digits, color="#555555", linewidth=1.2, label="the reference's last digit")
