"""Numbers in words are spelled as they are read, and one by itself is no number."""

from fractions import Fraction as Q

import pytest
from hypothesis import given
from hypothesis import strategies as st

from driftproof.texts.readers.number_words import (
    counts_of_steps,
    durations,
    is_worded,
    worded_number,
    worded_trend,
    words_in,
)
from tests.looping import some

SPELLED = {
    Q(0): "zero", Q(2): "twice", Q(16): "sixteen", Q(21): "twenty one", Q(100): "a hundred", Q(1, 8): "an eighth",
    Q(160): "one hundred and sixty", Q(5651): "five thousand six hundred and fifty-one", Q(10**6): "One million",
    Q(10**9): "a billion", Q(1, 2): "half", Q(1, 3): "a third", Q(2, 3): "two-thirds", Q(3, 4): "three quarters",
    Q(19): "nineteen", Q(99): "ninety-nine", Q(3): "thrice", Q(9 * 10**11): "nine hundred billion",
}  # fmt: skip


@pytest.mark.parametrize("number", SPELLED)
def test_number_is_written_so(number):
    assert SPELLED[number] in worded_number(number)


@given(st.integers(0, 10**12 - 1) | st.fractions(0, 1, max_denominator=10).filter(lambda x: x.denominator > 1))
def test_every_spelling_is_read_as_one_number(number):
    for spelling in some(worded_number(Q(number)), 2):
        assert is_worded(spelling)
        assert [word.text for word in words_in(f"only {spelling}, and")] == [spelling]


@pytest.mark.parametrize("number", [Q(-1), Q(10**12), Q(1, 11), Q(4, 3)])
def test_what_nobody_writes_in_words_is_refused(number):
    with pytest.raises(ValueError, match="this number has no usual form in words"):
        worded_number(number)


READ = {
    "Sixteen of two and three": ["Sixteen", "two", "three"],
    "Uses one; one of them; no one": ["one"],
    "it grows and shrinks, drops, decayed, and keeps": ["grows", "shrinks", "drops", "decayed"],
    "someone weighs anthony's tent": [],
    "a thousand and\none": ["a thousand"],
    "h halved halves two halves; neither is quartered": ["halved", "halves", "two halves", "neither", "quartered"],
    "too cold, cold; Heun overestimates it, an underestimate": ["cold", "overestimates", "underestimate"],
}


@pytest.mark.parametrize("text", READ)
def test_words_of_a_text(text):
    assert [word.text for word in words_in(text)] == READ[text]


def test_trend_is_the_sign_of_a_change():
    assert [worded_trend(sign)[0] for sign in (1, -1, 0)] == ["grows", "shrinks", "stays"]
    assert not is_worded("steps")


def test_steps_are_counted_in_digits_and_words():
    assert counts_of_steps("After five steps, 200 time steps, One step or ten equal steps") == [5, 200, 1, 10]
    assert durations("After one second, after 2.5 time units, after two steps and in 3 days") == ["1", "2.5"]
    assert counts_of_steps("stepsize 3, twenty steps, 1.5 steps, five stepping stones, 3 step sizes") == []
