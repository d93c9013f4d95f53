"""Stiff problems to a given error, by compiled Radau IIA in controlled steps, and by SciPy and diffrax.

The error is the distance of the last state from the reference's digits. Of everybody the tolerance is the largest that
reaches it, of those tried, and absolute tolerances are 10⁻⁴ of the relative ones. What is compiled is compiled before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from math import inf, isfinite
from time import process_time
from typing import Any

from benchmarks.harness import Section, Subject, by_scipy, timed, with_largest_tolerance
from driftproof.methods.catalogue import METHODS
from driftproof.numeric.advance import field_rate, float_start
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import distance_from_digits
from driftproof.numeric.steps.controlled import controlled_runner
from driftproof.numeric.steps.engine import functions_of

METHOD = METHODS["radau_iia3"]
# The errors that are asked for; both problems are of size 1 at most, Robertson's first two components below 1e-7.
ERRORS = {"robertson": 1e-13, "hires": 1e-9}
TOLERANCES = tuple(10 ** (-k / 8) for k in range(16, 81))
# The most that our time may be of SciPy's Radau's.
SHARE = 1 / 20


def ours(problem: Problem, tolerance: float) -> Callable[[], Any]:
    """The last state, and the number of steps."""
    run = controlled_runner(METHOD, problem.field, compiled=True)
    start, end = float_start(problem), float(problem.t)
    return lambda: (run(start, end, tolerance, tolerance * 1e-4), run.steps)


def scipy_solver(name: str, problem: Problem, tolerance: float) -> Callable[[], Any]:
    """The same of a solver of SciPy."""
    given = {"rtol": tolerance, "atol": tolerance * 1e-4}
    return partial(by_scipy, field_rate(problem.field), float_start(problem), float(problem.t), name, **given)


def by_diffrax(problem: Problem) -> Callable[[Problem, float], Callable[[], Any]]:
    """The same of diffrax's Kvaerno5, compiled once, for all tolerances."""
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    rate = field_rate(problem.field, functions_of(jax.numpy))
    start, end = jax.numpy.array(float_start(problem)), float(problem.t)

    def solve(tolerance: Any) -> Any:
        term = diffrax.ODETerm(lambda t, y, _: jax.numpy.stack([jax.numpy.asarray(x) for x in rate(t, y)]))
        control = diffrax.PIDController(rtol=tolerance, atol=tolerance * 1e-4)
        given = {"saveat": diffrax.SaveAt(t1=True), "stepsize_controller": control, "max_steps": 10**5, "throw": False}
        found = diffrax.diffeqsolve(term, diffrax.Kvaerno5(), 0.0, end, None, start, **given)
        return found.ys[0], found.stats["num_accepted_steps"]

    compiled = jax.jit(solve)

    def of(_: Problem, tolerance: float) -> Callable[[], Any]:
        def task() -> Any:
            y, steps = compiled(tolerance)
            return tuple(map(float, y)), int(steps)

        return task

    return of


def error_of(problem: Problem, state: Any) -> float:
    """The distance from the reference; infinite for a state that is not finite."""
    found = tuple(map(float, state))
    return distance_from_digits(found, problem.reference.states[-1]) if all(map(isfinite, found)) else inf


def subjects() -> Iterator[Subject]:
    """What can be had here."""
    solvers = {f"scipy, {name}": partial(scipy_solver, name) for name in ("Radau", "BDF")} if find_spec("scipy") else {}
    for key, error in ERRORS.items():
        problem, contestants = PROBLEMS[key], {"ours": ours, **solvers}
        if find_spec("diffrax"):
            contestants["diffrax, Kvaerno5"] = by_diffrax(problem)
        yield Subject(
            f"{key}, error {error:.0e}; ours: {METHOD.key}".replace("e-0", "e-"),
            {
                who: with_largest_tolerance(partial(solver, problem), TOLERANCES, partial(error_of, problem), error)
                for who, solver in contestants.items()
            },
            None,
            {("ours", "scipy, Radau"): SHARE},
        )


def sections(rounds: int) -> Iterator[Section]:
    """Measured; nothing without numba."""
    if find_spec("numba") is not None:
        yield timed("Stiff problems", subjects(), rounds, process_time)
