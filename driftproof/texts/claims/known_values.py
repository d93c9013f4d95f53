"""Values that a number of a text may be, each by its question, and how likely a number that looks so means it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import chain, product
from math import prod

from driftproof.methods.catalogue import keys_of_name
from driftproof.texts.claims.contradictions import SETTING, methods_named
from driftproof.texts.questions.answer import GIVEN, Answer
from driftproof.texts.readers.numbers import numbers_in

# Chosen: a look-alike is strong if at most one in 100 random numbers with as many digits would look as good.
_ODDS = 100
# The same for values that the author asked for, which the text is known to contain.
_ODDS_OF_ASKED = 20
# At most this many questions may come of one with braces: each may take a run.
_MOST_ASKED = 2000
_BRACES = re.compile(r"((?:\b\w+ ?= ?)?)\{([^{}]*)\}")
# A count of steps in words or a setting.
COUNT_OF_STEPS = re.compile(r"(?:\bN ?= ?|\b(?=[0-9]+ (?:time )?steps\b))([0-9]{1,5})\b")


def questions_in(asked: str) -> dict[str, tuple[str, ...]]:
    """Each question that the braces stand for -> its choices. Raises ValueError for none or 2001.

    Equal braces choose alike, and so do those of one setting with as many choices, as in h={0.2,0.1} and h={0.1,0.05}.
    """
    together = dict[tuple[str, int], dict[str, list[str]]]()
    for setting, brace in _BRACES.findall(asked):
        ends = re.fullmatch(r"([0-9]{1,6})\.\.([0-9]{1,6})", brace)
        choices = [*map(str, range(int(ends[1]), int(ends[2]) + 1))] if ends else brace.split(",")
        together.setdefault((setting or brace, len(choices)), {})[brace] = choices
    ways = [[*zip(*choices.values(), strict=True)] for choices in together.values()]
    if not 0 < (count := prod(map(len, ways))) <= _MOST_ASKED:
        raise ValueError(f"{asked[:60]!r} expands to {count} questions; from 1 to {_MOST_ASKED} are allowed")
    found = {}
    for chosen in map(tuple, map(chain.from_iterable, product(*ways))):
        chosen_for = dict(zip(chain(*together.values()), chosen, strict=True))
        found[_BRACES.sub(lambda brace, chosen_for=chosen_for: brace[1] + chosen_for[brace[2]], asked)] = chosen  # type: ignore[misc]
    return found


@dataclass(frozen=True)
class KnownValue:
    """A value that a number may be, by question or id; `chosen` has the choices from the braces of an asked one.

    A `stated` one was not asked by the author, but is about a problem that the text states.
    """

    question: str
    answer: Answer
    chosen: tuple[str, ...] | None = None
    stated: bool = False

    @cached_property
    def methods(self) -> list[set[str]]:
        """The methods that are chosen, each as the keys that its name may mean."""
        return [{*keys} for text in self.chosen or () if (keys := keys_of_name(text))]

    @cached_property
    def numbers(self) -> list[set[Fraction]]:
        """The chosen numbers, which stand beside the value in a table; for a number N of steps also the time N h."""
        chosen = [{number.value} for text in self.chosen or () for number in numbers_in(text) if number.text == text]
        h, n = (Fraction(*found[:1]) for found in (x.findall(self.question) for x in (SETTING["h"], COUNT_OF_STEPS)))
        return [x | {n * h} if x == {n} else x for x in chosen]

    @cached_property
    def names(self) -> list[str]:
        """The words that name the value, without single letters and words common to all questions."""
        words_chosen = [text for text in self.chosen or () if not keys_of_name(text)]
        text = " ".join(words_chosen) if self.chosen else re.sub(r"\b(?:run|step|from) |[htN]=\S+", "", self.question)
        words = dict.fromkeys(re.split(r"[^a-z0-9]+", text.lower()))
        least = "[a-z]{2,}[0-9]*" if self.chosen is not None else ".*[a-z].+|.+[a-z].*"
        return [word for word in words if re.fullmatch(least, word)]

    @cached_property
    def keys(self) -> set[str]:
        """The keys of the methods that the question names."""
        return set().union(*self.methods) or methods_named(self.question.lower())

    @cached_property
    def rank(self) -> int:
        """2 for what the author asks for, 1 for what is about a stated problem, 0 for other values."""
        return (self.chosen is not None) + (self.chosen is not None and not self.stated)

    @property
    def most(self) -> int:
        """How many names, methods and numbers it has, all of which may stand near a number."""
        return len(self.names) + len(self.methods) + len(self.numbers)

    def is_meant(self, x: Fraction, digits: int, fit: int, rivals: int) -> bool:
        """True if x hardly looks so by chance: `fit` names are near, and as near to no more than `rivals` values."""
        asked = self.chosen is not None
        likely = rivals * (_ODDS_OF_ASKED if asked and not self.stated else _ODDS) <= 9 * 10 ** (digits - 1)
        only_method = {*self.names} <= {*"_".join(self.keys).split("_")}
        says_what = asked or digits > 1 or not only_method
        named = says_what and fit == self.most and fit > (digits < 2 or not asked)
        # Digits of roots of small numbers are not random, so an irrational value needs a name nearby.
        near = asked or fit > 0 or isinstance(self.answer.exact, Fraction)
        # A constant that the lesson chose may be chosen by another text, too, without being meant.
        return (likely or (self.answer.exact == x and named)) and near and self.answer.evidence != GIVEN
