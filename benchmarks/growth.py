"""How cost grows, on paper and measured: facts, trees, enclosures, checked texts and sweeps; about five minutes.

Processor seconds, caches emptied; the slope is that of least squares in log-log over the last `LAST` sizes. Of sweeps
the seconds of the clock are measured, on dask's workers; that part asks for a machine with nothing else to do.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction as Q
from importlib.util import find_spec
from os import cpu_count
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import numpy as np

import driftproof
from benchmarks.enclosure import lorenz, pendulum
from benchmarks.harness import Contestant, Goal, Section, forget, milliseconds, one_turn
from benchmarks.long_runs import exponent
from driftproof.enclosure.solution.solutions import BITS_AT_FIRST, enclose_solution
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.numeric.scenes import PRESETS
from driftproof.numeric.sweep import run_grid
from driftproof.symbolic.trees.order_conditions import order_of, runge_kutta_conditions
from driftproof.symbolic.trees.rooted_trees import tree_table
from driftproof.texts.check import check

# Sizes that the slope is taken over; how much a slope may be above the one on paper, being measured; and for how long
# a short task is repeated, in seconds.
LAST, NEAR, SHORT = 3, 0.3, 0.3
# Efficiency of each worker that has a processor of its own.
EFFICIENT = 0.9


@dataclass(frozen=True)
class Law:
    """What is done at each size, the exponent of the size on paper, and why it is that."""

    name: str
    task: Callable[[int], Callable[[], object]]
    sizes: Sequence[int]
    exponent: float
    reason: str


def dense(stages: int, *, explicit: bool) -> RungeKutta:
    """A table of random ratios of two digits without a zero where there may be something else."""
    draw = Random(stages)
    number = lambda: Q(draw.randrange(1, 100), draw.randrange(10, 100))
    a = tuple(tuple(number() if j < i or not explicit else Q(0) for j in range(stages)) for i in range(stages))
    return RungeKutta("dense", "dense", 0, "", a, tuple(number() for _ in a), tuple(sum(row, Q(0)) for row in a))


def facts(*, explicit: bool) -> Callable[[int], Callable[[], object]]:
    """Every fact of a dense table."""

    def of(stages: int) -> Callable[[], object]:
        method = dense(stages, explicit=explicit)
        return lambda: driftproof.facts(method).data

    return of


def gauss_by_trees(trees: int) -> Callable[[], object]:
    """The order of the Gauss method whose first failing tree is in the table with so many trees."""
    stages = next(s for s in range(2, 8) if trees_to(2 * s + 1) == trees)
    return lambda: order_of(runge_kutta_conditions(METHODS[f"gauss{stages}"]))  # type: ignore[arg-type]


def trees_to(order: int) -> int:
    """The number of trees with so many vertices at most."""
    return tree_table(order).first[-1]


def enclosed(f: Callable[[Any, Any], Any], start: Sequence[float], end: float, bits: int = BITS_AT_FIRST) -> Any:
    """The solution of y' = f(t, y) at the end."""
    return enclose_solution(f, [*map(Q, start)], [Q(0), Q(end)], bits)


def gravity(bodies: int) -> Callable[[Any, Any], Any]:
    """So many equal masses in space that attract each other, as a user writes it."""

    def f(t: Any, y: Any) -> Any:
        q, v = y[: 3 * bodies].reshape(bodies, 3), y[3 * bodies :]
        a = np.zeros((bodies, 3))
        for i in range(bodies):
            for j in range(i):
                r = q[j] - q[i]
                pull = r / (r @ r) ** 1.5 / bodies
                a[i] += pull
                a[j] -= pull
        return np.concatenate([v, a.ravel()])

    return f


def bodies_enclosed(components: int) -> Any:
    """One step of masses anywhere in a cube."""
    draw, bodies = Random(1), components // 6
    start = [draw.uniform(-1, 1) for _ in range(3 * bodies)] + [draw.uniform(-0.1, 0.1) for _ in range(3 * bodies)]
    return enclosed(gravity(bodies), start, 2.0**-10)


def checked(numbers: int) -> Callable[[], object]:
    """A text with so many numbers, a hundredth of them claimed."""

    def line(i: int) -> str:
        return f"In case {i} the method has the order 4." if i % 50 == 0 else f"Line {i} of it says {i / 7:.5f}."

    claim = 'id = "c{0}", given = true, phrase = "In case {0} the method has the order {{value}}", value = "order rk4"'
    claims = ",\n".join(f"{{ {claim.format(i)} }}" for i in range(0, numbers // 2, 50))

    def task() -> object:
        with TemporaryDirectory() as folder:
            text, held = Path(folder) / "text.md", Path(folder) / "claims.toml"
            text.write_text("\n\n".join(map(line, range(numbers // 2))), encoding="utf-8")
            held.write_text(f"claim = [{claims}]", encoding="utf-8")
            found = check(text, held)
        assert found.passed
        return found

    return task


ORDERS = [trees_to(2 * s + 1) for s in range(4, 8)]
LAWS = (
    Law(
        "every fact, explicit, by stages",
        facts(explicit=True),
        (8, 12, 16, 20, 24, 30),
        5,
        "s products of matrices, s³ each, of entries that grow to s digits",
    ),
    Law(
        "every fact, implicit, by stages",
        facts(explicit=False),
        (8, 12, 16, 20, 24, 30),
        5,
        "the same, of matrices without zeros",
    ),
    Law(
        "order of Gauss methods to 14, by trees",
        gauss_by_trees,
        ORDERS,
        1,
        "each tree is one product of two smaller ones; trees grow like 2.96^p",
    ),
    Law(
        "enclosure of the pendulum, by t",
        lambda t: lambda: enclosed(pendulum, (2.0, 0.0), t),
        (10, 20, 40, 80),
        1,
        "steps are as long as the radius of convergence allows, whatever the time",
    ),
    Law(
        "enclosure of Lorenz's system, by bits",
        lambda bits: lambda: enclosed(lorenz, (1.0, 1.0, 1.0), 2, bits),
        (128, 256, 512, 1024),
        2,
        "b/3 coefficients of b bits, products of whole series at a cost near that of reading them",
    ),
    Law(
        "enclosure of bodies in space, by components",
        lambda n: lambda: bodies_enclosed(n),
        (24, 48, 96, 180),
        3,
        "n² pairs with n partial derivatives each, and products of n × n matrices",
    ),
    Law(
        "check of a text, by numbers",
        checked,
        (6250, 12500, 25000, 50000, 100000),
        1,
        "every number is read once; each claim is a search for its first letters",
    ),
)


def seconds(task: Callable[[], object]) -> float:
    """Processor seconds, the least of some runs where they are short."""
    return min(one_turn(Contestant(task, lambda _: "", forget), SHORT, process_time)[0])


def laws_section(laws: Sequence[Law] = LAWS) -> Section:
    """Each law with the exponent that is measured."""
    rows, goals = [["", "size", "time", "on paper", "measured", "because"]], []
    for law in laws:
        costs = [seconds(law.task(size)) for size in law.sizes]
        found = exponent(law.sizes[-LAST:], costs[-LAST:])
        for size, cost in zip(law.sizes, costs, strict=True):
            said = ("", "", "") if size != law.sizes[-1] else (f"{law.exponent:g}", f"{found:.2f}", law.reason)
            rows.append([law.name if size == law.sizes[0] else "", str(size), milliseconds(1000 * cost), *said])
        goals.append(
            Goal(f"{law.name}: exponent", f"≤ {law.exponent:g} + {NEAR}", f"{found:.2f}", found <= law.exponent + NEAR)
        )
    return Section("Growth", rows, goals)


POINTS = 8000
# What a process measures that does one sweep: seconds of the clock, and the largest memory of its own in MiB.
SWEEP = "from benchmarks.growth import sweep_once; print(*sweep_once({points}, {workers}))"


@contextmanager
def dask_executor(workers: int) -> Iterator[Any]:
    """So many processes of dask, each of one thread, on this machine."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,  # type: ignore[no-untyped-call]
        Client(cluster) as client,  # type: ignore[no-untyped-call]
    ):
        yield client.get_executor()  # type: ignore[no-untyped-call]


def sweep_once(points: int, workers: int) -> tuple[float, float]:
    """Seconds that a sweep over so many starts of one length takes, and the peak of memory in MiB of who asks."""
    import resource

    scene, starts = replace(PRESETS["default"], h=Q(1, 1600)), [(Q(1), Q(i, points)) for i in range(points)]
    with dask_executor(workers) as executor:
        run_grid(scene, {"start": starts[: 20 * workers]}, executor)  # imports and compiles everywhere
        start = perf_counter()
        run_grid(scene, {"start": starts}, executor)
        taken = perf_counter() - start
    return taken, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def sweeps_section(points: int = POINTS) -> Section:
    """On 1, 2 and 4 workers; and a quarter of the points, for memory."""
    rows, goals = [["workers", "points", "time", "efficiency of each", "memory of the asking process"]], []
    able, measured = cpu_count() or 1, list[tuple[float, float]]()
    for workers, count in ((1, points), (2, points), (4, points), (2, points // 4)):
        command = [sys.executable, "-c", SWEEP.format(points=count, workers=workers)]
        made = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).parents[1])
        taken, peak = map(float, made.stdout.split())
        measured.append((taken, peak))
        efficiency = measured[0][0] * count / points / taken / min(workers, able)
        rows.append([str(workers), str(count), milliseconds(1000 * taken), f"{efficiency:.2f}", f"{peak:.0f} MiB"])
        if workers == able == 2 and count == points:
            goals.append(
                Goal("sweep on 2 workers: efficiency", f"≥ {EFFICIENT}", f"{efficiency:.2f}", efficiency >= EFFICIENT)
            )
    grown = measured[1][1] / measured[3][1]
    goals.append(Goal("sweep of 4 times the points: memory", "≤ 1.25", f"{grown:.2f}", grown <= 1.25))
    return Section("Growth of sweeps, on dask", rows, goals)


def sections(_: int = 1) -> Iterator[Section]:
    """The tables, one after the other; sweeps where dask is installed."""
    yield laws_section()
    if find_spec("distributed") is not None:
        yield sweeps_section()
