"""A scene's run, whatever it is of: the oscillator, or a problem, whose readouts are beside its reference's digits."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import isfinite
from typing import Any

import numpy as np

from driftproof.methods.tableau_file import method_of
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.run import (
    Counter,
    NonFiniteReadout,
    NonFiniteState,
    Readouts,
    RunEnded,
    demand_few,
    run_method,
    times_of_steps,
)
from driftproof.numeric.scenes import TRAJECTORY, Scene


def run_scene(scene: Scene, key: str, counter: Counter = range) -> Readouts:
    """The scene's readouts for the method `key`, in binary64; nothing else is computed or kept.

    Of a problem, `exact_state` is the reference's, rounded once, and `state_error` the Euclidean distance of the floats
    from its digits. Raises ValueError as `run_method`, and for a method that does not apply to the problem; RunEnded.
    """
    if scene.problem is None:
        return run_method(scene, key, counter)
    demand_few(scene.steps)
    return _run_problem(scene, scene.problem, key, counter)


def _run_problem(scene: Scene, problem: Problem, key: str, counter: Counter) -> Readouts:
    from driftproof.numeric.advance import (
        advance,
        error_summary,
        evaluations_of,
        float_start,
        step_times,
    )
    from driftproof.numeric.reference_errors import decimal_energy, distance_from_digits

    method = method_of(key)
    run, (h, _) = advance(method, problem), step_times(scene.t, scene.steps)
    y = float_start(problem)
    path = [y]
    for i in counter(scene.steps):
        try:
            y = run(y, h, i, i + 1)
        except (ArithmeticError, ValueError) as error:
            raise RunEnded(f"the run ends at step {i + 1}: {error_summary(error)}") from None
        if not all(map(isfinite, y)):
            raise NonFiniteState(i + 1, y)
        if TRAJECTORY in scene.readouts:
            path.append(y)
    digits = problem.reference.states[problem.reference.times.index(scene.t)]
    energy = partial(decimal_energy, problem)
    read: dict[str, Callable[[], Any]] = {
        "final_state": lambda: y,
        "exact_state": lambda: tuple(map(float, digits)),
        "state_error": lambda: distance_from_digits(y, digits),
        "energy": lambda: float(energy(y)),
        "energy_change": lambda: float(energy(y) - energy(problem.start)),
        "steps": lambda: scene.steps,
        "evaluations": lambda: evaluations_of(run, method, problem, scene.steps),
        TRAJECTORY: lambda: (times_of_steps(scene.h, scene.steps), np.array(path)),
    }
    return {name: _finite(name, read[name]()) for name in scene.readouts}


def _finite(name: str, value: Any) -> Any:
    if isinstance(value, float) and not isfinite(value):
        raise NonFiniteReadout(f"{name} overflows binary64 at the final state")
    return value
