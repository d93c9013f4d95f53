"""The coefficients of somebody's implicit Runge-Kutta step, read from its floats by marking its stages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import frexp, fsum
from typing import NamedTuple

from driftproof.blackbox.probes.marked_stages import (
    MarkedRun,
    MarkedSteps,
    Setting,
    StageLabel,
    StageMarks,
    StageShares,
    spread,
)
from driftproof.blackbox.probes.scripted_answers import BACKWARD, NotReadable, Rounding, complaints
from driftproof.blackbox.probes.stage_solutions import UNSOLVED, StageEquations
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

# Where two clocks tell no stages apart that one does not, more of them do not either but in contrived tables.
_MOST_CLOCKS = 2
# What is read once more differs by less where it is a coefficient that a solver has come near to.
_FAR = 2.0**-10
# A solver that goes on leaves less than this; where more is left, stages may have been taken for one.
_DOUBTFUL = 2.0**-30
_AS_ONE = "stages at one time, if there are several, are read as one: its solver does not tell them apart"
# Less than this is what a solver leaves at a guess that is no stage: a stage has a weight, or a place in one that has.
_LEAST = 2.0**-20


def read_implicit_tableau(subject: ForeignStepper) -> TableauReading:
    """The A, b and c of a step(f, t, y, h) with implicit stages, as near as its solver comes to them.

    bᵢ = y(h)/h for y' = [stage i]; and with x' = [stage j], y' = [stage i] x it is y(h) = h² bᵢ aᵢⱼ, longer chains
    lead to stages without a weight. These stage equations are affine and nilpotent: one step of Newton's method with
    any Jacobian by differences solves them up to rounding, and so do as many fixed-point iterations as the chain has
    links; what is left by a solver that stops before shows in a second reading with other numbers, as the `error` of
    the first. Stages are known by their time, or where times coincide or none is handed on, by clocks that run along
    in y. Stages that are equal on every problem are read as one, those that do not count are not.

    Further steps control that the coefficients account for everything, and how well the stages are solved
    (`stage_solutions`). Raises NotReadable, saying what was seen.
    """
    steps = MarkedSteps(subject)
    found: list[TableauReading] = []
    refusals: list[NotReadable] = []
    for clocks in range(not steps.timed, min(_MOST_CLOCKS, steps.size - 1) + 1):
        try:
            found.append(_Probe(steps, steps.marks(clocks)).reading())
        except NotReadable as refusal:
            refusals.append(refusal)
            continue
        if _curved(found[-1]) <= _DOUBTFUL:
            break
    if not found:
        raise refusals[0]
    return _best(found)


def _best(found: Sequence[TableauReading]) -> TableauReading:
    """The reading with the fewest clocks, unless more of them tell stages apart of which the nonlinear step is made.

    Raises NotReadable where none accounts for nonlinear steps, and no solver that stops early does, either.
    """
    first = found[0]
    best = next((reading for reading in found if _curved(reading) <= _DOUBTFUL), first)
    if _curved(best) <= UNSOLVED:
        return best
    if best.solved is None or not best.solved.power:
        raise NotReadable(
            f"on nonlinear problems the step is off by {_curved(best):.1e} of what its coefficients say: a solver that "
            "stops too early, or other stages"
        )
    return best if len(found) > 1 else replace(best, remarks=(*best.remarks, _AS_ONE))


def _curved(reading: TableauReading) -> float:
    return 0.0 if reading.solved is None else reading.solved.curved


class _Variant(NamedTuple):
    setting: Setting
    amplitude: float


# Read from the first; another start, time, h and size show what the solver leaves. Powers of two: products are exact.
_VARIANTS = (_Variant(Setting(), 1.0), _Variant(Setting(1.0, 1.0, 0.5), -1.0))


class _Probe:
    """Chains of marked stages in steps of one subject, with one way to tell its stages apart."""

    def __init__(self, steps: MarkedSteps, marks: StageMarks) -> None:
        self.steps, self.marks = steps, marks
        self.off = 0.0

    def reading(self) -> TableauReading:
        """The coefficients, controlled."""
        labels, fmt = self.marks.labels, self.steps.subject.format
        weights = {label: self._chained([label], 1.0) for label in labels}
        chains = {label: ([label], weight) for label, weight in weights.items() if abs(weight) > _LEAST}
        if not chains:
            raise NotReadable("no stage of it has a weight")
        rows: dict[StageLabel, dict[StageLabel, float]] = {}
        while left := [label for label in chains if label not in rows]:
            chain, product = chains[left[0]]
            row = rows[left[0]] = {label: self._chained([*chain, label], product) for label in labels}
            found = {label: x for label, x in row.items() if abs(x) > _LEAST and label not in chains}
            chains |= {label: ([*chain, label], product * x) for label, x in found.items()}
        kept = [label for label in labels if label in rows]
        self.marks = self.marks.only(kept)
        a = tuple(tuple(self._cleaned(rows[i][j]) for j in kept) for i in kept)
        if _is_explicit(a):
            raise NotReadable("none of its stages is implicit")
        b = tuple(self._cleaned(weights[i]) for i in kept)
        c = tuple(self.marks.nodes[label[0]] for label in kept) if self.steps.timed else None
        reading = TableauReading(a, b, c, fmt, stage_error=self._left)
        for variant in _VARIANTS:
            self._demand_chain(reading, kept, variant)
        equations = StageEquations(self.steps, reading)
        equations.demand_solver()
        reading = replace(reading, solved=equations.solved())
        return replace(reading, remarks=complaints(lambda: equations.demand_solved(BACKWARD)))

    def _demand_chain(self, reading: TableauReading, kept: Sequence[StageLabel], variant: _Variant) -> None:
        """Raises NotReadable unless a chain through all stages at once goes as the coefficients say.

        x' = g(i), y' = g(i) x, ... at each stage i, with other g for each number: all aᵢⱼ aⱼₖ ... are in its end, so
        that stages which were taken for one show. In the second variant the chain runs through y from its other end.
        """
        setting, size = variant
        count, backward = self.steps.size - len(self.marks.hands), size < 0
        weights = [{label: spread((3 * i + 1) * (link + 1)) for i, label in enumerate(kept)} for link in range(count)]

        def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
            given = [1.0, *(moved[::-1] if backward else moved)]
            known = [(label, share) for label, share in shares.items() if label in weights[0]]
            own = [x * fsum(share * g[label] for label, share in known) for x, g in zip(given, weights, strict=False)]
            return own[::-1] if backward else own

        run = self.steps.run(self.marks, setting, slopes)
        seen = run.result[len(self.marks.hands) :][0 if backward else -1] - setting.start
        at, largest = [1.0] * len(kept), max(1.0, *(fsum(map(abs, row)) for row in (*reading.a, reading.b)))
        for link, row in enumerate(weights):
            pulled = [row[label] * x for label, x in zip(kept, at, strict=True)]
            rows = reading.a if link < count - 1 else [reading.b]
            at = [setting.h * fsum(x * k for x, k in zip(entries, pulled, strict=True)) for entries in rows]
        # Each of the factors, which are up to 2 and sums of A's rows, is off by what the coefficients are off by.
        allowed = count * (2 * largest) ** count * reading.rounding.of(1.0) + UNSOLVED * max(1.0, abs(at[0]))
        if not abs(seen - at[0]) <= allowed:
            raise NotReadable(
                f"with its stages marked, a chain of {count} of them comes to {seen:.6g} where the coefficients read "
                f"say {at[0]:.6g}: another step than of these stages"
            )

    def _chained(self, chain: Sequence[StageLabel], product: float) -> float:
        """What the last link of a chain i, j, ..., k adds to the product bᵢ aᵢⱼ ... of the others, as a factor."""
        seen = [self._once(variant, chain, product) for variant in _VARIANTS]
        off = abs(seen[0] - seen[1])
        if off > _FAR * max(1.0, *map(abs, seen)):
            raise NotReadable(
                f"with its stages marked, a coefficient is {seen[0]:.6g}, and {seen[1]:.6g} with another start, time, "
                "h and size: a solver that stops too early, or another step than of stages"
            )
        self.off = max(self.off, off)
        return seen[0]

    def _once(self, variant: _Variant, chain: Sequence[StageLabel], product: float) -> float:
        links, clocks = len(chain), len(self.marks.hands)
        if links + clocks > self.steps.size:
            raise NotReadable(f"a chain of {links} stages needs more than the {self.steps.size} numbers that it takes")
        # So large that what comes out is of size 1: a solver's tolerance is absolute as a rule.
        size = variant.amplitude * 2.0 ** -frexp(product)[1]
        marked = chain[::-1]

        def slopes(shares: StageShares, moved: Sequence[float]) -> Sequence[float]:
            given = [size, *moved[: links - 1]]
            own = [x * shares.get(mark, 0.0) for x, mark in zip(given, marked, strict=True)]
            return [*own, *[0.0] * (len(moved) - links)]

        run: MarkedRun = self.steps.run(self.marks, variant.setting, slopes, size=links)
        start, _, h = variant.setting
        return (run.result[clocks + links - 1] - start) / (size * product * h**links)

    @property
    def _left(self) -> float:
        """What the two readings differ by at most; and what elimination in a dozen unknowns may lose."""
        return self.off + 32 * float(self.steps.subject.format.u)

    def _counts(self, x: float) -> bool:
        return abs(x) > Rounding(self.steps.subject.format, 1, 4 * self._left).of(1.0)

    def _cleaned(self, x: float) -> float:
        return x if self._counts(x) else 0.0


def _is_explicit(a: Sequence[Sequence[float]]) -> bool:
    """True when no stage depends on itself, by way of whichever others."""
    left = set(range(len(a)))
    while ready := {i for i in left if not any(a[i][j] for j in left)}:
        left -= ready
    return not left
