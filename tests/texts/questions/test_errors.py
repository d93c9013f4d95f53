"""Errors of questions are one line of bounded length; answers that do not end are ended."""

import signal
import threading

import pytest

from driftproof.texts.questions.errors import QUESTION_SECONDS, QuestionError, time_limit
from driftproof.texts.questions.evaluate import value


def test_time_limit_ends_what_does_not_end_and_leaves_the_rest_alone():
    with time_limit("quick", 60):
        assert value("1 + 1").exact == 2
    assert signal.getitimer(signal.ITIMER_REAL) == (0, 0)
    assert signal.getsignal(signal.SIGALRM) == signal.SIG_DFL

    def for_ever():
        with time_limit("for ever", 0.05):
            while True:
                pass

    with pytest.raises(QuestionError, match=r"no answer within 0\.05 seconds"):
        for_ever()
    assert signal.getsignal(signal.SIGALRM) == signal.SIG_DFL


def test_time_is_not_limited_beside_the_main_thread():
    found = []

    def limited():
        with time_limit("long", 60):
            found.append(signal.getitimer(signal.ITIMER_REAL))

    thread = threading.Thread(target=limited)
    thread.start()
    thread.join()
    assert found == [(0, 0)]
    assert QUESTION_SECONDS == 60, "as docs/language.md says"


def test_error_is_one_line_that_quotes_no_more_than_it_must():
    error = QuestionError("a\nb" * 100, 3, "no\n" * 1000)
    assert str(error).startswith("'a ba ba")
    assert len(str(error)) < 600
    assert "\n" not in str(error)
