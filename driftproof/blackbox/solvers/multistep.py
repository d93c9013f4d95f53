"""Solvers whose steps remember: which multistep method advances, how it starts; or which ones, where steps vary."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import cos, isclose, sin
from typing import Any

import numpy as np

from driftproof.blackbox.families.multistep import read_multistep
from driftproof.blackbox.families.multistep_recurrence import FORWARD_EULER, Recurrence, candidates
from driftproof.blackbox.families.multistep_runs import SteadyRun
from driftproof.blackbox.findings import WrongShape
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.solvers.foreign_solver import COUNT, LENGTH, DoesNotEnd, ForeignSolver, Solution
from driftproof.blackbox.stepper.array_adapters import ARRAYS
from driftproof.blackbox.stepper.calling_conventions import FIELD, FUNCTION, GRID, STATE, CallingConvention
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.methods.multistep import Multistep

# Of slopes that are a function of t alone every correction is the first: what is left of a recurrence is rounding.
_SPAN, _TOLERANCES = (0.0, 24.0), (1e-6, 1e-4, 1e-8)
# Two steps are of one length if their times, up to 24 and rounded to u t, and sums of some, cannot tell them apart.
_SAME = 2.0**-45
# t is up to 24, rounded to u t, and the slopes change as fast as t; a method is told where what the solution itself
# leaves of its recurrence, its truncation error, is more by far.
_OF_TIMES, _BY_FAR = 32.0, 2.0**10
# Of one step, as Adams-Moulton's and BDF's families begin.
_ENDS = (Fraction(-1), Fraction(1))
BACKWARD_EULER = Multistep("backward_euler", "Backward Euler", 1, "", _ENDS, (Fraction(0), Fraction(1)))
TRAPEZOID = Multistep("trapezoid", "Trapezoid", 2, "", _ENDS, (Fraction(1, 2), Fraction(1, 2)))


@dataclass(frozen=True)
class SolverMemory:
    """What the steps of a solver are that are made of more than the state before: by name, of which order, in words.

    The order is None where several methods take turns, or none is known; `faults` are of that method and its start.
    `settled` is False where f is asked neither at the states that the solver returns nor at predicted ones.
    """

    name: str
    order: int | None
    lines: tuple[str, ...]
    faults: tuple[str, ...] = ()
    settled: bool = True
    dense: None = None


def read_memory(subject: ForeignSolver) -> SolverMemory:
    """The multistep methods of a solver's steps. Raises NotReadable where they are others, saying what was seen."""
    runs = _equal_steps(subject)
    if runs is None:
        return _varying(subject)
    stepper = runs.stepper()
    for one_step in (BACKWARD_EULER, TRAPEZOID):
        reading = read_multistep(stepper, one_step)
        if reading.recurrence.method is not None or reading.recurrence.recurrence.steps > 1:
            break
    else:
        raise NotReadable(reading.recurrence.name)
    order = None if reading.recurrence.facts is None else reading.recurrence.facts.order
    begun = f", started by {reading.start.name}" if reading.start is not None and reading.start.name else ""
    lines = [line for _, part in reading.parts for line in part]
    settled = not reading.recurrence.asked or reading.recurrence.predictor is not None
    return SolverMemory(reading.recurrence.name + begun, order, tuple(lines), tuple(reading.faults), settled)


@dataclass(frozen=True)
class SolverRuns:
    """Runs of a solver of as many steps, and of the length, that are asked for: run(f, y0, ts).

    A solver with a number of steps of its own, `count`, is given so long a span; one with a `length` of its own an
    equation in another time, in which the steps asked for are so long.
    """

    subject: ForeignSolver
    count: int | None
    length: float | None

    def __deepcopy__(self, memo: dict[int, Any]) -> SolverRuns:
        """Itself: a solver begins anew in every run."""
        return self

    def __call__(self, f: Callable[..., Any], y0: Sequence[float], ts: Sequence[float]) -> np.ndarray[Any, Any]:
        """The states at all of ts. Raises WrongShape where the solver makes fewer steps."""
        steps, start, h = len(ts) - 1, float(ts[0]), float(ts[1] - ts[0])
        stretch, made = 1.0 if self.length is None else h / self.length, self.count or steps

        def rate(_: int, at: float, y: tuple[float, ...]) -> list[float]:
            time = at if self.length is None else start + at * stretch
            return [stretch * float(x) for x in f(time, np.array(y))]

        for length in (made, made + 1):  # whose number of steps is the whole part of a quotient may make one less
            span = (start, start + length * h) if self.length is None else (0.0, length * self.length)
            found = self.subject.solve(rate, span, y0, steps=length).y
            if len(found) > steps:
                return np.array(found[: steps + 1])
            if self.count:
                break
        raise WrongShape(f"it returns {len(found)} states in a run of {steps} steps")

    def stepper(self) -> ForeignStepper:
        """The same for the instruments that read steps."""
        seen = self.subject.solve(lambda n, t, y: [0.0], (0.0, 1.0), (0.5,))
        calls = CallingConvention(FIELD, (FUNCTION, STATE, GRID), run=True)
        return ForeignStepper(self, calls, ARRAYS, seen.format, pristine=self)


def _equal_steps(subject: ForeignSolver) -> SolverRuns | None:
    """The solver as one that makes steps of one length, told from two runs; None where its lengths vary."""
    if subject.takes in (LENGTH, COUNT):
        return SolverRuns(subject, None, None)
    runs = [subject.solve(lambda n, t, y: _quadrature(t), (0.0, end), (0.0, 0.0)) for end in (1.5, 3.0)]
    lengths = [[b - a for a, b in pairwise(run.t)] for run in runs]
    # The last step is cut to the end.
    if not all(len(h) > 1 and _is_same(max(h[:-1]), min(h[:-1])) for h in lengths):
        return None
    if len(lengths[0]) == len(lengths[1]):
        return SolverRuns(subject, len(lengths[0]), None)
    return SolverRuns(subject, None, lengths[0][0]) if _is_same(lengths[0][0], lengths[1][0]) else None


def _is_same(h: float, length: float) -> bool:
    return isclose(h, length, rel_tol=0.0, abs_tol=_SAME)


def _quadrature(t: float) -> list[float]:
    return [cos(t), sin(2 * t) / 2]


def _solution(t: float) -> list[float]:
    return [sin(t), sin(t) ** 2 / 2]


def _varying(subject: ForeignSolver) -> SolverMemory:
    """The methods of the steps that follow enough others of their own length. Raises NotReadable if there are none."""
    known = [FORWARD_EULER, BACKWARD_EULER, TRAPEZOID, *candidates(1)]
    seen: Counter[str] = Counter()
    told = steps = 0
    for tolerance in _TOLERANCES:
        try:
            run = subject.solve(lambda n, t, y: _quadrature(t), _SPAN, (0.0, 0.0), tolerance, tolerance)
        except DoesNotEnd as failure:  # of low order
            if not seen:
                raise NotReadable(str(failure)) from None
            break
        steps += len(run.t) - 1
        for kept in _of_stretches(run, known):
            told += 1
            seen.update([kept])
        if not seen:
            raise NotReadable(f"of {steps} steps none that follows others of its length keeps a recurrence known here")
    orders = {m.key: m.claimed_order for m in known}
    if not any(m.key in seen for m in candidates(1)):
        told_alike = f"where slopes depend on t alone, its steps are those of {', '.join(sorted(seen))}"
        raise NotReadable(f"{told_alike}, as are those of every method with these weights")
    names = sorted(seen, key=lambda key: (orders[key], key))
    return SolverMemory(
        f"{', '.join(names)} where its steps are of one length",
        None,
        (
            "on y' = (cos t, sin(2 t)/2), which does not tell how well it solves for its steps,",
            f"to t = {_SPAN[1]:g} at rtol = {', '.join(f'{x:g}' for x in _TOLERANCES)}:",
            *(f"{seen[key]} steps are of {key}" for key in names),
            f"so {told} of {steps} steps are told: those after enough others of their length, and long enough that "
            "methods differ by more than rounding; coefficients between steps of several lengths are not read",
        ),
    )


def _of_stretches(run: Solution, known: Sequence[Multistep]) -> Iterator[str]:
    """The method of each step that only one of these methods gives from those before it, all of its length."""
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
