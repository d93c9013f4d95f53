"""Run a scene of either kind: of the oscillator, or of a problem, whose state is compared with a reference's digits."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial
from math import isfinite
from typing import Any

import numpy as np

from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.readouts import (
    ENERGY_ERROR,
    LARGEST_CHANGE,
    LARGEST_ERROR,
    LARGEST_STATE_ERROR,
    ON_THE_WAY,
    TRAJECTORY,
)
from driftproof.numeric.run import (
    Counter,
    NonFiniteState,
    Readouts,
    RunEnded,
    finite,
    require_float_steps,
    run_method,
    times_of_steps,
)
from driftproof.numeric.scenes import Scene


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
    from driftproof.numeric import reference_errors as off
    from driftproof.numeric.advance import State, advance, evaluations_of, float_start, float_step
    from driftproof.numeric.stability import STEPS_BETWEEN_CHECKS, observe

    method = scene.method(key)
    run, start = advance(method, problem), float_start(problem)
    path, ticks = [start], enumerate(counter(scene.steps), start=1)
    keep = not {*ON_THE_WAY}.isdisjoint(scene.readouts)

    def way() -> off.Way:
        return off.Way.of((n * h for n in range(len(path))), path)

    def look(done: int, y: State) -> None:
        path.extend([y] if keep else [])
        next(n for n, _ in ticks if n == done)

    apart = 1 if keep else STEPS_BETWEEN_CHECKS
    h = float_step(scene.t, scene.steps)
    seen = observe(run, start, h, scene.steps, apart=apart, look=look)
    if seen.failed_after is not None:
        if not all(map(isfinite, seen.state)):
            raise NonFiniteState(seen.failed_after, tuple(seen.state))
        raise RunEnded(f"the run ends at step {seen.failed_after}: {seen.remark}")
    deque(ticks, maxlen=0)  # a progress bar closes at its end
    digits = problem.reference.states[problem.reference.times.index(scene.t)]
    energy = partial(off.decimal_energy, problem)
    read: dict[str, Callable[[], Any]] = {
        "final_state": lambda: tuple(seen.state),
        "exact_state": lambda: tuple(map(float, digits)),
        "state_error": lambda: off.distance_from_digits(seen.state, digits),
        "energy": lambda: float(energy(seen.state)),
        "energy_change": lambda: float(energy(seen.state) - energy(problem.start)),
        ENERGY_ERROR: lambda: float(energy(seen.state) - off.energy_of_solution(problem, scene.t)),
        LARGEST_STATE_ERROR: lambda: off.largest_state_error(problem, way()),
        LARGEST_ERROR: lambda: off.largest_energy_error(problem, way()),
        LARGEST_CHANGE: lambda: off.largest_energy_change(problem, np.array([[*y] for y in path])),
        "steps": lambda: scene.steps,
        "evaluations": lambda: evaluations_of(run, method, scene.steps),
        TRAJECTORY: lambda: (times_of_steps(scene.h, scene.steps), np.array(path)),
    }
    return {name: finite(name, read[name], "the final state") for name in scene.readouts}
