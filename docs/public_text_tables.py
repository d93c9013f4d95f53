"""The tables of docs/public_texts.md: what five public texts print, held to the answers of questions about it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

from docs.pages import TABLE, rows_of
from driftproof.texts.claims.phrases import NumberForm, Phrase, form_of
from driftproof.texts.drafts.possible_values import questions_in
from driftproof.texts.questions.decimals import HALF_AWAY, HALF_EVEN
from driftproof.texts.questions.evaluate import value
from driftproof.texts.readers.canonical import canonical_text
from driftproof.texts.readers.numbers import numbers_in

Rows = list[list[str]]
HEADER = ["asked", "printed", "found"]
_WHOLE = Phrase(("", ""), ("value",))


class Held(NamedTuple):
    """A number as it is printed, and what it should be where it is not that."""

    printed: str
    should_be: str | None


@cache
def numbers_held(asked: str, printed: str) -> list[Held]:
    """The numbers of a row, one for each choice from its braces, in order. Raises ValueError for too many."""
    questions = questions_in(asked.strip("`"))
    return [_held(*pair) for pair in zip(questions, printed.split(), strict=True)]


def _held(question: str, printed: str) -> Held:
    """Held as a claim holds it; where the exact value is a tie, either neighbour is right."""
    (number,) = numbers_in(canonical_text(printed))
    form, answer = form_of(number), value(question)
    try:
        spellings = form.spellings(answer)
    except ValueError:
        ways = (NumberForm(form.places, form.digits, form.exact, rounding) for rounding in (HALF_EVEN, HALF_AWAY))
        spellings = [spelling for way in ways for spelling in way.spellings(answer)]
    right = _WHOLE.exact({"value": spellings}).fullmatch(number.text)
    return Held(printed, None if right else spellings[0])


def held_rows(shown: Sequence[Sequence[str]]) -> Rows:
    """Each row with what was found; what is no question stands there as it is."""
    return [HEADER, *([asked, printed, _found(asked, printed)] for asked, printed, *_ in shown)]


def _found(asked: str, printed: str) -> str:
    if not asked.startswith("`"):
        return "not worked out"
    wrong = [f"{one.printed} should be {one.should_be}" for one in numbers_held(asked, printed) if one.should_be]
    return f"**{', '.join(wrong)}**" if wrong else "right"


def _texts() -> Iterator[tuple[str, Rows]]:
    page = Path(__file__).with_name("public_texts.md").read_text(encoding="utf-8")
    yield from ((match[1], rows_of(match[2])) for match in TABLE.finditer(page) if match[1] != "summary")


def summary(shown: Sequence[Sequence[str]]) -> Rows:
    """Of each text, by the name of its table: numbers, how many are worked out, and how many of these are wrong."""
    tables, rows = dict(_texts()), []
    for name, text, *_ in shown:
        table = tables[name.strip("`")]
        numbers = sum(len(printed.split()) for _, printed, *_ in table)
        held = [one for asked, printed, *_ in table if asked[:1] == "`" for one in numbers_held(asked, printed)]
        wrong = sum(one.should_be is not None for one in held)
        rows.append([name, text, str(numbers), f"{len(held)}, {100 * len(held) // numbers} %", str(wrong)])
    return [["table", "text", "computed numbers", "worked out", "wrong"], *rows]


TABLES: dict[str, Callable[[Sequence[Sequence[str]]], Rows]] = {
    **dict.fromkeys(("notebook", "convergence", "chapter", "wiki", "book"), held_rows),
    "summary": summary,
}
