"""Answers and scenes as plain text: what the command line prints."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from methods.catalogue import METHODS
from methods.families import FAMILIES as PARAMETRIC
from methods.schemes import Collocation, Nystrom, RungeKutta, Splitting
from numeric.scenes import Scene

# An exact form longer than this is left to --format json.
LONGEST_SHOWN = 24
# A float of this size or more is shown with an exponent.
LARGEST_PLAIN = 1e9


def as_json(answer: Any) -> str:
    """Canonical JSON: keys sorted, one line per value, byte-stable from run to run."""
    return json.dumps(answer, indent=1, sort_keys=True, ensure_ascii=False)


def table(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Rows as aligned columns, two spaces apart; the columns in `right` are aligned right."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    padded = (
        [cell.rjust(widths[i]) if i in right else cell.ljust(widths[i]) for i, cell in enumerate(row)] for row in rows
    )
    return "\n".join("  ".join(cells).rstrip() for cells in padded)


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


def with_digits(x: float, digits: int) -> str:
    """So many significant digits, zeros at the end among them; an exponent as in 1.5e-7, below 1e-4 and above them."""
    mantissa, _, exponent = f"{x:#.{digits}g}".partition("e")
    return mantissa.removesuffix(".") + (f"e{int(exponent)}" if exponent else "")


def short(x: float) -> str:
    """Three decimals as the lesson's table shows them; two significant digits with an exponent below 1e-3, and beyond
    LARGEST_PLAIN.
    """
    if x == 0 or 1e-3 <= abs(x) < LARGEST_PLAIN:
        return f"{x:.3f}"
    mantissa, exponent = f"{x:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"
