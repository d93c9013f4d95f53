"""A number has the step size and the time of its row, its head or its sentence, and else the last ones before it."""

from fractions import Fraction as Q

import pytest

from driftproof.texts.readers.numbers import TextNumber
from driftproof.texts.words.contradictions import sentence_around
from driftproof.texts.words.settings_named import settings_named
from driftproof.texts.words.tables import tables_of


@pytest.mark.parametrize(
    ("text", "settings", "near"),
    [
        ("for h = 0.1 and t = 2, y = {}", {"h": "1/10", "t": "2"}, "ht"),
        ("h = 0.1, t = 2. Then y = {}", {"h": "1/10", "t": "2"}, ""),
        ("h = 0.1, t = 3: y = {} for h = 0.2", {"h": "1/5", "t": "3"}, "ht"),
        ("with h = 0.1 it is off by {}, with h = 0.2 by 0.9", {"h": "1/10"}, "h"),
        ("with h = 0.1; its error is {}, and 0.9 with h = 0.2", {"h": "1/10"}, ""),
        ("for h = 0.2 and h = 0.1 it is 0.9 and {}", {"h": "1/10"}, "h"),
        ("for h = 0.2 and h = 0.1 it is {}", {"h": "1/10"}, ""),
        ("h = 0.1, it goes to ({}, 0.5) at t = 0.2", {"h": "1/10", "t": "1/5"}, "ht"),
        ("δt = 0.1: after five steps y = {}", {"h": "1/10", "t": "1/2"}, "h"),
        ("h = 0.1: after 20 steps, at t = 3, y = {}", {"h": "1/10", "t": "3"}, "ht"),
        ("h = 0.1: {} % after 4 steps", {"h": "1/10", "t": "2/5"}, "h"),
        ("h = 0.1: after one second y = {}", {"h": "1/10", "t": "1"}, "ht"),
        ("h = 0.1, y(2) is {}", {"h": "1/10", "t": "2"}, "ht"),
        ("h = 0.1, t = 3. Its energy is {} at the start", {"h": "1/10", "t": "0"}, "t"),
        ("with h = 0.1, in the very first step euler goes to y = {}", {"h": "1/10", "t": "1/10"}, "h"),
        ("with h = 0.1, at last euler goes to y = {}", {"h": "1/10"}, "h"),
        ("h = 0.1\n| n | s_n |\n| 4 | {} |", {"h": "1/10", "n": "4", "t": "2/5"}, "t"),
        ("h = 0.1, t = 2\n| N | S |\n| 4 | {} |", {"h": "1/2", "t": "2"}, ""),
        ("errors\nh = 0.2 h = 0.1\n| euler | {} |", {}, ""),  # heads that are not told apart
        ("errors\nh = 0.1\n| euler | {} |", {"h": "1/10"}, ""),
    ],
)
def test_step_size_and_time_are_those_of_the_place(text, settings, near):
    start, written = text.index("{"), text.format("0.75").lower()
    row = tables_of(written).row_of(TextNumber(start, start + 4, "0.75", None))
    head = row[-1].head if row else ""
    found, of_place, _ = settings_named(
        written, (start, start + 4), sentence_around(written, start, start + 4), row, head
    )
    assert found == {x: Q(given) for x, given in settings.items()}
    assert of_place == {*near}
