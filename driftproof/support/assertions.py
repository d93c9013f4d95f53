"""What the assertions for tests found: raised where it does not hold, and told to whoever listens."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass, field

from driftproof.support.plain_text import Json


@dataclass(frozen=True)
class AssertedVerdict:
    """A verdict on a stepper or a trajectory: in one line, as the whole report, and as data for a program.

    `passed` is None where it is undecided.
    """

    subject: str
    words: str
    passed: bool | None
    report: str
    data: dict[str, Json] = field(default_factory=dict)

    @property
    def headline(self) -> str:
        """Subject and verdict in one line.

        >>> AssertedVerdict("springs:step", "is not rk4", False, "...").headline
        'springs:step is not rk4'
        """
        return f"{self.subject} {self.words}".strip()


class VerdictError(AssertionError):
    """What a test held its code to does not hold; the message is the whole report, `verdict` what was found."""

    def __init__(self, verdict: AssertedVerdict) -> None:
        """Raised for a verdict that does not hold."""
        super().__init__(verdict.report)
        self.verdict = verdict


# Called with every verdict of an assertion, whether it holds or not.
listeners: list[Callable[[AssertedVerdict], None]] = []
# Seconds that a test gives an assertion which names no limit itself; None: the assertion's own default.
time_limit_of_test: ContextVar[float | None] = ContextVar("time_limit_of_test", default=None)


def tell(verdict: AssertedVerdict) -> None:
    """Tell the listeners."""
    for listener in listeners:
        listener(verdict)


def demand(verdict: AssertedVerdict, *, holds: bool) -> None:
    """Tell the listeners, and raise VerdictError unless it holds.

    >>> demand(AssertedVerdict("springs:step", "is rk4", True, "the whole report"), holds=True)
    """
    __tracebackhide__ = True
    tell(verdict)
    if not holds:
        raise VerdictError(verdict)
