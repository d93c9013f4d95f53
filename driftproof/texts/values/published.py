"""The published values: every number the lesson prints, by stable id, proved by the proofs and kept in values.json."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

from driftproof.support.plain_text import as_json

# id -> {"exact": "337/384" or None, "decimal": digits, "printed": {claim id: text}, "evidence": ..., "statement": ...}
Values: TypeAlias = dict[str, dict[str, Any]]

VALUES_FILE = Path(__file__).with_name("values.json")
# The module for web pages; its line NO_VALUES is where the values go.
MODULE_FILE = Path(__file__).with_name("driftproof.mjs")
NO_VALUES = "export const values = {};"


@cache
def _document() -> dict[str, Any]:
    return dict(json.loads(VALUES_FILE.read_text(encoding="utf-8")))


def published_values(pattern: str = "*") -> Values:
    """The published values whose id matches the shell pattern, e.g. "rk4.*". Raises ValueError if none does."""
    values: Values = _document()["values"]
    chosen = {key: value for key, value in values.items() if fnmatchcase(key, pattern)}
    if not chosen:
        raise ValueError(f"no published value has an id that matches {pattern!r}; `driftproof values` lists them")
    return chosen


def render_values(values: Values, form: str) -> str:
    """The values in one of FORMATS; JSON is canonical, the others are renderings of it."""
    return FORMATS[form](values)


def _as_json(values: Values) -> str:
    return as_json({**_document(), "values": values})


def _as_markdown(values: Values) -> str:
    lines = ["| id | exact | decimal | printed |", "|---|---|---|---|"]
    for key, value in values.items():
        exact = f"`{value['exact']}`" if value["exact"] else ""
        lines.append(f"| `{key}` | {exact} | {value['decimal']} | {', '.join(_prints(value))} |")
    return "\n".join(lines)


def _as_tex(values: Values) -> str:
    """Definitions for a LaTeX document, which then says \\driftproof{id}."""
    from driftproof.texts.values.macros import values_tex

    return values_tex(values)


def _as_js(values: Values) -> str:
    """An ES module that holds the values, and rounds and shows them."""
    module = MODULE_FILE.read_text(encoding="utf-8")
    return module.replace(NO_VALUES, f"export const values = {as_json(values)};").rstrip("\n")


def _as_csv(values: Values) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["id", "exact", "decimal", "printed", "evidence"])
    for key, value in values.items():
        writer.writerow([key, value["exact"] or "", value["decimal"], " ".join(_prints(value)), value["evidence"]])
    return out.getvalue().rstrip("\n")


def _prints(value: dict[str, Any]) -> list[str]:
    return sorted(set(value["printed"].values()))


FORMATS: dict[str, Callable[[Values], str]] = {
    "json": _as_json,
    "md": _as_markdown,
    "tex": _as_tex,
    "js": _as_js,
    "csv": _as_csv,
}
