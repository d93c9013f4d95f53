"""A process may hang, crash, hoard, flood or fork: its cause of death is told, within its time, and nothing stays."""

import os
import sys
import threading
from pathlib import Path

import pytest

from driftproof.support import processes
from driftproof.support.processes import Limits, ProcessEnded, Session, ask_once
from tests.support import misbehaving

# A hang is waited for; everything else is over long before its limit.
SHORT, LONG = Limits(seconds=0.3), Limits(seconds=60)
HANGING = {"hangs", "sleeps", "closes_everything_and_hangs"}
WAYS = ["fork", "by name"]


def handler(name, way):
    return getattr(misbehaving, name) if way == "fork" else f"tests.support.misbehaving:{name}"


def cause_of(name, way, limits=None, request=None):
    with pytest.raises(ProcessEnded) as caught:
        ask_once(handler(name, way), request, limits or (SHORT if name in HANGING else LONG))
    return caught.value.cause, str(caught.value)


@pytest.mark.parametrize("way", WAYS)
def test_a_session_answers_one_request_after_another(way):
    before = os.listdir("/proc/self/fd")
    with Session(handler("echoes", way), LONG) as session:
        for request in (1, [None, "text", {"a": 0.1}], "x" * 2**21, 10**30):
            assert session.ask(request) == request
    assert session.end() == "the process ended (signal 9, SIGKILL)"
    assert len(os.listdir("/proc/self/fd")) == len(before), "a file is left open"


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    ("name", "cause", "words"),
    [
        ("hangs", "time", "no answer within 0.3 s"),
        ("closes_everything_and_hangs", "time", "no answer within 0.3 s"),
        ("raises", "raised", "KeyError: 'so it is'"),
        ("answers_no_json", "raised", "TypeError: Object of type set is not JSON serializable"),
        ("exits", "exit", "the process ended (exit status 3)"),
        ("leaves", "exit", "the process ended (exit status 1)"),
        ("is_killed", "killed", "the process ended (signal 9, SIGKILL)"),
        ("aborts", "signal", "the process ended (signal 6, SIGABRT)"),
        ("kills_its_supervisor", "killed", "the process ended (its supervisor is gone)"),
    ],
)
def test_the_cause_of_a_death_is_told(name, cause, words, way):
    assert cause_of(name, way) == (cause, words)


@pytest.mark.parametrize("way", WAYS)
def test_memory_is_bounded(way):
    limits = Limits(seconds=60, memory=64 * misbehaving.MEGABYTE)
    assert cause_of("is_killed", way, limits) == ("killed", "the process ended (signal 9, SIGKILL)")
    assert cause_of("hoards", way, limits) == ("memory", "more than 6.71e+07 bytes of memory")


@pytest.mark.parametrize(("code", "peak", "cause"), [(1, 950, "memory"), (1, 850, "exit"), (0, 950, "exit")])
def test_what_failed_after_nine_tenths_of_its_memory_reached_the_limit(code, peak, cause):
    with Session(misbehaving.echoes, Limits(seconds=60, memory=1000 * misbehaving.MEGABYTE)) as session:
        session._status = {"code": code, "peak": peak * misbehaving.MEGABYTE}
        assert session._cause().cause == cause


@pytest.mark.parametrize("name", ["floods", "floods_its_pipe"])
def test_an_answer_is_bounded_in_size(name):
    assert Limits() == Limits(seconds=60, memory=None, answer=64 * misbehaving.MEGABYTE)
    limits = Limits(seconds=60, answer=4 * misbehaving.MEGABYTE)
    assert cause_of(name, "by name", limits) == ("answer", "an answer of more than 4194304 bytes")


def test_a_file_is_bounded_in_size(tmp_path):
    cause, words = cause_of("writes_a_large_file", "fork", Limits(seconds=60, file=misbehaving.MEGABYTE), str(tmp_path))
    assert (cause, words) == ("raised", "OSError: [Errno 27] File too large")
    assert (tmp_path / "large").stat().st_size <= misbehaving.MEGABYTE


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", ["prints_a_flood", "closes_its_output"])
def test_what_is_printed_goes_nowhere(name, way, capfd):
    assert ask_once(handler(name, way), None, LONG) == "done"
    assert capfd.readouterr() == ("", "")


def test_words_in_our_pipe_are_no_answer():
    found = cause_of("writes_words_into_its_pipe", "by name")
    assert found == ("answer", "an invalid answer: the code wrote into the pipe to its caller")


def test_a_handler_that_cannot_be_imported_and_a_system_without_forks_are_told(monkeypatch):
    with pytest.raises(ProcessEnded, match=r"ModuleNotFoundError: No module named 'tests\.support\.nothing'"):
        ask_once("tests.support.nothing:echoes", None, LONG)
    monkeypatch.delattr(os, "fork")
    with pytest.raises(OSError, match="fork"):
        Session(misbehaving.echoes, LONG)


def test_after_its_time_a_session_can_still_be_looked_at_and_then_ends():
    threads = threading.active_count()  # others may have left some
    with Session(misbehaving.sleeps, SHORT) as session:
        with pytest.raises(ProcessEnded):
            session.ask(None)
        os.kill(session._pid, 0)
    assert session.end() == "the process ended (signal 9, SIGKILL)"
    assert threading.active_count() == threads


def test_modules_of_the_user_named_like_ours_shadow_nothing_and_are_found(tmp_path):
    for name in ("driftproof", "support", "methods", "texts", "commands", "misbehaving"):
        (tmp_path / f"{name}.py").write_text("def answers(request): return __file__\n")
    (tmp_path / "where.py").write_text(
        "def answers(request):\n    import methods\n    from driftproof.support import files\n"
        "    return [files.__file__, methods.__file__]\n"
    )
    ours = Path(processes.__file__).parent / "files.py"
    found = ask_once("where:answers", None, LONG, path=[str(tmp_path), *sys.path])
    assert found == [str(ours), str(tmp_path / "methods.py")]


def test_environment_and_folder_are_those_that_are_given(tmp_path):
    conditions = {"environment": {"LEFT": "1"}, "folder": tmp_path, "path": [os.getcwd(), *sys.path]}
    _, _, folder, left, _ = ask_once("tests.support.misbehaving:where_it_is", None, LONG, **conditions)
    assert (folder, left) == (str(tmp_path), "1")


def test_a_fresh_process_loads_nothing_but_what_it_is_asked_for():
    loaded = ask_once("tests.support.misbehaving:where_it_is", None, LONG)[-1]
    assert not {"numpy", "sympy", "flint", "pytest"} & set(loaded)
