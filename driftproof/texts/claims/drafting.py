"""Draft a claims file from the values that the numbers of a text look like, for its author to complete."""

from __future__ import annotations

import json
import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby
from typing import TypeAlias

from driftproof.texts.claims.claims import MOST_CLAIMS
from driftproof.texts.claims.contradictions import begins_with_method, methods_named
from driftproof.texts.claims.phrases import Phrase
from driftproof.texts.claims.spellings import digits_of
from driftproof.texts.claims.stated_problems import equations_in, parameters_in
from driftproof.texts.claims.suggestions import LookAlike, Missed, Suggestions
from driftproof.texts.questions.decimals import HALF_EVEN, Style
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.numbers import TextNumber, numbers_in

# Words of a phrase before its first number: enough to tell which number of a sentence is meant; and how far before it a
# method is looked for, which the phrase of a value names.
_WORDS, _MOST_WORDS = 3, 10
_BEGINNING = re.compile(r"(?!(?<=\w)\w)\S+")  # not in the middle of a word
# A claim with longer questions takes its phrase as its id.
_LONGEST_ID = 150
# Significant digits shown of a value that the text does not contain, and the numbers that are named beside it.
_SHOWN_DIGITS, _MOST_PLACES = 8, 3
# Words before a number that the author chooses rather than computes, as in h = 0.1 or a start from (1, 0).
_SETTING = re.compile(
    r"(?<![\w./])(?:(?:h|dt|Δt|[tTNnkλμω]|lambda|mu|omega|[ra]?tol|t_?(?:end|max|final)|n(?:um)?_?steps) ?= ?"
    r"|[^\W\d_]'{0,2}\(0\) ?= ?|step ?size (?:of |= )?|[Aa]fter |from \((?:[-+]?[0-9./]+, ?)*)\Z"
)
_LONGEST_SETTING = 20
# The head of a column of such numbers.
_HEAD_OF_SETTINGS = re.compile(r"(?:h|dt|δt|t|n|k|z|λ|ω|time|steps?|step ?size)(?: ?[(\[](?![0-9]).*)?")
# Letters of settings that are also unknowns, as in ω' = -sin(θ), or eigenvalues, which have more than three digits.
_SOLVED_FOR = re.compile(r"[kznλμω]|lambda|mu|omega")
# Numbers on one line with gaps of at most this many characters share a phrase, up to this many of them.
_WIDEST_GAP, _MOST_IN_PHRASE = 25, 8

# What the remark on a number says that is perhaps wrong.
SLIP = " is perhaps a slip:"
_HEADER = """\
# Claims drafted by `driftproof check --init {name}`. Each phrase occurs in the text as often as its count says.
# A number that looks like a value need not mean that value: read each claim. Numbers that look like no value, or
# hardly like one, are comments: ask for the value (`driftproof value --help` shows how), or say why the number is
# given. What the text chooses, as in h = 0.1, is marked as given. If the text solves a problem of its own, say which
# one if it is not read from the text, and its numbers are drafted as well; the option may be repeated:
# --ask "run heun2 y'=-y, y(0)=1, h=0.1, t=1 : {{y,exact.y,error}}"
"""


@dataclass(frozen=True)
class _Member:
    """A number, the values that it looks like or is a slip for, and, if it is chosen, where h = or its cell begins."""

    number: TextNumber
    alike: list[LookAlike]
    slips: dict[str, str]
    strong: bool
    chosen_at: int | None

    @classmethod
    def of(
        cls, number: TextNumber, suggestions: Suggestions, text: str, equations: Mapping[int, int], letters: set[str]
    ) -> _Member:
        start, alike = max(0, number.start - _LONGEST_SETTING), suggestions.look_alikes(number)
        before = text[start : number.start].replace("\n", " ")
        parameter = re.search(r"(?<![\w./])([^\W\d]\w*) ?= ?\Z", before)
        found = _SETTING.search(before) or (parameter if parameter and parameter[1] in letters else None)
        setting, strong = start + found.start() if found else None, bool(alike) and alike[0].strong
        if _HEAD_OF_SETTINGS.fullmatch(suggestions.tables.column_of(number)):
            cell = re.search(r"(?m)(?:\||^) ?\Z", text[start : number.start])
            if cell and re.match(r" ?(?:[|\n]|\Z)", text[number.end :]):
                setting = start + cell.start()
        letter = _SOLVED_FOR.fullmatch(found[0].rstrip("= ") if found else suggestions.tables.column_of(number))
        if letter and (f"{letter[0]}'" in text or len(digits_of(number.text).rstrip("0")) > 3):
            setting = None
        if number.start in equations:
            strong, setting = False, equations[number.start]
        setting = suggestions.in_calculation.get(number.start, setting)
        return cls(number, alike, suggestions.slips(number), strong, None if strong else setting)

    @property
    def chosen(self) -> bool:
        return self.chosen_at is not None

    def remark(self, place: str) -> str:
        """A comment line with the other values that the number looks like, at most two of them, or a likely slip."""
        if self.slips:
            question, slip = min(self.slips.items(), key=lambda one: (abs(Fraction(one[1]) - self.number.value), one))
            other = next((one.question for one in self.alike if one.question != question), "")
            also = f"; it looks like {other}" * bool(other)
            return f"# {place}: {self.number.text}{SLIP} {question} is {slip}{also}\n"
        others = [alike.question for alike in self.alike[self.strong :]]
        more = f" and {len(rest)} more" if (rest := others[2:]) else ""
        also = "also " * self.strong
        shown = others and not self.chosen
        return f"# {self.number.text} looks {also}like {', '.join(others[:2])}{more}\n" if shown else ""


# Neighbouring numbers of one line that go into one phrase: strong look-alikes and a setting before them, or neither.
_Group: TypeAlias = list[_Member]
_Bounded: TypeAlias = tuple[int, int, _Group]


def draft(document: Document, name: str, asked: Iterable[str] = ()) -> str:
    """The draft of a claims file for the text called `name`, with one claim for each group of uncovered numbers.

    The `asked` questions whose values the text does not contain are listed at the end. Raises ValueError if there would
    be more claims than a file may have, and for a question without an answer.
    """
    text = document.text.text
    suggestions, search = Suggestions(text, asked), _Search(text)
    equations = {at: start for start, end in equations_in(text) for at in range(start, end)}
    counted, letters = [number for number in search.numbers if number.label is None], parameters_in(text)
    members = [_Member.of(number, suggestions, text, equations, letters) for number in counted]
    code = {at for span in document.code for at in range(*span)}
    # A single digit of a program, such as an initial 1.0 or a number of turns, looks like too much to be a value.
    in_code = [m for m in members if m.number.start in code]
    inputs = [m for m in in_code if not (m.strong and len(digits_of(m.number.text).rstrip("0")) > 1)]
    members = [member for member in members if member not in inputs]
    fences = sorted({0, len(text), *(at for one in inputs for at in (one.number.start, one.number.end))})
    drafted, covered, ids = [_HEADER.format(name=" ".join(name.split()))], set[int](), Counter[str]()
    if suggestions.stated:
        drafted.append("# Read from the text:\n" + "".join(f"# --ask {_quoted(one)}\n" for one in suggestions.stated))
    questions = {member.number.start: member.alike[0].question for member in members if member.strong}
    for *room, group in _uncovered([*_groups(text, members, fences)], fences, covered):
        if len(drafted) > MOST_CLAIMS:
            raise ValueError(f"claims for more than {MOST_CLAIMS} groups of numbers are not drafted")
        first = group[0].number
        place = "line {}, column {}".format(*document.position(first.start))
        phrase, stands = search.phrase(room, group)
        meant = [[questions.get(at + member.number.start - first.start) for member in group] for at in stands]
        if any(one != meant[0] for one in meant):  # the same words and numbers elsewhere do not mean the same
            group = [replace(member, strong=False) for member in group]
            phrase, stands = search.phrase(room, group)
        covered |= {at + member.number.start - first.start for at in stands | {first.start} for member in group}
        claim = f"# {place}: no phrase can be drafted for {first.text}\n"
        drafted.append(_claim(group, phrase, len(stands), place, ids) if stands else claim)
    missed = sorted(suggestions.nowhere(), key=lambda one: not one[2])
    for guessed, said in enumerate(("but not found in the text", "and found only as a guess, a comment above")):
        lines = [_asked_line(document, one) for one in missed if bool(one[3] and not one[2]) == guessed]
        drafted += [f"# Asked for with --ask, {said}:\n{''.join(lines)}"] * bool(lines)
    for why, those in suggestions.not_asked.items():
        drafted += [f"# Not asked, because {why}: {len(those)}, such as {next(iter(those))}\n"] if those else []
    if inputs:
        drafted.append(f"# Left out: numbers in program code, {len(inputs)} in all; they are inputs, not claims.\n")
    return "\n".join(drafted).rstrip("\n")


def _claim(group: _Group, phrase: str, count: int, place: str, ids: Counter[str]) -> str:
    """The claim of a group, with remarks; a comment with its `place` as id if its numbers are only guessed."""
    head, line = group[0], place.partition(",")[0]
    valued, chosen = any(member.strong for member in group), head.chosen
    if valued or chosen:
        asked = ", ".join(member.alike[0].question for member in group if member.strong)
        place = asked if asked and len(asked) <= _LONGEST_ID else phrase
        ids[place] += 1
        place += f" ({ids[place]})" if ids[place] > 1 else ""
    lines = ["[[claim]]", f"id = {_quoted(place)}", f"phrase = {_quoted(phrase)}", *[f"count = {count}"] * (count > 1)]
    if valued or chosen:
        lines += _values([member for member in group if member.strong]) if valued else []
        lines += ['given = "the text chooses it"'] * chosen
    else:
        lines = [f"# {line}" for line in ("TODO", *lines, 'given = "TODO: why"')]
    return "".join([*dict.fromkeys(member.remark(line) for member in group), *(f"{line}\n" for line in lines)])


def _asked_line(document: Document, missed: Missed) -> str:
    """The line of an asked value without a claim: the value, and at most _MOST_PLACES numbers that may mean it."""
    question, answer, slips, vague = missed
    shown = answer.digits(_SHOWN_DIGITS, Style(HALF_EVEN)) if answer.is_number else str(answer.exact_text)
    shown = shown if "e" in shown else re.sub(r"(\.[0-9]*?)0+\Z", r"\1", shown).removesuffix(".")
    places = [f"{x.text} in line {document.position(x.start).line}" for x in (slips or vague)[:_MOST_PLACES]]
    return f"#   {question}, {shown}{(bool(places) * ('; a slip? ' if slips else '; perhaps ')) + ', '.join(places)}\n"


def _uncovered(groups: list[_Group], fences: list[int], covered: set[int]) -> Iterator[_Bounded]:
    """The runs of the groups that no drafted phrase covers, each with the bounds that its phrase must stay within."""
    befores = [fences[0], *(group[-1].number.end for group in groups)]
    afters = [*(group[0].number.start for group in groups[1:]), fences[-1]]
    for before, after, group in zip(befores, afters, groups, strict=False):
        starts = [member.number.start for member in group]
        at = bisect_right(fences, min(starts))  # a number that is left out may stand in no phrase
        ends = [max(before, fences[at - 1]), *(member.number.end for member in group)]
        for is_covered, run in groupby(range(len(group)), lambda i, starts=starts: starts[i] in covered):  # type: ignore[misc]
            part = [*run]
            if not is_covered:
                end = [*starts, min(after, fences[at])][part[-1] + 1]
                yield ends[part[0]], end, group[part[0] : part[-1] + 1]


def _groups(text: str, members: list[_Member], fences: list[int]) -> Iterator[_Group]:
    """The groups of the members; none extends over a fence, an end of a number that may stand in no phrase."""
    group: _Group = []
    for member in members:
        if group:
            last = group[-1]
            between = text[last.number.end : member.number.start]
            together = len(between) <= _WIDEST_GAP and not re.search(r"[.;?!] |\S.*\n|\n.*\S", between)
            alike = (last.strong, last.chosen_at) == (member.strong, member.chosen_at) or (
                last.chosen and member.strong
            )
            fenced = bisect_right(fences, last.number.start) != bisect_right(fences, member.number.start)
            if not (together and alike and not fenced and len(group) < _MOST_IN_PHRASE):
                yield group
                group = []
        group.append(member)
    if group:
        yield group


class _Search:
    """An index of the places of phrases: a search of the whole text for each phrase would take quadratic time."""

    def __init__(self, text: str) -> None:
        self.text, self.flat, self.numbers = text, text.replace("\n", " "), numbers_in(text)
        self._starts: dict[str, list[int]] = {}
        for number in self.numbers:
            self._starts.setdefault(number.text, []).append(number.start)
        self._alike: dict[tuple[int, int, str], dict[str, list[int]]] = {}
        self._stands: dict[tuple[str, str], set[int]] = {}

    def phrase(self, room: list[int], group: _Group) -> tuple[str, set[int]]:
        """A phrase with the group's numbers and all positions of its first number; ("", set()) if none matches here.

        The phrase lies within `room` and begins up to _WORDS words before the first number, with its setting, or with
        the method or the heads of the table that say what a value is. Text after the last number is included only if it
        belongs to the number, as in " %". Strong look-alikes become placeholders for values; other numbers stand in the
        phrase literally.
        """
        head, *_ = group
        text, start, end = self.text, head.number.start, group[-1].number.end
        first = at = self._beginning(room[0], group)
        phrase, names = "", iter(_names(group))
        for number, strong in ((member.number, member.strong) for member in group):
            phrase += _escaped(text[at : number.start]) + (f"{{{next(names)}}}" if strong else _escaped(number.text))
            at = number.end
        cell = head.chosen and not text[first:start].strip("| ")
        for more in (*[r" ?\|\|?"] * cell, r"", r"\S+", r"\S*\s+\S+"):
            follows = re.match(more, text[end : room[1]])
            last = end + len(follows[0].rstrip(".,;:!? ") if follows else "")
            longer = phrase + _escaped(text[end:last])
            stands = self._found(longer, group, first, last)
            if start in stands:
                return longer, stands
        return "", set()

    def _beginning(self, least: int, group: _Group) -> int:
        """The place, at `least`, where the phrase of the group begins."""
        text, start, chosen_at = self.text, group[0].number.start, group[0].chosen_at
        words = [match.start() for match in _BEGINNING.finditer(text, least, start)]
        first = words[-_WORDS:][0] if words else start
        first = first if chosen_at is None else max(least, chosen_at)
        if not any(member.strong for member in group):
            return first
        line = text.rfind("\n", 0, start) + 1
        if "|" in text[line:start]:
            above = text.rfind("\n", 0, max(0, line - 1)) + 1
            heads = text[above:line]
            is_first = not text[line:first].strip("| ") and "|" in heads and all(x.label for x in numbers_in(heads))
            return max(least, above) if is_first else first
        begins, named = start, set[str]()
        for word in reversed(words[-_MOST_WORDS:]):
            said = text[word:start].lower()
            longer = methods_named(said)
            if re.search(r"[.;?!]\s", said) or (named == longer and named and not begins_with_method(said)):
                break
            begins, named = word if longer else begins, longer  # "backward Euler" is no "Euler"
        return min(first, begins)

    def _found(self, phrase: str, group: _Group, first: int, last: int) -> set[int]:
        """The positions of the first number in all matches of the phrase, which was drafted from text[first:last]."""
        key = phrase, self.flat[first:last]
        if key not in self._stands:
            stands, done, before = self._stands.setdefault(key, set()), 0, group[0].number.start - first
            try:
                parsed = Phrase.of(phrase)
            except ValueError:  # too long
                return stands
            if not (parsed.names or parsed.free_numbers):  # its numbers run together, as in 0.50.5
                return stands
            strong = [member.number.text for member in group if member.strong]
            pattern = parsed.exact({name: [spelled] for name, spelled in zip(_names(group), strong, strict=True)})
            for place in self._places(before, last - first, group[0].number.text).get(key[1], ()):
                if place - before >= done and (match := pattern.match(self.text, place - before)):
                    stands.add(place)
                    done = match.end()
        return self._stands[key]

    def _places(self, before: int, length: int, number: str) -> dict[str, list[int]]:
        """The positions of the number, keyed by the `length` characters that begin `before` characters ahead of it."""
        shape = before, length, number
        if shape not in self._alike:
            places = self._alike[shape] = {}
            for at in self._starts[number]:
                if at >= before:
                    places.setdefault(self.flat[at - before : at - before + length], []).append(at)
        return self._alike[shape]


def _names(group: _Group) -> list[str]:
    """The names of the placeholders for the strong members."""
    count = sum(member.strong for member in group)
    return ["value"] if count == 1 else [chr(ord("a") + i) for i in range(count)]


def _escaped(text: str) -> str:
    return text.replace("\n", " ").replace("{", "{{").replace("}", "}}")


def _values(group: _Group) -> list[str]:
    best = []
    for alike, *_ in (member.alike for member in group):
        sizes = (("places", alike.form.places), ("digits", alike.form.digits))
        form = ["exact = true"] * alike.form.exact + [f"{key} = {n}" for key, n in sizes if n is not None]
        best.append((_quoted(alike.question), form))
    if len(best) == 1:
        return [f"value = {best[0][0]}", *best[0][1]]
    tables = [f"{{ {', '.join([f'ask = {question}', *form])} }}" if form else question for question, form in best]
    return [f"values = {{ {', '.join(map('{} = {}'.format, _names(group), tables))} }}"]


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
