"""The progress line of long computations, with the seconds that have passed, on a terminal; in a pipe, a few lines."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from threading import Event, Lock, Thread
from time import monotonic, time
from typing import TextIO

# Seconds before the progress line first appears, and between two updates of it.
SILENCE, BEAT = 2.0, 1.0
# Seconds after which a pipe gets another line; then after twice as many, and so on.
AGAIN = 30.0
_BACK = "\b"
# Set by pytest for what a test starts, and where nobody waits: outputs are compared there, and times differ.
QUIET = {"PYTEST_CURRENT_TEST", "CI"}
# Held by the `working` block that shows the line; blocks within it show none of their own.
_SHOWING = Lock()
# The stages that are in progress, the outermost first.
_STAGES: list[Stage] = []


def on_terminal(stream: TextIO | None = None) -> bool:
    """True if the stream, by default standard error, is a terminal."""
    return bool((shown := stream or sys.stderr) and shown.isatty())


@contextmanager
def working(name: str, stream: TextIO | None = None, *, plain: bool = False) -> Iterator[None]:
    """Show `name` and the seconds that the block has taken on a terminal, after SILENCE and while no bar moves.

    Of nested blocks only the outermost shows a line, and without a `name` only the seconds, after the text that it has.
    If `plain`, a standard error of this process that is a pipe gets a line after SILENCE, and others after AGAIN, twice
    AGAIN, ... seconds; not in tests and on CI.
    """
    shown = on_terminal(stream)
    own = plain and not shown and sys.stderr is not None and sys.stderr is sys.__stderr__ and not QUIET & {*os.environ}
    said = own and stat.S_ISFIFO(os.fstat(sys.stderr.fileno()).st_mode)
    if not (shown or said) or not _SHOWING.acquire(blocking=False):
        yield
        return
    done, place = Event(), os.dup((stream or sys.stderr).fileno())  # a test runner may replace the file meanwhile
    thread = Thread(target=_show if shown else _say, args=(name, done, place), daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
        os.close(place)
        _SHOWING.release()


@dataclass
class Stage:
    """A stage of a long computation: its description, which part of it is done, and since when it has been running."""

    words: str
    part: float = 0.0
    since: float = field(default_factory=monotonic)

    def left(self) -> str:
        """The estimate of the time left, as in ", about 7 s to go", or "" before any part is done."""
        return f", about {(monotonic() - self.since) * (1 / self.part - 1):.0f} s to go" if self.part else ""


@contextmanager
def stage(words: str) -> Iterator[Stage]:
    """Name this stage in the progress line while the block runs; the block may update the `part` that is done."""
    found = Stage(words)
    _STAGES.append(found)
    try:
        yield found
    finally:
        _STAGES.remove(found)


def _say(name: str, done: Event, place: int) -> None:
    """Write a line after SILENCE, then after AGAIN, 2 AGAIN, 4 AGAIN, ... seconds with these, and what is left."""
    wait, passed = SILENCE, 0.0
    while not done.wait(wait):
        passed += wait
        what, left = (_STAGES[-1].words, _STAGES[-1].left()) if _STAGES else ("working (Ctrl-C ends it)", "")
        since = f", {passed:.0f} s{left}" if passed > SILENCE else ""
        with suppress(OSError):
            os.write(place, f"{name}: {what}{since}\n".encode())
        wait = AGAIN - passed if passed < AGAIN else passed


def _show(name: str, done: Event, place: int) -> None:
    """Write the line until `done` is set, past Python's buffer: a process forked meanwhile would never get its lock."""
    start, shown, pause = monotonic(), 0, SILENCE
    while not done.wait(pause):
        pause = BEAT
        bars = list(getattr(getattr(sys.modules.get("tqdm"), "tqdm", None), "_instances", ()))
        moving = any(time() - bar.last_print_t < SILENCE for bar in bars)
        done_of = f", {bars[-1].n} of {bars[-1].total} {bars[-1].unit}s" if bars else ""
        seconds = f"{monotonic() - start:.0f} s"
        what, left = (_STAGES[-1].words, _STAGES[-1].left()) if _STAGES else ("working", " (Ctrl-C ends it)")
        line = f"{name}: {what}, {seconds}{done_of}{left}" if name else f" {seconds}"
        with suppress(OSError):
            if not bars:  # the text before the line is kept, and the cursor returns to its end
                line = line.ljust(shown)
                os.write(place, f"{line}{_BACK * len(line)}".encode())
            elif not moving:  # the line is written over a bar that has stopped
                os.write(place, f"\r{line.ljust(os.get_terminal_size(place).columns - 1)}\r".encode())
        shown = 0 if moving else len(line)
    if shown:
        with suppress(OSError):
            os.write(place, f"{' ' * shown}{_BACK * shown}".encode())
