"""A list of changes as text, as JSON, and as annotations of a continuous-integration run on GitHub."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from driftproof.support.plain_text import as_json, table
from driftproof.texts.values.changes import ADDED, DIGITS, KINDS, REMOVED, VALUE, WORDING, Change

# A text longer than this is cut in the middle of a report, not in JSON.
LONGEST_TEXT = 40
_SAID = {
    VALUE: ("value changed", "values changed"),
    DIGITS: ("only in digits", "only in digits"),
    WORDING: ("only in wording", "only in wording"),
    ADDED: ("added", "added"),
    REMOVED: ("removed", "removed"),
}
_KEY = re.compile(r'\s*"([^"]*)":')
_LEVELS = {VALUE: "error", REMOVED: "warning"}


def changes_text(changes: Sequence[Change], old: Path, new: Path) -> str:
    """One line per change, the gravest kind first, and a line of counts."""
    rows = [[change.kind, change.id, _became(change)] for kind in KINDS for change in changes if change.kind == kind]
    return "\n\n".join(filter(None, [table(rows) if rows else "", _counts(changes, old, new)]))


def changes_json(changes: Sequence[Change], old: Path, new: Path) -> str:
    """{"old": file, "new": file, "changes": [{"kind", "id", "part", "old", "new"}], "counts": {kind: number}}."""
    counts = Counter(change.kind for change in changes)
    return as_json(
        {
            "old": str(old),
            "new": str(new),
            "changes": [vars(change) for change in changes],
            "counts": {kind: counts[kind] for kind in KINDS},
        }
    )


def changes_github(changes: Sequence[Change], old: Path, new: Path) -> str:
    """One workflow command per change, on the line of the new file that holds the id: error, warning or notice."""
    lines = _lines_of_keys(new.read_text(encoding="utf-8-sig"))
    found = []
    for change in changes:
        level = _LEVELS.get(change.kind, "notice")
        where = f"file={_property(str(new))},line={_line(lines, change.id)},title={_property(_SAID[change.kind][0])}"
        found.append(f"::{level} {where}::{_data(f'{change.id}: {_became(change)}')}")
    return "\n".join([*found, _counts(changes, old, new)])


def _became(change: Change) -> str:
    part = f"{change.part}: " if change.part else ""
    if change.kind == ADDED:
        return part + _cut(change.new)
    if change.kind == REMOVED:
        return part + _cut(change.old)
    return f"{part}{_cut(change.old)} became {_cut(change.new)}"


def _cut(text: str | None) -> str:
    """The text in one line, both ends of it where it is long."""
    shown = "nothing" if text is None else " ".join(text.split()) or '""'
    parts = (part if len(part) <= LONGEST_TEXT else f"{part[:18]}...{part[-18:]}" for part in shown.split(" = "))
    return " = ".join(parts)


def _counts(changes: Sequence[Change], old: Path, new: Path) -> str:
    if not changes:
        return f"{old} and {new} say the same"
    counts = Counter(change.kind for change in changes)
    return ", ".join(f"{counts[kind]} {_SAID[kind][counts[kind] != 1]}" for kind in KINDS)


def _lines_of_keys(text: str) -> dict[str, int]:
    """The first line that opens with each key."""
    found: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        if match := _KEY.match(line):
            found.setdefault(match[1], number)
    return found


def _line(lines: dict[str, int], name: str) -> int:
    """The line of the key `name`, or of the first part of a path; 1 where there is none."""
    return lines.get(name) or lines.get(re.split(r"[.\[]", name)[0], 1)


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


FORMATS: dict[str, Callable[[Sequence[Change], Path, Path], str]] = {
    "text": changes_text,
    "json": changes_json,
    "github": changes_github,
}
