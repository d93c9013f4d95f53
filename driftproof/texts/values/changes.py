"""What changed between two documents of values: in value, only in digits or in wording; what came and what went."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeAlias

from flint import fmpz

VALUE, DIGITS, WORDING, ADDED, REMOVED = "value", "digits", "wording", "added", "removed"
KINDS = (VALUE, DIGITS, WORDING, ADDED, REMOVED)

# Documents beyond these are refused: a file of 64 MB holds some hundred thousand values.
LARGEST_FILE = 64 * 10**6
LARGEST_EXPONENT = 10**5

Json: TypeAlias = Any
# "values" -> id, or the keys and list positions that lead to a leaf.
Place: TypeAlias = tuple[str, ...]

# Words about a number, which is the same number under other words; how long it is printed is a matter of digits.
_WORDS = {"evidence", "statement", "title", "source", "technique", "rounding", "reason", "generator"}
_LENGTHS = {"digits"}
_DECIMAL = re.compile(r"(-?)([0-9]+)(?:\.([0-9]+))?(?:[eE]([+-]?[0-9]{1,6}))?")
_FRACTION = re.compile(r"(-?[0-9]+)/([0-9]+)")


@dataclass(frozen=True)
class Change:
    """One difference: its kind, one of KINDS; the id or path; the part of it, "" for the number itself; both texts."""

    kind: str
    id: str
    part: str
    old: str | None
    new: str | None


def read_document(path: Path) -> dict[str, Json]:
    """The JSON object in the file; numbers stay text, so that none is rounded. Raises ValueError with one line."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}") from None
    if len(data) > LARGEST_FILE:
        raise ValueError(f"{path}: longer than {LARGEST_FILE} bytes; give a file of values")
    try:
        read = json.loads(
            data.decode("utf-8-sig"),
            parse_int=str,
            parse_float=str,
            parse_constant=str,
            object_pairs_hook=_without_repetition,
        )
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not UTF-8 at byte {error.start}") from None
    except RecursionError:
        raise ValueError(f"{path}: nested too deeply for a file of values") from None
    except ValueError as error:
        raise ValueError(f"{path}: no JSON: {error}") from None
    if not isinstance(read, dict):
        raise ValueError(f"{path}: holds no JSON object; give what `driftproof values` prints")
    return read


def _without_repetition(pairs: list[tuple[str, Json]]) -> dict[str, Json]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"the key {twice[:60]!r} stands twice in one object")
    return found


def changes(old: dict[str, Json], new: dict[str, Json]) -> list[Change]:
    """Every difference, by place. A number is an object with the key "decimal"; all else is compared leaf by leaf.

    A number changed in value if both exact forms are rational and differ, or the decimals cannot be roundings of one
    number; in digits if they can, and are not of one length; in wording otherwise. Other leaves changed in value
    unless they spell the same rational, or stand under a key that only words a number.
    """
    before, after = dict(_leaves(old)), dict(_leaves(new))
    found: list[Change] = []
    for place in sorted(before.keys() | after.keys()):
        name = _name(place)
        if place not in after:
            found.append(Change(REMOVED, name, "", _shown(before[place]), None))
        elif place not in before:
            found.append(Change(ADDED, name, "", None, _shown(after[place])))
        elif before[place] != after[place]:
            found += _of_leaf(place, before[place], after[place])
    return found


def _leaves(node: Json, place: Place = ()) -> Iterator[tuple[Place, Json]]:
    if isinstance(node, dict) and not isinstance(node.get("decimal"), str) and (node or not place):
        for key, inner in node.items():
            yield from _leaves(inner, (*place, key))
    elif isinstance(node, list) and node:
        for i, inner in enumerate(node):
            yield from _leaves(inner, (*place, f"[{i}]"))
    else:
        yield place, node


def _name(place: Place) -> str:
    parts = place[1:] if place[0] == "values" and len(place) > 1 else place
    return ".".join(parts).replace(".[", "[")


def _of_leaf(place: Place, old: Json, new: Json) -> Iterator[Change]:
    name = _name(place)
    if isinstance(old, dict) and isinstance(new, dict) and old and new:
        yield from _of_number(name, old, new)
    else:
        yield Change(_kind_of_words(place[-1], old, new), name, "", _shown(old), _shown(new))


def _kind_of_words(key: str, old: Json, new: Json) -> str:
    if key in _WORDS:
        return WORDING
    if key in _LENGTHS:
        return DIGITS
    exact = [_exact(text) for text in (old, new)]
    return WORDING if None not in exact and exact[0] == exact[1] else VALUE


def _of_number(name: str, old: dict[str, Json], new: dict[str, Json]) -> Iterator[Change]:
    if kind := _kind_of_number(old, new):
        yield Change(kind, name, "", _shown(old), _shown(new))
    if old.get("unit") != new.get("unit"):
        yield Change(VALUE, name, "unit", _shown(old.get("unit")), _shown(new.get("unit")))
    for part in sorted((old.keys() | new.keys()) - {"exact", "decimal", "unit", "printed"}):
        if old.get(part) != new.get(part):
            yield Change(WORDING, name, part, _shown(old.get(part)), _shown(new.get(part)))
    yield from _of_prints(name, old.get("printed"), new.get("printed"))


def _kind_of_number(old: dict[str, Json], new: dict[str, Json]) -> str | None:
    """How exact form and decimal together changed; None if neither did."""
    exact = [_exact(number.get("exact")) for number in (old, new)]
    decimals = old["decimal"], new["decimal"]
    if (None not in exact and exact[0] != exact[1]) or not _agree(*decimals):
        return VALUE
    if decimals[0] != decimals[1]:
        return DIGITS
    return WORDING if old.get("exact") != new.get("exact") else None


def _of_prints(name: str, old: Json, new: Json) -> Iterator[Change]:
    """The texts in which claims print the number: {claim: text}."""
    old, new = (prints if isinstance(prints, dict) else {} for prints in (old, new))
    for claim in sorted(old.keys() | new.keys()):
        texts = old.get(claim), new.get(claim)
        if texts[0] == texts[1]:
            continue
        kind = WORDING if None in texts else DIGITS if _agree(*texts) else VALUE
        yield Change(kind, name, f"printed {claim}", *map(_shown, texts))


def _agree(old: Json, new: Json) -> bool:
    """True if both texts can be correct roundings of one number, and not two different ones to one length.

    A decimal with last digit 10**-k stands for its value up to 10**-k/2 either way, a fraction for itself.
    """
    if old == new:
        return True
    before, after = _rounded(old), _rounded(new)
    if before is None or after is None:
        return False
    (x, half_x), (y, half_y) = before, after
    return half_x != half_y and abs(x - y) <= half_x + half_y


def _rounded(text: Json) -> tuple[Fraction, Fraction] | None:
    """The number that the text spells and half a unit of its last digit, 0 for a fraction; None for other text."""
    match = _DECIMAL.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        exact = _exact(text)
        return None if exact is None else (exact, Fraction(0))
    sign, whole, part, exponent = match.groups("")
    power = int(exponent or 0) - len(part)
    if abs(power) > LARGEST_EXPONENT:
        return None
    unit = Fraction(10) ** power
    # fmpz reads integers of any length; Python's own int() refuses beyond 4300 digits.
    x = int(fmpz(whole + part)) * unit
    return (-x if sign else x), unit / 2


def _exact(text: Json) -> Fraction | None:
    """The rational that the text spells, a decimal being itself; None for other text."""
    if not isinstance(text, str):
        return None
    if match := _FRACTION.fullmatch(text):
        top, bottom = (int(fmpz(part)) for part in match.groups())
        return Fraction(top, bottom) if bottom else None
    read = _rounded(text) if _DECIMAL.fullmatch(text) else None
    return read[0] if read else None


def _shown(leaf: Json) -> str | None:
    """A number as exact = decimal, other leaves as they are spelled in JSON."""
    if leaf is None or isinstance(leaf, str):
        return leaf
    if isinstance(leaf, dict) and leaf:
        exact, decimal = leaf.get("exact"), leaf["decimal"]
        return f"{exact} = {decimal}" if exact and exact != decimal else str(decimal)
    return json.dumps(leaf)
