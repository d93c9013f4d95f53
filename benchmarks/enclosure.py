"""Solutions enclosed, beside the floats of SciPy's DOP853 and Radau at tight tolerances: about three minutes.

Right-hand sides are Python functions as a user writes them. `digits` are those of the largest error of the float
solution that are proved. Times are CPU seconds; OPENBLAS_NUM_THREADS=1 keeps small matrices on one core.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from importlib.util import find_spec
from math import inf
from time import process_time
from typing import Any

import numpy as np

from benchmarks.harness import Contestant, Goal, Section, Subject, measure, milliseconds
from driftproof.enclosure.certificate import Certificate
from driftproof.enclosure.certify import certify
from driftproof.enclosure.fields.text_fields import field_function
from driftproof.enclosure.solution.solutions import enclose_solution
from driftproof.numeric.problems.catalogue import PROBLEMS

# The tolerances of the float solutions, and the digits of their errors that are wanted.
TIGHT, RADAU, DIGITS = 1e-13, 1e-8, 12


@dataclass(frozen=True)
class Run:
    """y' = f(t, y) from a start at t = 0; to be enclosed within so many milliseconds where a number is given."""

    f: Callable[[Any, Any], Any]
    start: tuple[float, ...]
    end: float
    goal: float | None = None


def pendulum(t: Any, y: Any) -> Any:
    return [y[1], -np.sin(y[0])]


def van_der_pol(t: Any, y: Any) -> Any:
    return [y[1], (1 - y[0] ** 2) * y[1] - y[0]]


def brusselator(t: Any, y: Any) -> Any:
    return [1 + y[0] ** 2 * y[1] - 4 * y[0], 3 * y[0] - y[0] ** 2 * y[1]]


def laub_loomis(t: Any, y: Any) -> Any:
    a, b, c, d, e, f, g = y
    return [
        *(1.4 * c - 0.9 * a, 2.5 * e - 1.5 * b, 0.6 * g - 0.8 * b * c, 2 - 1.3 * c * d),
        *(0.7 * a - d * e, 0.3 * a - 3.1 * f, 1.8 * f - 1.5 * b * g),
    ]


def kepler(t: Any, y: Any) -> Any:
    cubed = (y[0] ** 2 + y[1] ** 2) ** 1.5
    return [y[2], y[3], -y[0] / cubed, -y[1] / cubed]


def lorenz(t: Any, y: Any) -> Any:
    return [10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]]


def robertson(t: Any, y: Any) -> Any:
    slow, fast, fastest = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return [fast - slow, slow - fast - fastest, fastest]


RUNS = {
    "pendulum, t = 10": Run(pendulum, (2.0, 0.0), 10, 1000),
    "pendulum, t = 100": Run(pendulum, (2.0, 0.0), 100, 2000),
    "van der Pol, mu = 1, t = 20": Run(van_der_pol, (2.0, 0.0), 20, 1000),
    "Brusselator, t = 20": Run(brusselator, (1.5, 3.0), 20, 1000),
    "Laub-Loomis, t = 20": Run(laub_loomis, (1.2, 1.05, 1.5, 2.4, 1.0, 0.1, 0.45), 20, 1000),
    "Kepler, e = 0.5, t = 10": Run(kepler, (0.5, 0.0, 0.0, 3**0.5), 10, 1000),
    "Lorenz, t = 20": Run(lorenz, (1.0, 1.0, 1.0), 20, 4000),
}
STIFF = {
    "Robertson, t = 10^11": Run(robertson, (1.0, 0.0, 0.0), 1e11, 2000),
    **{
        key: Run(field_function(PROBLEMS[key].field), tuple(map(float, PROBLEMS[key].start)), float(PROBLEMS[key].t))
        for key in ("hires", "van_der_pol_1e3", "oregonator")
    },
}
NOT_STIFF = {
    key: Run(field_function(problem.field), tuple(map(float, problem.start)), float(problem.t))
    for key, problem in PROBLEMS.items()
    if not problem.stiff
}


def solved(run: Run, method: str, tolerance: float) -> Any:
    """SciPy's solution, with all its steps."""
    from scipy.integrate import solve_ivp

    return solve_ivp(run.f, (0, run.end), run.start, method=method, rtol=tolerance, atol=tolerance * 1e-3)


def digits(found: Certificate) -> int:
    """How many digits of the largest error are proved."""
    i, j = found.worst
    return int(found.errors[i][j].rel_accuracy_bits() * 0.30103)


def measured(title: str, runs: Mapping[str, Run], method: str, tolerance: float, rounds: int) -> Section:
    """Each run enclosed and, where there is SciPy, solved in floats; whose error is then proved."""
    header = [
        "",
        "minimum",
        "median",
        "steps",
        "radius",
        f"{method} {tolerance:.0e}",
        "ours over it",
        "its error",
        "digits",
    ]
    rows, goals = [header], []
    for name, run in runs.items():
        enclosed = partial(enclose_solution, run.f, [*map(Fraction, run.start)], [Fraction(0), Fraction(run.end)])
        tasks = [enclosed, *([partial(solved, run, method, tolerance)] if find_spec("scipy") else [])]
        asked = Subject(name, {str(task): Contestant(task, lambda _: "") for task in tasks})
        (taken,) = measure([asked], rounds, 0.0, inf, process_time)
        ours, *theirs = taken.times.values()
        found, row = enclosed(), [name, *(milliseconds(1000 * x) for x in (ours.best, ours.median))]
        row += [str(found.steps), f"{max(float(x.rad()) for state in found.states for x in state):.0e}"]
        for times in theirs:
            proved = certify(run.f, solved(run, method, tolerance))
            row += [milliseconds(1000 * times.best), f"{ours.best / times.best:.3g}"]
            row += [f"{float(proved.largest_error):.1e}", str(digits(proved))]
            goals.append(Goal(f"{name}: digits of the error", f"≥ {DIGITS}", row[-1], digits(proved) >= DIGITS))
        if run.goal is not None:
            goals.append(Goal(name, f"≤ {milliseconds(run.goal)}", row[1], 1000 * ours.best <= run.goal))
        rows.append(row)
    return Section(title, rows, goals)


def sections(rounds: int) -> Iterator[Section]:
    """What the goals name, stiff problems, and the catalogue."""
    yield measured("Enclosures, CPU time", RUNS, "DOP853", TIGHT, rounds)
    yield measured("Enclosures of stiff problems, CPU time", STIFF, "Radau", RADAU, rounds)
    yield measured("Enclosures over the catalogue, CPU time", NOT_STIFF, "DOP853", TIGHT, 1)
