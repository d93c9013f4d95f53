"""Progress bars are for a terminal, and only where a run takes a while."""

import sys

from tqdm import tqdm

from driftproof.reports import progress


def test_progress_bar_is_for_long_runs_on_a_terminal_only(monkeypatch):
    steps = progress.LONG_RUN * 10
    assert progress.count_steps(steps) == range(steps)  # standard error is no terminal here
    monkeypatch.setattr(tqdm, "monitor_interval", 0)  # no thread that outlives the test
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert progress.count_steps(10) == range(10)
    bar = progress.count_steps(progress.LONG_RUN)
    assert not isinstance(bar, range)
    assert len(bar) == progress.LONG_RUN
    bar.close()
    with progress.progress_bar(3, "point") as bar:
        assert (bar.total, bar.unit) == (3, "point")
