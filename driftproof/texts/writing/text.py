"""Answers and scenes as plain text: what the command line prints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from driftproof.methods.catalogue import METHODS
from driftproof.methods.families import FAMILIES as PARAMETRIC
from driftproof.methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from driftproof.numeric.scenes import Scene
from driftproof.support.plain_text import table

# An exact form longer than this is left to --format json.
LONGEST_SHOWN = 24


def answer_text(answer: dict[str, Any]) -> str:
    """The answer of `driftproof step` or `driftproof run`, as a titled table."""
    start = ", ".join(answer["start"])
    steps = f"{answer['steps']} steps" if "steps" in answer else "one step"
    until = f" to t = {answer['t']}" if "t" in answer else ""
    title = f"{answer['title']} ({answer['method']}): {steps} of h = {answer['h']} from ({start}){until}"
    rows = [row for name in _SHOWN if name in answer for row in _rows(name, answer[name])]
    return f"{title}\n\n{table(rows)}\n\n{answer['digits']} digits, rounded {answer['rounding']}, certified"


_SHOWN = (
    "final_state",
    "exact_state",
    "state_error",
    "energy",
    "energy_change",
    "phase_error",
    "steps",
    "evaluations",
)


def _rows(name: str, value: Any) -> list[list[str]]:
    label = name.replace("_", " ")
    if value is None:
        return [[label, "undefined at the origin", ""]]
    if isinstance(value, int):
        return [[label, str(value), ""]]
    if "decimal" not in value:
        return [row for component, part in value.items() for row in _rows(f"{label} {component}", part)]
    unit = f" {value['unit']}" if "unit" in value else ""
    exact = value["exact"] or ""
    short = f"exactly {exact}" if exact and exact != value["decimal"] and len(exact) <= LONGEST_SHOWN else ""
    return [[label, value["decimal"] + unit, short]]


FAMILIES = {RungeKutta: "Runge-Kutta", Collocation: "collocation", Splitting: "splitting", Nystrom: "Nyström"}


def methods_text() -> str:
    """The catalogue, families with a free parameter last: key, family, claimed order, title, source."""
    rows = [["method", "family", "order", "title", "source"]]
    for key, method in METHODS.items():
        rows.append([key, FAMILIES[type(method)], str(method.claimed_order), method.title, method.source])
    for key, family in PARAMETRIC.items():
        name = f"{FAMILIES[RungeKutta]} in {family.parameter}"
        rows.append([key, name, str(family.claimed_order), family.title, family.source])
    return table(rows, right=(2,))


def scenes_text(scenes: Sequence[Scene]) -> str:
    """The presets: name, selected method, h, steps."""
    rows = [["scene", "selected method", "h", "t", "steps"]]
    rows += [[scene.name, scene.selected, str(scene.h), str(scene.t), str(scene.steps)] for scene in scenes]
    return table(rows, right=(2, 3, 4))
