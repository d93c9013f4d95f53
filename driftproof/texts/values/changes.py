"""Compare two files of values: changes of values, of digits or of wording only, additions and removals."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeAlias

from flint import fmpz

from driftproof.support.files import read_utf8
from driftproof.support.plain_text import as_json, table
from driftproof.support.results import Printable

# Kind of change -> its words in the singular and plural; the most serious first.
CHANGES = {
    "value": ("value changed", "values changed"),
    "digits": ("only in digits", "only in digits"),
    "wording": ("only in wording", "only in wording"),
    "added": ("added", "added"),
    "removed": ("removed", "removed"),
}
# Larger files are refused: 64 MB hold some hundred thousand values.
_LARGEST_FILE = 64 * 10**6
# A larger power of ten fills the memory before it is compared.
_LARGEST_EXPONENT = 10**5
# A longer text is shortened in the middle in reports, but not in JSON.
_LONGEST_TEXT = 40
# Keys of texts about a number: changes in them do not change the number.
_WORDS = {"evidence", "statement", "title", "source", "technique", "rounding", "reason", "generator"}
_DECIMAL = re.compile(r"(-?)([0-9]+)(?:\.([0-9]+))?(?:[eE]([+-]?[0-9]{1,6}))?")
_FRACTION = re.compile(r"(-?[0-9]+)/([0-9]+)")

# The keys and list positions that lead to a leaf of the document, and the leaf.
Leaf: TypeAlias = tuple[tuple[str, ...], Any]


@dataclass(frozen=True)
class Change:
    """A difference: its kind, one of CHANGES; the id or path; the part, "" for the number itself; old and new text."""

    kind: str
    id: str
    part: str
    old: str | None
    new: str | None

    def __str__(self) -> str:
        """The change in one line, without kind and id."""
        part = f"{self.part}: " if self.part else ""
        if self.kind in ("added", "removed"):
            return part + _cut(self.new if self.kind == "added" else self.old)
        return f"{part}{_cut(self.old)} became {_cut(self.new)}"


def read_values(path: Path) -> dict[str, Any]:
    """Read a JSON object, with numbers kept as text so that none is rounded. Raises ValueError with one line."""
    text, hook = read_utf8(path, _LARGEST_FILE), _without_repetition
    try:
        read = json.loads(text, parse_int=str, parse_float=str, parse_constant=str, object_pairs_hook=hook)
    except (RecursionError, ValueError) as error:
        reason = "nested too deeply for a file of values" if isinstance(error, RecursionError) else f"not JSON: {error}"
        raise ValueError(f"{path}: {reason}") from None
    if not isinstance(read, dict):
        raise ValueError(f"{path}: not a JSON object; give the output of `driftproof value --only '*'`")
    for place, leaf in _leaves(read):
        if isinstance(leaf, dict) and leaf and _rounded(leaf["decimal"]) is None:
            raise ValueError(f"{path}: {_name(place)}: decimal is {str(leaf['decimal'])[:60]!r}, not a number")
    return read


def _name(place: tuple[str, ...]) -> str:
    """The id of a value, or the path to another leaf."""
    return ".".join(place[1:] if place[0] == "values" and len(place) > 1 else place).replace(".[", "[")


def _without_repetition(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = next(key for key, times in Counter(key for key, _ in pairs).items() if times > 1)
        raise ValueError(f"the key {twice[:60]!r} occurs twice in one object")
    return found


def changes(old: dict[str, Any], new: dict[str, Any]) -> list[Change]:
    """All differences, by path. An object with the key "decimal" is a number; everything else is compared leaf by leaf.

    A number changed in value if both exact forms are given and differ, or if the decimals cannot be roundings of one
    number; in digits if the decimals can but differ; in wording if only the spelling of the exact form differs. Any
    other leaf changed in value unless both spell the same rational or its key is one of _WORDS.
    """
    before, after = dict(_leaves(old)), dict(_leaves(new))
    found: list[Change] = []
    for place in sorted(before.keys() | after.keys()):
        name = _name(place)
        if place in before and place in after:
            found += _leaf_changes(name, place[-1], before[place], after[place])
        else:
            kind, shown = "added" if place in after else "removed", (_shown(x.get(place)) for x in (before, after))
            found.append(Change(kind, name, "", *shown))
    return found


def _leaves(node: Any, place: tuple[str, ...] = ()) -> Iterator[Leaf]:
    """The leaves below the node; a document that is one number, the answer to a question, is called by that."""
    if isinstance(node, dict) and not isinstance(node.get("decimal"), str) and (node or not place):
        for key, inner in node.items():
            yield from _leaves(inner, (*place, key))
    elif isinstance(node, list) and node:
        for i, inner in enumerate(node):
            yield from _leaves(inner, (*place, f"[{i}]"))
    else:
        yield place or (str(node.get("question", "value")),), node


def _leaf_changes(name: str, key: str, old: Any, new: Any) -> Iterator[Change]:
    if isinstance(old, dict) and isinstance(new, dict) and old and new:
        yield from _number_changes(name, old, new)
    elif old != new:
        same = _number(old) is not None and _number(old) == _number(new)
        kind = "digits" if key == "digits" else "wording" if key in _WORDS or same else "value"
        yield Change(kind, name, "", _shown(old), _shown(new))


def _number_changes(name: str, old: dict[str, Any], new: dict[str, Any]) -> Iterator[Change]:
    """The change of exact form and decimal, then of unit, of words, and of the texts that claims print."""
    form, other = old.get("exact"), new.get("exact")
    x = _number(form)  # None for a formula, which is compared as text
    respelled = form == other or (x is not None and x == _number(other))
    if not (respelled or None in (form, other)) or not _agree(old["decimal"], new["decimal"]):
        yield Change("value", name, "", _shown(old), _shown(new))
    elif old["decimal"] != new["decimal"] or form != other:
        yield Change("digits" if old["decimal"] != new["decimal"] else "wording", name, "", _shown(old), _shown(new))
    for part in ["unit", *sorted((old.keys() | new.keys()) - {"exact", "decimal", "unit", "printed"})]:
        if old.get(part) != new.get(part):
            kind = "value" if part == "unit" else "wording"
            yield Change(kind, name, part, _shown(old.get(part)), _shown(new.get(part)))
    before, after = (prints if isinstance(prints, dict) else {} for prints in (old.get("printed"), new.get("printed")))
    for claim in sorted(before.keys() | after.keys()):
        text, new_text = before.get(claim), after.get(claim)
        if text != new_text:
            kind = "wording" if None in (text, new_text) else "digits" if _agree(text, new_text) else "value"
            yield Change(kind, name, f"printed {claim}", _shown(text), _shown(new_text))


def _agree(old: Any, new: Any) -> bool:
    """True if both texts can be correct roundings of one number; texts of equal precision must be equal.

    A decimal with last digit 10**-k stands for any number within 10**-k/2 of it, a fraction for itself.
    """
    before, after = _rounded(old), _rounded(new)
    if old == new or before is None or after is None:
        return bool(old == new)
    (x, half_x), (y, half_y) = before, after
    if half_x == half_y:
        return x == y and old.startswith("-") == new.startswith("-")
    return bool(abs(x - y) <= half_x + half_y)


def _number(text: Any) -> Fraction | None:
    """The rational number that the text spells as a fraction or a decimal; None for other text."""
    return (_rounded(text) or (None,))[0]


def _rounded(text: Any) -> tuple[Fraction, Fraction] | None:
    """The rational that the text spells, and half a unit of its last digit, 0 for a fraction; None for other text."""
    if not isinstance(text, str):
        return None
    # fmpz reads integers of any length; int() refuses more than 4300 digits.
    if match := _FRACTION.fullmatch(text):
        top, bottom = (int(fmpz(part)) for part in match.groups())
        return (Fraction(top, bottom), Fraction(0)) if bottom else None
    if match := _DECIMAL.fullmatch(text):
        sign, whole, part, exponent = match.groups("")
        power = int(exponent or 0) - len(part)
        if abs(power) <= _LARGEST_EXPONENT:
            unit = Fraction(10) ** power
            return int(fmpz(sign + whole + part)) * unit, unit / 2
    return None


def _shown(leaf: Any) -> str | None:
    """A number as "exact = decimal", any other leaf as JSON spells it."""
    if leaf is None or isinstance(leaf, str):
        return leaf
    if isinstance(leaf, dict) and leaf:
        exact, decimal = leaf.get("exact"), leaf["decimal"]
        return f"{exact} = {decimal}" if exact and exact != decimal else str(decimal)
    return json.dumps(leaf)


def _cut(text: str | None) -> str:
    shown = "nothing" if text is None else " ".join(text.split()) or '""'
    parts = (part if len(part) <= _LONGEST_TEXT else f"{part[:18]}...{part[-18:]}" for part in shown.split(" = "))
    return " = ".join(parts)


@dataclass(frozen=True, repr=False)
class Changes(Printable):
    """The changes between two files of values, in the order of their ids."""

    found: tuple[Change, ...]
    old: Path
    new: Path

    @property
    def same(self) -> bool:
        """True if no change is one of value; numbers may have come, gone, or changed in digits or wording."""
        return all(change.kind != "value" for change in self.found)

    def written(self, form: str) -> str:
        """The changes as "text", the most serious first, or as "json"."""
        counts = Counter(change.kind for change in self.found)
        if form == "json":
            files = {"old": str(self.old), "new": str(self.new)}
            listed = [vars(change) for change in self.found]
            return as_json({**files, "changes": listed, "counts": {kind: counts[kind] for kind in CHANGES}})
        counted = ", ".join(f"{counts[kind]} {words[counts[kind] != 1]}" for kind, words in CHANGES.items())
        counted = counted if self.found else f"{self.old} and {self.new} say the same"
        rows = [[kind, change.id, str(change)] for kind in CHANGES for change in self.found if change.kind == kind]
        return f"{table(rows)}\n\n{counted}" if rows else counted


def diff(old: str | Path, new: str | Path) -> Changes:
    """Compare two files of values: which changed in value, which only in digits or wording. Raises ValueError.

    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from driftproof import diff
    >>> with TemporaryDirectory() as folder:
    ...     for name, decimal in (("old", "0.5"), ("new", "0.50")):
    ...         _ = (Path(folder) / name).write_text('{"values": {"x": {"decimal": "%s"}}}' % decimal)
    ...     diff(Path(folder) / "old", Path(folder) / "new").same
    True
    """
    before, after = Path(old), Path(new)
    return Changes(tuple(changes(read_values(before), read_values(after))), before, after)
