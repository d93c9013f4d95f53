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


class Said(NamedTuple):
    """A phrase of the text at `start`, the fact that it states as a question, yes or no, and whether that is so."""

    start: int
    phrase: str
    question: str
    answer: str
    holds: bool


def properties_in(text: str) -> Iterator[Said]:
    """The sentences of a text in canonical spelling that say of one method that it has a property or has it not."""
    said = (
        rf"(?P<of>{spoken_names().pattern}) (?:(?:method|rule|scheme) )?is (?P<no>not )?(?P<what>{'|'.join(_FACTS)})\b"
    )
    # A hyphen or the end of a line may stand for each blank of a name.
    for match in re.finditer(re.sub(r"\\? ", "[-_ \n]", said), text.lower()):
        fact, found = _FACTS[match["what"]], dict[str, str | None]()
        for key in sorted(methods_named(match["of"])):  # of leapfrog, both
            with suppress(ValueError):  # a fact that a multistep method has not
                found[key] = value(f"{fact} {key}").exact_text
        if {*found.values()} in ({"yes"}, {"no"}):
            answer, phrase = "no" if match["no"] else "yes", text[slice(*match.span())].replace("\n", " ")
            holds = answer in found.values()
            yield Said(match.start(), phrase, f"{fact} {next(iter(found))}", answer, holds)
