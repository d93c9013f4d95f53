"""Progress bars, on a terminal only; and what an interruption says of the work that is kept."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
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


@contextmanager
def kept_in(place: Path | None) -> Iterator[None]:
    """Work of which this file or folder keeps the parts that are done: an interruption says so; None keeps nothing."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(*[f"the same command goes on from {place}"] * (place is not None)) from None


def count_steps(steps: int) -> Iterable[int]:
    """range(steps), with a progress bar on a terminal from LONG_RUN steps on."""
    return range(steps) if steps < LONG_RUN else with_progress(range(steps), "step")
