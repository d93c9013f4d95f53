"""The benchmarks run, compare and report; how long anything takes depends on the machine, so no time is tested."""

from __future__ import annotations

import json
import time
from pathlib import Path

import pytest

from benchmarks import answers, facts, import_time, order, report, roundoff, stability
from benchmarks.timing import Contestant, Goal, Row, Section, Subject, Times, forget, measure, times_rows
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.steppers import rk4
from driftproof.symbolic.facts import FACTS
from driftproof.symbolic.trees import rooted

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("benchmark", [order, stability, import_time], ids=lambda benchmark: benchmark.__name__)
def test_benchmark_measures_and_prints_its_goals(benchmark, capsys):
    benchmark.main(["--rounds", "1"])
    shown = capsys.readouterr().out
    assert "minimum" in shown
    assert "wanted" in shown


def test_benchmark_of_rounding_searches_and_prints_its_goals(capsys, monkeypatch):
    monkeypatch.setattr(roundoff, "PROGRAMS", {"rk4": rk4})
    roundoff.main(["--generations", "0", "--checks", "3"])
    assert "steps whose rounding error exceeds the bound      0" in capsys.readouterr().out


def test_every_fact_is_asked():
    (row,) = measure(facts.subjects()[:1], rounds=1, turn=0)
    assert row.answers["ours"] == str(len(FACTS))


def test_contestants_take_turns_and_a_slow_one_gets_a_single_one():
    turns: list[str] = []
    slow = Contestant(lambda: (turns.append("slow"), time.sleep(0.01)))
    quick = Contestant(lambda: turns.append("quick"))
    (row,) = measure([Subject("q", {"ours": quick, "peer": slow})], rounds=3, turn=0, limit=0.005)
    assert turns == ["quick", "slow", "quick", "quick"]
    assert [len(times.samples) for times in row.times.values()] == [3, 1]


def test_row_says_where_the_goal_is_missed_and_who_answers_otherwise():
    times = {"ours": Times([4.0, 2.0, 3.0]), "peer": Times([5.0, 9.0])}
    row = Row("question", times, {"ours": "8", "peer": "7"}, 1.5)
    (goal,) = row.goals()
    assert (goal.found, goal.met) == ("2 ms", False)
    assert next(Row("question", times, {}, 2.5).goals()).met
    assert times_rows([row])[1:] == [
        ["question", "ours", "2 ms", "3 ms", "33 %", "3", "", "8"],
        ["", "peer", "5 ms", "7 ms", "29 %", "2", "2.5", "7"],
    ]


def test_forgetting_empties_the_caches_of_the_exact_side():
    rooted.shapes(5)
    assert rooted.shapes.cache_info().currsize
    forget()
    assert rooted.shapes.cache_info().currsize == 0


def test_report_names_the_goals_that_are_missed():
    timed = {"Times": [Row("quick", {"ours": Times([1.0])}, {"ours": "1"}, 2)]}
    sections = [Section("Table", [["a", "b"], ["|h|", "1"]], [Goal("bound", "0", "3", False)])]
    page = report.page(timed, sections, {}, 1)
    assert "1 of 2 goals are met; missed: bound." in page
    assert "| bound | 0 | 3 | **missed** |" in page
    assert "| \\|h\\| | 1 |" in page
    assert "No peer was installed." in page


def test_committed_report_has_every_goal():
    page = (DOCS / "benchmarks.md").read_text(encoding="utf-8").partition("## How")[0]
    subjects = [*order.subjects(), *stability.subjects(), *facts.subjects()]
    assert all(f"| {subject.name} | ≤" in page for subject in subjects if subject.goal)
    assert "| import driftproof loads SymPy | no | no | met |" in page


def test_kept_answers_of_peers_are_about_our_methods_and_facts():
    kept = json.loads((DOCS / "peers.json").read_text(encoding="utf-8"))
    assert answers.as_json(kept) == (DOCS / "peers.json").read_text(encoding="utf-8")
    assert set(kept) <= set(answers.QUESTIONS)
    for name, peer in kept.items():
        assert set(peer["facts"]) == set(answers.QUESTIONS[name]) <= set(FACTS)
        assert all(set(seen["differs"]) | set(seen["silent"]) <= set(METHODS) for seen in peer["facts"].values())


def test_comparison_counts_what_a_peer_answers_and_where_it_differs(monkeypatch):
    monkeypatch.setattr(answers, "tableaux", lambda: [METHODS[key] for key in ("rk4", "heun2", "gauss2", "rk38")])
    said = {"rk4": 4, "heun2": 3, "gauss2": "Unknown"}
    found = answers.compared("order", lambda method: said[method.key])
    assert (found.agree, found.differs) == (1, {"heun2": "3"})
    assert found.silent == {"gauss2": "Unknown", "rk38": "KeyError"}


@pytest.mark.parametrize(
    ("theirs", "mine", "same"),
    [
        ("2.78529", "2.78529", True),
        ("5.9999995", "6", True),
        ("5.999", "6", False),
        ("inf", "inf", True),
        ("yes", "no", False),
    ],
)
def test_reals_are_compared_as_far_as_floats_go(theirs: str, mine: str, same: bool) -> None:
    assert answers.same(theirs, mine) is same


def test_a_question_that_takes_too_long_has_no_answer(monkeypatch):
    monkeypatch.setattr(answers, "PATIENCE", 0.01)
    assert answers.answered(lambda: time.sleep(1)) == (None, "no answer within 0.01 s")
    assert answers.answered(lambda: 1) == (1, "")
