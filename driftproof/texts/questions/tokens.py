"""A question cut into tokens, each with its column."""

from __future__ import annotations

import re
from typing import NamedTuple

from driftproof.texts.questions.errors import QuestionError

LONGEST_QUESTION = 2000
NUMBER, NAME, SIGN, END = "number", "name", "sign", "end"

_TOKEN = re.compile(
    r"(?P<number>(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z_0-9]*(?:\.[A-Za-z_0-9]+)*)"
    r"|(?P<sign>\*\*|[-+*/^()=:,])",
    re.ASCII,
)
_SPACE = re.compile(r"\s*")


class Token(NamedTuple):
    """A piece of the question: its kind, its text, and the 1-based column at which it begins."""

    kind: str
    text: str
    column: int

    @property
    def end(self) -> int:
        """The column after the last character."""
        return self.column + len(self.text)

    @property
    def shown(self) -> str:
        """How a complaint names it."""
        return "the end" if self.kind == END else repr(self.text if len(self.text) <= 40 else f"{self.text[:37]}...")


def tokens(question: str, longest: int) -> list[Token]:
    """The tokens, an empty one of kind END last. Raises QuestionError for a character that has no place."""
    if len(question) > longest:
        reason = f"a question has at most {longest} characters, not {len(question)}"
        raise QuestionError(question, longest + 1, reason)
    text = question.replace("\N{MINUS SIGN}", "-")
    found: list[Token] = []
    at = _after_space(text, 0)
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise QuestionError(question, at + 1, f"{text[at]!r} has no place in a question")
        found.append(Token(str(match.lastgroup), match[0], at + 1))
        at = _after_space(text, match.end())
    return [*found, Token(END, "", len(text) + 1)]


def _after_space(text: str, at: int) -> int:
    match = _SPACE.match(text, at)
    return match.end() if match else at
