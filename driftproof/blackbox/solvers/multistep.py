"""Multistep solvers: which method advances and how it starts, or which methods, where step sizes vary."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import cos, isclose, sin
from typing import Any

import numpy as np

from driftproof.blackbox.families.imex import WELL_SOLVED
from driftproof.blackbox.families.multistep import read_multistep
from driftproof.blackbox.families.multistep_recurrence import FORWARD_EULER, Recurrence, candidates
from driftproof.blackbox.families.multistep_runs import SteadyRun
from driftproof.blackbox.findings import WrongShape
from driftproof.blackbox.judging.measured_order import order_seen, slopes_text
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.solvers.foreign_solver import COUNT, LENGTH, DoesNotEnd, ForeignSolver, Solution, TooSlow
from driftproof.blackbox.stepper.calling_conventions import FIELD, FUNCTION, GRID, STATE, CallingConvention
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS
from driftproof.methods.multistep import Multistep

# If slopes depend on t alone, the first correction is exact: the residual of a recurrence is rounding.
_SPAN, _TOLERANCES = (0.0, 24.0), (1e-6, 1e-4, 1e-8)
# Step sizes this close are equal: times up to 24 are rounded to u t, and some are sums of many steps.
_SAME = 2.0**-45
# The first bounds the rounding of slopes, which follow t up to 24. A method is recognised only if the exact solution
# leaves a residual, its truncation error, that is larger by the second factor.
_OF_TIMES, _BY_FAR = 32.0, 2.0**10
# The one-step methods with which the Adams-Moulton and the BDF families begin.
_ENDS = (Fraction(-1), Fraction(1))
BACKWARD_EULER = Multistep("backward_euler", "Backward Euler", 1, "", _ENDS, (Fraction(0), Fraction(1)))
TRAPEZOID = Multistep("trapezoid", "Trapezoid", 2, "", _ENDS, (Fraction(1, 2), Fraction(1, 2)))


@dataclass(frozen=True)
class SolverMemory:
    """The multistep method of a solver's steps: its name, its order, and the evidence as lines.

    The order is None if several methods take turns, or if none is known; `faults` are those of the method and its
    start. `settled` is False if f is called neither at the states that the solver returns nor at predicted ones.
    """

    name: str
    order: int | None
    lines: tuple[str, ...]
    faults: tuple[str, ...] = ()
    settled: bool = True
    dense: None = None
    key: str | None = None  # of the catalogue, if it is one without changes
    named: bool = True  # whether the name is that of a method, or of several, exactly or nearly
    remarks: tuple[str, ...] = ()


def read_memory(subject: ForeignSolver) -> SolverMemory:
    """Read the multistep methods of a solver's steps. Raises NotReadable, saying what was seen instead."""
    runs = _equal_steps(subject)
    if runs is None:
        return _varying(subject)
    stepper = runs.stepper()
    for one_step in (BACKWARD_EULER, TRAPEZOID):
        reading = read_multistep(stepper, one_step)
        if reading.recurrence.method is not None or reading.recurrence.recurrence.steps > 1:
            break
    else:
        if not reading.recurrence.theta:
            raise NotReadable(reading.recurrence.name)
    found = reading.recurrence
    if found.recurrence.steps == 1 and found.asked and found.predictor is None:
        alike = f"where slopes depend on t alone, its steps are those of {found.name.partition(',')[0]}, as are those"
        raise NotReadable(f"{alike} of every method with these weights; where they depend on y, {found.asked}")
    order = None if found.facts is None else found.facts.order
    begun = f", started by {reading.start.name}" if reading.start is not None and reading.start.name else ""
    lines = [line for _, part in reading.parts for line in part]
    settled = not found.asked or found.predictor is not None
    remarks = [f"its equations are solved to {found.left:.1e} only"] * (found.left > WELL_SOLVED)
    if order and reading.start is not None and reading.start.order is None and len(reading.start.order_slopes) > 2:
        remarks.append(f"{order_seen(None)} in whole runs (slopes: {slopes_text(reading.start.order_slopes)})")
    of_all = tuple(lines), tuple(reading.faults), settled
    name = found.name + begun
    return SolverMemory(name, order, *of_all, key=reading.key, named=reading.named, remarks=tuple(remarks))


@dataclass(frozen=True)
class SolverRuns:
    """Runs of a solver, run(f, y0, ts), with any number of equal steps of any size.

    If the solver always makes `count` steps, the span is chosen for that; if its steps always have the same `length`,
    the equation is solved in a rescaled time.
    """

    subject: ForeignSolver
    count: int | None
    length: float | None

    def __deepcopy__(self, memo: dict[int, Any]) -> SolverRuns:
        """The same object: a solver starts anew in every run."""
        return self

    def __call__(self, f: Callable[..., Any], y0: Sequence[float], ts: Sequence[float]) -> np.ndarray[Any, Any]:
        """The states at all of ts. Raises WrongShape if the solver makes fewer steps."""
        steps, start, h = len(ts) - 1, float(ts[0]), float(ts[1] - ts[0])
        stretch, made = 1.0 if self.length is None else h / self.length, self.count or steps

        def rate(_: int, at: float, y: tuple[float, ...]) -> list[float]:
            time = at if self.length is None else start + at * stretch
            return [stretch * float(x) for x in f(time, np.array(y))]

        for length in (made, made + 1):  # a solver that rounds span/h down may make one step less
            span = (start, start + length * h) if self.length is None else (0.0, length * self.length)
            found = self.subject.solve(rate, span, y0, steps=length).y
            if len(found) > steps:
                return np.array(found[: steps + 1])
        raise WrongShape(f"it returns {len(found)} states in a run of {steps} steps")

    def stepper(self) -> ForeignStepper:
        """The runs as a stepper, for the instruments that read steps."""
        seen = self.subject.solve(lambda n, t, y: [0.0], (0.0, 1.0), (0.5,))
        calls = CallingConvention(FIELD, (FUNCTION, STATE, GRID), run=True)
        return ForeignStepper(self, calls, ARRAYS, seen.format, pristine=self)


def _equal_steps(subject: ForeignSolver) -> SolverRuns | None:
    """The runs of a solver whose steps have one size, judged by two of them; None if its step sizes vary."""
    if subject.takes in (LENGTH, COUNT):
        return SolverRuns(subject, None, None)
    runs = [subject.solve(lambda n, t, y: _quadrature(t), (0.0, end), (0.0, 0.0)) for end in (1.5, 3.0)]
    short, long = ([b - a for a, b in pairwise(run.t)] for run in runs)
    # The last step is shortened to the end.
    if not all(len(h) > 1 and _is_same(max(h[:-1]), min(h[:-1])) for h in (short, long)):
        return None
    if len(short) == len(long):
        return SolverRuns(subject, len(short), None)
    (h, *_), (other, *_) = short, long
    return SolverRuns(subject, None, h) if _is_same(h, other) else None


def _is_same(h: float, length: float) -> bool:
    return isclose(h, length, rel_tol=0.0, abs_tol=_SAME)


def _quadrature(t: float) -> list[float]:
    return [cos(t), sin(2 * t) / 2]


def _solution(t: float) -> list[float]:
    return [sin(t), sin(t) ** 2 / 2]


def _varying(subject: ForeignSolver) -> SolverMemory:
    """The methods of steps that follow enough others of their size. Raises NotReadable if none is recognised."""
    known = [FORWARD_EULER, BACKWARD_EULER, TRAPEZOID, *candidates(1)]
    seen: Counter[str] = Counter()
    told = steps = 0
    for tolerance in _TOLERANCES:
        try:
            run = subject.solve(lambda n, t, y: _quadrature(t), _SPAN, (0.0, 0.0), tolerance, tolerance)
        except (DoesNotEnd, TooSlow) as failure:  # a method of low order makes too many steps
            if not seen:
                raise NotReadable(str(failure)) from None
            break
        steps += len(run.t) - 1
        for kept in _recognised_steps(run, known):
            told += 1
            seen.update([kept])
        if not seen:
            raise NotReadable(f"of {steps} steps, none that follows others of its size satisfies a known recurrence")
    orders = {m.key: m.claimed_order for m in known}
    if not any(m.key in seen for m in candidates(1)):
        told_alike = f"where slopes depend on t alone, its steps are those of {', '.join(sorted(seen))}"
        raise NotReadable(f"{told_alike}, as are those of every method with these weights")
    names = sorted(seen, key=lambda key: (orders[key], key))
    return SolverMemory(
        f"{', '.join(names)} where its step size is constant",
        None,
        (
            "on y' = (cos t, sin(2 t)/2), which does not show how well it solves for its steps,",
            f"to t = {_SPAN[1]:g} at rtol = {', '.join(f'{x:g}' for x in _TOLERANCES)}:",
            *(f"{seen[key]} steps are those of {key}" for key in names),
            f"so {told} of {steps} steps are identified: those after enough others of their size, and large enough "
            "that methods differ by more than rounding; coefficients for varying step sizes are not read",
        ),
    )


def _recognised_steps(run: Solution, known: Sequence[Multistep]) -> Iterator[str]:
    """For each step after others of its size, the key of its method, if exactly one known method gives it."""
    states, true = np.array(run.y), np.array([*map(_solution, run.t)])
    slopes = np.array([_quadrature(t) for t in run.t])
    recurrences = [(m.key, each, _OF_TIMES * each.rounding) for m in known for each in [Recurrence.of(m, run.format)]]
    lengths, equal = np.diff(run.t), 0
    for n, h in enumerate(lengths):
        equal = equal + 1 if _is_same(h, lengths[n - 1]) else 1
        kept = []
        for key, each, allowed in recurrences:
            if each.steps <= equal:
                rows = slice(n + 1 - each.steps, n + 2)
                left = (each.left(SteadyRun(y[rows], h * slopes[rows])).item() for y in (states, true))
                kept += [key] if next(left) <= allowed and next(left) > _BY_FAR * allowed else []
        if len(kept) == 1:
            yield kept[0]
