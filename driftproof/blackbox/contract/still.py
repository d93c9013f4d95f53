"""A step too short to move anything: whatever it changes nevertheless is no dynamics but a rule about states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import copysign, inf

from driftproof.blackbox.contract.bench import Bench, State
from driftproof.blackbox.contract.clauses import Trial
from driftproof.blackbox.contract.thresholds import Pair, edge
from driftproof.symbolic.rounding.formats import power_of_two

NAMES = ("q", "v")
# Few bits, so that a rule which rounds spares them; then states with all their bits.
_STATES: tuple[State, ...] = ((0.3125, 0.375), (0.27182818284590454, 0.31415926535897931), (0.2236067977499790, 0.3))
# Sums of the stepper's own, as of an angle and pi before it is wrapped, round by this many u at most.
_SLACK = 16


@dataclass(frozen=True)
class Still:
    """A state, and a step `h` that leaves it alone to the last bit; or, if `slack` is not 0, to rounding by a rule."""

    bench: Bench
    h: float
    state: State
    slack: float

    def along(self, component: int, x: float) -> Trial:
        """The short step from the state with x in place of one component."""
        q, v = self.state
        return self.bench.trial(*((x, v) if component == 0 else (q, x)), self.h)

    def scaled(self, factor: float) -> Trial:
        """The short step from a multiple of the state."""
        q, v = (self.bench.number(factor * x) for x in self.state)
        return self.bench.trial(q, v, self.h)

    def keeps(self, trial: Trial) -> bool:
        """True when the state came back, but for what so short a step of an oscillator may do, and for rounding."""
        return self.change(trial) <= 4 * abs(self.h) * _size(trial) + self.slack * max(1.0, _size(trial))

    def change(self, trial: Trial) -> float:
        """How far the state went, in the larger component; infinite where there is none."""
        if trial.answer is None or not trial.finite:
            return inf
        return max(abs(after - before) for after, before in zip(trial.answer, trial.given, strict=False))


def still(bench: Bench) -> Still | None:
    """A short step and a state that it leaves alone; None if there is no such step."""
    if bench.is_coarse:
        return None
    smallest = bench.format.eta, power_of_two(bench.format.emin), power_of_two(bench.format.emin // 8), Fraction(0)
    for h in map(float, smallest):
        states = list(map(bench.scaled, _STATES))
        for slack in (0.0, _SLACK * float(bench.format.u) + bench.grain):
            found = Still(bench, h, states[0], slack)
            if all(found.keeps(bench.trial(*z, h)) for z in states):
                return found
    return None


def _size(trial: Trial) -> float:
    q, v, _ = trial.given
    return max(abs(q), abs(v))


@dataclass(frozen=True)
class Border:
    """Where a ray of states leaves the part that is left alone: the last trial there; the first beyond, and more."""

    kept: Trial
    beyond: tuple[Trial, ...]


def border(
    still: Still, at: Callable[[float], Trial], start: float, points: Sequence[float], hints: Sequence[Pair] = ()
) -> Border | None:
    """The first border on the way from `start`, which is left alone, along the points; None if there is none.

    Overflow is such a border, too: from the first state on that has no finite answer. The `hints` are places where it
    may be.
    """
    last = start
    for place, x in enumerate(points):
        trial = at(x)
        if still.keeps(trial):
            last = x
            continue
        beyond = _beyond_as(trial, still, at)
        # Next to 0 the short step itself moves by more than the distance of floats.
        tiny = copysign(2.0 ** (still.bench.format.emin // 2), x)
        at_zero = last == 0 and beyond(tiny)
        kept, gone = (last, tiny) if at_zero else edge(beyond, last, x, still.bench, hints)
        return Border(at(kept), tuple(map(at, (gone, x, *points[place + 1 : place + 4]))))
    return None


def _beyond_as(trial: Trial, still: Still, at: Callable[[float], Trial]) -> Callable[[float], bool]:
    """Whether a state is on the far side as the trial is: without an answer, or a finite one, or else changed."""
    if trial.answer is None:
        return lambda x: at(x).answer is None
    if not trial.finite:
        return lambda x: not at(x).finite
    return lambda x: not still.keeps(at(x))
