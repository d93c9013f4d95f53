"""A sign of life of whatever takes a while: a line of how long it has taken, on a terminal only."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import Event, Lock, Thread
from time import monotonic, time

# Seconds of silence after which who waits is told that something is done, and between two tellings.
SILENCE, BEAT = 2.0, 1.0
# Held while somebody is told: what is done within says nothing of its own.
_TELLING = Lock()


def on_terminal() -> bool:
    """Whether somebody sees standard error as it is written."""
    return sys.stderr is not None and sys.stderr.isatty()


@contextmanager
def working(name: str) -> Iterator[None]:
    """While the block lasts, a line of `name` and its seconds on a terminal, from SILENCE on and where no bar moves.

    Of blocks within each other the outermost tells.
    """
    if not on_terminal() or not _TELLING.acquire(blocking=False):
        yield
        return
    done, place = Event(), sys.stderr.fileno()
    teller = Thread(target=_tell, args=(name, done, place), daemon=True)
    teller.start()
    try:
        yield
    finally:
        done.set()
        teller.join()
        _TELLING.release()


def _tell(name: str, done: Event, place: int) -> None:
    """Written past Python's own buffer, whose lock a process that is forked at that moment would never get."""
    start, told, pause = monotonic(), 0, SILENCE
    while not done.wait(pause):
        pause = BEAT
        bars = list(getattr(getattr(sys.modules.get("tqdm"), "tqdm", None), "_instances", ()))
        moving = any(time() - bar.last_print_t < SILENCE for bar in bars)
        done_of = f", {bars[-1].n} of {bars[-1].total} {bars[-1].unit}s" if bars else ""
        line = "" if moving else f"{name}: working, {monotonic() - start:.0f} s{done_of} (Ctrl-C ends it)"
        with suppress(OSError):
            covered = os.get_terminal_size(place).columns - 1 if bars else told  # a bar that stands still
            os.write(place, f"\r{line.ljust(covered)}".encode() if line else b"")
        told = len(line)
    if told:
        with suppress(OSError):
            os.write(place, f"\r{' ' * told}\r".encode())
