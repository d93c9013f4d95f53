"""Whether a text says what its claims say, and which of its numbers the claims answer for."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice

from driftproof.texts.claims.claims import Claim, NumberLabel
from driftproof.texts.claims.phrases import Spellings, decimal_spellings, spelled_alike
from driftproof.texts.readers.document import Document, Position
from driftproof.texts.readers.number_words import TextWord, words_in
from driftproof.texts.readers.numbers import TextNumber, numbers_in

# How a number is accounted for: worked out here, given, printed by a listing that was run, part of a name, or not.
WORKED_OUT, GIVEN, RUN, LABEL, UNCOVERED = ACCOUNTS = ("value", "given", "run", "label", "uncovered")
# Of a number in the code of a listing, which says what is run: why it is a label where nobody claims anything of it.
IN_PROGRAM = "what a program is given"
# What is shown of the text where a phrase begins as it should and then goes on differently.
_SHOWN = 60
# Places of a text that have the shape of one phrase: of more, the first are compared.
_MOST_COMPARED = 2000
# What is wrong more often than that is wrong in the same way.
_MOST_FINDINGS = 3

Span = tuple[int, int]


@dataclass(frozen=True)
class Occurrence:
    """Where a phrase stands in the text, and where in it its values do."""

    start: int
    end: int
    values: tuple[Span, ...]


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong: the claim, the place, what is expected there, what is found, and the same in words."""

    claim: str
    line: int
    column: int
    expected: str
    found: str
    message: str


@dataclass(frozen=True)
class CheckedClaim:
    """A claim held to a text: where it stands, and what is wrong with it."""

    claim: Claim
    occurrences: tuple[Occurrence, ...]
    findings: tuple[Finding, ...]


def check_claims(document: Document, claims: Iterable[Claim]) -> list[CheckedClaim]:
    """Every claim held to the text. Raises ValueError where a claim has no value."""
    return [check_claim(document, claim, claim.spellings()) for claim in claims]


def check_claim(document: Document, claim: Claim, spellings: Spellings) -> CheckedClaim:
    """The claim, whose values are spelled so, held to the text."""
    found = occurrences_of(document, claim, spellings)
    wrong = _surplus if len(found) > claim.count else _missing
    findings = () if len(found) == claim.count else tuple(wrong(document, claim, spellings, found))
    return CheckedClaim(claim, found, findings)


def occurrences_of(document: Document, claim: Claim, spellings: Spellings) -> tuple[Occurrence, ...]:
    """Everywhere that the phrase stands with its values, spelled so."""
    return tuple(
        Occurrence(*match.span(), tuple(match.span(name) for name in claim.phrase.names))
        for match in claim.phrase.exact(spellings, claim.ignore_case).finditer(document.text.text)
    )


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _surplus(
    document: Document, claim: Claim, spellings: Spellings, occurrences: tuple[Occurrence, ...]
) -> Iterator[Finding]:
    message = f"this stands {_times(len(occurrences))} in the text, and should stand {_times(claim.count)}"
    for one in occurrences[claim.count :][:_MOST_FINDINGS]:
        found = document.text.text[one.start : one.end]
        yield Finding(claim.id, *document.position(one.start), "nothing", found, message)


def _missing(
    document: Document, claim: Claim, spellings: Spellings, occurrences: tuple[Occurrence, ...]
) -> Iterator[Finding]:
    """As many as are missing of the places that come closest: the most numbers right, and the first such."""
    missing, known = claim.count - len(occurrences), {occurrence.start for occurrence in occurrences}
    for names in (True, False):  # a name with another number in it comes close, too, where nothing comes closer
        expected = claim.phrase.numbers(spellings, names)
        shape = claim.phrase.shape(spellings, claim.ignore_case, names)
        shape = re.compile(f"(?={shape.pattern})", shape.flags)  # in a row of a table one begins inside another
        found = islice(shape.finditer(document.text.text), _MOST_COMPARED)
        near = [match for match in found if match.start() not in known]
        near.sort(key=lambda match: -sum(map(spelled_alike, expected, match.groups())))
        if near:
            nearest = near[: min(missing, _MOST_FINDINGS)]
            yield from (_difference(document, claim, expected, match) for match in nearest)
            return
    often = "nowhere" if not occurrences else f"only {_times(len(occurrences))}"
    written = claim.phrase.written(spellings)
    message = f"{written!r} stands {often} in the text, and should stand {_times(claim.count)}"
    capitals = None if claim.ignore_case else claim.phrase.shape(spellings, True).search(document.text.text)
    if capitals:
        place, shown = document.position(capitals.start()), capitals[0]
        message += f"; {shown!r} has other capitals, and ignore_case = true allows them"
    else:
        place, shown = _beginning(document, written)
        message += f"; closest is {shown!r}" if shown else ""
    yield Finding(claim.id, *place, written, shown, message)


def _difference(document: Document, claim: Claim, expected: list[str], match: re.Match[str]) -> Finding:
    wrong = [(i, *pair) for i, pair in enumerate(zip(expected, match.groups(), strict=True), 1) if pair[0] != pair[1]]
    i, right, found = next((one for one in wrong if not spelled_alike(*one[1:])), wrong[0])
    if re.search("[eE×·]", found) and re.fullmatch("-?[0-9.]+", right):
        right = decimal_spellings(right)[-1]
    return Finding(claim.id, *document.position(match.start(i)), right, found, f"expected {right}, found {found}")


def _beginning(document: Document, written: str) -> tuple[Position, str]:
    """Where the longest run of first words of a phrase stands, and what does; the first place and "" if none does."""
    flat = document.text.text.replace("\n", " ")
    for word in reversed([*re.finditer(r"\S+", written)]):
        at = flat.find(written[: word.end()].replace("\n", " "))
        if at >= 0 and word.end() > 1:
            return document.position(at), flat[at : at + len(written)][:_SHOWN]
    return Position(1, 1), ""


@dataclass(frozen=True)
class Accounted:
    """A number, how it is accounted for (one of ACCOUNTS), and by what: a claim's id, or why it is a label."""

    number: TextNumber
    kind: str
    by: str


@dataclass(frozen=True)
class Coverage:
    """Every number of a text, accounted for, in order; and its words for numbers and growth that no phrase holds."""

    numbers: tuple[Accounted, ...]
    unread: tuple[TextWord, ...] = ()

    @property
    def counts(self) -> dict[str, int]:
        """How many there are of each kind."""
        found = Counter(accounted.kind for accounted in self.numbers)
        return {kind: found[kind] for kind in ACCOUNTS}

    @property
    def share(self) -> Fraction:
        """The part of the numbers, labels apart, that is covered: values, given and run. All of none is 1."""
        of = len(self.numbers) - self.counts[LABEL]
        return 1 - Fraction(len(self.uncovered), of) if of else Fraction(1)

    @property
    def uncovered(self) -> list[TextNumber]:
        """The numbers that nobody answers for."""
        return [accounted.number for accounted in self.numbers if accounted.kind == UNCOVERED]


def coverage(
    document: Document, checked: Iterable[CheckedClaim], labels: Iterable[NumberLabel] = (), ran: Iterable[Span] = ()
) -> Coverage:
    """Every number of the text; `ran` are the spans of what listings print and were seen to print.

    A number counts for the value it stands in, else as a label by rule, else for what it stands in first: the phrase of
    a claim, which gives it, that of a label, or what was run; and else, in the code of a listing, as a label. A word
    for a number or for growth that stands in a phrase is held only where it is a value, or the claim says why its
    numbers are given: nobody worked it out otherwise.
    Raises ValueError for a label that stands nowhere.
    """
    text = document.text.text
    values: dict[Span, tuple[str, str]] = {}
    holders: list[tuple[int, int, str, str]] = []
    unheld: list[Span] = []
    for one in checked:
        claim = one.claim
        for occurrence in one.occurrences:
            for name, span in zip(claim.phrase.names, occurrence.values, strict=True):
                values.setdefault(span, (WORKED_OUT if claim.values[name].given is None else GIVEN, claim.id))
            holders.append((occurrence.start, occurrence.end, GIVEN, claim.id))
            unheld += [(occurrence.start, occurrence.end)] if claim.given is None else []
    for label in labels:
        found = [match.span() for match in label.phrase.any_numbers().finditer(text)]
        if not found:
            raise ValueError(f"the label for {label.why!r} stands nowhere in the text")
        holders += [(*span, LABEL, label.why) for span in found]
    holders += [(*span, RUN, "running the listing") for span in ran]
    holders += [(*span, LABEL, IN_PROGRAM) for span in document.code]
    numbers = [number for span, how in values.items() for number in _of_value(text, span, *how)]
    rest = list(text)
    for start, end in values:  # where these stand, signs of no number and no word, from Unicode's private use
        rest[start:end] = "\uf8ff" * (end - start)
    numbers += _of_rest("".join(rest), holders)
    held = set[int]()
    for start, end in {(start, end) for start, end, *_ in holders}.difference(unheld) | values.keys():
        held.update(range(start, end))
    unread = tuple(word for word in words_in(text) if word.start not in held)
    return Coverage(tuple(sorted(numbers, key=lambda accounted: accounted.number.start)), unread)


def _of_value(text: str, span: Span, kind: str, by: str) -> Iterator[Accounted]:
    """The numbers of one value: of a formula there are several."""
    start, end = span
    for number in numbers_in(text[start:end]):
        if number.label is None:
            yield Accounted(replace(number, start=start + number.start, end=start + number.end), kind, by)


def _of_rest(text: str, holders: list[tuple[int, int, str, str]]) -> Iterator[Accounted]:
    held: list[tuple[int, str, str] | None] = [None] * len(text)  # of each character, by what, and where that ends
    for start, end, kind, by in sorted(holders, key=lambda holder: (holder[3] == IN_PROGRAM, holder[0]), reverse=True):
        held[start:end] = [(end, kind, by)] * (end - start)
    for number in numbers_in(text):
        holder = held[number.start]
        if number.label is not None:
            yield Accounted(number, LABEL, number.label)
        elif holder and number.end <= holder[0]:
            yield Accounted(number, *holder[1:])
        else:
            yield Accounted(number, UNCOVERED, "")
