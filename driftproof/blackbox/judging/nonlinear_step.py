"""Comparison of a stepper with the method's own step, computed in balls, on nonlinear problems that depend on time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import chain, product
from math import inf, isnan
from typing import Any

import numpy as np
from flint import arb, ctx

from driftproof.blackbox.judging.nonlinear_problems import (
    START,
    NonlinearProblem,
    dragged_problem,
    field_problem,
    force_problems,
)
from driftproof.blackbox.judging.specification import Allowance, Specification
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.stage_solutions import advanced, step_by_iteration
from driftproof.blackbox.stepper.array_adapters import AnyNumber
from driftproof.blackbox.stepper.calling_conventions import FIELD
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.methods.stepping import stepper
from driftproof.symbolic.algebra.certified import enclose

# Chosen: balls of this precision are far narrower than the rounding errors of doubles.
_BITS = 192
# Step sizes so small that the iteration for the stages converges for every method of the catalogue, and so large that
# two tables of one order differ by far more than a solver's tolerance; and the times at which the steps start.
STEPS, TIMES = (2.0**-4, 2.0**-5, 2.0**-7), (START, 1.5)
# An iteration that converges at those step sizes gains at least one bit a round. Chosen: twice as many as are needed.
_ROUNDS = 2 * _BITS
# A smaller change of a slope of size 1 is far below the rounding of doubles, and above that of the balls themselves.
_SETTLED = 2.0**-150
# Methods with one linear step differ by 1e-6 and more at those step sizes, and solvers in use leave less than this.
_SOLVED = 1e-8
# The factor by which the stages of a solver may exceed its tolerance: it stops by a change or a residual, and the error
# is larger than these by a factor of at most 1/(1 - h L), with h L up to 3/4 here.
BEYOND_TOLERANCE = 4


@dataclass(frozen=True)
class NonlinearAgreement:
    """The largest difference from the method's step that was seen, and where it exceeded the allowed one, if it did.

    `beyond` is the worst place in words, "" for none, and `wrong` are the names of all components that are wrong there.
    """

    problem: str
    steps: int
    largest: float
    beyond: str = ""
    wrong: tuple[str, ...] = ()

    @property
    def holds(self) -> bool:
        """True if every step is the method's, up to rounding or the tolerance of its solver."""
        return not self.beyond

    @property
    def words(self) -> str:
        """The finding in one line."""
        if self.beyond:
            others = f"; wrong components: {', '.join(self.wrong)}" if len(self.wrong) > 1 else ""
            return f"on {self.problem}, {self.beyond}{others}"
        return f"its steps agree with the method's own on {self.problem}, to {self.largest:.1e} in {self.steps} steps"


def nonlinear_agreement(subject: ForeignStepper, wanted: Specification) -> NonlinearAgreement:
    """Compare the stepper with the method, from states near the solution of a problem in which all derivatives matter.

    A splitting or a Nyström method is compared on q'' = F(t, q), with several positions if the stepper takes them, in
    the order of y that fits; its time advances as its positions do. A Runge-Kutta method whose force gets velocities is
    compared on a force that depends on them. Raises UnsupportedCall if the system is built in.
    """
    partitioned = isinstance(wanted.method, Splitting | Nystrom)
    general = subject.convention.kind == FIELD and not partitioned
    if subject.gives_velocities and not partitioned:
        problems = [dragged_problem(subject)]
    else:
        problems = [field_problem(subject)] if general else force_problems(subject)
    found = [_compared(subject, wanted, problem) for problem in problems]
    return next((each for each in found if each.holds), min(found, key=lambda each: each.largest))


def nonlinear_twins(subject: ForeignStepper, keys: Sequence[str]) -> tuple[str, ...]:
    """The methods, of several implicit ones with the same linear step, whose nonlinear steps the stepper takes.

    Stages may be as far off as solvers in use leave them. Raises UnsupportedCall if the system is built in.
    """
    wanted = {key: Specification(METHODS[key], Allowance(solver_tolerance=_SOLVED)) for key in keys}
    return tuple(key for key, each in wanted.items() if nonlinear_agreement(subject, each).holds)


def _compared(subject: ForeignStepper, wanted: Specification, problem: NonlinearProblem) -> NonlinearAgreement:
    found = NonlinearAgreement(problem.words, len(TIMES) * len(STEPS), 0.0)
    with ctx.workprec(_BITS):
        for t, h in product(TIMES, STEPS):
            start = problem.start(t)
            expected = own_step(wanted.method, problem, t, start, h)
            allowed = allowed_off(subject, wanted, 1 + max(map(abs, start)), h)
            seen = problem.stepped(subject, t, start, h)
            off = [*map(error_above, seen, expected)]
            wrong = tuple(name for name, x in zip(problem.names, off, strict=True) if not x <= allowed)
            i = max(range(len(off)), key=lambda i: inf if isnan(off[i]) else off[i])
            if wrong and not off[i] <= found.largest:
                right = f"{wanted.method.key} gives {float(expected[i].mid())!r}"
                numbers = f"{problem.names[i]} is {seen[i]!r} where {right}"
                beyond = f"in a step of {h:g} from t = {t:g}, {numbers}: off by {off[i]:.1e}, allowed {allowed:.1e}"
                found = replace(found, beyond=beyond, wrong=wrong)
            found = replace(found, largest=max(found.largest, off[i]))
    return found


def error_above(x: AnyNumber, exact: arb) -> float:
    """An upper bound of |x - exact|, as a float."""
    return float(abs(arb(x) - exact).upper())


def allowed_off(subject: ForeignStepper, wanted: Specification, size: float, h: float) -> float:
    """How far a component of a step may be off if components and slopes are of this size."""
    method, allowance = wanted.method, wanted.allowance
    calls = len(method.parts) if isinstance(method, Splitting) else method.stages
    rounding = Rounding(subject.format, calls).of(2 * size)
    by_quotient = 2 * size * float(subject.format.u) / h if allowance.velocity_from_positions else 0.0
    return rounding + by_quotient + BEYOND_TOLERANCE * size * float(allowance.solver_tolerance or 0)


def own_step(method: Method, problem: NonlinearProblem, t: float, y: Sequence[float], h: float) -> list[arb]:
    """The method's step from exactly these floats, in balls."""
    if isinstance(method, RungeKutta | Collocation):
        return _runge_kutta_step(method, problem, arb(t), [arb(x) for x in y], arb(h))
    n = problem.positions

    def force(q: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        return np.array([*problem.force(q[n], q[:n].tolist()), arb(0)], dtype=object)

    # The time is one more position, with velocity 1 and no force: each sub-step or stage then has its own time.
    q, v = (np.array([*map(arb, part), arb(clock)], dtype=object) for part, clock in ((y[:n], t), (y[n:], 1)))
    q1, v1 = stepper(method, enclose)(force, q, v, arb(h))
    return [*q1[:n], *v1[:n]]


def _runge_kutta_step(
    method: RungeKutta | Collocation, problem: NonlinearProblem, t: arb, y: Sequence[arb], h: arb
) -> list[arb]:
    """The step y + h Σ bᵢ kᵢ with kᵢ = f(t + cᵢh, y + h Σ aᵢⱼ kⱼ).

    Explicit stages are computed in turn, implicit ones as `solved_in_balls` does.
    """
    tableau: Any = method.tableau(_BITS) if isinstance(method, Collocation) else (method.a, method.b, method.c)
    a = [[enclose(x) for x in row] for row in tableau[0]]
    b, c = ([enclose(x) for x in row] for row in tableau[1:])
    if method.explicit:
        slopes: list[list[arb]] = []
        for node, row in zip(c, a, strict=True):
            slopes.append([x.mid() for x in problem.rate(t + node * h, advanced(y, h, [row], [slopes], _ball_sum))])
        return advanced(y, h, [b], [slopes], _ball_sum)
    return solved_in_balls(method, [a], [b], lambda i, place, part: problem.rate(t + c[i] * h, [*place]), y, h)


def solved_in_balls(
    method: Any,
    tables: Sequence[Sequence[Sequence[arb]]],
    weights: Sequence[Sequence[arb]],
    slopes_at: Callable[[int, Sequence[arb], int], Sequence[arb]],
    y: Sequence[arb],
    h: arb,
) -> list[arb]:
    """The end of an implicit step by iteration from k = y. Raises ArithmeticError if its stages do not converge."""
    centres = lambda i, place, part: [x.mid() for x in slopes_at(i, place, part)]
    end, done = step_by_iteration(tables, weights, centres, y, h, _ROUNDS, _settled, _ball_sum)
    if not done:
        raise ArithmeticError(f"the stages of {method.key} do not converge")
    return end


def _settled(slopes: Any, before: Any) -> bool:
    pairs = zip(*(chain.from_iterable(chain.from_iterable(each)) for each in (slopes, before)), strict=True)
    return all(abs(x - old) <= _SETTLED * (1 + abs(x)) for x, old in pairs)


def _ball_sum(terms: Iterable[arb]) -> arb:
    return sum(terms, arb(0))
