"""A template rendered in an isolated process, within limits, and the difference from what a file holds."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path

from driftproof.support.environment import require_package
from driftproof.support.processes import Limits, ProcessEnded, ask_once

# No example of ours takes a second; a thousand questions take some.
RENDERING_SECONDS, RENDERING_MEMORY, LONGEST_RENDERED = 120.0, 2 * 10**9, 10**7


@dataclass(frozen=True)
class RenderedText:
    """The text that a template becomes, and how many values it asked for."""

    text: str
    asked: int


def render(
    template: Path,
    output: Path,
    style: str | None = None,
    rounding: str | None = None,
    time_limit: float = RENDERING_SECONDS,
) -> RenderedText:
    """The text of a file `output` that is rendered from the template. Nothing is written.

    Raises ValueError with one line, which holds the place in the template wherever there is one; OSError for a
    template that cannot be read.
    """
    require_package("jinja2", "text", "templates need Jinja2")
    with template.open("rb") as file:
        line_end = "\r\n" if file.readline().endswith(b"\r\n") else "\n"
    order = {"template": str(template), "output": str(output), "style": style, "rounding": rounding}
    limits = Limits(seconds=time_limit, memory=RENDERING_MEMORY, answer=LONGEST_RENDERED)
    try:
        answer = ask_once("driftproof.texts.templates.template:render_order", order, limits)
    except ProcessEnded as ended:
        late = f"not rendered within {time_limit:g} s; a loop or a question takes too long"
        raise ValueError(f"{template}: {late if ended.cause == 'time' else ended}") from None
    if "problem" in answer:
        raise ValueError(answer["problem"])
    return RenderedText(answer["text"].replace("\n", line_end), answer["asked"])


def output_difference(output: Path, rendered: str, template: Path) -> str:
    """A unified diff from what the file holds to what its template renders; empty if they are the same."""
    held = output.read_bytes().decode("utf-8", errors="replace") if output.exists() else ""
    if held == rendered and output.exists():
        return ""
    old, new = held.splitlines(keepends=True), rendered.splitlines(keepends=True)
    name = str(output) if output.exists() else f"{output} (which is not there)"
    lines = difflib.unified_diff(old, new, name, f"{output} as {template} renders it")
    return "".join(line if line.endswith("\n") else f"{line}\n\\ no end of line\n" for line in lines).rstrip("\n")
