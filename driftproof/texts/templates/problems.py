"""What is wrong with a template: one line with file, line and column."""

from __future__ import annotations

from typing import NamedTuple


class Place(NamedTuple):
    """A character of a template: the template's name, and the offset from its beginning.

    `of_question` is true where a question begins there, whose own columns then count from that character.
    """

    template: str
    offset: int
    of_question: bool = False


class Refusal(ValueError):
    """What a template asks for is not done; whoever knows the place makes a TemplateProblem of it."""


class TemplateProblem(ValueError):
    """A template that cannot be rendered; the message is the whole line: file, line, column, reason."""


def problem(place: Place, source: str, reason: str) -> TemplateProblem:
    """The problem with a reason at a place in the source of its template; lines and columns count from 1."""
    before = source[: place.offset]
    line, column = before.count("\n") + 1, place.offset - (before.rfind("\n") + 1) + 1
    return TemplateProblem(f"{place.template}, line {line}, column {column}: {' '.join(reason.split())}")
