"""The figures of error against work: one per quantity, with a panel for evaluations and for each kind of time."""

from __future__ import annotations

from math import ceil, floor, log10
from pathlib import Path
from textwrap import shorten

from driftproof.numeric.reference_errors import ENERGY, PHASE, STATE, U, floors, largest_state_size
from driftproof.numeric.work_precision.curves import Curve
from driftproof.numeric.work_precision.integrators import COMPILED, ENSEMBLE, PYTHON
from driftproof.reports.page.figure import write_picture
from driftproof.reports.page.plot import WIDE, Plot, decades, decades_of
from driftproof.reports.page.stability import line_style
from driftproof.reports.work_precision.study import EVALUATIONS, Measured, Study

_ERRORS = {STATE: "error of the state", ENERGY: "error of the energy", PHASE: "error of the phase, degrees"}
_COSTS = {
    EVALUATIONS: "evaluations of f",
    COMPILED: "seconds, compiled",
    PYTHON: "seconds, Python",
    ENSEMBLE: "seconds per state, ensemble",
}
# Errors above this many times the size of the solution, of runs that have blown up, are not shown.
_FARTHEST = 1000
# Characters that fit above a panel.
_CHARACTERS = 66
# More curves than these have no thin lines beside them.
_MOST_THIN = 6
_NO_RUN = "no run can be shown here"
_THIN = ("line thin mark", "thin: largest on the way")
_FLOOR = ("line floor", "rounding of the exact result")


def draw_study(study: Study, measured: Measured, quantity: str, folder: Path) -> Path:
    """Write the figure of a quantity as an SVG file; return its path. Points without error or cost are left out.

    Lines with dots show errors at the end, thin ones, unless there are many, the largest on the way. The floor, below
    which no method is but by luck, is what rounding the exact result may cost, `reference_errors.floors`.
    """
    limits, rounding = _limits(study, measured, quantity), floors(study.problem)[quantity]
    shown = {c: {k for k, curve in measured.curves.items() if _places(measured, curve, quantity, c)} for c in _COSTS}
    keys = [key for key in measured.curves if any(key in of for of in shown.values())]
    kinds = [x for x in measured.kinds if not shown[x] <= shown[COMPILED] or 2 * len(shown[x]) >= len(keys)]
    costs, thin = (EVALUATIONS, *kinds), len(keys) <= _MOST_THIN
    plots = [_panel(measured, quantity, cost, limits, rounding, thin=thin) for cost in costs]
    legend = [(f"line path {_style(measured, key)}", measured.curves[key].title or key) for key in keys]
    legend += [_THIN] * thin + [_FLOOR] * (rounding > 0)
    what = _ERRORS[quantity]
    return write_picture(
        folder / f"work_precision_{quantity}.svg",
        f"{what.capitalize()} against work",
        shorten(study.problem.title, _CHARACTERS * min(2, len(plots)), placeholder=" …"),
        f"The {what} against {', '.join(_COSTS[c] for c in costs)}; all axes are logarithmic.",
        plots,
        legend,
    )


def _panel(
    measured: Measured, quantity: str, cost: str, limits: tuple[int, int], rounding: float, *, thin: bool
) -> Plot:
    low, high = limits
    places = {key: _places(measured, curve, quantity, cost) for key, curve in measured.curves.items()}
    shown = {key: [p for p in found if low <= p[1] <= high] for key, found in places.items()}
    costs = [x for found in shown.values() for x, _, _ in found]
    x, y = decades_of(costs or [0.0], _COSTS[cost], WIDE[0]), decades(low, high, _ERRORS[quantity], WIDE[1])
    plot = Plot(x, y)
    for key, found in shown.items():
        if found:
            style = _style(measured, key)
            if thin:
                plot.line(((x, min(largest, high)) for x, _, largest in found), f"path {style} thin")
            plot.line(((x, final) for x, final, _ in found), f"path {style}")
            plot.dots(((x, final) for x, final, _ in found), f"dots {style}")
    if not costs:
        plot.words(_NO_RUN)
    if rounding > 0 and low <= (at := log10(rounding)) <= high:
        plot.line([(x, at) for x in (plot.x.scale.low, plot.x.scale.high)], "floor")
    return plot


def _style(measured: Measured, key: str) -> str:
    return line_style(list(measured.curves).index(key))


def _limits(study: Study, measured: Measured, quantity: str) -> tuple[int, int]:
    """Exponents of ten at the ends of the axis; errors below u² of the solution's size have decayed off it."""
    found = [point.errors[quantity] for c in measured.curves.values() for point in c.points if point.errors]
    lows = [x for x in (*(size.final for size in found), floors(study.problem)[quantity]) if x > 0]
    whole = _scale(study, quantity)
    if not (lows and found and whole > 0):
        return -16, 0
    low = min(whole, max(min(lows), whole * float(U) ** 2))
    high = max(low, min(_FARTHEST * whole, max(size.largest for size in found)))
    bottom = floor(log10(low))
    return bottom, max(ceil(log10(high)), bottom + 2)


def _scale(study: Study, quantity: str) -> float:
    """The size of the solution; of an energy, the sum of |yᵢ ∂E/∂yᵢ|; of a phase, half a turn."""
    if quantity == ENERGY:
        return floors(study.problem)[ENERGY] / float(U)
    return 180.0 if quantity == PHASE else largest_state_size(study.problem)


def _places(measured: Measured, curve: Curve, quantity: str, cost: str) -> list[tuple[float, float, float]]:
    """log₁₀ of cost, final and largest error of the points that have a place on logarithmic axes."""
    costs, found = measured.costs(curve, cost), []
    for point in curve.points:
        size, x = point.errors.get(quantity), costs.get(point.setting)
        if size is not None and x and size.final > 0:
            found.append((log10(x), log10(size.final), log10(size.largest)))
    return found
