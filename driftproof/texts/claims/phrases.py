"""A phrase of a text with places for values: the pattern of what must stand there, and of its shape."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from typing import TypeAlias

from driftproof.texts.claims.spelling import literal_pattern, pattern
from driftproof.texts.readers.canonical import canonical_spelling
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.readers.source_text import SourceText

LONGEST_PHRASE = 400
MOST_VALUES = 20
# The ways to write each value, by its name, the plainest first.
Spellings: TypeAlias = Mapping[str, list[str]]

_PLACEHOLDER = re.compile(r"\{\{|\}\}|\{(?P<name>[a-z][a-z0-9_]*)\}|[{}]")
# In a phrase a placeholder is one character of Unicode's private use, so that its spelling can be made canonical.
_FIRST_SEAT = 0xF000
_SEAT = re.compile(f"[{chr(_FIRST_SEAT)}-{chr(_FIRST_SEAT + MOST_VALUES)}]")
# Any number, or several that run together; a power is no part of a fraction. It gives nothing back, so that no search
# takes long.
ANY_NUMBER = (
    r"(?>(?:(?<=\^)[0-9]++|[-+]?(?:[0-9]++(?:[.,'/][0-9]++)*+|\.[0-9]++)(?:[eE][-+]?[0-9]++)?+"
    r"(?: ?[×·] ?10\^(?:\{-?[0-9]++\}|[0-9]))?+)++)"
)
# A number is not torn out of a longer one, nor out of a product, a power or a percentage of which it is a part.
_NUMBER_BEGINS = r"(?<![0-9][,'/])(?<![\w.^_√+-])"
_NUMBER_ENDS = r"(?!\w)(?![.,'/][0-9])(?!/[\w(])(?![\^_√])(?! ?[×·] ?10\^)(?! ?%)"


@dataclass(frozen=True)
class Phrase:
    """Literal texts in canonical spelling, and between each and the next the name of a value."""

    literals: tuple[str, ...]
    names: tuple[str, ...]

    @classmethod
    def of(cls, text: str) -> Phrase:
        """The phrase that `text` spells: {name} is the place of a value, {{ and }} are braces.

        Raises ValueError, in one line.
        """
        if len(text) > LONGEST_PHRASE:
            raise ValueError(f"it has {len(text)} characters; at most {LONGEST_PHRASE} are allowed")
        if _SEAT.search(text):
            raise ValueError("it holds a character of Unicode's private use")
        names: list[str] = []
        spelled = canonical_spelling(SourceText.of(_seated(text.strip(), names))).text
        if not spelled:
            raise ValueError("it is empty")
        return cls(tuple(_SEAT.split(spelled)), tuple(names))

    def exact(self, spellings: Spellings, ignore_case: bool = False) -> re.Pattern[str]:
        """The pattern of the phrase as it must stand, each value in one of its spellings, as a group of its name."""
        values = (f"(?P<{name}>{'|'.join(map(pattern, spellings[name]))})" for name in self.names)
        return self._pattern("".join(_alternating(map(literal_pattern, self.literals), values)), ignore_case)

    def shape(self, spellings: Spellings, ignore_case: bool = False, names: bool = True) -> re.Pattern[str]:
        """The pattern of the phrase with any numbers for its own, each a group; `names` such as RK4 keep theirs."""
        texts, _ = self._texts_and_numbers(spellings, names)
        return self._pattern(f"({ANY_NUMBER})".join(map(literal_pattern, texts)), ignore_case)

    def numbers(self, spellings: Spellings, names: bool = True) -> list[str]:
        """What the groups of the shape are where every number is right."""
        return self._texts_and_numbers(spellings, names)[1]

    def written(self, spellings: Spellings) -> str:
        """The phrase with the plainest spelling of each value."""
        return "".join(_alternating(self.literals, (spellings[name][0] for name in self.names)))

    def any_numbers(self) -> re.Pattern[str]:
        """The pattern of the phrase with any number for each value, and its own literal numbers."""
        return self._pattern(
            "".join(_alternating(map(literal_pattern, self.literals), (f"({ANY_NUMBER})" for _ in self.names)))
        )

    def _texts_and_numbers(self, spellings: Spellings, names: bool) -> tuple[list[str], list[str]]:
        """The phrase cut at its numbers, those that run together being one: n + 1 texts and n numbers."""
        texts, found = [""], list[str]()
        for part in _alternating(self.literals, [spellings[name][0] for name in self.names]):
            done = 0
            for number in numbers_in(part):
                if number.label is None or not names:
                    texts[-1] += part[done : number.start]
                    if found and not texts[-1]:
                        found[-1] += number.text
                    else:
                        found.append(number.text)
                        texts.append("")
                    done = number.end
            texts[-1] += part[done:]
        return texts, found

    def _pattern(self, text: str, ignore_case: bool = False) -> re.Pattern[str]:
        whole = _begins(self.literals[0]) + text + _ends(self.literals[-1])
        return re.compile(whole, re.IGNORECASE if ignore_case else 0)


def _seated(text: str, names: list[str]) -> str:
    """The text with a seat for each placeholder, whose name is appended to `names`."""

    def seat(match: re.Match[str]) -> str:
        if match["name"] is None:
            if len(match[0]) == 1:
                raise ValueError(f"{match[0]!r} stands alone; a value is {{name}}, a brace itself {{{{ or }}}}")
            return match[0][0]
        if match["name"] in names:
            raise ValueError(f"{{{match['name']}}} stands in it twice")
        names.append(match["name"])
        if len(names) > MOST_VALUES:
            raise ValueError(f"it has more than {MOST_VALUES} values")
        return chr(_FIRST_SEAT + len(names) - 1)

    return _PLACEHOLDER.sub(seat, text)


def _alternating(literals: Iterable[str], values: Iterable[str]) -> Iterator[str]:
    for pair in zip_longest(literals, values, fillvalue=""):
        yield from pair


def _begins(literal: str) -> str:
    """What must hold where a phrase begins with this text, or, where there is none, with a value."""
    if not literal or re.match("[-+.]?[0-9]", literal):
        return _NUMBER_BEGINS
    return r"(?<!\w)" if re.match(r"\w", literal) else ""


def _ends(literal: str) -> str:
    """What must hold where a phrase ends with this text, or, where there is none, with a value."""
    if not literal or literal[-1].isdigit():
        return _NUMBER_ENDS
    return r"(?!\w)" if re.search(r"\w\Z", literal) else ""
