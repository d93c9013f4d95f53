"""Each public bug is caught by its cause, no mended twin raises an alarm, and the page counts them."""

import re
from pathlib import Path

import pytest

from tests.campaigns.public_bugs import ALL, Outcome, outcome, page
from tests.looping import some

PAGE = Path(__file__).parents[2] / "docs" / "public_bugs.md"
EACH = [pytest.param(each, id=f"{each.reference}: {each.about}") for each in ALL]


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("replay", EACH)
def test_the_bug_is_caught_its_cause_is_named_and_its_mended_twin_raises_no_alarm(replay):
    found = outcome(replay)
    assert found[:3] == (True, True, False)


def test_the_page_has_a_row_for_each_bug_and_counts_what_is_caught():
    text = PAGE.read_text(encoding="utf-8")
    for replay in some(ALL):
        assert f"| {replay.about} |" in text
    total, caught, named, alarms = map(int, re.search(r"Of (\d+) bugs, (\d+) .*?, (\d+) .*?; (\d+)", text).groups())
    assert (total, caught, named, alarms) == (len(ALL), len(ALL), len(ALL), 0)
    assert total >= 60
    assert len({replay.about for replay in ALL}) == len(ALL)


def test_what_is_not_caught_is_told():
    text = page([Outcome(False, False, True, "")] * len(ALL))
    assert f"Of {len(ALL)} bugs, 0 are caught, 0 with the cause named; {len(ALL)} alarms." in text
