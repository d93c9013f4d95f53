"""A scene, run and shown as text or JSON: its readouts and its table of methods, and nothing that it does not name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import MethodError
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.readouts import ENERGY_ERROR, LARGEST_CHANGE, LARGEST_ERROR, LARGEST_STATE_ERROR
from driftproof.numeric.run import Counter, Readouts, RunEnded
from driftproof.numeric.scene_run import run_scene
from driftproof.numeric.scenes import TABLE, Scene, compared_readouts
from driftproof.numeric.sweep import strings
from driftproof.support.plain_text import LARGEST_PLAIN, short, table, with_digits

# Those of an oscillator's scene, as in the lesson; of a problem, with the largest on the way.
COMPARED_READOUTS = ("state_error", "energy_change", "evaluations")
# Digits of the components of a problem's state.
_DIGITS = 6
UNDEFINED = "undefined at the origin"
# Characters of a message in a cell, about as many as a title has.
_LONGEST_CELL = 40


def show_scene(scene: Scene, counter: Counter = range) -> dict[str, Any]:
    """{"readouts", "table"} of the scene, each present only if the scene asks for it.

    A method whose run overflows, or that does not apply to the problem, has the message in the place of its readouts;
    the others are still shown.
    """
    shown: dict[str, Any] = {}
    if scene.readouts:
        shown["readouts"] = runs_of(scene, scene.readouts, [scene.selected], counter)[scene.selected]
    if TABLE in scene.panels:
        shown["table"] = runs_of(scene, _compared(scene), scene.methods, counter)
    return shown


def _compared(scene: Scene) -> tuple[str, ...]:
    """The readouts in the table of methods."""
    if scene.problem is None:
        return COMPARED_READOUTS
    return compared_readouts(scene.problem)


def runs_of(
    scene: Scene, readouts: Iterable[str], keys: Iterable[str], counter: Counter = range
) -> dict[str, Readouts | str]:
    """The named readouts of the scene's run by each of the methods, or the message if the run fails."""
    asked, found = asking_for(scene, readouts), dict[str, Readouts | str]()
    for key in keys:
        try:
            found[key] = run_scene(asked, key, counter)
        except (RunEnded, MethodError) as stopped:
            found[key] = str(stopped)
    return found


def scene_json(scene: Scene, shown: dict[str, Any]) -> dict[str, Any]:
    """The shown scene with every number a string: repr for floats, so that they read back to the same bits."""
    header: dict[str, Any] = {name: getattr(scene, name) for name in ("selected", "h", "t")}
    header |= {"start": scene.start}
    if scene.problem is not None:  # its title names the values of its parameters
        header |= {"problem": scene.problem.key, "title": scene.problem.title, "start": scene.problem.start}
    header |= {"started": starts} if (starts := starts_of(scene)) else {}
    return dict(strings({"scene": scene.name, **header, **shown}))


def scene_text(scene: Scene, shown: dict[str, Any]) -> str:
    """The readouts with the lesson's labels and digits, then the table of methods."""
    of = f" on {scene.problem.title}" if scene.problem else ""
    title = f"{scene.method(scene.selected).title}{of}, h = {scene.h}, t = {scene.t}"
    parts = [f"{scene.name}: {title}"]
    if "readouts" in shown:
        readouts = shown["readouts"]
        parts.append(readouts if isinstance(readouts, str) else table(readout_rows(readouts, scene.problem)))
    if "table" in shown:
        rows, remarks = comparison_rows(scene, shown["table"])
        compared = "\n\n".join([table(rows, right=range(1, len(rows[0]))), *remarks])
        parts.append(f"All methods at h = {scene.h}, measured at t = {scene.t}\n\n{compared}")
    parts += [scene.problem.energy_note] if scene.problem and scene.problem.energy_note else []
    parts += [f"First values of {scene.method(key).title}: steps of {start}" for key, start in starts_of(scene).items()]
    return "\n\n".join(parts)


def starts_of(scene: Scene) -> dict[str, str]:
    """The key of the method that gives first values, for each multistep method of the scene."""
    several = {key: m for key in (scene.selected, *scene.methods) if isinstance(m := scene.method(key), Multistep)}
    if not several:
        return {}
    from driftproof.numeric.steps.multistep import start_of

    return {key: start_of(method).key for key, method in several.items()}


def asking_for(scene: Scene, readouts: Iterable[str]) -> Scene:
    """The same run with other readouts, and no panels."""
    return replace(scene, methods=(), readouts=tuple(readouts), panels=())


def _fixed(places: int) -> Callable[[float], str]:
    """The formatter with `places` places. A zero has no sign, not even one that rounding makes (the option z)."""
    return lambda x: f"{x:z.{places}f}" if abs(x) < LARGEST_PLAIN else f"{x:.{places}e}"


def _pair(shown: Callable[[float], str]) -> Callable[[Sequence[float]], str]:
    return lambda state: f"({', '.join(map(shown, state))})"


# Label and format of each readout, as the lesson shows them.
_SHOWN: dict[str, tuple[str, Callable[[Any], str]]] = {
    "final_state": ("Numerical (q, v)", _pair(_fixed(3))),
    "exact_state": ("Exact (q, v)", _pair(_fixed(3))),
    "state_error": ("State error", _fixed(6)),
    LARGEST_STATE_ERROR: ("Largest state error", _fixed(6)),
    "energy": ("Final energy", _fixed(6)),
    "energy_change": ("Energy change", _fixed(6)),
    LARGEST_CHANGE: ("Largest energy change", _fixed(6)),
    ENERGY_ERROR: ("Energy error", _fixed(6)),
    LARGEST_ERROR: ("Largest energy error", _fixed(6)),
    "phase_error": ("Wrapped phase error (degrees)", _fixed(3)),
    "steps": ("Steps", str),
    "evaluations": ("Acceleration evaluations", str),
    "trajectory": ("Trajectory", lambda path: f"{len(path[0])} samples (in --format json)"),
}


_components = _pair(lambda x: with_digits(x, _DIGITS))
# The same for a problem, whose components may be of any size.
_SHOWN_OF_PROBLEM: dict[str, tuple[str, Callable[[Any], str]]] = {
    "final_state": ("Numerical y", _components),
    "exact_state": ("Exact y", _components),
    **{name: (label, short) for name, (label, _) in _SHOWN.items() if "error" in name or "energy" in name},
    "evaluations": ("Evaluations of f", str),
}


def readout_rows(readouts: Readouts, problem: Problem | None = None) -> list[list[str]]:
    """Label and value of each readout, of the oscillator or of a problem."""
    known = _SHOWN | (_SHOWN_OF_PROBLEM if problem else {})
    shown = ((*known[name], value) for name, value in readouts.items())
    own = f"({', '.join(problem.unknowns)})" if problem and problem.unknowns else "y"
    return [
        [label.replace(" y", f" {own}"), UNDEFINED if value is None else show(value)] for label, show, value in shown
    ]


def comparison_rows(scene: Scene, rows: dict[str, Readouts | str]) -> tuple[list[list[str]], list[str]]:
    """The header of the table of methods, and a row for each; then remarks that stand below it.

    A run that failed has its message in the second cell, or below the table if it is long.
    """
    names, remarks = _compared(scene), list[str]()
    lines = [["Method", *("Calls" if name == "evaluations" else _SHOWN[name][0] for name in names)]]
    for key, readouts in rows.items():
        if isinstance(readouts, str):
            is_long, title = len(readouts) > _LONGEST_CELL, scene.method(key).title
            lines.append([title, "see below" if is_long else readouts, *[""] * (len(names) - 1)])
            remarks += [f"{title}: {readouts}"] * is_long
        else:
            cells = [x if isinstance(x := readouts[name], int) else short(x) for name in names]
            lines.append([scene.method(key).title, *map(str, cells)])
    return lines, remarks
