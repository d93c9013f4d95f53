"""A sign of life of whatever takes a while: a line of how long it has taken, on a terminal only."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from threading import Event, Lock, Thread
from time import monotonic, time
from typing import TextIO

# Seconds of silence after which who waits is told that something is done, and between two tellings.
SILENCE, BEAT = 2.0, 1.0
_BACK = "\b"
# Held while somebody is told: what is done within says nothing of its own.
_TELLING = Lock()
# What is done at the moment, the outermost first.
_STAGES: list[Stage] = []


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


@dataclass
class Stage:
    """What is done while a block lasts, in words, and which part of it by now."""

    words: str
    part: float = 0.0
    since: float = field(default_factory=monotonic)

    def left(self) -> str:
        """About how long it will take yet, in words, where that can be told."""
        left = (monotonic() - self.since) * (1 - self.part) / self.part if self.part else 0.0
        return f", about {left:.0f} s to go" if self.part else ""


@contextmanager
def stage(words: str) -> Iterator[Stage]:
    """While the block lasts, whoever is told of anything is told of this, and of the part that the block says."""
    found = Stage(words)
    _STAGES.append(found)
    try:
        yield found
    finally:
        _STAGES.remove(found)


def _tell(name: str, done: Event, place: int) -> None:
    """Written past Python's own buffer, whose lock a process that is forked at that moment would never get."""
    start, told, pause = monotonic(), 0, SILENCE
    while not done.wait(pause):
        pause = BEAT
        bars = list(getattr(getattr(sys.modules.get("tqdm"), "tqdm", None), "_instances", ()))
        moving = any(time() - bar.last_print_t < SILENCE for bar in bars)
        done_of = f", {bars[-1].n} of {bars[-1].total} {bars[-1].unit}s" if bars else ""
        seconds = f"{monotonic() - start:.0f} s"
        what, left = (_STAGES[-1].words, _STAGES[-1].left()) if _STAGES else ("working", " (Ctrl-C ends it)")
        line = f"{name}: {what}, {seconds}{done_of}{left}" if name else f" {seconds}"
        with suppress(OSError):
            if not bars:  # what stands before it stays, and the cursor behind that
                line = line.ljust(told)
                os.write(place, f"{line}{_BACK * len(line)}".encode())
            elif not moving:  # the line covers a bar that stands still
                os.write(place, f"\r{line.ljust(os.get_terminal_size(place).columns - 1)}\r".encode())
        told = 0 if moving else len(line)
    if told:
        with suppress(OSError):
            os.write(place, f"{' ' * told}{_BACK * told}".encode())
