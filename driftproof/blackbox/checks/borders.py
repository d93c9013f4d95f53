"""Borders between states that a negligible step leaves unchanged and states that it changes, found to the float.

A step too short to move anything changes a state only by a rule about states, such as a cap or a reset.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from math import copysign, inf, pi, sqrt

import numpy as np

from driftproof.blackbox.checks.trials import PhasePoint, Trial, TrialRunner
from driftproof.blackbox.findings import NoAnswer
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, power_of_two

Neighbours = tuple[float, float]
COMPONENT_NAMES = ("q", "v")
# A state with few bits, which a rule that rounds leaves unchanged; then states with all their bits.
_STATES = (0.3125, 0.375), (0.27182818284590454, 0.31415926535897931), (0.2236067977499790, 0.3)
# Sums inside the stepper, such as an angle plus pi before and after it is wrapped, round numbers up to 4 times the
# state, by this many u at most.
_SLACK = 16


@dataclass(frozen=True)
class NegligibleStep:
    """A state, and a step `h` that leaves it unchanged to the last bit, or to `slack` where a rule rounds."""

    runner: TrialRunner
    h: float
    state: PhasePoint
    slack: float

    def along(self, component: int, x: float) -> Trial:
        """The short step from the state with x in place of one component."""
        q, v = self.state
        return self.runner.trial(*((x, v) if component == 0 else (q, x)), self.h)

    def scaled(self, factor: float) -> Trial:
        """The short step from a multiple of the state."""
        q, v = (self.runner.number(factor * x) for x in self.state)
        return self.runner.trial(q, v, self.h)

    def keeps(self, trial: Trial) -> bool:
        """True if the state came back, but for rounding and what so short a step of an oscillator may do."""
        return self.change(trial) <= 4 * abs(self.h) * _size(trial) + self.slack * max(1.0, _size(trial))

    def keeps_other(self, component: int, trial: Trial) -> bool:
        """True if the other component came back, as in `keeps`."""
        assert trial.answer is not None
        other, size = 1 - component, abs(trial.given[component])
        return abs(trial.answer[other] - trial.given[other]) <= 4 * self.h * size + self.slack * max(1.0, size)

    def change(self, trial: Trial) -> float:
        """How far the state went, in the larger component; infinite if there is no finite answer."""
        if trial.answer is None or not trial.finite:
            return inf
        return max(abs(after - before) for after, before in zip(trial.answer, trial.given, strict=False))


def negligible_step(runner: TrialRunner) -> NegligibleStep | None:
    """A short step and a state that it leaves unchanged; None if there is no such step."""
    if runner.is_coarse:
        return None
    smallest = runner.format.eta, power_of_two(runner.format.emin), power_of_two(runner.format.emin // 8), Fraction(0)
    for h in map(float, smallest):
        states = list(map(runner.scaled, _STATES))
        for slack in (0.0, _SLACK * float(runner.format.u) + runner.grain):
            found = NegligibleStep(runner, h, states[0], slack)
            with suppress(NoAnswer):
                if all(found.keeps(runner.trial(*z, h)) for z in states):
                    return found
    return None


def _size(trial: Trial) -> float:
    q, v, _ = trial.given
    return max(abs(q), abs(v))


@dataclass(frozen=True)
class Border:
    """The border of a ray of states: the last trial that leaves its state unchanged; the first beyond, and more."""

    kept: Trial
    beyond: tuple[Trial, ...]

    @property
    def example(self) -> tuple[Trial, Trial]:
        """The last state that is left unchanged, and the first that is not."""
        return self.kept, self.beyond[0]


def border(
    short: NegligibleStep,
    at: Callable[[float], Trial],
    start: float,
    points: Sequence[float],
    hints: Sequence[Neighbours] = (),
) -> Border | None:
    """The first border on the way from `start`, which is left unchanged, along the points; None if there is none.

    Overflow is such a border as well, from the first state without a finite answer. The `hints` are tried first.
    """
    last = start
    for place, x in enumerate(points):
        trial = at(x)
        if short.keeps(trial):
            last = x
            continue
        beyond = _beyond_as(trial, short, at)
        # Next to 0 even the short step moves the state by more than the distance of floats.
        tiny = copysign(2.0 ** (short.runner.format.emin // 2), x)
        at_zero = last == 0 and beyond(tiny)
        kept, gone = (last, tiny) if at_zero else bisected_neighbours(beyond, last, x, short.runner, hints)
        return Border(at(kept), tuple(map(at, (gone, x, *points[place + 1 : place + 4]))))
    return None


def _beyond_as(trial: Trial, short: NegligibleStep, at: Callable[[float], Trial]) -> Callable[[float], bool]:
    """The test for states beyond the border like this trial: no answer, no finite one, or else a changed state."""
    if trial.answer is None:
        return lambda x: at(x).answer is None
    if not trial.finite:
        return lambda x: not at(x).finite
    return lambda x: not short.keeps(at(x))


def bisected_neighbours(
    changed: Callable[[float], bool], kept: float, gone: float, runner: TrialRunner, hints: Sequence[Neighbours] = ()
) -> Neighbours:
    """Neighbours a, b of the format between `kept` and `gone`, with a unchanged and b changed, as these ends are.

    Both ends have one sign, or `kept` is 0. The hints, which are neighbours in the same order, are tried first, then
    numbers with few digits, as most thresholds have.
    """
    low, high = kept, gone

    def inside(x: float) -> bool:
        return min(low, high) < x < max(low, high)

    for a, b in hints:
        if inside(a) and inside(b) and changed(b) and not changed(a):
            return a, b
    while inside(middle := _middle(low, high, runner)):
        short = next(filter(inside, _by_roundness(middle, runner)), None)
        if short is not None:
            low, high = (low, short) if changed(short) else (short, high)
            middle = runner.beside(short, low if short == high else high)  # if the threshold is here, that ends it
        low, high = (low, middle) if changed(middle) else (middle, high)
    return low, high


def _by_roundness(centre: float, runner: TrialRunner) -> Iterator[float]:
    """Numbers near the centre that a programmer may have chosen, those with the fewest digits first."""
    yield from (runner.number(copysign(x, centre)) for x in (pi, 2 * pi, pi / 2))
    # Beyond six digits nobody chose the number, and halving is quicker.
    yield from (runner.number(float(f"{centre:.{digits}e}")) for digits in range(6))


def _middle(low: float, high: float, runner: TrialRunner) -> float:
    """The geometric mean while the ends are far apart, then the arithmetic mean."""
    small, large = sorted((abs(low), abs(high)))
    if small == 0:
        small = float(runner.format.eta)
        if small == large:
            return low
    middle = sqrt(small) * sqrt(large) if large > 4 * small else small + (large - small) / 2
    return runner.number(copysign(middle, high))


def short_name(x: float) -> str:
    """x as a reader writes it: 100, 0.01, -2 pi, 0.1 in binary32; with all digits if it has no short name."""
    for part, name in ((pi, "pi"), (2 * pi, "2 pi"), (pi / 2, "pi/2")):
        if abs(x) == part:
            return f"{'-' * (x == -part)}{name}"
    if x == 0:
        return "0"
    for kind, fmt in ((np.float16, BINARY16), (np.float32, BINARY32)):
        if float(fmt.largest) > abs(x) == float(kind(abs(x))) and len(str(kind(x))) < len(repr(x)):
            return f"{str(kind(x)).removesuffix('.0')} in {fmt.name}"
    return repr(x).removesuffix(".0")


def shorter_number(first: float, second: float) -> float:
    """The number with the shorter name; the first if both are equally short."""
    return min((first, second), key=lambda x: len(short_name(x)))
