"""What a stepper did that no stepper should: failures with the call that shows them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any


class Misbehaviour(Exception):
    """A step that gave no usable answer; `kind` is one word for it, the message says what was seen."""

    kind = "misbehaviour"


class StepRaised(Misbehaviour):
    """The stepper raised an exception of its own."""

    kind = "raises"


class WrongShape(Misbehaviour):
    """The answer is not the number of numbers that went in."""

    kind = "wrong_shape"


class NotANumber(Misbehaviour):
    """The answer holds something that is no real number: text, None, a complex number."""

    kind = "not_a_number"


class Increment(Misbehaviour):
    """The answer is y1 - y where y1 is meant."""

    kind = "increment"


class Exchanged(Misbehaviour):
    """The answer is (v1, q1) where (q, v) went in."""

    kind = "exchanged"


class StaleSlope(Misbehaviour):
    """The slope that a step hands on to the next one is not that at its end."""

    kind = "stale_slope"


class NotFinite(Misbehaviour):
    """The answer is NaN or infinite where the exact one is an ordinary number; `answer` is what came."""

    kind = "not_finite"

    def __init__(self, seen: str, answer: tuple[Any, ...]) -> None:
        """What was seen, in words and in numbers."""
        super().__init__(seen)
        self.answer = answer


class NoAnswer(BaseException):
    """A call that had not come back when its time was over, and is not made again: evidence of nothing.

    It is no `Exception`, so that nobody who looks for what a code refuses or raises takes it for that.
    """

    kind = "time_limit"


class UnsupportedCall(ValueError):
    """The stepper takes no force, or no right-hand side, so that this question cannot be put to it."""

    kind = "unsupported_call"


# What says nothing of a stepper, and what would: a time limit, an end from outside, an instrument of ours that failed.
NO_EVIDENCE = {
    "time_limit": "a longer time limit",
    "killed": "a run whose process is not killed",
    "instrument_failed": "a report to us",
}


@dataclass(frozen=True)
class Outcome:
    """What came of one check: its result; or one word for why there is none, and what was seen.

    `arithmetic` says who changed the rounding mode, or what becomes of subnormal numbers, where somebody did; `calls`,
    how often the subject was called for it.
    """

    result: Any = None
    kind: str | None = None
    seen: str = ""
    arithmetic: str = ""
    calls: int = field(default=0, compare=False)

    @property
    def failed(self) -> bool:
        """True when there is no result."""
        return self.kind is not None


def arithmetic_of(outcomes: Iterable[Outcome]) -> str:
    """Who changed the arithmetic, of the first outcome that says so; "" for nobody."""
    return next((outcome.arithmetic for outcome in outcomes if outcome.arithmetic), "")
