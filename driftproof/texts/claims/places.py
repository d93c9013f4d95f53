"""What the place of a number says about it: the method, step size, time and quantity that its row or sentence names."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from driftproof.texts.claims.contradictions import POSITIVE, SETTING, last_methods_named, methods_named, sentence_around
from driftproof.texts.claims.tables import Cell
from driftproof.texts.readers.number_words import counts_of_steps

# Quantity -> the words that name it; the last of these words before a number, or in its column's head, counts.
_WORDS = {
    "energy": r"(?:energy|hamiltonian)(?: (?:errors?|drift|change))?",
    "ratio": r"factor|ratio|times as|divides",
    "relative_error": r"relative(?: errors?)?",
    "error": r"errors?|e_n|off(?= by)|wrong|deviat\w+|differ\w+",
    "exact": r"exact|true|solution|analytical",
    "evaluations": r"evaluations|calls",
}
_QUANTITY = re.compile("|".join(rf"(?P<{name}>\b(?:{words}))\b" for name, words in _WORDS.items()))
_AFTER = re.compile(
    r" ?(?:(?P<percent>%)|times (?:as|less|more|smaller|larger)|(?P<count>evaluations|calls|(?:time )?steps))"
)
# An unknown with its sign right before a number, as in x = 0.5, or its value at a time, as in y(1) ≈ 0.5.
_UNKNOWN = re.compile(r"(?<!\w)(?P<name>[^\W\d_][a-z]*)(?:\([0-9][0-9./]*\)|_?(?P<n>[0-9]))? ?[=≈] ?\Z")
# A time is also given by the value of an unknown then, as in y(1).
_TIME = re.compile(rf"(?<!\w)(?:t\s?=\s?|[^\W\d]\w*\((?=[0-9./]*\))){POSITIVE}")
# The head of the column of an unknown, and of a row whose number is that of a step.
_HEAD_OF_UNKNOWN = re.compile(r"(?P<name>[^\W\d_])(?P<of_step>_\{?[nijk]\}?)?(?:\(t(?:_\{?[nijk]\}?)?\))?")
_HEADS = {"h": r"h|dt|δt|step ?size", "t": r"t(?:_[ni])?|time|t_\{?n\}?", "n": r"n|(?:number of |n_?)?steps"}
# Characters before a number that are searched for a step size or time, and for a method.
_FARTHEST, _NEAR = 2000, 400
_NUMBER = re.compile(r"[-+]?[0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?")


@dataclass(frozen=True)
class Place:
    """What is named where a number stands: None or an empty set where nothing is."""

    methods: frozenset[str]
    settings: dict[str, Fraction]
    quantity: str | None
    unknown: str | None

    def means(self, question: str, methods: set[str]) -> bool:
        """True if a question about one of these methods asks for what is named here, and all that it asks for is."""
        quantity, unknown = asked_quantity(question)
        for x, given in _asked_settings(question).items():
            if given and self.settings.get(x) not in (given if quantity == "ratio" else given[:1]):
                return False
        if (methods and not methods & self.methods) or (self.unknown and unknown.lower() not in ("", self.unknown)):
            return False
        return quantity == self.quantity if self.quantity else quantity in ("state", "error", "exact")


@cache
def _asked_settings(question: str) -> dict[str, list[Fraction]]:
    return {x: [*map(Fraction, pattern.findall(question))] for x, pattern in SETTING.items()}


@cache
def asked_quantity(question: str) -> tuple[str, str]:
    """The quantity that a question asks for, and the unknown whose value it is, if it is one's."""
    readout = question.removesuffix(", 1)").rpartition(" : ")[2].rstrip(")")
    kind, _, unknown = readout.rpartition(".")
    unknown = "" if "rates=" in question else unknown  # y0, y1, ... need not be the names in the text
    if question.startswith(("ratio(", "R(")):
        return "ratio", ""
    if " : " not in question:
        return "fact", ""
    if question.startswith("percent("):
        return "percent" if "relative_error" in question else "share", ""
    if readout in ("error", "state_error", "position_error", "relative_error", "evaluations", "steps"):
        return readout.removeprefix("state_").removeprefix("position_"), ""
    if readout in ("energy", "energy_change"):
        return "energy", ""
    if kind[:1] == "k":
        return kind, ""
    if kind == "error":
        return kind, unknown
    return "exact" if kind == "exact" or question.startswith("exact ") else "state", unknown


def place_of(text: str, start: int, end: int, row: Sequence[Cell], unknowns: Collection[str]) -> Place:
    """The place of the number from `start` to `end` of a text in lower case; `row` is its table's, else empty.

    The names of `unknowns`, in lower case, may have an index, as N_1 does; the index of any other is that of a step.
    """
    heads = [cell.head for cell in row if cell.start <= start]
    head = heads[-1] if heads else ""
    before, after = sentence_around(text, start, end)
    settings = dict[str, Fraction]()
    nearest = (*row[len(heads) :], *row[: len(heads)])  # the last one: of columns h, y, h, y the one on the left
    for x, pattern in (("h", SETTING["h"]), ("t", _TIME)):
        near = pattern.findall(head) or pattern.findall(before) or pattern.findall(after)[:1]
        given = near or pattern.findall(text[max(0, start - _FARTHEST) : start])
        cells = [cell.text for cell in nearest if is_head_of(x, cell.head) and _NUMBER.fullmatch(cell.text)]
        settings |= {x: Fraction((cells or given)[-1])} if cells or given else {}
    in_steps = [cell.text for cell in nearest if is_head_of("n", cell.head)]
    counts = [int(number) for number in in_steps if re.fullmatch("[1-9][0-9]*", number)]
    of_step = any((found := _HEAD_OF_UNKNOWN.fullmatch(cell.head)) and found["of_step"] for cell in row)
    taken = counts[-1:] if row and of_step else [] if row or near else counts_of_steps(before)[-1:]
    if taken and not cells and "h" in settings:  # after the last pass of the loop these are what gives the time
        settings["t"] = taken[0] * settings["h"]
    elif counts and "t" in settings and "h" not in settings:
        settings["h"] = settings["t"] / counts[-1]
    about = head if row else before
    if methods_named(head) or SETTING["h"].search(head):  # what is read stands above the table
        about = next(iter(re.findall(r"^[^|\n]+$", text[max(0, start - _FARTHEST) : start], re.MULTILINE)[-1:]), head)
    unknown, said = _UNKNOWN.search(before), [*_QUANTITY.finditer(about)]
    quantity, name = said[-1].lastgroup if said else "state" if head else None, unknown["name"] if unknown else None
    if unknown and unknown["n"] and name == "k":
        quantity, name = f"k{unknown['n']}", None
    elif (of_column := _HEAD_OF_UNKNOWN.fullmatch(head)) and not said:
        name = of_column["name"]
    elif unknown and f"{name}_{unknown['n']}" in unknowns:
        quantity, name = "exact" if quantity == "exact" else "state", f"{name}_{unknown['n']}"
    elif unknown:
        quantity = "exact" if quantity == "exact" else "state"
        settings |= {"t": int(unknown["n"]) * settings["h"]} if unknown["n"] and "h" in settings else {}
    if more := _AFTER.match(text, end):
        counted = "steps" if (more["count"] or "").endswith("steps") else "evaluations" if more["count"] else ""
        quantity = "percent" if more["percent"] else counted or "ratio"
    if any(is_head_of(x, head) for x in _HEADS):
        quantity = "chosen"
    methods = next((named for one in reversed(heads) if (named := methods_named(one))), set[str]())
    methods = methods or methods_named(" ".join(cell.text for cell in row))
    methods = methods or last_methods_named(text[max(0, start - _NEAR) : start], after)
    return Place(frozenset(methods), settings, quantity, name)


def is_head_of(setting: str, head: str) -> bool:
    """True if the head of a column, in lower case, is that of values of h, t or the number of steps."""
    return re.fullmatch(rf"(?:{_HEADS[setting]})(?: ?[(\[].*)?", head) is not None
