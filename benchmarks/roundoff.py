"""Rounding bounds against the worst that searches find: python benchmarks/roundoff.py (about two minutes)"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction as Q
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own packages, whatever else is installed

import numpy as np

from benchmarks.timing import Goal, Row, Section, Subject, cold_and_warm, goal_rows, measure
from driftproof.methods.catalogue import METHODS
from driftproof.methods.problems import oscillator
from driftproof.methods.stepping import stepper
from driftproof.methods.tables import basic
from driftproof.numeric.leapfrog import leapfrog
from driftproof.numeric.steppers import HAND_WRITTEN, rk4
from driftproof.numeric.worst_case import Envelope
from driftproof.numeric.worst_case_search import search
from driftproof.support.plain_text import table
from driftproof.symbolic.algebra.certified import enclose, significant
from driftproof.symbolic.derivation.one_step import matrix_at, one_step_matrix
from driftproof.symbolic.rounding.error_of_run import ErrorOfRun
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from driftproof.symbolic.rounding.n_steps import run_bound
from driftproof.symbolic.rounding.sharp import sharp_bound
from driftproof.symbolic.rounding.step import step_bound
from driftproof.symbolic.runs import apply

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
            envelope = Envelope(*step_bound(subject, fmt).coefficients)
            found = [search(step, envelope, dtype, h_range, 1, generations) for h_range in RANGES.values()]
            checked, over = (sum(getattr(w, name) for w in found) for name in ("checked", "violations"))
            violations, least = violations + over, min(least, found[0].ratio)
            rows.append([key, fmt.name, *(f"{worst.ratio:.3f}" for worst in found), str(checked), str(over)])
    goals = [
        Goal("steps whose rounding error exceeds the bound", "0", str(violations), violations == 0),
        Goal("worst found / bound for |h| ≤ 1/4, every program", f"≥ {TIGHT}", f"{least:.3f}", least >= TIGHT),
    ]
    return Section("Worst rounding error of one step that a search finds, over the proved bound", rows, goals)


def sharper_form(generations: int) -> Section:
    """In units of u, for |q|, |v| <= 1: both bounds, and the worst error found."""
    rows = [[PROGRAM, "plain bound", "sharper bound", "worst found", "found / sharper"]]
    for key, step in {**HAND_WRITTEN, "leapfrog": leapfrog}.items():
        for h in (Q(1, 4), Q(1), Q(5, 2)):
            plain = max(step_bound(step).error_of(h, Q(1), Q(1)))
            sharp = max(sharp_bound(step, h).over_box(Q(1), Q(1)))
            worst = _worst_in_box(step, h, generations)
            cells = [f"{float(x / BINARY64.u):.2f}" for x in (plain, sharp, worst)]
            rows.append([f"{key}, h = {h}", *cells, f"{float(worst / sharp):.3f}"])
    return Section("One step with |q|, |v| ≤ 1, in units of u", rows)


def _worst_in_box(step, h: Q, generations: int) -> Q:
    """The largest error found in |q|, |v| <= 1: the bound searched against is the constant u, whatever the state."""
    exact, _, _ = step_bound(step).coefficients
    flat = Envelope(exact, (((), ()), ((), ())), ((BINARY64.u,), (BINARY64.u,)))

    def boxed(force, q, v, size):
        inside = (abs(q) <= 1) & (abs(v) <= 1)
        q1, v1 = step(force, q, v, size)
        return np.where(inside, q1, np.nan), np.where(inside, v1, np.nan)

    found = search(boxed, flat, np.float64, (float(h), float(h)), 2, generations)
    return Q(found.ratio) * BINARY64.u


def forty_steps() -> Section:
    """What is proved of 40 steps for every float run, and the certified rounding error of this one."""
    h, start = Q(1, 4), (Q(1), Q(0))
    rows = [[PROGRAM, "theorem", "with the plain bound", "this run, certified"]]
    for key, step in HAND_WRITTEN.items():
        sharp = run_bound(step, h, 40, start)
        plain = run_bound(step, h, 40, start, local=step_bound(step).at(h))
        q, v = 1.0, 0.0
        for _ in range(40):
            q, v = step(oscillator, q, v, 0.25)
        run = ErrorOfRun(matrix_at(one_step_matrix(METHODS[key]), h), h, 40, start, (Q(q), Q(v)))
        certified = significant(lambda run=run: enclose(run.rounding) / enclose(BINARY64.u), 4)
        rows.append([key, *(f"{float(b.euclidean / BINARY64.u):.1f}" for b in (sharp, plain)), certified])
    return Section("40 steps of h = 1/4 from (1, 0), in units of u", rows)


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
            goals.append(
                Goal("a weight of RK4 wrong by 1e-13 is caught", "100 %", f"{rates[0]:.1f} %", rates[0] == 100)
            )
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


def sections(generations: int = GENERATIONS, checks: int = CHECKS) -> Iterator[Section]:
    """The tables, one after the other, for they take about two minutes together."""
    yield worst_over_bound(generations)
    yield sharper_form(5 * generations)
    yield forty_steps()
    yield anchor()
    yield teeth(checks)


def rows(rounds: int) -> list[Row]:
    """What a bound costs."""
    h, start = Q(1, 4), (Q(1), Q(0))
    tasks = {
        "bound of one step of rk4": lambda: step_bound(rk4).coefficients,
        "sharper bound of one step of rk4, h = 1/4": lambda: sharp_bound(rk4, h),
        "bound of one step of dop853": lambda: step_bound(METHODS["dop853"]).coefficients,
        "bound of 40 steps of rk4, h = 1/4": lambda: run_bound(rk4, h, 40, start),
    }
    return measure([Subject(name, cold_and_warm(task, lambda found: "")) for name, task in tasks.items()], rounds)


def main(arguments: Sequence[str] | None = None) -> None:
    """Search and print, table by table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--generations", type=int, default=GENERATIONS, help=f"of a search (default {GENERATIONS})")
    parser.add_argument("--checks", type=int, default=CHECKS, help=f"random steps of the last table ({CHECKS})")
    chosen = parser.parse_args(arguments)
    for section in sections(chosen.generations, chosen.checks):
        print(section.title, table(section.rows), "", sep="\n", flush=True)
        if section.goals:
            print(table(goal_rows(section.goals)), end="\n\n", flush=True)


if __name__ == "__main__":
    main()
