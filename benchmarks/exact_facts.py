"""What exact answers cost, beside NodePy, kauri and RKkit: trees, orders, stability, every fact, and rounding bounds.

Ours is timed cold, every cache forgotten before each call, and warm, as within a session that asks for many facts.
Peers keep whatever caches they have, so that the ratio favours them; but RKkit keeps what a method has answered, and so
its object is made anew in every call. NodePy's R(z) is exact for rational tableaux, its limits and SSP coefficients are
floats; kauri computes in floats; RKkit works with real algebraic numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction as Q
from random import Random
from typing import Any

from flint import fmpq_poly

from benchmarks.harness import Contestant, Section, Subject, cold_and_warm, timed
from benchmarks.peers import (
    installed,
    kauri_method,
    nodepy_method,
    rational_function,
    read_nodepy,
    read_rkkit,
    rkkit_method,
    six_digits,
)
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.numeric.steppers import rk4
from driftproof.reports.fact_sheet import facts
from driftproof.symbolic.algebra.radicals import root_decimal
from driftproof.symbolic.linear.a_stability import a_stability, l_stability
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import imaginary_limit, real_limit
from driftproof.symbolic.rounding.fixed_step_bound import fixed_step_bound
from driftproof.symbolic.rounding.n_steps_bound import run_bound
from driftproof.symbolic.rounding.step_bound import step_bound
from driftproof.symbolic.trees import rooted_trees
from driftproof.symbolic.trees.algebraic_stability import is_algebraically_stable
from driftproof.symbolic.trees.modified_equation import modified_equation
from driftproof.symbolic.trees.order_conditions import order, order_of, runge_kutta_conditions
from driftproof.symbolic.trees.partitioned_trees import embedded_order

# Any: the catalogue holds methods of every family under its keys.
METHOD: dict[str, Any] = {**METHODS}
RK4, RKF8, GAUSS2 = METHOD["rk4"], METHOD["fehlberg78"], METHOD["gauss2"]
PLAIN = ("rk4", "fehlberg78", "dop853", "gauss2", "gauss5")
SSP, RADAU = METHOD["ssprk104"], METHOD["radau_iia3"]
# kauri's modified equation is compared at this order; at 9 it takes minutes.
PEER_ORDER = 6
TREES = "trees of order 12"
ORDER_RK4, ORDER_RKF8, ORDER_GAUSS2 = "order of rk4", "order of RKF8, 13 stages", "order of gauss2, over Q(sqrt 3)"
MODIFIED = f"modified equation of rk4 to order {PEER_ORDER}"
ALGEBRAIC, SSP_NAME = "algebraic stability of radau_iia3", "SSP coefficient of ssprk104"
TWELVE = "every fact of a dense table of 12 stages"
Tasks = dict[str, dict[str, Contestant]]


def trees_of_order_12() -> Any:
    """Every tree with at most 12 vertices as an object, with γ and σ."""
    trees = rooted_trees.tree_table(12)
    return rooted_trees.shapes(12), trees.density, trees.symmetry, trees.ids(12)


def zeros(coefficients: Any) -> str:
    """How many coefficients vanish; of floats those below 1e-12."""
    values = [abs(float(c)) for c in coefficients]
    return f"{sum(v < 1e-12 for v in values)} of {len(values)} zero"


def trees_and_orders() -> list[Subject]:
    """Goals in ms."""

    def of_order(name: str, task: Callable[[], Any], goal: float | None = None) -> Subject:
        return Subject(name, cold_and_warm(task, lambda fact: str(fact.order)), goal)

    def modified(n: int) -> dict[str, Contestant]:
        return cold_and_warm(
            lambda: modified_equation(RK4, n), lambda series: zeros(value for _, value in series.items())
        )

    return [
        Subject(TREES, cold_and_warm(trees_of_order_12, lambda found: str(len(found[-1]))), 10),
        of_order(ORDER_RK4, lambda: order(RK4)),
        of_order(ORDER_RKF8, lambda: embedded_order(RKF8), 20),
        of_order(ORDER_GAUSS2, lambda: order(GAUSS2)),
        of_order("order of gauss4 by its trees", lambda: order_of(runge_kutta_conditions(METHOD["gauss4"])), 1000),
        of_order("order of gauss4 by theorem", lambda: order(METHOD["gauss4"]), 1000),
        Subject(MODIFIED, modified(PEER_ORDER)),
        Subject("modified equation of rk4 to order 9", modified(9), 1000),
    ]


def r_of(method: Any) -> dict[str, Contestant]:
    """R(z), by the method's tableau or by its nodes; over a number field as it prints."""
    read = lambda r: rational_function(r.num.coeffs(), r.den.coeffs()) if isinstance(r.num, fmpq_poly) else str(r)
    return cold_and_warm(lambda: stability_function(method), read)


def stability() -> list[Subject]:
    """Goals in ms."""

    def both(*facts: Callable[[Any], Any]) -> Callable[[str], Callable[[], Any]]:
        def of(key: str) -> Callable[[], Any]:
            return lambda: [fact(stability_function_of(METHOD[key])) for fact in facts]

        return of

    limits, properties = both(real_limit, imaginary_limit), both(a_stability, l_stability)
    digits = six_digits(lambda limit: root_decimal(limit, 8))
    goals = {"rk4": 0.1, "fehlberg78": 2, "gauss5": 1}
    shown = lambda found: ", ".join(map(digits, found))
    verdicts = lambda found: str(tuple(map(bool, found)))
    return [
        *(Subject(f"R(z) of {key}", r_of(METHOD[key]), goals.get(key)) for key in PLAIN),
        *(Subject(f"both limits of {key}, with R", cold_and_warm(limits(key), shown)) for key in ("rk4", "dop853")),
        *(
            Subject(f"A- and L-stability of {key}", cold_and_warm(properties(key), verdicts))
            for key in ("radau_iia3", "gauss10")
        ),
        Subject(ALGEBRAIC, cold_and_warm(lambda: is_algebraically_stable(RADAU))),
        Subject(SSP_NAME, cold_and_warm(lambda: ssp_coefficient(SSP), digits)),
    ]


def every_fact() -> list[Subject]:
    """Two methods, all of them, and the largest table of one's own; goals in ms."""
    asked = lambda *methods: cold_and_warm(lambda: sum(len(facts(method).data) for method in methods))
    return [
        Subject("every fact of rk4", asked(METHODS["rk4"]), 50),
        Subject("every fact of dop853", asked(METHODS["dop853"]), 30),
        Subject("every fact of the whole catalogue", asked(*METHODS.values()), 4000),
        Subject(TWELVE, asked(twelve_stages()), 5000),
    ]


def twelve_stages() -> RungeKutta:
    """An implicit table of 12 stages without a zero, its coefficients ratios of 13 digits."""
    draw = Random(12)
    number = lambda: Q(draw.randrange(-(10**13), 10**13), draw.randrange(10**12, 10**13))
    a = tuple(tuple(number() for _ in range(12)) for _ in range(12))
    return RungeKutta("dense12", "dense12", 0, "", a, tuple(number() for _ in a), tuple(sum(row) for row in a))


def rounding_bounds() -> list[Subject]:
    """What a bound costs."""
    h, start = Q(1, 4), (Q(1), Q(0))
    tasks: dict[str, Callable[[], Any]] = {
        "bound of one step of rk4": lambda: step_bound(rk4).at(h),
        "sharper bound of one step of rk4, h = 1/4": lambda: fixed_step_bound(rk4, h),
        "bound of one step of dop853": lambda: step_bound(METHODS["dop853"]).at(h),
        "bound of 40 steps of rk4, h = 1/4": lambda: run_bound(rk4, h, 40, start),
    }
    goals = {"bound of one step of dop853": 100.0}
    return [Subject(name, cold_and_warm(task, lambda _: ""), goals.get(name)) for name, task in tasks.items()]


def nodepy_tasks() -> Tasks:
    """Orders in the mode that it calls exact, and in floats where the tableau is irrational; R(z), intervals, SSP."""

    def r(key: str) -> dict[str, Contestant]:
        return {"nodepy": Contestant(nodepy_method(METHOD[key]).stability_function, read_nodepy)}

    def intervals(key: str) -> dict[str, Contestant]:
        method = nodepy_method(METHOD[key])
        task = lambda: (method.real_stability_interval(), method.imaginary_stability_interval())
        return {"nodepy": Contestant(task, lambda found: ", ".join(f"{float(x):.6g}" for x in found))}

    rk4, rkf8 = nodepy_method(RK4), nodepy_method(RKF8, embedded=True)
    return {
        ORDER_RK4: {"nodepy": Contestant(lambda: rk4.order(mode="exact"))},
        ORDER_RKF8: {"nodepy": Contestant(lambda: rkf8.order(mode="exact"))},
        ORDER_GAUSS2: {"nodepy, floats": Contestant(nodepy_method(GAUSS2).order)},
        **{f"R(z) of {key}": r(key) for key in PLAIN[:3]},
        **{f"both limits of {key}, with R": intervals(key) for key in ("rk4", "dop853")},
        SSP_NAME: {"nodepy": Contestant(nodepy_method(SSP).absolute_monotonicity_radius, six_digits())},
        ALGEBRAIC: {"nodepy, floats": Contestant(nodepy_method(RADAU).is_algebraically_stable)},
    }


def kauri_tasks() -> Tasks:
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


def rkkit_tasks() -> Tasks:
    """Exact answers. Its orders sum over all assignments of stages to vertices: only few stages are in reach."""
    asked: dict[str, tuple[Any, Callable[[Any], Any], Callable[[Any], str]]] = {
        ORDER_RK4: (RK4, lambda made: made.order(), str),
        ORDER_GAUSS2: (GAUSS2, lambda made: made.order(), str),
        "R(z) of rk4": (RK4, lambda made: made.stability_function(), read_rkkit),
        "R(z) of fehlberg78": (RKF8, lambda made: made.stability_function(), read_rkkit),
        "A- and L-stability of radau_iia3": (RADAU, lambda made: (made.is_A_stable(), made.is_L_stable()), str),
        ALGEBRAIC: (RADAU, lambda made: made.is_algebraically_stable(), str),
    }
    return {
        name: {"RKkit": Contestant(lambda method=method, ask=ask: ask(rkkit_method(method)), read)}
        for name, (method, ask, read) in asked.items()
    }


PEER_TASKS = {"nodepy": nodepy_tasks, "kauri": kauri_tasks, "RKkit": rkkit_tasks}
TITLES: dict[str, Callable[[], list[Subject]]] = {
    "Trees and orders": trees_and_orders,
    "Stability": stability,
    "Every fact": every_fact,
    "Rounding bounds": rounding_bounds,
}


def with_peers(subject: Subject, tasks: list[Tasks]) -> Subject:
    """The subject with those contestants that the peers have under its name."""
    theirs = {who: contestant for of_peer in tasks for who, contestant in of_peer.get(subject.name, {}).items()}
    return replace(subject, contestants={**subject.contestants, **theirs})


def sections(rounds: int) -> Iterator[Section]:
    """A table for each title, measured beside the peers that are installed."""
    tasks = [make() for name, make in PEER_TASKS.items() if name in installed()]
    for title, subjects in TITLES.items():
        yield timed(title, (with_peers(subject, tasks) for subject in subjects()), rounds)
