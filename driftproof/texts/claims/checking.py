"""Check a text against its claims, and account for each of its numbers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Set
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import Decimal
from difflib import SequenceMatcher
from fractions import Fraction
from itertools import islice, product

from driftproof.texts.claims.claims import Claim, NumberLabel
from driftproof.texts.claims.phrases import NUMBER_ENDS, Spellings, decimal_spellings, spelled_alike
from driftproof.texts.readers.document import Document, Position
from driftproof.texts.readers.number_words import TextWord, words_in
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.words.contradictions import names_another_axis
from driftproof.texts.words.method_names import lowered
from driftproof.texts.words.places import place_of
from driftproof.texts.words.tables import tables_of

# How a number is accounted for: computed here, given, printed by a listing that was run, part of a name, not at all.
WORKED_OUT, GIVEN, RUN, LABEL, UNCOVERED = ACCOUNTS = ("value", "given", "run", "label", "uncovered")
# Why a number in the code of a listing is a label unless some claim covers it.
IN_PROGRAM = "an input of a program"
# Characters of the text that are shown where a phrase is not, but something like it.
_SHOWN = 60
_WORD = re.compile(r"\w[\w.]*(?<!\.)")
# At most this many places with the shape of a phrase are compared, in the order of the text.
_MOST_COMPARED = 2000
# At most this many findings are reported for one claim: further ones would repeat them.
_MOST_FINDINGS = 3

Span = tuple[int, int]


@dataclass(frozen=True)
class Finding:
    """A discrepancy: the claim, the place, the expected text, the text found, and a message that says both."""

    claim: str
    line: int
    column: int
    expected: str
    found: str
    message: str


@dataclass(frozen=True)
class CheckedClaim:
    """A claim checked against a text: how its values are spelled, where its phrase has them, and its findings."""

    claim: Claim
    spellings: Spellings
    occurrences: list[re.Match[str]]
    findings: tuple[Finding, ...]


def check_claims(document: Document, claims: Iterable[Claim]) -> list[CheckedClaim]:
    """Check every claim against the text. Raises ValueError if a claim has no value."""
    found = [check_claim(document, claim, claim.spellings()) for claim in claims]
    places = [place.span() for one in found if len(one.occurrences) <= one.claim.count for place in one.occurrences]
    held = frozenset(at for span in places for at in range(*span))
    return [
        check_claim(document, one.claim, one.spellings, held) if one.findings else replace(one, findings=untrue)
        for one, untrue in zip(found, _untrue(document, found), strict=True)
    ]


def _untrue(document: Document, checked: Iterable[CheckedClaim]) -> Iterator[tuple[Finding, ...]]:
    """What each claim says beside its numbers and is not so: the method that the text names there, or a fact."""
    text, tables = document.text.text, tables_of(document.text.text)
    lower = lowered(text, (x.question or "" for one in checked for x in one.claim.values.values()))
    for one in checked:
        claim, findings = one.claim, list[Finding]()
        if claim.fact and (untrue := claim.untrue()):
            places = [document.position(place.start()) for place in one.occurrences]
            findings += [
                Finding(claim.id, *at, untrue, claim.fact[1], f"{untrue}, not {claim.fact[1]}") for at in places
            ]
        findings += [
            Finding(claim.id, *document.position(place.start(name)), axis, "", f"the text names no {axis} axis here")
            for place, name in product(one.occurrences, claim.phrase.names)
            for axis in re.findall(r"\b(real|imaginary)_limit ", claim.values[name].question or "")[:1]
            if names_another_axis(axis, lower, *place.span(name), tables.head_at(place.start(name)).lower())
        ]
        for place, (method, name) in product(one.occurrences, zip(claim.methods, claim.phrase.names, strict=False)):
            start, end = place.span(name)
            row = tables.row_of(TextNumber(start, end, text[start:end], None))
            if method not in (named := place_of(lower, start, end, row, {}).methods):
                names = ", ".join(sorted(named)) or "no method"
                said = f"the text names {names} here, not {method}"
                findings.append(Finding(claim.id, *document.position(start), method, names, said))
        yield tuple(findings[:_MOST_FINDINGS])


def check_claim(document: Document, claim: Claim, spellings: Spellings, held: Set[int] = frozenset()) -> CheckedClaim:
    """Check one claim, with the accepted spellings of its values, against the text; other claims hold at `held`."""
    found = _at_address(document, claim, claim.phrase.exact(spellings))
    elsewhere = [x for one in found if (x := _of_other_column(document, claim, one))]
    found = [one for one in found if not _of_other_column(document, claim, one)]
    if elsewhere and len(found) < claim.count:
        return CheckedClaim(claim, spellings, found, tuple(elsewhere[:_MOST_FINDINGS]))
    more = len(found) > claim.count
    wrong = _surplus(document, claim, found) if more else _missing(document, claim, spellings, found, held)
    return CheckedClaim(claim, spellings, found, () if len(found) == claim.count else tuple(wrong))


def _at_address(
    document: Document, claim: Claim, pattern: re.Pattern[str], most: int | None = None
) -> list[re.Match[str]]:
    """The matches, of the first `most`, whose first number stands in the row and the column that the claim names."""
    found, tables = [*islice(pattern.finditer(document.text.text), most)], tables_of(document.text.text)
    if not any(claim.address[:2]):
        return found
    first = [next((x.start for x in numbers_in(one[0]) if x.label is None), 0) for one in found]
    starts = [one.start() + at if one[0] else one.start(1) for one, at in zip(found, first, strict=True)]  # a lookahead
    return [one for one, start in zip(found, starts, strict=True) if tables.stands_at(claim.address, start)]


def _of_other_column(document: Document, claim: Claim, match: re.Match[str]) -> Finding | None:
    """What is wrong if a value stands under another head than the claim says."""
    tables = tables_of(document.text.text)
    for name, head in zip(claim.phrase.names, claim.address.columns, strict=False):
        if (found := tables.head_at(match.start(name))).lower() != head.lower():
            said = f"{match[name]} stands under {found!r}, not under {head!r}"
            return Finding(claim.id, *document.position(match.start(name)), head, found, said)
    return None


def places_of(document: Document, claim: Claim, number: str) -> list[int]:
    """The places where the phrase of a claim without values has this number, whatever its others are, or this word."""
    if number[0].isalpha():
        places = claim.phrase.exact({}).finditer(document.text.text)
        return [one.start() + at.start() for one in places for at in re.finditer(rf"\b{number}\b", one[0])]
    shape, numbers = claim.phrase.shape({})
    found = _at_address(document, claim, re.compile(f"(?={shape.pattern})", shape.flags))
    return [one.start(i) for one in found for i, x in enumerate(numbers, 1) if x == one[i] == number]


def others_in_phrases(
    document: Document, checked: Iterable[CheckedClaim], open_ones: Iterable[TextNumber]
) -> list[str]:
    """The numbers, of these that nothing accounts for, that stand where a claim that holds has another one."""
    left, found = {x.start: x.text for x in open_ones}, dict[int, str]()
    for one in (one for one in checked if one.occurrences and not one.findings and one.claim.phrase.names):
        claim = one.claim
        shape, _ = claim.phrase.shape(one.spellings)
        if any(re.search(r"[^\W\d_]{2}", text) for text in claim.phrase.literals):  # not a number alone
            for match in _at_address(document, claim, re.compile(f"(?={shape.pattern})", shape.flags), _MOST_COMPARED):
                places = map(match.start, range(1, len(match.groups()) + 1))
                found |= {at: left[at] for at in places if at in left}
    return [found[at] for at in sorted(found)]


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _surplus(document: Document, claim: Claim, occurrences: list[re.Match[str]]) -> Iterator[Finding]:
    message = f"this occurs {_times(len(occurrences))} in the text; expected {_times(claim.count)}"
    for one in occurrences[claim.count :][:_MOST_FINDINGS]:
        yield Finding(claim.id, *document.position(one.start()), "nothing", one[0], message)


def _missing(
    document: Document, claim: Claim, spellings: Spellings, occurrences: list[re.Match[str]], held: Set[int]
) -> Iterator[Finding]:
    """One finding for each missing occurrence: where few numbers are wrong, no claim holds, and they are most alike."""

    def distance(match: re.Match[str]) -> tuple[int, bool, float]:
        compared = enumerate(zip(expected, match.groups(), strict=True), 1)
        wrong = {i: map(_digits_and_power, pair) for i, pair in compared if not spelled_alike(*pair)}
        alike = sum(SequenceMatcher(None, a, b).ratio() for a, b in wrong.values())
        return len(wrong), not held.isdisjoint(map(match.start, wrong)), -alike

    missing, known = claim.count - len(occurrences), {one.start() for one in occurrences}
    for names in (True, False):  # second, names such as RK4 may have another number
        shape, expected = claim.phrase.shape(spellings, names)
        shape = re.compile(f"(?={shape.pattern})", shape.flags)  # a lookahead, because matches may overlap
        found = _at_address(document, claim, shape, _MOST_COMPARED)
        near = [one for one in found if one.start() not in known and _is_under(document, claim, one.start(1))]
        near.sort(key=distance)
        if near:
            for match in near[: min(missing, _MOST_FINDINGS)]:
                yield from _differences(document, claim, expected, match, spellings)
            return
    often = "nowhere" if not occurrences else f"only {_times(len(occurrences))}"
    written = claim.phrase.written(spellings)
    there = "".join(f", {x} {said!r}" for x, said in zip(("row", "column"), claim.address, strict=False) if said)
    message = f"{written!r} occurs {often} in the text{there}; expected {_times(claim.count)}"
    flat = document.text.text.replace("\n", " ")
    for one in occurrences:  # where nothing is missing
        flat = flat[: one.start()] + " " * len(one[0]) + flat[one.end() :]
    at, tables = flat.find(written), tables_of(document.text.text)
    number = next((x for x in numbers_in(written) if x.label is None), None)
    if any(claim.address[:2]) and at >= 0 and number:  # in another row or column
        stands = tables.address(replace(number, start=at + number.start, end=at + number.end))
        own = [
            f"{x} {said!r}"
            for x, said, named in zip(("row", "column"), stands, claim.address, strict=False)
            if named not in ("", said)
        ]
        yield Finding(claim.id, *document.position(at), written, written, f"{message}; it stands in {', '.join(own)}")
        return
    place, shown = _closest(document, flat, claim.address.row or written)
    message += f"; closest is {shown!r}" if shown else ""
    yield Finding(claim.id, *place, written, shown, message)


def _digits_and_power(number: str) -> str:
    """A decimal with a power of ten: 0.00000699 as 6.99e-6 is like 6.91e-6, and not like 0.800000 as 8e-1."""
    with suppress(ArithmeticError, LookupError, ValueError):
        x = numbers_in(number)[0].value
        return f"{Decimal(x.numerator) / x.denominator:e}"
    return number


def _differences(
    document: Document, claim: Claim, expected: list[str], match: re.Match[str], spellings: Spellings
) -> Iterator[Finding]:
    """The numbers that differ, each with its question where the claim is called by its phrase."""
    wrong = [(i, *pair) for i, pair in enumerate(zip(expected, match.groups(), strict=True), 1) if pair[0] != pair[1]]
    for i, right, found in [one for one in wrong if not spelled_alike(*one[1:])] or wrong[:1]:
        if re.search("[eE×·]", found) and re.fullmatch("-?[0-9.]+", right):
            right = [*decimal_spellings(right), right][1]
        names = [name for name in claim.phrase.names if spellings[name][0] == expected[i - 1]]
        asked = claim.values[names[0]].question if len(names) == 1 < len(claim.phrase.names) else None
        of = f" for {asked}" if asked and "{" in claim.id else ""
        place = document.position(match.start(i))
        yield Finding(claim.id, *place, right, found, f"expected {right}, found {found}{of}")


def _is_under(document: Document, claim: Claim, start: int) -> bool:
    """True if the first number, which begins there, stands under the first head of the columns, if there are any."""
    head = claim.address.columns[0] if claim.address.columns and not claim.phrase.free_numbers else None
    return head is None or tables_of(document.text.text).head_at(start).lower() == head.lower()


def _closest(document: Document, flat: str, written: str) -> tuple[Position, str]:
    """The place of as many words as the phrase has that share most with it, and are most alike, and the text there.

    It begins with them, or with the first that is shared; the start and "" if a third is shared, or less.
    """
    asked, words = Counter(_WORD.findall(written.lower())), [*_WORD.finditer(flat)]
    of, lead = asked.total(), next((word.start() for word in _WORD.finditer(written)), 0)
    within, shared, found = Counter[str](), 0, list[tuple[int, int]]()
    for i, word in enumerate(said := [word[0].lower() for word in words]):
        within[word] += 1
        shared += within[word] <= asked[word]
        if i >= of:
            left = said[i - of]
            shared -= within[left] <= asked[left]
            within[left] -= 1
        found.append((shared, max(0, i + 1 - of)))
    most = max(found, default=(0, 0))[0]
    starts = (
        max(0, word.start() - lead)
        for shared, i in found
        if shared == most > of // 3
        for word in (next(word for word in words[i:] if word[0].lower() in asked), words[i])
    )
    compared = {at: flat[at : at + len(written)] for at in islice(dict.fromkeys(starts), _MOST_COMPARED)}
    if not compared:
        return Position(1, 1), ""
    at = max(compared, key=lambda at: SequenceMatcher(None, written, compared[at]).ratio())
    return document.position(at), _there(flat, at, at + len(written)).rstrip()


def _there(flat: str, start: int, end: int) -> str:
    """The text of a place, with what makes another number of the one at its end: off by 0.5 percent."""
    is_part = flat[start:end][-1:].isdigit() and not re.compile(NUMBER_ENDS).match(flat, end)
    follows = re.match(r"\S* ?\S*", flat[end:]) if is_part else None
    return (flat[start:end] + (follows[0] if follows else "").rstrip(".,;:!? "))[:_SHOWN]


@dataclass(frozen=True)
class Accounted:
    """A number, how it is accounted for (one of ACCOUNTS), and by what: a claim's id or the reason for a label."""

    number: TextNumber
    kind: str
    by: str


@dataclass(frozen=True)
class Coverage:
    """How the numbers of a text are accounted for, in order, and the words for numbers or growth left over."""

    numbers: tuple[Accounted, ...]
    unread: tuple[TextWord, ...] = ()

    @property
    def counts(self) -> dict[str, int]:
        """The count of numbers for each of ACCOUNTS."""
        found = Counter(accounted.kind for accounted in self.numbers)
        return {kind: found[kind] for kind in ACCOUNTS}

    @property
    def share(self) -> Fraction:
        """The share of numbers, labels excluded, that are values, given or run; 1 if there are none."""
        of = len(self.numbers) - self.counts[LABEL]
        return 1 - Fraction(len(self.uncovered), of) if of else Fraction(1)

    @property
    def uncovered(self) -> list[TextNumber]:
        """The numbers that nothing accounts for."""
        return [accounted.number for accounted in self.numbers if accounted.kind == UNCOVERED]


def coverage(
    document: Document, checked: Iterable[CheckedClaim], labels: Iterable[NumberLabel] = (), ran: Iterable[Span] = ()
) -> Coverage:
    """Account for every number of the text; `ran` are the spans of listing output that a run reproduced.

    A number belongs to the value that contains it; otherwise it is a label if a rule of `numbers_in` says so; otherwise
    it belongs to the first span that contains it: the phrase of a claim (as given), the phrase of a label, or the
    output of a run; a remaining number in the code of a listing is a label. A word for a number or for growth in the
    phrase of a claim counts as checked only if it is a value, or if the claim says why its numbers are given.
    Raises ValueError for a label that occurs nowhere.
    """
    text = document.text.text
    values: dict[Span, tuple[str, str]] = {}
    holders: list[tuple[int, int, str, str]] = []
    unheld, denied = list[Span](), set[int]()
    for one in checked:
        claim = one.claim
        for occurrence in one.occurrences:
            for name in claim.phrase.names:
                how = WORKED_OUT if claim.values[name].given is None else GIVEN
                values.setdefault(occurrence.span(name), (how, claim.id))
            holders.append((*occurrence.span(), GIVEN, claim.id))
            unheld += [occurrence.span()] if claim.given is None else []
            denied.update(range(*occurrence.span()) if claim.fact and claim.fact[1] == "no" else ())
    for label in labels:
        found = [match.span() for match in label.phrase.any_numbers().finditer(text)]
        if not found:
            raise ValueError(f"the phrase of the label {label.why!r} occurs nowhere in the text")
        holders += [(*span, LABEL, label.why) for span in found]
    holders += [(*span, RUN, "running the listing") for span in ran]
    holders += [(*span, LABEL, IN_PROGRAM) for span in document.code]
    numbers = [
        Accounted(replace(number, start=start + number.start, end=start + number.end), *how)
        for (start, end), how in values.items()
        for number in numbers_in(text[start:end])  # several in a formula
        if number.label is None
    ]
    rest = list(text)
    for start, end in values:  # replaced by private-use characters, part of no number and no word
        rest[start:end] = "\uf8ff" * (end - start)
    numbers += _other_numbers("".join(rest), holders)
    held = set[int]()
    for start, end in {(start, end) for start, end, *_ in holders}.difference(unheld) | values.keys():
        held.update(range(start, end))
    left = (word for word in words_in(text) if word.start not in held)
    unread = tuple(word for word in left if word.start not in denied or word.text.lower() != "neither")
    return Coverage(tuple(sorted(numbers, key=lambda accounted: accounted.number.start)), unread)


def _other_numbers(text: str, holders: list[tuple[int, int, str, str]]) -> Iterator[Accounted]:
    held: list[tuple[int, str, str] | None] = [None] * len(text)  # per character: end, kind and reason
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
