"""Whole runs with step-size control, compiled or in Python: pairs (explicit, Rosenbrock), Gauss's, Radau IIA."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from math import inf
from typing import Any

import numpy as np

from driftproof.methods.catalogue import Entry, of_one_state
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.programs.explicit_steps import FieldSource, field_source
from driftproof.methods.programs.program_text import indented, maker_text, used_stages
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import MethodError, RungeKutta
from driftproof.numeric.steps import step_control
from driftproof.numeric.steps.engine import program_function
from driftproof.numeric.steps.field_loops import field_writers
from driftproof.numeric.steps.loops import loop, maker_of_rows
from driftproof.numeric.steps.rosenbrock import (
    RosenbrockTable,
    autonomous_writers,
    rosenbrock_attempt,
    rosenbrock_table,
    work_of_stages,
)
from driftproof.numeric.steps.simplified_newton import (
    CollocationTable,
    collocation_attempt,
    collocation_table,
    work_for,
)
from driftproof.numeric.steps.step_control import (
    PairTable,
    StepAttempt,
    StepControl,
    Tolerances,
    controlled_steps,
    pair_attempt,
)

# Growth of the step size up to this factor is not used, so that matrices can be kept (hairer-wanner-1996, IV.8).
STEADY = 1.2


@dataclass
class ControlledRun:
    """run(y, end, relative, absolute) -> y at t = end > 0, from t = 0, the error of each step within the tolerances.

    `steps`, `rejected` (steps) and `calls` (of f) are those of the last run. Raises ArithmeticError if no step size
    meets the tolerances, and if the run is given up after more than `most` calls.
    """

    method: Entry
    loop: Callable[..., None]
    power: float
    steady: float
    table: Any
    work: Callable[[int], Any]
    made: Callable[[Any], Any]
    zeros: Callable[..., Any]
    timed: bool = False  # t is one more component of the state
    steps: int = 0
    rejected: int = 0
    calls: int = 0
    rows: Any = ()

    def __call__(
        self, y: Sequence[float], end: float, relative: float, absolute: float, most: float = inf
    ) -> tuple[float, ...]:
        """Return the state at t = `end`."""
        return self._run(y, end, Tolerances(relative, absolute, self.power, self.steady, most), 0)

    def way(self, y: Sequence[float], end: float, relative: float, absolute: float, most: int) -> Sequence[Any]:
        """Rows of t and y after each step or, if there are more than `most`, after each k-th."""
        self(y, end, relative, absolute)
        apart = -(-self.steps // most)
        self._run(y, end, Tolerances(relative, absolute, self.power, self.steady), self.steps // apart, apart)
        return [row[: 1 + len(y)] for row in self.rows]

    def _run(self, y: Sequence[float], end: float, given: Tolerances, rows: int, apart: int = 1) -> tuple[float, ...]:
        state, report = self.made((*y, 0.0) if self.timed else y), self.made([0.0] * 5)
        self.rows = self.zeros(rows, 1 + len(state))
        self.loop(state, end, StepControl(given, self.table, self.work(len(state)), report, self.rows, apart))
        self.calls, self.steps, self.rejected = (int(report[i]) for i in range(step_control.STATE))
        if report[step_control.STATE] != step_control.DONE:
            if report[step_control.STATE] == step_control.GIVEN_UP:
                raise ArithmeticError(f"{self.method.key}: given up after {given.most:.2g} evaluations")
            at = f"from t = {report[step_control.TIME]:g}"
            raise ArithmeticError(f"{self.method.key}: no step size meets the tolerance {at}")
        return tuple(map(float, state[: len(y)]))


def controlled_runner(method: Entry, field: VectorField, *, compiled: bool = False) -> ControlledRun:
    """The run of a pair, explicit or Rosenbrock, or of a collocation method without the node 0; compiled by numba.

    A compiled run compiles at its first call. Raises MethodError for methods without an error estimate.
    """
    writers_of = autonomous_writers if isinstance(method, Rosenbrock) else field_writers
    writers, timed, steady = writers_of(field, compiled=compiled), False, 1.0
    table: PairTable | CollocationTable | RosenbrockTable
    attempt: StepAttempt
    work: Callable[[int], Any]
    if isinstance(method, Rosenbrock | RungeKutta):
        power = min(method.claimed_order, method.embedded_order or 0) + 1.0
    if isinstance(method, Rosenbrock):
        attempt, table = rosenbrock_attempt, _rosenbrock_pair(method, field, compiled=compiled)
        timed, work = table.timed, partial(work_of_stages, table=table, writers=writers)
    elif isinstance(method, RungeKutta) and method.explicit and method.b_embedded is not None:
        step = _pair_step(method, field, compiled=compiled)
        stages = used_stages(method.a, [method.b, method.b_embedded])
        attempt, table = pair_attempt, PairTable(step, len(stages) - 1, _keeps_last(method))
        work = lambda n: tuple(writers.zeros(3, n))
    else:
        known = collocation_table(of_one_state(method))
        attempt, table = collocation_attempt, CollocationTable(*map(np.array, known)) if compiled else known
        power, steady, work = len(known.c) + 1.0, STEADY, partial(work_for, table=known, writers=writers)
    steps = partial(loop(controlled_steps, compiled=compiled), writers, loop(attempt, compiled=compiled))
    made = maker_of_rows(compiled=compiled)
    return ControlledRun(method, steps, power, steady, table, work, made, writers.zeros, timed)


def _rosenbrock_pair(method: Rosenbrock, field: VectorField, *, compiled: bool) -> RosenbrockTable:
    if method.b_embedded is None:
        raise MethodError(f"{method.key} has no error estimate: no second row of weights")
    off = [x - y for x, y in zip(method.b, method.b_embedded, strict=True)]
    return rosenbrock_table(method, off, field, compiled=compiled)


def _keeps_last(method: RungeKutta) -> bool:
    """True if the last stage is f at the new state, and so the first stage of the next step."""
    return method.a[-1] == method.b and method.c[-1] == 1


@cache
def _pair_step(method: RungeKutta, field: VectorField, *, compiled: bool) -> Callable[..., None]:
    """Return step(t, y, h, first, last, begin_, end_): reads `first`, f(t, y); writes last f, new state, error."""
    source = field_source(method, field, estimated=True)
    lines = [line for line in source.lines if not line.startswith("k1_")]
    inputs = [("y", "{}"), ("first", "k1_{}")]
    outputs = [("begin_", "{}_new"), ("end_", "{}_off"), *([("last", f"k{len(method.b)}_{{}}")] * _keeps_last(method))]
    reads = [f"{x} = {row}[{i}]" for row, names in inputs for i, x in _numbered(source, names)]
    writes = [f"{row}[{i}] = {x}" for row, names in outputs for i, x in _numbered(source, names)]
    head = "def run(t, y, h, first, last, begin_, end_):"
    text = maker_text(dict(source.coefficients), "run", [head, *indented([*reads, *lines, *writes])])
    return loop(program_function(text, method.key, source.coefficients), compiled=compiled)


def _numbered(source: FieldSource, names: str) -> Iterable[tuple[int, str]]:
    return enumerate(names.format(x) for x in source.components)
