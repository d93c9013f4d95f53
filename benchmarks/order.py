"""Rooted trees, orders and modified equations against nodepy and kauri: python benchmarks/order.py

Ours is timed cold, every table of trees forgotten before each round, and warm, as within a session that asks for many
facts. A peer that is installed runs in the same process, at least once and for at most a few seconds; it keeps its own
caches. The ratio is the peer's best time over our best cold one, so that the comparison favours the peer.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own `symbolic`, whatever else is installed

from methods.catalogue import METHODS
from methods.number_field import Exact
from methods.schemes import Collocation, Method, RungeKutta
from methods.tables import collocation, high_order_pairs
from symbolic.trees import alternating, rooted, table
from symbolic.trees.modified import modified_equation
from symbolic.trees.order import embedded_order, order, order_of, runge_kutta_conditions

Task = Callable[[], object]


@dataclass(frozen=True)
class Subject:
    """What is timed, the project's goal for it in ms, and who else can do it."""

    name: str
    goal: str
    ours: Task
    peers: dict[str, Task] = field(default_factory=dict)


def named(key: str, entries: Iterable[Method]) -> Any:
    return next(method for method in entries if method.key == key)


RK4: RungeKutta = named("rk4", METHODS.values())
RKF8: RungeKutta = named("fehlberg78", high_order_pairs.ENTRIES)
GAUSS4: Collocation = named("gauss4", collocation.ENTRIES)


def trees_of_order_12() -> object:
    """Every tree as an object, with γ and σ."""
    trees = table.tree_table(12)
    return rooted.shapes(12), trees.density, trees.symmetry


def forget() -> None:
    """Empty every cache that holds trees."""
    for cached in (
        table._table,
        rooted.shapes,
        rooted._numbers,
        rooted.coloured_shapes,
        alternating._nystrom_columns,
    ):
        cached.cache_clear()


def subjects(peer_order: int) -> list[Subject]:
    """Ours and, where installed, theirs; kauri's modified equation only to `peer_order`."""
    peers: dict[str, dict[str, Task]] = {}
    for name, tasks in (("nodepy", nodepy_tasks), ("kauri", lambda: kauri_tasks(peer_order))):
        if find_spec(name):
            for subject, task in tasks().items():
                peers.setdefault(subject, {})[name] = task
    low = f"modified equation to order {peer_order}"
    tasks = {
        "trees of order 12": ("10", trees_of_order_12),
        "order of RK4": ("", lambda: order(RK4)),
        "order of RKF8, 13 stages": ("20", lambda: embedded_order(RKF8)),
        "order of Gauss 4 by trees": ("1000", lambda: order_of(runge_kutta_conditions(GAUSS4))),
        "order of Gauss 4 by theorem": ("1000", lambda: order(GAUSS4)),
        low: ("1000", lambda: modified_equation(RK4, peer_order)),
        "modified equation to order 9": ("1000", lambda: modified_equation(RK4, 9)),
    }
    return [Subject(name, goal, ours, peers.get(name, {})) for name, (goal, ours) in tasks.items()]


def nodepy_tasks() -> dict[str, Task]:
    """Exact order, in the mode that nodepy calls exact."""
    import numpy as np
    import sympy
    from nodepy import runge_kutta_method

    def prepared(method: RungeKutta, b: Sequence[Exact]) -> Task:
        def rationals(row: Sequence[Any]) -> list[sympy.Rational]:
            return [sympy.Rational(x.numerator, x.denominator) for x in row]

        made = runge_kutta_method.ExplicitRungeKuttaMethod(
            np.array([*map(rationals, method.a)]), np.array(rationals(b))
        )
        return lambda: made.order(mode="exact")

    return {"order of RK4": prepared(RK4, RK4.b), "order of RKF8, 13 stages": prepared(RKF8, RKF8.b_embedded or ())}


def kauri_tasks(order: int) -> dict[str, Task]:
    """Trees, order in floats to kauri's own tolerance, and the modified equation in floats."""
    import kauri

    def floats(method: RungeKutta, b: Sequence[Exact]) -> Any:
        return kauri.RK([[float(x) for x in row] for row in method.a], [float(x) for x in b])

    def modified() -> object:
        field = floats(RK4, RK4.b).modified_equation_map()
        return [field(tree) for n in range(1, order + 1) for tree in kauri.trees_of_order(n)]

    return {
        "trees of order 12": lambda: list(kauri.trees_of_order(12)),
        # A method made anew each time: kauri keeps the weights of one that has answered before.
        "order of RK4": lambda: floats(RK4, RK4.b).order(),
        "order of RKF8, 13 stages": lambda: floats(RKF8, RKF8.b_embedded or ()).order(),
        f"modified equation to order {order}": modified,
    }


def timed(task: Task, rounds: int, before: Callable[[], None] = lambda: None, seconds: float = 600) -> list[float]:
    """Up to `rounds` times in ms, at least one, until `seconds` are spent; `before` is not counted."""
    taken: list[float] = []
    while len(taken) < rounds and sum(taken) < 1000 * seconds:
        before()
        start = perf_counter()
        task()
        taken.append(1000 * (perf_counter() - start))
    return taken


def lines(rounds: int, seconds: float, peer_order: int) -> Iterator[str]:
    """A table of times in ms, with goals and ratios."""
    yield f"{'ms':32}{'cold min':>10}{'median':>9}{'warm min':>10}{'goal':>7}   peer: min, ratio"
    for subject in subjects(peer_order):
        cold, warm = timed(subject.ours, rounds, forget), timed(subject.ours, rounds)
        best = min(cold)
        theirs = ((name, min(timed(task, rounds, seconds=seconds))) for name, task in subject.peers.items())
        compared = ", ".join(f"{name}: {least:.4g}, {least / best:.3g}" for name, least in theirs)
        times = f"{best:10.3f}{statistics.median(cold):9.3f}{min(warm):10.3f}{subject.goal:>7}"
        yield f"{subject.name:32}{times}   {compared or 'no peer here'}"
    yield f"\n{rounds} rounds, Python {platform.python_version()}, {platform.machine()}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print, line by line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15, help="times each is run (default 15)")
    parser.add_argument("--seconds", type=int, default=3, help="what a peer may take before it is stopped (default 3)")
    parser.add_argument("--peer-order", type=int, default=6, help="order of kauri's modified equation (default 6)")
    chosen = parser.parse_args(arguments)
    for line in lines(chosen.rounds, chosen.seconds, chosen.peer_order):
        print(line, flush=True)


if __name__ == "__main__":
    main()
