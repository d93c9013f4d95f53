"""Run a scene of either kind: of the oscillator, or of a problem, whose state is compared with a reference's digits."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import islice
from math import isfinite
from time import perf_counter
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
    require_float_steps,
    run_method,
    times_of_steps,
)
from driftproof.numeric.scenes import TRAJECTORY, Scene

# Seconds that progress may wait: the steps of one call double until it lasts as long.
UNSEEN = 0.05


def run_scene(scene: Scene, key: str, counter: Counter = range) -> Readouts:
    """The scene's readouts for the method `key`, in binary64; nothing else is computed or kept.

    For a problem, `exact_state` is the reference rounded once, and `state_error` the Euclidean distance of the floats
    from its digits. Raises RunEnded, and ValueError as `run_method` and for a method that does not apply to the
    problem.
    """
    if scene.problem is None:
        return run_method(scene, key, counter)
    require_float_steps(scene.steps)
    return _run_problem(scene, scene.problem, key, counter)


def _run_problem(scene: Scene, problem: Problem, key: str, counter: Counter) -> Readouts:
    from driftproof.numeric.advance import State, advance, error_summary, evaluations_of, float_start, step_times
    from driftproof.numeric.reference_errors import decimal_energy, distance_from_digits

    method = method_of(key)
    run, (h, _) = advance(method, problem), step_times(scene.t, scene.steps)
    y, done = float_start(problem), 0
    path, ticks = [y], iter(counter(scene.steps))

    def advanced(y: State, first: int, last: int) -> State:
        """Take steps first to last - 1 in one call; if it fails, singly, to raise the error of the first to fail."""
        try:
            after = run(y, h, first, last)
            if all(map(isfinite, after)):
                return after
            ended: RunEnded = NonFiniteState(last, after)
        except (ArithmeticError, ValueError) as error:
            ended = RunEnded(f"the run ends at step {last}: {error_summary(error)}")
        for i in range(first, last) if last > first + 1 else ():
            y = advanced(y, i, i + 1)
        raise ended

    together, keep = 1, TRAJECTORY in scene.readouts
    while taken := sum(1 for _ in islice(ticks, together)):
        before = perf_counter()
        y, done = advanced(y, done, done + taken), done + taken
        path += [y] if keep else []
        together *= 1 if keep or perf_counter() - before > UNSEEN else 2
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
    found = {name: read[name]() for name in scene.readouts}
    for name, value in found.items():
        if isinstance(value, float) and not isfinite(value):
            raise NonFiniteReadout(f"{name} overflows binary64 at the final state")
    return found
