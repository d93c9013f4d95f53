"""The benchmarks compare like with like and report; how long anything takes is the machine's, and is not tested."""

import json
import shutil
import time
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest

from benchmarks import __main__ as benchmarks
from benchmarks import answers, engine, exact_facts, growth, harness, import_time, lines, peers_time, roundoff
from benchmarks.harness import Contestant, Goal, Row, Section, Subject, forget, measure, timed
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.advance import field_rate
from driftproof.numeric.steppers import rk4
from driftproof.numeric.steps import field_loops
from driftproof.numeric.steps.engine import runner
from driftproof.numeric.work_precision.timing import Timing
from driftproof.reports.work_precision.peers import Peer
from driftproof.symbolic.facts import FACTS
from driftproof.symbolic.trees import rooted_trees as rooted

DOCS = Path(__file__).parents[2] / "docs"
SUBJECTS = [subject for subjects in exact_facts.TITLES.values() for subject in subjects()]


def timing(*seconds):
    return Timing(samples=list(seconds))


# --- the harness --------------------------------------------------------------------------------------------------


@pytest.fixture
def clock(monkeypatch):
    """A clock of one reading, in seconds, that tasks put forward; the harness reads it instead of the machine's."""
    readings = [0.0]
    monkeypatch.setattr(harness, "perf_counter", lambda: readings[0])
    return readings


def takes(seconds, clock, turns, name):
    """A task, or what comes before one."""

    def task():
        clock[0] += seconds
        turns.append(name)
        return 7

    return task


@pytest.mark.slow
def test_contestants_take_turns_and_a_slow_one_gets_a_single_one(clock):
    turns = []
    both = {"ours": Contestant(takes(1, clock, turns, "quick")), "peer": Contestant(takes(9, clock, turns, "slow"))}
    (row,) = measure([Subject("q", both)], rounds=3, turn=0, limit=5)
    assert turns == ["quick", "slow", "quick", "quick"]
    assert [times.samples for times in row.times.values()] == [[1, 1, 1], [9]]


def test_short_task_is_repeated_in_its_turn_and_what_comes_before_it_is_not_timed(clock):
    turns = []
    task, before = takes(2, clock, turns, "task"), takes(100, clock, turns, "before")
    (row,) = measure([Subject("q", {"ours": Contestant(task, lambda found: f"read {found}", before)})], 1, turn=5)
    assert turns == ["before", "task"] * 3
    assert (row.times["ours"].samples, row.answers) == ([2, 2, 2], {"ours": "read 7"})


def test_row_says_where_goals_are_missed_and_who_answers_otherwise():
    both = {"ours": Contestant(int), "peer": Contestant(int, our_bits=True)}
    subject = Subject("question", both, 1.5, {("ours", "peer"): 0.25, ("peer", "ours"): 3})
    row = Row(subject, {"ours": timing(4e-3, 2e-3, 3e-3), "peer": timing(5e-3, 9e-3)}, {"ours": "8", "peer": "7"})
    assert list(row.goals()) == [
        Goal("question", "≤ 1.5 ms", "2 ms", False), Goal("question: peer over ours", "≥ 4", "2.5", False),
        Goal("question: peer over ours", "≤ 3", "2.5", True), Goal("question: peer", "our bits", "others", False),
    ]  # fmt: skip
    assert list(row.lines()) == [
        ["question", "ours", "2 ms", "3 ms", "33 %", "3", "", "8"],
        ["", "peer", "5 ms", "7 ms", "29 %", "2", "2.5", "7"],
    ]
    assert [goal.met for goal in Row(subject, row.times, {"ours": "8", "peer": "8"}).goals()] == [
        False, False, True, True,
    ]  # fmt: skip


def test_goal_of_a_contestant_that_is_absent_is_not_asked():
    section = timed("t", [Subject("q", {"ours": Contestant(int)}, None, {("ours", "C"): 1.0})], rounds=1)
    assert section.goals == []
    assert [row[:2] for row in section.rows[1:]] == [["q", "ours"]]


def test_forgetting_empties_the_caches_of_the_exact_side():
    rooted.shapes(5)
    assert rooted.shapes.cache_info().currsize
    forget()
    assert rooted.shapes.cache_info().currsize == 0


# --- each benchmark -----------------------------------------------------------------------------------------------


SLOW = ("every fact of the whole catalogue", exact_facts.TWELVE, "every fact of dop853", "bound of one step of dop853")


@pytest.mark.parametrize("subject", [s for s in SUBJECTS if s.name not in SLOW], ids=lambda s: s.name)
def test_ours_answers_cold_as_it_does_warm(subject):
    cold, warm = (contestant.read(contestant.task()) for contestant in subject.contestants.values())
    assert cold == warm


def test_every_fact_is_asked():
    (subject,) = (subject for subject in SUBJECTS if subject.name == "every fact of rk4")
    assert subject.contestants["ours"].task() == len(FACTS)


# By default each question is answered, untimed. Here the benchmarks run, rounds, peers, interpreters and all.
@pytest.mark.long
@pytest.mark.parametrize("name", ["exact_facts", "import_time", "commands", "engine", "peers_time"])
def test_benchmark_measures_and_prints_its_goals(name, capsys):
    benchmarks.main([name, "--rounds", "1"])
    shown = capsys.readouterr().out
    assert "minimum" in shown
    assert "wanted" in shown


def test_name_of_no_benchmark_is_refused(capsys):
    with pytest.raises(SystemExit):
        benchmarks.main(["roundof"])
    assert "'roundof' is no benchmark; choose from exact_facts, " in capsys.readouterr().err


def test_benchmark_of_rounding_searches_and_counts_violations(monkeypatch):
    monkeypatch.setattr(roundoff, "PROGRAMS", {"rk4": rk4})
    searched = roundoff.worst_over_bound(0)
    assert searched.goals[0].found == "0"
    assert int(searched.rows[1][-2]) > 0
    assert [goal.what for goal in roundoff.teeth(3).goals] == [
        "RK4 as it is is caught",
        "a weight of RK4 wrong by 1e-13 is caught",
    ]


@pytest.mark.parametrize(("exponent", "met"), [(3, True), (2, False)])
def test_growth_is_the_slope_of_the_last_sizes(monkeypatch, exponent, met):
    monkeypatch.setattr(growth, "seconds", lambda task: task())
    law = growth.Law("cubes", lambda n: lambda: float(max(n, 5) ** 3), (1, 2, 8, 16, 32), exponent, "it is so")
    shown = growth.laws_section([law])
    assert (shown.goals[0].found, shown.goals[0].met) == ("3.00", met)
    assert shown.rows[-1][-3:] == [str(exponent), "3.00", "it is so"]


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("law", growth.LAWS, ids=lambda law: law.name)
def test_what_grows_is_done_at_its_smallest_size(law):
    assert law.task(law.sizes[0])()


def test_loops_by_hand_have_the_bits_of_ours():
    ours = runner(engine.RK4, engine.OSCILLATOR)(engine.START, engine.H, 0, 100)
    assert engine.by_hand(*engine.START, engine.H, 100) == engine.by_steps(*engine.START, engine.H, 100) == ours
    lorenz = runner(engine.RK4, engine.LORENZ)(engine.LORENZ_START, engine.H, 0, 100)
    assert engine.lorenz_by_hand(engine.LORENZ_START, engine.H, 100) == lorenz


@pytest.mark.skipif(not (shutil.which("gcc") or shutil.which("cc")), reason="no C compiler")
def test_unfused_c_has_our_bits_and_fused_c_has_others(monkeypatch):
    monkeypatch.setattr(engine, "MANY", 1000)
    ours = runner(engine.RK4, engine.OSCILLATOR)(engine.START, engine.H, 0, 1000)
    assert engine.c_trajectory(engine.compiled_c("-ffp-contract=off"))() == ours
    flags = Path("/proc/cpuinfo")
    if flags.exists() and " fma " in flags.read_text(encoding="utf-8"):
        assert engine.c_trajectory(engine.compiled_c("-mfma", "-ffp-contract=fast"))() != ours


def test_ours_reach_their_errors_with_as_few_steps_as_will_do():
    pytest.importorskip("numba")
    for t, error, ours, steps in ((10.0, 1e-6, peers_time.by_steps, 10), (1000.0, 1e-10, peers_time.by_powers, 2048)):
        contestant = ours(t, error)
        assert peers_time.error_at(t, contestant.task()) <= error
        assert contestant.read(contestant.task()).endswith(f", {steps} steps")


def test_a_peer_is_measured_with_the_fastest_tolerance_that_reaches_the_error(monkeypatch):
    """Here of a peer whose error is a tenth of its tolerance, and whose time grows as that falls."""
    solver = lambda *_: type("Solver", (), {"solve": lambda _, x, t: (cos(t) + x / 10, -sin(t))})()
    taken = iter([9.0, 3.0, 5.0] * 100)
    monkeypatch.setattr(peers_time, "_seconds", lambda task: next(taken))
    monkeypatch.setattr(peers_time, "TOLERANCES", (1e-3, 1e-4, 1e-5, 1e-6))
    peer = Peer("scipy", ("any",), "", solver)
    found = peers_time.at_its_best(peer, "any", 10.0, 1.5e-5)
    assert found.read(found.task()) == "1.0e-06, tol 1e-05"
    assert peers_time.at_its_best(peer, "any", 10.0, 1e-9) is None


@pytest.mark.parametrize(("least", "met"), [(0.125, True), (0.126, False)])
def test_imports_are_compared_by_their_minima(least, met):
    taken = {name: timing(0.2, 0.1, 0.9) for name in import_time.SUBJECTS} | {import_time.FLOATS: timing(0.9, least)}
    shown = import_time.section(taken, loads_sympy=False)
    assert [goal.met for goal in shown.goals] == [met, True]
    assert shown.goals[0].found == f"{10 * least:.2f}"
    assert [row[0] for row in shown.rows[1:]] == list(import_time.SUBJECTS)
    assert not import_time.section(taken, loads_sympy=True).goals[1].met


def test_subjects_of_the_import_benchmark_run_in_a_new_interpreter():
    code = "\n".join(import_time.SUBJECTS[name] for name in ("all of numeric", "import driftproof"))
    assert float(import_time.new_interpreter(import_time.TIMED.format(code="pass"))) > 0
    assert import_time.new_interpreter(f"{code}\nprint('done')") == "done"


# --- the report, and what peers answer ----------------------------------------------------------------------------


def test_report_names_the_goals_that_are_missed():
    sections = [
        Section("Times", [["", "minimum"], ["quick", "1 ms"]], [Goal("quick", "≤ 2 ms", "1 ms", True)]),
        Section("Table", [["a", "b"], ["|h|", "1"]], [Goal("bound", "0", "3", False)]),
    ]
    page = benchmarks.page(sections, {}, 1)
    assert "1 of 2 goals are met; missed: bound." in page
    assert "| bound | 0 | 3 | **missed** |" in page
    assert "| \\|h\\| | 1 |" in page
    assert "No peer was installed." in page


def test_committed_report_has_every_goal():
    page = (DOCS / "benchmarks.md").read_text(encoding="utf-8").partition("## How")[0]
    assert all(f"| {subject.name} | ≤" in page for subject in SUBJECTS if subject.goal)
    assert "| import driftproof loads SymPy | no | no | met |" in page


def test_kept_answers_of_peers_are_about_our_methods_and_facts():
    kept = json.loads((DOCS / "peers.json").read_text(encoding="utf-8"))
    assert answers.as_json(kept) == (DOCS / "peers.json").read_text(encoding="utf-8")
    assert set(kept) <= set(answers.QUESTIONS)
    for name, peer in kept.items():
        assert set(peer["facts"]) == set(answers.QUESTIONS[name]) <= set(FACTS)
        assert set(peer["own"]) == set(answers.OWN_METHODS.get(name, ()))
        assert all(set(seen["differs"]) | set(seen["silent"]) <= set(METHODS) for seen in peer["facts"].values())


def test_questions_are_put_to_the_methods_that_they_are_about():
    asked = answers.at_most(3, lambda method: method.key, explicit=True)
    keys = ("heun3", "rk4", "implicit_midpoint")
    assert [asked(METHODS[key]) for key in keys] == ["heun3", None, None]
    assert answers.of_pairs(lambda method: method.key)(METHODS["rk4"]) is None


def test_comparison_counts_what_a_peer_answers_and_where_it_differs(monkeypatch):
    monkeypatch.setattr(answers, "tableaux", lambda: [METHODS[key] for key in ("rk4", "heun2", "gauss2", "rk38")])
    said = {"rk4": 4, "heun2": 3, "gauss2": "Unknown"}
    found = answers.compared("order", lambda method: said[method.key])
    assert (found.agree, found.differs) == (1, {"heun2": "3"})
    assert found.silent == {"gauss2": "Unknown", "rk38": "KeyError"}


@pytest.mark.parametrize(
    ("theirs", "mine", "same"),
    [
        ("2.78529", "2.78529", True), ("5.9999995", "6", True), ("5.999", "6", False), ("inf", "inf", True),
        ("yes", "no", False),
    ],
)  # fmt: skip
def test_reals_are_compared_as_far_as_floats_go(theirs, mine, same):
    assert answers.same(theirs, mine) is same


def test_a_question_that_takes_too_long_has_no_answer(monkeypatch):
    monkeypatch.setattr(answers, "PATIENCE", 0.01)
    assert answers.answered(lambda: time.sleep(1)) == (None, "no answer within 0.01 s")
    assert answers.answered(lambda: 1) == (1, "")


def test_lines_of_neighbours_are_the_same_rates_for_everybody():
    """Those of the text and those on arrays, rounded a dozen times each."""
    start = lines.start(12)
    alone = field_rate(lines.brusselator(12))(0.0, start)
    assert list(lines.rate_on_arrays(12)(0.0, np.array(start))) == pytest.approx(alone, rel=1e-12, abs=1e-12)
    assert field_loops.field_writers(lines.brusselator(12), compiled=False).band == (2, 2)
