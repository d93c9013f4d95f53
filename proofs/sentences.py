"""The lesson's lines as they were read against their proofs: a digest of the words of each, and its statements.

A proof cannot tell that its sentence has been rewritten. `proofs/lesson/sentences.txt` holds what was read, without the
sentences themselves; a line that is another one now is named with its statements. After reading them against the
ledger, `python -m proofs.sentences` writes the file anew, from the text and the list of claims beside this checkout. A
line whose words are as before keeps its statements; the others stand where their words do, the `quote` of the list. If
these stand nowhere any more, the statement is named and nothing is written. A statement that the list has no more is
dropped: the files that still speak of it are named.
"""

from __future__ import annotations

import json
import re
import sys
from bisect import bisect
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from difflib import SequenceMatcher
from functools import cache
from hashlib import sha256
from itertools import accumulate
from pathlib import Path
from textwrap import shorten
from typing import Any, NamedTuple

from driftproof.methods.numbers.rationals import parse_rational

BESIDE = Path(__file__).parents[2] / "shared" / "lesson"
LESSON, INVENTORY = BESIDE / "lesson.txt", BESIDE / "claims.json"
FILE = Path(__file__).parent / "lesson" / "sentences.txt"
DIGITS, LONGEST_QUOTE = 16, 100
ALIKE = ("equal", "moved")
HEAD = "# The number of each line of the lesson that has words, a digest of these, and the statements in it.\n"


class Line(NamedTuple):
    """A line of the lesson: its number, the digest of its words, the ids of the statements that quote it."""

    number: int
    digest: str
    claims: tuple[str, ...]

    def __str__(self) -> str:
        """The line of the file."""
        return " ".join((str(self.number), self.digest, *self.claims))


def _is_line(x: Any) -> bool:
    numbers = x if isinstance(x, list) and len(x) == 2 else [x]
    return all(type(number) is int and number > 0 for number in numbers) and numbers == sorted(numbers)


def _is_number(x: Any) -> bool:
    try:
        return x is None or (isinstance(x, str) and parse_rational(x) is not None)
    except ValueError:
        return False


# The fields of an entry of the list that are read, with what each may be; the others are for people.
FIELDS: dict[str, tuple[Callable[[Any], object], str]] = {
    "id": (lambda x: isinstance(x, str) and re.fullmatch(r"L\d{3}", x), "L and three digits"),
    "line": (_is_line, "the number of its line, or of its first and its last as [39, 40]"),
    "quote": (lambda x: isinstance(x, str) and x.strip(), "the words of the lesson"),
    "verifiable": (lambda x: isinstance(x, bool), "true, or false for one that NOT_VERIFIABLE in proofs/claims.py has"),
    "printed": (_is_number, 'the number that it prints, as in "0.25" or "337/384", or null'),
    "decimal": (_is_number, 'its value to any number of digits, as in "0.25", or null'),
}


def inventory() -> list[dict[str, Any]]:
    """The entries of the list of claims. Raises ValueError, in one line, for what is none: where, and what may be."""
    try:
        document = json.loads(INVENTORY.read_text(encoding="utf-8"))
    except json.JSONDecodeError as slip:
        raise ValueError(f"{INVENTORY.name}, line {slip.lineno}, column {slip.colno}: {slip.msg}") from None
    except OSError as missing:
        raise ValueError(f"{INVENTORY}: {missing.strerror}") from None
    entries = document.get("claims") if isinstance(document, dict) else None
    if not isinstance(entries, list):
        raise ValueError(f'{INVENTORY.name}: its entries are a list under "claims", as in {{"claims": [...]}}')
    seen: dict[str, int] = {}
    for number, entry in enumerate(entries, 1):
        last = f", after {entries[number - 2]['id']}" if number > 1 else ""
        name = entry["id"] if isinstance(entry, dict) and isinstance(entry.get("id"), str) else f"entry {number}{last}"
        for field, (allowed, what) in FIELDS.items():
            if not isinstance(entry, dict) or field not in entry:
                raise ValueError(f"{INVENTORY.name}: {name} has no {field!r}; an entry has {', '.join(FIELDS)}")
            if not allowed(entry[field]):
                raise ValueError(f"{INVENTORY.name}: {name}: its {field!r} is {entry[field]!r}, and may be {what}")
        if seen.setdefault(name, number) != number:
            raise ValueError(
                f"{INVENTORY.name}: {name} is the id of the entries {seen[name]} and {number}, and may be of one"
            )
    return entries


def words_of(text: str) -> dict[int, str]:
    """The words of each line of a text that has any, by its number, with one space between two words."""
    words = ((number, " ".join(line.split())) for number, line in enumerate(text.splitlines(), 1))
    return {number: line for number, line in words if line}


def lines_of(text: str, claims: Mapping[int, list[str]]) -> list[Line]:
    """The lines of a text that have words, however these are spaced; `claims` are the statements by line."""
    digest = lambda line: sha256(line.encode()).hexdigest()[:DIGITS]
    return [Line(number, digest(line), tuple(claims.get(number, ()))) for number, line in words_of(text).items()]


@cache
def lines_read() -> tuple[Line, ...]:
    """The lines in the file."""
    rows = (row.split() for row in FILE.read_text(encoding="utf-8").splitlines() if not row.startswith("#"))
    return tuple(Line(int(number), digest, tuple(claims)) for number, digest, *claims in rows)


def line_of_claim(claim: str) -> int | None:
    """The line of the lesson in which a statement stands, or begins; None for one that is not of this lesson."""
    return next((line.number for line in lines_read() if claim in line.claims), None)


Place = tuple[str, list[Line], list[Line]]


def _places(text: str) -> Iterator[Place]:
    """What became of the lines that were read: for each place its kind, before and after.

    The kinds are those of `difflib`, and "moved" for a line that stands elsewhere, its words as before. Lines that
    were replaced by as many are a place each.
    """
    read, found = list(lines_read()), lines_of(text, {})
    digests = [[line.digest for line in lines] for lines in (read, found)]
    codes = SequenceMatcher(None, *digests, autojunk=False).get_opcodes()
    old, new = (
        {line.digest: line for kind, *at in codes if kind != "equal" for line in lines[at[i] : at[i + 1]]}
        for i, lines in ((0, read), (2, found))
    )
    once = [{digest for digest, times in Counter(each).items() if times == 1} for each in digests]
    moved = old.keys() & new.keys() & once[0] & once[1]
    yield from (("moved", [line], [new[digest]]) for digest, line in old.items() if digest in moved)
    for kind, first, last, start, end in codes:
        before, after = (
            [line for line in lines if line.digest not in moved] for lines in (read[first:last], found[start:end])
        )
        if len(before) == len(after):
            yield from ((kind, [old], [new]) for old, new in zip(before, after, strict=True))
        else:
            yield kind, before, after


def changes(text: str) -> list[str]:
    """What differs between a text and the lines that were read, a sentence for each place."""
    told, shifted, last = [], "", 0
    for kind, before, after in _places(text):
        numbers = [line.number for line in after]
        ids = ", ".join(dict.fromkeys(claim for line in before for claim in line.claims))
        if kind in ALIKE:
            at = f"line {before[0].number} is line {numbers[0]} now, its words as before{ids and f': {ids}'}"
            if kind == "moved":
                told.append(at)
                continue
            shifted = shifted or at * (before[0].number != numbers[0])
        else:
            what = f"the words of {ids}" if ids else "words without a statement"
            where = f"lines {numbers[0]} to {numbers[-1]}" if numbers[1:] else f"line {(numbers or [last])[0]}"
            gone = f"{where}: {what} are gone or changed" if numbers else f"after {where}: {what} are gone"
            told.append(gone if before else f"{where}: new words")
        last = numbers[-1] if numbers else last
    return told or [shifted] * bool(shifted)


def placed(text: str, listed: Iterable[Mapping[str, Any]]) -> tuple[dict[int, list[str]], list[str]]:
    """The statements of an inventory by the lines of the text in which they stand, and a sentence for each without one.

    A statement that was read stands where its line does now, or in what took the place of that, or else in a line that
    is new; any other, anywhere. Its `line` says which, if its quote stands in several of these; else it stands in none.
    """
    its_own: dict[str, set[int]] = {}
    others: set[int] = set()
    for kind, before, after in _places(text):
        numbers = {line.number for line in after}
        others |= numbers if kind not in ALIKE else set()
        for claim in (claim for line in before for claim in line.claims):
            its_own.setdefault(claim, set()).update(numbers)
    words, claims, lost = words_of(text), dict[int, list[str]](), list[str]()
    for entry in listed:
        at = _where(" ".join(entry["quote"].split()), words)
        own = its_own.get(entry["id"], set(words))
        found = [each for each in at if own.issuperset(each)] or [each for each in at if others.issuperset(each)]
        declared = entry["line"] if isinstance(entry["line"], int) else entry["line"][0]
        found = [each for each in found if each[0] == declared] if len(found) > 1 else found
        for number in found[0] if found else ():
            claims.setdefault(number, []).append(entry["id"])
        if not found:
            lost.append(f"{entry['id']}: {shorten(entry['quote'], LONGEST_QUOTE, placeholder=' ...')!r} is gone")
    return claims, lost


def _told(text: str, claims: Mapping[int, list[str]]) -> list[str]:
    """The `changes`, then the lines that are new, or have other words, and hold no statement, with what to do."""
    words = words_of(text)
    new = (line.number for kind, _, after in _places(text) if kind not in ALIKE for line in after)
    what = f"is of no statement; if it says what can be checked, give it an entry in {INVENTORY.name} and a proof"
    shown = ((number, shorten(words[number], LONGEST_QUOTE, placeholder=" ...")) for number in new)
    return [*changes(text), *(f"line {number}: {quote!r} {what}" for number, quote in shown if number not in claims)]


def to_do(text: str, listed: Iterable[Mapping[str, Any]]) -> list[str]:
    """What differs between a text and what was read, and what to do about it; nothing if it does not differ."""
    claims, lost = placed(text, listed)
    told = _told(text, claims)
    if lost:
        lost.append(f"Write the new words of these to {INVENTORY.name}; delete those that the lesson says no more.")
    others = lost or any(kind not in ALIKE for kind, *_ in _places(text))
    read = "Read what has other words against its proof in ledger.md, then run" if others else "To record that, run"
    read += " python -m proofs.sentences."
    return [*told, *lost, read] if told or lost else []


def _where(quote: str, words: dict[int, str]) -> list[tuple[int, ...]]:
    """The numbers of the lines of each place at which the quote stands, not as a part of a longer number."""
    numbers, starts = list(words), list(accumulate((len(line) + 1 for line in words.values()), initial=0))
    alone = rf"(?:(?!\d)|(?<!\d)(?<!\d\.)){re.escape(quote)}(?:(?<!\d)|(?!\d|\.\d))"
    spans = (found.span() for found in re.finditer(alone, " ".join(words.values())))
    lines = (numbers[bisect(starts, start) - 1 : bisect(starts, end - 1)] for start, end in spans)
    return list(dict.fromkeys(map(tuple, lines)))


def main() -> int:
    """Write the file from the lesson's text and its list of claims, and tell what is taken as read by that."""
    try:
        text, listed = LESSON.read_text(encoding="utf-8"), inventory()
    except (OSError, ValueError) as slip:
        print(f"nothing written: {slip}", file=sys.stderr)
        return 1
    claims, lost = placed(text, listed)
    if lost:
        print("\n".join(["nothing written:", *to_do(text, listed)]), file=sys.stderr)
        return 1
    told, read = _told(text, claims), lines_of(text, claims)
    dropped = {claim for line in lines_read() for claim in line.claims}.difference(*(line.claims for line in read))
    FILE.write_text(HEAD + "".join(f"{line}\n" for line in read), encoding="utf-8")
    print("\n".join([f"wrote {FILE.name}: {len(read)} lines", *(f"now read: {each}" for each in told)]))
    print(
        "".join(f"dropped: {claim}, still named in {', '.join(_named(claim))}\n" for claim in sorted(dropped)), end=""
    )
    return 0


def _named(claim: str) -> list[str]:
    """The files of the proofs that name a statement, with the line in which they do so first."""
    found = []
    for path in sorted(Path(__file__).parent.rglob("*")):
        if path.suffix in (".py", ".toml", ".v"):
            lines = path.read_text(encoding="utf-8").splitlines()
            at = [n for n, line in enumerate(lines, 1) if re.search(rf"(?<![^\W_]){claim}(?![^\W_])", line)]
            found += [f"{path.relative_to(Path(__file__).parents[1])}:{n}" for n in at[:1]]
    return found


if __name__ == "__main__":
    sys.exit(main())
