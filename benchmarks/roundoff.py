"""Rounding bounds against the worst that searches find: about two minutes."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction as Q

import numpy as np

from benchmarks.harness import Goal, Section
from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.methods.tables import basic
from driftproof.numeric.steppers import HAND_WRITTEN, rk4
from driftproof.symbolic.algebra.certified import enclose, significant
from driftproof.symbolic.derivation.one_step import matrix_at, one_step_matrix
from driftproof.symbolic.error_budget import ErrorOfRun
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from driftproof.symbolic.rounding.n_steps_bound import run_bound
from driftproof.symbolic.rounding.step_bound import step_bound
from driftproof.symbolic.runs import apply
from tests.witnesses.leapfrog import leapfrog
from tests.witnesses.worst_case import envelope_of, search

FORMATS = {BINARY64: np.float64, BINARY32: np.float32, BINARY16: np.float16}
RANGES = {"|h| <= 1/4": (0.0, 0.25), "|h| = 1/4": (0.25, 0.25), "|h| = 1": (1.0, 1.0), "|h| = 5/2": (2.5, 2.5)}
PROGRAMS = {**HAND_WRITTEN, "leapfrog": leapfrog} | {f"generic {m.key}": m for m in basic.ENTRIES}


# Generations of a search, and steps of the last table, of a whole run.
GENERATIONS, CHECKS = 24, 1000
PROGRAM = "program"
# How much of the bound the worst step found should reach where h is small: the design's own measurement.
TIGHT = 0.94


def worst_over_bound(generations: int) -> Section:
    """Of every program in every format: the worst error found over the bound at that step."""
    rows = [[PROGRAM, "format", *RANGES, "steps checked", "violations"]]
    violations, least = 0, 1.0
    for key, subject in PROGRAMS.items():
        step = subject if callable(subject) else stepper(subject, float)
        for fmt, dtype in FORMATS.items():
            envelope = envelope_of(step_bound(subject, fmt))
            found = [search(step, envelope, dtype, h_range, 1, generations) for h_range in RANGES.values()]
            checked, over = (sum(getattr(w, name) for w in found) for name in ("checked", "violations"))
            violations, least = violations + over, min(least, found[0].ratio)
            rows.append([key, fmt.name, *(f"{worst.ratio:.3f}" for worst in found), str(checked), str(over)])
    goals = [
        Goal("steps whose rounding error exceeds the bound", "0", str(violations), violations == 0),
        Goal("worst found / bound for |h| ≤ 1/4, every program", f"≥ {TIGHT}", f"{least:.3f}", least >= TIGHT),
    ]
    return Section("Worst rounding error of one step that a search finds, over the proved bound", rows, goals)


def anchor() -> Section:
    """The run of VerifiedLeapfrog (kellison-appel-2022): its certified error, and what is proved of it."""
    h, start, steps = Q(1, 32), (Q(1), Q(0)), 1000
    q, v, size = np.float32(1), np.float32(0), np.float32(1) / np.float32(32)
    for _ in range(steps):
        q, v = leapfrog(oscillator, q, v, size)
    matrix = matrix_at(one_step_matrix(METHODS["velocity_verlet"]), h)
    run = ErrorOfRun(matrix, h, steps, start, (Q(float(q)), Q(float(v))))
    bound = run_bound(leapfrog, h, steps, start, BINARY32).euclidean
    proved = lambda: enclose(run.truncation) + enclose(bound)
    rows = [
        ["", "Euclidean norm"],
        ["certified error of the run", significant(run.total, 12)],
        ["its truncation", significant(run.truncation, 12)],
        ["its rounding", significant(run.rounding, 12)],
        ["theorem's bound on rounding", significant(bound, 6)],
        ["proved bound on the error: truncation + theorem", significant(proved, 6)],
        ["proved by VerifiedLeapfrog", "0.0308"],
        ["times better", significant(lambda: enclose(Q(308, 10**4)) / proved(), 4)],
    ]
    total = significant(proved, 6)
    goals = [Goal("proved error of VerifiedLeapfrog's run", "< 0.0308", total, Q(total) < Q(308, 10**4))]
    return Section("binary32 leapfrog, h = 1/32, N = 1000, from q = 1, v = 0", rows, goals)


def teeth(checks: int) -> Section:
    """How many of so many random steps betray an RK4 whose last weight is wrong."""
    matrix, bound = one_step_matrix(METHODS["rk4"]), step_bound(rk4)
    rng = np.random.default_rng(3)
    points = [
        tuple(map(float, p)) for p in zip(rng.uniform(0, 2.5, checks), *rng.uniform(-1, 1, (2, checks)), strict=True)
    ]
    rows = [["last weight wrong by", "caught by the bound", "caught by a tolerance of 1e-12"]]
    goals = []
    for error in (0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11):
        seen = [_caught(_wrong_rk4(error), matrix, bound, *point) for point in points]
        rates = [100 * sum(column) / checks for column in zip(*seen, strict=True)]
        rows.append([f"{error:g}", *(f"{rate:.1f} %" for rate in rates)])
        if error == 1e-13:
            caught = "a weight of RK4 wrong by 1e-13 is caught"
            goals.append(Goal(caught, "100 %", f"{rates[0]:.1f} %", rates[0] == 100))
        if error == 0:
            goals.append(Goal("RK4 as it is is caught", "0 %", f"{rates[0]:.1f} %", rates[0] == 0))
    return Section(f"Teeth: RK4 with a wrong weight in {checks} random steps", rows, goals)


def _wrong_rk4(error: float):
    weights = METHODS["rk4"].b
    b = [float(w) for w in weights[:3]] + [float(weights[3]) + error]

    def step(force, q, v, h):
        k1q, k1v = v, force(q)
        k2q, k2v = v + h * k1v / 2, force(q + h * k1q / 2)
        k3q, k3v = v + h * k2v / 2, force(q + h * k2q / 2)
        k4q, k4v = v + h * k3v, force(q + h * k3q)
        q1 = q + h * (b[0] * k1q + b[1] * k2q + b[2] * k3q + b[3] * k4q)
        return q1, v + h * (b[0] * k1v + b[1] * k2v + b[2] * k3v + b[3] * k4v)

    return rk4 if error == 0 else step


def _caught(step, matrix, bound, h: float, q: float, v: float) -> tuple[bool, bool]:
    floats = step(oscillator, q, v, h)
    exact = apply(matrix_at(matrix, Q(h)), Q(q), Q(v))
    errors = [abs(Q(x) - y) for x, y in zip(floats, exact, strict=True)]
    by_bound = any(e > most for e, most in zip(errors, bound.error_of(Q(h), Q(q), Q(v)), strict=True))
    return by_bound, any(e > Q(1, 10**12) for e in errors)


def sections(_: int = 1) -> Iterator[Section]:
    """The tables, one after the other, for the first takes a minute or two. No table is one of times."""
    yield worst_over_bound(GENERATIONS)
    yield anchor()
    yield teeth(CHECKS)
