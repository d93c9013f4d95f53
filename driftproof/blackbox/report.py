"""What was found out about a stepper, as text for a terminal, Markdown for an issue, and JSON for a program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from driftproof.support.plain_text import Json, as_json, printable


@dataclass(frozen=True)
class Section:
    """Lines under a heading."""

    title: str
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Report:
    """The verdict on a stepper in one line, whether it passed what was asked, and the sections that say why.

    `passed` is None where that is undecided, or nothing was asked but what it is. `data` is the same for programs:
    numbers are strings.
    """

    target: str
    verdict: str
    passed: bool | None
    sections: tuple[Section, ...]
    data: dict[str, Json] = field(default_factory=dict)

    def section(self, title: str) -> Section | None:
        """The section with this title, if there is one."""
        return next((section for section in self.sections if section.title == title), None)

    def text(self) -> str:
        """The report for a terminal, over which what the stepper wrote has no say."""
        parts = [f"{self.target}\n  {self.verdict}"]
        parts += [f"{section.title}\n" + "\n".join(f"  {line}" for line in section.lines) for section in self.sections]
        return printable("\n\n".join(parts))

    def markdown(self) -> str:
        """The report for an issue or a pull request."""
        parts = [f"### `{self.target}`: {self.verdict}"]
        for section in self.sections:
            parts.append(f"**{section.title}**\n\n" + "\n".join(f"- {_escaped(line)}" for line in section.lines))
        return "\n\n".join(parts)

    def json(self) -> str:
        """The report for a program: canonical, keys sorted."""
        return as_json({"target": self.target, "verdict": self.verdict, "passed": self.passed, **self.data})

    def written(self, form: str) -> str:
        """The report as "text", "markdown" or "json"."""
        return {"text": self.text, "markdown": self.markdown, "json": self.json}[form]()

    def __str__(self) -> str:
        """As `text`."""
        return self.text()


def sections(*parts: tuple[str, Sequence[str]]) -> tuple[Section, ...]:
    """The sections that have lines."""
    return tuple(Section(title, tuple(lines)) for title, lines in parts if lines)


def _escaped(line: str) -> str:
    """The line as Markdown shows it verbatim: nothing emphasised, no table begun."""
    return "".join(f"\\{c}" if c in "*_|`<[" else c for c in line)
