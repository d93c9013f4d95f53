"""The report on a whole solver: verdict, sections, JSON; in an isolated process, and from the public door."""

from __future__ import annotations

import json

import pytest

from driftproof import identify_solver
from tests.blackbox.solvers.planted_solvers import adaptive, fixed
from tests.blackbox.transcripts import checksum

LAW = "its step sizes: h_next/h = 0.8 r^(-1/3), at least 0.25, at most 4 (not PI)"


def test_a_right_solver_is_named_with_its_law():
    report = identify_solver(adaptive(), isolate=False)
    assert report.verdict == f"it advances bogacki_shampine32, of order 3; {LAW}"
    assert report.passed is None
    assert report.section("Faults") is None
    titles = [section.title for section in report.sections]
    assert titles[:2] == ["Steps", "Step size control"]
    assert all(title.endswith(", measured") for title in titles[2:])
    data = json.loads(report.json())
    assert (data["steps"], data["faults"]) == ({"name": "bogacki_shampine32", "order": 3}, [])


def test_what_is_wrong_stands_in_the_verdict():
    report = identify_solver(adaptive(stale=True, on_nan="silent"), isolate=False)
    assert report.verdict.startswith(
        f"it advances bogacki_shampine32, of order 3; {LAW}; a rejected step leaves traces"
    )
    assert len(report.section("Faults").lines) == 2


SOLVERS = {
    "right": adaptive("dormand_prince54", exponent=0.2),
    "of another order": adaptive("cash_karp54", exponent=0.25),
    "stale": adaptive(stale=True, on_nan="silent"),
    "deaf to the error": adaptive(estimate=lambda e: [0.0] * len(e)),
    "of one length": fixed(),
    "of two steps": fixed(2),
    "of no pair": adaptive(estimate=lambda e: [2 * e[0], *e[1:-1], e[-1] - e[0]]),
    "without an answer": lambda *_: 7,
}


@pytest.mark.parametrize("name", SOLVERS)
def test_all_that_is_reported_is_as_before(name, as_before):
    report = identify_solver(SOLVERS[name], isolate=False)
    as_before(report.text(everything=True).partition("\n")[2], checksum(report.json()))


def test_a_hang_and_a_refusal_are_told():
    def hangs(f, t_span, y0, rtol, atol):
        while True:
            pass

    assert identify_solver(hangs, time_limit=2.0).verdict.startswith("undecided: no answer within")
    assert identify_solver(lambda *_: 7, isolate=False).verdict.startswith("gives no answer: it returns int")
    with pytest.raises(ValueError, match="cannot be imported"):
        identify_solver("no.such:solver")
