"""Run a scene at every point of a grid, on the workers of any executor; results are in the order of the grid.

The result of a point depends on the point alone, not on the executor, the number of its workers or an interruption.

Results are kept in a file of JSON lines, which survives whatever ends the sweep. The first line says what is swept, by
which version; every other line holds the result of one point, with a checksum of the first line and of itself. Lines
are written whole and synchronised, a batch at a time: only the last one can be cut off, and it is then dropped. Floats
are strings, exact to the last bit. While a sweep writes the file, no other sweep may.
"""

from __future__ import annotations

import json
import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import replace
from fractions import Fraction
from hashlib import sha256
from itertools import product
from multiprocessing import get_context, parent_process, resource_tracker
from pathlib import Path
from threading import Thread
from time import perf_counter
from typing import Any, NamedTuple, TypeAlias

from driftproof import __version__
from driftproof.numeric.readouts import TRAJECTORY
from driftproof.numeric.run import Readouts
from driftproof.numeric.scene_run import run_scene
from driftproof.numeric.scenes import Scene
from driftproof.support.files import atomic_write, naming, require_file, sole_writer

# The values of one point, by the names of fields of a scene.
Values: TypeAlias = dict[str, Any]
# The readouts, or the message of the error that stopped the run.
Found: TypeAlias = Readouts | str
Grid: TypeAlias = Mapping[str, Sequence[Any]]
Batch: TypeAlias = list[tuple[int, Found]]

AXES = ("selected", "h", "t", "start")
# A batch should take at least SHORTEST seconds, so that sending it is a small part of them. After LONGEST it stops and
# hands the rest back, so that no worker keeps many slow points.
SHORTEST, LONGEST = 0.2, 1.0
# Batches under way at a time: enough for as many workers.
WAITING = 64


class SweepAnswer(NamedTuple):
    """A point of the grid: its `values` by field of the scene, and `found`, its readouts or the error message."""

    values: Values
    found: Found


def run_grid(
    scene: Scene,
    grid: Grid,
    executor: Executor | None = None,
    checkpoint: Path | None = None,
    answered: Callable[[int], object] = lambda _: None,
) -> list[SweepAnswer]:
    """The scene's readouts for its selected method at every point of `grid`, the last name varying fastest.

    `grid` maps names among selected, h, t and start to their values: keys, Fractions, and pairs of Fractions. A run
    that overflows, or does not exist because h does not divide t, has a message as its answer. `executor` is any of
    `concurrent.futures`, and is left open; without one, what is not done within a second goes to processes on this
    machine. `checkpoint` names a file in which answers are kept as they come, and from which the same sweep goes on.
    `answered` is called with the number of answers whenever some come. Raises ValueError for an invalid grid, a scene
    without readouts, and the file of another sweep; OSError if a process dies.

    >>> from fractions import Fraction
    >>> from driftproof import PRESETS
    >>> from driftproof.numeric.sweep import run_grid
    >>> [answer.found["steps"] for answer in run_grid(PRESETS["default"], {"h": [Fraction(1, 4), Fraction(1, 8)]})]
    [40, 80]
    """
    points, found = points_of(scene, grid), dict[int, Found]()
    for batch in sweep_batches(scene, grid, executor, checkpoint):
        found.update(batch)
        answered(len(batch))
    return [SweepAnswer(values, found[i]) for i, values in enumerate(points)]


def points_of(scene: Scene, grid: Grid) -> list[Values]:
    """The points of the grid in their order. Raises ValueError as `run_grid` does."""
    if not scene.readouts or TRAJECTORY in scene.readouts:
        raise ValueError(f"scene {scene.name!r}: a sweep needs readouts, and {TRAJECTORY} cannot be one")
    for name, values in grid.items():
        if name not in AXES:
            raise ValueError(f"the grid has no axis {name!r}; choose from {', '.join(AXES)}")
        if name == "start" and scene.problem is not None:
            raise ValueError(f"scene {scene.name!r}: the problem fixes the start; remove the axis start")
        if isinstance(values, str) or not values:
            raise ValueError(f"the axis {name!r} is {values!r}; write a list with at least one value")
        for value in values:
            _check_value(scene, name, value)
    return [dict(zip(grid, values, strict=True)) for values in product(*grid.values())]


def sweep_batches(
    scene: Scene, grid: Grid, executor: Executor | None = None, checkpoint: Path | None = None
) -> Iterator[Batch]:
    """Yield batches of (index of the point, its result) in the order in which they come; arguments as in `run_grid`."""
    points = points_of(scene, grid)
    if checkpoint is None:
        yield from _all_batches(scene, points, deque(range(len(points))), executor)
        return
    require_file(checkpoint)
    checkpoint.parent.mkdir(parents=True, exist_ok=True)
    checkpoint.open("ab").close()  # so that there is something to lock
    with sole_writer(checkpoint):
        kept = Checkpoint(checkpoint, scene, grid, points)
        yield list(kept.found.items())
        left = deque(i for i in range(len(points)) if i not in kept.found)
        for batch in _all_batches(scene, points, left, executor):
            kept.add(batch)
            yield batch
        kept.finish()


class Workers(ProcessPoolExecutor):
    """Fresh processes on this machine, which inherit no threads or locks, ignore Ctrl-C and end with their parent."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit as usual; the first call starts the processes, in which interrupts are blocked from the start."""
        resource_tracker.ensure_running()  # started later, it would unblock them
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def stop(self) -> None:
        """Kill the processes, whatever they are doing."""
        for process in list((self._processes or {}).values()):
            process.kill()
        self.shutdown()


def processes(workers: int | None = None) -> Workers:
    """A pool of `workers` processes, by default one for each processor."""
    return Workers(workers, mp_context=get_context("spawn"), initializer=_end_with_parent)


def _end_with_parent() -> None:
    """End this process as soon as its parent has ended: one that is killed cannot end its workers."""
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()


def _all_batches(scene: Scene, points: list[Values], left: deque[int], executor: Executor | None) -> Iterator[Batch]:
    if executor is not None:
        yield from _batches_on(scene, points, left, executor)
        return
    found, _ = run_points(scene, [points[i] for i in left])
    yield [(left.popleft(), answer) for answer in found]
    if left:
        with processes() as pool:
            yield from _batches_on(scene, points, left, pool)


def _batches_on(scene: Scene, points: list[Values], left: deque[int], executor: Executor) -> Iterator[Batch]:
    """Yield batches, of double the size until one takes SHORTEST; what a worker hands back is sent next."""
    running: dict[Future[tuple[list[Found], float]], list[int]] = {}
    size = 1
    try:
        while left or running:
            while left and len(running) < WAITING:
                batch = [left.popleft() for _ in range(min(size, len(left)))]
                running[executor.submit(run_points, scene, [points[i] for i in batch])] = batch
            done = wait(running, return_when=FIRST_COMPLETED).done
            for future in [each for each in running if each in done]:  # in the order sent, so that runs can be repeated
                batch = running.pop(future)
                found, seconds = future.result()
                if len(found) < len(batch):
                    size = len(found)
                elif seconds < SHORTEST and len(batch) == size:
                    size *= 2
                left.extendleft(reversed(batch[len(found) :]))
                yield list(zip(batch, found, strict=False))
    except BrokenExecutor:
        why = 'did it run out of memory? In a script, call the sweep under if __name__ == "__main__":'
        raise ChildProcessError(f"a process of the sweep ended before it answered; {why}") from None
    finally:
        if running and isinstance(executor, Workers):
            executor.stop()
        for future in running:
            future.cancel()


def run_points(scene: Scene, points: Sequence[Values]) -> tuple[list[Found], float]:
    """The results of the points reached within LONGEST seconds, and the seconds taken: a worker's part."""
    start, found = perf_counter(), list[Found]()
    for values in points:
        found.append(_run_point(scene, values))
        if perf_counter() - start > LONGEST:
            break
    return found, perf_counter() - start


def _run_point(scene: Scene, values: Values) -> Found:
    try:
        at = replace(scene, **values, methods=(), panels=())
        return run_scene(at, at.selected)
    except (ValueError, ArithmeticError) as stopped:
        return str(stopped)


def _check_value(scene: Scene, name: str, value: object) -> None:
    """Raise ValueError for a value of the wrong type, or an unknown method, with the suggestion of `Scene.method`."""
    if name == "selected":
        scene.method(value if isinstance(value, str) else str(value))
    elif name == "start":
        if not (isinstance(value, tuple) and len(value) == 2 and all(isinstance(x, Fraction) for x in value)):
            raise ValueError(f"the axis 'start' has {value!r}; write pairs of Fractions")
    elif not isinstance(value, Fraction):
        raise ValueError(f"the axis {name!r} has {value!r}; write Fractions, which are exact")


class Checkpoint:
    """The file of a sweep; `found` has the results in it by index of the point."""

    def __init__(
        self, path: Path, scene: Scene, grid: Mapping[str, Sequence[Any]], points: Sequence[Mapping[str, Any]]
    ) -> None:
        """Read the file, or start one. Raises ValueError for another sweep's, or for lines that are not answers."""
        self.path, self.points, self.readouts = path, points, scene.readouts
        self.head = _line(
            {
                "sweep": scene.name,
                "driftproof": __version__,
                **({"problem": scene.problem.title} if scene.problem else {}),
                **{name: strings(getattr(scene, name)) for name in ("selected", "h", "t")},
                "start": strings(scene.problem.start if scene.problem else scene.start),
                "readouts": scene.readouts,
                "definition": digest((scene.problem, [*map(scene.method, grid.get("selected", [scene.selected]))])),
                "grid": [[name, strings(values)] for name, values in grid.items()],
            }
        )
        self.found: dict[int, Any] = {}
        self._open()

    def add(self, batch: Iterable[tuple[int, Any]]) -> None:
        """Append the results of a batch."""
        batch = list(batch)
        self._append(b"".join(self._of_point(i, found) for i, found in batch))
        self.found.update(batch)

    def finish(self) -> None:
        """Sort the lines in the order of the grid, so that every run of the sweep leaves the same bytes."""
        with atomic_write(self.path) as draft:
            text = self.head + b"".join(self._of_point(i, self.found[i]) for i in sorted(self.found))
            Path(draft).write_bytes(text)

    def _open(self) -> None:
        with naming(self.path):
            text = self.path.read_bytes()
        lines = text.splitlines(keepends=True)
        cut = lines.pop() if lines and not lines[-1].endswith(b"\n") else b""
        if not (lines[0] == self.head if lines else self.head.startswith(cut)):
            raise ValueError(f"{self.path} belongs to another sweep; name another file, or delete it")
        for number, line in enumerate(lines[1:], 2):
            self._read(number, line)
        with naming(self.path), self.path.open("ab") as file:
            file.truncate(len(text) - len(cut))
        if not lines:
            self._append(self.head)

    def _append(self, lines: bytes) -> None:
        with naming(self.path), self.path.open("ab") as file:
            file.write(lines)
            file.flush()
            os.fsync(file.fileno())

    def _of_point(self, i: int, found: Any) -> bytes:
        kind = "message" if isinstance(found, str) else "readouts"
        entry = {"point": i, **{name: strings(x) for name, x in self.points[i].items()}, kind: strings(found)}
        return _line({**entry, "checksum": sha256(self.head + _line(entry)).hexdigest()[:16]})

    def _read(self, number: int, line: bytes) -> None:
        """Keep the result in a line. Raises ValueError unless it is the very line that is written for that result."""
        try:
            entry = json.loads(line)
            i, found = entry["point"], entry.get("message")
            if found is None:
                found = {name: _read_out(entry["readouts"][name]) for name in self.readouts}
            right = i not in self.found and self._of_point(i, found) == line
        except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
            right = False
        if not right:
            raise ValueError(f"{self.path}, line {number}: not an answer of this sweep, or a duplicate")
        self.found[i] = found


def digest(data: object) -> str:
    """A hash that tells apart problems or methods of which only the names are kept, such as those of a file."""
    return sha256(repr(data).encode()).hexdigest()[:16]


def _line(entry: dict[str, Any]) -> bytes:
    return f"{json.dumps(entry, ensure_ascii=False)}\n".encode()


def strings(value: Any) -> Any:
    """The value with Fractions and floats as strings, exact to the last bit, arrays as lists, the rest unchanged."""
    if isinstance(value, Mapping):
        return {name: strings(x) for name, x in value.items()}
    if isinstance(value, tuple | list):
        return [strings(x) for x in value]
    if hasattr(value, "tolist"):
        return strings(value.tolist())
    return str(value) if isinstance(value, float | Fraction) else value


def _read_out(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_read_out(x) for x in value)
    return float(value) if isinstance(value, str) else value
