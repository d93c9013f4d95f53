"""The page of public texts is true: every number on it is worked out anew, and said to be right or wrong."""

import re
from pathlib import Path

import pytest

from docs.pages import TABLE, refreshed, rows_of
from docs.public_text_tables import TABLES, numbers_held
from tests.looping import exactly

PAGE = (Path(__file__).parents[2] / "docs" / "public_texts.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_page_is_what_its_questions_are_answered():
    assert refreshed(PAGE, TABLES) == PAGE, "run `make docs`"


def test_four_fifths_of_the_computed_numbers_of_each_text_are_worked_out():
    summary = next(match[2] for match in TABLE.finditer(PAGE) if match[1] == "summary")
    shares = [int(found.split()[1]) for *_, found, _ in exactly(5, rows_of(summary))]
    assert min(shares) >= 80


@pytest.mark.parametrize(
    ("asked", "printed", "should_be"),
    [
        ("run forward_euler rates=(t+y0) from 0 h=0.2 N={2..5} : y0", "0.04 0.128 0.274 0.489", [None] * 3 + ["0.488"]),
        ("run forward_euler rates=(-y0/2) from 1 h=1/{4,8} t=1/2 : y0", "0.766 0.772", [None, None]),
        ("run forward_euler rates=(y0/2) from 1 h=1/4 t=1/2 : y0", "1.26563", [None]),  # 1.265625, a tie
        ("run forward_euler rates=(y0/2) from 1 h=1/4 t=1/2 : y0", "1.26562", [None]),
        ("run forward_euler rates=(y0/2) from 1 h=1/4 t=1/2 : y0", "1.26561", ["1.26562"]),
        ("step rk4 rates=(t+y0) from 1 h=0.1 : k{1..2}.y0 - 1", "0 .1", [None, None]),
    ],
)
def test_numbers_are_held_as_claims_hold_them(asked, printed, should_be):
    assert [one.should_be for one in numbers_held(f"`{asked}`", printed)] == should_be


def test_wrong_verdict_and_number_too_many_are_noticed():
    row = re.search(r"\| (`run rk4[^|]*`) \| ([^|]*) \| right \|", PAGE)
    name = TABLE.findall(PAGE.partition(row[0])[0])[-1][0]
    planted = f"<!-- table: {name} -->\n\n| | | |\n| --- | --- | --- |\n{row[0].replace('0.713542', '0.713543')}\n"
    assert "**0.713543 should be 0.713542**" in refreshed(planted, TABLES)
    with pytest.raises(ValueError, match="longer"):
        numbers_held(row[1], f"{row[2]} 1.5")
