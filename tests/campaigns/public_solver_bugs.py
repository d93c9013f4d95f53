"""Public bugs of estimates, dense outputs, controllers, clocks and run loops, each as a small twin in our own words.

The codes are not those of the threads: they have their mistakes, in methods of the catalogue.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from driftproof import identify_solver
from driftproof.blackbox.matching.dense_outputs import judged_dense
from driftproof.blackbox.matching.estimates import judged_estimate
from driftproof.blackbox.solvers.foreign_solver import ForeignSolver
from driftproof.blackbox.solvers.runs import read_runs
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox.extension_steppers import but_the_last, extension_step, first_and_last_exchanged
from tests.blackbox.pair_steppers import but_one, pair_step
from tests.blackbox.solvers.planted_solvers import adaptive, fixed

# True of both twins where they make steps of one length, whatever the tolerance: no alarm.
OF_BOTH = ("have the same size", "rtol is ignored", "the jump is stepped over", "a tolerance 1000 times smaller")


class Said(NamedTuple):
    """All that is said of a code, and the faults of it."""

    words: str
    faults: list[str]


class Replay(NamedTuple):
    """A public thread, its mistake and its mended twin, and what must be said of the first."""

    reference: str
    about: str
    examine: Callable[[Any], Said]
    buggy: Any
    mended: Any
    cause: str


def of_second(judged: Callable[[ForeignStepper], Any], step: Any) -> Said:
    """What `identify` says of what a step returns besides y1."""
    found = judged(opened(step, "field"))
    return Said("; ".join((*found.lines, *found.faults)), list(found.faults))


of_pair, of_dense = partial(of_second, judged_estimate), partial(of_second, judged_dense)


@cache  # several mistakes have the same mended twin
def of_solver(solve: Any) -> Said:
    """What `identify_solver` says of a solver."""
    report = identify_solver(solve, isolate=False)
    faults = [str(fault) for fault in (*report.data["faults"], *report.data["remarks"])]
    return Said(report.verdict, [fault for fault in faults if not any(words in fault for words in OF_BOTH)])


def of_runs(solve: Any) -> Said:
    """What runs show of a solver: where each takes as many calls as it may, no more is asked of it."""
    found = read_runs(ForeignSolver(solve))
    return Said("; ".join(found.faults), [*found.faults])


def other_row(key: str) -> Callable[[list[float]], list[float]]:
    """The weights of the other row where their difference from the first belongs."""
    return lambda e: [float(x) for x in METHODS[key].b_embedded]


def no_end_slope(rows: list[list[float]]) -> list[list[float]]:
    """The cubic Hermite whose slope at the end is 0."""
    return [*rows[:-1], [0.0] * len(rows[-1])]


def degree_lowered(rows: list[list[float]]) -> list[list[float]]:
    """The term of highest degree left out."""
    return [[*row[:-1], 0.0] for row in rows]


def midpoints(first_step_twice: bool):
    """The midpoint rule with 64 steps; the first is integrated over twice, and counted once, where asked."""

    def solve(f, t_span, y0, rtol, atol):
        times, h = np.linspace(*t_span, 65), (t_span[1] - t_span[0]) / 64
        states = [np.array(y0, float)]
        for n, t in enumerate(times[:-1]):
            y = states[-1]
            for _ in range(2 if first_step_twice and not n else 1):
                y = y + h * f(t + h / 2, y + h / 2 * f(t, y))
            states.append(y)
        return times, states

    return solve


def last_stage_as_first(taken: bool):
    """Heun's method; the slope at y + h f is taken for the one at y1, where `taken`: f is called half as often."""

    def solve(f, t_span, y0, rtol, atol):
        times, h = np.linspace(*t_span, 65), (t_span[1] - t_span[0]) / 64
        states = [np.array(y0, float)]
        first = f(times[0], states[0])
        for t in times[1:]:
            second = f(t, states[-1] + h * first)
            states.append(states[-1] + h / 2 * (first + second))
            first = second if taken else f(t, states[-1])
        return times, states

    return solve


DP, BS, CK, TS = "dormand_prince54", "bogacki_shampine32", "cash_karp54", "tsitouras54"
QUARTIC = "dormand_prince54_shampine"
RIGHT = adaptive()

REPLAYS = (
    Replay("SciML/OrdinaryDiffEq.jl#4403", "the other row in place of the difference", of_pair,
           pair_step(BS, estimate=other_row(BS)), pair_step(BS), "its weights add up to 1, not to 0"),
    Replay("SciML/OrdinaryDiffEq.jl#4403", "u' = 1 is not integrated", of_runs,
           adaptive(estimate=other_row(BS)), RIGHT, "cannot integrate u' = 1"),
    Replay("SciML/OrdinaryDiffEq.jl#4362", "the estimate is never set", of_solver,
           adaptive(estimate=lambda e: [0.0] * 4, growth_at_zero=1.0, first_step=0.02), RIGHT,
           "all steps have the same size, whatever the error"),
    Replay("SciML/OrdinaryDiffEq.jl#3976", "an estimate of 0 lets any step pass", of_solver,
           adaptive(estimate=lambda e: [0.0] * 4), RIGHT, "the step size does not depend on the error"),
    Replay("llnl/sundials#850", "the last weight of an estimate has the other sign", of_pair,
           pair_step(TS, estimate=but_one(6, 1 / 66)), pair_step(TS), "its weights add up to 1/33, not to 0"),
    Replay("SciML/DiffEqDevTools.jl#23", "a digit of an embedded weight", of_pair,
           pair_step(CK, estimate=lambda e: but_one(2, e[2] + 1 / 48384)(e)), pair_step(CK), "differs in e[2]"),
    Replay("RobotLocomotion/drake#10633", "an estimate with the slope of another stage", of_pair,
           pair_step(BS, estimate=lambda e: [e[0] + e[3], e[1], e[2], 0.0]), pair_step(BS),
           "the error estimate is O(h^2); the step has order 3"),
    Replay("SciML/ODE.jl#15", "the last slope of a rejected step is kept", of_solver,
           adaptive(stale=True), RIGHT, "its first slope is the last one of the rejected attempt"),
    Replay("LupoLab/Luna.jl#436", "the last slope in the place of the first, before the dense output", of_dense,
           extension_step(QUARTIC, weights=first_and_last_exchanged), extension_step(QUARTIC),
           "is not y1 at theta = 1"),
    Replay("LupoLab/Luna.jl#436", "the row of order 4 is propagated", of_pair,
           pair_step(f"{DP}_embedded"), pair_step(DP), "the row of order 4 is propagated, the other one has order 5"),
    Replay("SciML/OrdinaryDiffEq.jl#4139", "a Hermite cubic with the slope 0 at the end", of_dense,
           extension_step("rk4_hermite", weights=no_end_slope), extension_step("rk4_hermite"),
           "the dense output has order"),
    Replay("scipy/scipy#14480", "the highest term of a dense output is left out", of_dense,
           extension_step(QUARTIC, weights=degree_lowered), extension_step(QUARTIC), "is not y1 at theta = 1"),
    Replay("SciML/DifferentialEquations.jl#45", "gaps between a dense output and the steps", of_dense,
           extension_step("dop853_dense", weights=but_the_last(lambda row: [*row[:-1], 1.01 * row[-1]])),
           extension_step("dop853_dense"), "is not y1 at theta = 1"),
    Replay("sxs-collaboration/spectre#1851", "a slope of another stage for the one at the end", of_dense,
           extension_step(QUARTIC, weights=lambda rows: [*rows[:-2], rows[-1], rows[-2]]), extension_step(QUARTIC),
           "is not y1 at theta = 1"),
    Replay("jax-ml/jax#40510", "an error of NaN ends the run", of_solver,
           adaptive(on_nan="silent"), RIGHT, "without saying so"),
    Replay("headmyshoulder/odeint-v2#173", "a bad right-hand side is tried for ever", of_solver,
           adaptive(on_nan="retry"), RIGHT, "where f is NaN it has not ended"),
    Replay("headmyshoulder/odeint-v2#228", "the tolerance goes into another argument", of_solver,
           adaptive(tolerances=lambda rtol, atol: (1e-6, 1e-6)), RIGHT, "rtol is ignored"),
    Replay("llnl/sundials#321", "exponents of the controller off by one", of_solver,
           adaptive(CK, exponent=1 / 4), adaptive(CK, exponent=1 / 5), "for an estimate O(h^5) it is 1/5"),
    # A remark: its step sizes settle, and the thread tells of a difference from a book, not of harm.
    Replay("Tudat/tudat#51", "the order of the other row in the controller", of_solver,
           adaptive("fehlberg45", exponent=1 / 6), adaptive("fehlberg45", exponent=1 / 5), "control is 1/6"),
    Replay("llnl/sundials#311", "a last stage at t + h is taken for the slope at the end", of_solver,
           last_stage_as_first(True), last_stage_as_first(False), "uses a last stage as the slope at the end"),
    Replay("FireDynamics/ARTSS#43", "one step more than asked for", of_solver,
           fixed(extra=1), fixed(), "one step too many"),
    Replay("headmyshoulder/odeint-v2#71", "one step less than asked for", of_solver,
           fixed(extra=-1), fixed(), "one step too few"),
    Replay("firemodels/fds#8009", "a last step of 10^-13", of_solver,
           adaptive(ending="tiny"), RIGHT, "one step too many: the last one is"),
    Replay("OpenQBMM/OpenQBMM#148", "the first step is integrated twice", of_solver,
           midpoints(True), midpoints(False), "that it returns differ"),
    Replay("mfem/mfem#2343", "the time advances by more than the step", of_solver,
           adaptive(stepped=lambda h: h * 1.01), RIGHT, "that it returns differ"),
    Replay("a clock of 24 bits", "time is accumulated in binary32", of_solver,
           fixed(clock=np.float32), fixed(), "t += h in binary32, which gives these times exactly"),
)  # fmt: skip
