"""The figures of a scene: position over time, and the phase plane. Needs the extra `report`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.readouts import exact_state
from driftproof.numeric.scenes import Scene
from driftproof.support.files import whole

EXACT = {"color": "#1f6fb4", "linestyle": "--", "linewidth": 1.6, "label": "exact"}
NUMERICAL = {"color": "#c87a00", "marker": "o", "markersize": 3.5, "linewidth": 1.0, "label": "samples"}


def draw(panel: str, scene: Scene, trajectory: tuple[Any, Any], folder: Path) -> Path:
    """Write the figure `panel` of the scene as an SVG file into `folder` and return its path.

    The file appears whole or not at all, and is byte-stable from run to run.
    """
    times, states = trajectory
    with matplotlib.rc_context({"svg.hashsalt": "driftproof", "font.size": 11}):
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        axes = figure.add_subplot()
        _PANELS[panel](axes, scene, times, states)
        axes.set_title(f"{METHODS[scene.selected].title}, h = {scene.h}, t = {scene.t}")
        axes.grid(alpha=0.3)
        figure.legend(loc="outside lower center", ncols=4, frameon=False)
        path = folder / f"{scene.name}_{panel}.svg"
        save(figure, path)
    return path


def _position(axes: Any, scene: Scene, times: Any, states: Any) -> None:
    fine = np.linspace(times[0], times[-1], 801)
    axes.plot(fine, _exact(scene, fine)[0], **EXACT)
    axes.plot(times, states[:, 0], **NUMERICAL)
    axes.set_xlabel("time t")
    axes.set_ylabel("position q")


def _phase_plane(axes: Any, scene: Scene, times: Any, states: Any) -> None:
    q_end, v_end = _exact(scene, times[-1])
    axes.plot(*_exact(scene, np.linspace(0, 2 * np.pi, 401)), **EXACT)
    axes.plot(states[:, 0], states[:, 1], **NUMERICAL)
    axes.plot(q_end, v_end, "o", markersize=10, fillstyle="none", color=EXACT["color"], label="exact end")
    axes.plot(*states[-1], "o", markersize=8, color=NUMERICAL["color"], label="numerical end")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("position q")
    axes.set_ylabel("velocity v")


_PANELS = {"position": _position, "phase_plane": _phase_plane}


def _exact(scene: Scene, times: Any) -> Any:
    q, v = (float(x) for x in scene.start)
    return exact_state((q, v), times)


def save(figure: Figure, path: Path) -> None:
    """Write the figure whole or not at all, as the kind that the suffix names. Raises ValueError for any other name."""
    known = figure.canvas.get_supported_filetypes()
    if path.suffix[1:].lower() not in known:
        raise ValueError(f"{path}: the name of a picture ends in one of {', '.join(f'.{kind}' for kind in known)}")
    with whole(path) as draft:
        figure.savefig(draft, metadata={"Date": None})
