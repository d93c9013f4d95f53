"""A sweep as text or JSON, with a row for each point of its grid; and an executor on a dask cluster."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, Executor, Future
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

from driftproof.methods.given_methods import GivenMethods, names_of
from driftproof.methods.numbers.rationals import ExactNumber, GivenState, exact_numbers, state_of, steps_of
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.readouts import ENERGY_ERROR, LARGEST_ERROR
from driftproof.numeric.run import Readouts
from driftproof.numeric.scenes import PRESETS, Scene, compared_readouts
from driftproof.numeric.sweep import SweepAnswer, points_of, processes, run_grid, strings
from driftproof.reports.progress import kept_in, progress_bar
from driftproof.reports.scene_view import scene_json
from driftproof.reports.scenes import scene_given
from driftproof.support.environment import require_package
from driftproof.support.plain_text import counted, table, with_digits
from driftproof.support.results import Answered

# Pairs would widen the table; they are in the JSON.
_STATES = ("final_state", "exact_state")
# Digits: enough to compare errors at neighbouring h.
_DIGITS = 4
# The headings of columns that are not the name of the axis or of the readout.
_AXES, _LABELS = {"selected": "method"}, {"phase_error": "phase error (degrees)"}
# The form of a scheduler's address, and the seconds in which it has to answer.
_ADDRESS = re.compile(r"(\w+://)?[^/\s]+:\d+")
_SECONDS_TO_CONNECT = 10


def sweep(
    scene: str | Path | Mapping[str, Any] | Problem | Scene,
    *,
    methods: GivenMethods = (),
    parameters: Mapping[str, ExactNumber] | Sequence[tuple[str, ExactNumber]] = (),
    state: Sequence[GivenState] = (),
    t: ExactNumber | Sequence[ExactNumber] = (),
    h: ExactNumber | Sequence[ExactNumber] = (),
    output: str | Path | None = None,
    workers: int | Executor | None = None,
    cluster: str | None = None,
) -> Answered:
    """A scene in floats at every point of a grid, in parallel; `found` has a `SweepAnswer` for each point in order.

    The grid has a point for each combination, h varying fastest; values that are not given are the scene's. `output` is
    a file in which answers are kept as they come, and from which the same sweep goes on. `workers` is a number of
    processes, or an executor of your own; `cluster` is the address of a dask scheduler. A problem, as for
    `work_precision`, is swept to its end, and needs methods and h; `parameters` replace some of its own. Raises
    ValueError.

    >>> from driftproof import sweep
    >>> [answer.found["final_state"] for answer in sweep("stability_boundary", h=[1, 2]).found]
    [(0.0, 1.0), (-11.0, -10.0)]
    """
    about = scene if isinstance(scene, Scene) else _scene_of(scene, methods, h, parameters)
    if parameters and about.problem is None:
        raise ValueError("parameters are of a problem of your own; a scene has none to change")
    times, states = exact_numbers(t, "t"), [state_of(each) for each in state or ()]
    keys, own = names_of(methods)
    about = replace(about, own=own) if own else about
    if about.problem is None:
        sizes = steps_of(h)
    else:
        from driftproof.enclosure.problem_tables import steps_to  # of which a scene has no need

        sizes = steps_to(about.t, h)
    axes: dict[str, Sequence[Any]] = {"selected": keys, "start": states, "t": times, "h": sizes}
    grid = {name: values for name, values in axes.items() if values}
    points = points_of(about, grid)
    place = None if output is None else Path(output)
    with _executor(workers, cluster) as executor, progress_bar(len(points), "point") as bar, kept_in(place):
        found = run_grid(about, grid, executor, place, bar.update)
    return Answered(sweep_json(about, found), lambda _: sweep_text(about, found), found)


def _scene_of(
    given: str | Path | Mapping[str, Any] | Problem,
    methods: GivenMethods,
    h: ExactNumber | Sequence[ExactNumber],
    parameters: Any,
) -> Scene:
    """The scene of this name; of a problem, that of the errors at its end, for the first method and step size."""
    if str(given) in PRESETS:
        return scene_given(str(given))
    from driftproof.enclosure.problem_tables import steps_to
    from driftproof.reports.user_problem import names_problem, problem_given

    if not names_problem(given):
        return scene_given(str(given))
    problem = problem_given(given, parameters)
    (keys, own), steps = names_of(methods), steps_to(problem.t, h)
    if not (keys and steps):
        raise ValueError(f"{problem.key} is a problem; a sweep of it needs methods and h, such as rk4 and 1/10,1/20")
    name, readouts = Path(problem.key).stem, compared_readouts(problem)
    return Scene(name, keys[0], steps[0], problem.t, readouts=readouts, problem=problem, own=own)


def _executor(workers: int | Executor | None, cluster: str | None) -> AbstractContextManager[Executor | None]:
    """The executor to use; None leaves the choice to the sweep."""
    if cluster:
        return cluster_executor(cluster)
    return processes(workers) if isinstance(workers, int) else nullcontext(workers)


def sweep_json(scene: Scene, found: list[SweepAnswer]) -> dict[str, Any]:
    """The scene and its points in the order of the grid; numbers are strings, floats exact to the last bit."""
    points = [
        strings(answer.values)
        | ({"message": answer.found} if isinstance(answer.found, str) else {"readouts": answer.found})
        for answer in found
    ]
    return scene_json(scene, {"points": points})


def sweep_text(scene: Scene, found: list[SweepAnswer]) -> str:
    """A table with a row for each point: the values that vary, then the readouts or, if the run failed, the message."""
    names = [name for name in scene.readouts if name not in _STATES]
    axes = [_AXES.get(name, name) for name in found[0].values]
    rows = [[*axes, *(_LABELS.get(name, name.replace("_", " ")) for name in names), ""]]
    for values, answer in found:
        cells = [*("" for _ in names), answer] if isinstance(answer, str) else [*_cells(answer, names), ""]
        rows.append([*map(_shown, values.values()), *cells])
    note = scene.problem.energy_note if scene.problem and {ENERGY_ERROR, LARGEST_ERROR} & {*names} else ""
    title = scene.problem.title.replace(scene.problem.key, scene.name) if scene.problem else scene.name
    name = title if title.startswith(scene.name) else f"{scene.name} ({title})"  # with other values of parameters
    return "\n\n".join(filter(None, [f"{name}: {counted(len(found), 'point')}", table(rows), note]))


def _shown(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _cells(readouts: Readouts, names: list[str]) -> list[str]:
    values = [readouts[name] for name in names]
    return ["undefined" if x is None else with_digits(x, _DIGITS) if isinstance(x, float) else str(x) for x in values]


class _ClusterExecutor(Executor):
    """An executor on a dask client that survives the death of a worker between the end of a task and its delivery.

    `Client.get_executor` does not: it looks at the future's status after the result has arrived, and takes the result
    of a future that is "lost" by then for an exception.
    """

    def __init__(self, client: Any) -> None:
        self._client = client

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Run fn on a worker; cancelling the future cancels the task."""
        task, future = self._client.submit(fn, *args, pure=False, **kwargs), Future[Any]()

        def deliver(_: object) -> None:
            if future.set_running_or_notify_cancel():
                try:
                    future.set_result(task.result())
                except BaseException as error:
                    future.set_exception(error)

        future.add_done_callback(lambda done: task.cancel() if done.cancelled() else None)
        task.add_done_callback(deliver)
        return future


@contextmanager
def cluster_executor(address: str) -> Iterator[Executor]:
    """An executor on the cluster with its scheduler at `address`, such as tcp://10.0.0.1:8786, during the block.

    Its workers need the same version of driftproof. Work of a worker that is lost is given to others. Raises ValueError
    for an invalid address and without the extra `cluster`; OSError if there is no scheduler, if it goes away, or if a
    task has taken several workers with it.
    """
    if not _ADDRESS.fullmatch(address):
        raise ValueError(f"{address!r} is not the address of a scheduler, such as tcp://10.0.0.1:8786")
    require_package("distributed", "cluster", "--cluster needs distributed")
    from distributed import Client, KilledWorker

    # What went wrong is raised, and distributed logs it once more with its own traceback.
    unheard, known = lambda record: False, [*logging.root.manager.loggerDict]
    loggers = [logging.getLogger(name) for name in known if name.partition(".")[0] == "distributed"]
    for each in loggers:
        each.addFilter(unheard)
    try:
        with Client(address, timeout=_SECONDS_TO_CONNECT, set_as_default=False) as client:
            yield _ClusterExecutor(client)
    except KilledWorker as error:
        raise ChildProcessError(f"a batch killed the workers at {address}: {error}") from None
    except CancelledError:
        raise ConnectionError(f"the connection to the cluster at {address} was lost") from None
    finally:
        for each in loggers:
            each.removeFilter(unheard)
