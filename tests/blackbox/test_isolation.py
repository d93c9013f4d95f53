"""Rogue steppers are findings within their time: in a fork of this process, and by name in a fresh interpreter."""

from __future__ import annotations

import subprocess
import sys
import threading
from contextlib import nullcontext
from functools import partial
from itertools import product
from time import monotonic
from types import SimpleNamespace

import pytest

from driftproof import assert_verified, cli, identify, verify
from driftproof.blackbox.checks.arguments import negative_step, zero_step
from driftproof.blackbox.checks.suite import CHECKS
from driftproof.blackbox.checks.trials import steady_runner
from driftproof.blackbox.findings import NoAnswer, Outcome, StepRaised
from driftproof.blackbox.isolation import IsolatedRunner, Serving, _CallLog, _is_command_alone, _not_again
from driftproof.blackbox.stepper.opening import Target
from driftproof.support.messages import MessageError, encode
from driftproof.support.processes import ProcessEnded
from tests.blackbox import broken_steppers, handwritten_steppers
from tests.blackbox.checks.habits import all_checks

# A hang is waited for; everything else is over long before its limit.
SHORT, LONG = 1.0, 60.0
WAYS = ["fork", "by name"]


def runner(rogue, way="fork"):
    limit = SHORT if rogue.__name__.startswith("hangs") else LONG
    return IsolatedRunner(Target(rogue if way == "fork" else f"{rogue.__module__}:{rogue.__name__}"), limit)


def answer(subject, h=0.25):
    return subject.step(1.0, 0.75, h)


def outcome(rogue, way="fork"):
    return runner(rogue, way).run([answer])[0]


def faults(checks):
    return [check.words for check in checks if check.is_fault]


SILENT = {
    broken_steppers.crashes: "the process ended (signal 11, SIGSEGV) in step(q=1.0, v=0.75, h=0.25)",
    broken_steppers.returns_nan: "from 1.0, 0.75, 0.25 it returns nan, 0.75",
    broken_steppers.hoards: "raises MemoryError: (an isolated process is given 8 GiB)",
    broken_steppers.wrong_shape: "it returns (1.1875,), not a pair (q1, v1)",
}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("rogue", "way"), [*product(SILENT, WAYS[:1]), (broken_steppers.hoards, "by name")])
def test_a_rogue_without_an_answer_has_one_check(rogue, way):
    checks = all_checks(runner(rogue, way))
    assert [(check.key, check.holds) for check in checks] == [("answers", False)]
    assert SILENT[rogue] in checks[0].words


@pytest.mark.parametrize("way", WAYS)
def test_a_rogue_that_always_hangs_is_given_up_after_one_time_limit(way):
    checks = all_checks(runner(broken_steppers.hangs, way))
    hung = "no answer within 0.375 s in step(q=1.0, v=0.75, h=0.25)"
    assert [check.words for check in checks] == [f"nothing could be tested: {hung}"]


SAID = {
    broken_steppers.returns_integers: "returns integers: at h = 0, (1.0, 0.75) becomes (1.0, 0.0)",
    broken_steppers.remembers: "the answer depends on the previous call",
    broken_steppers.noisy: "the same call gives answers up to",
}


@pytest.mark.parametrize(("rogue", "way"), [*product(SAID, WAYS[:1]), (broken_steppers.remembers, "by name")])
def test_a_rogue_that_answers_is_described(rogue, way):
    assert any(SAID[rogue] in words for words in faults(all_checks(runner(rogue, way))))


def hanging(monkeypatch, rogue, limit=30.0):
    """The runner of a stepper whose calls are given up soon."""
    monkeypatch.setattr("driftproof.blackbox.isolation.LEAST_LIMIT", 0.4)
    return IsolatedRunner(Target(rogue), limit)


def test_a_hang_is_no_fault_and_its_question_is_answered_without_the_call(monkeypatch):
    rogue = hanging(monkeypatch, broken_steppers.hangs_at_zero)
    checks = {check.key: check for check in all_checks(rogue)}
    assert faults(checks.values()) == []
    assert checks["zero_step"].holds is None
    assert "zero step: undecided: step(q=1.0, v=0.75, h=0.0) did not return in time" in checks["zero_step"].words
    assert all(checks[key].holds for key in ("no_memory", "negative_step", "position_range", "linear"))
    assert rogue.hung == ["h=0.0"]


def hangs_in_short_steps(q, v, h):
    t = 1.0
    while t < 1.0 + 2.0**-30 and h > 0:
        t += h
    return q + h * v, v - h * q


def tiny(subject, q=1.0):
    for h in (5e-324, 2.0**-20, 5e-324):
        subject.step(q, 0.75, h)


def rests(subject):
    return steady_runner(subject).size


def test_a_call_that_hung_is_not_made_again_whatever_the_state(monkeypatch):
    rogue = hanging(monkeypatch, hangs_in_short_steps)
    start = monotonic()
    found = rogue.run([tiny, partial(tiny, q=0.5), rests, answer])
    assert [outcome.kind for outcome in found] == ["time_limit", "time_limit", None, None]
    assert found[0].seen == "step(q=1.0, v=0.75, h=5e-324) did not return in time"
    assert found[2].result == 1.0
    assert rogue.hung == ["h=5e-324"]
    assert rogue.spent <= monotonic() - start


def test_a_crash_costs_its_own_question_only():
    found = runner(broken_steppers.crashes_backwards).run([answer, partial(answer, h=-0.25), answer, zero_step])
    assert [outcome.kind for outcome in found] == [None, "crashes", None, None]
    assert found[1].seen == "the process ended (exit status 3) in step(q=1.0, v=0.75, h=-0.25)"
    assert found[0].result == found[2].result == (1.1875, 0.5)


def test_a_stepper_that_exits_is_a_finding_and_ends_nothing():
    found = outcome(broken_steppers.exits)
    assert (found.kind, found.seen) == ("raises", "step(q=1.0, v=0.75, h=0.25) raises SystemExit: no licence")


def test_processes_of_a_hanging_stepper_are_ended_with_it():
    assert outcome(broken_steppers.hangs_with_a_child).kind == "time_limit"
    assert threading.active_count() == 1


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("way", WAYS)
def test_what_a_stepper_prints_and_warns_of_is_neither_shown_nor_read(way, capfd):
    assert outcome(broken_steppers.prints, way).result == (1.1875, 0.5)
    assert capfd.readouterr() == ("", "")


def test_a_stepper_that_cannot_be_imported_is_refused_by_every_question():
    found = IsolatedRunner(Target("tests.blackbox.broken_steppers:nobody")).run([answer, answer])
    assert [outcome.kind for outcome in found] == ["bad_input", "bad_input"]
    assert found[0].seen.startswith("tests.blackbox.broken_steppers:nobody cannot be imported: AttributeError")


def test_a_fault_of_ours_while_a_stepper_is_opened_is_no_bad_input(monkeypatch):
    monkeypatch.setattr("driftproof.blackbox.stepper.trial_steps._after_trial", lambda *_: int("a mistake"))
    (found,) = IsolatedRunner(Target(lambda q, v, h: (q, v)), isolate=False).run([answer])
    assert found.kind == "instrument_failed"
    assert "ValueError in test_isolation.py" in found.seen


def test_without_isolation_the_stepper_runs_here():
    here = []
    step = lambda q, v, h: here.append(h) or (q + h * v, v - h * q)
    assert IsolatedRunner(Target(step), isolate=False).run([answer])[0].result == (1.1875, 0.5)
    assert here == [0.25, 0.25]
    assert IsolatedRunner(Target(step)).run([answer])[0].result == (1.1875, 0.5)
    assert len(here) == 2


def raises_misbehaviour(subject):
    raise StepRaised("as it were")


def test_outcomes_come_in_the_order_of_the_questions():
    asked = [raises_misbehaviour, answer, lambda subject: 1 // 0, lambda subject: max([]), negative_step]
    found = runner(broken_steppers.noisy).run(asked)
    assert [outcome.kind for outcome in found] == ["raises", None, *["instrument_failed"] * 2, "unsteady"]
    assert found[0].seen == "as it were"
    for mistake, name in zip(found[2:4], ("ZeroDivisionError", "ValueError"), strict=True):
        assert mistake.seen.startswith(f"{name} in test_isolation.py, line ")


@pytest.mark.slow
def test_every_experiment_is_picklable_by_name():
    found = runner(broken_steppers.crashes_backwards, "by name").run(list(CHECKS.values()))
    kinds = dict(zip(CHECKS, (outcome.kind for outcome in found), strict=True))
    assert [key for key, kind in kinds.items() if kind] == ["negative_step", "reversal"]
    assert {kinds["negative_step"], kinds["reversal"]} == {"crashes"}


@pytest.mark.slow
@pytest.mark.parametrize(("first", "forked"), [("", True), ("import pytest; ", False)], ids=["alone", "with others"])
def test_our_command_alone_forks_and_with_modules_of_others_a_new_interpreter_is_started(first, forked, tmp_path):
    (tmp_path / "who.py").write_text("import sys\nraise ImportError('driftproof.cli' in sys.modules)\n")
    command = f"{first}from driftproof.cli import main; main(['identify', 'who:step'])"
    run = subprocess.run(
        [sys.executable, "-c", command], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60
    )
    assert f"who:step cannot be imported: ImportError: {forked}" in run.stderr


@pytest.mark.parametrize(("main", "loaded", "alone"), [
    (cli.main, ["os", "numpy.linalg", "_sitecustomize", "driftproof.cli"], True),
    (cli.main, ["os", "numpy.linalg", "mine.steps"], False),
    (encode, ["os"], False),
    (None, ["os"], False),
])  # fmt: skip
def test_our_command_is_alone_where_nobody_else_s_modules_are_loaded(main, loaded, alone, monkeypatch):
    modules = {"__main__": SimpleNamespace(main=main), **dict.fromkeys(loaded)}
    seen = SimpleNamespace(modules=modules, stdlib_module_names=sys.stdlib_module_names)
    monkeypatch.setattr("driftproof.blackbox.isolation.sys", seen)
    assert _is_command_alone() is alone


HUNG = {
    "q=1.0, v=0.75, h=0.25": "q=1.0, v=0.75, h=0.25", "q=1.0, v=0.75, h=5e-324": "h=5e-324",
    "q=1.0, v=0.75, h=-1e300": "h=-1e300", "q=1.0, h=nan": "h=nan", "y=[1.0], h=256.0": "y=[1.0], h=256.0",
    "y=[1.0], h=256.5": "h=256.5", f"q=1.0, h={2.0**-40!r}": f"q=1.0, h={2.0**-40!r}",
    f"q=1.0, h={2.0**-40 * 0.999!r}": f"h={2.0**-40 * 0.999!r}",
    "q=1.0, h=[1 +/- 0.1]": "q=1.0, h=[1 +/- 0.1]",
}  # fmt: skip


@pytest.mark.parametrize("call", HUNG)
def test_a_call_that_hung_is_not_made_again_and_at_the_ends_of_floats_its_h_is_not(call):
    assert _not_again(call) == HUNG[call]


def steps_of(subject):
    found = []
    for q, h in ((1.0, 0.25), (2.0, 0.25), (1.0, 5e-324), (1.0, 0.5)):
        try:
            found.append(subject.step(q, 0.75, h)[0])
        except NoAnswer as refusal:
            found.append(str(refusal))
    return found


def test_what_hung_is_refused_on_the_far_side_and_nothing_else():
    serving = Serving(Target(broken_steppers.hangs_at_zero), [steps_of], hung=["q=2.0, v=0.75, h=0.25", "h=5e-324"])
    refused = "step({}) did not return in time"
    expected = [refused.format("q=2.0, v=0.75, h=0.25"), refused.format("q=1.0, v=0.75, h=5e-324")]
    assert serving.outcome(0).result == [1.1875, *expected, 1.375]


def test_here_too_one_stepper_is_opened_for_all_questions_of_a_with_statement():
    calls = []
    step = lambda q, v, h: calls.append(h) or (q + h * v, v - h * q)
    with IsolatedRunner(Target(step), isolate=False) as kept:
        assert [kept.run([answer])[0].kind for _ in range(3)] == [None] * 3
    assert len(calls) == 4
    apart = IsolatedRunner(Target(step), isolate=False)
    assert [apart.run([answer])[0].kind for _ in range(3)] == [None] * 3
    assert len(calls) == 10


def test_the_file_of_calls_says_which_is_made_and_whether_it_is_back(tmp_path):
    log = _CallLog(tmp_path / "last_call")
    assert (log.now(), log.call) == ("", "")
    seen = []
    step = lambda q, v, h: seen.append(log.now()) or (q + h * v, v - h * q)
    serving = Serving(Target(step), [lambda subject: seen.append(log.now())], log.path)
    serving.outcome(0)
    assert seen == ["calling 1: q=1.0, v=0.75, h=0.25", "back 1: q=1.0, v=0.75, h=0.25"]
    assert log.call == "q=1.0, v=0.75, h=0.25"


LOOK = 0.5  # seconds, so that sums of it are exact
CALL, BACK = "calling 7: q=1.0, v=0.75, h=0.25", "back 7: q=1.0, v=0.75, h=0.25"
GOOD = Outcome(result=7)


class FarSide:
    """Stands for processes: at each look the clock goes on, and what comes is the next of the script."""

    def __init__(self, script):
        self.now, self.script, self.started = 0.0, iter(script), 0

    def __call__(self, serving, limits):
        self.log, self.started = serving.log, self.started + 1
        return nullcontext(self)

    def ask(self, request, seconds):
        return "" if request is None else self.wait(seconds)

    def wait(self, seconds):
        self.now += seconds
        seen = next(self.script)
        if isinstance(seen, str):
            self.log.write_text(f"{seen}\n", encoding="utf-8")
            raise ProcessEnded("time", "")
        if isinstance(seen, Outcome):
            return encode(seen)
        raise seen


def told(monkeypatch, *script):
    """The runner, and its outcomes; the far side does each of the script so often."""
    far = FarSide(each for count, each in script for _ in range(count))
    for name, fake in (("Session", far), ("monotonic", lambda: far.now), ("_LOOK", LOOK)):
        monkeypatch.setattr(f"driftproof.blackbox.isolation.{name}", fake)
    rogue = IsolatedRunner(Target(broken_steppers.noisy))
    outcomes = rogue.run([answer] * 2)
    assert next(far.script, None) is None
    assert not far.log.parent.exists()
    return rogue, far, outcomes


IN_CALL = " in step(q=1.0, v=0.75, h=0.25)"
TOO_LONG = [f"the 120 s for the whole run were not enough: stopped after 59.8 s{IN_CALL}", 7]
# What the far side does at its looks, with the time and the number of processes that it takes, and what is told of it.
FAR = {
    "answers": ([(3, GOOD)], 1.5, 1, [7, 7]),
    "the first call hangs": ([(91, CALL)], 45.5, 1, [f"no answer within 45 s{IN_CALL}"] * 2),
    "the first call is over in time": ([(90, CALL), (3, GOOD)], 46.5, 1, [7, 7]),
    "a call is over in time": ([(1, GOOD), (10, CALL), (2, GOOD)], 6.5, 1, [7, 7]),
    "a call hangs": ([(1, GOOD), (11, CALL), (2, GOOD)], 7.0, 2, [7, 7]),
    "a call after a long one is over in time": ([(4, BACK), (2, GOOD), (20, CALL), (1, GOOD)], 13.5, 1, [7, 7]),
    "a call after a long one hangs": ([(4, BACK), (2, GOOD), (21, CALL), (1, GOOD)], 14.0, 2, [7, 7]),
    "a call after a longer one is over in time": ([(12, BACK), (2, GOOD), (40, CALL), (1, GOOD)], 27.5, 1, [7, 7]),
    "a call after a longer one hangs": ([(12, BACK), (2, GOOD), (41, CALL), (1, GOOD)], 28.0, 2, [7, 7]),
    "calls hang": ([(1, GOOD), (44, CALL), (1, GOOD)], 23.0, 5, [f"no answer within 5 s{IN_CALL}", 7]),
    "few hang": ([(1, GOOD), (33, CALL), (1, GOOD), (33, CALL), (1, GOOD)], 34.5, 7, [7, 7]),
    "calls come back": ([(1, GOOD), *[(10, CALL), (10, "calling 8: ")] * 5, (20, BACK), (1, GOOD)], 61.0, 2, TOO_LONG),
    "we are slow": ([(1, GOOD), (100, BACK), (2, GOOD)], 51.5, 1, [7, 7]),
    "cannot be imported": ([(1, ProcessEnded("exit", "why"))], 0.5, 1, ["why while the stepper was imported"] * 2),
}


@pytest.mark.parametrize("name", FAR)
def test_limits_of_calls_questions_and_runs_are_kept_and_told(name, monkeypatch):
    script, seconds, processes, expected = FAR[name]
    rogue, far, outcomes = told(monkeypatch, *script)
    seen = [outcome.seen if outcome.failed else outcome.result for outcome in outcomes]
    assert (seen, rogue.spent, far.started) == (expected, seconds, processes)


def test_of_too_little_time_nothing_is_said_and_none_is_refused():
    step = handwritten_steppers.velocity_verlet
    for answer in (verify(step, "velocity_verlet", time_limit=1e-9), identify(step, time_limit=1e-9)):
        assert (answer.passed, answer.verdict[:9]) == (None, "undecided")
    for time_limit, ask in product((0, -1.0, float("nan")), (verify, assert_verified)):
        with pytest.raises(ValueError, match=f"a time limit of {time_limit:g} s leaves no time; write a number above"):
            ask(step, "velocity_verlet", time_limit=time_limit)


ENDS = {"exit": "crashes", "signal": "crashes", "memory": "crashes", "answer": "crashes", "no message": "crashes"}
ENDS |= {"killed": "killed", "raised": "instrument_failed"}


@pytest.mark.parametrize("cause", ENDS)
def test_an_end_is_the_stepper_s_own_or_tells_nothing_of_it(cause, monkeypatch):
    end = MessageError("why") if cause == "no message" else ProcessEnded(cause, "why")
    _, _, outcomes = told(monkeypatch, (1, GOOD), (1, CALL), (1, end), (1, GOOD))
    assert [outcome.kind for outcome in outcomes] == [ENDS[cause], None]
    assert outcomes[0].seen.startswith("why")
    assert outcomes[0].seen.endswith(IN_CALL)
