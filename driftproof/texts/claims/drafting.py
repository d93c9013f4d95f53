"""A claims file drafted from a text: what a value of ours looks like is claimed, the rest is left to be said."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from driftproof.texts.claims.phrases import Phrase
from driftproof.texts.claims.spelling import Form
from driftproof.texts.claims.suggestions import Candidate, Suggestions
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.numbers import TextNumber, numbers_in

# Words of a phrase before its first number and after its last, until it stands there and only once.
EXTENTS = tuple((before, after) for after in range(4) for before in range(3, 12))
# Numbers on one line that are no further apart stand in one phrase, if it has room for them.
WIDEST_GAP, MOST_IN_PHRASE = 25, 8
LARGEST_DRAFT = 5000

HEADER = """\
# Claims drafted by `driftproof check --init {name}`. Every phrase stands in the text as often as it says.
# That a value looks like a number is no proof that the text means it: read each claim. What looks like no value follows
# as a comment; ask for its value (`driftproof value --help` teaches how), or say why it is given.
"""

# A number, and the values that it looks like.
Member: TypeAlias = tuple[TextNumber, list[Candidate]]
Group: TypeAlias = Sequence[Member]


def draft(document: Document, name: str) -> str:
    """The text of a claims file for a text called `name`."""
    return "\n".join([HEADER.format(name=" ".join(name.split())), *_Draft(document).claims()])


@dataclass
class _Draft:
    """The claims so far: which numbers they cover, and how often the same questions came up."""

    document: Document
    covered: set[int] = field(default_factory=set)
    named: Counter[str] = field(default_factory=Counter)

    def claims(self) -> Iterator[str]:
        """One claim for each group of numbers that no claim before it covers."""
        text = self.document.text.text
        found = [number for number in numbers_in(text) if number.label is None]
        if len(found) > LARGEST_DRAFT:
            raise ValueError(f"the text has {len(found)} numbers; claims for more than {LARGEST_DRAFT} are not drafted")
        suggestions = Suggestions(text)
        groups = list(_groups(text, [(number, suggestions.of(number)) for number in found]))
        ends = [0, *(group[-1][0].end for group in groups)]
        starts = [*(group[0][0].start for group in groups[1:]), len(text)]
        for end, start, group in zip(ends, starts, groups, strict=False):
            if group[0][0].start not in self.covered:
                yield self.claim(text, (end, start), group)

    def claim(self, text: str, room: tuple[int, int], group: Group) -> str:
        """A claim about the numbers of one group, whose phrase keeps to `room`; a remark where there is none."""
        line, column = self.document.position(group[0][0].start)
        strong = all(_is_strong(candidates) for _, candidates in group)
        written, found = _best_phrase(text, room, [number for number, _ in group], strong)
        if not found:
            return f"# line {line}, column {column}: no phrase can be drafted for {group[0][0].text}\n"
        self.covered.update(found)
        place = f"line {line}, column {column}"
        lines = [f"id = {_quoted(self.name_of(group) if strong else place)}", f"phrase = {_quoted(written)}"]
        lines += [f"count = {len(found)}"] if len(found) > 1 else []
        remark = "".join(dict.fromkeys(_remark(number, candidates) for number, candidates in group))
        if not strong:
            return remark + "".join(f"# {line}\n" for line in ("TODO", "[[claim]]", *lines, 'given = "TODO: why"'))
        return f"{remark}[[claim]]\n" + "".join(f"{line}\n" for line in (*lines, _values(group)))

    def name_of(self, group: Group) -> str:
        """The questions of the group, numbered where they have come up before."""
        questions = ", ".join(candidates[0].question for _, candidates in group)
        self.named[questions] += 1
        return questions if self.named[questions] == 1 else f"{questions} ({self.named[questions]})"


def _best_phrase(text: str, room: tuple[int, int], group: list[TextNumber], strong: bool) -> tuple[str, list[int]]:
    """The phrase that stands once, or else least often, and where its first number does; ("", []) if none stands."""
    best: tuple[str, list[int]] = ("", [])
    for before, after in EXTENTS:
        written, first = _phrase(text, room, group, before, after, strong)
        found = _starts(text, written, group if strong else [], first)
        if found and (not best[1] or len(found) < len(best[1])):
            best = (written, [at - first + group[0].start for at in found])
        if len(found) == 1:
            break
    return best


def _groups(
    text: str, found: list[tuple[TextNumber, list[Candidate]]]
) -> Iterator[list[tuple[TextNumber, list[Candidate]]]]:
    """Neighbours on one line, all of which look like values, or none of which do."""
    group: list[Member] = []
    for number, candidates in found:
        if group:
            last = group[-1][0]
            between = text[last.end : number.start]
            together = "\n" not in between and len(between) <= WIDEST_GAP and not re.search(r"[.;?!] ", between)
            alike = _is_strong(group[-1][1]) == _is_strong(candidates)
            if not (together and alike and len(group) < MOST_IN_PHRASE):
                yield group
                group = []
        group.append((number, candidates))
    if group:
        yield group


def _is_strong(candidates: list[Candidate]) -> bool:
    return bool(candidates) and candidates[0].strong


def _names(group: Sequence[object]) -> list[str]:
    return ["value"] if len(group) == 1 else [chr(ord("a") + i) for i in range(len(group))]


def _phrase(
    text: str, room: tuple[int, int], group: list[TextNumber], before: int, after: int, strong: bool
) -> tuple[str, int]:
    """The phrase with at most so many words before its first number and after its last, and where it begins.

    Its numbers are places for values if they are `strong`, and stand in it otherwise.
    """
    chunks = [room[0] + match.start() for match in re.finditer(r"\S+", text[room[0] : group[0].start])]
    starts = [at for at in chunks if not re.match(r"\w\w", text[max(at - 1, 0) : at + 1])]
    first = at = starts[-before] if len(starts) >= before else starts[0] if starts else group[0].start
    written = ""
    for number, name in zip(group, _names(group), strict=True):
        written += _escaped(text[at : number.start]) + (f"{{{name}}}" if strong else _escaped(number.text))
        at = number.end
    follows = re.match(rf"\S*(?:\s+\S+){{0,{after - 1}}}", text[at : room[1]]) if after else None
    return written + (_escaped(follows[0]).rstrip(".,;:!? ") if follows else ""), first


def _escaped(text: str) -> str:
    return text.replace("\n", " ").replace("{", "{{").replace("}", "}}")


def _starts(text: str, written: str, group: list[TextNumber], first: int) -> list[int]:
    """Where the phrase stands, everywhere in the text; nothing if it does not stand at `first`."""
    try:
        spellings = {name: [number.text] for name, number in zip(_names(group), group, strict=False)}
        pattern = Phrase.of(written).exact(spellings)
    except ValueError:
        return []
    found = [match.start() for match in pattern.finditer(text)]
    return found if first in found else []


def _values(group: Group) -> str:
    best = [candidates[0] for _, candidates in group]
    if len(best) == 1:
        return "\n".join([f"value = {_quoted(best[0].question)}", *_form(best[0].form)])
    tables = (f"{name} = {_value(one)}" for name, one in zip(_names(group), best, strict=True))
    return f"values = {{ {', '.join(tables)} }}"


def _value(candidate: Candidate) -> str:
    question, form = _quoted(candidate.question), _form(candidate.form)
    return f"{{ {', '.join([f'ask = {question}', *form])} }}" if form else question


def _form(form: Form) -> list[str]:
    if form.exact:
        return ["exact = true"]
    size = [f"{key} = {n}" for key, n in (("places", form.places), ("digits", form.digits)) if n is not None]
    return [*size, *([f'rounding = "{form.rounding}"'] if form.rounding else [])]


def _remark(number: TextNumber, candidates: list[Candidate]) -> str:
    others = [candidate.question for candidate in candidates[_is_strong(candidates) :]]
    if not others:
        return ""
    more = f" and {len(others) - 2} more" if len(others) > 2 else ""
    return f"# {number.text} looks {'also ' * _is_strong(candidates)}like {', '.join(others[:2])}{more}\n"


def _quoted(text: str) -> str:
    """A TOML string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
