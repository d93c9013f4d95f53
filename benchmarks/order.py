"""Rooted trees, orders and modified equations, beside NodePy, kauri and RKkit: python benchmarks/order.py

Ours is timed cold, every table of trees forgotten before each call, and warm, as within a session that asks for many
facts. Peers keep whatever caches they have, so that the ratio favours them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own packages, whatever else is installed

from benchmarks.peers import installed, kauri_method, nodepy_method, rkkit_method
from benchmarks.timing import Contestant, Row, Subject, cold_and_warm, measure, print_measured, with_peers
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.trees import rooted, table
from driftproof.symbolic.trees.modified import modified_equation
from driftproof.symbolic.trees.order import OrderFact, embedded_order, order, order_of, runge_kutta_conditions

# Any: the catalogue holds methods of every family under its keys.
RK4: Any = METHODS["rk4"]
RKF8: Any = METHODS["fehlberg78"]
GAUSS2: Any = METHODS["gauss2"]
GAUSS4: Any = METHODS["gauss4"]
# kauri's modified equation is compared at this order; at 9 it takes minutes.
PEER_ORDER = 6
TREES = "trees of order 12"
ORDER_RK4 = "order of rk4"
ORDER_RKF8 = "order of RKF8, 13 stages"
ORDER_GAUSS2 = "order of gauss2, over Q(sqrt 3)"
MODIFIED = f"modified equation of rk4 to order {PEER_ORDER}"


def trees_of_order_12() -> Any:
    """Every tree with at most 12 vertices as an object, with γ and σ."""
    trees = table.tree_table(12)
    return rooted.shapes(12), trees.density, trees.symmetry, trees.ids(12)


def order_found(task: Callable[[], OrderFact[Any] | None]) -> dict[str, Contestant]:
    """Ours for an order."""
    return cold_and_warm(task, lambda fact: str(fact.order))


def modified_to(n: int) -> dict[str, Contestant]:
    """Our modified equation of RK4 with trees of at most n vertices."""
    return cold_and_warm(lambda: modified_equation(RK4, n), lambda series: zeros(value for _, value in series.items()))


def zeros(coefficients: Any) -> str:
    """By how many coefficients vanish; of floats those below 1e-12."""
    values = [abs(float(c)) for c in coefficients]
    return f"{sum(v < 1e-12 for v in values)} of {len(values)} zero"


def nodepy_tasks() -> dict[str, dict[str, Contestant]]:
    """Its order in the mode that it calls exact, and in floats where the tableau is irrational."""
    rk4, rkf8, gauss2 = nodepy_method(RK4), nodepy_method(RKF8, embedded=True), nodepy_method(GAUSS2)
    return {
        ORDER_RK4: {"nodepy": Contestant(lambda: rk4.order(mode="exact"))},
        ORDER_RKF8: {"nodepy": Contestant(lambda: rkf8.order(mode="exact"))},
        ORDER_GAUSS2: {"nodepy, floats": Contestant(gauss2.order)},
    }


def kauri_tasks() -> dict[str, dict[str, Contestant]]:
    """Trees, order in floats to its own tolerance, and the modified equation in floats."""
    import kauri

    def modified() -> Any:
        field = kauri_method(RK4).modified_equation_map()
        return [field(tree) for n in range(1, PEER_ORDER + 1) for tree in kauri.trees_of_order(n)]

    return {
        TREES: {"kauri": Contestant(lambda: list(kauri.trees_of_order(12)), lambda trees: str(len(trees)))},
        ORDER_RK4: {"kauri, floats": Contestant(lambda: kauri_method(RK4).order())},
        ORDER_RKF8: {"kauri, floats": Contestant(lambda: kauri_method(RKF8, embedded=True).order())},
        ORDER_GAUSS2: {"kauri, floats": Contestant(lambda: kauri_method(GAUSS2).order())},
        MODIFIED: {"kauri, floats": Contestant(modified, zeros)},
    }


def rkkit_tasks() -> dict[str, dict[str, Contestant]]:
    """Exact orders. Its sums run over all assignments of stages to vertices, so that only few stages are in reach."""
    return {
        ORDER_RK4: {"RKkit": Contestant(lambda: rkkit_method(RK4).order())},
        ORDER_GAUSS2: {"RKkit": Contestant(lambda: rkkit_method(GAUSS2).order())},
    }


TASKS = {"nodepy": nodepy_tasks, "kauri": kauri_tasks, "RKkit": rkkit_tasks}


def subjects() -> list[Subject]:
    """The questions, each with ours and with the peers that are installed; goals in ms."""
    found = [
        Subject(TREES, cold_and_warm(trees_of_order_12, lambda found: str(len(found[-1]))), 10),
        Subject(ORDER_RK4, order_found(lambda: order(RK4))),
        Subject(ORDER_RKF8, order_found(lambda: embedded_order(RKF8)), 20),
        Subject(ORDER_GAUSS2, order_found(lambda: order(GAUSS2))),
        Subject("order of gauss4 by its trees", order_found(lambda: order_of(runge_kutta_conditions(GAUSS4))), 1000),
        Subject("order of gauss4 by theorem", order_found(lambda: order(GAUSS4)), 1000),
        Subject(MODIFIED, modified_to(PEER_ORDER)),
        Subject("modified equation of rk4 to order 9", modified_to(9), 1000),
    ]
    return with_peers(found, (tasks() for name, tasks in TASKS.items() if name in installed()))


def rows(rounds: int) -> list[Row]:
    """All subjects, measured."""
    return measure(subjects(), rounds)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    print_measured(arguments, __doc__, rows)


if __name__ == "__main__":
    main()
