"""A question answered: value("step rk4 h=1/2 from 1,0 : q")."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache

from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.errors import QuestionError, refused_at
from driftproof.texts.questions.parser import parse
from driftproof.texts.questions.syntax import Asked, Call, Chain, Negated, Node, Number, Power, Published


@lru_cache(maxsize=1024)
def value(question: str) -> Answer:
    """The answer to a question of the language that docs/language.md describes, or the published value of that id.

    Raises QuestionError, one line with the column, for a question that has no answer. Nothing is evaluated as code.

    >>> from driftproof import value
    >>> value("step rk4 h=1/2 : q").exact
    Fraction(337, 384)
    """
    return replace(_answer(parse(question), question), question=question)


def _answer(node: Node, question: str) -> Answer:
    from driftproof.texts.questions import arithmetic

    match node:
        case Number():
            return Answer("", node.value)
        case Published():
            return _published(node, question)
        case Asked():
            from driftproof.texts.questions.heads import answer

            return answer(node, question)
        case Chain():
            return _chain(node, question)
        case Call():
            return _call(node, question)
        case Negated():
            inner = _answer(node.node, question)
            with refused_at(question, node.column):
                return arithmetic.negate(inner)
        case Power():
            base = _answer(node.base, question)
            with refused_at(question, node.column):
                return arithmetic.power(base, node.exponent)


def _published(node: Published, question: str) -> Answer:
    """The exact form of a published value is itself a question, of which the answer is enclosed to any length."""
    from driftproof.texts.questions.answer import as_printed
    from driftproof.texts.values.published import published_values

    entries = published_values()
    if node.name not in entries:
        raise QuestionError(question, node.column, _unknown(node.name, [*entries]))
    entry = entries[node.name]
    if entry["exact"] is None:
        return as_printed(entry)
    return replace(value(entry["exact"]), form=entry["exact"], evidence=entry["evidence"])


def _unknown(name: str, ids: list[str]) -> str:
    close = get_close_matches(name, ids, n=2)
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    return f"{name[:60]!r} is no id of a published value; {hint}`driftproof value --list` shows what can be asked"


def _chain(node: Chain, question: str) -> Answer:
    """Sums and products, from the left."""
    from driftproof.texts.questions import arithmetic

    operations: dict[str, Callable[[Answer, Answer], Answer]] = {
        "+": arithmetic.add,
        "-": arithmetic.subtract,
        "*": arithmetic.multiply,
        "/": arithmetic.divide,
    }
    total = _answer(node.first, question)
    for sign, part in node.rest:
        other = _answer(part, question)
        with refused_at(question, sign.column):
            total = operations[sign.text](total, other)
    return total


def _call(node: Call, question: str) -> Answer:
    """A function of numbers."""
    from driftproof.texts.questions.arithmetic import FUNCTIONS

    name = node.function
    if name not in FUNCTIONS:
        raise QuestionError(question, node.column, f"{name[:40]!r} is no function; there are {', '.join(FUNCTIONS)}")
    function, count = FUNCTIONS[name]
    if len(node.arguments) != count:
        raise QuestionError(question, node.column, f"{name} takes {count} number{'s' * (count > 1)}")
    arguments = [_answer(argument, question) for argument in node.arguments]
    with refused_at(question, node.column):
        return function(*arguments)
