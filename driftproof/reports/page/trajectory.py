"""The figures of a run: position over time, and the phase plane at equal scales, with the exact motion.

A page shows them, and `write_figures` writes the same pictures as files of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np

from driftproof.numeric.readouts import TRAJECTORY, FloatState, exact_state
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import Scene
from driftproof.reports.page.figure import Figure
from driftproof.reports.page.markup import details, html_table
from driftproof.reports.page.plot import COLUMNS_OF_PIXELS, SQUARE, WIDE, Plot, label, linear, symmetric_limit
from driftproof.reports.scene_view import asking_for
from driftproof.support.plain_text import counted

# A drawn run is kept whole in memory, which the samples of a longer one would fill.
MOST_DRAWN_STEPS = 10**6
# More than MOST_DOTS samples are drawn without dots, which would cover the line; more than MOST_MARKS are thinned.
MOST_DOTS, MOST_MARKS = 400, 4000
MOST_ROWS = 200
_DOTTED, _LINE = "dotted samples", "line samples path"
# Points of the exact curve: a chord over 1/24 radian is off the circle by 2e-4 of its radius.
_PER_RADIAN, _MOST_CURVE_POINTS = 24, 10**6


@dataclass(frozen=True)
class SampledRun:
    """The samples of a method in a scene: times of shape (N + 1), states of shape (N + 1, 2); `identity` begins ids."""

    scene: Scene
    key: str
    times: Any
    states: Any
    identity: str

    @property
    def start(self) -> FloatState:
        """The start, in floats."""
        q, v = map(float, self.scene.start)
        return q, v

    @property
    def radius(self) -> float:
        """The distance from the origin, which the exact motion keeps."""
        return hypot(*self.start)

    @property
    def exact(self) -> Any:
        """The exact states at the times of the samples, of shape (N + 1, 2)."""
        return np.column_stack(exact_state(self.start, self.times))

    @property
    def thin(self) -> bool:
        """True if not every sample has a mark of its own."""
        return len(self.times) > MOST_DOTS

    @property
    def method(self) -> str:
        """The title of the method."""
        return self.scene.method(self.key).title

    def data(self, component: int) -> list[list[str]]:
        """Step, time, computed and exact value of the samples; of a long run, of at most MOST_ROWS and the last."""
        name, kept = "qv"[component], evenly_spaced(len(self.times), MOST_ROWS)
        columns = (kept, self.times[kept], self.states[kept, component], self.exact[kept, component])
        rows = [[str(i), f"{t:.6g}", _number(x), _number(y)] for i, t, x, y in zip(*columns, strict=True)]
        return [["step", "t", f"computed {name}", f"exact {name}"], *rows]

    def samples_table(self) -> str:
        """The samples as tables, for a scene that asks for them but for no figure."""
        titles = (f"Positions, {self.method}", f"Velocities, {self.method}")
        return "".join(details(title, html_table(self.data(i), title)) for i, title in enumerate(titles))


def position(run: SampledRun) -> Figure:
    """q against t: samples joined by straight segments, the exact curve dashed. The q axis ends just beyond both."""
    reach = symmetric_limit(Fraction(max(run.radius, float(np.abs(run.states[:, 0]).max()))))
    low, high = sorted((Fraction(0), run.scene.t)) if run.scene.t else (Fraction(0), Fraction(1))
    plot = Plot(linear(low, high, "time t", WIDE[0]), linear(-reach, reach, "position q", WIDE[1]))
    kept = downsample(run.states[:, 0], COLUMNS_OF_PIXELS) if run.thin else np.arange(len(run.times))
    samples = list(zip(run.times[kept], run.states[kept, 0], strict=True))
    dense = " dense" if run.thin else ""
    plot.line(samples, f"samples path{dense}")
    plot.line(_exact_curve(run), f"exact path{dense}")
    if not run.thin:
        plot.dots(samples, "samples dots")
    return Figure(
        identity=f"{run.identity}-position",
        kind="wide",
        title=f"Position against time: {run.method}",
        description=f"Position q from t = 0 to {run.scene.t}, axis from {label(-reach)} to {label(reach)}. "
        f"Dashed: the exact motion. {_joined(run)} The run ends at q = {_number(run.states[-1, 0])}, "
        f"the exact motion at q = {_number(run.exact[-1, 0])}.",
        plot=plot,
        legend=[("line exact path", "exact"), (_LINE if run.thin else _DOTTED, "computed")],
        note=f"{len(run.times) - 1} steps, joined by straight segments."
        + (" Only the extremes of each column of pixels are drawn." if run.thin else ""),
        data=run.data(0),
        data_title=f"Positions, {run.method}",
    )


def phase_plane(run: SampledRun) -> Figure:
    """v against q at one scale for both axes, with the exact circle dashed and both final states marked."""
    reach = symmetric_limit(Fraction(max(run.radius, float(np.abs(run.states).max()))))
    plot = Plot(linear(-reach, reach, "position q", SQUARE[0]), linear(-reach, reach, "velocity v", SQUARE[1]))
    mark, drawn = _draw_path(plot, run, float(2 * reach / (SQUARE[0][1] - SQUARE[0][0])))
    plot.circle(run.radius, "exact path")
    if not run.thin:
        plot.dots(map(tuple, run.states), "samples dots")
    computed, exact = run.states[-1], run.exact[-1]
    sense = "clockwise" if run.scene.t >= 0 else "anticlockwise"
    plot.disc(tuple(exact), 6, "exact end", f"exact final state {_pair(exact)}")
    plot.disc(tuple(computed), 4, "samples end", f"computed final state {_pair(computed)}")
    return Figure(
        identity=f"{run.identity}-phase_plane",
        kind="square",
        title=f"Phase plane: {run.method}",
        description=f"Velocity v against position q, both axes from {label(-reach)} to {label(reach)} at equal scale. "
        f"Dashed: the exact path, a circle of radius {_number(run.radius)}, run {sense}. {drawn} "
        f"Open ring: the exact final state {_pair(exact)}. Solid disc: the computed final state {_pair(computed)}.",
        plot=plot,
        legend=[
            ("line exact path", "exact"),
            (mark, "computed"),
            ("end exact end", "exact end"),
            ("end samples end", "computed end"),
        ],
        note=f"Both axes have the same scale; the radius of the circle is {_number(run.radius)}.",
        data=run.data(1),
        data_title=f"Velocities, {run.method}",
    )


DRAWN: dict[str, Callable[[SampledRun], Figure]] = {"position": position, "phase_plane": phase_plane}


def write_figures(scene: Scene, folder: Path) -> list[Path]:
    """Write the figures that the scene names as SVG files into `folder`, each whole or not at all, with stable bytes.

    Raises ValueError as `require_drawable`, and as `run_method` does.
    """
    require_drawable(scene)
    times, states = run_method(asking_for(scene, (TRAJECTORY,)), scene.selected)[TRAJECTORY]
    sampled = SampledRun(scene, scene.selected, times, states, scene.name)
    panels = [panel for panel in scene.panels if panel in DRAWN]
    return [DRAWN[name](sampled).write(folder / f"{scene.name}_{name}.svg", setting(scene)) for name in panels]


def require_drawable(scene: Scene) -> None:
    """Raise ValueError for a scene of more than MOST_DRAWN_STEPS steps."""
    if scene.steps > MOST_DRAWN_STEPS:
        raise ValueError(f"scene {scene.name!r}: {scene.steps} steps are too many to draw; at most {MOST_DRAWN_STEPS}")


def setting(scene: Scene) -> str:
    """Start, step, end and number of steps of the scene, in words."""
    q, v = scene.start
    steps = counted(scene.steps, "step")
    return f"start ({q}, {v}), h = {scene.h}, t = {scene.t}, {steps}"


def _exact_curve(run: SampledRun) -> list[tuple[float, float]]:
    turned = abs(float(run.scene.t)) * _PER_RADIAN
    fine = np.linspace(0, float(run.scene.t), int(min(max(turned, _PER_RADIAN), _MOST_CURVE_POINTS)) + 1)
    q = exact_state(run.start, fine)[0]
    kept = downsample(q, COLUMNS_OF_PIXELS)
    return list(zip(fine[kept], q[kept], strict=True))


def _draw_path(plot: Plot, run: SampledRun, pixel: float) -> tuple[str, str]:
    """Draw the samples: all, joined; of a long run those a pixel apart, joined; or, if these are too many, specks.

    Returns the mark for the legend, and a sentence on what has been drawn.
    """
    if not run.thin:
        plot.line(map(tuple, run.states), "samples path")
        return _DOTTED, _joined(run)
    kept = one_per_square(run.states, pixel)
    if len(kept) <= MOST_MARKS:
        plot.line(map(tuple, run.states[kept]), "samples path")
        return _LINE, _joined(run)
    kept = evenly_spaced(len(run.states), MOST_MARKS)
    plot.dots(map(tuple, run.states[kept]), "samples specks")
    return "line samples specks", f"Small dots: {len(kept)} of {len(run.states)} computed samples, not joined."


def _joined(run: SampledRun) -> str:
    marks = "Solid" if run.thin else "Dots on a solid line"
    return f"{marks}: {len(run.times)} computed samples, joined by straight segments."


def _number(x: float) -> str:
    return f"{x:z.6g}" if abs(x) >= 10**6 else f"{x:z.6f}"


def _pair(state: Any) -> str:
    return f"({_number(state[0])}, {_number(state[1])})"


def downsample(values: Any, columns: int) -> Any:
    """Indices of the first, the least, the largest and the last sample in each of `columns` equal parts.

    Joined by segments they cover in each column of pixels what all samples cover, if columns are pixels wide
    (jugel-et-al-2014, the aggregation M4). All samples are kept if there are at most four per column.
    """
    if len(values) <= 4 * columns:
        return np.arange(len(values))
    ends = np.linspace(0, len(values), columns + 1).astype(int)
    kept = set()
    for start, end in pairwise(ends):
        part = values[start:end]
        kept |= {start, start + int(part.argmin()), start + int(part.argmax()), end - 1}
    return np.array(sorted(kept))


def one_per_square(states: Any, distance: float) -> Any:
    """Indices of the first and last sample, and of each in another square of side `distance` than its predecessor."""
    cells = np.floor(states / distance)
    left = np.any(cells[1:] != cells[:-1], axis=1)
    return np.unique(np.concatenate([[0], np.flatnonzero(left) + 1, [len(states) - 1]]))


def evenly_spaced(count: int, most: int) -> Any:
    """At most `most` of `count` indices, equally far apart, and the last one with them."""
    apart = -(-count // most)
    return np.unique(np.append(np.arange(0, count, apart), count - 1))
