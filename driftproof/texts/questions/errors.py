"""Errors of questions, with the column and the reason in one line, and a time limit for answers."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from driftproof.methods.formulas.expression_tree import ExpressionError

# Chosen: questions of the documentation take less than one second, and foreseeably long ones are refused earlier.
QUESTION_SECONDS = 60


class QuestionError(ExpressionError):
    """A question without an answer: its `text`, the 1-based `column` of the problem, and the `reason` in one line.

    >>> from driftproof import QuestionError, value
    >>> try:
    ...     value("step rk4 h=1/2 : speed")
    ... except QuestionError as error:
    ...     error.column
    18
    """


class AmbiguousRounding(QuestionError):
    """A number half-way between two decimals, for which the question names no rounding policy."""


@contextmanager
def refused_at(question: str, column: int) -> Iterator[None]:
    """Turn every ValueError and ArithmeticError raised inside into a QuestionError at this column."""
    try:
        yield
    except QuestionError:
        raise
    except (ValueError, ArithmeticError) as error:
        raise QuestionError(question, column, str(error)) from None


class _Alarm(BaseException):
    """The time limit has passed. A BaseException, so that no handler of errors catches it on the way."""


@contextmanager
def time_limit(question: str, seconds: float) -> Iterator[None]:
    """Raise QuestionError if the body takes longer than `seconds`, in the main thread of systems with timers."""
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
