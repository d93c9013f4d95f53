"""What came of holding a text to its claims: as text, JSON, and annotations that GitHub shows beside the lines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from driftproof.support.plain_text import as_json
from driftproof.texts.claims.checking import Finding, Outcome, check_claims
from driftproof.texts.claims.claims import Claims
from driftproof.texts.claims.coverage import GIVEN, LABEL, RUN, UNCOVERED, VALUE, Accounted, Coverage, coverage
from driftproof.texts.claims.running import Ran
from driftproof.texts.claims.suggestions import Candidate, Suggestions
from driftproof.texts.readers.document import Document, Position
from driftproof.texts.readers.numbers import TextNumber

# Characters of the text that are shown on each side of a number, and the values that are named of those it looks like.
CONTEXT, MOST_NAMED = 24, 3
# Uncovered numbers for which values are looked for.
MOST_LISTED = 5000
FORMATS = ("text", "json", "github")


@dataclass(frozen=True)
class Report:
    """A text called `file`, held to claims: the outcomes, the coverage, and what running its listings showed."""

    file: str
    document: Document
    outcomes: tuple[Outcome, ...]
    coverage: Coverage
    least_coverage: Fraction
    ran: Ran | None = None
    suggestions: Suggestions | None = field(default=None, compare=False)

    @classmethod
    def of(cls, file: str, document: Document, claims: Claims, ran: Ran | None = None, suggest: bool = False) -> Report:
        """The claims checked. With `suggest` it says which values each uncovered number looks like.

        Raises ValueError where a claim has no value, a label stands nowhere, or there is too much to suggest.
        """
        outcomes = tuple(check_claims(document, claims.claims))
        covered = coverage(document, outcomes, claims.labels, ran.spans if ran else ())
        if suggest and len(covered.uncovered) > MOST_LISTED:
            raise ValueError(f"{len(covered.uncovered)} numbers are not covered; at most {MOST_LISTED} are listed")
        suggestions = Suggestions(document.text.text) if suggest else None
        return cls(file, document, outcomes, covered, claims.coverage, ran, suggestions)

    @property
    def findings(self) -> list[Finding]:
        """Everything that is wrong, in the order of the file."""
        found = [finding for outcome in self.outcomes for finding in outcome.findings]
        found += self.ran.findings if self.ran else ()
        if self.coverage.share < self.least_coverage:
            least, share = _percent(self.least_coverage), _percent(self.coverage.share)
            place = self.document.position(self.coverage.uncovered[0].start)
            message = f"{share} of the numbers are covered, and {least} should be; this is the first that is not"
            found.append(Finding("coverage", place, least, share, message))
        return sorted(found, key=lambda finding: finding.place)

    @property
    def passed(self) -> bool:
        """True if nothing is wrong."""
        return not self.findings

    def written(self, form: str) -> str:
        """The report in one of FORMATS."""
        if form == "json":
            return as_json(self.as_dict())
        return "\n".join(self._annotations() if form == "github" else self._lines())

    def as_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "file": self.file,
            "passed": self.passed,
            "claims": {
                outcome.claim.id: {"count": outcome.claim.count, "found": len(outcome.occurrences)}
                for outcome in self.outcomes
            },
            "findings": [
                {
                    "claim": finding.claim,
                    "line": finding.place.line,
                    "column": finding.place.column,
                    "expected": finding.expected,
                    "found": finding.found,
                    "message": finding.message,
                }
                for finding in self.findings
            ],
            "listings": self.ran.count if self.ran else None,
            "coverage": {**self.coverage.counts, "share": _percent(self.coverage.share)},
            "numbers": [self._number_as_dict(accounted) for accounted in self.coverage.numbers],
        }

    def _number_as_dict(self, accounted: Accounted) -> dict[str, Any]:
        number, place = accounted.number, self.document.position(accounted.number.start)
        entry = {"text": number.text, "line": place.line, "column": place.column, "kind": accounted.kind}
        if accounted.kind != UNCOVERED:
            return {**entry, "by": accounted.by}
        entry["context"] = self._context(number)
        if self.suggestions:
            entry["looks_like"] = [candidate.question for candidate in self.suggestions.of(number)]
        return entry

    def _lines(self) -> Iterator[str]:
        for finding in self.findings:
            yield f"{self.file}:{finding.place.line}:{finding.place.column}: {finding.claim}: {finding.message}"
        if self.suggestions:
            yield from (self._uncovered_line(number) for number in self.coverage.uncovered)
        wrong = len({finding.claim for finding in self.findings})
        checked = _counted(len(self.outcomes), "claim")
        listings = f", {_counted(self.ran.count, 'listing')} run" if self.ran else ""
        verdict = f"{wrong} refuted" if wrong else "all hold" if self.outcomes or self.ran else "so nothing is held"
        yield f"{self.file}: {checked}{listings}, {verdict}"
        counts = self.coverage.counts
        ran = f", {counts[RUN]} by running" if counts[RUN] else ""
        yield (
            f"{_percent(self.coverage.share)} of {_counted(sum(counts.values()) - counts[LABEL], 'number')} covered: "
            f"{counts[VALUE]} by values, {counts[GIVEN]} given{ran}; {counts[UNCOVERED]} not; "
            f"and {_counted(counts[LABEL], 'label')}"
        )

    def _uncovered_line(self, number: TextNumber) -> str:
        line, column = self.document.position(number.start)
        assert self.suggestions is not None
        return (
            f"{self.file}:{line}:{column}: not covered: {self._context(number)!r}{_named(self.suggestions.of(number))}"
        )

    def _context(self, number: TextNumber) -> str:
        text = self.document.text.text
        start = max(text.rfind("\n", 0, number.start) + 1, number.start - CONTEXT)
        end = text.find("\n", number.end)
        return text[start : min(len(text) if end < 0 else end, number.end + CONTEXT)]

    def _annotations(self) -> Iterator[str]:
        for finding in self.findings:
            yield _annotation("error", self.file, finding.place, finding.claim, finding.message)
        if self.suggestions:
            for number in self.coverage.uncovered:
                message = f"no claim covers {number.text}{_named(self.suggestions.of(number))}"
                yield _annotation("notice", self.file, self.document.position(number.start), "coverage", message)


def _annotation(level: str, file: str, place: Position, title: str, message: str) -> str:
    """A workflow command of GitHub's, in which a few characters have to be escaped."""
    properties = {"file": file, "line": str(place.line), "col": str(place.column), "title": title}
    listed = ",".join(f"{key}={_escaped(value, ':,')}" for key, value in properties.items())
    return f"::{level} {listed}::{_escaped(message)}"


def _escaped(text: str, more: str = "") -> str:
    for character in "%\r\n" + more:
        text = text.replace(character, f"%{ord(character):02X}")
    return text


def _named(candidates: list[Candidate]) -> str:
    if not candidates:
        return ""
    named = ", ".join(candidate.question for candidate in candidates[:MOST_NAMED])
    more = f" and {len(candidates) - MOST_NAMED} more" if len(candidates) > MOST_NAMED else ""
    return f"; looks like {named}{more}"


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _percent(share: Fraction) -> str:
    """To a tenth, rounded down: 100% is said of nothing less."""
    tenths = int(share * 1000)
    return f"{tenths // 10}%" if tenths % 10 == 0 else f"{tenths // 10}.{tenths % 10}%"
