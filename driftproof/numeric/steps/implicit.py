"""Implicit Runge-Kutta and collocation methods on y' = f(t, y): stage equations by Newton's method, residual reported.

The unknowns are the stage increments Zᵢ = h Σⱼ aᵢⱼ f(t + cⱼ h, y + Zⱼ) (hairer-wanner-1996, IV.8), `moves` in the code.
If A is lower triangular, stages are solved one by one, otherwise all together except explicit ones at the head.

When does a step count as solved? Let E bound the rounding error of the computed residual ĝ, and R its change when Z
is rounded to floats. One iteration with a matrix M in the place of G' leaves |ĝ(Z⁺)| ≤ κ|ĝ(Z)| + 2E + R, where κ is
the norm of I - G'M⁻¹. Let κ ≤ 1/2. As long as |ĝ| > 8E + 4R, the next residual is at most |ĝ|/2 + |ĝ|/4 = 3|ĝ|/4. So

    solved        |ĝ| ≤ 8E + 4R in every component, which iterations with κ ≤ 1/2 reach;
    simplified    M is made from one Jacobian matrix, at the start of the iteration, while each one shrinks |ĝ| to 1/8;
    full          otherwise M is made anew at the present stages, which costs less than slow iterations;
    damped        after 128 iterations, as (3/4)¹²⁸ < 2⁻⁵³, or if a number is not finite, the iteration starts again,
                  full, and with shortened corrections where the next one would not be shorter;
    failed        after another 128 iterations.

The iteration starts at the stage before, at first at Z = 0; from Z = w a stiff stage may end in another solution. That
of a solved step goes on while the residual still halves, and the best Z is kept. Of several solutions it finds one; as
h tends to 0, the one near the start. Norms are of ĝ divided by 8E + 4R.

The solution wanted is that to which Z = 0 at h = 0 leads as h grows. There det G' = 1, and along solutions it changes
its sign at singular G' only. So one with det G' < 0 is on another branch, which is told. det G' > 0 shows nothing.

E: in g = Z - w - h Σ aᵢⱼ fⱼ with w known, the terms a f undergo 1 rounding of a, s of the products and the sum, 1 of h
and 2 of the differences, s + 4 together; Z and w at most 2. The rate is assumed to be computed as f(y(1 + α))(1 + β)
with |α|, |β| ≤ m u, m = newton.RATE_ROUNDINGS, and its argument y + Z is rounded once. With J the matrix used for f',
E = u (2|Z| + 2|w| + (s + 4 + m) |h||A||f| + (m + 1)|h||A||J||y + Z|) + (s + 1)(1 + |h|) eta, the last for underflow;
R = u (|Z| + |h||A||J||Z|) + eta (1 + |h||A||J|1), the last for subnormal Z. Terms in u², 10⁻¹³ of these, are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.schemes import Method
from driftproof.numeric.steps import newton
from driftproof.numeric.steps.engine import EnsembleRun, FloatArray, require_ensemble
from driftproof.numeric.steps.field_loops import field_writers
from driftproof.numeric.steps.loops import loop, maker_of_rows
from driftproof.numeric.steps.newton import StepTable, run_ensemble, run_steps
from driftproof.numeric.steps.tableaux import FloatTableau, float_tableau

NO_STEP = (0.0,) * (newton.PAST + 1)  # the report before the first step


class StageEquationsUnsolved(ArithmeticError):
    """Newton's method found no stages: the step is too large, the start too far away, or there is no solution.

    `reason` says so in a few words, without the step and the residual.
    """

    def __init__(self, message: str, reason: str = "") -> None:
        """Keep both; a copy made from the message alone, as pickle makes it, gets its reason afterwards."""
        super().__init__(message)
        self.reason = reason


@dataclass
class ImplicitRun:
    """run(y, h, first, last) -> y of the loop `steps` for y' = f(t, y): steps first to last - 1, step i from i h.

    `key` is that of the method, and `made` makes the rows that the loop takes. `calls` counts the evaluations of f so
    far; `past` is the time at the end of the first step past a singular matrix, 0 for none. Raises
    StageEquationsUnsolved.
    """

    key: str
    steps: Callable[..., None]
    table: Any
    made: Callable[[Any], Any]
    calls: int = 0
    past: float = 0.0

    def __call__(self, y: Sequence[float], h: float, first: int, last: int) -> tuple[float, ...]:
        """Return the state after steps first to last - 1."""
        state, report = self.made(y), self.made(NO_STEP)
        self.steps(0.0, state, h, first, last, self.table, report)
        self.calls += int(report[newton.EVALUATIONS])
        self.past = self.past or float(report[newton.PAST])
        require_done(self.key, report, 0.0, h)
        return tuple(map(float, state))


def implicit_runner(method: Method, field: VectorField, *, compiled: bool = False) -> ImplicitRun:
    """The loop of an implicit method on floats, with Jacobian matrices by exact formulas.

    Collocation methods are run by the tableau that their nodes determine. A run raises StageEquationsUnsolved rather
    than return what is not solved to rounding. Raises MethodError for splittings and Nyström methods.

    Compiled by numba it has the same bits, and needs the extra `fast`. The first call on a field then compiles, which
    takes some ten seconds; other methods on that field need no more.
    """
    table, run = _table(method), _on_field(run_steps, field, compiled=compiled)
    if compiled:
        table = StepTable._make((*map(np.array, table[:4]), table.way))
    return ImplicitRun(method.key, run, table, maker_of_rows(compiled=compiled))


def compiled_implicit_ensemble_runner(method: Method, field: VectorField) -> EnsembleRun:
    """Return run(y, h, first, last) of an implicit method on many systems, as `engine.compiled_ensemble_runner`.

    Each system has its own matrices and iterations. Raises StageEquationsUnsolved, which names a system that fails; the
    states of the others are then undefined.
    """
    arrays, run = implicit_runner(method, field, compiled=True).table, _on_field(run_ensemble, field, compiled=True)

    def run_systems(y: FloatArray, h: float, first: int, last: int) -> None:
        require_ensemble(y, len(field.rates))
        report = np.array(NO_STEP)
        run(y, h, first, last, arrays, report)
        require_done(method.key, report, 0.0, h, f"system {int(report[newton.SYSTEM])}: ")

    return run_systems


def _on_field(run: Callable[..., None], field: VectorField, *, compiled: bool) -> Callable[..., None]:
    """The loop `run` of `newton` on y' = f(t, y)."""
    return partial(loop(run, compiled=compiled), field_writers(field, compiled=compiled))


@cache
def _table(method: Method) -> StepTable:
    table = float_tableau(method)
    way = newton.LAST if table.stiffly_accurate else newton.SLOPES if table.d is None else newton.MOVES
    weights = table.b if table.d is None else table.d
    return StepTable(table.a.tolist(), weights.tolist(), table.c.tolist(), _groups(table), way)


def _groups(table: FloatTableau) -> tuple[tuple[int, int], ...]:
    """Groups (first, end) of stages solved together. Explicit ones at the head, and all of a triangular A, are alone.

    Among others an explicit stage would be an equation almost without rounding, which no elimination solves exactly.
    """
    ahead = next((i for i, row in enumerate(table.a) if row[i:].any()), table.stages)
    if not np.triu(table.a, 1).any():
        ahead = table.stages
    rest = [(ahead, table.stages)] if ahead < table.stages else []
    return (*((i, i + 1) for i in range(ahead)), *rest)


def require_done(key: str, report: Any, t: float, h: float, whose: str = "") -> None:
    """Raise StageEquationsUnsolved, in one line, if the step of the method with this key failed."""
    name, where = f"{key}: {whose}", f"the step from t = {t + report[newton.STEP] * h:g} by h = {h:g}"
    if report[newton.STATE] in (newton.OVERFLOWS, newton.SINGULAR):
        reason = "overflows binary64" if report[newton.STATE] == newton.OVERFLOWS else "has a singular matrix"
        raise StageEquationsUnsolved(f"{name}{where} {reason}", reason)
    if report[newton.STATE] == newton.UNSOLVED:
        left = f"residual {report[newton.LEFT]:.3g}, {report[newton.LEFT_OVER_FLOOR]:.3g} times its rounding error"
        where = f"{name}the step by h = {h:g} to t = {report[newton.TIME]:g}"
        reason = f"not solved after {int(report[newton.TRIED])} iterations"
        raise StageEquationsUnsolved(f"{where} is {reason}: {left}", reason)
