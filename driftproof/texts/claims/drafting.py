"""What the numbers of a text might be, of our values written as they are; and claims drafted from that."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TypeAlias

from driftproof.methods.catalogue import METHODS
from driftproof.methods.names import also_known_as
from driftproof.texts.claims.claims import MOST_CLAIMS
from driftproof.texts.claims.phrases import NumberForm, Phrase
from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.values.published import published_values

# What is asked, of the methods of which a text is taken to speak where it names none that we know.
_USUAL_METHODS = ("forward_euler", "symplectic_euler", "velocity_verlet", "rk4")
_USUAL_STEPS = ("1/4", "1/2", "1/10")
_RUN_READOUTS = ("state_error", "energy", "energy_change", "phase_error", "q", "v", "steps", "evaluations")
_STEP_READOUTS = ("q", "v", "energy")
_USUAL_FACTS = ("imaginary_limit", "real_limit", "order", "error_constant")
# A few hundred questions, which take a second or two; runs of more steps are not cheap.
_MOST_METHODS, _MOST_SIZES, _MOST_TIMES = 6, 4, 2
_LONGEST_RUN = 10_000
# Of so many numbers with these digits one at most, drawn at random, would look like a value whose names stand as near.
_ODDS = 100
# Characters on each side of a number in which the names of a value are looked for: about a line.
_NEIGHBOURHOOD = 100

_H, _T = (re.compile(rf"\b{letter} ?= ?([0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?)(?![\w./])") for letter in "ht")


@dataclass(frozen=True)
class LookAlike:
    """A value that looks like a number when written in `form`: its id or question.

    It is `strong`, no guess, where chance would make so few numbers of as many digits look like a value as near by
    its names, or where the number is the value itself and all its names are near.
    """

    question: str
    form: NumberForm
    strong: bool


@dataclass(frozen=True)
class _Known:
    """A value that a number might be: its question, or its id where it is published, and the answer."""

    question: str
    published: bool
    answer: Answer

    @cached_property
    def names(self) -> list[str]:
        """What the value is called, but for single letters and what is said of every value."""
        words = re.split(r"[^a-z0-9]+", re.sub(r"\b(?:run|step|from) |[htN]=\S+", "", self.question))
        return [word for word in dict.fromkeys(words) if len(word) > 1 and not word.isdigit()]


class Suggestions:
    """What the numbers of a text might be."""

    def __init__(self, text: str) -> None:
        """The text is in canonical spelling."""
        self.text = text
        self._spelled: dict[NumberForm, dict[str, list[_Known]]] = {}

    def of(self, number: TextNumber) -> list[LookAlike]:
        """Every value that is written like the number, the best first: its names stand nearby, or it is equal."""
        try:
            x = number.value
        except (ValueError, ZeroDivisionError):
            return []
        fits = self._fits(self.text[max(0, number.start - _NEIGHBOURHOOD) : number.end + _NEIGHBOURHOOD].lower())
        digits = _digits(re.split(r"[eE]| ?[×·]", number.text)[0])
        spelled = re.sub(r" ?[×·] ?10\^\{?(-?[0-9]+)\}?", r"e\1", number.text.replace(",", "").lstrip("+"))
        form, found = _form_of(number), []
        for known in self._written(form).get(spelled, ()):
            fit = fits[known.question]
            rivals = sum(other >= fit for other in fits.values())
            strong = rivals * _ODDS <= 9 * 10 ** (digits - 1) if digits else False
            strong = strong or (known.answer.exact == x and fit == len(known.names) > 1)
            order = (-fit, known.answer.exact != x, not known.published, len(known.question), known.question)
            found.append((order, LookAlike(known.question, form, strong)))
        return [alike for _, alike in sorted(found, key=lambda pair: pair[0])]

    def _fits(self, near: str) -> dict[str, int]:
        """Of every value, how many of its names stand in `near`."""
        stand = {name for name in self._all_names if re.search(rf"(?<![a-z]){name}", near)}
        return {known.question: sum(name in stand for name in known.names) for known in self._known}

    @cached_property
    def _all_names(self) -> set[str]:
        return {name for known in self._known for name in known.names}

    def _written(self, form: NumberForm) -> dict[str, list[_Known]]:
        """The values by their spellings in this form; one that cannot be written so, as a tie, is left out."""
        if form not in self._spelled:
            table = self._spelled[form] = {}
            for known in self._known:
                with suppress(ValueError):
                    for spelling in form.spellings(known.answer):
                        table.setdefault(spelling, []).append(known)
        return self._spelled[form]

    @cached_property
    def _known(self) -> list[_Known]:
        """The published values, and those of the usual questions about the methods, steps and times of the text."""
        found = []
        for question in (ids := published_values()) | dict.fromkeys(self._questions()):
            with suppress(ValueError):  # of a question that a method has no answer to
                found.append(_Known(question, question in ids, value(question)))
        return found

    def _questions(self) -> Iterator[str]:
        sizes, times = _given(_H, self.text, _USUAL_STEPS)[:_MOST_SIZES], _given(_T, self.text, ("10",))[:_MOST_TIMES]
        for method in _methods_in(self.text):
            yield from (f"{fact} {method}" for fact in _USUAL_FACTS)
            for h in sizes:
                yield from (f"step {method} h={h} : {readout}" for readout in _STEP_READOUTS)
                for t in times:
                    if (n := Fraction(t) / Fraction(h)).denominator == 1 and n <= _LONGEST_RUN:
                        yield from (f"run {method} h={h} t={t} : {readout}" for readout in _RUN_READOUTS)
        yield from (f"exact t={t} : {readout}" for t in (*times, *sizes) for readout in "qv")


def _methods_in(text: str) -> list[str]:
    """The methods whose keys, titles or other names stand in the text, or else the usual ones."""
    flat = text.lower().replace("\n", " ").replace("-", " ")
    called = {key: (key, method.title, *also_known_as(key)) for key, method in METHODS.items()}
    spoken = {
        key: "|".join(re.escape(name.lower().replace("-", " ")) for name in names) for key, names in called.items()
    }
    named = [key for key, names in spoken.items() if re.search(rf"\b(?:{names})\b", flat)]
    usual = [key for key in _USUAL_METHODS if key in named or key.replace("_", " ") in flat]
    return (list(dict.fromkeys([*usual, *named])) or list(_USUAL_METHODS))[:_MOST_METHODS]


def _given(pattern: re.Pattern[str], text: str, default: Iterable[str]) -> list[str]:
    """The positive numbers that the text gives to a letter, then the default ones, each once."""
    spelled = [number for number in (*pattern.findall(text), *default) if len(number) < 20]
    return [str(x) for x in dict.fromkeys(map(Fraction, spelled)) if x]


def _form_of(number: TextNumber) -> NumberForm:
    """The form in which the number stands."""
    if "/" in number.text:
        return NumberForm(exact=True)
    if number.places is None:
        return NumberForm(digits=max(1, _digits(re.split(r"[eE]| ?[×·]", number.text)[0])))
    return NumberForm(places=number.places or None)


def _digits(text: str) -> int:
    """How many digits it has from the first that is not 0."""
    return len(re.sub(r"[^0-9]", "", text).lstrip("0"))


# Words of a phrase before its first number: enough to say in a table or a sentence which number is meant.
_WORDS = 3
# Numbers on one line that are no further apart stand in one phrase.
_WIDEST_GAP, _MOST_IN_PHRASE = 25, 8

_HEADER = """\
# Claims drafted by `driftproof check --init {name}`. Every phrase stands in the text as often as it says.
# That a value looks like a number is no proof that the text means it: read each claim. What looks like no value, or so
# little like one that it may be chance, is a comment; ask for its value (`driftproof value --help` teaches how), or say
# why it is given.
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

    Raises ValueError where that would be more claims than a file may have.
    """
    text = document.text.text
    suggestions, search = Suggestions(text), _Search(text)
    members = [_Member(number, suggestions.of(number)) for number in search.numbers if number.label is None]
    drafted, covered, named = [_HEADER.format(name=" ".join(name.split()))], set[int](), Counter[str]()
    groups = [*_groups(text, members)]
    ends = [0, *(group[-1].number.end for group in groups)]
    starts = [*(group[0].number.start for group in groups[1:]), len(text)]
    for *room, group in zip(ends, starts, groups, strict=False):
        first = group[0].number
        if first.start in covered:
            continue
        if len(drafted) > MOST_CLAIMS:
            raise ValueError(f"claims for more than {MOST_CLAIMS} groups of numbers are not drafted")
        place = "line {}, column {}".format(*document.position(first.start))
        phrase, stands = search.phrase(room, group)
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


class _Search:
    """Where phrases stand. To search the whole text for each of them would take the square of its length."""

    def __init__(self, text: str) -> None:
        self.text, self.flat, self.numbers = text, text.replace("\n", " "), numbers_in(text)
        self._starts: dict[str, list[int]] = {}
        for number in self.numbers:
            self._starts.setdefault(number.text, []).append(number.start)
        self._alike: dict[tuple[int, int, str], dict[str, list[int]]] = {}
        self._stands: dict[tuple[str, str], set[int]] = {}

    def phrase(self, room: list[int], group: _Group) -> tuple[str, set[int]]:
        """A phrase with the group's numbers, and where the first of them stands; ("", {}) if none stands there.

        It lies within `room` and begins with _WORDS before the first number; what follows the last is in it only where
        it belongs to the number, as " %". Numbers are places for values if they are strong, else they stand in it.
        """
        text, start, end = self.text, group[0].number.start, group[-1].number.end
        words = [room[0] + match.start() for match in re.finditer(r"\S+", text[room[0] : start])]
        words = [at for at in words if not re.match(r"\w\w", text[max(at - 1, 0) : at + 1])][-_WORDS:]
        first = at = words[0] if words else start
        phrase = ""
        for member, name in zip(group, _names(group), strict=True):
            number = member.number
            phrase += _escaped(text[at : number.start]) + (f"{{{name}}}" if member.strong else _escaped(number.text))
            at = number.end
        for more in (r"", r"\S+", r"\S*\s+\S+"):
            follows = re.match(more, text[end : room[1]])
            last = end + len(follows[0].rstrip(".,;:!? ") if follows else "")
            longer = phrase + _escaped(text[end:last])
            stands = self._found(longer, group, first, last)
            if start in stands:
                return longer, stands
        return "", set()

    def _found(self, phrase: str, group: _Group, first: int, last: int) -> set[int]:
        """Where the first number stands in the phrase, which is made of the text from `first` to `last`."""
        key = phrase, self.flat[first:last]
        if key not in self._stands:
            stands, done, before = self._stands.setdefault(key, set()), 0, group[0].number.start - first
            try:
                parsed = Phrase.of(phrase)
            except ValueError:  # too long
                return stands
            if not (parsed.names or parsed.free_numbers):  # its numbers run together to what is no number, as 0.50.5
                return stands
            pattern = parsed.exact({name: [m.number.text] for name, m in zip(_names(group), group, strict=True)})
            for place in self._places(before, last - first, group[0].number.text).get(key[1], ()):
                if place - before >= done and (match := pattern.match(self.text, place - before)):
                    stands.add(place)
                    done = match.end()
        return self._stands[key]

    def _places(self, before: int, length: int, number: str) -> dict[str, list[int]]:
        """Where the number stands, by the `length` characters that begin so many before it."""
        shape = before, length, number
        if shape not in self._alike:
            places = self._alike[shape] = {}
            for at in self._starts[number]:
                if at >= before:
                    places.setdefault(self.flat[at - before : at - before + length], []).append(at)
        return self._alike[shape]


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
