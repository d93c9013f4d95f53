"""Progress of whatever takes a while: bars, or a line of how long it has taken; on a terminal only."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from threading import Event, Thread
from time import monotonic
from typing import Any, TypeVar

_T = TypeVar("_T")
# A float run longer than this shows a progress bar.
LONG_RUN = 10**6
# Seconds of silence after which who waits is told that something is done, and between two tellings.
SILENCE, BEAT = 2.0, 1.0


class _Unseen:
    """A progress bar that nobody would see."""

    total = 0

    def update(self, done: int) -> None:
        """Nothing."""


def progress_bar(total: int, unit: str) -> AbstractContextManager[Any]:
    """A bar on a terminal; elsewhere what has its methods, and tqdm is not imported."""
    if not on_terminal():
        return nullcontext(_Unseen())
    from tqdm import tqdm

    bar: AbstractContextManager[Any] = tqdm(total=total, unit=unit, leave=False)
    return bar


def with_progress(items: Sequence[_T], unit: str) -> Iterable[_T]:
    """The items, with a progress bar on a terminal."""
    if not on_terminal():
        return items
    from tqdm import tqdm

    bar: Iterable[_T] = tqdm(items, unit=unit, unit_scale=True, leave=False)
    return bar


def count_steps(steps: int) -> Iterable[int]:
    """range(steps), with a progress bar when it will take a while."""
    return range(steps) if steps < LONG_RUN else with_progress(range(steps), "step")


def on_terminal() -> bool:
    """Whether somebody sees standard error as it is written."""
    return sys.stderr is not None and sys.stderr.isatty()


@contextmanager
def working(name: str) -> Iterator[None]:
    """While the block lasts, a line of `name` and its seconds on a terminal, from SILENCE on and where no bar is."""
    if not on_terminal():
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


def _tell(name: str, done: Event, place: int) -> None:
    """Written past Python's own buffer, whose lock a process that is forked at that moment would never get."""
    start, told, pause = monotonic(), 0, SILENCE
    while not done.wait(pause):
        pause = BEAT
        bars = getattr(getattr(sys.modules.get("tqdm"), "tqdm", None), "_instances", ())
        line = "" if bars else f"{name}: working, {monotonic() - start:.0f} s (Ctrl-C ends it)"
        with suppress(OSError):
            os.write(place, f"\r{line.ljust(told)}".encode() if line else b"")
        told = len(line)
    if told:
        with suppress(OSError):
            os.write(place, f"\r{' ' * told}\r".encode())
