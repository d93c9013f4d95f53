"""What a text says of methods in words, such as "BDF2 is A-stable", as claims."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

from driftproof.texts.claims.contradictions import methods_named, spoken_names
from driftproof.texts.questions.evaluate import value

# Property -> the fact of that name.
_FACTS = {"a-stable": "a_stable", "l-stable": "l_stable", "symplectic": "symplectic", "symmetric": "symmetric"}
# Words before a sentence, or in it, that ask, deny or doubt what it says, and how far before.
_IN_DOUBT = re.compile(r"\b(?:myth|false|whether|if|unless|claims?|believes?|wrong|say|cannot|nobody|never)\b")
_BEFORE = 100


class Said(NamedTuple):
    """A phrase of the text at `start`, the fact that it states as a question, yes or no, and whether that is so."""

    start: int
    phrase: str
    question: str
    answer: str
    holds: bool


def properties_in(text: str) -> Iterator[Said]:
    """The sentences of a text in canonical spelling that say of one method that it has a property or has it not."""
    what, of = "|".join(_FACTS), spoken_names().pattern
    said = rf"(?P<of>{of})(?:'s)?(?: (?:method|rule|scheme))?(?:, [^,.;]{{1,30}},)? is (?P<no>not )?(?P<what>{what})\b"
    said += rf"(?: (?:and|but|or) (?P<no2>not )?(?P<what2>{what})\b)?(?! ?\?)"
    lower = text.lower()
    # A hyphen or the end of a line may stand for each blank of a name.
    for match in re.finditer(re.sub(r"\\? ", "[-_ \n]", said), lower):
        before = re.split(r"[.?!]\s|\n\n", lower[max(0, match.start() - _BEFORE) : match.start()])[-1]
        if not _IN_DOUBT.search(before + match[0]):
            phrase = text[slice(*match.span())].replace("\n", " ")
            for no, fact in ((x, _FACTS[match[y]]) for x, y in (("no", "what"), ("no2", "what2")) if match[y]):
                answer, found = "no" if match[no] else "yes", dict[str, str | None]()
                for key in sorted(methods_named(match["of"])):  # of leapfrog, both
                    with suppress(ValueError):  # a fact that a multistep method has not
                        found[key] = value(f"{fact} {key}").exact_text
                if {*found.values()} in ({"yes"}, {"no"}):
                    question = f"{fact} {next(iter(found))}"
                    yield Said(match.start(), phrase, question, answer, answer in found.values())
