"""Resolve what a query names: method, settings, start and readout; errors point to the column of the part."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from driftproof.methods.formulas.expression_tree import Token
from driftproof.support.plain_text import counted, did_you_mean
from driftproof.texts.questions.errors import QuestionError, refused_at
from driftproof.texts.questions.parser import Query, parse_question

if TYPE_CHECKING:
    from driftproof.enclosure.runs.multistep_runs import StartedMultistep
    from driftproof.methods.catalogue import FurtherMethod
    from driftproof.methods.families import Family
    from driftproof.methods.schemes import Method

_Entry = TypeVar("_Entry")


class QueryContext:
    """A query within the question `text`."""

    def __init__(self, query: Query, text: str) -> None:
        self.query, self.text, self.head = query, text, query.head.text

    @property
    def start(self) -> tuple[Fraction, Fraction]:
        """The initial state of the oscillator, (1, 0) by default. Raises QuestionError for another dimension."""
        if self.query.start is None:
            return Fraction(1), Fraction(0)
        if len(self.query.start) != 2:
            raise self.error(None, "a start is a position and a velocity, as in 1,0")
        for entry in self.query.start:
            if isinstance(entry, str):
                raise self.error(None, f"{entry}: the oscillator starts from rationals; with equations you may say pi")
        return self.query.start[0], self.query.start[1]  # type: ignore[return-value]

    @property
    def about_problem(self) -> Token | None:
        """The token that names or begins a problem y' = f(t, y); None for the oscillator."""
        return self.query.problem or next(iter(self.query.rates), None)

    def error(self, token: Token | None, reason: str) -> QuestionError:
        """A QuestionError at the token, at the head for None."""
        return QuestionError(self.text, (token or self.query.head).column, reason)

    def ask_for(self, lacks: str | None, readout: str = "") -> str:
        """The end of a message: the question with what it lacks, ready to be asked; "" if it asks for more."""
        if lacks is None or parse_question(self.text) != self.query:
            return ""
        lacks = lacks or " t=10" * (self.head == "exact" and "t" not in self.query.settings)
        asked, colon, given = self.text.rstrip(" ?").partition(":")
        if self.query.readout is not None:
            readout = ""  # it is told, if only in words
        elif self.head in ("step", "run", "exact"):
            readout = readout or ("error" if self.about_problem else "q")
        method = " with rk4" * (self.query.subject is None and self.head in ("step", "run"))
        ends = f" : {given.strip() or readout}" * bool(colon or readout)
        return f"; ask for example: {asked.rstrip()}{method}{lacks}{ends}"

    def refused(self, token: Token | None = None) -> AbstractContextManager[None]:
        """Turn errors raised inside into QuestionErrors at the token, at the head for None."""
        return refused_at(self.text, (token or self.query.head).column)

    def method(self) -> Method:
        """The method that the query names. Raises QuestionError for a family without a value of its parameter."""
        return self._of_one_step(self.subject())

    def _of_one_step(self, subject: Method | Family | FurtherMethod) -> Method:
        from driftproof.methods.families import Family
        from driftproof.methods.given_methods import method_of

        if isinstance(subject, Family):
            reason = f"{subject.key} is a family of methods; choose one with at and a value of {subject.parameter}"
            raise self.error(self.query.subject, reason)
        with self.refused(self.query.subject):
            return method_of(subject)  # which refuses what has facts only

    def method_of_run(self) -> Method | StartedMultistep:
        """The method that a run names, with what it is started with if it is a multistep one. Raises QuestionError."""
        from driftproof.enclosure.runs.multistep_runs import StartedMultistep
        from driftproof.methods.given_methods import method_of
        from driftproof.methods.multistep import Multistep

        found, started = self.subject(), self.query.started
        if not isinstance(found, Multistep):
            if started is not None:
                raise self.error(started, "started=METHOD is for multistep methods; others start by themselves")
            return self._of_one_step(found)
        if started is None:
            hint = self.ask_for(" started=rk4" + " h=0.1 t=1" * (not self.query.settings), "error")
            more = counted(found.steps - 1, "more value")
            said = f"{found.key} needs {more} than the start: say started=rk4, or another method of one step, or"
            raise self.error(self.query.subject, f"{said} started=exact{hint}")
        with self.refused(started):
            return StartedMultistep(found, None if started.text == "exact" else method_of(started.text))

    def subject(self) -> Method | Family | FurtherMethod:
        """The method, or the family if no value of its parameter is given. Raises QuestionError for an unknown one."""
        from driftproof.methods.families import Family
        from driftproof.methods.formulas.expressions import parse_number
        from driftproof.methods.given_methods import subject_of

        token, at = self.query.subject, self.query.at
        if token is None:
            raise self.error(None, f"{self.head} needs a method, as in {self.head} rk4")
        with self.refused(token):
            found = subject_of(token.text)
        if at is None:
            return found
        if not isinstance(found, Family):
            raise self.error(at, f"{found.key} has no parameter; only families such as sdirk_order_2 do")
        with self.refused(at):
            return found.member(parse_number(at.text, found.parameter))

    def require_only(self, *settings: str, parts: Iterable[str] = ()) -> None:
        """Raise QuestionError for any part but these settings and `parts`, such as start, readout and unit."""
        query = self.query
        if self.about_problem is not None and "problem" not in parts:
            raise self.error(self.about_problem, f"{self.head} takes no problem here; leave it out")
        if query.started is not None and "started" not in parts:
            raise self.error(query.started, f"{self.head} takes no started= here; leave it out")
        if query.energy is not None and not query.rates:
            raise self.error(
                query.energy, "energy goes with equations such as y'=v, v'=-y; a problem has it in its file"
            )
        for name, number in query.settings.items():
            if name not in settings:
                takes = f"it takes {', '.join(settings)}" if settings else "it takes no settings"
                raise QuestionError(self.text, number.column, f"{self.head} does not take {name} here; {takes}")
        if query.start is not None and "start" not in parts:
            raise self.error(None, f"{self.head} takes no start here; leave out 'from'")
        if query.readout is not None and "readout" not in parts:
            raise self.error(query.readout, f"{self.head} has no parts; leave out {query.readout.shown}")
        if query.unit is not None and ("unit" not in parts or (query.readout or query.unit).text != "phase_error"):
            raise self.error(query.unit, f"{query.unit.shown} is not allowed here; only angles take a unit")

    def setting(self, name: str, example: str) -> Fraction:
        """The value of a required setting; `example` is for the error message."""
        if name not in self.query.settings:
            raise self.error(None, f"{self.head} needs {name}, as in {example}{self.ask_for(f' {example}')}")
        return self.query.settings[name].value

    def readout(self, table: Mapping[str, _Entry]) -> _Entry:
        """The entry of the table that the readout names; without a readout, the only entry. Raises QuestionError."""
        token = self.query.readout
        if token is None and len(table) == 1:
            return next(iter(table.values()))
        names = f"the readouts are {', '.join(table)}"
        if token is None:
            lacks = f"{self.head} needs a readout after a colon; {names}{self.ask_for('', next(iter(table)))}"
            raise self.error(None, lacks)
        if token.text.rpartition(".")[2] == "y" and f"{token.text}0" in table and f"{token.text}1" not in table:
            token = token._replace(text=f"{token.text}0")  # a single unknown
        if token.text not in table:
            hint = did_you_mean(token.text, table)
            if self.about_problem is None and token.text.startswith("largest_"):
                hint = self.ask_for(" on q'=v, v'=-q, q(0)=1, v(0)=0, energy=(q^2+v^2)/2")
            elif self.query.rates and "energy" in token.text:
                hint = "; add what it is, as in energy=v^2/2 + x^2"
            raise self.error(token, f"{token.text[:40]!r} is not a readout of {self.head}; {names}{hint}")
        return table[token.text]
