"""Runs of a right-hand side, whatever its numbers are: comparisons, floors, constants, and what is refused."""

from __future__ import annotations

import linecache
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, floor
from numbers import Rational
from threading import RLock
from types import FrameType
from typing import Any, TypeAlias

import numpy as np
from flint import arb, arb_series, ctx, fmpq

from driftproof.methods.numbers.flint_rationals import dyadic

# A ball, a Taylor series or a Taylor model; all of one evaluation are of the same kind, but constants are balls.
Value: TypeAlias = Any
# Whose lines are not the user's, and how much of one of these is quoted.
_OURS, _LONGEST_LINE = ("driftproof", "numpy", "scipy"), 80
_ONE_THREAD = RLock()


@contextmanager
def in_bits(bits: int) -> Iterator[None]:
    """Compute with so many bits, and no other enclosure meanwhile: FLINT's precision is that of the whole process.

    Other code that sets FLINT's precision must not run in another thread.
    """
    with _ONE_THREAD, ctx.workprec(bits):
        yield


class Refused(ArithmeticError):
    """Nothing can be proved; the message names the obstacle and, if there is one, the remedy.

    >>> from driftproof import Refused, certify
    >>> try:
    ...     certify(lambda t, y: y, [0.0, 1.0, 0.5], [[1.0], [2.7], [1.6]])
    ... except Refused as refusal:
    ...     print(refusal)
    times must increase, but t[2] = 0.5 is not above t[1] = 1.0

    `t` is the time that the enclosure reached if more bits may lead further, else None.
    """

    # The number of refusals made so far, in any thread: if it has grown when a run of f ends normally, f caught one.
    made = 0

    def __init__(self, message: str, t: Fraction | None = None) -> None:
        super().__init__(message)
        self.t = t
        Refused.made += 1


class Stiff(Refused):
    """Too many explicit steps would be needed, because some component decays fast; implicit steps may succeed."""


class ZeroByZero(Refused):
    """f divides a number that may be 0 by one that may be 0."""


class Overlapping(Refused):
    """f compares numbers, or takes the floor of one, and the balls allow two outcomes."""


TWO_RUNS = "certify the points before it and those after it as two runs, each from its own first point"


def not_smooth(t: Fraction | float, obstacle: Refused | None, *, at_start: bool = False) -> Refused:
    """The refusal of steps that end at a pole, a 0/0 or a kink near t, with the way on, from what f refuses ahead."""
    near = f"near t = {float(t):.9g}"
    if isinstance(obstacle, ZeroByZero):
        remedy = "where that is no pole, write x/(1 - exp(-x)) as 1/exprel(-x), exprel from scipy.special, and "
        remedy += "sin(x)/x as np.sinc(x / np.pi), in functions for certify; "
        remedy += "problems on which methods are compared cannot have them"
        return Refused(f"f divides 0, or nearly 0, by 0 {near}; {remedy}")
    if isinstance(obstacle, Overlapping):
        said = "that the solution crosses the kink or jump of f there, as of abs, max or an if, is not proved: it may"
        way = "as it starts there, write f as it is on the side to which the solution goes" if at_start else TWO_RUNS
        return Refused(f"f compares numbers that are equal {near}; {said} touch or follow it; {way}")
    said = f"f or the solution has a pole, or f is not smooth, {near}"
    return Refused(f"{said}; if f jumps there, {TWO_RUNS}")


@dataclass
class Evaluation:
    """One run of a right-hand side: the outcomes of its comparisons, and the doubles that it read.

    It decides comparisons at a point, or for all times of a step, on the step's polynomial or on the set around it that
    holds the solutions. `taken` collects the outcomes, and the integers of floors. `span` holds the first and last time
    of a step, the last None for times just after the first, for comparisons of the time (see `clocks`); it is None at a
    single time. Models are compared for 0 <= σ <= 1 if it goes `forward` from the middle of their disc, else for
    -1 <= σ <= 1.
    """

    taken: list[int] = field(default_factory=list)
    doubles: set[float] = field(default_factory=set)
    span: tuple[Fraction, Fraction | None] | None = None
    forward: bool = False

    def decide(self, greater: Value, less: Value, at_zero: bool = False) -> bool:
        """True if the first number is greater, False if it is less. Raises Refused if their balls overlap.

        At a single time two exact numbers may be equal, as of floats; then the answer is `at_zero`.
        """
        difference = greater - less
        values = self._between(difference)
        if all(x > 0 for x in values):
            answer = True
        elif all(x < 0 for x in values):
            answer = False
        elif self.span is None and isinstance(difference, arb) and difference.is_zero():
            answer = at_zero
        else:
            answer = self.undecided(greater, less, at_zero)
        self.taken.append(answer)
        return answer

    def is_positive(self, x: Value) -> bool:
        """True if the number is certainly positive, at the point of expansion if it is a series; no outcome of f."""
        values = (x[0],) if isinstance(x, arb_series) else self._between(x)
        return all(value > 0 for value in values)

    def floor(self, x: Value) -> int:
        """The integer k with k <= x < k + 1, in a span also with k = x if x falls. Raises Refused if there are two."""
        balls = [x if isinstance(x, arb) else x.range(arb(0, 1)) for x in self._between(x)]
        if not all(ball.is_finite() for ball in balls):
            raise Refused("f takes the floor of a number that may be infinite")
        least = min(dyadic(ball.lower()) for ball in balls)
        first = floor(least) if self.span is None else ceil(least) - 1
        last = max(floor(dyadic(ball.upper())) for ball in balls)
        if last > first + 1:
            raise Refused(f"f takes the floor of a number in a wide range, from {first}")
        answer = last if last == first or self.undecided(x, arb(last), True) else first
        self.taken.append(answer)
        return answer

    def undecided(self, greater: Value, less: Value, at_zero: bool) -> bool:
        """Raise Refused: neither outcome is certain."""
        raise Overlapping("f compares numbers whose enclosures overlap")

    def made_of(self, made: Value, x: Value, y: Value, *, product: bool) -> None:
        """Note that a number is the sum of two, or their product."""

    def written(self, name: str, x: Value) -> Value | None:
        """The function of a name that stands for a number; None for numbers, whose functions are decided."""
        return None

    def function(self, name: str, x: Value) -> Value:
        """A function of FLINT. Raises Refused where it may not be analytic."""
        return analytic(name, x)

    def _between(self, x: Value) -> tuple[Value, ...]:
        """Numbers between which the value lies: the ends of a model, or the value itself."""
        return x.ends() if self.forward and not isinstance(x, arb) else (x,)

    def constant(self, x: object) -> Value:
        """A constant in the code of f, exactly. Raises Refused if it is not a finite real number."""
        if isinstance(x, np.generic):
            x = x.item()
        if isinstance(x, bool | int):
            return arb(int(x))
        if isinstance(x, float):
            if not np.isfinite(x):
                raise Refused(f"f uses the constant {x}")
            if not x.is_integer():
                self.doubles.add(x)
            return arb(x)
        if isinstance(x, Rational):
            return arb(fmpq(x.numerator, x.denominator))
        raise Refused(f"f uses a {type(x).__name__} as a number")


@dataclass
class Replay(Evaluation):
    """A run on Taylor series, which are not compared: it takes the outcomes at the point of expansion."""

    outcomes: Sequence[int] = ()

    def decide(self, greater: Value, less: Value, at_zero: bool = False) -> bool:
        """The next outcome. Raises Refused behind the last."""
        return bool(self.floor(greater))

    def floor(self, x: Value) -> int:
        """The next outcome. Raises Refused behind the last."""
        if len(self.taken) == len(self.outcomes):
            raise Refused("f takes a different branch on a Taylor series than on the box around the solution")
        self.taken.append(self.outcomes[len(self.taken)])
        return self.taken[-1]


def analytic(name: str, x: Value) -> Value:
    """A function that FLINT has under the name. Raises Refused where it may not be analytic."""
    try:
        return getattr(x, name)()
    except (ValueError, ZeroDivisionError):
        raise Refused(f"f takes {name} of a number where {name} may not be analytic") from None


def running_line() -> str:
    """The line of the user's code that is running, if it can be read, and what of SciPy it calls, to end a sentence."""
    frame: FrameType | None = sys._getframe(1)
    called = ""
    while frame is not None and (package := str(frame.f_globals.get("__name__")).partition(".")[0]) in _OURS:
        called = f", by SciPy's {frame.f_code.co_qualname}" if package == "scipy" else called
        frame = frame.f_back
    line = "" if frame is None else linecache.getline(frame.f_code.co_filename, frame.f_lineno).strip()
    return (f" in {line[:_LONGEST_LINE]!r}" if line else "") + called
