"""Whether a text says what its claims say: each phrase with its values exactly as often as claimed."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

from driftproof.texts.claims.claims import Claim
from driftproof.texts.claims.phrases import Spellings
from driftproof.texts.readers.document import Document, Position

# What is shown of the text where a phrase begins as it should and then goes on differently.
SHOWN = 60
# Places of a text that have the shape of one phrase: of more, the first are compared.
MOST_COMPARED = 2000
MOST_FINDINGS = 3


@dataclass(frozen=True)
class Occurrence:
    """Where a phrase stands in the text, and where in it its values do."""

    start: int
    end: int
    values: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong: the claim, the place, what is expected there, what is found, and the same in words."""

    claim: str
    place: Position
    expected: str
    found: str
    message: str


@dataclass(frozen=True)
class Outcome:
    """A claim held to a text: where it stands, and what is wrong with it."""

    claim: Claim
    occurrences: tuple[Occurrence, ...]
    findings: tuple[Finding, ...]


def occurrences_of(document: Document, claim: Claim, spellings: Spellings) -> tuple[Occurrence, ...]:
    """Everywhere that the phrase stands with its values, spelled so."""
    return tuple(
        Occurrence(*match.span(), tuple(match.span(name) for name in claim.phrase.names))
        for match in claim.phrase.exact(spellings, claim.ignore_case).finditer(document.text.text)
    )


def check_claim(document: Document, claim: Claim, spellings: Spellings) -> Outcome:
    """The claim, whose values are spelled so, held to the text."""
    occurrences = occurrences_of(document, claim, spellings)
    if len(occurrences) == claim.count:
        return Outcome(claim, occurrences, ())
    if len(occurrences) > claim.count:
        return Outcome(claim, occurrences, tuple(_surplus(document, claim, occurrences)))
    return Outcome(claim, occurrences, tuple(_missing(document, claim, spellings, occurrences)))


def check_claims(document: Document, claims: Iterable[Claim]) -> list[Outcome]:
    """Every claim held to the text. Raises ValueError where a claim has no value."""
    return [check_claim(document, claim, claim.spellings()) for claim in claims]


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _surplus(document: Document, claim: Claim, occurrences: tuple[Occurrence, ...]) -> Iterable[Finding]:
    for occurrence in occurrences[claim.count :][:MOST_FINDINGS]:
        found = document.text.text[occurrence.start : occurrence.end]
        message = f"this stands {_times(len(occurrences))} in the text, and should stand {_times(claim.count)}"
        yield Finding(claim.id, document.position(occurrence.start), "nothing", found, message)


def _missing(
    document: Document, claim: Claim, spellings: Spellings, occurrences: tuple[Occurrence, ...]
) -> Iterable[Finding]:
    """As many as are missing of the places that come closest: the most numbers right, and the first such."""
    missing, known = claim.count - len(occurrences), {occurrence.start for occurrence in occurrences}
    for names in (True, False):  # a name with another number in it comes close, too, where nothing comes closer
        expected = claim.phrase.numbers(spellings, names)
        shape = claim.phrase.shape(spellings, claim.ignore_case, names)
        found = islice(shape.finditer(document.text.text), MOST_COMPARED)
        near = [match for match in found if match.start() not in known]
        near.sort(key=lambda match: -sum(a == b for a, b in zip(expected, match.groups(), strict=True)))
        if near:
            yield from (_difference(document, claim, expected, match) for match in near[: min(missing, MOST_FINDINGS)])
            return
    often = "nowhere" if not occurrences else f"only {_times(len(occurrences))}"
    written = claim.phrase.written(spellings)
    message = f"{written!r} stands {often} in the text, and should stand {_times(claim.count)}"
    yield _unseen(document, claim, spellings, message)


def _unseen(document: Document, claim: Claim, spellings: Spellings, message: str) -> Finding:
    """A phrase that has not even its shape in the text: where the text comes closest."""
    written = claim.phrase.written(spellings)
    capitals = None if claim.ignore_case else claim.phrase.shape(spellings, True).search(document.text.text)
    if capitals:
        place, found, why = document.position(capitals.start()), capitals[0], "other capitals, and ignore_case = true"
        return Finding(claim.id, place, written, found, f"{message}; {found!r} has {why} allows them")
    place, found = _beginning(document, written)
    return Finding(claim.id, place, written, found, f"{message}; closest is {found!r}" if found else message)


def _difference(document: Document, claim: Claim, expected: list[str], match: re.Match[str]) -> Finding:
    """The first number that is not as it should be."""
    groups = list(match.groups())
    first = next((i for i, (a, b) in enumerate(zip(expected, groups, strict=True)) if a != b), None)
    if first is None:
        message = f"{match[0]!r} is part of something longer here, or is spelled in another way"
        return Finding(claim.id, document.position(match.start()), match[0], match[0], message)
    message = f"expected {expected[first]}, found {groups[first]}"
    return Finding(claim.id, document.position(match.start(first + 1)), expected[first], groups[first], message)


def _beginning(document: Document, written: str) -> tuple[Position, str]:
    """Where the longest run of first words of a phrase stands, and what does; the first place and "" if none does."""
    flat = document.text.text.replace("\n", " ")
    words = [match.end() for match in re.finditer(r"\S+", written.replace("\n", " "))]
    for end in reversed(words):
        at = flat.find(written[:end].replace("\n", " "))
        if at >= 0 and end > 1:
            return document.position(at), flat[at : at + max(len(written), end)][:SHOWN]
    return Position(1, 1), ""
