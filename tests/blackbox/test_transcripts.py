"""A transcript is held to the word; one of a test that is gone fails, and is dropped where they are written anew."""

from __future__ import annotations

import pytest

from tests.blackbox.transcripts import assert_as_before, shortened


def test_a_line_that_changed_and_a_title_of_no_test_are_noticed(tmp_path, monkeypatch):
    place = tmp_path / "test_all.txt"
    with pytest.raises(AssertionError, match="not as in"):
        assert_as_before(place, "one", [1, "a\nb"])
    monkeypatch.setenv("WRITE_TRANSCRIPTS", "1")
    for title in ("one", "two"):
        assert_as_before(place, title, [1, "a\nb"])
    monkeypatch.delenv("WRITE_TRANSCRIPTS")
    assert_as_before(place, "one", [1, "a\nb"], {"one", "two"})
    for said, tests in (([1, "a\nB"], ()), ([1, "a\nb"], {"one"})):
        with pytest.raises(AssertionError, match="not as in"):
            assert_as_before(place, "one", said, tests)
    monkeypatch.setenv("WRITE_TRANSCRIPTS", "1")
    assert_as_before(place, "one", [2], {"one"})
    assert place.read_text(encoding="utf-8") == "== one\n2\n"


def test_what_is_shortened_still_hangs_on_every_line():
    lines = ["a", "b"]
    assert shortened(lines, True) == lines
    assert shortened(lines, False) != shortened(["a", "c"], False)
