"""A catalogue method as it runs on a problem: its states, counted evaluations, and the calls that are timed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from importlib.util import find_spec
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from driftproof.methods.catalogue import Entry, FurtherMethod
from driftproof.numeric.advance import Advance, State, advance, evaluations_of, float_start, float_step
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import Way
from driftproof.numeric.steps.engine import BLOCK, EnsembleRun, FloatArray, Run, array_runner, compiled_ensemble_runner
from driftproof.numeric.steps.implicit import compiled_implicit_ensemble_runner

# What is timed: one trajectory, compiled or in plain Python, and a state of an ensemble of MEMBERS.
COMPILED, PYTHON, ENSEMBLE = "compiled", "python", "ensemble"
KINDS = (COMPILED, PYTHON, ENSEMBLE)
MEMBERS = BLOCK
# Errors of implicit methods are computed in Python up to so many steps: some seconds, as compiling takes ten.
COMPILED_FROM = 2**10
# A run whose way is compared is looked at after each step or, if there are more than so many, after each k-th. Chosen:
# some tenths of a second.
MOST_LOOKS = 2**16

# call(steps) -> a function without arguments that returns the final state; calling it is what is timed.
TimedCall: TypeAlias = Callable[[int], Callable[[], State]]


@dataclass(frozen=True)
class CountedRun:
    """A run of N steps: its states at those times of `steps_at_known_times`, evaluations of f, its way, and itself."""

    states: Mapping[Fraction, State]
    evaluations: int
    way: Way | None = None
    run: Advance | None = None


@dataclass(frozen=True)
class Integrator:
    """A method on a problem.

    `run(steps)` is for errors, and raises ArithmeticError or ValueError if floats overflow or stages are not solved.
    `calls` maps each kind to what is timed; a call of kind ENSEMBLE integrates MEMBERS states, all from the same start.
    `absent` says why a kind is missing.
    """

    run: Callable[[int], CountedRun]
    calls: Mapping[str, TimedCall]
    absent: Mapping[str, str]


def has_numba() -> bool:
    """True if the extra `fast` is installed."""
    return find_spec("numba") is not None


def kinds_of_trajectories() -> tuple[str, ...]:
    """The kinds in which one trajectory can be timed here, the fastest last."""
    return (PYTHON, COMPILED) if has_numba() else (PYTHON,)


def integrator(method: Entry, problem: Problem, *, compiled: bool = False) -> Integrator:
    """The method as it runs on the problem; `compiled` adds numba's runs, which give the errors of explicit methods.

    Errors of implicit methods are computed in Python up to COMPILED_FROM steps, which takes less time than compiling.
    Raises MethodError with the reason if the method does not apply, such as a splitting on a problem of first order.
    """
    fast = compiled and has_numba()
    runs = {PYTHON: advance(method, problem), **({COMPILED: advance(method, problem, compiled=True)} if fast else {})}
    start = float_start(problem)

    def run(steps: int) -> CountedRun:
        best = advance(method, problem, compiled=fast and (method.explicit or steps > COMPILED_FROM))
        apart = -(-steps // MOST_LOOKS) if problem.reference.dense else steps
        known, reached, h = steps_at_known_times(problem, steps), {0: start}, float_step(problem.t, steps)
        for first, last in pairwise(sorted({0, *known, *range(apart, steps, apart)})):
            reached[last] = best(reached[first], h, first, last)
        del reached[0]
        way = Way.of((n * h for n in reached), reached.values()) if problem.reference.dense else None
        states = {t: reached[n] for n, t in known.items()}
        return CountedRun(states, evaluations_of(best, method, steps), way, best)

    def call(run: Advance, steps: int) -> Callable[[], State]:
        return partial(run, start, float_step(problem.t, steps), 0, steps)

    calls: dict[str, TimedCall] = {kind: partial(call, run) for kind, run in runs.items()}
    absent = {}
    if compiled and not fast:
        absent[COMPILED] = "numba is not installed; pip install 'driftproof[fast]'"
    ensemble = _ensemble(method, problem, fast=fast)
    if isinstance(ensemble, str):
        absent[ENSEMBLE] = ensemble
    else:
        calls[ENSEMBLE] = ensemble
    return Integrator(run, calls, absent)


def steps_at_known_times(problem: Problem, steps: int) -> dict[int, Fraction]:
    """The reference's times by their numbers of steps, if that is a whole number."""
    parts = [(t, t / problem.t * steps) for t in problem.reference.times]
    return {int(part): t for t, part in parts if part.denominator == 1}


def _ensemble(method: Entry, problem: Problem, *, fast: bool) -> TimedCall | str:
    """The call for MEMBERS states, or the reason why there is none."""
    if isinstance(method, FurtherMethod):
        return "multistep and Rosenbrock methods are only timed for one trajectory"
    start = np.array(float_start(problem))[:, None]
    run: EnsembleRun
    if fast:
        compiled = compiled_ensemble_runner if method.explicit else compiled_implicit_ensemble_runner
        run = compiled(method, problem.field)
    elif method.explicit:
        run = _on_arrays(array_runner(method, problem.field))
    else:
        return "implicit methods are only timed compiled"

    def call(steps: int) -> Callable[[], State]:
        y, h = np.empty((len(start), MEMBERS)), float_step(problem.t, steps)

        def integrate() -> State:
            y[:] = start
            run(y, h, 0, steps)
            return tuple(map(float, y.max(axis=1)))  # all are alike

        return integrate

    return call


def _on_arrays(step: Run) -> EnsembleRun:
    def run(y: FloatArray, h: float, first: int, last: int) -> None:
        with np.errstate(all="ignore"):
            y[:] = step(tuple(y), h, first, last)

    return run
