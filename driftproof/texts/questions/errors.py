"""What goes wrong with a question: one line, the column, and what is allowed; and a limit of time."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from driftproof.methods.expression_tree import ExpressionError

# What can be foreseen to be too long is refused before it begins; every question of the documentation takes below one.
QUESTION_SECONDS = 60


class QuestionError(ExpressionError):
    """A question that is not answered: its `text`, the 1-based `column` in it, and the `reason`, on one line.

    >>> from driftproof import QuestionError, value
    >>> try:
    ...     value("step rk4 h=1/2 : speed")
    ... except QuestionError as error:
    ...     error.column
    18
    """

    @property
    def question(self) -> str:
        """The text that was refused."""
        return self.text


class AmbiguousRounding(QuestionError):
    """A number half-way between two decimals, where half-even and half-away differ and no policy was named."""


@contextmanager
def refused_at(question: str, column: int) -> Iterator[None]:
    """Whatever is refused inside is refused as a QuestionError at this column."""
    try:
        yield
    except QuestionError:
        raise
    except (ValueError, ArithmeticError) as error:
        raise QuestionError(question, column, str(error)) from None


class _Alarm(BaseException):
    """Time is up; no handler of errors on the way may take it for one."""


@contextmanager
def time_limit(question: str, seconds: float) -> Iterator[None]:
    """What is done inside ends with a QuestionError after so many seconds.

    By an interval timer: without effect outside the main thread, and on systems that have none.
    """
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def ring(_: int, __: FrameType | None) -> None:
        raise _Alarm

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    except _Alarm:
        raise QuestionError(question, 1, f"no answer within {seconds:g} seconds") from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
