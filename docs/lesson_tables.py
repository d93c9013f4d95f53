"""The figures of docs/lesson.md: how much of the lesson its claims cover, and which misprints they notice.

The lesson is not kept here, so its figures are, in lesson.json. `python docs/lesson_tables.py` measures them anew where
the lesson lies beside the checkout; the tests compare.
"""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from driftproof.texts.claims.checking import (  # noqa: E402
    GIVEN,
    LABEL,
    UNCOVERED,
    WORKED_OUT,
    CheckedClaim,
    check_claims,
    coverage,
)
from driftproof.texts.claims.claims import Claim, read_claims  # noqa: E402
from driftproof.texts.readers.canonical import FRACTIONS, LOWERED, RAISED  # noqa: E402
from driftproof.texts.readers.document import Document, document_of, read_document  # noqa: E402

LESSON = ROOT.parent / "shared" / "lesson" / "lesson.txt"
CLAIMS = ROOT / "proofs" / "lesson" / "claims.toml"
FIGURES = Path(__file__).with_name("lesson.json")
Rows = list[list[str]]
STATEMENT = re.compile(r"L\d{3}\b")

# Each digit, and what a misprint may put in its place.
_SHIFTED = ("".join(c for c, d in table.items() if d.isdigit()) for table in (RAISED, LOWERED))
_KINDS = ("0123456789", *_SHIFTED, FRACTIONS)
MISPRINTS = {digit: kind.replace(digit, "") for kind in _KINDS for digit in kind}
# More of a plain text than this on either side of a digit has no say in what a phrase around it is.
ROUND_ABOUT = 200


def misprints(document: Document, outcome: CheckedClaim) -> Iterator[tuple[int, str]]:
    """Every change of one digit where the claim's phrase stands: the place in the file, and the digit put there."""
    for occurrence in outcome.occurrences:
        places = {document.text.origin(i): None for i in range(*occurrence.span())}
        yield from ((at, other) for at in places for other in MISPRINTS.get(document.source[at], ""))


def unnoticed(document: Document, outcome: CheckedClaim) -> list[tuple[int, str]]:
    """The misprints of a plain text by which the claim is not refuted, from their surroundings alone.

    The claim holds of the text as it is, so that one occurrence more or less refutes it.
    """
    phrase = outcome.claim.phrase.exact(outcome.claim.spellings())

    @cache
    def count(at: int, digit: str) -> int:
        before, after = document.source[max(0, at - ROUND_ABOUT) : at], document.source[at + 1 : at + ROUND_ABOUT]
        return len(phrase.findall(document_of(before + digit + after).text.text))

    tried = misprints(document, outcome)
    return [(at, digit) for at, digit in tried if count(at, digit) == count(at, document.source[at])]


def figures(lesson: Path = LESSON) -> dict[str, Any]:
    """Everything that the page says in numbers."""
    claims = read_claims(CLAIMS)
    document = read_document(lesson, claims.form)
    outcomes = check_claims(document, claims.claims)
    covered = coverage(document, outcomes, claims.labels)
    tried = {place for outcome in outcomes for place in misprints(document, outcome)}
    why = {claim.id: _reason(claim) for claim in claims.claims}
    return {
        "claims": len(outcomes),
        "refuted": sum(bool(outcome.findings) for outcome in outcomes),
        **covered.counts,
        "share": str(covered.share),
        "labels": dict(Counter(one.by for one in covered.numbers if one.kind == LABEL)),
        "given_as": dict(Counter(why[one.by] for one in covered.numbers if one.kind == GIVEN)),
        "digits": sum(character in MISPRINTS for character in document.source),
        "held_digits": len({at for at, _ in tried}),
        "misprints": len(tried),
        "unnoticed": sum(len(unnoticed(document, outcome)) for outcome in outcomes),
    }


def _reason(claim: Claim) -> str:
    if claim.given is None:
        return "ticks of a diagram"
    settled = STATEMENT.match(claim.given)
    return "formulas and conventions, settled in the ledger" if settled else "choices of the lesson's"


def known() -> dict[str, Any]:
    """The figures as they were measured last."""
    return dict(json.loads(FIGURES.read_text(encoding="utf-8")))


def _coverage(_: object) -> Rows:
    found = known()
    numbers = found[WORKED_OUT] + found[GIVEN] + found[UNCOVERED]
    share = Fraction(found["share"]) * 100
    return [
        ["numbers of the lesson", "how many"],
        ["all but labels", str(numbers)],
        ["worked out and rounded here", str(found[WORKED_OUT])],
        *[[f"given: {why}", str(count)] for why, count in sorted(found["given_as"].items())],
        ["covered by no claim", str(found[UNCOVERED])],
        ["covered", f"{share.numerator}%" if share.denominator == 1 else f"{float(share):.1f}%"],
    ]


def _labels(_: object) -> Rows:
    found = sorted(known()["labels"].items(), key=lambda pair: (-pair[1], pair[0]))
    return [["labels", "how many"], *([why, str(count)] for why, count in found), ["all", str(known()[LABEL])]]


def _misprints(_: object) -> Rows:
    found = known()
    return [
        ["digits of the lesson", "how many"],
        ["all, in numbers and in labels", str(found["digits"])],
        ["in a phrase that has to stand as it does", str(found["held_digits"])],
        ["changes of one of these to another digit", str(found["misprints"])],
        ["noticed by the claim in whose phrase the digit stands", str(found["misprints"] - found["unnoticed"])],
        ["not noticed", str(found["unnoticed"])],
    ]


TABLES: dict[str, Callable[[object], Rows]] = {"coverage": _coverage, "labels": _labels, "misprints": _misprints}


def main() -> None:
    """Measure, and keep the figures."""
    FIGURES.write_text(json.dumps(figures(), indent=1, sort_keys=True, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
