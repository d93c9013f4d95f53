"""A sign of life of whatever takes a while: a line of how long it has taken, on a terminal only."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import Event, Lock, Thread
from time import monotonic, time
from typing import TextIO

# Seconds of silence after which who waits is told that something is done, and between two tellings.
SILENCE, BEAT = 2.0, 1.0
_BACK = "\b"
# Held while somebody is told: what is done within says nothing of its own.
_TELLING = Lock()


def on_terminal(stream: TextIO | None = None) -> bool:
    """Whether somebody sees the stream, by default standard error, as it is written."""
    stream = stream or sys.stderr
    return stream is not None and stream.isatty()


@contextmanager
def working(name: str, stream: TextIO | None = None) -> Iterator[None]:
    """While the block lasts, `name` and its seconds on a terminal, from SILENCE on and where no bar moves.

    Of blocks within each other the outermost tells. `stream` is standard error if it is None. Where `name` is empty the
    seconds are told alone, behind what stands in the line.
    """
    if not on_terminal(stream) or not _TELLING.acquire(blocking=False):
        yield
        return
    done, place = Event(), os.dup((stream or sys.stderr).fileno())  # which is another file while a test runs
    teller = Thread(target=_tell, args=(name, done, place), daemon=True)
    teller.start()
    try:
        yield
    finally:
        done.set()
        teller.join()
        os.close(place)
        _TELLING.release()


def _tell(name: str, done: Event, place: int) -> None:
    """Written past Python's own buffer, whose lock a process that is forked at that moment would never get."""
    start, told, pause = monotonic(), 0, SILENCE
    while not done.wait(pause):
        pause = BEAT
        bars = list(getattr(getattr(sys.modules.get("tqdm"), "tqdm", None), "_instances", ()))
        moving = any(time() - bar.last_print_t < SILENCE for bar in bars)
        done_of = f", {bars[-1].n} of {bars[-1].total} {bars[-1].unit}s" if bars else ""
        seconds = f"{monotonic() - start:.0f} s"
        line = f"{name}: working, {seconds}{done_of} (Ctrl-C ends it)" if name else f" {seconds}"
        with suppress(OSError):
            if not bars:  # what stands before it stays, and the cursor behind that
                os.write(place, f"{line}{_BACK * len(line)}".encode())
            elif not moving:  # the line covers a bar that stands still
                os.write(place, f"\r{line.ljust(os.get_terminal_size(place).columns - 1)}\r".encode())
        told = 0 if moving else len(line)
    if told:
        with suppress(OSError):
            os.write(place, f"{' ' * told}{_BACK * told}".encode())
