"""Implicit Runge-Kutta and collocation methods on y' = f(t, y): stage equations by Newton's method, residual reported.

The unknowns are the moves Zᵢ = h Σⱼ aᵢⱼ f(t + cⱼ h, y + Zⱼ) (hairer-wanner-1996, IV.8). A lower triangular A is solved
stage by stage, any other at once but for explicit stages at its head.

When is it solved? With E a bound on the rounding error of the computed residual ĝ, and R on what moving Z to the
nearest floats changes in it, one iteration with a matrix M for G' leaves |ĝ(Z⁺)| ≤ κ|ĝ(Z)| + 2E + R, where κ is the
size of I - G'M⁻¹. Let κ ≤ 1/2. As long as |ĝ| > 8E + 4R, the next is at most |ĝ|/2 + |ĝ|/4: it shrinks to 3/4. So

    solved        |ĝ| ≤ 8E + 4R in every component, which an iteration with κ ≤ 1/2 reaches;
    simplified    M is made of one Jacobian matrix, where the iteration starts, as long as |ĝ| shrinks to 1/8;
    full          else M is made anew at the present stages, which costs less than slow iterations;
    failed        after 128 iterations: (3/4)¹²⁸ < 2⁻⁵³, or where something is no longer finite.

A solved step goes on while the residual still halves, and keeps the best. Where the equations have several solutions,
it is one of them; as h tends to 0, the one near the start. Norms are of ĝ divided by 8E + 4R.

E: of g = Z - w - h Σ aᵢⱼ fⱼ, w known, the terms a f pass 1 rounding of a, s of the products and the sum, 1 of h, 2 of
the differences, so s + 4, Z and w at most 2. The rate is taken to be computed as f(y(1 + α))(1 + β) with |α|, |β| at
most m u, m = _RATE_ROUNDINGS, and its argument y + Z is rounded once. J being the matrix in use for f',
E = u (2|Z| + 2|w| + (s + 4 + m) |h||A||f| + (m + 1)|h||A||J||y + Z|) + (s + 1)(1 + |h|) eta, the last for underflow;
R = u (|Z| + |h||A||J||Z|) + eta (1 + |h||A||J|1), the last where Z is subnormal. Terms in
u² are left out: they are 10⁻¹³ of these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.schemes import Method
from driftproof.numeric.tableaux import FloatTableau, float_tableau

_Vector: TypeAlias = NDArray[np.float64]
_Rate: TypeAlias = Callable[[float, _Vector], Any]
# (t, y) -> the n x n matrix of the derivatives of the rate.
Jacobian: TypeAlias = Callable[[float, _Vector], Any]

_UNIT = float(np.finfo(np.float64).epsneg)  # u = 2⁻⁵³
_ETA = float(np.finfo(np.float64).smallest_subnormal)
_RATE_ROUNDINGS = 16
MOST_ITERATIONS = 128
SHRINKS, HALVES = 0.125, 0.5


class StageEquationsUnsolved(ArithmeticError):
    """Newton's method found no stages: the step is too large, the start too far, or there are none.

    `reason` says it in a few words, without which step it was and how far it came.
    """

    def __init__(self, message: str, reason: str = "") -> None:
        """Keep both; a copy that is made of the message alone, as pickle does, gets its reason afterwards."""
        super().__init__(message)
        self.reason = reason


class ImplicitStep(NamedTuple):
    """What a step found.

    `residual` is the largest |g| left in a stage equation, in the units of y; `over_floor` the largest over what its
    rounding explains, at most 1.
    """

    y: _Vector
    residual: float
    over_floor: float
    iterations: int


ImplicitStepper: TypeAlias = Callable[[float, Any, float], ImplicitStep]


def implicit_stepper(method: Method, rate: _Rate, jacobian: Jacobian | None = None) -> ImplicitStepper:
    """step(t, y, h) of a Runge-Kutta or collocation method, y one-dimensional; h may be negative.

    Without a `jacobian` it is formed by differences, on which only the number of iterations depends. Collocation
    methods are run by their tableau, formed of the nodes. The step raises StageEquationsUnsolved, and never returns
    what is not solved to rounding, and ValueError for a rate of another length. Raises MethodError for a splitting and
    for a Nyström method.
    """
    return partial(_step, _Problem(method.key, float_tableau(method), rate, jacobian))


@dataclass(frozen=True)
class _Problem:
    key: str
    tableau: FloatTableau
    rate: _Rate
    jacobian: Jacobian | None

    def slope(self, t: float, y: _Vector) -> _Vector:
        found = np.asarray(self.rate(t, y), np.float64)
        if found.shape != y.shape:
            raise ValueError(f"the rate returns shape {found.shape} at a state of {len(y)} components")
        return found

    def derivative(self, t: float, y: _Vector, h: float) -> _Vector:
        if self.jacobian is not None:
            return np.asarray(self.jacobian(t, y), np.float64)
        base = self.slope(t, y)
        sizes = np.maximum(np.abs(y), np.abs(h * base))
        shifts = np.sqrt(_UNIT) * np.where(sizes > 0, sizes, 1.0)
        columns = [(self.slope(t, y + shift * unit) - base) / shift for shift, unit in _units(shifts)]
        return np.array(columns).T


def _units(shifts: _Vector) -> Any:
    return zip(shifts, np.eye(len(shifts)), strict=True)


@dataclass
class _Stages:
    """The stages of one step: moves Z and slopes h f of those that are solved, and the equations that were."""

    moves: _Vector
    slopes: _Vector
    equations: list[_Equations] = field(default_factory=list)


def _step(problem: _Problem, t: float, y: Any, h: float) -> ImplicitStep:
    y = np.array(y, np.float64)
    table = problem.tableau
    stages = _Stages(np.zeros((table.stages, len(y))), np.zeros((table.stages, len(y))))
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        for group in _groups(table):
            _solve(problem, stages, group, (t, y, h))
        moved = _moved(problem, stages, (t, y, h))
    if not np.isfinite(moved).all():
        where, reason = f"{problem.key}: the step from t = {t:g} by h = {h:g}", "overflows binary64"
        raise StageEquationsUnsolved(f"{where} {reason}", reason)
    residual, over_floor = (max(getattr(x, name) for x in stages.equations) for name in ("residual", "over_floor"))
    return ImplicitStep(moved, residual, over_floor, sum(x.iterations for x in stages.equations))


def _groups(table: FloatTableau) -> list[slice]:
    """The stages that are solved together: explicit ones at the head, and all of a lower triangular A, one by one.

    An explicit stage among others would be an equation without any rounding, which no elimination solves exactly.
    """
    ahead = next((i for i, row in enumerate(table.a) if row[i:].any()), table.stages)
    if not np.triu(table.a, 1).any():
        ahead = table.stages
    rest = [slice(ahead, table.stages)] if ahead < table.stages else []
    return [*(slice(i, i + 1) for i in range(ahead)), *rest]


def _moved(problem: _Problem, stages: _Stages, start: tuple[float, _Vector, float]) -> _Vector:
    """y₁: the last stage if that is the result, else from the moves; from slopes only where A is singular."""
    (t, y, h), table = start, problem.tableau
    if table.stiffly_accurate:
        return np.asarray(y + stages.moves[-1])
    if table.d is not None:
        return np.asarray(y + table.d @ stages.moves)
    slopes = [problem.slope(t + c * h, y + move) for c, move in zip(table.c, stages.moves, strict=True)]
    return np.asarray(y + h * (table.b @ np.array(slopes)))


def _solve(problem: _Problem, stages: _Stages, group: slice, start: tuple[float, _Vector, float]) -> None:
    """Newton's method for the stages of one group; those before it are solved."""
    (t, y, h), table = start, problem.tableau
    a, times = table.a[group, group], t + table.c[group] * h
    known = table.a[group, : group.start] @ stages.slopes[: group.start]
    equations = _Equations(problem, a, times, y, h, known)
    moves = equations.solved() if a.any() else known
    stages.moves[group] = moves
    if len(a) == 1:  # h f, for the stages to come; not evaluated again, which in a stiff problem magnifies rounding
        stages.slopes[group] = (moves - known) / a if a.any() else h * problem.slope(times[0], y + moves[0])
    stages.equations.append(equations)


class _Equations:
    """g(Z) = Z - known - h A f(t + c h, y + Z) = 0."""

    def __init__(self, problem: _Problem, a: _Vector, times: _Vector, y: _Vector, h: float, known: _Vector) -> None:
        self.problem, self.a, self.times, self.y, self.h, self.known = problem, a, times, y, h, known
        self.residual = self.over_floor = 0.0
        self.iterations = 0

    def solved(self) -> _Vector:
        """Z. Raises StageEquationsUnsolved."""
        moves = self.known
        at_start = self.problem.derivative(self.times[0], self.y + moves[0], self.h)
        jacobians = np.array([at_start] * len(self.a))
        g, ratio = self.at(moves, jacobians)
        best = (moves, g, ratio)
        while self.iterations < MOST_ITERATIONS and np.isfinite(ratio):
            self.iterations += 1
            moves = moves - self.correction(g, jacobians)
            before = ratio
            g, ratio = self.at(moves, jacobians)
            if ratio < best[2]:
                best = (moves, g, ratio)
            if best[2] <= 1 and not ratio < HALVES * before:
                break
            if ratio > SHRINKS * before:
                jacobians = self.jacobians(moves)
        if not best[2] <= 1:
            raise self.unsolved(best[1], best[2])
        self.residual, self.over_floor = float(np.abs(best[1]).max()), float(best[2])
        return best[0]

    def at(self, moves: _Vector, jacobians: _Vector) -> tuple[_Vector, float]:
        """The residual, and the largest part of it over its floor; infinite for what is not finite."""
        places = self.y + moves
        slopes = np.array([self.problem.slope(t, place) for t, place in zip(self.times, places, strict=True)])
        g = moves - self.known - self.h * (self.a @ slopes)
        ratio = float((np.abs(g) / self.floor(moves, places, slopes, jacobians)).max())
        return g, ratio if np.isfinite(ratio) and np.isfinite(g).all() else np.inf

    def floor(self, moves: _Vector, places: _Vector, slopes: _Vector, jacobians: _Vector) -> _Vector:
        """8E + 4R of the head of this file."""
        stages, m, size = len(self.a), _RATE_ROUNDINGS, np.abs(self.h)
        weights, matrices = np.abs(self.a), np.abs(jacobians)

        def mapped(x: _Vector) -> _Vector:
            return np.asarray(size * (weights @ np.einsum("jkl,jl->jk", matrices, np.abs(x))))

        flow = (stages + 4 + m) * size * (weights @ np.abs(slopes))
        e = _UNIT * (2 * np.abs(moves) + 2 * np.abs(self.known) + flow + (m + 1) * mapped(places))
        r = _UNIT * (np.abs(moves) + mapped(moves)) + _ETA * (1 + mapped(np.ones_like(moves)))
        return np.asarray(8 * (e + (stages + 1) * (1 + size) * _ETA) + 4 * r)

    def correction(self, g: _Vector, jacobians: _Vector) -> _Vector:
        """M⁻¹ g with M = I - h (aᵢⱼ Jⱼ). Raises StageEquationsUnsolved for a singular M."""
        (stages, _), n = self.a.shape, len(self.y)
        blocks = self.h * np.einsum("ij,jkl->ikjl", self.a, jacobians)
        matrix = np.eye(stages * n) - blocks.reshape(stages * n, stages * n)
        try:
            return np.linalg.solve(matrix, g.reshape(-1)).reshape(g.shape)
        except np.linalg.LinAlgError:
            raise self.unsolved(g, np.inf) from None

    def jacobians(self, moves: _Vector) -> _Vector:
        """f' at each stage."""
        pairs = zip(self.times, self.y + moves, strict=True)
        return np.array([self.problem.derivative(t, place, self.h) for t, place in pairs])

    def unsolved(self, g: _Vector, ratio: float) -> StageEquationsUnsolved:
        """The error, in one line."""
        left = f"residual {float(np.abs(g).max()):.3g}, {ratio:.3g} times what rounding explains"
        where = f"{self.problem.key}: the step by h = {self.h:g} to t = {float(self.times[-1]):g}"
        reason = f"not solved after {self.iterations} iterations"
        return StageEquationsUnsolved(f"{where} is {reason}: {left}", reason)
