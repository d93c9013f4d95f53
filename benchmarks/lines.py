"""The Brusselator on a line of places, each coupled to its neighbours, to a given error: in a band, and without one.

That of hairer-wanner-1996, IV.1, with diffusion 1/50, to t = 10: the rates of two numbers at each place. The error is
the largest of a component, beside a run of Radau IIA with five stages at tolerance 1e-12. Everybody's tolerance is the
largest that reaches it. SciPy's solvers have the rates in NumPy, on whole arrays, Radau the places that are not zero,
and LSODA the band.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache, partial
from importlib.util import find_spec
from math import pi, sin
from time import process_time
from typing import Any

import numpy as np

from benchmarks.harness import Section, Subject, by_scipy, timed, with_largest_tolerance
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.steps import field_loops
from driftproof.numeric.steps.controlled import ControlledRun, controlled_runner
from driftproof.numeric.steps.elimination import FULL

METHOD, END, ERROR = METHODS["radau_iia3"], 10.0, 1e-6
PLACES = (50, 500)
# Beyond, a full matrix takes minutes.
FULL_PLACES = 50
TOLERANCES = tuple(10 ** (-k / 2) for k in range(9, 19))


def brusselator(places: int) -> VectorField:
    """u and v at each place in turn; 1 and 3 at the ends."""
    name = lambda i, k: f"y{2 * i + k}" if 0 <= i < places else str(1 + 2 * k)
    rates = []
    for i in range(places):
        u, v = name(i, 0), name(i, 1)
        moved = [f"spread * ({name(i - 1, k)} - 2 * {name(i, k)} + {name(i + 1, k)})" for k in range(2)]
        rates += [f"1 + {u} * {u} * {v} - 4 * {u} + {moved[0]}", f"3 * {u} - {u} * {u} * {v} + {moved[1]}"]
    return VectorField(tuple(rates), (("spread", Fraction((places + 1) ** 2, 50)),))


def start(places: int) -> tuple[float, ...]:
    """u = 1 + sin 2πx, v = 3."""
    return tuple(x for i in range(places) for x in (1 + sin(2 * pi * (i + 1) / (places + 1)), 3.0))


def rate_on_arrays(places: int) -> Callable[[float, Any], Any]:
    """The same rates, of all places at once."""
    spread = (places + 1) ** 2 / 50

    def rate(t: float, y: Any) -> Any:
        (u, v), moved = (y[0::2], y[1::2]), np.empty_like(y)
        for k, x in enumerate((u, v)):
            wide = np.concatenate(([1 + 2 * k], x, [1 + 2 * k]))
            moved[k::2] = spread * (wide[:-2] - 2 * x + wide[2:])
        moved[0::2] += 1 + u * u * v - 4 * u
        moved[1::2] += 3 * u - u * u * v
        return moved

    return rate


@cache
def in_a_band(places: int) -> ControlledRun:
    """As it is found."""
    return controlled_runner(METHOD, brusselator(places), compiled=True)


@cache
def without_a_band(places: int) -> ControlledRun:
    """As if every rate read everything."""
    found, field_loops.band_of = field_loops.band_of, lambda reads: FULL
    field_loops.field_writers.cache_clear()
    try:
        return controlled_runner(METHOD, brusselator(places), compiled=True)
    finally:
        field_loops.band_of = found
        field_loops.field_writers.cache_clear()


def by_us(run: ControlledRun, places: int, tolerance: float) -> Callable[[], Any]:
    """The last state, and the number of steps."""
    return lambda: (np.array(run(start(places), END, tolerance, tolerance)), run.steps)


def scipy_solver(name: str, places: int, tolerance: float) -> Callable[[], Any]:
    """The same of a solver of SciPy."""
    from scipy.sparse import diags

    n = 2 * places
    band = {"jac_sparsity": diags([1.0] * 5, range(-2, 3), shape=(n, n))}
    known = {"lband": 2, "uband": 2} if name == "LSODA" else band
    given = {"rtol": tolerance, "atol": tolerance, **known}
    return lambda: by_scipy(rate_on_arrays(places), start(places), END, name, **given)


@cache
def reference(places: int) -> Any:
    """The last state."""
    run = controlled_runner(METHODS["radau_iia5"], brusselator(places), compiled=True)
    return np.array(run(start(places), END, 1e-12, 1e-12))


def error_of(places: int, state: Any) -> float:
    """The largest error of a component."""
    return float(np.abs(state - reference(places)).max())


def subjects() -> Iterator[Subject]:
    """What can be had here."""
    for places in PLACES:
        solvers: dict[str, Callable[[float], Callable[[], Any]]] = {
            "ours": lambda tolerance, n=places: by_us(in_a_band(n), n, tolerance)
        }
        if places <= FULL_PLACES:
            solvers["ours, full"] = lambda tolerance, n=places: by_us(without_a_band(n), n, tolerance)
        for name in ("Radau", "LSODA") if find_spec("scipy") else ():
            solvers[f"scipy, {name}"] = lambda tolerance, n=places, name=name: scipy_solver(name, n, tolerance)
        yield Subject(
            f"Brusselator, {places} places, error {ERROR:.0e}".replace("e-0", "e-"),
            {
                who: with_largest_tolerance(solver, TOLERANCES, partial(error_of, places), ERROR)
                for who, solver in solvers.items()
            },
        )


def sections(rounds: int) -> Iterator[Section]:
    """Measured; nothing without numba."""
    if find_spec("numba") is not None:
        yield timed("Lines of neighbours", subjects(), rounds, process_time)
