"""Calculations that a text prints in full, such as 0.9/1.1 = 0.8182, as questions for what they give."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import NamedTuple

from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.words.stated_problems import plain

# Numbers, brackets, roots, π, powers of e and signs, and a sign of equality behind; what is before is no part of it.
_CALCULATION = re.compile(
    r"(?<![\w.,^)\]])(?:log_?2 )?(?:[(√π0-9-]|e(?=\^))(?:[-+*/·×^()0-9.√π{} ]|e(?=\^))*[0-9)}π]"
    r"(?= ?[=≈] ?(?P<result>[-+]?[0-9.]))"
)
_LONGER = re.compile(r"(?:[-+*/·×^√_]|(?<!\w)(?:\w|sin|cos|tan|exp|ln|log|lg)) ?\Z")
_OPERATOR = re.compile(r"[0-9)}π] ?[-+*/·×^] ?[0-9({√π]|[√_]|e\^|[0-9] ?π")
# A longer calculation than people print on one line.
_LONGEST = 80


class Calculation(NamedTuple):
    """A calculation from `start`, the place of its result, and what it gives exactly."""

    start: int
    result: int
    question: str
    answer: Answer


def calculations_in(text: str) -> list[Calculation]:
    """The calculations of a text in canonical spelling, with numbers only and a result behind each.

    >>> [(one.question, one.answer.places(4)) for one in calculations_in("the factor 0.9/1.1 = 0.8182")]
    [('0.9/1.1', '0.8182')]
    """
    found = []
    for match in _CALCULATION.finditer(text):
        if len(match[0]) <= _LONGEST and _OPERATOR.search(match[0]) and not _LONGER.search(text[: match.start()][-8:]):
            question = plain(re.sub(r"(?<=[0-9)π]) ?(?=[√eπ])", "*", match[0].replace("×", "*")))
            question = question.replace("^", "**").replace("{", "(").replace("}", ")")
            question = re.sub(r"\Alog_?2 (.+)", r"log2(\1)", question)
            with suppress(QuestionError):
                found.append(Calculation(match.start(), match.start("result"), question, value(question)))
    return found
