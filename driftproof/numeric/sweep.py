"""A scene at every point of a grid, on the workers of any executor: each point answered once, in the order of the grid.

What a point answers depends on the point alone, so the executor, the number of its workers and an interruption change
nothing in the result.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import replace
from fractions import Fraction
from itertools import product
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple, TypeAlias

from driftproof.methods.catalogue import method_named
from driftproof.numeric.checkpoint import Checkpoint
from driftproof.numeric.run import Readouts, run_method
from driftproof.numeric.scenes import TRAJECTORY, Scene

# Names of fields of a scene, and the values of one point.
Values: TypeAlias = dict[str, Any]
# The readouts, or the message of what stopped the run.
Found: TypeAlias = Readouts | str
Grid: TypeAlias = Mapping[str, Sequence[Any]]
Batch: TypeAlias = list[tuple[int, Found]]

AXES = ("selected", "h", "t", "start")
# Seconds that a batch should take at least, so that sending it is a small part, and at which it stops and hands the
# rest back, so that no worker sits on many slow points.
SHORTEST, LONGEST = 0.05, 1.0
# Batches under way at a time: enough for as many workers.
WAITING = 64


class Answer(NamedTuple):
    """A point of the grid, `values` by field of the scene; `found` is its readouts, or what stopped it, in a line."""

    values: Values
    found: Found


def sweep(scene: Scene, grid: Grid, executor: Executor | None = None, checkpoint: Path | None = None) -> list[Answer]:
    """The scene's readouts for its selected method at every point of `grid`, the last name varying fastest.

    `grid` maps names among selected, h, t and start to their values: keys, Fractions, and pairs of Fractions. A run
    that overflows, or that there is none of, as where h does not divide t, is answered by its message. `executor` is
    any of `concurrent.futures`, and left open; without one, what is not done within a second goes to processes on this
    machine. `checkpoint` names a file in which answers are kept as they come, and from which the same sweep goes on.
    Raises ValueError for a grid that is none, a scene without readouts, and a file that is not of this sweep; OSError
    where a process ends.

    >>> from fractions import Fraction
    >>> from driftproof import PRESETS, sweep
    >>> grid = {"h": [Fraction(1), Fraction(2)]}
    >>> [answer.found["final_state"] for answer in sweep(PRESETS["stability_boundary"], grid)]
    [(0.0, 1.0), (-11.0, -10.0)]
    """
    points = points_of(scene, grid)
    found = {i: answer for batch in batches(scene, grid, executor, checkpoint) for i, answer in batch}
    return [Answer(values, found[i]) for i, values in enumerate(points)]


def points_of(scene: Scene, grid: Grid) -> list[Values]:
    """The points of the grid in their order. Raises as `sweep`."""
    if not scene.readouts or TRAJECTORY in scene.readouts:
        raise ValueError(f"scene {scene.name!r}: a sweep needs readouts, and keeps no trajectory")
    for name, values in grid.items():
        if name not in AXES:
            raise ValueError(f"the grid has no axis {name!r}; choose from {', '.join(AXES)}")
        if isinstance(values, str) or not values:
            raise ValueError(f"the axis {name!r} is {values!r}; write a list of at least one value")
        for value in values:
            _check_value(name, value)
    return [dict(zip(grid, values, strict=True)) for values in product(*grid.values())]


def batches(
    scene: Scene, grid: Grid, executor: Executor | None = None, checkpoint: Path | None = None
) -> Iterator[Batch]:
    """(index of the point, what it found) for every point, in the order in which they come; as `sweep`."""
    points, kept = points_of(scene, grid), None
    if checkpoint is not None:
        kept = Checkpoint(checkpoint, scene, grid, points)
        yield list(kept.found.items())
    done = kept.found if kept is not None else {}
    for batch in _spread(scene, points, deque(i for i in range(len(points)) if i not in done), executor):
        if kept is not None:
            kept.add(batch)
        yield batch
    if kept is not None:
        kept.finish()


def processes(workers: int | None = None) -> ProcessPoolExecutor:
    """So many fresh processes on this machine, by default one for each processor; they inherit no threads or locks."""
    return ProcessPoolExecutor(workers or os.cpu_count(), mp_context=get_context("spawn"))


def _spread(scene: Scene, points: list[Values], left: deque[int], executor: Executor | None) -> Iterator[Batch]:
    if executor is not None:
        yield from _answered(scene, points, left, executor)
        return
    found, _ = run_points(scene, [points[i] for i in left])
    yield [(left.popleft(), answer) for answer in found]
    if left:
        with processes() as pool:
            yield from _answered(scene, points, left, pool)


def _answered(scene: Scene, points: list[Values], left: deque[int], executor: Executor) -> Iterator[Batch]:
    """Batches double until one takes `SHORTEST`; what a worker hands back goes to the front of the queue."""
    running: dict[Future[tuple[list[Found], float]], list[int]] = {}
    size = 1
    try:
        while left or running:
            while left and len(running) < WAITING:
                batch = [left.popleft() for _ in range(min(size, len(left)))]
                running[executor.submit(run_points, scene, [points[i] for i in batch])] = batch
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                batch = running.pop(future)
                found, seconds = future.result()
                if len(found) < len(batch):
                    size = len(found)
                elif seconds < SHORTEST and len(batch) == size:
                    size *= 2
                left.extendleft(reversed(batch[len(found) :]))
                yield list(zip(batch, found, strict=False))
    except BrokenExecutor:
        raise ChildProcessError("a process of the sweep ended before it answered; was its memory used up?") from None
    finally:
        for future in running:
            future.cancel()


def run_points(scene: Scene, points: Sequence[Values]) -> tuple[list[Found], float]:
    """What the points find, as far as they were reached within `LONGEST`, and the seconds it took: a worker's part."""
    start, found = perf_counter(), list[Found]()
    for values in points:
        found.append(_run_point(scene, values))
        if perf_counter() - start > LONGEST:
            break
    return found, perf_counter() - start


def _run_point(scene: Scene, values: Values) -> Found:
    try:
        at = replace(scene, **values, methods=(), certified=(), panels=())
        return run_method(at, at.selected)
    except (ValueError, ArithmeticError) as stopped:
        return str(stopped)


def _check_value(name: str, value: object) -> None:
    """Raises ValueError, or for a method that is not in the catalogue the suggestion of `method_named`."""
    if name == "selected":
        method_named(str(value))
    elif name == "start":
        if not (isinstance(value, tuple) and len(value) == 2 and all(isinstance(x, Fraction) for x in value)):
            raise ValueError(f"the axis 'start' has {value!r}; write pairs of Fractions")
    elif not isinstance(value, Fraction):
        raise ValueError(f"the axis {name!r} has {value!r}; write Fractions, which are exact")
