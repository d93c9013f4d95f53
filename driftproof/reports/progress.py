"""Progress bars, on a terminal only."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from types import SimpleNamespace
from typing import Any, TypeVar

from driftproof.support.progress import on_terminal

_T = TypeVar("_T")
# A float run longer than this shows a progress bar.
LONG_RUN = 10**6


def progress_bar(total: int, unit: str) -> AbstractContextManager[Any]:
    """A bar on a terminal; elsewhere an object with its methods, and tqdm is not imported."""
    if not on_terminal():
        return nullcontext(SimpleNamespace(total=0, update=lambda done: None))
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
    """range(steps), with a progress bar on a terminal from LONG_RUN steps on."""
    return range(steps) if steps < LONG_RUN else with_progress(range(steps), "step")
