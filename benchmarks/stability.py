"""Stability functions, limits, whole fact sheets, beside NodePy where installed: python benchmarks/stability.py

Minimum of several runs in one process, ours with its cache of isolated roots emptied before each. NodePy's R(z) is
exact for rational tableaux, its stability intervals and SSP coefficients are floats by bisection.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import io
import platform
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own `symbolic`, whatever else is installed

from methods.catalogue import METHODS
from methods.schemes import Collocation, RungeKutta
from symbolic.linear import real_roots
from symbolic.linear.facts import FACTS, LinearFacts
from symbolic.linear.implicit_stability import a_stability, l_stability
from symbolic.linear.limits import data, imaginary_limit, real_limit
from symbolic.linear.monotonicity import ssp_coefficient
from symbolic.linear.oscillator import stability_function_of
from symbolic.linear.stability_function import stability_function, stability_function_of_collocation

Task = Callable[[], Any]


def every_fact(key: str) -> None:
    facts = LinearFacts(METHODS[key])
    for name in FACTS:
        facts.value(name)


def whole_catalogue() -> None:
    for key in METHODS:
        every_fact(key)


def explicit(key: str) -> RungeKutta:
    method = METHODS[key]
    if not isinstance(method, RungeKutta):
        raise TypeError(f"{key} is no Runge-Kutta method")
    return method


def nodes_of(key: str) -> Any:
    method = METHODS[key]
    if not isinstance(method, Collocation):
        raise TypeError(f"{key} is not given by its nodes")
    return method.node_polynomial


def limits_of(key: str) -> tuple[Any, Any]:
    r = stability_function_of(METHODS[key])
    if r is None:
        raise TypeError(f"{key} has no stability function")
    return real_limit(r), imaginary_limit(r)


# name: (ours, goal in ms or None, the peer's way from its own method object or None, key)
def tasks() -> dict[str, tuple[Task, float | None, Callable[[Any], Any] | None, str]]:
    def r_of(key: str) -> Task:
        return lambda: stability_function(explicit(key))

    def by_nodes(key: str) -> Task:
        return lambda: stability_function_of_collocation(nodes_of(key))

    def peer_r(method: Any) -> Any:
        return method.stability_function()

    def peer_limits(method: Any) -> Any:
        return method.real_stability_interval(), method.imaginary_stability_interval()

    gauss = stability_function_of(METHODS["gauss10"])
    return {
        "R(z) of rk4": (r_of("rk4"), 0.1, peer_r, "rk4"),
        "R(z) of fehlberg78": (r_of("fehlberg78"), 2, peer_r, "fehlberg78"),
        "R(z) of dop853": (r_of("dop853"), None, peer_r, "dop853"),
        "R(z) of gauss2, over Q(sqrt 3)": (r_of("gauss2"), None, None, "gauss2"),
        "R(z) of gauss4 by its nodes": (by_nodes("gauss4"), 1, None, "gauss4"),
        "R(z) of gauss5 by its nodes": (by_nodes("gauss5"), 1, None, "gauss5"),
        "both limits of rk4, with R": (lambda: limits_of("rk4"), None, peer_limits, "rk4"),
        "both limits of dop853, with R": (lambda: limits_of("dop853"), None, peer_limits, "dop853"),
        "A- and L-stability of gauss10": (lambda: (a_stability(gauss), l_stability(gauss)), None, None, "gauss10"),
        "SSP coefficient of ssprk104": (
            lambda: ssp_coefficient(explicit("ssprk104")),
            None,
            lambda method: method.absolute_monotonicity_radius(),
            "ssprk104",
        ),
        "every linear fact of rk4": (lambda: every_fact("rk4"), 50, None, "rk4"),
        "every linear fact of dop853": (lambda: every_fact("dop853"), 2000, None, "dop853"),
        f"every linear fact of {len(METHODS)} methods": (whole_catalogue, 60000, None, "rk4"),
    }


def least(task: Task, budget: float) -> float:
    """The least time of one call in milliseconds, over at least one call and about `budget` seconds."""
    best, spent = float("inf"), 0.0
    while spent < budget or best == float("inf"):
        real_roots._real_balls.cache_clear()
        start = time.perf_counter()
        task()
        taken = time.perf_counter() - start
        best, spent = min(best, taken), spent + taken
    return 1e3 * best


def peer_method(key: str, *, exact: bool = True) -> Any:
    """The same tableau as NodePy's object, exact or in floats; None where NodePy is not installed."""
    if importlib.util.find_spec("nodepy") is None:
        return None
    import numpy as np
    import sympy
    from nodepy import rk

    method, kind = explicit(key), object if exact else float
    number = sympy.Rational if exact else lambda p, q: p / q
    rows = [[number(*x.as_integer_ratio()) for x in row] for row in (*method.a, method.b)]
    return rk.ExplicitRungeKuttaMethod(np.array(rows[:-1], dtype=kind), np.array(rows[-1], dtype=kind))


def timed_peer(way: Callable[[Any], Any] | None, key: str, budget: float) -> float | None:
    if way is None:
        return None
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        method = peer_method(key)
        return None if method is None else least(lambda: way(method), budget)


def table(budget: float) -> str:
    lines = [f"{'':34}{'ms':>10}{'goal':>8}{'NodePy':>11}{'ratio':>8}"]
    for name, (ours, goal, way, key) in tasks().items():
        taken, peer = least(ours, budget), timed_peer(way, key, budget)
        wanted = "" if goal is None else f"{goal:g}"
        beside = "" if peer is None else f"{peer:11.3f}{peer / taken:8.0f}"
        missed = "" if goal is None or taken <= goal else "  missed"
        lines.append(f"{name:34}{taken:10.3f}{wanted:>8}{beside}{missed}")
    return "\n".join(lines)


def answers() -> str:
    """Where the answers differ: real limits of R that touches -1 or 1; NodePy needs minutes for 40 stages."""
    lines = ["", f"{'real limit':34}{'ours':>10}{'':>8}{'NodePy':>11}"]
    for key in ("rk4", "chebyshev10_1", "ssprk40_2"):
        ours = data(limits_of(key)[0], 8)["decimal"]
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            method = peer_method(key, exact=False) if explicit(key).stages <= 10 else None
            peer = "" if method is None else f"{float(method.real_stability_interval()):.6g}"
        lines.append(f"{key:34}{ours:>10}{'':>8}{peer:>11}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--budget", type=float, default=0.3, metavar="SECONDS", help="per row and side")
    budget = parser.parse_args().budget
    print(table(budget))
    print(answers())
    print(f"\n{platform.python_implementation()} {platform.python_version()}, {platform.machine()}")


if __name__ == "__main__":
    main()
