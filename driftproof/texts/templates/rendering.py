"""Render a template in a separate process with limits, and compare the result with the output file."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path

from driftproof.support.environment import require_package
from driftproof.support.files import atomic_write, read_utf8
from driftproof.support.plain_text import as_json, counted
from driftproof.support.processes import Limits, ProcessEnded, ask_once
from driftproof.support.results import Printable
from driftproof.texts.templates.text_kinds import LARGEST_TEMPLATE

# Chosen: examples take less than one second, a thousand questions some seconds.
RENDERING_SECONDS, RENDERING_MEMORY, LONGEST_RENDERED = 120.0, 2 * 10**9, 10**7
TEMPLATE_SUFFIX = ".j2"


@dataclass(frozen=True, repr=False)
class RenderedText(Printable):
    """The rendered text of a template, the number of values that it asked for, and the output file."""

    text: str
    asked: int
    template: Path
    output: Path

    def write(self) -> str:
        """Write the output file atomically; return a line with the number of values and of changed lines."""
        told = str(self)
        with atomic_write(self.output) as draft:
            Path(draft).write_bytes(self.text.encode("utf-8"))
        return told

    def difference(self) -> str:
        """A unified diff from the present content of the output file to the text; empty if they are equal."""
        held = self.output.read_bytes().decode("utf-8", errors="replace") if self.output.exists() else ""
        old, new = held.splitlines(keepends=True), self.text.splitlines(keepends=True)
        name = str(self.output) if self.output.exists() else f"{self.output} (does not exist)"
        lines = difflib.unified_diff(old, new, name, f"{self.output} as {self.template} renders it")
        return "".join(line if line.endswith("\n") else f"{line}\n\\ no end of line\n" for line in lines).rstrip("\n")

    def written(self, form: str) -> str:
        """The output file with the numbers of values and changed lines, as "text"; as "json" with the rendered text."""
        if form == "json":
            return as_json({"output": str(self.output), "values": self.asked, "text": self.text})
        signs = [line[0] for line in self.difference().splitlines()[2:]]
        lines = f", {max(map(signs.count, '+-'))} of its lines changed" if self.output.exists() else ""
        return f"{self.output}: {counted(self.asked, 'value')}{lines}"


def render(
    template: str | Path,
    output: str | Path | None = None,
    style: str | None = None,
    rounding: str | None = None,
    time_limit: float = RENDERING_SECONDS,
) -> RenderedText:
    """Render a template as the text for the file `output`, by default the template's name without .j2.

    The file is written only by the method `write` of the result. `style` is "plain" or "printed", `rounding` a policy
    for ties. Needs the extra `text`. Raises ValueError, with one line that names the place in the template if it is
    known.

    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from driftproof import render
    >>> with TemporaryDirectory() as folder:
    ...     lesson = Path(folder) / "lesson.md.j2"
    ...     _ = lesson.write_text("q = {{ value('step rk4 h=1/2 : q') }}")
    ...     render(lesson).text
    'q = 337/384'
    """
    template, output = Path(template), output_of(template, output)
    require_package("jinja2", "text", "templates need Jinja2")
    first, feed, _ = read_utf8(template, LARGEST_TEMPLATE).partition("\n")
    line_end = "\r\n" if feed and first.endswith("\r") else "\n"
    order = {"template": str(template), "output": str(output), "style": style, "rounding": rounding}
    limits = Limits(seconds=time_limit, memory=RENDERING_MEMORY, answer=LONGEST_RENDERED)
    try:
        answer = ask_once("driftproof.texts.templates.template:render_order", order, limits)
    except ProcessEnded as ended:
        late = f"not rendered within {time_limit:g} s; a loop or a question takes too long"
        raise ValueError(f"{template}: {late if ended.cause == 'time' else ended}") from None
    if "problem" in answer:
        raise ValueError(answer["problem"])
    return RenderedText(answer["text"].replace("\n", line_end), answer["asked"], template, output)


def output_of(template: str | Path, output: str | Path | None = None) -> Path:
    """The output file, by default the template's name without .j2. Raises ValueError for a name without it."""
    if output is None and Path(template).suffix != TEMPLATE_SUFFIX:
        raise ValueError(f"{template}: the name does not end in {TEMPLATE_SUFFIX}; name the output with -o")
    return Path(template).with_suffix("") if output is None else Path(output)
