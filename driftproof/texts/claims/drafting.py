"""A claims file drafted from a text: what a value of ours looks like is claimed, the rest is left to be said."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

from driftproof.texts.claims.phrases import NumberForm, Phrase
from driftproof.texts.claims.suggestions import LookAlike, Suggestions
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.numbers import TextNumber, numbers_in

# Words of a phrase before its first number and after its last: more of them until it stands there and only once.
_BEFORE, _AFTER = range(3, 12), range(4)
# Numbers on one line that are no further apart stand in one phrase, if it has room for them.
_WIDEST_GAP, _MOST_IN_PHRASE = 25, 8
_MOST_DRAFTED = 5000

_HEADER = """\
# Claims drafted by `driftproof check --init {name}`. Every phrase stands in the text as often as it says.
# That a value looks like a number is no proof that the text means it: read each claim. What looks like no value follows
# as a comment; ask for its value (`driftproof value --help` teaches how), or say why it is given.
"""


@dataclass(frozen=True)
class _Member:
    """A number, and the values that it looks like."""

    number: TextNumber
    alike: list[LookAlike]

    @property
    def strong(self) -> bool:
        return bool(self.alike) and self.alike[0].strong

    def remark(self) -> str:
        """What else it looks like, two of them by name."""
        others = [alike.question for alike in self.alike[self.strong :]]
        more = f" and {len(others) - 2} more" if len(others) > 2 else ""
        also = "also " * self.strong
        return f"# {self.number.text} looks {also}like {', '.join(others[:2])}{more}\n" if others else ""


# Neighbours on one line, all of which look like values, or none of which do.
_Group: TypeAlias = list[_Member]


def draft(document: Document, name: str) -> str:
    """The text of a claims file for a text called `name`: one claim for each group of numbers that none before covers.

    Raises ValueError where the text has too many numbers.
    """
    text = document.text.text
    found = [number for number in numbers_in(text) if number.label is None]
    if len(found) > _MOST_DRAFTED:
        raise ValueError(f"the text has {len(found)} numbers; claims for more than {_MOST_DRAFTED} are not drafted")
    suggestions = Suggestions(text)
    groups = [*_groups(text, [_Member(number, suggestions.of(number)) for number in found])]
    ends = [0, *(group[-1].number.end for group in groups)]
    starts = [*(group[0].number.start for group in groups[1:]), len(text)]
    drafted, covered, named = [_HEADER.format(name=" ".join(name.split()))], set[int](), Counter[str]()
    for *room, group in zip(ends, starts, groups, strict=False):
        first = group[0].number
        if first.start in covered:
            continue
        place = "line {}, column {}".format(*document.position(first.start))
        phrase, stands = _best_phrase(text, room, group)
        covered.update(stands)
        if not stands:
            drafted.append(f"# {place}: no phrase can be drafted for {first.text}\n")
            continue
        if group[0].strong:
            place = ", ".join(member.alike[0].question for member in group)
            named[place] += 1
            place += f" ({named[place]})" if named[place] > 1 else ""
        lines = [f"id = {_quoted(place)}", f"phrase = {_quoted(phrase)}"]
        lines += [f"count = {len(stands)}"] if len(stands) > 1 else []
        if group[0].strong:
            lines = ["[[claim]]", *lines, *_values(group)]
        else:
            lines = [f"# {line}" for line in ("TODO", "[[claim]]", *lines, 'given = "TODO: why"')]
        remarks = dict.fromkeys(member.remark() for member in group)
        drafted.append("".join([*remarks, *(f"{line}\n" for line in lines)]))
    return "\n".join(drafted)


def _groups(text: str, members: list[_Member]) -> Iterator[_Group]:
    group: _Group = []
    for member in members:
        if group:
            between = text[group[-1].number.end : member.number.start]
            together = "\n" not in between and len(between) <= _WIDEST_GAP and not re.search(r"[.;?!] ", between)
            if not (together and group[-1].strong == member.strong and len(group) < _MOST_IN_PHRASE):
                yield group
                group = []
        group.append(member)
    if group:
        yield group


def _best_phrase(text: str, room: list[int], group: _Group) -> tuple[str, list[int]]:
    """The phrase that stands once, or else least often, and where its first number does; ("", []) if none stands."""
    best: tuple[str, list[int]] = ("", [])
    for after, before in product(_AFTER, _BEFORE):
        phrase, first = _phrase(text, room, group, before, after)
        spellings = {name: [member.number.text] for name, member in zip(_names(group), group, strict=True)}
        try:
            found = [match.start() for match in Phrase.of(phrase).exact(spellings).finditer(text)]
        except ValueError:  # too long
            continue
        if first in found and (not best[1] or len(found) < len(best[1])):
            best = (phrase, [at - first + group[0].number.start for at in found])
        if found == [first]:
            break
    return best


def _phrase(text: str, room: list[int], group: _Group, before: int, after: int) -> tuple[str, int]:
    """The phrase with at most so many words before its first number and after its last, and where it begins.

    Its numbers are places for values if they are strong, and stand in it otherwise.
    """
    start = group[0].number.start
    chunks = [room[0] + match.start() for match in re.finditer(r"\S+", text[room[0] : start])]
    starts = [at for at in chunks if not re.match(r"\w\w", text[max(at - 1, 0) : at + 1])]
    first = at = starts[-before] if len(starts) >= before else starts[0] if starts else start
    phrase = ""
    for member, name in zip(group, _names(group), strict=True):
        number = member.number
        phrase += _escaped(text[at : number.start]) + (f"{{{name}}}" if member.strong else _escaped(number.text))
        at = number.end
    follows = re.match(rf"\S*(?:\s+\S+){{0,{after - 1}}}", text[at : room[1]]) if after else None
    return phrase + (_escaped(follows[0]).rstrip(".,;:!? ") if follows else ""), first


def _names(group: _Group) -> list[str]:
    return ["value"] if len(group) == 1 else [chr(ord("a") + i) for i in range(len(group))]


def _escaped(text: str) -> str:
    return text.replace("\n", " ").replace("{", "{{").replace("}", "}}")


def _values(group: _Group) -> list[str]:
    best = [(_quoted(member.alike[0].question), _form(member.alike[0].form)) for member in group]
    if len(best) == 1:
        return [f"value = {best[0][0]}", *best[0][1]]
    tables = [f"{{ {', '.join([f'ask = {question}', *form])} }}" if form else question for question, form in best]
    return [f"values = {{ {', '.join(map('{} = {}'.format, _names(group), tables))} }}"]


def _form(form: NumberForm) -> list[str]:
    if form.exact:
        return ["exact = true"]
    return [f"{key} = {n}" for key, n in (("places", form.places), ("digits", form.digits)) if n is not None]


def _quoted(text: str) -> str:
    """A TOML string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
