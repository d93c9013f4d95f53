"""Runs of a method on a problem, and what they are said to be: right, wrong, ended, drifting."""

from __future__ import annotations

import math
from fractions import Fraction as Q
from itertools import pairwise

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.numeric.advance import State, advance, float_start, float_step
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import EXACT, Problem, Reference
from driftproof.numeric.reference_errors import decimal_energy, distance_from_digits, largest_state_size
from driftproof.numeric.stability import observe

DECAY = Problem(
    "decay",
    "y' = -y",
    VectorField(("rate * y0",), (("rate", Q(-1)),)),
    (Q(1),),
    Reference((Q(1),), (("0.36787944117144232160",),), EXACT, "1/e"),
    "test",
)
TABLEAUX = {key: m for key, m in METHODS.items() if isinstance(m, RungeKutta | Collocation)}
EXPLICIT = [key for key, m in TABLEAUX.items() if m.explicit]
IMPLICIT = [key for key in TABLEAUX if key not in EXPLICIT]
RIGHT, WRONG, ENDED = "right", "wrong", "ended"


def states(key: str, name: str, steps: int, pieces: int = 8, t: Q | None = None) -> list[State]:
    """The start and the states after each piece of a run to t; those up to where it ended."""
    problem = PROBLEMS[name]
    run, y, h = advance(METHODS[key], problem), float_start(problem), float_step(t or problem.t, steps)
    found = [y]
    for first, last in pairwise(i * steps // pieces for i in range(pieces + 1)):
        try:
            y = run(y, h, first, last)
        except (ArithmeticError, ValueError):
            break
        if not all(map(math.isfinite, y)):
            break
        found.append(y)
    return found


def fate(key: str, name: str, steps: int, tolerance: float, t: Q | None = None) -> str:
    """RIGHT within the tolerance at t, a time of the reference's."""
    reference = PROBLEMS[name].reference
    found = states(key, name, steps, 1, t)
    if len(found) == 1:
        return ENDED
    digits = reference.states[reference.times.index(t or PROBLEMS[name].t)]
    return RIGHT if distance_from_digits(found[-1], digits) < tolerance else WRONG


def energy_errors(key: str, name: str, steps: int, pieces: int = 8) -> list[float]:
    problem = PROBLEMS[name]
    before = decimal_energy(problem, problem.start)
    return [float(decimal_energy(problem, y) - before) for y in states(key, name, steps, pieces)[1:]]


def growth(key: str, name: str, steps: int, times: int = 1) -> float:
    """The largest size of a state over `times` times the interval, over the solution's; infinite where it ends."""
    problem = PROBLEMS[name]
    seen = observe(advance(METHODS[key], problem), float_start(problem), float_step(problem.t, steps), times * steps)
    return math.inf if seen.failed_after is not None else seen.largest / largest_state_size(problem)


def drifts(errors: list[float]) -> bool:
    """The last quarter is far worse than the first."""
    return max(map(abs, errors[-2:])) > 2 * max(map(abs, errors[:2]))
