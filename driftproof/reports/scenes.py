"""Run a scene and show it: only what it names is computed, and only what that needs is imported."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from driftproof.methods.given_methods import GivenMethods, names_of
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.scenes import FIGURES, PRESETS, TABLE, Scene, SceneError, read_scene
from driftproof.reports.progress import count_steps
from driftproof.reports.scene_view import scene_json, scene_text, show_scene
from driftproof.support.files import require_folder
from driftproof.support.plain_text import table, unknown
from driftproof.support.results import Answered


def scene_given(given: str | Path | Scene) -> Scene:
    """The scene itself, a preset, or the scene in a .toml file, on a problem of ours or your own. Raises ValueError."""
    if isinstance(given, Scene):
        return given
    name = str(given)
    if name in PRESETS:
        return PRESETS[name]
    if not name.endswith(".toml"):
        raise SceneError(unknown("scene", name, PRESETS, "`driftproof scene` lists them; a file ends in .toml"))
    return read_scene(Path(name), _problem)


def _problem(name: str) -> Problem:
    from driftproof.reports.user_problem import problem_given

    return problem_given(name)


def scene(
    name: str | Path | Scene | None = None,
    *,
    methods: GivenMethods = (),
    figures: str | Path | None = None,
) -> Answered:
    """A preset, or a scene of your own, run in floats: the readouts and the table that it asks for.

    `methods` replace those of the scene: the first is shown, all are compared. Without a name, the presets are listed:
    the method shown, h, t and the number of steps. `found` has the results as numbers; `figures` names a folder
    for the scene's figures, as SVG. Raises ValueError.

    >>> from driftproof import scene
    >>> scene("stability_boundary").found["readouts"]["final_state"]
    (-11.0, -10.0)
    """
    if name is None:
        header = ("scene", "selected", "h", "t", "steps")
        rows = [[x.name, x.selected, str(x.h), str(x.t), str(x.steps)] for x in PRESETS.values()]
        listed = [dict(zip(header, row, strict=True)) for row in rows]
        return Answered(listed, lambda _: table([header, *rows], right=(2, 3, 4)))
    about = scene_given(name)
    keys, own = names_of(methods)
    if keys:
        panels = tuple(dict.fromkeys((*about.panels, TABLE)))
        about = replace(about, selected=keys[0], methods=tuple(keys), own=own, panels=panels)
    if figures is not None:
        if not {*FIGURES} & {*about.panels}:
            raise ValueError(f"scene {about.name!r} has no figure to draw: give panels {' or '.join(FIGURES)}")
        require_folder(Path(figures))
    shown, wrote = show_scene(about, count_steps), ""
    if figures is not None:
        from driftproof.reports.page.trajectory import write_figures

        wrote = "\n".join(f"wrote {path}" for path in write_figures(about, Path(figures)))
    text = "\n\n".join(filter(None, [scene_text(about, shown), wrote]))
    return Answered(scene_json(about, shown), lambda _: text, shown)
