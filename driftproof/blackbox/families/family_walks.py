"""Walks of Rosenbrock and IMEX steppers: their steps beside the method's own, on many problems and in balls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import Any, ClassVar

import numpy as np
from flint import arb, arb_mat, ctx

from driftproof.blackbox.judging.measured_order import MeasuredOrder, measured_in_floats
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem, field_problem
from driftproof.blackbox.judging.nonlinear_step import solved_in_balls
from driftproof.blackbox.judging.walks import Walker
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.stepper.calling_conventions import IMPLICIT, JACOBIAN, TIME_SLOPE
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.second_functions import SecondFunction, with_functions, zeros
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber
from driftproof.symbolic.algebra.certified import enclose

# The precision and the length of a difference in balls: its quotient is right to the last bit of a float of size 1.
_BITS, _STEP = 256, 2.0**-100
# A difference quotient for df/dt in floats is off by a few times the square root of u.
DIFFERENCES = 4
# Order conditions count as satisfied up to this: errors of reading, and of printed decimals, leave less.
NO_RESIDUAL = Fraction(1, 10**9)
# The most differences shown: chosen, as readers take in no more.
DIFFERENCES_SHOWN = 6


def derivatives(problem: NonlinearProblem, t: AnyNumber, y: Any) -> tuple[list[list[float]], list[float]]:
    """∂f/∂y and ∂f/∂t by differences in balls, so small that they are right to the last bit of a float."""
    with ctx.workprec(_BITS):
        at, state = arb(float(t)), [arb(float(x)) for x in y]
        here = problem.rate(at, state)

        def slope(moved: Sequence[AnyNumber]) -> list[float]:
            return [float(((x - z) / _STEP).mid()) for x, z in zip(moved, here, strict=True)]

        shifted = ([x + _STEP * (i == j) for i, x in enumerate(state)] for j in range(len(state)))
        columns = [slope(problem.rate(at, place)) for place in shifted]
        return [list(row) for row in zip(*columns, strict=True)], slope(problem.rate(at + _STEP, state))


class WithJacobian(NonlinearProblem):
    """A problem that gives the stepper a `share` of the Jacobian f', and df/dt."""

    share = 1.0

    def stepped(self, subject: ForeignStepper, t: float, y: Sequence[AnyNumber], h: float) -> list[AnyNumber]:
        """The end of a step with this share of f' as its Jacobian."""
        functions: dict[str, SecondFunction] = {
            JACOBIAN: lambda t, y: (self.share * np.array(derivatives(self, t, y)[0])).tolist(),
            TIME_SLOPE: lambda t, y: derivatives(self, t, y)[1],
        }
        return super().stepped(with_functions(subject, functions), t, y, h)


class WithHalfJacobian(WithJacobian):
    """A problem that gives the stepper half of f', which changes the order of all but W methods."""

    share = 0.5


class _InTwoParts(NonlinearProblem):
    """A problem y' = f + g, where g, which is solved for, is a fixed part of each slope."""

    def part(self, t: AnyNumber, y: Sequence[AnyNumber], implicit: bool) -> list[AnyNumber]:
        """The slopes of g if `implicit`, else those of f."""
        shares = [0.25 * (1 + i % 3) for i in range(len(y))]
        return [(s if implicit else 1 - s) * k for s, k in zip(shares, self.rate(t, [*y]), strict=True)]

    def stepped(self, subject: ForeignStepper, t: float, y: Sequence[AnyNumber], h: float) -> list[AnyNumber]:
        split = with_functions(subject, {IMPLICIT: lambda at, z: self.part(at, z, True)}, t)
        return split.step_field(lambda at, z: self.part(at, z, False), t, y, h)


class WithDamping(_InTwoParts):
    """A problem y' = f + g, where g damps each number at a rate that depends on the next one, and on t if told."""

    def part(self, t: AnyNumber, y: Sequence[AnyNumber], implicit: bool) -> list[AnyNumber]:
        """The slopes of g if `implicit`, else those of f."""
        faster = t * t if self.timed else 0
        damping = [-x * (1 + faster + z * z) for x, z in zip(y, [*y[1:], y[0]], strict=True)]
        return damping if implicit else [k - g for k, g in zip(self.rate(t, [*y]), damping, strict=True)]


def alone(subject: ForeignStepper) -> ForeignStepper:
    """The subject as a step(f, t, y, h), with zeros for its other functions."""
    still = {JACOBIAN: lambda t, y: [zeros(t, y)] * len(y), TIME_SLOPE: zeros, IMPLICIT: zeros}
    return with_functions(subject, still)


def measured_of_two(
    subject: ForeignStepper, kind: type[NonlinearProblem], halvings: Sequence[int], slack: float = 0.0
) -> MeasuredOrder:
    """The measured order of a stepper of two functions, with h = 2⁻ᵏ in its own floats, on this kind of problem."""
    problem = kind(**vars(field_problem(alone(subject))))
    return measured_in_floats(subject, problem, [2.0**-k for k in halvings], slack)


class _TwoFunctionWalker(Walker):
    """A walk on y' = f(t, y), with few and with many numbers."""

    kind: ClassVar[type[NonlinearProblem]]

    @property
    def partitioned(self) -> bool:
        return False

    @property
    def numbers(self) -> tuple[int, ...]:
        return (*range(1, 8), 9, 13)

    def problems(self, numbers: int) -> list[NonlinearProblem]:
        """The problems of a plain walk, with the functions that the stepper takes besides f."""
        walker = Walker(alone(self.subject), self.wanted)
        return [self.kind(**vars(problem)) for problem in walker.problems(numbers)]


@dataclass(frozen=True)
class RosenbrockWalker(_TwoFunctionWalker):
    """A walk beside a Rosenbrock method; `slack` is the error of a df/dt by differences, `autonomous` leaves it out."""

    kind = WithJacobian
    slack: float = 0.0
    autonomous: bool = False

    def allowed(self, size: float, numbers: int, h: float) -> float:
        """The error allowed: rounding, which grows with the linear systems to be solved, and that of df/dt."""
        rounding = Rounding(self.subject.format, self.method.stages * (1 + numbers))
        return rounding.of(2 * size) + DIFFERENCES * self.slack * h * h * size

    def own_step(self, problem: NonlinearProblem, t: float, y: Sequence[float], h: float) -> list[arb]:
        """The step with kᵢ = f(t + αᵢh, y + h Σ αᵢⱼ kⱼ) + h J Σ γᵢⱼ kⱼ + h γᵢ df/dt, and with the J and df/dt given."""
        rows, slopes = derivatives(problem, t, y)
        slopes = [0.0] * len(y) if self.autonomous else slopes
        jacobian, time_slope, n = arb_mat(rows), arb_mat([[x] for x in slopes]), len(y)
        one = arb_mat([[float(i == j) for j in range(n)] for i in range(n)])
        alpha, gamma = ([[enclose(x) for x in row] for row in part] for part in (self.method.alpha, self.method.gamma))
        stages: list[arb_mat] = []

        def moved(weights: Sequence[arb]) -> arb_mat:
            return sum((w * k for w, k in zip(weights, stages, strict=False)), arb_mat(n, 1))

        for i, (a, g) in enumerate(zip(alpha, gamma, strict=True)):
            place = arb_mat([[arb(x)] for x in y]) + h * moved(a)
            asked = problem.rate(arb(t) + h * sum(a, arb(0)), [place[m, 0] for m in range(n)])
            right = arb_mat([[k] for k in asked]) + h * (jacobian * moved(g)) + h * sum(g, arb(0)) * time_slope
            stages.append((one - h * g[i] * jacobian).solve(right))
        end = moved([enclose(x) for x in self.method.b])
        return [arb(x) + h * end[m, 0] for m, x in enumerate(y)]


@dataclass(frozen=True)
class ImexWalker(_TwoFunctionWalker):
    """A walk beside an IMEX method, whose stages are solved to the error `solved`."""

    kind = _InTwoParts
    solved: float = inf

    def allowed(self, size: float, numbers: int, h: float) -> float:
        """The error allowed: rounding, and what the stepper's solver leaves."""
        return Rounding(self.subject.format, 2 * self.method.stages).of(2 * size) + self.solved * size

    def own_step(self, problem: NonlinearProblem, t: float, y: Sequence[float], h: float) -> list[arb]:
        """y + h Σ (bᵢ f(Yᵢ) + b̂ᵢ g(Yᵢ)), by iteration. Raises ArithmeticError if the stages do not converge."""
        assert isinstance(problem, _InTwoParts)
        tables = [[[enclose(x) for x in row] for row in a] for a in (self.method.a_explicit, self.method.a_implicit)]
        weights = [[enclose(x) for x in b] for b in (self.method.b_explicit, self.method.b_implicit)]
        nodes = [sum(row, arb(0)) for row in tables[0]]
        slopes_at = lambda i, z, part: problem.part(t + nodes[i] * h, z, bool(part))
        return solved_in_balls(self.method, tables, weights, slopes_at, [arb(x) for x in y], arb(h))
