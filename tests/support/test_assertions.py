"""Findings of assertions: every listener hears every one, and those that do not hold are raised."""

import pytest

from driftproof.support.assertions import AssertedVerdict, VerdictError, assert_verdict, listeners

WRONG = AssertedVerdict("springs:step", "is not rk4", False, "the whole report", {"order": 1})


@pytest.fixture
def heard():
    told = []
    listeners.append(told.append)
    yield told
    listeners.remove(told.append)


def test_what_holds_is_told_and_not_raised(heard):
    assert_verdict(WRONG, holds=True)
    assert heard == [WRONG]


def test_what_does_not_hold_is_told_and_raised_with_the_whole_report(heard):
    with pytest.raises(VerdictError, match="the whole report") as raised:
        assert_verdict(WRONG, holds=False)
    assert heard == [WRONG]
    assert raised.value.verdict is WRONG
    assert isinstance(raised.value, AssertionError)


def test_the_headline_is_one_line():
    assert WRONG.headline == "springs:step is not rk4"
