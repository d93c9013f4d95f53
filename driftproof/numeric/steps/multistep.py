"""Runs of linear multistep methods in floats, whose first values are those of a one-step method that is stated."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import isfinite
from typing import Any, NamedTuple, TypeAlias

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import Method, MethodError
from driftproof.numeric.steps import newton
from driftproof.numeric.steps.field_loops import field_writers
from driftproof.numeric.steps.implicit import NO_STEP, require_done
from driftproof.numeric.steps.loops import FieldWriters, loop, maker_of_rows
from driftproof.numeric.steps.newton import Equations, solved_group

_State: TypeAlias = Sequence[float]
# The explicit methods that start explicit ones, each with its order p. The error of one of their steps is O(h^(p + 1)),
# which a few first values may have where the order is p + 1.
_EXPLICIT_STARTS = {4: "rk4", 5: "dormand_prince54", 8: "prince_dormand87"}


class MultistepTable(NamedTuple):
    """The new state is Σ `states`ⱼ yₙ₊ⱼ + h Σ `slopes`ⱼ fₙ₊ⱼ + h `implicit` fₙ₊ₖ, j < k."""

    states: Any
    slopes: Any
    implicit: float


def start_of(method: Multistep) -> Method:
    """The method that gives the first values: explicit for an explicit one, else Radau IIA.

    Its steps are as exact as the order needs, which is at most k for an explicit zero-stable method and k + 2 for an
    implicit one (dahlquist-1956). Raises MethodError if there is none.

    >>> from driftproof.methods.catalogue import FURTHER_METHODS
    >>> [start_of(FURTHER_METHODS[key]).key for key in ("adams_bashforth4", "bdf2", "bdf4")]
    ['rk4', 'radau_iia2', 'radau_iia3']
    """
    if method.explicit:
        starts, needed = _EXPLICIT_STARTS, method.steps - 1
    else:
        starts, needed = {2 * s - 1: f"radau_iia{s}" for s in range(2, 8)}, method.steps + 1
    found = next((key for order, key in starts.items() if order >= needed), None)
    if found is None:
        raise MethodError(f"{method.key}: no method here gives the first values of {method.steps} steps")
    return METHODS[found]


@dataclass(frozen=True)
class Trail(Sequence[float]):
    """The state of a multistep run: the newest `states` and `slopes` f, oldest first. It reads as the newest state."""

    states: Sequence[_State]
    slopes: Sequence[_State]

    def __getitem__(self, i: Any) -> Any:
        """A component of the newest state."""
        return self.states[-1][i]

    def __len__(self) -> int:
        """The number of components."""
        return len(self.states[-1])


@dataclass
class MultistepRun:
    """run(y, h, first, last) -> y of a multistep method: steps first to last - 1, step i from i h.

    A run from a plain state begins there, by steps of `starter`; one from a `Trail` goes on. `steps` is the loop, and
    `made` makes the rows that it takes. `calls` counts the evaluations of f but for those of the starter, whose steps
    `begun` counts; `past` is as in an ImplicitRun. Raises StageEquationsUnsolved.
    """

    method: Multistep
    start_method: Method
    starter: Callable[[_State, float, int, int], _State]
    writers: FieldWriters
    table: MultistepTable
    steps: Callable[..., None]
    made: Callable[[Any], Any]
    calls: int = 0
    begun: int = 0
    past: float = 0.0

    def __call__(self, y: _State, h: float, first: int, last: int) -> Trail:
        """Return the state after steps first to last - 1."""
        states, slopes = (list(y.states), y.slopes) if isinstance(y, Trail) else ([y], [])
        while len(states) < self.method.steps and first < last:
            states.append(self.starter(tuple(states[-1]), h, first, first + 1))
            first, self.begun = first + 1, self.begun + 1
        if first < last:
            states, slopes = self._advanced(states, slopes, h, first, last)
        return Trail(states, slopes)

    def of_all(self, rows: _State, h: float, first: int, last: int) -> _State:
        """The same steps on the vector of k states at once, oldest first."""
        n, k = len(rows) // self.method.steps, self.method.steps
        states, _ = self._advanced([rows[i * n : (i + 1) * n] for i in range(k)], [], h, first, last)
        return [x for row in states for x in row]

    def _advanced(
        self, states: Sequence[_State], slopes: Sequence[_State], h: float, first: int, last: int
    ) -> tuple[list[_State], list[_State]]:
        k, n, made = len(states), len(states[0]), self.made
        rows, rates, report = made([*map(list, states)]), made([*map(list, slopes or [[0.0] * n] * k)]), made(NO_STEP)
        for j in range(0 if slopes else k - self.method.explicit):  # an explicit step evaluates the newest itself
            if any(self.table.slopes[: j + 1]):
                self.writers.rate((first - k + 1 + j) * h, rows[j], rates[j])
                self.calls += 1
        self.steps(rows, rates, h, first, last, self.table, report)
        self.calls += int(report[newton.EVALUATIONS])
        self.past = self.past or float(report[newton.PAST])
        require_done(self.method.key, report, 0.0, h)
        return [[*map(float, row)] for row in rows], [[*map(float, row)] for row in rates]


def multistep_runner(
    method: Multistep,
    system: VectorField,
    start: Callable[[Method], Callable[[_State, float, int, int], _State]],
    *,
    compiled: bool = False,
) -> MultistepRun:
    """The run of a multistep method on y' = f(t, y), where `start` makes the run of a one-step method on it.

    Raises MethodError for a method for y'' = F(y), which gives positions only.
    """
    if method.derivative != 1:
        raise MethodError(f"{method.key} is for y'' = F(y) and gives positions only; methods for y' = f can be run")
    first, (*rho, leading), (*sigma, newest) = start_of(method), method.rho, method.sigma
    made = maker_of_rows(compiled=compiled)
    states, slopes = (made([float(x / leading) for x in row]) for row in ([-x for x in rho], sigma))
    table = MultistepTable(states, slopes, float(newest / leading))
    writers = field_writers(system, compiled=compiled)
    steps = partial(loop(run_multistep, compiled=compiled), writers)
    return MultistepRun(method, first, start(first), writers, table, steps, made)


def run_multistep(
    writers: FieldWriters,
    states: Any,
    slopes: Any,
    h: float,
    first: int,
    last: int,
    table: MultistepTable,
    report: Any,
) -> None:
    """Take steps first to last - 1 in place, the newest state of step i being that at i h; stop at one that fails."""
    k, n, zeros = len(states), len(states[0]), writers.zeros
    base, a, c, known, moves, start = zeros(n), zeros(1, 1), zeros(1), zeros(1, n), zeros(1, n), zeros(n)
    a[0][0], c[0] = table.implicit, 1.0
    for i in range(first, last):
        if table.implicit == 0:
            writers.rate(i * h, states[k - 1], slopes[k - 1])
            report[newton.EVALUATIONS] += 1
        for d in range(n):
            value = flow = 0.0
            for j in range(k):
                value += table.states[j] * states[j][d]
                flow += table.slopes[j] * slopes[j][d]
            base[d] = value + h * flow
            start[d] = states[k - 1][d] - base[d]
        if table.implicit != 0:
            equations = Equations(i * h, base, h, a, c, known)
            if not solved_group(writers, equations, start, moves, report):
                report[newton.STATE], report[newton.STEP] = newton.UNSOLVED, i
                return
        finite = True
        for j in range(k - 1):
            for d in range(n):
                states[j][d], slopes[j][d] = states[j + 1][d], slopes[j + 1][d]
        for d in range(n):
            states[k - 1][d] = base[d] + moves[0][d]
            slopes[k - 1][d] = moves[0][d] / (h * table.implicit) if table.implicit != 0 else 0.0
            finite = finite and isfinite(states[k - 1][d])
        if not finite:
            report[newton.STATE], report[newton.STEP] = newton.OVERFLOWS, i
            return
    report[newton.STATE] = newton.DONE
