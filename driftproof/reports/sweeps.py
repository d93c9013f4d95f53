"""A sweep shown: a row for each point of its grid, as text or as JSON; and the workers of a dask cluster."""

from __future__ import annotations

import logging
import re
import sys
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Any

from driftproof.numeric.run import Readouts
from driftproof.numeric.scenes import Scene
from driftproof.numeric.sweep import Grid, SweepAnswer, points_of, strings, sweep
from driftproof.reports.scene_view import scene_json
from driftproof.support.environment import require_package
from driftproof.support.plain_text import table, with_digits

# Pairs would widen the table; they are in the JSON.
_STATES = ("final_state", "exact_state")
# Enough to compare errors at neighbouring h.
_DIGITS = 4
# What stands over a column, where it is not the name of the axis or of the readout.
_AXES, _LABELS = {"selected": "method"}, {"phase_error": "phase error (degrees)"}
# How the address of a scheduler is written, and the seconds in which it has to answer.
_ADDRESS = re.compile(r"(\w+://)?[^/\s]+:\d+")
_PATIENCE = 10


def sweep_with_progress(
    scene: Scene, grid: Grid, executor: Executor | None, checkpoint: Path | None
) -> list[SweepAnswer]:
    """As `driftproof.numeric.sweep.sweep`, with a progress bar on a terminal."""
    with progress_bar(len(points_of(scene, grid)), "point") as bar:
        return sweep(scene, grid, executor, checkpoint, bar.update)


class _Unseen:
    """A progress bar that nobody would see."""

    total = 0

    def update(self, done: int) -> None:
        """Nothing."""


def progress_bar(total: int, unit: str) -> AbstractContextManager[Any]:
    """A bar on a terminal; elsewhere what has its methods, and tqdm is not imported."""
    if sys.stderr is None or not sys.stderr.isatty():
        return nullcontext(_Unseen())
    from tqdm import tqdm

    bar: AbstractContextManager[Any] = tqdm(total=total, unit=unit, leave=False)
    return bar


def sweep_json(scene: Scene, found: list[SweepAnswer]) -> dict[str, Any]:
    """The scene and its points in the order of the grid; numbers are strings, floats to the last bit."""
    points = [
        strings(answer.values)
        | ({"message": answer.found} if isinstance(answer.found, str) else {"readouts": answer.found})
        for answer in found
    ]
    return scene_json(scene, {"points": points})


def sweep_text(scene: Scene, found: list[SweepAnswer]) -> str:
    """A table: what varies, then the readouts; where there are none, the message."""
    names = [name for name in scene.readouts if name not in _STATES]
    axes = [_AXES.get(name, name) for name in found[0].values]
    rows = [[*axes, *(_LABELS.get(name, name.replace("_", " ")) for name in names), ""]]
    for values, answer in found:
        cells = [*("" for _ in names), answer] if isinstance(answer, str) else [*_cells(answer, names), ""]
        rows.append([*map(_shown, values.values()), *cells])
    return f"{scene.name}: {len(found)} point{'' if len(found) == 1 else 's'}\n\n{table(rows)}"


def _shown(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _cells(readouts: Readouts, names: list[str]) -> list[str]:
    values = [readouts[name] for name in names]
    return ["undefined" if x is None else with_digits(x, _DIGITS) if isinstance(x, float) else str(x) for x in values]


@contextmanager
def cluster_executor(address: str) -> Iterator[Executor]:
    """An executor on the cluster whose scheduler is at `address`, such as tcp://10.0.0.1:8786, while the block lasts.

    Its workers need driftproof installed in the same version. Work of one that is lost is given to others. Raises
    ValueError without the extra `cluster` and for an address that is none, OSError where there is no scheduler, where
    it goes away, and where a task has taken several workers with it.
    """
    if not _ADDRESS.fullmatch(address):
        raise ValueError(f"{address!r} is no address of a scheduler; write it like tcp://10.0.0.1:8786")
    require_package("distributed", "cluster", "a cluster needs distributed")
    from distributed import Client, KilledWorker

    before = logging.root.manager.disable
    logging.disable()  # what went wrong is raised, and distributed logs it once more with its own traceback
    try:
        with Client(address, timeout=_PATIENCE, set_as_default=False) as client:
            yield client.get_executor(pure=False)
    except KilledWorker as error:
        raise ChildProcessError(f"the workers at {address} died of a batch: {error}") from None
    except CancelledError:
        raise ConnectionError(f"the cluster at {address} has gone away") from None
    finally:
        logging.disable(before)
