"""The tables of docs/language.md: the questions that stand there, and the answers that they have now."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from docs.pages import TABLE, rows_of
from driftproof.texts.questions.decimals import ROUNDING_POLICIES, Style
from driftproof.texts.questions.evaluate import value

Rows = list[list[str]]


def answers(shown: Sequence[Sequence[str]]) -> Rows:
    """Each question of the table with what `driftproof value` prints."""
    return [["question", "answer"], *([question, str(value(question.strip("`")))] for question, *_ in shown)]


def roundings(shown: Sequence[Sequence[str]]) -> Rows:
    """The numbers under every policy, "refused" where a tie is no answer; the places and the last cell stand there."""
    policies = (None, *ROUNDING_POLICIES)
    rows = [
        [number, places, *(_rounded(number.strip("`"), int(places), policy) for policy in policies), why]
        for number, places, *_, why in shown
    ]
    return [["number", "places", "none named", *ROUNDING_POLICIES, ""], *rows]


def _rounded(question: str, places: int, rounding: str | None) -> str:
    try:
        return value(question).places(places, Style(rounding))
    except ValueError:
        return "refused"


def refusals(shown: Sequence[Sequence[str]]) -> Rows:
    """Questions without an answer, each with the one line that says why."""
    return [["question", "the line, after the question"], *([question, _refusal(question)] for question, *_ in shown)]


def _refusal(question: str) -> str:
    try:
        return f"not refused: {value(question.strip('`'))}"
    except ValueError as error:
        return str(error).partition(", ")[2]


def questions_of(*names: str) -> list[str]:
    """The questions of some tables, as they stand on the page."""
    page = Path(__file__).with_name("language.md").read_text(encoding="utf-8")
    found = {match[1]: [row[0].strip("`") for row in rows_of(match[2])] for match in TABLE.finditer(page)}
    return [question for name in names for question in found[name]]


TABLES: dict[str, Callable[[Sequence[Sequence[str]]], Rows]] = {
    **dict.fromkeys(("runs", "facts", "arithmetic"), answers),
    "roundings": roundings,
    "refusals": refusals,
}
