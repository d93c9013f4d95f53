"""A template rendered in a process of its own, with a time limit, and the difference from what a file holds."""

from __future__ import annotations

import difflib
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from driftproof.support.environment import require_package

TIME_LIMIT = 120.0  # in seconds
MEMORY_LIMIT = 2 * 10**9  # in bytes
# Files with more lines than this are not compared line by line.
MOST_LINES = 20_000


@dataclass(frozen=True)
class Rendered:
    """The text that a template becomes, and how many values it asked for."""

    text: str
    asked: int


def render(
    template: Path, output: Path, style: str | None = None, rounding: str | None = None, time_limit: float = TIME_LIMIT
) -> Rendered:
    """The text of a file `output` that is rendered from the template. Nothing is written.

    Raises ValueError with one line, which holds the place in the template wherever there is one; OSError for a
    template that cannot be read.
    """
    require_package("jinja2", "text", "templates need Jinja2")
    if not template.is_file():
        raise ValueError(f"{template}: {'no file' if template.exists() else 'No such file or directory'}")
    with template.open("rb") as file:
        line_end = "\r\n" if file.readline().endswith(b"\r\n") else "\n"
    names = {"template": str(template), "output": str(output)}
    order = {**names, "style": style, "rounding": rounding, "memory": MEMORY_LIMIT}
    answer = _ask_child(json.dumps(order), template, time_limit)
    if "problem" in answer:
        raise ValueError(answer["problem"])
    return Rendered(answer["text"].replace("\n", line_end), answer["asked"])


def _ask_child(order: str, template: Path, time_limit: float) -> dict[str, Any]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "PYTHONUTF8": "1"}
    try:
        done = subprocess.run(
            [sys.executable, "-m", "driftproof.texts.templates.child"],
            input=order,
            capture_output=True,
            encoding="utf-8",
            env=environment,
            timeout=time_limit,
        )
    except subprocess.TimeoutExpired:
        raise ValueError(
            f"{template}: not rendered within {time_limit:g} s; a loop or a question takes too long"
        ) from None
    if done.returncode:
        last = done.stderr.strip().rpartition("\n")[2]
        raise ValueError(f"{template}: the rendering ended with status {done.returncode}: {last}")
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def difference(output: Path, rendered: str, template: Path) -> str:
    """A unified diff from what the file holds to what its template renders; empty if they are the same."""
    try:
        held = output.read_bytes().decode("utf-8", errors="replace") if output.exists() else ""
    except OSError as error:
        raise ValueError(f"{output}: {error.strerror}") from None
    if held == rendered and output.exists():
        return ""
    old, new = held.splitlines(keepends=True), rendered.splitlines(keepends=True)
    if max(len(old), len(new)) > MOST_LINES:
        first = next(
            (i for i, pair in enumerate(zip(old, new, strict=False)) if pair[0] != pair[1]), min(len(old), len(new))
        )
        return f"{output}, line {first + 1}: not as {template} renders it"
    name = str(output) if output.exists() else f"{output} (which is not there)"
    lines = difflib.unified_diff(old, new, name, f"{output} as {template} renders it")
    return "".join(line if line.endswith("\n") else f"{line}\n\\ no end of line\n" for line in lines).rstrip("\n")
