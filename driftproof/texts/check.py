"""Check a text against its claims, and report the result as text, JSON or GitHub annotations."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from os.path import isfile
from pathlib import Path
from shlex import quote
from typing import Any, Literal, overload

from driftproof.support.assertions import AssertedVerdict, assert_verdict
from driftproof.support.files import named_beside, read_utf8
from driftproof.support.plain_text import annotation, as_json, counted
from driftproof.support.results import Answered, Printable
from driftproof.texts.claims.checking import (
    Accounted,
    CheckedClaim,
    Coverage,
    Finding,
    check_claims,
    coverage,
    others_in_phrases,
)
from driftproof.texts.claims.claims import Claims, read_claims, refused_in
from driftproof.texts.claims.listings import Ran, run_listings
from driftproof.texts.drafts.drafting import Doubt, doubts_of, draft
from driftproof.texts.drafts.members import SLIP, problems_named_once
from driftproof.texts.drafts.suggestions import Suggestions
from driftproof.texts.readers.document import LARGEST_DOCUMENT, Document, read_document
from driftproof.texts.readers.number_words import TextWord
from driftproof.texts.readers.numbers import TextNumber

# Characters of context shown on each side of a number; look-alike values named for it.
_CONTEXT, _MOST_NAMED = 24, 3
# At most this many uncovered numbers are listed: the search for look-alikes takes about 1 ms each.
_MOST_LISTED = 5000
# At most this many unchecked words for numbers are shown.
_MOST_WORDS = 5


@dataclass(frozen=True, repr=False)
class TextReport(Printable):
    """The result of checking the text called `file`: checked claims, coverage, and the outcome of its listings.

    The `slips` are uncovered numbers, or words, that the draft of the claims calls perhaps wrong, with what it says.
    """

    file: str
    document: Document
    checked: list[CheckedClaim]
    coverage: Coverage
    least_coverage: Fraction
    ran: Ran | None = None
    suggestions: Suggestions | None = None
    slips: tuple[tuple[TextNumber, str], ...] = ()

    @classmethod
    def of(
        cls,
        file: str,
        document: Document,
        claims: Claims,
        ran: Ran | None = None,
        suggest: bool = False,
        doubts: Sequence[Doubt] = (),
    ) -> TextReport:
        """Check the claims; with `suggest`, also look for the values that each uncovered number may be.

        The `doubts` are what the draft of the claims called perhaps wrong.

        Raises ValueError if a claim has no value, a label occurs nowhere, or too many numbers need suggestions.
        """
        checked = check_claims(document, claims.claims)
        covered = coverage(document, checked, claims.labels, ran.spans if ran else ())
        if suggest and len(covered.uncovered) > _MOST_LISTED:
            raise ValueError(f"{len(covered.uncovered)} numbers are not covered; at most {_MOST_LISTED} are listed")
        suggestions = Suggestions(document.text.text) if suggest else None
        slips = [(at, one.said) for one in doubts if (at := one.place(document, covered.uncovered))]
        slips.sort(key=lambda slip: slip[0].start)
        return cls(file, document, checked, covered, claims.coverage, ran, suggestions, tuple(slips))

    @property
    def passed(self) -> bool:
        """True if there is no finding: claims and listings hold, and the coverage is high enough."""
        return not self.findings

    @property
    def findings(self) -> list[Finding]:
        """All findings, in the order of the file."""
        found = [finding for one in self.checked for finding in one.findings]
        found += self.ran.findings if self.ran else ()
        if self.coverage.share < self.least_coverage:
            least, share = _percent(self.least_coverage), _percent(self.coverage.share)
            place = self.document.position(self.coverage.uncovered[0].start)
            message = f"{share} of the numbers are covered, required: {least}; this is the first uncovered one"
            found.append(Finding("coverage", *place, least, share, message))
        return sorted(found, key=lambda finding: (finding.line, finding.column))

    def written(self, form: str) -> str:
        """The report as "text", "json" or "github"."""
        if form == "json":
            return as_json(self.as_dict())
        return "\n".join(self._annotations() if form == "github" else self._lines())

    def as_dict(self) -> dict[str, Any]:
        """The content of the JSON report: claims, findings, coverage, and how each number is accounted for."""
        return {
            "file": self.file,
            "passed": self.passed,
            "claims": {one.claim.id: {"count": one.claim.count, "found": len(one.occurrences)} for one in self.checked},
            "findings": [vars(finding) for finding in self.findings],
            "listings": self.ran.count if self.ran else None,
            "coverage": {**self.coverage.counts, "share": _percent(self.coverage.share)},
            "numbers": [self._accounted(one) for one in self.coverage.numbers],
            "slips": [{**self._placed(number), "message": said} for number, said in self.slips],
            "words": [self._placed(word) for word in self.coverage.unread],
            "not_read": self.document.other_files,
        }

    def _placed(self, found: TextNumber | TextWord) -> dict[str, Any]:
        return {"text": found.text, **self.document.position(found.start)._asdict()}

    def _accounted(self, one: Accounted) -> dict[str, Any]:
        entry = {**self._placed(one.number), "kind": one.kind}
        if one.by:
            return {**entry, "by": one.by}
        alike = self.suggestions.look_alikes(one.number) if self.suggestions else None
        looks_like = {} if alike is None else {"looks_like": [each.question for each in alike]}
        return {**entry, "context": self._context(one.number), **looks_like}

    def _lines(self) -> Iterator[str]:
        yield from problems_named_once(
            f"{self.file}:{self.document.shown(line, column)}: {f'{title}: ' * bool(title)}{message}"
            for _, line, column, title, message in self._notes()
        )
        wrong = len({finding.claim for finding in self.findings})
        listings = f", {counted(self.ran.count, 'listing')} run" if self.ran else ""
        verdict = f"{wrong} refuted" if wrong else "all hold" if self.checked or self.ran else "so nothing was checked"
        look = f"; {len(self.slips)} perhaps wrong" if self.slips else ""
        yield f"{self.file}: {counted(len(self.checked), 'claim')}{listings}, {verdict}{look}"
        if self.slips:
            yield 'what is right is kept by a claim of it with given = "why", or by deleting its line in the claims'
        worked_out, given, run, labels, uncovered = self.coverage.counts.values()
        numbers = counted(worked_out + given + run + uncovered, "number")
        kinds = f"{worked_out} by values, {given} given{f', {run} by running' if run else ''}, {uncovered} uncovered"
        yield f"{_percent(self.coverage.share)} of {numbers} covered: {kinds}; {counted(labels, 'label')} not counted"
        if others := others_in_phrases(self.document, self.checked, self.coverage.uncovered):
            shown = [*others[:_MOST_WORDS], *[f"{len(others) - _MOST_WORDS} more"] * (len(others) > _MOST_WORDS)]
            yield f"not checked: {counted(len(others), 'number')} where a claim has another one ({', '.join(shown)})"
        if unread := Counter(word.text.lower() for word in self.coverage.unread):
            words = [f"{word}{f' ×{n}' * (n > 1)}" for word, n in unread.most_common(_MOST_WORDS)]
            words += [f"{len(unread) - _MOST_WORDS} more"] * (len(unread) > _MOST_WORDS)
            yield f"not checked: {counted(unread.total(), 'word')} for numbers or growth ({', '.join(words)})"
        if files := self.document.other_files:
            yield f"not read: {', '.join(files)}, included by the text; check each separately"

    def _annotations(self) -> Iterator[str]:
        for level, line, column, title, message in self._notes():
            yield annotation(level, message, file=self.file, line=line, col=column, title=title or "draft")

    def _notes(self) -> Iterator[tuple[str, int, int, str, str]]:
        """What to look at: level, line, column, title and message; uncovered numbers if suggestions were requested."""
        for one in self.findings:
            yield "error", one.line, one.column, one.claim, one.message
        for number, looks in (
            (x, self.suggestions.look_alikes(x)) for x in self.coverage.uncovered if self.suggestions
        ):
            alike = [one.question for one in looks]
            more = f" and {len(alike) - _MOST_NAMED} more" if len(alike) > _MOST_NAMED else ""
            said = f"; looks like {', '.join(alike[:_MOST_NAMED])}{more}" if alike else ""
            place = self.document.position(number.start)
            yield "notice", *place, "not covered", f"{self._context(number)!r}{said}"
        for number, said in self.slips:
            yield "warning", *self.document.position(number.start), "", f"{number.text} {SLIP} {said}"

    def _context(self, number: TextNumber) -> str:
        text = self.document.text.text
        before = text[max(number.start - _CONTEXT, 0) : number.start].rpartition("\n")[2]
        after = text[number.end : number.end + _CONTEXT].partition("\n")[0]
        return before + text[number.start : number.end] + after


@dataclass(frozen=True, repr=False)
class UncheckedText(Printable):
    """A text among several that could not be checked, and why."""

    file: str
    error: str
    passed = False

    def written(self, form: str) -> str:
        """The reason as "text", "json" or "github"."""
        if form == "json":
            return as_json(self.as_dict())
        return annotation("error", self.error, file=self.file) if form == "github" else f"not checked: {self.error}"

    def as_dict(self) -> dict[str, Any]:
        """The content of the JSON report."""
        return {"file": self.file, "passed": False, "error": self.error}


@overload
def check(text: str | Path, *, init: Literal[True], ask: Sequence[str] = ...) -> Answered: ...
@overload
def check(
    text: str | Path, claims: str | Path | None = ..., *, coverage: bool = ..., run: bool = ..., time_limit: float = ...
) -> TextReport: ...
def check(
    text: str | Path,
    claims: str | Path | None = None,
    *,
    init: bool = False,
    ask: Sequence[str] = (),
    coverage: bool = False,
    run: bool = False,
    time_limit: float = 10.0,
) -> TextReport | Answered:
    """Check that each phrase of a claims file occurs in a text with the right values; with `init`, draft such a file.

    Without `claims`, the claims of chapter.md are read from chapter.md.claims.toml beside it. With `coverage`, the
    numbers that no claim covers are listed with suggestions. With `run`, the Python listings of the text run within
    `time_limit` seconds, with your rights. A draft looks for the values of the questions in `ask`, which may hold
    braces, and lists those that the text does not contain. Raises ValueError for an invalid claims file or text and for
    options that exclude each other.

    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from driftproof import check
    >>> with TemporaryDirectory() as folder:
    ...     text, claims = Path(folder) / "text.md", Path(folder) / "claims.toml"
    ...     _ = text.write_text("The order is 4.")
    ...     _ = claims.write_text('claim = [{ id = "o", phrase = "order is {value}", value = "order rk4" }]')
    ...     check(text, claims).passed
    True
    """
    if init and (claims is not None or coverage or run):
        raise ValueError("--init drafts claims; --run, --coverage and --format need --claims")
    if ask and not init:
        raise ValueError("--ask needs --init; a claims file already has its questions")
    if init:
        with named_beside(text):
            drafted = draft(read_document(text), str(text), ask)
        return Answered({"claims": drafted}, lambda data: str(data["claims"]))
    file = claims_beside(text) if claims is None else claims
    held = read_claims(file)
    doubts = doubts_of(read_utf8(file, LARGEST_DOCUMENT))
    document = read_document(text, held.form)
    ran = run_listings(document, time_limit) if run else None
    with refused_in(str(file)), named_beside(text, file):
        return TextReport.of(str(text), document, held, ran, coverage, doubts)


def assert_text(text: str | Path, claims: str | Path | None = None, *, run: bool = False) -> None:
    """Assert that every claim about a text holds: for a test.

    `claims` and `run` are those of `check`. Raises AssertionError with each finding, its place, and the numbers that
    the draft of the claims calls perhaps wrong; and ValueError, as `check` does.

    >>> from driftproof import assert_text
    >>> assert_text("missing.md")
    Traceback (most recent call last):
    ValueError: missing.md: No such file or directory
    """
    __tracebackhide__ = True  # pytest shows the user's line, and the message
    found = check(text, claims, run=run)
    wrong = len({finding.claim for finding in found.findings})
    words = f"has {counted(wrong, 'claim')} that {'does' if wrong == 1 else 'do'} not hold" if wrong else "holds"
    verdict = AssertedVerdict(str(text), words, found.passed, found.written("text"), found.as_dict())
    assert_verdict(verdict, holds=found.passed)


def claims_beside(text: str | Path) -> Path:
    """The default path of the claims of a text. Raises ValueError if there is no such file, or no text."""
    if not isfile(path := Path(f"{text}.claims.toml")):
        read_utf8(text, LARGEST_DOCUMENT)  # or it is the text that is missing
        draft = f"to draft them: driftproof check {quote(str(text))} --init > {quote(str(path))}"
        raise ValueError(f"no claims to check: give --claims FILE or write {path.name}; {draft}")
    return path


def texts_with_claims(given: Path) -> list[Path]:
    """The given text, or all texts of the given folder with claims beside them. Raises ValueError if there are none."""
    if not given.is_dir():
        return [given]
    found = sorted(path.with_name(path.name.removesuffix(".claims.toml")) for path in given.rglob("*.claims.toml"))
    if not found:
        raise ValueError(f"no text in {given} has a claims file; that of chapter.md would be chapter.md.claims.toml")
    return found


def _percent(share: Fraction) -> str:
    """A share to a tenth of a percent, rounded down so that only full coverage shows as 100%."""
    tenths = int(share * 1000)
    return f"{tenths // 10}%" if tenths % 10 == 0 else f"{tenths // 10}.{tenths % 10}%"
