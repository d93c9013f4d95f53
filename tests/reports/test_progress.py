"""Progress is shown on a terminal, and only where a run takes a while."""

import os
import sys

from tqdm import tqdm

from driftproof.reports import progress


def test_progress_bar_is_for_long_runs_on_a_terminal_only(monkeypatch):
    assert progress.count_steps(progress.LONG_RUN * 10) == range(
        progress.LONG_RUN * 10
    )  # standard error is no terminal here
    monkeypatch.setattr(tqdm, "monitor_interval", 0)  # no thread that outlives the test
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert progress.count_steps(10) == range(10)
    bar = progress.count_steps(progress.LONG_RUN)
    assert not isinstance(bar, range)
    assert len(bar) == progress.LONG_RUN
    bar.close()


def test_silence_on_a_terminal_is_broken_by_a_line_that_goes_again(monkeypatch):
    """A pseudo-terminal is what is written to."""
    outer, inner = os.openpty()
    monkeypatch.setattr(progress, "SILENCE", 0.01)
    monkeypatch.setattr(progress, "BEAT", 0.01)
    with os.fdopen(inner, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress.working("driftproof verify"):
            said = os.read(outer, 1000).decode()
        rest = os.read(outer, 1000).decode()
    assert said.startswith("\rdriftproof verify: working, 0 s (Ctrl-C ends it)")
    assert rest.endswith(" \r")


def test_nothing_is_said_where_nobody_looks(capfd):
    with progress.working("driftproof verify"):
        pass
    assert capfd.readouterr() == ("", "")
