"""Rounding bounds against the worst that searches find: `python benchmarks/roundoff.py` (about two minutes)."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from fractions import Fraction as Q
from importlib.metadata import version
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from driftproof.text import table
from methods.catalogue import METHODS
from methods.problems import oscillator
from methods.stepping import stepper
from methods.tables import basic
from numeric.leapfrog import leapfrog
from numeric.steppers import HAND_WRITTEN, rk4
from numeric.worst_case import Envelope
from numeric.worst_case_search import search
from symbolic.certified import enclose, significant
from symbolic.n_steps import apply, matrix_at
from symbolic.one_step import one_step_matrix
from symbolic.rounding.error_of_run import ErrorOfRun
from symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from symbolic.rounding.n_steps import run_bound
from symbolic.rounding.sharp import sharp_bound
from symbolic.rounding.step import step_bound

FORMATS = {BINARY64: np.float64, BINARY32: np.float32, BINARY16: np.float16}
RANGES = {"|h| <= 1/4": (0.0, 0.25), "|h| = 1/4": (0.25, 0.25), "|h| = 1": (1.0, 1.0), "|h| = 5/2": (2.5, 2.5)}
PROGRAMS = {**HAND_WRITTEN, "leapfrog": leapfrog} | {f"generic {m.key}": m for m in basic.ENTRIES}


def worst_over_bound() -> str:
    rows = [["worst error found / bound", "format", *RANGES, "steps checked", "violations"]]
    for key, subject in PROGRAMS.items():
        step = subject if callable(subject) else stepper(subject, float)
        for fmt, dtype in FORMATS.items():
            envelope = Envelope(*step_bound(subject, fmt).coefficients)
            found = [search(step, envelope, dtype, h_range, seed=1, generations=24) for h_range in RANGES.values()]
            ratios = [f"{worst.ratio:.3f}" for worst in found]
            checked, violations = (sum(getattr(w, name) for w in found) for name in ("checked", "violations"))
            rows.append([key, fmt.name, *ratios, str(checked), str(violations)])
    return table(rows, right=range(2, len(rows[0])))


def sharper_form() -> str:
    rows = [["in units of u, for |q|, |v| <= 1", "plain bound", "sharper bound", "worst found", "found / sharper"]]
    for key, step in {**HAND_WRITTEN, "leapfrog": leapfrog}.items():
        for h in (Q(1, 4), Q(1), Q(5, 2)):
            plain = max(step_bound(step).error_of(h, Q(1), Q(1)))
            sharp = max(sharp_bound(step, h).over_box(Q(1), Q(1)))
            worst = _worst_in_box(step, h)
            cells = [f"{float(x / BINARY64.u):.2f}" for x in (plain, sharp, worst)]
            rows.append([f"{key}, h = {h}", *cells, f"{float(worst / sharp):.3f}"])
    return table(rows, right=range(1, 5))


def _worst_in_box(step, h: Q) -> Q:
    """The largest error found in |q|, |v| <= 1: the bound searched against is the constant u, whatever the state."""
    exact, _, _ = step_bound(step).coefficients
    flat = Envelope(exact, (((), ()), ((), ())), ((BINARY64.u,), (BINARY64.u,)))

    def boxed(force, q, v, size):
        inside = (abs(q) <= 1) & (abs(v) <= 1)
        q1, v1 = step(force, q, v, size)
        return np.where(inside, q1, np.nan), np.where(inside, v1, np.nan)

    found = search(boxed, flat, np.float64, (float(h), float(h)), seed=2, generations=128)
    return Q(found.ratio) * BINARY64.u


def forty_steps() -> str:
    h, start = Q(1, 4), (Q(1), Q(0))
    rows = [["40 steps of 1/4 from (1, 0), in units of u", "theorem", "with the plain bound", "this run, certified"]]
    for key, step in HAND_WRITTEN.items():
        sharp = run_bound(step, h, 40, start)
        plain = run_bound(step, h, 40, start, local=step_bound(step).at(h))
        q, v = 1.0, 0.0
        for _ in range(40):
            q, v = step(oscillator, q, v, 0.25)
        run = ErrorOfRun(matrix_at(one_step_matrix(METHODS[key]), h), h, 40, start, (Q(q), Q(v)))
        certified = significant(lambda run=run: enclose(run.rounding) / enclose(BINARY64.u), 4)
        rows.append([key, *(f"{float(b.euclidean / BINARY64.u):.1f}" for b in (sharp, plain)), certified])
    return table(rows, right=range(1, 4))


def anchor() -> str:
    h, start, steps = Q(1, 32), (Q(1), Q(0)), 1000
    q, v, size = np.float32(1), np.float32(0), np.float32(1) / np.float32(32)
    for _ in range(steps):
        q, v = leapfrog(oscillator, q, v, size)
    matrix = matrix_at(one_step_matrix(METHODS["velocity_verlet"]), h)
    run = ErrorOfRun(matrix, h, steps, start, (Q(float(q)), Q(float(v))))
    bound = run_bound(leapfrog, h, steps, start, BINARY32).euclidean
    proved = lambda: enclose(run.truncation) + enclose(bound)
    rows = [
        ["binary32 leapfrog, h = 1/32, N = 1000, from q = 1, v = 0", ""],
        ["certified error of the run", significant(run.total, 12)],
        ["  truncation", significant(run.truncation, 12)],
        ["  rounding", significant(run.rounding, 12)],
        ["theorem's bound on rounding", significant(bound, 6)],
        ["proved bound on the error: truncation + theorem", significant(proved, 6)],
        ["proved by VerifiedLeapfrog", "0.0308"],
        ["times better", significant(lambda: enclose(Q(308, 10**4)) / proved(), 4)],
    ]
    return table(rows)


def teeth(checks: int = 1000) -> str:
    matrix, bound = one_step_matrix(METHODS["rk4"]), step_bound(rk4)
    rng = np.random.default_rng(3)
    points = [
        tuple(map(float, p)) for p in zip(rng.uniform(0, 2.5, checks), *rng.uniform(-1, 1, (2, checks)), strict=True)
    ]
    rows = [
        ["RK4, last weight wrong by", "caught by the bound", "by a tolerance of 1e-12", f"of {checks} random steps"]
    ]
    for error in (0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11):
        seen = [_caught(_wrong_rk4(error), matrix, bound, *point) for point in points]
        rates = (f"{100 * sum(column) / checks:.1f} %" for column in zip(*seen, strict=True))
        rows.append([f"{error:g}", *rates, ""])
    return table(rows, right=(1, 2))


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


def footer() -> str:
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "sympy", "python-flint"))
    command, at = f"python {' '.join(sys.argv)}", commit.stdout.strip() or "unknown"
    machine = f"{platform.machine()}, {os.cpu_count()} cores"
    return f"{command}; commit {at}; Python {platform.python_version()}, {versions}; {machine}"


if __name__ == "__main__":
    for section in (worst_over_bound, sharper_form, forty_steps, anchor, teeth, footer):
        print(section(), end="\n\n", flush=True)
