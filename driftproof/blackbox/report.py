"""Reports on a stepper or a solver: text for a terminal, Markdown for an issue, JSON for a program."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from driftproof.support.plain_text import Json, as_json, printable
from driftproof.support.results import Printable

# How a verdict begins if it says no more than this.
UNDECIDED, NO_ANSWER = "undecided", "gives no answer"
NOT_KNOWN = "it is not a known method"


def verification(name: str) -> str:
    """The command that verifies a stepper, up to its method; one that no import finds has to be given a name first."""
    named, first = name, ""
    if "<" in name:
        named, first = f"{name.partition(':')[0]}:NAME", "give it a NAME in its module, then "
    return f"{first}driftproof verify {named} --method"


def refusal(key: str, mistakes: Sequence[str], why: str = "", on: str = "") -> str:
    """The verdict on what is not the method, with the first of the mistakes that give its steps, or why alone."""
    if not mistakes:
        return f"is not {key}: {why}"
    return "; ".join(filter(None, [f"is not {key}", f"it is {key}{on} with one mistake: {mistakes[0]}", why]))


class Basis(Enum):
    """What a stepper is named by: coefficients, all but a few of them, its linear steps only, or nothing."""

    KNOWN, ADDED, NEAR, LINEAR_ONLY, UNKNOWN, UNDECIDED, NO_ANSWER = range(7)  # ADDED: known, and more is to be said

    @property
    def answered(self) -> bool | None:
        """Whether it names a method; None if that is undecided."""
        return None if self is Basis.UNDECIDED else self not in (Basis.UNKNOWN, Basis.NO_ANSWER)


class Naming(NamedTuple):
    """A verdict: its basis, its words, the keys of all methods in it, and whether it has a reservation.

    `variant` is how the words go on if they are "it is KEY, " of the first method, `differences` are its coefficients
    that they call wrong, and `parted` is True if they speak of several steps of parts of h.
    """

    basis: Basis
    words: str
    methods: tuple[str, ...] = ()
    reserved: bool = False
    variant: str = ""
    differences: tuple[str, ...] = ()
    parted: bool = False


@dataclass(frozen=True)
class Section:
    """Lines under a heading; a `brief` that is not empty replaces them unless everything is asked for."""

    title: str
    lines: tuple[str, ...]
    brief: str = ""

    def shown(self, everything: bool) -> tuple[str, ...]:
        """All lines, or the brief one instead."""
        return self.lines if everything or not self.brief else (self.brief,)


@dataclass(frozen=True, repr=False)
class Report(Printable):
    """The verdict on a stepper in one line, whether it passed, and the sections that say why.

    `passed` is None if that is undecided, or if no method was given to compare with. Where none was, `answered` is True
    if the verdict names a method, exactly or nearly; False if it names none, and None if that is undecided. `data` is
    for programs, with floats as strings.
    """

    target: str
    verdict: str
    passed: bool | None
    sections: tuple[Section, ...]
    data: dict[str, Json] = field(default_factory=dict)
    answered: bool | None = True

    def section(self, title: str) -> Section | None:
        """The section with this title; None if there is none."""
        return next((section for section in self.sections if section.title == title), None)

    def text(self, everything: bool = False) -> str:
        """The report for a terminal, in which control characters from the stepper are spelled out."""
        parts = [f"{self.target}\n  {self.verdict}"]
        for section in self.sections:
            parts.append("\n  ".join([section.title, *section.shown(everything)]))
        return printable("\n\n".join(parts))

    def markdown(self, everything: bool = False) -> str:
        """The report for an issue or a pull request."""
        parts = [f"### `{self.target}`: {_escaped(self.verdict)}"]
        for section in self.sections:
            lines = "\n".join(f"- {_escaped(line)}" for line in section.shown(everything))
            parts.append(f"**{section.title}**\n\n{lines}")
        return "\n\n".join(parts)

    def written(self, form: str, everything: bool = False) -> str:
        """The report as "text", "markdown" or "json"; JSON always holds everything."""
        if form == "json":
            return as_json({"target": self.target, "verdict": self.verdict, "passed": self.passed, **self.data})
        return {"text": self.text, "markdown": self.markdown}[form](everything)


def sections(*parts: tuple[str, Sequence[str]]) -> tuple[Section, ...]:
    """A section for each part that has lines."""
    return tuple(Section(title, tuple(lines)) for title, lines in parts if lines)


def without_duplicates(lines: Iterable[str]) -> list[str]:
    """The lines without duplicates, each repeated one with its count."""
    return [f"{line} ({often} times)" if often > 1 else line for line, often in Counter(lines).items()]


def _escaped(line: str) -> str:
    """The text as Markdown shows it verbatim, in one line: nothing emphasised, no tag and no table begun."""
    return "".join(f"\\{c}" if c in "\\*_|`<[~&" else c for c in " ".join(printable(line).splitlines()))


@dataclass(frozen=True)
class Criterion:
    """One criterion of a comparison with a method: whether it passed, None if that is open, and what was seen.

    `missing` says what would decide it; it is empty if the calls of the stepper do not allow the question.
    """

    title: str
    passed: bool | None
    lines: tuple[str, ...]
    data: dict[str, Json]
    missing: str = ""

    @property
    def mark(self) -> str:
        """The outcome in at most two words."""
        return {True: "passed", False: "FAILED", None: "undecided" if self.missing else "not tested"}[self.passed]


def criteria_parts(
    checks: Sequence[Criterion], passed: bool | None
) -> tuple[list[tuple[str, Sequence[str]]], dict[str, Json]]:
    """The criteria as titles with lines, and as data for programs; if `passed` is None, with what would decide them.

    Criteria that are open, or failed, for the same reason share a title.
    """
    alike: dict[tuple[str, tuple[str, ...]], list[Criterion]] = {}
    for check in checks:
        alike.setdefault((check.mark, check.lines), []).append(check)
    parts: list[tuple[str, Sequence[str]]] = [
        (f"{', '.join([first.title, *(check.title.lower() for check in rest)])}: {first.mark}", first.lines)
        for first, *rest in alike.values()
    ]
    if passed is None:
        missing = [f"{check.title.lower()}: {check.missing}" for check in checks if check.mark == "undecided"]
        parts.append(("What would decide it", missing))
    data: dict[str, Json] = {
        check.title.lower().replace(" ", "_"): {"passed": check.passed, "seen": list(check.lines), **check.data}
        for check in checks
    }
    return parts, data
