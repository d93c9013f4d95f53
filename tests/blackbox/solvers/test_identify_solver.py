"""The report on a whole solver: verdict, sections, JSON; in an isolated process, and from the public door."""

from __future__ import annotations

import pytest

from driftproof import identify_solver
from tests.blackbox.solvers.planted_solvers import adaptive, fixed
from tests.blackbox.transcripts import checksum, shortened

SOLVERS = {
    "as planted": adaptive(), "right": adaptive("dormand_prince54", exponent=0.2),
    "of another order": adaptive("cash_karp54", exponent=0.25),
    "stale": adaptive(stale=True, on_nan="silent"),
    "deaf to the error": adaptive(estimate=lambda e: [0.0] * len(e)),
    "of one length": fixed(), "of two steps": fixed(2), "without an answer": lambda *_: 7,
}  # fmt: skip
IN_WORDS = ("as planted", "stale", "of one length", "without an answer")


@pytest.mark.parametrize("name", SOLVERS)
def test_all_that_is_reported_is_as_before(name, as_before):
    report = identify_solver(SOLVERS[name], isolate=False)
    said = report.text(everything=True).splitlines()[1:]
    as_before(*said[:3], *shortened(said[3:], name in IN_WORDS), checksum(report.json()))


def test_a_hang_and_a_refusal_are_told():
    def hangs(f, t_span, y0, rtol, atol):
        while True:
            pass

    assert identify_solver(hangs, time_limit=1.0).verdict.startswith("undecided: no answer within")
    assert identify_solver(lambda *_: 7, isolate=False).verdict.startswith("gives no answer: it returns int")
    with pytest.raises(ValueError, match="cannot be imported"):
        identify_solver("no.such:solver")
