"""Search a text for the phrases of a draft: those that say which number is meant, and all places where they stand."""

from __future__ import annotations

import re
from collections.abc import Iterable

from driftproof.texts.claims.phrases import LONGEST_PHRASE, Phrase
from driftproof.texts.drafts.members import Group
from driftproof.texts.readers.number_words import words_like
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.words.method_names import begins_with_method, methods_named
from driftproof.texts.words.tables import ANYWHERE, Address, tables_of

# Words of a phrase before its first number: enough to tell which number of a sentence is meant; and how far before it a
# method is looked for, which the phrase of a value names.
_WORDS, _MOST_WORDS = 3, 10
# Characters of a row before its first value that its phrase may begin with.
_LONGEST_LABEL = 150
_BEGINNING = re.compile(r"(?!(?<=\w)\w)\S+")  # not in the middle of a word


class PhraseSearch:
    """The phrases of one text, each with the places where it stands, which are searched for once."""

    def __init__(self, text: str) -> None:
        self.text, self.flat, self.tables = text, text.replace("\n", " "), tables_of(text)
        self._stands: dict[tuple[str, str], set[int]] = {}

    def phrase(self, room: list[int], group: Group, bound: bool = False) -> tuple[str, set[int], Address]:
        """A phrase with the group's numbers, "" if none matches here; all positions of its first number; their address.

        These are the row and column of values and likely slips in a table, or if `bound`, where the phrase lacks them.

        The phrase lies within `room` and begins up to _WORDS words before the first number, with its setting, or with
        the method or the heads of the table that say what a value is. Text after the last number is included only if it
        belongs to the number, as in " %". Strong look-alikes become placeholders for values; other numbers stand in the
        phrase literally.
        """
        head, *_ = group
        text, start, end = self.text, head.number.start, group[-1].number.end
        first = at = self._beginning(room[0], group)
        line, address = text.rfind("\n", 0, start) + 1, ANYWHERE
        valued = [x.number.start for x in group if x.strong]
        if text[line:first].strip("| ") and (bound or valued or any(x.slips for x in group)):
            address = self.tables.address(head.number)
            row, column = (x if len(x) <= LONGEST_PHRASE else "" for x in address[:2])
            address = Address(row, column)
        heads = [self.tables.head_at(x) for x in valued * ("\n" not in text[first:start])]
        if any(heads) and len("".join(heads)) <= LONGEST_PHRASE:
            alone = valued == [start]
            address = address._replace(column=heads[0] * alone, columns=(*heads[alone:],))
        phrase, names = "", iter(placeholders(group))
        for number, strong in ((member.number, member.strong) for member in group):
            phrase += as_phrase(text[at : number.start]) + (f"{{{next(names)}}}" if strong else as_phrase(number.text))
            at = number.end
        cell = head.chosen and not text[first:start].strip("| ")
        until = min(max(end, group[-1].until), room[1])
        whole = [re.escape(rest)] if (rest := text[end:until].rstrip()) else []
        for more in (*whole, *[r" ?\|\|?"] * cell, r"", r"\S+", r"\S*\s+\S+"):
            follows = re.match(more, text[end : room[1]])
            last = end + len(follows[0].rstrip(".,;:!? ") if follows else "")
            longer = phrase + as_phrase(text[end:last])
            stands = self._found(longer, group, first, last)
            if start in stands:
                if cell and any(self.tables.head_at(at) != self.tables.head_at(start) for at in stands):
                    address = Address(column=self.tables.head_at(start))  # z = -1, and no R(z)
                heads_at = [x - start for x in valued] if address.columns else []
                return longer, {at for at in stands if at == start or self._is_at(address, at, heads_at)}, address
        return "", set(), address

    def _is_at(self, address: Address, start: int, valued: Iterable[int]) -> bool:
        """True if the place has that address, and the values so far behind it those columns."""
        heads = tuple(self.tables.head_at(start + x) for x in valued)
        return self.tables.stands_at(address, start) and heads == address.columns

    def _beginning(self, least: int, group: Group) -> int:
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
            labelled = least <= line and start - line < _LONGEST_LABEL
            if not re.search(r"\w", heads):  # |- on a page of a wiki
                return line if labelled else max(first, line)
            is_first = not text[line:first].strip("| ") and "|" in heads and all(x.label for x in numbers_in(heads))
            return max(least, above) if is_first else min(first, line) if labelled else first
        begins, named = start, set[str]()
        for word in reversed(words[-_MOST_WORDS:]):
            said = text[word:start].lower()
            longer = methods_named(said)
            if re.search(r"[.;?!]\s", said) or (named == longer and named and not begins_with_method(said)):
                break
            begins, named = word if longer else begins, longer  # "backward Euler" is no "Euler"
        return min(first, begins)

    def _found(self, phrase: str, group: Group, first: int, last: int) -> set[int]:
        """The positions of the first number in all matches of the phrase, which was drafted from text[first:last]."""
        key = phrase, self.flat[first:last]
        if key not in self._stands:
            stands, done, before = self._stands.setdefault(key, set()), 0, group[0].number.start - first
            try:
                parsed = Phrase.of(phrase)
            except ValueError:  # too long
                return stands
            if not (parsed.names or parsed.free_numbers_and_words):  # its numbers run together, as in 0.50.5
                return stands
            strong = [words_like(member.number.text) for member in group if member.strong]
            pattern = parsed.exact(dict(zip(placeholders(group), strong, strict=True)))
            if any(spellings[1:] for spellings in strong):  # other words stand elsewhere
                stands |= {match.start() + before for match in pattern.finditer(self.text)}
                return stands
            while (at := self.flat.find(key[1], done)) >= 0:
                match = pattern.match(self.text, at)
                stands |= {at + before} if match else set()
                done = match.end() if match else at + 1
        return self._stands[key]


def placeholders(group: Group) -> list[str]:
    """The names of the placeholders for the strong members."""
    count = sum(member.strong for member in group)
    return ["value"] if count == 1 else [chr(ord("a") + i) for i in range(count)]


def as_phrase(text: str) -> str:
    """The text as a phrase has it: on one line, its braces doubled."""
    return text.replace("\n", " ").replace("{", "{{").replace("}", "}}")
