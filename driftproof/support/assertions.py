"""The verdicts of `assert_verified`, `assert_accurate` and `assert_text`: told to listeners, raised if they fail."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass, field

from driftproof.support.plain_text import Json


@dataclass(frozen=True)
class AssertedVerdict:
    """A verdict on a stepper, a trajectory or a text: one line of words, the whole report, and data for a program.

    `passed` is None if the verdict is undecided.
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
    """Raised for a `verdict` that does not hold; its whole report is the message unless one is given."""

    def __init__(self, verdict: AssertedVerdict, message: str | None = None) -> None:
        """Take the message, or else the report of the verdict."""
        super().__init__(verdict.report if message is None else message)
        self.verdict = verdict


class RemarkWarning(UserWarning):
    """Warns of a verdict that passes with a remark, such as a step that overwrites its arguments.

    A test fails there under pytest's `filterwarnings = ["error::driftproof.RemarkWarning"]`.

    >>> import warnings
    >>> from driftproof import RemarkWarning
    >>> warnings.simplefilter("error", RemarkWarning)
    """


# Functions that are called with every verdict, whether it holds or not.
listeners: list[Callable[[AssertedVerdict], None]] = []
# The time limit in seconds of assertions that name none themselves, set by a test; None: the assertion's default.
time_limit_of_test: ContextVar[float | None] = ContextVar("time_limit_of_test", default=None)


def assert_verdict(verdict: AssertedVerdict, *, holds: bool, message: str | None = None) -> None:
    """Pass the verdict to all listeners, and raise VerdictError, with the message if one is given, unless it holds.

    >>> assert_verdict(AssertedVerdict("springs:step", "is rk4", True, "the whole report"), holds=True)
    """
    __tracebackhide__ = True
    for listener in listeners:
        listener(verdict)
    if not holds:
        raise VerdictError(verdict, message)
