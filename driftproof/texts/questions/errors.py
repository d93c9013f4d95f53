"""What goes wrong with a question: one line, the column, and what is allowed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

# A question is quoted in a complaint no further than this, and a reason, which may hold a formula, said no further.
MOST_QUOTED = 60
MOST_SAID = 500


class QuestionError(ValueError):
    """A question that is not answered: `question`, the 1-based `column` in it, and the `reason`, on one line.

    >>> from driftproof import QuestionError, value
    >>> try:
    ...     value("step rk4 h=1/2 : speed")
    ... except QuestionError as error:
    ...     error.column
    18
    """

    def __init__(self, question: str, column: int, reason: str) -> None:
        """The line is "QUESTION, column N: REASON"."""
        self.question, self.column = question, column
        self.reason = _cut(" ".join(reason.split()), MOST_SAID)
        super().__init__(f"{_cut(' '.join(question.split()), MOST_QUOTED)!r}, column {column}: {self.reason}")


def _cut(text: str, longest: int) -> str:
    return text if len(text) <= longest else f"{text[: longest - 3]}..."


class AmbiguousRounding(QuestionError):
    """A number half-way between two decimals, where half-even and half-away differ and no policy was named."""


@contextmanager
def refused_at(question: str, column: int) -> Iterator[None]:
    """Turns what is refused inside, by any part of the house, into a QuestionError at this column."""
    try:
        yield
    except QuestionError:
        raise
    except (ValueError, ArithmeticError) as error:
        raise QuestionError(question, column, str(error)) from None
