"""Whoever waits at a terminal is told that something is done, and nobody else."""

import os
import re
import sys
from pathlib import Path
from threading import Event, Thread
from time import monotonic, sleep

import pytest
from tqdm import tqdm

from driftproof.support import progress

LINE = "driftproof verify: working, 0 s (Ctrl-C ends it)"


@pytest.mark.parametrize(
    ("name", "part", "line"),
    [
        ("driftproof verify", None, LINE),
        ("driftproof sweep", 0.0, "driftproof sweep: enclosing, 0 s"),
        ("driftproof sweep", 0.25, "driftproof sweep: enclosing, 0 s, about 3000 s to go"),
        ("", 0.5, " 0 s"),
    ],
)
def test_silence_on_a_terminal_is_broken_by_a_line_that_goes_again(name, part, line, monkeypatch):
    """A pseudo-terminal is what is written to; what works within another says nothing of its own."""
    if part is not None:  # a quarter of it took 1000 s
        monkeypatch.setattr(progress, "_STAGES", [progress.Stage("enclosing", part, monotonic() - 1000)])
    outer, inner = os.openpty()
    monkeypatch.setattr(progress, "SILENCE", 0.01)
    monkeypatch.setattr(progress, "BEAT", 0.01)
    with os.fdopen(inner, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress.working(name), progress.working("certify"):
            said = os.read(outer, 1000).decode()
        rest = os.read(outer, 1000).decode()
    back = "\b" * len(line)
    assert said.startswith(f"{line}{back}")
    assert rest.endswith(f"{' ' * len(line)}{back}")


def test_the_tutorial_quotes_the_line():
    page = Path(__file__).parents[2] / "docs" / "tutorials" / "engineer.md"
    (quoted,) = re.findall(r"`(.*: working, .*?)`", page.read_text(encoding="utf-8"))
    assert quoted.replace("3 s", "0 s") == LINE


def test_in_a_pipe_a_command_says_one_line_and_a_function_and_a_file_get_none(tmp_path, monkeypatch):
    """A pipe's reader sees what is done; a file, a function in a script, or what a test captures, stays silent."""
    monkeypatch.setattr(progress, "SILENCE", 0.01)
    monkeypatch.setattr(progress, "_STAGES", [progress.Stage("errors of rk4")])
    said = []
    for plain, own, quiet in ((True, True, set()), (False, True, set()), (True, False, set()), (True, True, {"CI"})):
        monkeypatch.setattr(progress, "QUIET", quiet)
        monkeypatch.setenv("CI", "1")
        read, write = os.pipe()
        with os.fdopen(write, "w") as pipe, (tmp_path / "errors").open("w") as file:
            for stream in (pipe, file):
                with monkeypatch.context() as patched:
                    patched.setattr(sys, "stderr", stream)
                    patched.setattr(sys, "__stderr__", stream if own else None)
                    with progress.working("driftproof report", plain=plain), progress.working("a problem"):
                        sleep(0.1)
        with os.fdopen(read) as reader:
            said.append(reader.read() + (tmp_path / "errors").read_text())
    assert said == ["driftproof report: errors of rk4\n", "", "", ""]


def test_in_a_pipe_long_work_says_again_how_long_it_has_been_and_what_is_left(monkeypatch):
    """After 0.02 s, 0.1 s, 0.2 s and 0.4 s, the stage having done a half in a minute."""
    monkeypatch.setattr(progress, "SILENCE", 0.02)
    monkeypatch.setattr(progress, "AGAIN", 0.1)
    monkeypatch.setattr(progress, "_STAGES", [progress.Stage("enclosing", 0.5, progress.monotonic() - 60)])
    read, write = os.pipe()
    done = Event()
    thread = Thread(target=progress._say, args=("driftproof stability", done, write))
    thread.start()
    with os.fdopen(read) as reader:
        told = [reader.readline() for _ in range(4)]
        done.set()
        thread.join()
        os.close(write)
        assert told[0] == "driftproof stability: enclosing\n"
        assert told[1:] == ["driftproof stability: enclosing, 0 s, about 60 s to go\n"] * 3
        assert reader.read().count("\n") <= 1


def test_a_bar_that_stands_still_is_silence(monkeypatch):
    outer, inner = os.openpty()
    monkeypatch.setattr(tqdm, "monitor_interval", 0)  # no thread that outlives the test
    monkeypatch.setattr(progress, "SILENCE", 0.01)
    with os.fdopen(inner, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with tqdm(total=4, unit="point", leave=False) as bar, progress.working("driftproof sweep"):
            bar.update(3)
            said = ""
            while not re.search(r"driftproof sweep: working, \d+ s, 3 of 4 points \(Ctrl-C", said):
                said += os.read(outer, 1000).decode()


def test_nothing_is_said_where_nobody_looks(capfd):
    with progress.working("driftproof verify"):
        pass
    assert capfd.readouterr() == ("", "")
