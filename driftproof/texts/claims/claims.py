"""Claims files: TOML that states what each number of a text is; every mistake is reported in one line."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeGuard

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.support import toml_tables as toml
from driftproof.support.toml_tables import TomlTable
from driftproof.texts.claims.phrases import LONGEST_PHRASE, MOST_DECIMALS, SPELLED, NumberForm, Phrase
from driftproof.texts.questions.decimals import ROUNDING_POLICIES
from driftproof.texts.readers.canonical import canonical_text
from driftproof.texts.readers.document import READERS
from driftproof.texts.readers.numbers import numbers_in
from driftproof.texts.words.tables import ANYWHERE, Address

# Limits on a claims file; 5000 claims are read in about a second.
_LARGEST_FILE = 2**20
MOST_CLAIMS = 5000
_MOST_OCCURRENCES = 10_000
_LONGEST_NAME = 200
_FORM = ("places", "digits", "exact", "rounding", "spelled")
_ELSEWHERE = ("row", "column", *_FORM)


@dataclass(frozen=True)
class Expected:
    """The expected value at one place of a phrase: the answer to a question in some form, or a given number."""

    question: str | None
    given: str | None
    form: NumberForm

    def spellings(self) -> list[str]:
        """All accepted spellings, in canonical form. Raises ValueError if the answer has no such form."""
        from driftproof.texts.questions.evaluate import value

        if self.question is None:
            return [str(self.given)]
        return [canonical_text(text) for text in self.form.spellings(value(self.question))]


@dataclass(frozen=True)
class Claim:
    """A phrase that stands `count` times in the text, its values, and the reason why its other numbers are given.

    The text names the `methods` where the values stand, or one where the first stands. The first number of the phrase
    stands at the `address` in a table, or each value under one of its columns. A phrase without values may say a
    `fact`, a question with its answer, such as yes.
    """

    id: str
    phrase: Phrase
    values: Mapping[str, Expected]
    count: int
    given: str | None
    methods: tuple[str, ...] = ()
    fact: tuple[str, str] | None = None
    address: Address = ANYWHERE

    def spellings(self) -> dict[str, list[str]]:
        """All accepted spellings of each value. Raises ValueError, with a line that names the claim."""
        with refused_in(f"claim {self.id!r}"):
            return {name: expected.spellings() for name, expected in self.values.items()}

    def untrue(self) -> str | None:
        """What is so instead of its fact, None if that is true. Raises ValueError, as above, also for a number."""
        from driftproof.texts.questions.evaluate import value

        with refused_in(f"claim {self.id!r}"):
            question, said = self.fact or ("", "")
            if (answer := value(question) if question else None) and answer.is_number:
                raise ValueError(f"{question} is a number; its phrase has no {{value}} in place of one")
            return None if answer is None or answer.exact_text == said else f"{question} is {answer.exact_text}"


@dataclass(frozen=True)
class NumberLabel:
    """A phrase whose numbers are parts of names, about which nothing is claimed."""

    phrase: Phrase
    why: str


@dataclass(frozen=True)
class Claims:
    """The contents of a claims file: claims, labels, the format of the text, and the coverage it requires."""

    claims: tuple[Claim, ...] = ()
    labels: tuple[NumberLabel, ...] = ()
    form: str | None = None
    coverage: Fraction = Fraction(0)


def read_claims(path: str | Path) -> Claims:
    """Read the claims file at `path`. Raises ValueError, with one line, if it is not a valid claims file."""
    return toml.read_toml(path, _LARGEST_FILE, _claims)


def parse_claims(text: str) -> Claims:
    """Parse the text of a claims file. Raises ValueError, with one line, if it is not valid."""
    return _claims(toml.parse_toml(text))


@contextmanager
def refused_in(what: str) -> Iterator[None]:
    """Prefix every ValueError raised inside with the part of the file that is at fault."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from None


def _claims(table: TomlTable) -> Claims:
    toml.require_keys(table, ("text", "claim", "label"), "the file")
    text = toml.as_table(table.get("text", {}), "text")
    toml.require_keys(text, ("format", "coverage"), "text")
    claims = tuple(_claim(entry, i) for i, entry in enumerate(_entries(table, "claim"), 1))
    if twice := next((key for key, times in Counter(claim.id for claim in claims).items() if times > 1), None):
        raise ValueError(f"two claims have the id {twice!r}")
    labels = tuple(_label(entry, i) for i, entry in enumerate(_entries(table, "label"), 1))
    form = toml.as_choice(text["format"], "format of text", READERS) if "format" in text else None
    share = re.fullmatch(r"([0-9]{1,3}(?:\.[0-9]{1,3})?) ?%", str(text.get("coverage", "0%")))
    if share is None or Fraction(share[1]) > 100:
        raise ValueError('coverage of text is a percentage, like "95%"')
    return Claims(claims, labels, form, Fraction(share[1]) / 100)


def _entries(table: TomlTable, name: str) -> list[TomlTable]:
    found = toml.as_list(table.get(name, []), name, most=MOST_CLAIMS)
    if not all(isinstance(entry, dict) for entry in found):
        raise ValueError(f"{name} is a list of tables; begin each with [[{name}]]")
    return found


def _claim(entry: TomlTable, number: int) -> Claim:
    key = toml.as_line(entry.get("id"), f"id of claim {number}", _LONGEST_NAME)
    with refused_in(f"claim {key!r}"):
        toml.require_keys(
            entry,
            ("id", "phrase", "value", "values", "answer", "count", "given", "method", *_ELSEWHERE),
            "a claim",
        )
        phrase, given = _phrase(entry), entry.get("given")
        if not (given is None or given is True or _is_text(given, _LONGEST_NAME)):
            raise ValueError("given is true, or a short reason why the numbers of the phrase are given")
        fact = _fact(entry, phrase)
        values = {} if fact else _values(entry, phrase)
        if phrase.free_numbers and given is None:
            reason = "is not a placeholder; make it one, or write given = true if it is data"
            raise ValueError(f"the number {phrase.free_numbers[0]} of its phrase {reason}")
        if not (values or fact or given):
            raise ValueError("its phrase contains no number; write {value} in place of one and define value")
        methods = entry.get("method", [])
        methods = methods if isinstance(methods, list) else [methods]
        if len(methods) not in {0, min(1, len(values)), len(values)} or not all(
            str(x) in METHODS or str(x) in FURTHER_METHODS for x in methods
        ):
            raise ValueError(
                "method is the key of a method that the text names where the value stands, or one for each"
            )
        count = toml.as_whole(entry.get("count", 1), "count", 0, _MOST_OCCURRENCES)
        given = "given" if given is True else given
        return Claim(key, phrase, values, count, given, tuple(methods), fact, _address(entry, len(values)))


def _address(entry: TomlTable, values: int) -> Address:
    """The row and the column of the phrase, or one column for each of its values."""
    heads, columns = entry.get("column", ""), list[str]()
    if isinstance(heads, list):
        if len(heads) != values:
            raise ValueError("column is the head of a column of a table, or a list of heads, one for each value")
        heads, columns = "", ["" if head == "" else _head(head, "column") for head in heads]
    elif "column" in entry:
        heads = _head(heads, "column")
    return Address(_head(entry["row"], "row") if "row" in entry else "", heads, tuple(columns))


def _head(found: Any, where: str) -> str:
    return canonical_text(toml.as_line(found, where, LONGEST_PHRASE))


def _fact(entry: TomlTable, phrase: Phrase) -> tuple[str, str] | None:
    """The question of a phrase without a placeholder, and its answer in words, which is yes unless it says another."""
    if phrase.names or not isinstance(question := entry.get("value"), str):
        if "answer" in entry:
            raise ValueError("answer is for a phrase without a placeholder, with a question as its value")
        return None
    return question, toml.as_line(entry.get("answer", "yes"), "answer", _LONGEST_NAME)


def _label(entry: TomlTable, number: int) -> NumberLabel:
    with refused_in(f"label {number}"):
        toml.require_keys(entry, ("phrase", "why"), "a label")
        if not _is_text(entry.get("why"), _LONGEST_NAME):
            raise ValueError("why is a short text that says what its numbers are")
        return NumberLabel(_phrase(entry), entry["why"])


def _is_text(found: object, longest: int) -> TypeGuard[str]:
    return isinstance(found, str) and 0 < len(found) <= longest


def _phrase(entry: TomlTable) -> Phrase:
    if not isinstance(entry.get("phrase"), str):
        raise ValueError("its phrase is missing or not a string")
    with refused_in("phrase"):
        return Phrase.of(entry["phrase"])


def _values(entry: TomlTable, phrase: Phrase) -> dict[str, Expected]:
    if "value" in entry and "values" in entry:
        raise ValueError("it has both value and values; use value if {value} is the only placeholder")
    values = {"value": entry["value"]} if "value" in entry else toml.as_table(entry.get("values", {}), "values")
    for name in phrase.names:
        if name not in values:
            raise ValueError(f"its phrase has the placeholder {{{name}}}, which neither value nor values defines")
    for name in values:
        if name not in phrase.names:
            raise ValueError(f"values defines {name[:40]!r}, which is not a placeholder of its phrase")
    default = {key: entry[key] for key in _FORM if key in entry}
    return {name: _expected(values[name], default) for name in phrase.names}


def _expected(value: Any, default: TomlTable) -> Expected:
    """Parse a value: a question, a table with a question and its form, or a table with a given number."""
    entry = {"ask": value} if isinstance(value, str) else value
    if not isinstance(entry, dict) or ("ask" in entry) == ("given" in entry):
        raise ValueError('a value is a question, {ask = "...", places = 3}, or {given = "0.25"}')
    toml.require_keys(entry, ("ask", "given", *_FORM), "a value")
    question, given = entry.get("ask"), entry.get("given")
    if "given" in entry:
        spelled = canonical_text(given.strip()) if _is_text(given, _LONGEST_NAME) else ""
        if len(entry) > 1 or [number.text for number in numbers_in(spelled)] != [spelled]:
            raise ValueError("given is one number in quotes, as the text writes it, without places, digits or exact")
        return Expected(None, spelled, NumberForm())
    if not isinstance(question, str):
        raise ValueError("a question is a string")
    return Expected(question, None, _form(entry if set(entry) & {*_FORM} - {"rounding"} else {**default, **entry}))


def _form(entry: TomlTable) -> NumberForm:
    chosen = [key for key in ("places", "digits", "exact") if key in entry]
    if len(chosen) > 1:
        raise ValueError(f"it has {' and '.join(chosen)}; give only one of them")
    return NumberForm(
        toml.as_whole(entry["places"], "places", 0, MOST_DECIMALS) if "places" in entry else None,
        toml.as_whole(entry["digits"], "digits", 1, MOST_DECIMALS) if "digits" in entry else None,
        toml.as_flag(entry.get("exact", False), "exact"),
        toml.as_choice(entry["rounding"], "rounding", ROUNDING_POLICIES) if "rounding" in entry else None,
        toml.as_choice(entry["spelled"], "spelled", SPELLED) if "spelled" in entry else None,
    )
