"""Scenes: what to run, from where, and which readouts and panels to compute. The lesson's presets, and a user's own.

>>> from driftproof import PRESETS
>>> PRESETS["default"].h, PRESETS["default"].steps
(Fraction(1, 4), 40)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from fractions import Fraction
from pathlib import Path

from driftproof.methods.catalogue import Entry
from driftproof.methods.given_methods import NamedMethods, entry_of, method_of
from driftproof.methods.numbers.rationals import parse_rational, step_count
from driftproof.methods.schemes import Method
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.readouts import ENERGY_ERROR, LARGEST_CHANGE, LARGEST_ERROR, LARGEST_STATE_ERROR, ON_THE_WAY
from driftproof.support.plain_text import unknown
from driftproof.support.toml_tables import TomlTable, as_list, as_text, as_texts, quoted, read_toml, require_keys

_OF_THE_END = ("final_state", "exact_state", "state_error", "energy", "energy_change", "phase_error")
_OF_PRESETS = (*_OF_THE_END, "steps", "evaluations")
READOUTS = (*_OF_PRESETS, ENERGY_ERROR, *ON_THE_WAY)
TABLE = "table"
FIGURES = ("position", "phase_plane")
# Panels about all methods of a scene: error against evaluations, and what is proved about their powers at this h.
WORK_PRECISION, STABILITY = "work_precision", "stability"
PANELS = (TABLE, *FIGURES, WORK_PRECISION, STABILITY)

# The largest step size that the lesson's slider offers. A user's own scenes may exceed it.
LARGEST_LESSON_H = Fraction(5, 2)
LONGEST_FILE = 65_536
_LESSON_START = (Fraction(1), Fraction(0))


class SceneError(ValueError):
    """A scene that cannot be run as described: an unknown name, no readout, or an h that does not divide t."""


@dataclass(frozen=True)
class Scene:
    """N = t/h steps of each method on q' = v, v' = -q from `start`, or on a problem from its start, and what to show.

    `selected` is the method whose readouts and figures are shown; `methods` are compared in the table panel. They are
    keys, files, and names of `own` methods. h, t and start are exact: Fractions. `readouts` are computed in floats,
    `panels` are drawn. Nothing else is computed. With a `problem`, t is one of its reference's times, and there are no
    phase errors or drawn panels. Raises SceneError.

    >>> from fractions import Fraction
    >>> from driftproof import Scene
    >>> Scene("mine", "rk4", Fraction(1, 4), Fraction(10), readouts=("energy",)).steps
    40
    """

    name: str
    selected: str
    h: Fraction
    t: Fraction
    start: tuple[Fraction, Fraction] = _LESSON_START
    methods: tuple[str, ...] = ()
    readouts: tuple[str, ...] = ()
    panels: tuple[str, ...] = ()
    problem: Problem | None = None
    own: NamedMethods = ()

    def __post_init__(self) -> None:
        """Raise SceneError for an unknown name, an empty request, or an h that does not divide t."""
        if Path(self.name).name != self.name:
            raise SceneError(f"scene {self.name!r}: the name must not contain a folder, as files are named after it")
        if not (self.readouts or self.panels):
            raise SceneError(f"scene {self.name!r} computes nothing; give readouts or panels")
        _check_names(self.name, "readout", self.readouts, READOUTS)
        _check_names(self.name, "panel", self.panels, PANELS)
        if TABLE in self.panels and not self.methods:
            raise SceneError(f"scene {self.name!r} has the panel table, but no methods to compare; give methods")
        if self.problem is not None:
            self._check_problem(self.problem)
        try:
            for key in (self.selected, *self.methods):
                self.method(key)
            step_count(self.t, self.h)
        except ValueError as error:
            raise SceneError(f"scene {self.name!r}: {error}") from None

    def _check_problem(self, problem: Problem) -> None:
        """Raise SceneError for what only the oscillator has, and for a time without a reference solution."""
        if self.start != _LESSON_START:
            raise SceneError(f"scene {self.name!r}: the problem fixes the start; remove `start`")
        there_are = [name for name in READOUTS if has(problem, name)]
        for what, names, allowed in (("readout", self.readouts, there_are), ("panel", self.panels, [TABLE])):
            if absent := [name for name in names if name not in allowed]:
                refusal = f"the problem {problem.key} has no {what} {absent[0]}; choose from {', '.join(allowed)}"
                raise SceneError(f"scene {self.name!r}: {refusal}")
        if self.t not in (times := problem.reference.times):
            more = "; another `end` in its file gives others" if problem.key.endswith(".toml") else ""
            known = ", ".join(map(str, times)) + more
            raise SceneError(f"scene {self.name!r}: the solution of {problem.key} is known only at t = {known}")

    def method(self, key: str | Path) -> Entry:
        """The method of this name; on the oscillator its step takes one state and f. Raises ValueError."""
        given = dict[str | Path, Method](self.own).get(key, key)
        return method_of(given) if self.problem is None else entry_of(given)

    @property
    def steps(self) -> int:
        """The number of steps N = t / h, exact."""
        return step_count(self.t, self.h)

    @property
    def every_method(self) -> tuple[str, ...]:
        """The methods compared, each once, after the selected one if it is not among them."""
        compared = tuple(dict.fromkeys(self.methods))
        return compared if self.selected in compared else (self.selected, *compared)


def compared_readouts(problem: Problem) -> tuple[str, ...]:
    """The readouts in which runs are compared: errors, changes of the energy or, if f changes it, its errors, calls."""
    energies = (ENERGY_ERROR, LARGEST_ERROR) if problem.energy_changes else ("energy_change", LARGEST_CHANGE)
    return tuple(name for name in ("state_error", LARGEST_STATE_ERROR, *energies, "evaluations") if has(problem, name))


def has(problem: Problem, readout: str) -> bool:
    """False for a readout of an energy or of the whole way, where the problem has none, or is known at few times."""
    if readout == LARGEST_STATE_ERROR:
        return problem.reference.dense is not None
    return readout != "phase_error" and (bool(problem.energy) or "energy" not in readout)


def _check_names(scene: str, what: str, names: tuple[str, ...], known: tuple[str, ...]) -> None:
    for name in names:
        if name not in known:
            raise SceneError(f"scene {scene!r}: {unknown(what, name, known)}")


def _lesson_scene(name: str, selected: str, h: Fraction, *panels: str) -> Scene:
    methods, shown = ("forward_euler", "symplectic_euler", "rk4"), (TABLE, *FIGURES, *panels)
    return Scene(name, selected, h, Fraction(10), methods=methods, readouts=_OF_PRESETS, panels=shown)


PRESETS: dict[str, Scene] = {
    scene.name: scene
    for scene in (
        _lesson_scene("default", "forward_euler", Fraction(1, 4), WORK_PRECISION, STABILITY),
        _lesson_scene("small_steps", "forward_euler", Fraction(1, 10), STABILITY),
        _lesson_scene("compare", "forward_euler", Fraction(1, 2), STABILITY),
        _lesson_scene("stability_boundary", "symplectic_euler", Fraction(2), STABILITY),
    )
}


def read_scene(path: Path, problem_of: Callable[[str], Problem] = problem_named) -> Scene:
    """Read a scene from a TOML file, its decimals exactly. Raises SceneError with one line that says where.

    `problem_of` returns the Problem that a file names; by default, it looks up a key of the catalogue.

    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from driftproof import read_scene
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "mine.toml"
    ...     _ = path.write_text('selected = "rk4"\\nh = 0.1\\nt = 10\\nreadouts = ["energy"]')
    ...     read_scene(path).h
    Fraction(1, 10)
    """
    return read_toml(path, LONGEST_FILE, lambda table: _scene(table, path.stem, problem_of), SceneError)


def _scene(table: TomlTable, name: str, problem_of: Callable[[str], Problem]) -> Scene:
    if "rates" in table or "function" in table:
        raise SceneError('it is a problem; write a scene with problem = "FILE.toml", selected, h and readouts')
    require_keys(table, tuple(field.name for field in fields(Scene) if field.name != "own"), "a scene")
    problem = problem_of(as_text(table["problem"], "problem")) if "problem" in table else None
    for key in ("selected", "h", *(() if problem else ("t",))):
        if key not in table:
            raise SceneError(f"{key!r} is missing")
    start = as_list(table.get("start", [1, 0]), "start", 2)
    return Scene(
        name=as_text(table.get("name", name), "name"),
        selected=as_text(table["selected"], "selected"),
        h=_rational(table["h"], "h"),
        t=problem.t if problem and "t" not in table else _rational(table["t"], "t"),
        start=(_rational(start[0], "start[0]"), _rational(start[1], "start[1]")),
        **{key: as_texts(table.get(key, []), key) for key in ("methods", "readouts", "panels")},
        problem=problem,
        own=(),
    )


def _rational(value: object, where: str) -> Fraction:
    if isinstance(value, int | str) and not isinstance(value, bool):
        return parse_rational(str(value), where)
    raise SceneError(f"{where} is {quoted(value)}; write a number or a quoted fraction like '1/4'")
