"""A wall-clock limit for answers, as a last resort: what can be foreseen to be too long is refused before it begins."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from driftproof.texts.questions.errors import QuestionError

# Every question of the documentation takes below one second.
SECONDS = 60


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
