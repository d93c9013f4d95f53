"""Which numbers of a text the claims cover, which are given, which are labels, and which nobody answers for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction

from driftproof.texts.claims.checking import Outcome
from driftproof.texts.claims.claims import Label
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.numbers import TextNumber, numbers_in

VALUE, GIVEN, LABEL, RUN, UNCOVERED = "value", "given", "label", "run", "uncovered"
# Stands for each character of what is answered for already: of no number, of no word.
_DONE = "\uf8ff"

Span = tuple[int, int]


@dataclass(frozen=True)
class Accounted:
    """A number, how it is accounted for (one of the kinds above), and by what: a claim's id, or why it is a label."""

    number: TextNumber
    kind: str
    by: str


@dataclass(frozen=True)
class Coverage:
    """Every number of a text, accounted for, in order."""

    numbers: tuple[Accounted, ...]

    @property
    def counts(self) -> dict[str, int]:
        """How many there are of each kind."""
        found = Counter(accounted.kind for accounted in self.numbers)
        return {kind: found[kind] for kind in (VALUE, GIVEN, RUN, LABEL, UNCOVERED)}

    @property
    def share(self) -> Fraction:
        """The part of the numbers, labels apart, that is covered: values, given and run. All of none is 1."""
        counts = self.counts
        of = sum(counts.values()) - counts[LABEL]
        return 1 - Fraction(counts[UNCOVERED], of) if of else Fraction(1)

    @property
    def uncovered(self) -> list[TextNumber]:
        """The numbers that nobody answers for."""
        return [accounted.number for accounted in self.numbers if accounted.kind == UNCOVERED]


def coverage(
    document: Document, outcomes: Iterable[Outcome], labels: Iterable[Label] = (), ran: Iterable[Span] = ()
) -> Coverage:
    """Every number of the text; `ran` are the spans of what listings print and were seen to print.

    Raises ValueError for a label that stands nowhere.
    """
    text = document.text.text
    values: dict[Span, tuple[str, str]] = {}
    phrases: list[tuple[Span, str, str]] = []
    for outcome in outcomes:
        claim = outcome.claim
        for occurrence in outcome.occurrences:
            for name, span in zip(claim.phrase.names, occurrence.values, strict=True):
                values.setdefault(span, (GIVEN if claim.values[name].given is not None else VALUE, claim.id))
            phrases.append(((occurrence.start, occurrence.end), GIVEN, claim.id))
    phrases += [(span, LABEL, label.why) for label in labels for span in _label_spans(text, label)]
    phrases += [(span, RUN, "running the listing") for span in ran]
    found = [accounted for span, how in values.items() for accounted in _of_value(text, span, *how)]
    rest = numbers_in(_masked(text, values))
    return Coverage(tuple(sorted([*found, *_of_rest(rest, phrases)], key=lambda a: a.number.start)))


def _label_spans(text: str, label: Label) -> list[Span]:
    spans = [match.span() for match in label.phrase.any_numbers().finditer(text)]
    if not spans:
        raise ValueError(f"the label for {label.why!r} stands nowhere in the text")
    return spans


def _of_value(text: str, span: Span, kind: str, by: str) -> list[Accounted]:
    """The numbers of one value: of a formula there are several."""
    start, end = span
    inside = [number for number in numbers_in(text[start:end]) if number.label is None]
    return [
        Accounted(replace(number, start=start + number.start, end=start + number.end), kind, by) for number in inside
    ]


def _masked(text: str, spans: Iterable[Span]) -> str:
    pieces, done = [], 0
    for start, end in sorted(spans):
        if start >= done:
            pieces += [text[done:start], _DONE * (end - start)]
            done = end
    return "".join([*pieces, text[done:]])


def _of_rest(rest: list[TextNumber], phrases: list[tuple[Span, str, str]]) -> list[Accounted]:
    """Numbers outside of values: labels by rule, then what stands in a phrase, then what is left."""
    found = []
    waiting, active = sorted(phrases, key=lambda phrase: phrase[0][0], reverse=True), list[tuple[Span, str, str]]()
    for number in rest:
        while waiting and waiting[-1][0][0] <= number.start:
            active.append(waiting.pop())
        active = [phrase for phrase in active if phrase[0][1] > number.start]
        holding = next((phrase for phrase in active if number.end <= phrase[0][1]), None)
        if number.label is not None:
            found.append(Accounted(number, LABEL, number.label))
        elif holding is not None:
            found.append(Accounted(number, *holding[1:]))
        else:
            found.append(Accounted(number, UNCOVERED, ""))
    return found
