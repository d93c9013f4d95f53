"""The panel of error against work: a scene's methods at its own step size, halved and doubled, and their orders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import isfinite, log10

from driftproof.methods.given_methods import method_of
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.numeric.problems.problem import EXACT, Problem, Reference
from driftproof.numeric.reference_errors import STATE
from driftproof.numeric.scenes import Scene
from driftproof.numeric.work_precision.curves import Against, Curve, Point, curve_of, lasting
from driftproof.numeric.work_precision.verdicts import GOALS, goal_text
from driftproof.reports.page.figure import Figure
from driftproof.reports.page.markup import element, escaped, html_table
from driftproof.reports.page.plot import WIDE, Plot, decades_of
from driftproof.reports.page.stability import line_style
from driftproof.support.plain_text import counted, short
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.runs import OscillatorRun

# The number of steps over the interval is halved down to COARSEST, and doubled up to FINEST, or to FINEST_IMPLICIT for
# implicit methods, which are solved in Python.
COARSEST, FINEST, FINEST_IMPLICIT = 5, 10_000, 600
REFERENCE_DIGITS = 30
# Errors of more than this times the solution have no place in the figure: those of runs that are not stable.
_FARTHEST = 10
ACCELERATIONS = "calls of the acceleration"


def work_curves(scene: Scene) -> list[Curve]:
    """Each method's curve at the scene's number of steps, halved and doubled. Raises ValueError for t <= 0."""
    if scene.t <= 0:
        raise ValueError(f"scene {scene.name!r}: comparing work needs t > 0")
    problem, methods = problem_of(scene), map(scene.method, scene.every_method)
    most = {True: FINEST, False: FINEST_IMPLICIT}
    return [curve_of(each, problem, halved_and_doubled(scene.steps, most[each.explicit])) for each in methods]


def halved_and_doubled(steps: int, finest: int = FINEST) -> list[int]:
    """N/2ᵏ while it is an integer and at least COARSEST, N itself, and 2ᵏN up to `finest`."""
    down = [steps]
    while down[-1] % 2 == 0 and down[-1] // 2 >= COARSEST:
        down.append(down[-1] // 2)
    up = [steps << k for k in range(1, finest.bit_length()) if steps << k <= finest]
    return [*reversed(down), *up]


def problem_of(scene: Scene) -> Problem:
    """The oscillator from the scene's start to its t; the reference is the exact state, to REFERENCE_DIGITS digits."""
    exact = OscillatorRun(method_of(scene.method(scene.selected)), scene.h, scene.t, scene.start).exact_state
    q, v = (significant(x, REFERENCE_DIGITS) for x in exact)
    reference = Reference((scene.t,), ((q, v),), EXACT, "the closed form, in ball arithmetic")
    return replace(HARMONIC, key="scene", start=scene.start, reference=reference, energy=None, expected={})


def work_figure(
    found: Sequence[Curve], identity: str, t: Fraction, own: int | None = None, cost: str = ACCELERATIONS
) -> Figure:
    """Error at t against evaluations, both logarithmic; rings mark the points with `own` steps, if any."""
    places = {c.key: {p.steps: (log10(spent), log10(p.error)) for p, spent in _plotted(c)} for c in found}
    every = [place for points in places.values() for place in points.values()] or [(0.0, 0.0)]
    left_out = sum(1 for c in found for p in c.points if isfinite(p.error) and p.error > _FARTHEST * p.scale)
    beyond = f" Above the figure, not stable: {counted(left_out, 'point')}." if left_out else ""
    names = (cost, "error at the end")
    x, y = (decades_of((place[i] for place in every), names[i], WIDE[i]) for i in (0, 1))
    plot, ringed = Plot(x, y), "" if own is None else f"h = {t / own}"
    for i, curve in enumerate(found):
        if points := places[curve.key]:
            plot.line(points.values(), f"path {line_style(i)}")
            plot.dots(points.values(), f"dots {line_style(i)}")
        if own in points:
            plot.disc(points[own], 6, f"own {line_style(i)}", f"{curve.title} at {ringed}")
    return Figure(
        identity=f"{identity}-work",
        kind="wide",
        title="Error against work",
        description=f"Distance from the exact state at t = {t} against {cost}, both axes logarithmic. "
        f"{f'Rings: {ringed}. ' if ringed else ''}{' '.join(map(_sentence, found))}{beyond}",
        plot=plot,
        legend=[(f"line path {line_style(i)}", curve.title) for i, curve in enumerate(found) if places[curve.key]],
        note=f"{f'Ringed: {ringed}. ' if ringed else ''}From point to point along a line, the step size is halved."
        f"{beyond}",
        data=_data(found, cost),
        data_title=f"Error and {cost}",
    )


def _plotted(curve: Curve) -> list[tuple[Point, int]]:
    """The points of the doublings that have a place on logarithmic axes, each with its evaluations."""
    shown = (p for p in curve.points if 0 < p.error <= _FARTHEST * p.scale and isfinite(p.error) and not p.between)
    return [(p, p.evaluations) for p in shown if p.evaluations]


def _sentence(curve: Curve) -> str:
    if not (plotted := _plotted(curve)):
        return f"{curve.title}: none."
    words = [f"{short(point.error)} at {spent}" for point, spent in (plotted[0], plotted[-1])]
    return f"{curve.title}: from {words[0]} to {words[1]}."


def work_table(found: Sequence[Curve], stated: Mapping[str, str] = {}, goals: Sequence[float] = GOALS[:2]) -> str:
    """A row per method: the order stated and measured, the fewest evaluations for each goal, or why it has none."""
    errors = (goal_text(goal).replace("-", "\N{NON-BREAKING HYPHEN}") for goal in goals)
    header = ["Method", "order", "measured", *(f"calls for {error}" for error in errors)]
    rows, fewest = [], {curve.key: [_fewest_calls(curve, goal) for goal in goals] for curve in found}
    least = [min((calls for calls in of_goal if calls), default=0) for of_goal in zip(*fewest.values(), strict=True)]
    for curve in found:
        if curve.refused:
            rows.append([curve.title, "does not apply", *[""] * (len(header) - 2)])
            continue
        measured = "–"
        if (x := curve.order) is not None:
            settled = x.largest - x.least < 1 and curve.against is not Against.NOT_SETTLED
            measured = f"{f'{x.median:.3f}' if settled else 'not settled'} ({x.least:.3f} to {x.largest:.3f})"
            measured += f", {curve.verdict}" * bool(settled and curve.verdict)
        most = max(point.steps or 0 for point in curve.points)
        pairs = zip(fewest[curve.key], least, strict=True)
        cells = [f"{calls}{' *' * (calls == best)}" if calls else f"not with {most} steps" for calls, best in pairs]
        rows.append([curve.title, str(stated.get(curve.key, "–")), measured, *cells])
    table = html_table([header, *rows], "Orders, and the least work measured (* the least)", "orders")
    notes = [f"{c.title}: {c.refused}" for c in found if c.refused]
    notes += [f"First values of {c.title}: steps of {c.started}" for c in found if c.started]
    return element("div", table, *(element("p", escaped(note), class_="note") for note in notes)) if notes else table


def _fewest_calls(curve: Curve, goal: float) -> int:
    """The fewest evaluations with which the error at the end lasts below the goal; 0 if none does."""
    return min((p.evaluations for p in lasting(curve.points, goal) if p.evaluations), default=0)


def _data(found: Sequence[Curve], cost: str) -> list[list[str]]:
    """A row for each run of the doublings, with the largest of its errors if any run was looked at on the way.

    What the runs between them show, the fewest steps for an error, is told in words below the figure.
    """
    on_the_way = any(point.errors and point.errors[STATE].looks > 1 for curve in found for point in curve.points)
    rows = [["Method", "steps", cost, "error", *["largest on the way"] * on_the_way]]
    for curve in found:
        for point in (each for each in curve.points if not each.between):
            spent = "–" if point.evaluations is None else str(point.evaluations)
            sizes = [short(size) for size in point.errors[STATE][: 1 + on_the_way]] if point.errors else [point.remark]
            rows.append([curve.title, str(point.steps), spent, *sizes, *[""] * (len(rows[0]) - 3 - len(sizes))])
    return rows
