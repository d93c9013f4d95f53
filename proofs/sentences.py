"""The lesson's lines as they were read against their proofs: a digest of the words of each, and its statements.

A proof cannot tell that its sentence has been rewritten. `proofs/lesson/sentences.txt` holds what was read, without the
sentences themselves; a line that is another one now is named with its statements. After reading them against the
ledger, `python -m proofs.sentences` writes the file anew, from the text and the list of claims beside this checkout.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from difflib import SequenceMatcher
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

BESIDE = Path(__file__).parents[2] / "shared" / "lesson"
LESSON, INVENTORY = BESIDE / "lesson.txt", BESIDE / "claims.json"
FILE = Path(__file__).parent / "lesson" / "sentences.txt"
DIGITS = 16
HEAD = "# The number of each line of the lesson that has words, a digest of these, and the statements in it.\n"


class Line(NamedTuple):
    """A line of the lesson: its number, the digest of its words, the ids of the statements that quote it."""

    number: int
    digest: str
    claims: tuple[str, ...]

    def __str__(self) -> str:
        """The line of the file."""
        return " ".join((str(self.number), self.digest, *self.claims))


def lines_of(text: str, claims: Mapping[int, list[str]]) -> list[Line]:
    """The lines of a text that have words, however these are spaced; `claims` are the statements by line."""
    words = ((number, " ".join(line.split())) for number, line in enumerate(text.splitlines(), 1))
    digest = lambda line: sha256(line.encode()).hexdigest()[:DIGITS]
    return [Line(number, digest(line), tuple(claims.get(number, ()))) for number, line in words if line]


@cache
def lines_read() -> tuple[Line, ...]:
    """The lines in the file."""
    rows = (row.split() for row in FILE.read_text(encoding="utf-8").splitlines() if not row.startswith("#"))
    return tuple(Line(int(number), digest, tuple(claims)) for number, digest, *claims in rows)


def line_of_claim(claim: str) -> int | None:
    """The line of the lesson in which a statement stands, or begins; None for one that is not of this lesson."""
    return next((line.number for line in lines_read() if claim in line.claims), None)


def changes(text: str) -> list[str]:
    """What differs between a text and the lines that were read, a sentence for each place."""
    read, found = lines_read(), lines_of(text, {})
    compared = SequenceMatcher(a=[line.digest for line in read], b=[line.digest for line in found], autojunk=False)
    told = []
    for kind, first, last, start, end in compared.get_opcodes():
        if kind != "equal":
            ids = [claim for line in read[first:last] for claim in line.claims]
            what = f"the words of {', '.join(dict.fromkeys(ids))}" if ids else "words without a statement"
            where = f"line {found[start].number}" if start < end else f"after line {found[start - 1].number}"
            told.append(f"{where}: {'new words' if kind == 'insert' else f'{what} are gone or changed'}")
    return told


def main() -> None:
    """Write the file from the lesson's text and its list of claims."""
    claims: dict[int, list[str]] = {}
    for entry in json.loads(INVENTORY.read_text(encoding="utf-8"))["claims"]:
        first, *last = [entry["line"]] if isinstance(entry["line"], int) else entry["line"]
        for number in range(first, (last[0] if last else first) + 1):
            claims.setdefault(number, []).append(entry["id"])
    read = lines_of(LESSON.read_text(encoding="utf-8"), claims)
    FILE.write_text(HEAD + "".join(f"{line}\n" for line in read), encoding="utf-8")
    print(f"wrote {FILE.name}: {len(read)} lines")


if __name__ == "__main__":
    main()
