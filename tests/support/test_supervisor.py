"""Nothing that has come of a worker outlives its session: no child, no daemon, no program in a session of its own."""

import os
import sys
import time
from pathlib import Path

import pytest

from driftproof.support import supervisor
from driftproof.support.processes import Limits, ProcessEnded, ask_once
from tests.support import misbehaving

LONG = Limits(seconds=60)
linux = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a process in a session of its own is not found")


def noted(folder):
    """The processes that noted themselves in the folder."""
    found = [int(name) for name in os.listdir(folder)]
    assert found
    return found


def alive(process):
    """Whether it still runs; one that is only not yet reaped does not."""
    try:
        os.kill(process, 0)
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False


def all_ended_in_time(folder):
    """Who is not a child of the supervisor's dies in its own time."""
    for _ in range(1000):
        if not any(map(alive, noted(folder))):
            return
        time.sleep(0.01)
    raise AssertionError("some process was left")


@linux
def test_a_daemon_in_a_session_of_its_own_is_ended(tmp_path):
    assert ask_once(misbehaving.leaves_a_daemon, str(tmp_path), LONG) == "answered"
    assert not any(map(alive, noted(tmp_path)))


@linux
def test_a_program_that_keeps_our_pipe_open_keeps_nobody_waiting(tmp_path):
    with pytest.raises(ProcessEnded, match="exit status 0"):  # not "no answer within": the pipe's end is not awaited
        ask_once(misbehaving.leaves_a_program, str(tmp_path), LONG)
    assert not any(map(alive, noted(tmp_path)))


@pytest.mark.slow
def test_a_fork_bomb_is_ended_with_all_that_came_of_it(tmp_path):
    with pytest.raises(ProcessEnded, match=r"no answer within 1 s"):
        ask_once(misbehaving.forks_without_end, str(tmp_path), Limits(seconds=1))
    assert len(noted(tmp_path)) > 1  # how many more is a matter of the machine
    assert not any(map(alive, noted(tmp_path)))


@pytest.mark.slow
def test_without_a_subreaper_or_process_descriptors_the_group_is_ended(tmp_path, monkeypatch):
    monkeypatch.setattr(supervisor, "_prctl", lambda option, argument: None)
    monkeypatch.delattr(os, "pidfd_open", raising=False)
    with pytest.raises(ProcessEnded, match="exit status 3"):
        ask_once(misbehaving.exits, None, LONG)
    with pytest.raises(ProcessEnded, match="no answer within 1 s"):
        ask_once(misbehaving.forks_without_end, str(tmp_path), Limits(seconds=1))
    all_ended_in_time(tmp_path)


@linux
def test_the_end_of_the_supervisor_is_the_end_of_the_worker(tmp_path):
    with pytest.raises(ProcessEnded, match="its supervisor is gone"):
        ask_once(misbehaving.kills_its_supervisor, str(tmp_path), LONG)
    all_ended_in_time(tmp_path)


def test_the_end_of_the_parent_is_the_end_of_the_worker(tmp_path):
    def parent(folder):
        if os.fork() == 0:
            os.setsid()
            ask_once(_notes_and_sleeps, folder, LONG)
        while not os.listdir(folder):
            time.sleep(0.001)
        return "answered"

    assert ask_once(parent, str(tmp_path), LONG) == "answered"
    assert not any(map(alive, noted(tmp_path)))


def _notes_and_sleeps(folder):
    open(os.path.join(folder, str(os.getpid())), "w").close()
    time.sleep(600)
