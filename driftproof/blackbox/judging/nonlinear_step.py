"""Comparison of a stepper with the method's own step, computed in balls, on nonlinear problems that depend on time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, product
from math import inf, isnan
from typing import Any, NamedTuple

import numpy as np
from flint import arb, ctx

from driftproof.blackbox.findings import NotANumber, StepRaised, WrongShape, first_taken
from driftproof.blackbox.judging import nonlinear_problems as nonlinear
from driftproof.blackbox.judging.nonlinear_problems import START, NonlinearProblem
from driftproof.blackbox.judging.specification import Allowance, Specification
from driftproof.blackbox.matching.tables import exact_tableau
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.stage_solutions import advanced, step_by_iteration
from driftproof.blackbox.stepper.calling_conventions import FIELD
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import stepper
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import enclose

# Chosen: balls of this precision are far narrower than the rounding errors of doubles.
BITS = 192
# An iteration that converges for the steps taken gains at least one bit a round. Chosen: twice as many as are needed.
_ROUNDS = 2 * BITS
# A smaller change of a slope of size 1 is far below the rounding of doubles, and above that of the balls themselves.
_SETTLED = 2.0**-150
# Step sizes so small that the iteration for the stages converges for every method of the catalogue, and so large that
# two tables of one order differ by far more than a solver's tolerance; and the times at which the steps start.
STEPS, TIMES = (2.0**-4, 2.0**-5, 2.0**-7), (START, 1.5)
# The numbers of components, or of positions, tried: the largest first, as some codes take only two, or one.
_COMPONENTS, _POSITIONS = (4, 2, 1), (3, 2, 1)
# Methods with one linear step differ by 1e-6 and more at those step sizes, and solvers in use leave less than this.
_SOLVED = 1e-8
# The factor by which the stages of a solver may exceed its tolerance: it stops by a change or a residual, and the error
# is larger than these by a factor of at most 1/(1 - h L), with h L up to 3/4 here.
BEYOND_TOLERANCE = 4
# The stepper may use another arithmetic or convention; a step that it refuses to take is no evidence against it.
REFUSALS = (StepRaised, WrongShape, NotANumber)


class ComparedStep(NamedTuple):
    """The end of a step, how far off its worst component is in units of its scale, and how far it may be.

    `wrong` are the names of all components that are farther off; `place` and `numbers` show the worst of them.
    """

    end: list[float]
    off: float
    allowed: float
    wrong: tuple[str, ...]
    place: str
    numbers: str


@dataclass(frozen=True)
class NonlinearComparison:
    """A stepper and what it is compared with; each family overrides the step and the problems."""

    subject: ForeignStepper
    wanted: Specification

    @property
    def method(self) -> Any:
        """The method that the steps are compared with."""
        return self.wanted.method

    @property
    def partitioned(self) -> bool:
        """True if the stepper is compared on y'' = F(t, y)."""
        return isinstance(self.method, Splitting | Nystrom) or self.subject.convention.kind != FIELD

    def problems(self, numbers: int) -> list[NonlinearProblem]:
        """The problem with this many numbers or positions, in each order in which y may hold them.

        A Runge-Kutta method whose force gets velocities is compared on a force that depends on them. A force that is
        asked for one position at a time gets the problem `walls`. Raises one of the REFUSALS if none is taken, and
        UnsupportedCall if the system is built in.
        """
        if not self.partitioned:
            timed = nonlinear.passes_time(self.subject, numbers)
            problem = nonlinear.driven(numbers, timed=timed)
            return [problem if timed else nonlinear.turned(problem)]
        timed = nonlinear.gives_force_times(self.subject)
        if self.subject.gives_velocities and not isinstance(self.method, Splitting | Nystrom):
            found = [nonlinear.dragged_problem(self.subject, numbers)]
        else:
            found = [nonlinear.pushed(numbers, timed=timed)] if timed or numbers > 1 else []
            found = found if timed else [nonlinear.turned(problem) for problem in found]
            found += [] if timed or (found and self.subject.convention.kind == FIELD) else [nonlinear.walls(numbers)]
        return first_taken(lambda problem: nonlinear.in_each_order(self.subject, problem), found, REFUSALS)

    def compared(self, problem: NonlinearProblem, t: float, y: Sequence[float], h: float) -> ComparedStep:
        """One step beside the method's own."""
        seen = [float(x) for x in problem.stepped(self.subject, t, y, h)]
        taken = float(np.float32(h)) if self.wanted.allowance.step_in_binary32 else h
        expected, scales = self.own_step(problem, t, y, taken), problem.scales or [1.0] * len(y)
        # Slopes change by about their size in a unit of the problem's own time, so that the rounding of t matters, too.
        size = 1 + max(abs(x / s) for x, s in zip(y, scales, strict=True)) + abs(t) * problem.pace
        allowed = self.allowed(size, len(y), h * problem.pace)
        off = [gap / abs(s) for gap, s in zip(map(error_above, seen, expected), scales, strict=True)]
        names, i = problem.names, max(range(len(off)), key=lambda i: inf if isnan(off[i]) else off[i])
        wrong = tuple(name for name, x in zip(names, off, strict=True) if not x <= allowed)
        place = f"in a step of {h:.6g} from t = {t:.6g}"
        numbers = f"{names[i]} is {seen[i]!r} where {self.method.key} gives {float(expected[i].mid())!r}"
        return ComparedStep(seen, off[i], allowed, wrong, place, numbers)

    def own_step(self, problem: NonlinearProblem, t: float, y: Sequence[float], h: float) -> list[arb]:
        """The method's step in balls."""
        return own_step(self.method, problem, t, y, h)

    def allowed(self, size: float, numbers: int, h: float) -> float:
        """The allowed error of a component, for components and slopes of this size and this number of components."""
        allowance = self.wanted.allowance
        calls = len(self.method.parts) if isinstance(self.method, Splitting) else self.method.stages
        rounding = Rounding(self.subject.format, calls).of(2 * size)
        by_quotient = 2 * size * float(self.subject.format.u) / abs(h) if allowance.velocity_from_positions else 0.0
        return rounding + by_quotient + BEYOND_TOLERANCE * size * float(allowance.solver_tolerance or 0)


@dataclass(frozen=True)
class NonlinearAgreement:
    """The steps of one problem that were compared, by their number, and the worst of them."""

    problem: str
    steps: int
    worst: ComparedStep

    @property
    def holds(self) -> bool:
        """True if every step is the method's, up to rounding or the tolerance of its solver."""
        return not self.worst.wrong

    @property
    def words(self) -> str:
        """The finding in one line."""
        _, off, allowed, wrong, place, numbers = self.worst
        if wrong:
            others = f"; wrong components: {', '.join(wrong)}" if len(wrong) > 1 else ""
            return f"on {self.problem}, {place}, {numbers}: off by {off:.1e}, allowed {allowed:.1e}{others}"
        return f"its steps agree with the method's own on {self.problem}, to {off:.1e} in {self.steps} steps"


def nonlinear_agreement(subject: ForeignStepper, wanted: Specification) -> NonlinearAgreement:
    """Compare single steps with the method's, from states near the solution of the largest problem that is taken.

    They are compared in the order of y that fits. Raises a Misbehaviour, or UnsupportedCall if the system is built in.
    """
    comparison, found = NonlinearComparison(subject, wanted), list[NonlinearAgreement]()
    numbers = _POSITIONS if comparison.partitioned else _COMPONENTS
    for problem in first_taken(comparison.problems, numbers, REFUSALS):
        with ctx.workprec(BITS):
            steps = [comparison.compared(problem, t, problem.start(t), h) for t, h in product(TIMES, STEPS)]
        worst = max(steps, key=lambda step: (step.wrong != (), inf if isnan(step.off) else step.off))
        found.append(NonlinearAgreement(problem.words, len(steps), worst))
    return next((each for each in found if each.holds), min(found, key=lambda each: each.worst.off))


def nonlinear_twins(subject: ForeignStepper, keys: Sequence[str]) -> tuple[str, ...]:
    """The methods, of several implicit ones with the same linear step, whose nonlinear steps the stepper takes.

    Stages may be as far off as solvers in use leave them. Raises UnsupportedCall if the system is built in.
    """
    wanted = {key: Specification(METHODS[key], Allowance(solver_tolerance=_SOLVED)) for key in keys}
    return tuple(key for key, each in wanted.items() if nonlinear_agreement(subject, each).holds)


def error_above(x: AnyNumber, exact: arb) -> float:
    """An upper bound of |x - exact|, as a float."""
    return float(abs(arb(x) - exact).upper())


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
    rows, *tableau = exact_tableau(method)
    a = [[enclose(x) for x in row] for row in rows]
    b, c = ([enclose(x) for x in row] for row in tableau)
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
