"""Solvers on our problems, with one small adapter each: our own, and other packages', imported only when asked for.

Each solver gets the problem's rates as functions of its own numbers, the start in binary64, and one tolerance, absolute
and relative; it chooses its steps itself. What has to be compiled is compiled by the first call, which is not timed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from importlib import import_module
from math import inf
from typing import Any

import numpy as np

from driftproof.methods.catalogue import Entry
from driftproof.methods.formulas.vector_fields import SMOOTH_FUNCTIONS, VectorField
from driftproof.methods.schemes import MethodError
from driftproof.numeric.advance import Rate, State, field_rate, float_start
from driftproof.numeric.problems.problem import Problem
from driftproof.numeric.reference_errors import Way
from driftproof.numeric.steps.controlled import controlled_runner
from driftproof.numeric.steps.engine import functions_of
from driftproof.numeric.work_precision.integrators import COMPILED, MOST_LOOKS, PYTHON
from driftproof.support.environment import how_to_install, installed
from driftproof.support.plain_text import unknown

TOLERANCES = tuple(10.0**-k for k in range(3, 14))
# Packages that run outside Python cannot be stopped after some evaluations, but after a number of steps.
_MOST_STEPS = 10**5
INSTALL = f"not installed; {how_to_install('peers')}"


class Solver:
    """A solver on a problem. Both methods raise ArithmeticError with the solver's message if it does not arrive."""

    rate: Rate
    # The evaluations that a run for errors may take per second of the time limit: as many as Python makes in ten.
    once = 10**6

    def solve(self, tolerance: float, t: float) -> State:
        """The state at t, from the start."""
        return self._solved(self.rate, tolerance, t)

    def way(self, tolerance: float, t: float) -> Way | None:
        """The states after the solver's own steps up to t; None if it does not tell them."""
        return None

    def counted(self, tolerance: float, t: float, most: float = inf) -> int | None:
        """The evaluations of f that a solve really makes, counted; the solve is given up after `most` of them.

        Evaluations for differences in Jacobian matrices are included. None if f is not called but expanded in series.
        """
        rate = _CountedRate(self.rate, most)
        self._solved(rate, tolerance, t)
        return rate.calls

    def _solved(self, rate: Rate, tolerance: float, t: float) -> State:
        raise NotImplementedError


@dataclass(frozen=True)
class Peer:
    """A package, the names of the solvers that are measured, and the kind of times that theirs compare with."""

    name: str
    solvers: tuple[str, ...]
    kind: str
    on: Callable[[Problem, str], Solver]

    @property
    def installed(self) -> bool:
        """True if the package can be imported."""
        return installed(self.name)


def peers_named(names: Iterable[str]) -> list[Peer]:
    """The peers of these names, each once. Raises ValueError naming the closest for an unknown one."""
    found = []
    for name in dict.fromkeys(names):
        if name not in PEERS:
            raise ValueError(unknown("peer", name, PEERS))
        found.append(PEERS[name])
    return found


class ControlledSolver(Solver):
    """Our own method with step-size control; compiled, it has the same bits as in Python."""

    once = 10**7

    def __init__(self, method: Entry, problem: Problem, *, compiled: bool) -> None:
        """Compile nothing yet. Raises MethodError for a method without an error estimate."""
        self.run = controlled_runner(method, problem.field, compiled=compiled)
        self.start = float_start(problem)

    def solve(self, tolerance: float, t: float) -> State:
        """The state at t."""
        return self.run(self.start, t, tolerance, tolerance)

    def way(self, tolerance: float, t: float) -> Way | None:
        """The states after all steps or, if there are very many, after each k-th."""
        rows = self.run.way(self.start, t, tolerance, tolerance, MOST_LOOKS)
        return Way.of((row[0] for row in rows), (row[1:] for row in rows))

    def counted(self, tolerance: float, t: float, most: float = inf) -> int | None:
        """The evaluations of f in a run."""
        self.run(self.start, t, tolerance, tolerance, most)
        return self.run.calls


class _Scipy(Solver):
    """scipy.integrate.solve_ivp, with the rate in plain Python."""

    def __init__(self, problem: Problem, solver: str) -> None:
        self.solve_ivp = import_module("scipy.integrate").solve_ivp
        self.rate, self.start, self.solver = _rate_of_doubles(problem.field), float_start(problem), solver

    def _solved(self, rate: Rate, tolerance: float, t: float) -> State:
        return tuple(map(float, self._found(rate, tolerance, t).y[:, -1]))

    def way(self, tolerance: float, t: float) -> Way | None:
        found = self._found(self.rate, tolerance, t)
        return Way(found.t[1:], found.y[:, 1:].T)

    def _found(self, rate: Rate, tolerance: float, t: float) -> Any:
        found = self.solve_ivp(rate, (0.0, t), self.start, method=self.solver, rtol=tolerance, atol=tolerance)
        if not found.success:
            raise ArithmeticError(found.message)
        return found


def _rate_of_doubles(field: VectorField) -> Rate:
    """The rate in plain Python; where that raises, as at exp(1000), infinite or NaN as of NumPy's doubles."""
    plain, like_arrays = field_rate(field), field_rate(field, functions_of(np))

    def rate(t: float, y: Any) -> list[float]:
        try:
            return plain(t, y)
        except (ArithmeticError, ValueError):
            with np.errstate(all="ignore"):
                return [*map(float, like_arrays(np.float64(t), np.asarray(y, float)))]

    return rate


class _Heyoka(Solver):
    """heyoka's Taylor integrator, compiled once for each tolerance, which sets its order."""

    def __init__(self, problem: Problem, solver: str) -> None:
        if not problem.field.smooth:
            raise MethodError("it has no kinks and jumps")
        self.heyoka, self.start = import_module("heyoka"), float_start(problem)
        variables = [self.heyoka.expression(name) for name in problem.field.components]
        rate = field_rate(problem.field, {name: getattr(self.heyoka, name) for name in SMOOTH_FUNCTIONS})
        self.system = list(zip(variables, rate(self.heyoka.time, variables), strict=True))
        self.compiled: dict[float, Any] = {}

    def solve(self, tolerance: float, t: float) -> State:
        if tolerance not in self.compiled:
            self.compiled[tolerance] = self.heyoka.taylor_adaptive(self.system, list(self.start), tol=tolerance)
        stepper = self.compiled[tolerance]
        stepper.time = 0.0
        stepper.state[:] = self.start
        outcome = stepper.propagate_until(t, max_steps=_MOST_STEPS)[0]
        if outcome != self.heyoka.taylor_outcome.time_limit:  # its name for the end of the interval
            raise ArithmeticError(f"stopped within {_MOST_STEPS} steps: {outcome}")
        return tuple(map(float, stepper.state))

    def counted(self, tolerance: float, t: float, most: float = inf) -> int | None:
        return None  # Taylor series call no rate


class _Diffrax(Solver):
    """diffrax.diffeqsolve compiled by jax, once for all tolerances; for these calls jax is set to binary64."""

    def __init__(self, problem: Problem, solver: str) -> None:
        self.jax, self.diffrax, self.solver = import_module("jax"), import_module("diffrax"), solver
        home = self.jax if hasattr(self.jax, "enable_x64") else import_module("jax.experimental")  # before version 0.8
        self.in_binary64: Callable[[bool], AbstractContextManager[None]] = home.enable_x64
        self.numpy = self.jax.numpy
        self.rate = field_rate(problem.field, functions_of(self.numpy))
        with self.in_binary64(True):
            self.start, self.calls = self.numpy.array(float_start(problem)), 0
        self.compiled, self.counting = (self.jax.jit(self._solver(counting=counting)) for counting in (False, True))

    def solve(self, tolerance: float, t: float) -> State:
        with self.in_binary64(True):
            return self._result(self.compiled(t, tolerance))

    def counted(self, tolerance: float, t: float, most: float = inf) -> int | None:
        """The calls of f in the compiled code, counted by a callback: slowly, so only for a solve that arrives."""
        self.solve(tolerance, t)
        self.calls = 0
        with self.in_binary64(True):
            self._result(self.counting(t, tolerance))
            self.jax.effects_barrier()
        return self.calls

    def _result(self, found: Any) -> State:
        y, successful = found
        if not successful:
            raise ArithmeticError(f"the end is not reached within {_MOST_STEPS} steps")
        return tuple(map(float, y))

    def _solver(self, *, counting: bool) -> Callable[[Any, Any], Any]:
        def rates(t: Any, y: Any, _args: Any) -> Any:
            if counting:
                self.jax.debug.callback(self._count)
            return self.numpy.stack([self.numpy.asarray(x) for x in self.rate(t, y)])

        def solve(t: Any, tolerance: Any) -> Any:
            control = self.diffrax.PIDController(rtol=tolerance, atol=tolerance)
            solver, end = getattr(self.diffrax, self.solver)(), self.diffrax.SaveAt(t1=True)
            settings = {"stepsize_controller": control, "saveat": end, "max_steps": _MOST_STEPS, "throw": False}
            found = self.diffrax.diffeqsolve(self.diffrax.ODETerm(rates), solver, 0.0, t, None, self.start, **settings)
            return found.ys[0], found.result == self.diffrax.RESULTS.successful

        return solve

    def _count(self) -> None:
        self.calls += 1


class _CountedRate:
    """A rate that counts its calls, and raises ArithmeticError after more than `most` of them."""

    def __init__(self, rate: Rate, most: float) -> None:
        self.rate, self.most, self.calls = rate, most, 0

    def __call__(self, t: float, y: Any) -> Any:
        self.calls += 1
        if self.calls > self.most:
            raise ArithmeticError(f"given up after {self.most:.2g} evaluations")
        return self.rate(t, y)


PEERS: Mapping[str, Peer] = {
    peer.name: peer
    for peer in (
        Peer("scipy", ("DOP853", "RK45", "Radau"), PYTHON, _Scipy),
        Peer("diffrax", ("Dopri8", "Tsit5"), COMPILED, _Diffrax),
        Peer("heyoka", ("Taylor",), COMPILED, _Heyoka),
    )
}
