"""A claims file: what the numbers of a text are, read from TOML, every mistake told in one line."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from driftproof.support.toml_tables import (
    Table,
    as_choice,
    as_flag,
    as_line,
    as_list,
    as_table,
    as_whole,
    demand_keys,
    parse_toml,
    read_toml,
)
from driftproof.texts.claims.phrases import Phrase
from driftproof.texts.claims.spelling import MOST_DIGITS, ROUNDINGS, Form
from driftproof.texts.readers.canonical import canonical_spelling
from driftproof.texts.readers.document import READERS
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.readers.source_text import SourceText

LARGEST_FILE = 2**20
MOST_CLAIMS = 5000
MOST_OCCURRENCES = 10_000
LONGEST_NAME = 200


@dataclass(frozen=True)
class Expected:
    """What a value of a phrase is: the answer to a question in some form, or a number that is given."""

    question: str | None
    given: str | None
    form: Form

    def spellings(self) -> list[str]:
        """Every way to write it, in canonical spelling. Raises ValueError where the question has no such answer."""
        if self.given is not None:
            return [_canonical(self.given)]
        from driftproof.texts.questions.ask import value

        assert self.question is not None
        return [_canonical(text) for text in self.form.spellings(value(self.question))]


@dataclass(frozen=True)
class Claim:
    """A phrase that stands `count` times in the text, its values, and why its other numbers are given, if they are."""

    id: str
    phrase: Phrase
    values: Mapping[str, Expected]
    count: int = 1
    given: str | None = None
    ignore_case: bool = False

    def spellings(self) -> dict[str, list[str]]:
        """Every way to write each value. Raises ValueError, in one line that names the claim."""
        try:
            return {name: expected.spellings() for name, expected in self.values.items()}
        except ValueError as error:
            raise ValueError(f"claim {self.id!r}: {error}") from None


@dataclass(frozen=True)
class Label:
    """A phrase whose numbers belong to names: of these nothing is claimed."""

    phrase: Phrase
    why: str


@dataclass(frozen=True)
class Claims:
    """A claims file: its claims and labels, how the text is read, and how much of it has to be covered."""

    claims: tuple[Claim, ...] = ()
    labels: tuple[Label, ...] = ()
    form: str | None = None
    coverage: Fraction = Fraction(0)


def read_claims(path: str | Path) -> Claims:
    """The claims file at `path`. Raises ValueError, in one line, for anything else than a claims file."""
    return read_toml(path, LARGEST_FILE, _claims)


def parse_claims(content: bytes) -> Claims:
    """The claims that a TOML file with this content states. Raises ValueError, in one line."""
    return _claims(parse_toml(content, LARGEST_FILE))


def _claims(table: Table) -> Claims:
    demand_keys(table, ("text", "claim", "label"), "the file")
    text = as_table(table.get("text", {}), "text")
    demand_keys(text, ("format", "coverage"), "text")
    claims = tuple(_claim(entry, i) for i, entry in enumerate(_entries(table, "claim"), 1))
    if twice := next((key for key, times in Counter(claim.id for claim in claims).items() if times > 1), None):
        raise ValueError(f"claim {twice!r} stands in it twice")
    labels = tuple(_label(entry, i) for i, entry in enumerate(_entries(table, "label"), 1))
    form = as_choice(text["format"], "format of text", READERS) if "format" in text else None
    return Claims(claims, labels, form, _share(text.get("coverage", "0%")))


def _claim(entry: Table, number: int) -> Claim:
    key = as_line(entry.get("id"), f"id of claim {number}", LONGEST_NAME)
    try:
        return _claim_named(key, entry)
    except ValueError as error:
        raise ValueError(f"claim {key!r}: {error}") from None


_FORM = ("places", "digits", "exact", "rounding")


def _claim_named(key: str, entry: Table) -> Claim:
    demand_keys(entry, ("id", "phrase", "value", "values", "count", "given", "ignore_case", *_FORM), "a claim")
    phrase = _phrase(entry)
    given = entry.get("given")
    if not (given is None or given is True or (isinstance(given, str) and 0 < len(given) <= LONGEST_NAME)):
        raise ValueError("given is true, or says in a few words why the numbers of the phrase are")
    values = _values(entry, phrase)
    free = next((n.text for literal in phrase.literals for n in numbers_in(literal) if n.label is None), None)
    if free is not None and given is None:
        raise ValueError(f"the number {free} of its phrase is no value; make it one, or say given = true if it is data")
    if not values and free is None:
        raise ValueError("its phrase holds no number; write {value} where one stands, and say what it is")
    return Claim(
        key,
        phrase,
        values,
        as_whole(entry.get("count", 1), "count", 0, MOST_OCCURRENCES),
        "given" if given is True else given,
        as_flag(entry.get("ignore_case", False), "ignore_case"),
    )


def _values(entry: Table, phrase: Phrase) -> dict[str, Expected]:
    if "value" in entry and "values" in entry:
        raise ValueError("it has both value and values; value is for a phrase with {value} alone")
    values = {"value": entry["value"]} if "value" in entry else as_table(entry.get("values", {}), "values")
    for name in phrase.names:
        if name not in values:
            raise ValueError(f"its phrase holds {{{name}}}, and nothing says what that is")
    for name in values:
        if name not in phrase.names:
            raise ValueError(f"its values name {name[:40]!r}, which its phrase does not hold")
    default = {key: entry[key] for key in _FORM if key in entry}
    return {name: _expected(values[name], default) for name in phrase.names}


def _expected(value: Any, default: dict[str, Any]) -> Expected:
    """A question, or a table of a question and its form, or of a given number."""
    entry = {"ask": value} if isinstance(value, str) else value
    if not isinstance(entry, dict) or ("ask" in entry) == ("given" in entry):
        raise ValueError('a value is a question, {ask = "...", places = 3}, or {given = "0.25"}')
    demand_keys(entry, ("ask", "given", *_FORM), "a value")
    question, given = entry.get("ask"), entry.get("given")
    if given is not None:
        found = numbers_in(_canonical(given)) if isinstance(given, str) and len(given) <= LONGEST_NAME else []
        if len(entry) > 1 or len(found) != 1 or found[0].text != _canonical(given):
            raise ValueError("given is one number as a text, as it stands in the phrase, and has no form")
        return Expected(None, given, Form())
    if not isinstance(question, str):
        raise ValueError("a question is a text")
    return Expected(question, None, _form(entry if set(entry) & {*_FORM} - {"rounding"} else {**default, **entry}))


def _form(entry: Table) -> Form:
    chosen = [key for key in ("places", "digits", "exact") if key in entry]
    if len(chosen) > 1:
        raise ValueError(f"it says {' and '.join(chosen)}; one of them is enough")
    return Form(
        as_whole(entry["places"], "places", 0, MOST_DIGITS) if "places" in entry else None,
        as_whole(entry["digits"], "digits", 1, MOST_DIGITS) if "digits" in entry else None,
        as_flag(entry.get("exact", False), "exact"),
        as_choice(entry["rounding"], "rounding", ROUNDINGS) if "rounding" in entry else None,
    )


def _label(entry: Table, number: int) -> Label:
    try:
        demand_keys(entry, ("phrase", "why"), "a label")
        why = entry.get("why")
        if not isinstance(why, str) or not 0 < len(why) <= LONGEST_NAME:
            raise ValueError("why says in a few words what its numbers are")
        return Label(_phrase(entry), why)
    except ValueError as error:
        raise ValueError(f"label {number}: {error}") from None


def _phrase(entry: Table) -> Phrase:
    if not isinstance(entry.get("phrase"), str):
        raise ValueError("its phrase is missing, or no text")
    try:
        return Phrase.of(entry["phrase"])
    except ValueError as error:
        raise ValueError(f"phrase: {error}") from None


def _canonical(text: str) -> str:
    return canonical_spelling(SourceText.of(text.strip())).text


def _entries(table: Table, name: str) -> list[Table]:
    found = as_list(table.get(name, []), name, most=MOST_CLAIMS)
    if not all(isinstance(entry, dict) for entry in found):
        raise ValueError(f"{name} is a list of tables; begin each with [[{name}]]")
    return found


def _share(found: Any) -> Fraction:
    match = re.fullmatch(r"([0-9]{1,3}(?:\.[0-9]{1,3})?) ?%", found) if isinstance(found, str) else None
    if match is None or Fraction(match[1]) > 100:
        raise ValueError('coverage of text is a percentage, like "95%"')
    return Fraction(match[1]) / 100
