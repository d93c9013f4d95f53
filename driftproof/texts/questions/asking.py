"""What is asked, for those that answer: method, settings, start and readout, each refused at its own column."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from driftproof.texts.questions.errors import QuestionError, refused_at
from driftproof.texts.questions.syntax import Asked
from driftproof.texts.questions.tokens import Token

if TYPE_CHECKING:
    from driftproof.methods.families import Family
    from driftproof.methods.schemes import Method

T = TypeVar("T")

START = (Fraction(1), Fraction(0))
# What a question may begin with that is no fact; `heads` answers each.
HEADS = ("step", "run", "exact", "roundoff")


class Asking:
    """The part of the question `text` that has a head."""

    def __init__(self, asked: Asked, text: str) -> None:
        """Nothing is looked at yet."""
        self.asked, self.text = asked, text
        self.head = asked.head.text

    @property
    def start(self) -> tuple[Fraction, Fraction]:
        """The state from which steps are taken, (1, 0) where none is given."""
        return self.asked.start or START

    def error(self, token: Token | None, reason: str) -> QuestionError:
        """A refusal at a token, at the head where it is absent."""
        return QuestionError(self.text, (token or self.asked.head).column, reason)

    def method(self) -> Method:
        """The one method that is asked about."""
        from driftproof.methods.families import Family

        subject = self.subject()
        if isinstance(subject, Family):
            reason = f"{subject.key} is a family; choose a method with at, a value of {subject.parameter}"
            raise self.error(self.asked.subject, reason)
        return subject

    def subject(self) -> Method | Family:
        """The method, or the family where no value of its parameter is given."""
        from driftproof.methods.catalogue import method_named
        from driftproof.methods.expressions import parse_number
        from driftproof.methods.families import FAMILIES

        token, at = self.asked.subject, self.asked.at
        if token is None:
            raise self.error(None, f"{self.head} is about a method, as in {self.head} rk4")
        if token.text not in FAMILIES:
            with refused_at(self.text, token.column):
                method = method_named(token.text)
            if at is not None:
                raise self.error(at, f"{method.key} has no parameter; families such as sdirk_order_2 have")
            return method
        family = FAMILIES[token.text]
        if at is None:
            return family
        with refused_at(self.text, at.column):
            return family.member(parse_number(at.text, family.parameter))

    def demand_only(
        self, *settings: str, start: bool = False, words: Iterable[str] = (), readout: bool = False, unit: bool = False
    ) -> None:
        """Refuse what this head does not take: other settings, a start, words, a readout, a unit after it."""
        for name, number in self.asked.settings.items():
            if name not in settings:
                takes = f"it takes {', '.join(settings)}" if settings else "it takes none"
                raise QuestionError(self.text, number.column, f"{self.head} has no setting {name} here; {takes}")
        for name, token in self.asked.words.items():
            if name not in words:
                raise self.error(token, f"{self.head} knows no word {name}")
        if self.asked.start is not None and not start:
            raise self.error(None, f"{self.head} starts nowhere here; leave out from")
        if self.asked.readout is not None and not readout:
            raise self.error(self.asked.readout, f"{self.head} has no parts; leave out {self.asked.readout.shown}")
        if self.asked.unit is not None and not unit:
            raise self.error(self.asked.unit, f"{self.asked.unit.shown} has no place; only angles have units to choose")

    def setting(self, name: str, example: str) -> Fraction:
        """A setting that must be there."""
        if name not in self.asked.settings:
            raise self.error(None, f"{self.head} needs {name}, as in {example}")
        return self.asked.settings[name].value

    def readout(self, table: Mapping[str, T], more: str = "") -> T:
        """The entry of the table that the readout names."""
        token = self.asked.readout
        names = f"there are {', '.join(table)}{more}"
        if token is None:
            raise self.error(None, f"{self.head} needs a readout after a colon; {names}")
        if token.text not in table:
            close = get_close_matches(token.text, table, n=1)
            hint = f"did you mean {close[0]}? " if close else ""
            raise self.error(token, f"{token.text[:40]!r} is no readout of {self.head}; {hint}{names}")
        return table[token.text]
