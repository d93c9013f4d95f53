"""The step size and the time of a number: those of its row and head, of its sentence, or the last ones before it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction

from driftproof.texts.readers.number_words import COUNT_GIVEN, PERCENT, TIME_UNIT, counts_of_steps, durations
from driftproof.texts.words.contradictions import LISTED_NUMBER, POSITIVE, SETTING, rest_of_list
from driftproof.texts.words.heads import SETTING_HEADS, is_head_of
from driftproof.texts.words.tables import Cell

# What joins numbers of a list, also one that goes from step size to step size, and step sizes in one.
_SIZES = re.compile(
    rf"(?:\bh|[dδ]t)\s?=\s?{POSITIVE}(?:(?:, (?:and )?| and | to | or )(?:(?:h|[dδ]t)\s?=\s?)?{POSITIVE})+"
)
_JOINED = r"(?:, (?:and )?| and | to )"
# A time is also given by the value of an unknown then, as in y(1).
_VALUE_AT = r"(?!(?:rk|ab|am|bdf|range|cos|sin|exp|ln|log|sqrt)\()[^\W\d]\w*"
_TIME = re.compile(rf"(?<![\w.])(?:t\s?=\s?|{TIME_UNIT} |{_VALUE_AT}\((?=[0-9./]*\))){POSITIVE}")
_AT_START = re.compile(
    r"\b(?:at the (?:start|beginning)|initial(?:ly)?|starts? (?:at|with))\b(?:[^.;,]|\.\d){0,30}\Z|"
    r"[a-z]'?(?:_0| ?\(0(?:\.0*)?\)) ?[=≈] ?(?:[^=≈,;\n]{1,30}[=≈] ?)?\Z"
)
_AT_START_BEHIND = re.compile(r" (?:at the (?:start|beginning)|initially)\b")
_FIRST_STEP = re.compile(r"\b(?:first|single) step\b")
# Characters before a number that are searched for its step size or time.
FARTHEST = 2000
# Characters after a number in which its own step size or method may stand, as in 0.01 for h = 0.5.
BESIDE_NUMBER = 40
_NEXT = re.compile(r"(?<![=≈] )(?<![=≈\w./])[-+]?[0-9]")
_NUMBER = re.compile(r"[-+]?[0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?")


def settings_named(
    text: str, span: tuple[int, int], sentence: tuple[str, str], row: Sequence[Cell], head: str
) -> tuple[dict[str, Fraction], frozenset[str], bool]:
    """The settings by letter, those that the row or the sentence gives one value of, and whether it gives a time.

    The number has this `span` in the lower-case text, and its sentence these parts before and behind it.
    """
    (start, end), (before, after), far = span, sentence, text[max(0, span[0] - FARTHEST) : span[0]]
    cells = sorted(row, key=lambda cell: cell.start <= start)  # the last one: of columns h, y, h, y the one on the left
    of = {x: [cell.text for cell in cells if is_head_of(x, cell.head)] for x in SETTING_HEADS}
    if state := re.match(r"(?:, ?[-+]?[0-9.]+)*\)", text[end : end + BESIDE_NUMBER]):  # (0.5, 0.1) at t = 0.2
        end += state.end()
    settings, near = dict[str, Fraction](), dict[str, list[str]]()
    for x, pattern in {**SETTING, "t": _TIME}.items():
        in_row = [number for number in of[x] if _NUMBER.fullmatch(number)]
        near[x] = in_row[-1:] or pattern.findall(head) or _said(x, pattern, text[end : end + BESIDE_NUMBER], sentence)
        if near[x] or not (row and not head and _gives_several(pattern, far)):
            settings |= {x: Fraction(given[-1])} if (given := near[x] or pattern.findall(far)) else {}
    if not row and (size := _size_in_order(before, after)):
        settings["h"], near["h"] = size, [str(size)]
    if row:
        taken = [int(n) for n in of["s"] if n.isdigit()][-1:]
        settings |= {"n": Fraction(taken[0])} if taken else {}
    else:
        taken = [] if near["t"] else _steps_taken(before, text[end : end + BESIDE_NUMBER])
    counts = [int(n) for n in (*COUNT_GIVEN.findall(head or before), *of["n"]) if re.fullmatch("[1-9][0-9]*", n)][-1:]
    if taken and "h" in settings:
        settings["t"] = taken[0] * settings["h"]
        near["t"] += [str(settings["t"])] * bool(row)
    elif counts and "t" in settings and not near["h"]:
        settings["h"] = settings["t"] / counts[0]
    if not row and (_AT_START.search(before) or _AT_START_BEHIND.match(after)):
        settings["t"], near["t"] = Fraction(0), ["0"]
    one = frozenset(x for x, given in near.items() if len({*map(Fraction, given)}) == 1)
    return settings, one, bool(row or near["t"] or taken)


def _said(x: str, pattern: re.Pattern[str], behind: str, sentence: tuple[str, str]) -> list[str]:
    """The values of a setting that the sentence gives: right behind the number, before it, or the next one after it."""
    before, after = sentence
    said = pattern.findall(before)
    beside = re.match(rf",? ?(?:(?!and |or |but )\w{{2,5}} )?{pattern.pattern}(?! ?[=≈])", behind)
    if beside and not (said and behind.startswith(",")):  # in 0.01, with h = 0.5 by 0.02, that of the next number
        return [beside[1]]
    said = said or (durations(before) if x == "t" else [])
    return said or pattern.findall(_NEXT.split(after)[0])[:1]


def _gives_several(pattern: re.Pattern[str], far: str) -> bool:
    """True if the last line that gives a setting gives several: heads that could not be told apart, perhaps."""
    lines = [*filter(None, map(pattern.findall, far.split("\n")))]
    return any(len({*line}) > 1 for line in lines[-1:])


def _steps_taken(before: str, behind: str) -> list[int]:
    """After how many steps a number of a sentence stands, of what is right behind it or was said last; [] for none."""
    is_after = re.match(rf"(?:{PERCENT})? after ", behind)
    return (
        (counts_of_steps(behind)[:1] if is_after else [])
        or counts_of_steps(before)[-1:]
        or [1] * bool(_FIRST_STEP.search(before))
    )


def _size_in_order(before: str, after: str) -> Fraction | None:
    """The step size of a number in a list behind a list of as many, as in "for h = 1 and 0.5 they are 0.2 and 0.1"."""
    sizes = [*_SIZES.finditer(before)]
    left, right = rest_of_list(before, after, _JOINED)
    if not sizes or len(before) - len(left) < sizes[-1].end():
        return None
    given = re.findall(POSITIVE, re.sub(r"[a-zδ]", "", sizes[-1][0]))
    at, rest = (len(re.findall(LISTED_NUMBER, part)) for part in (left, right))
    return Fraction(given[at]) if len(given) == at + 1 + rest else None
