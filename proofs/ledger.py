"""The ledger: the evidence for each claim after a run of the proofs, as tables, and the values to publish."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from driftproof.support.plain_text import as_json, table
from proofs.claims import EVIDENCE, HOW_TO_ADD, required_claims
from proofs.kernel.certificates import technique
from proofs.sentences import line_of_claim

NOT_RUN = "not run"
ROUNDING = "half-even"
# Statements are cut to the width of the terminal, but not to fewer characters than this.
SHORTEST = 80
# So many claims without a test are named; a run of one file leaves out two hundred.
NAMED = 12


@dataclass(frozen=True)
class Entry:
    """A claim as its proof states it, with the test, the evidence that a pass gives, and the technique."""

    claim: str
    test: str
    statement: str
    evidence: str
    technique: str


@dataclass
class Ledger:
    """The entries of all collected proofs, the outcomes of the tests that ran, and the values published."""

    entries: dict[str, Entry] = field(default_factory=dict)
    tests: set[str] = field(default_factory=set)
    outcomes: dict[str, str] = field(default_factory=dict)
    published: list[dict[str, Any]] = field(default_factory=list)

    def add(self, tests: Iterable[str], entries: Iterable[Entry]) -> None:
        """Add collected tests and entries. Raises ValueError if two tests claim the same statement."""
        self.tests.update(tests)
        for entry in entries:
            known = self.entries.setdefault(entry.claim, entry)
            if known != entry:
                raise ValueError(f"{entry.claim} is claimed by both {known.test} and {entry.test}")

    def record(self, test: str, outcome: str) -> None:
        """Record the outcome of one phase of a test; a failure in any phase outweighs passes."""
        if self.outcomes.get(test) in (None, "passed"):
            self.outcomes[test] = outcome

    def standing(self, claim: str) -> str:
        """The evidence for a claim if its proof passed, else "failed", "skipped" or "not run"."""
        entry = self.entries.get(claim)
        outcome = self.outcomes.get(entry.test, NOT_RUN) if entry else NOT_RUN
        return entry.evidence if entry and outcome == "passed" else outcome

    @property
    def required(self) -> list[str]:
        """The claims of the lesson that need a proof, then those about the toolkit."""
        return [claim for claims in required_claims(self.entries) for claim in claims]

    @property
    def missing(self) -> list[str]:
        """The required claims that no collected test proves."""
        return [claim for claim in self.required if claim not in self.entries]

    @property
    def complete(self) -> bool:
        """True when every required claim stands and no collected test failed or was left out.

        A test without a claim may be skipped: two compare with the lesson's own list, which a clone may lack.
        """
        return all(self.standing(claim) in EVIDENCE for claim in self.required) and all(
            self.outcomes.get(test) in ("passed", "skipped") for test in self.tests
        )

    def totals(self) -> str:
        """One line with the number of claims of the lesson, and about the toolkit, per kind of evidence."""
        lesson, toolkit = (f"{len(claims)} %s: {self._counts(claims)}" for claims in required_claims(self.entries))
        about_itself = f"; {toolkit % 'about the toolkit'}" if required_claims(self.entries)[1] else ""
        return f"{lesson % 'claims'}{about_itself}"

    def _counts(self, claims: Iterable[str]) -> str:
        counts = Counter(self.standing(claim) for claim in claims)
        order = [*EVIDENCE, "failed", "skipped", NOT_RUN]
        return ", ".join(f"{counts[standing]} {standing}" for standing in order if counts[standing])

    def text(self, width: int) -> str:
        """The table for a terminal of `width` columns, then what was not run, and the totals.

        If a test failed, with a claim or without, the table has only the claims that failed: nothing drowns in it.
        """
        rows = [["claim", "evidence", "technique", "statement"]]
        used = max(len(entry.technique) for entry in self.entries.values()) + 23  # the other columns and the gaps
        failed = "failed" in self.outcomes.values()
        for claim in self.required:
            if (entry := self.entries.get(claim)) and (not failed or self.standing(claim) == "failed"):
                statement = textwrap.shorten(entry.statement, max(width - used, SHORTEST), placeholder=" …")
                rows.append([claim, self.standing(claim), entry.technique, statement])
        lines = [table(rows)] * bool(rows[1:])
        if missing := self.missing:
            more = f" and {len(missing) - NAMED} more" if len(missing) > NAMED else ""
            named = f"{', '.join(missing[:NAMED])}{more}"
            lines.append(textwrap.fill(f"not run, or without a proof: {named}; {HOW_TO_ADD}", width))
        return "\n".join([*lines, self.totals()])

    def markdown(self) -> str:
        """The content of ledger.md: the table with full statements, in Markdown."""
        lesson, toolkit = required_claims(self.entries)
        lines = [
            "# Ledger",
            "",
            "What each statement of the lesson is worth. Written by `pytest proofs/` when every proof passes.",
            "A statement is in the words of its proof; that they say what the line of the lesson says is for people to",
            "read. Where the lesson lies beside a checkout, `pytest proofs/` names the lines that have changed since.",
            "Coq: how its kernel accepts the claim, or a part of it, - where it does not; see "
            "[docs/kernel.md](../docs/kernel.md).",
            "",
            self.totals() + ".",
            "",
            *self._rows(lesson),
            "",
            "## The toolkit",
            "",
            "What it claims about itself.",
            "",
            *self._rows(toolkit),
        ]
        return "\n".join(lines) + "\n"

    def _rows(self, claims: Iterable[str]) -> list[str]:
        lines = ["| claim | line | statement | evidence | technique | proof | Coq |", "|---|---|---|---|---|---|---|"]
        for claim in claims:
            entry = self.entries[claim]
            file = Path(entry.test.partition("::")[0]).name
            proof = f"[{file.removeprefix('test_').removesuffix('.py')}]({file})"
            cells = (claim, str(line_of_claim(claim) or "-"), entry.statement.replace("|", "\\|"), entry.evidence)
            lines.append(f"| {' | '.join((*cells, entry.technique, proof, technique(claim)))} |")
        return lines

    def values(self) -> str:
        """The content of values.json: every published value by id, with the text that each claim prints; deterministic.

        Raises ValueError if two proofs publish different values under one id, or one claim twice.
        """
        values: dict[str, dict[str, Any]] = {}
        for item in self.published:
            value = values.setdefault(item["id"], {key: item[key] for key in ("exact", "decimal", "evidence")})
            printed = value.setdefault("printed", {})
            if value["decimal"] != item["decimal"] or value["exact"] != item["exact"] or item["claim"] in printed:
                raise ValueError(f"{item['id']} is published twice, and not alike (claim {item['claim']})")
            printed[item["claim"]] = item["text"]
        return as_json({"rounding": ROUNDING, "values": values}) + "\n"
