"""Failures of foreign code as exceptions, and the outcome of one check."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import wraps
from typing import Any, ClassVar, NamedTuple, TypeVar

Tried = TypeVar("Tried")
Taken = TypeVar("Taken")


class Misbehaviour(Exception):
    """A step without a usable answer. `kind` is its name in small letters; the message says what was seen."""

    kind: ClassVar[str] = "misbehaviour"

    def __init_subclass__(cls) -> None:
        """Set the kind, unless the class has a word of its own."""
        cls.kind = vars(cls).get("kind", re.sub(r"(?<!^)(?=[A-Z])", "_", cls.__name__).lower())

    @property
    def word(self) -> str:
        """The kind in plain words."""
        return self.kind.replace("_", " ")


class StepRaised(Misbehaviour):
    """The stepper raised an exception of its own."""

    kind = "raises"


class WrongShape(Misbehaviour):
    """The answer does not hold as many numbers as went in."""


class WrongAnswer(WrongShape):
    """The answer is understood, and no step or run gives it."""


class NotANumber(Misbehaviour):
    """The answer holds something that is not a real number: text, None, a complex number."""


class UnlikeParts(NotANumber):
    """Parts of unlike sizes were returned."""


class NothingReturned(NotANumber):
    """The step returns None, or a part that is None, and has written its answer nowhere."""


class AskedAtNoState(NotANumber):
    """The step asks for its right-hand side at what is no real state."""


class ArgumentsExchanged(AskedAtNoState):
    """One call of a right-hand side has its state and its time in another order than the others."""


class Increment(Misbehaviour):
    """The answer is the increment y1 - y instead of y1."""


class Exchanged(Misbehaviour):
    """The step takes (q, v) and returns (v1, q1)."""


class StaleSlope(Misbehaviour):
    """The slope, or the time, that a step hands on to the next one is not that at its end."""


class OwnClock(Misbehaviour):
    """A step begins with what it keeps, such as the time of a clock, and no argument sets it."""


class NotFinite(Misbehaviour):
    """The answer to finite arguments is NaN or infinite. `answer` holds the numbers returned."""

    def __init__(self, seen: str, answer: tuple[Any, ...]) -> None:
        """Keep what was seen, in words and in numbers."""
        super().__init__(seen)
        self.answer = answer


def first_taken(
    ask: Callable[[Tried], Taken],
    tried: Iterable[Tried],
    refusal: type[Exception] | tuple[type[Exception], ...] = Misbehaviour,
) -> Taken:
    """The answer for the first of some things that is not refused. Raises the refusal of the first if all are."""
    refusals: list[Exception] = []
    for each in tried:
        try:
            return ask(each)
        except refusal as refused:
            refusals.append(refused)
    raise refusals[0]


def once(read: Callable[[Tried], Taken]) -> Callable[[Tried], Taken]:
    """The reading, made once of each subject, which keeps it as long as it lives; one that `replace` makes has none."""

    @wraps(read)
    def kept(subject: Tried) -> Taken:
        found: dict[str, Taken] = vars(subject)
        if read.__name__ not in found:
            found[read.__name__] = read(subject)
        return found[read.__name__]

    return kept


class NoAnswer(BaseException):
    """A call that did not come back within its time limit. It is not repeated, and it is evidence of nothing.

    It is no `Exception`, so that code which catches the exceptions of a stepper does not mistake it for one.
    """

    kind = "time_limit"


class UnsupportedCall(ValueError):
    """The stepper cannot be called as a question requires: it takes no force, say, or no right-hand side."""

    kind = "unsupported_call"


class BadInput(ValueError):
    """What was asked for makes no sense for this code, or for numbers of this format."""

    kind = "bad_input"


# Ends of the process of a stepper that no exception tells: from outside, by a fault of ours, by its own.
KILLED, INSTRUMENT_FAILED, CRASHES = "killed", "instrument_failed", "crashes"
# Kinds of outcome that say nothing about a stepper (a time limit, an end from outside, a fault of ours, a clock that we
# cannot set), each with what would settle the question.
NO_EVIDENCE = {
    NoAnswer.kind: "a longer time limit",
    KILLED: "a run whose process is not killed",
    INSTRUMENT_FAILED: "a report to us",
    OwnClock.kind: "a step that begins in the state and at the time that it is given, as in the wrapper",
}


class StepFinding(NamedTuple):
    """Whether what was looked at is right, what was seen in words, and a call that shows a failure, "" for none.

    `holds` is True if all of it is right, False if something is wrong, and None if nothing could be looked at.
    """

    holds: bool | None
    words: str
    reproduction: str = ""


class RightInAnotherForm(StepFinding):
    """What is wrong in the form of state that was given, and right in another one."""


class Remarked(StepFinding):
    """What is neither right nor wrong, and has to be known: a verdict that passes remarks on it."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one check: its result, or one word for why there is none, with what was seen instead.

    `arithmetic` says since when the rounding mode or the treatment of subnormal numbers is changed, if it is. `calls`
    is the number of calls of the subject that the check made; `traits` say what a step may be whose
    coefficients are not read.
    """

    result: Any = None
    kind: str | None = None
    seen: str = ""
    arithmetic: str = ""
    calls: int = field(default=0, compare=False)
    traits: tuple[str, ...] = ()

    @property
    def failed(self) -> bool:
        """True if there is no result."""
        return self.kind is not None

    @property
    def said(self) -> str:
        """The kind of failure in plain words, and what was seen."""
        return f"{str(self.kind).replace('_', ' ')}: {self.seen}"


def arithmetic_of(outcomes: Iterable[Outcome]) -> str:
    """The first change of the arithmetic that an outcome reports; "" if none does."""
    return next((outcome.arithmetic for outcome in outcomes if outcome.arithmetic), "")
