"""The tableau of a solver's steps with the methods that have it, and whether its other steps are those, too."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

from driftproof.blackbox.findings import Misbehaviour, once
from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem, driven, moved
from driftproof.blackbox.matching.dense_outputs import JudgedDense, judged_reading
from driftproof.blackbox.matching.estimates import is_pair
from driftproof.blackbox.matching.match import Identity, Match, match_method, match_tableau
from driftproof.blackbox.matching.read_order import ReadOrder, read_order
from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.probes.dense import THETAS, DenseReading
from driftproof.blackbox.probes.scripted_answers import (
    NotReadable,
)
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.solvers.foreign_solver import ForeignSolver, RunSlopes, Solution, TooSlow, in_binary32
from driftproof.blackbox.solvers.marked_steps import ROUNDINGS_READ, MarkedStep, stepped
from driftproof.blackbox.stepper.states.array_adapters import as_array
from driftproof.methods.catalogue import EMBEDDED_SUFFIX, METHODS
from driftproof.methods.schemes import Method, RungeKutta
from driftproof.symbolic.rounding.formats import BINARY32

# Runs of a problem whose numbers have all signs and sizes: in words, the origin of its time, start and end, and how
# many numbers.
_RUNS = (
    ("with five components", 0.0, (-1.0, 2.0), 5),
    ("before the time 0", -7.3, (0.25, 2.0), 2),
    ("long after the time 0", 100.1, (-0.5, 1.5), 3),
    ("backward in time", 0.0, (1.5, -0.5), 3),
)
_SIZES, _TOLERANCE = (1.0, -8.0, 2.0**-10), 1e-6
# The middle of a step. The coefficients of the weights of dense output add up to at most 11424 < 2^14 (dop853_dense):
# that many times the rounding of a step.
_MIDDLE, _OF_DENSE = len(THETAS) // 2, 2.0**14
# Constants in binary32 err by 2^28 u, times an h of 2^-6 or so; `_wrong` allows for 20 times 64 roundings already.
_CONSTANTS = 2.0**14


@dataclass(frozen=True)
class SolverSteps:
    """The tableau of a solver's steps, the methods that have it, and its order.

    The coefficients are quotients by the step size, within a few roundings of the code's own. `nodes` are those of all
    calls that an attempt makes after its start, in order, without the last ones at its end. `dense` is the dense output
    of that step if one is returned; `faults` say where other steps differ. A solver that is not `adaptive` makes no use
    of the embedded row of a pair. `given` is a pair of the user's own that has these stages.
    """

    reading: TableauReading
    identity: Identity
    order: ReadOrder
    nodes: tuple[float, ...]
    dense: JudgedDense | None = None
    faults: tuple[str, ...] = ()
    adaptive: bool = True
    given: tuple[RungeKutta, ...] = ()

    @property
    def pairs(self) -> tuple[RungeKutta, ...]:
        """The pairs that propagate these stages, if an attempt makes all the calls that they need."""
        return self._called([*map(METHODS.__getitem__, self.identity.keys), *self.given])

    @property
    def other_pairs(self) -> tuple[RungeKutta, ...]:
        """The catalogue pairs whose other row these stages propagate, if an attempt makes all the calls."""
        rows = ((pair, METHODS[pair.key + EMBEDDED_SUFFIX]) for pair in self._called(METHODS.values()))
        return tuple(pair for pair, other in rows if pair.explicit and match_method(self.reading, other).matches)

    def _called(self, methods: Iterable[Method]) -> tuple[RungeKutta, ...]:
        """The pairs among these, if an attempt makes all the calls that they need."""
        pairs, inner = filter(is_pair, methods if self.adaptive else ()), sum(0 < c < 1 for c in self.nodes)
        return tuple(pair for pair in pairs if sum(bool(0 < c < 1) for c in pair.c) <= inner)

    def held_to(self, pair: RungeKutta) -> SolverSteps:
        """The same with a pair of the user's own, if it has these stages."""
        own = METHODS.get(pair.key) != pair and bool(match_method(self.reading, pair).matches)
        return replace(self, given=(pair,)) if own else self

    @property
    def named(self) -> bool:
        """True if the name is that of a method, exactly or nearly, or called at wrong times."""
        return bool(self.identity.matches or self.identity.near or self._untimed)

    @property
    def _untimed(self) -> Sequence[Match]:
        """The methods that these are where f does not depend on t."""
        return match_tableau(replace(self.reading, c=None)).matches

    @property
    def name(self) -> str:
        """The pair that advances, or else another method of the catalogue, or the nearest; or that it is none."""
        if not self.identity.matches:
            if nearest := next((near.name for near in self.identity.near), ""):
                return nearest
            untimed, none = self._untimed, "no explicit method of the catalogue, judging by its calls"
            return f"{untimed[0].name} called at wrong times" if untimed else none
        return self.pairs[0].key if self.pairs else self.identity.matches[0].name

    @property
    def lines(self) -> list[str]:
        """The tableau as lines, with fractions for numbers within a few roundings of simple ones."""
        rows = [("c", self.reading.c or ()), *((f"a[{i}]", row[:i]) for i, row in enumerate(self.reading.a))]
        shown = [f"{name} = {', '.join(map(self._shown, row))}" for name, row in [*rows, ("b", self.reading.b)] if row]
        other = [f"the row propagated has order {p.claimed_order}, in the pair {p.key}" for p in self.pairs[:1]]
        return [*self.identity.lines, *self.order.lines, *other, *shown]

    def _shown(self, x: float) -> str:
        return coefficient_text(
            x, self.reading.format, ROUNDINGS_READ * float(self.reading.format.u) * max(1.0, abs(x))
        )


@once  # two questions about a solver begin with its steps
def read_steps(subject: ForeignSolver) -> SolverSteps:
    """Read the steps of a solver that returns the times of its steps. Raises NotReadable, saying what was seen."""
    marked = MarkedStep(subject)
    try:
        reading = marked.reading()
    except NotReadable:
        if not marked.reaches_beyond():
            raise
        reading = marked.reading()
    identity = match_tableau(reading)
    order = read_order(reading, next(iter(identity.matches), None))
    dense = marked.dense()
    judged = None if dense is None else judged_reading(dense)
    faults = tuple(_elsewhere(subject, reading))
    if dense and judged and not (judged.faults or faults):
        faults = tuple(_dense_elsewhere(subject, dense))
    return SolverSteps(reading, identity, order, marked.nodes, judged, faults, subject.adaptive)


def _elsewhere(subject: ForeignSolver, reading: TableauReading) -> Iterator[str]:
    """The faults of steps that are not those of the stages read: several numbers, early and late times, backward.

    The tolerance is one in use, so that some steps are rejected.
    """
    for words, problem, run in _further_runs(subject):
        for (t, after), (y, y1) in zip(pairwise(run.t), pairwise(run.y), strict=True):
            said = stepped(reading, problem.rate, t, after - t, y)
            if (i := _wrong(reading, problem, t, y1, said)) is not None:
                seen = f"from t = {t:.6g}, y[{i}] goes to {y1[i]!r} where the stages read give {said[i]!r}"
                yield f"{words}, steps differ from the tableau read: {seen}"
                break


def unlike(subject: ForeignSolver, method: RungeKutta) -> str:
    """Say where most steps with calls at the nodes of an explicit method are not its own; "" if they may be.

    They are those of neither row of a pair, beyond rounding. That is seen of steps whose coefficients are not read.
    """
    rows = [[float(x) for x in row] for row in (method.b, method.b_embedded or method.b)]
    a, c = [[float(x) for x in row] for row in method.a], [float(x) for x in method.c]
    for words, problem, run in _further_runs(subject):
        fmt = BINARY32 if in_binary32(run.t) else run.format
        readings = [TableauReading(tuple(map(tuple, a)), tuple(b), tuple(c), fmt) for b in rows]
        own, wrong = 0, list[str]()
        for (t, after), (y, y1) in zip(pairwise(run.t), pairwise(run.y), strict=True):
            h, near = after - t, ROUNDINGS_READ * float(fmt.u) * (abs(t) + abs(after))
            if not any(c) or any(all(abs(t + x * h - call.t) > near for call in run.calls) for x in c if x):
                continue
            own, said = own + 1, [stepped(each, problem.rate, t, h, y) for each in readings]
            off = [_wrong(each, problem, t, y1, z, _CONSTANTS) for each, z in zip(readings, said, strict=True)]
            if (i := off[0]) is not None and off[1] is not None:
                wrong.append(f"from t = {t:.6g}, y[{i}] goes to {y1[i]!r} where {method.key} gives {said[0][i]!r}")
        if 2 * len(wrong) > own:
            return f"{words}, {len(wrong)} of {own} steps are not its own: {wrong[0]}"
    return ""


def _dense_elsewhere(subject: ForeignSolver, dense: DenseReading) -> Iterator[str]:
    """The faults of a dense output that, in the middle of other steps, is not what the weights read give."""
    half = replace(dense.step, b=dense.rows[_MIDDLE])
    for words, problem, run in _further_runs(subject):
        for (t, after), y in zip(pairwise(run.t), run.y, strict=False):
            said, middle = stepped(half, problem.rate, t, after - t, y), t + (after - t) / 2
            try:
                seen = as_array(run.dense(middle)).astype(float).reshape(len(said)).tolist() if run.dense else said
            except Exception as error:
                yield f"{words}, the dense output at t = {middle:.6g} raises {type(error).__name__}: {error}"
                break
            if (i := _wrong(half, problem, t, seen, said, _OF_DENSE)) is not None:
                values = f"at t = {middle:.6g}, y[{i}] is {seen[i]!r} where the weights read give {said[i]!r}"
                yield f"{words}, the dense output differs from the one read: {values}"
                break


def _further_runs(subject: ForeignSolver) -> Iterator[tuple[str, NonlinearProblem, Solution]]:
    """The further runs in words, their problems and what is returned; a run that fails is reported elsewhere."""
    for words, origin, ends, numbers in _RUNS:
        problem = moved(driven(numbers, timed=True), _SIZES, 1.0, origin)
        start, end = (origin + x for x in ends)
        rate: RunSlopes = lambda n, t, y, problem=problem: problem.rate(t, list(y))  # type: ignore[misc]
        with suppress(Misbehaviour, TooSlow):
            yield words, problem, subject.solve(rate, (start, end), problem.start(start), _TOLERANCE)


def _wrong(
    reading: TableauReading,
    problem: NonlinearProblem,
    t: float,
    seen: Sequence[float],
    said: Sequence[float],
    times: float = 1.0,
) -> int | None:
    """The first number that rounding does not explain, or so many times it; None if there is none."""
    for i, (x, z, s) in enumerate(zip(seen, said, problem.scales, strict=True)):
        # Slopes up to 16 times the numbers move them by 64 times in a step of 4; a time is rounded to u t.
        if not abs(x - z) <= times * reading.rounding.of(64 * max(abs(s), abs(z)) * (1 + abs(t))):
            return i
    return None
