"""Runs of up to 10⁹ steps: energy, rounding and its laws in N, beside the theorem.

About three minutes. Needs numba. Of one trajectory of the oscillator, the rounding error is
|z_N - M^N z₀| with M^N certified, in units of u = 2⁻⁵³, and the theorem is that of `symbolic.rounding.n_steps`. Of
ensembles, of the pendulum too, it is the root mean square of what a plain run and a compensated one differ by, in the
energy and along the motion. All numbers but times are the same on every machine that rounds to nearest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib.util import find_spec
from typing import Any

import numpy as np
from flint import arb

from benchmarks.harness import Goal, Section
from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.steps.engine import compiled_runner
from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.error_budget import ErrorOfRun
from driftproof.symbolic.rounding.n_steps_bound import run_bound
from driftproof.symbolic.runs import apply, as_balls, exact_matrix_at, power

H, START = 2.0**-6, (0.6, -0.8)
# Ensembles take as many steps less as they have members, and the sine of each takes longer still.
LONGEST, MEMBERS, OF_OSCILLATORS, OF_PENDULUMS = 10**9, 128, 10, 100
# The last is not a short binary fraction, and h q is rounded to one side more often than to the other.
RUNS = (("symplectic_euler", H), ("velocity_verlet", H), ("rk4", H), ("velocity_verlet", 1 / 10))
OSCILLATOR, PENDULUM = VectorField(("y1", "-y0")), VectorField(("y1", "-sin(y0)"))
# What the exponent of N may differ by, of root mean squares over the members and three decades.
NEAR = 0.1
U = Fraction(1, 2**53)


@dataclass(frozen=True)
class Run:
    """A run of so many steps: relative energy changes, of the floats and of the exact map; rounding errors over u."""

    key: str
    steps: int
    energy: float
    energy_of_map: float
    rounding: float
    compensated: float
    theorem: float


def decades(most: int, first: int = 1000) -> list[int]:
    """first, 10 first, ..., up to `most`."""
    return [first * 10**i for i in range(len(str(most // first)))]


def long_run(key: str, steps: int, h: float = H) -> Run:
    """One run from the start, plain and compensated."""
    method, start = METHODS[key], (Fraction(START[0]), Fraction(START[1]))
    matrix, finals, errors = exact_matrix_at(method, Fraction(h)), [], []
    for compensated in (False, True):
        q, v = compiled_runner(method, OSCILLATOR, compensated=compensated)(START, h, 0, steps)
        finals.append((Fraction(q), Fraction(v)))
        error = ErrorOfRun(matrix, Fraction(h), steps, start, finals[-1])
        errors.append(float(significant(error.rounding, 4)) / float(U))
    energy = lambda z: z[0] * z[0] + z[1] * z[1]
    of_map = lambda: energy(apply(power(as_balls(matrix), steps), *map(arb, START))) / arb(float(energy(START))) - 1
    theorem = run_bound(method, Fraction(h), steps, start).euclidean
    change = float(energy(finals[0]) / energy(start) - 1)
    return Run(key, steps, change, float(significant(of_map, 6)), errors[0], errors[1], float(theorem / U))


def walk(field: VectorField, counts: Sequence[int], members: int = MEMBERS, h: float = H) -> list[tuple[float, float]]:
    """By number of steps of velocity Verlet: rounding over u of the energy and along the motion, root mean squares.

    Along the motion means in time: that is the phase on the unit circle of the oscillator.
    """
    starts, found = np.random.default_rng(1).uniform(-1, 1, (2, members)), []
    for count in counts:
        (dq, dv), (q, v) = _difference(field, starts, h, count)
        slope = np.sin(q) if field is PENDULUM else q
        energy, time = slope * dq + v * dv, (v * dq - slope * dv) / (v * v + slope * slope)
        rms = lambda x: float(np.sqrt((x * x).mean()) / float(U))
        found.append((rms(energy), rms(time)))
    return found


def _difference(field: VectorField, starts: Any, h: float, count: int) -> tuple[Any, Any]:
    """What a plain run of velocity Verlet is off the compensated one, and that one."""
    finals = []
    for compensated in (False, True):
        run = compiled_runner(METHODS["velocity_verlet"], field, compensated=compensated)
        finals.append(np.array([run(start, h, 0, count) for start in zip(*starts.tolist(), strict=True)]).T)
    return finals[0] - finals[1], finals[1]


def exponent(counts: Sequence[int], sizes: Sequence[float]) -> float:
    """The slope of log size against log N, by least squares."""
    return float(np.polyfit(np.log(counts), np.log(sizes), 1)[0])


def runs_section(most: int) -> Section:
    """One trajectory, with up to `most` steps."""
    rows = [["", "steps", "energy change", "of the exact map", "rounding / u", "compensated / u", "theorem / u"]]
    goals, found = [], list[Run]()
    for key, h in RUNS:
        for steps in decades(most):
            found.append(long_run(key, steps, h))
            run = found[-1]
            name = f"{key}, h = {Fraction(h).limit_denominator(100)}" if steps == decades(most)[0] else ""
            numbers = (run.energy, run.energy_of_map, run.rounding, run.compensated, run.theorem)
            rows.append([name, f"{steps:.0e}".replace("+0", ""), *(f"{x:.3g}" for x in numbers)])
    within = sum(run.rounding <= run.theorem for run in found)
    goals.append(Goal("long runs within the theorem's bound", str(len(found)), str(within), within == len(found)))
    return Section("Long runs of the oscillator", rows, goals)


def laws_section(most: int) -> Section:
    """Ensembles: the powers of N with which rounding grows."""
    rows, goals = [["velocity_verlet, ensemble", "steps", "in the energy / u", "along the motion / u"]], []
    for name, field, share, laws in (
        ("oscillator", OSCILLATOR, OF_OSCILLATORS, (1 / 2, 1 / 2)),
        ("pendulum", PENDULUM, OF_PENDULUMS, (1 / 2, 3 / 2)),
    ):
        counts = decades(most // share)
        sizes = walk(field, counts)
        rows += [
            [name if count == counts[0] else "", f"{count:.0e}".replace("+0", ""), *(f"{x:.3g}" for x in size)]
            for count, size in zip(counts, sizes, strict=True)
        ]
        found = [exponent(counts, [size[i] for size in sizes]) for i in (0, 1)]
        rows.append(["", "exponent of N", *(f"{x:.2f}" for x in found)])
        for what, law, x in zip(("energy", "time"), laws, found, strict=True):
            asked = f"rounding of {what}, {name}: exponent of N"
            goals.append(Goal(asked, f"{law:g} ± {NEAR:g}", f"{x:.2f}", abs(x - law) <= NEAR))
    return Section("Laws of rounding in the number of steps", rows, goals)


def sections(_: int = 1) -> Iterator[Section]:
    """The tables, one after the other; none without numba. Nothing is repeated: only times would differ."""
    if find_spec("numba") is not None:
        yield runs_section(LONGEST)
        yield laws_section(LONGEST)
