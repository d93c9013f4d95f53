"""Stiff problems to a given error, by compiled Radau IIA in controlled steps, and by SciPy and diffrax.

The error is the distance of the last state from the reference's digits. Of everybody the tolerance is the largest that
reaches it, of those tried, and absolute tolerances are 10⁻⁴ of the relative ones. What is compiled is compiled before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.util import find_spec
from math import inf, isfinite
from time import process_time
from typing import Any

from benchmarks.harness import Contestant, Section, Subject, timed
from driftproof.methods.catalogue import METHODS
from driftproof.methods.vector_fields import FUNCTIONS
from driftproof.numeric.advance import field_rate, float_start
from driftproof.numeric.controlled import controlled_runner
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import distance_from_digits

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


def by_scipy(name: str) -> Callable[[Problem, float], Callable[[], Any]]:
    """The same of a solver of SciPy."""
    from scipy.integrate import solve_ivp

    def of(problem: Problem, tolerance: float) -> Callable[[], Any]:
        rate, start, span = field_rate(problem.field), float_start(problem), (0.0, float(problem.t))

        def task() -> Any:
            found = solve_ivp(rate, span, start, name, rtol=tolerance, atol=tolerance * 1e-4)
            return tuple(map(float, found.y[:, -1])), len(found.t) - 1

        return task

    return of


def by_diffrax(problem: Problem) -> Callable[[Problem, float], Callable[[], Any]]:
    """The same of diffrax's Kvaerno5, compiled once, for all tolerances."""
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    rate = field_rate(problem.field, {name: getattr(jax.numpy, name) for name in FUNCTIONS})
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


def at_its_best(problem: Problem, solver: Callable[[Problem, float], Callable[[], Any]]) -> Contestant:
    """The solver with the largest tolerance with which it reaches the error; with the smallest if none does."""
    digits = problem.reference.states[-1]
    error = lambda found: distance_from_digits(found[0], digits) if all(map(isfinite, found[0])) else inf
    tasks = (solver(problem, tolerance) for tolerance in TOLERANCES)
    task = next((task for task in tasks if error(task()) <= ERRORS[problem.key]), solver(problem, TOLERANCES[-1]))
    return Contestant(task, lambda found: f"{error(found):.1e}, {found[1]} steps")


def subjects() -> Iterator[Subject]:
    """What can be had here."""
    solvers = {f"scipy, {name}": by_scipy(name) for name in ("Radau", "BDF")} if find_spec("scipy") else {}
    for key, error in ERRORS.items():
        contestants = {"ours": ours, **solvers}
        if find_spec("diffrax"):
            contestants["diffrax, Kvaerno5"] = by_diffrax(PROBLEMS[key])
        yield Subject(
            f"{key}, error {error:.0e}; ours: {METHOD.key}".replace("e-0", "e-"),
            {who: at_its_best(PROBLEMS[key], solver) for who, solver in contestants.items()},
            None,
            {("ours", "scipy, Radau"): SHARE},
        )


def sections(rounds: int) -> Iterator[Section]:
    """Measured; nothing without numba."""
    if find_spec("numba") is not None:
        yield timed("Stiff problems", subjects(), rounds, process_time)
