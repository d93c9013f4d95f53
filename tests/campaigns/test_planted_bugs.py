"""Planted bugs are caught and right twins pass: the first of each kind always, all of them in the long tier."""

from collections import Counter
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from driftproof.blackbox.report import Report, sections
from driftproof.methods.catalogue import METHODS
from tests.campaigns import planted_bugs as bugs
from tests.campaigns.planted_steppers import Bug

PAGE = Path(__file__).parents[2] / "docs" / "planted_bugs.md"
OTHER_SYSTEM = "small steps follow q' = v, v' = -0.5 q"


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("kind", bugs.KINDS)
def test_the_first_bug_of_each_kind_is_caught_and_its_right_twin_passes(kind):
    bug = next(bug for bug, equivalent in bugs.planted(kind) if not equivalent)
    assert bugs.judged(bug).passed is False
    assert bugs.judged(bug.mended).passed is True


@pytest.mark.long
def test_every_planted_bug_is_caught_and_named_no_right_twin_fails_and_the_page_says_so():
    twins: dict[Bug, Report] = {}
    tallies = {kind: bugs.campaign(kind, twins) for kind in bugs.KINDS}
    counts = sum((tally.counts for tally in tallies.values()), Counter())
    assert counts["planted"] == bugs.PER_KIND * len(bugs.KINDS) == 220
    assert bugs.page(tallies) == PAGE.read_text(encoding="utf-8")
    assert counts["caught"] == counts["named"] == 219  # kicks of 0.9 are right of another spring, which is told
    assert counts["undecided"] == 1
    assert counts["false pass"] == counts["false alarm"] == 0


def test_the_page_shows_a_row_for_each_kind_no_false_alarm_and_no_false_pass():
    rows = [line.split(" | ") for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| **")]
    assert len(rows) == len(bugs.KINDS) == 11
    for row in rows:
        assert row[1 + bugs.COLUMNS.index("planted")] == str(bugs.PER_KIND)
        assert row[1 + bugs.COLUMNS.index("false pass")] == "0"
        assert row[1 + bugs.COLUMNS.index("false alarm")].rstrip(" |") == "0"


def test_a_kind_has_twenty_different_bugs_of_several_methods_and_conventions():
    found = [bug for bug, equivalent in bugs.planted("component left out") if not equivalent]
    assert len(set(found)) == bugs.PER_KIND
    assert {bug.calls for bug in found} == {"map", "force", "field"}
    assert len({bug.key for bug in found}) > len(bugs.KEYS) // 2


@pytest.mark.parametrize(
    ("bug", "equivalent"),
    [
        (Bug("none", "rk4", "field", METHODS["rk4"]), True),
        (Bug("time", "rk4", "field", METHODS["rk4"], at=0, variant="t"), True),
        (Bug("time", "rk4", "field", METHODS["rk4"], at=1, variant="t"), False),
        (Bug("stale force", "rk4", "map", METHODS["rk4"], at=0), False),
        (Bug("order of updates", "heun2", "map", METHODS["heun2"], at=0), False),
        # One coefficient of Euler's method as a float, and the next float.
        (Bug("sign", "forward_euler", "map", replace(METHODS["forward_euler"], b=(1 + Fraction(1, 2**52),))), False),
        (Bug("sign", "forward_euler", "map", replace(METHODS["forward_euler"], b=(1 + Fraction(1, 2**60),))), True),
    ],
)
def test_equivalence_is_decided_in_exact_arithmetic(bug, equivalent):
    assert bugs.is_equivalent(bug) is equivalent


def test_a_cause_is_named_by_the_changed_entry_and_by_no_other_words():
    bug = Bug("sign", "heun2", "force", METHODS["heun2"], places=(("b", (1,)),))
    said = lambda verdict: bugs.names_the_cause(bug, Report("step", verdict, False, ()))
    assert said("is not heun2; it is heun2 except for b[1]: -1/2 instead of 1/2")
    assert said("is not heun2; it is ralston2")
    assert said("is not heun2; judging by linear steps only, it is heun2_of_another_name")
    assert not said("is not heun2; it is heun2 except for b[0]: -1/2 instead of 1/2")
    assert not bugs.names_the_cause(
        bug, Report("step", "is not heun2; it is rk4", False, sections(("Matrix", [OTHER_SYSTEM])))
    )
    assert not said("is not heun2; judging by linear steps only, it is heun2")
    assert not said("is not heun2; it is not a known method")


def test_what_passes_is_counted_and_told_below_the_table():
    tally = bugs.Tally(Counter({"false pass": 1, "planted": 1}), ["false pass: rk4 as field"])
    text = bugs.page({"time": tally})
    assert "| all | 1 | 0 | 0 | 0 | 0 | 1 | 0 | 0 |" in text
    assert text.endswith("\n- time: false pass: rk4 as field\n")
    assert bugs.page({"time": bugs.Tally(Counter(), [])}).endswith("Each bug was caught, and each twin passed.\n")
