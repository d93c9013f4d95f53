"""What all checks share: trial steps that may fail, the numbers that a stepper rounds to, and the results of checks."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf, isfinite
from typing import Any

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, NoAnswer, NotANumber, NotFinite, StepRaised, WrongShape, once
from driftproof.blackbox.probes.linear_steps import MOST_ROUNDING
from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.support.plain_text import counted
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat

PhasePoint = tuple[float, float]
# States with 53 bits each, of ordinary size: the fixed point of the cosine, the solution of x exp(x) = 1, and others.
ORDINARY_STATE: PhasePoint = (0.7390851332151607, 0.5671432904097838)
ANOTHER: PhasePoint = (0.5772156649015329, -0.9159655941772190)
TYPICAL_STEP = 0.25
# A step size with many bits.
IRREGULAR_STEP = 0.2
# Defects up to this many u count as rounding: a term of the longest step in the catalogue (ssprk40_2) passes some 1060
# roundings in the worst order with every coefficient computed; implicit solvers to full accuracy stop below.
_ROUNDINGS = 1024
# Sizes of states: a stepper may be made for a small domain, as a car in a valley has speeds below 0.07.
SIZES = (1.0, 2.0**-3, 2.0**-6, 2.0**-9)
# The size of a second state, in which numbers of a fixed point have seven bits less, and those of a format do not.
_SMALLER = 2.0**-7
# In units of the grain: up to eight rounded answers, each off by half of it.
_GRAINS = 4
_TYPES: dict[FloatFormat, type[np.floating]] = {BINARY64: np.float64, BINARY32: np.float32, BINARY16: np.float16}


class Unsteady(Misbehaviour):
    """The same call gives different answers, so that no other check can be made."""


@dataclass(frozen=True)
class TrialRunner:
    """A stepper on trial; `format` is that of the numbers it returns, or a narrower one that holds them all.

    `grain` is the spacing of its answers if a rule rounds them, else 0. `size` is 1, or a smaller power of two that
    brings ordinary states into a small domain. `made` keeps the trials if calls are known to repeat.
    """

    subject: ForeignStepper
    format: FloatFormat = BINARY64
    grain: float = 0.0
    size: float = 1.0
    made: dict[tuple[float, float, float], Trial] | None = None

    @property
    def ordinary(self) -> PhasePoint:
        """A state of ordinary size with all the bits of the format."""
        return self.scaled(ORDINARY_STATE)

    @property
    def another(self) -> PhasePoint:
        """Another such state."""
        return self.scaled(ANOTHER)

    def scaled(self, state: PhasePoint) -> PhasePoint:
        """A state of ordinary size, in the domain and the format of the stepper."""
        return self.number(self.size * state[0]), self.number(self.size * state[1])

    @property
    def rounding(self) -> float:
        """The largest defect of a state of ordinary size that counts as rounding, relative to it."""
        return min(_ROUNDINGS * float(self.format.u), MOST_ROUNDING) + _GRAINS * self.grain

    def step(self, q: float, v: float, h: float) -> PhasePoint:
        """One step that should succeed. Raises a `Misbehaviour` if it does not."""
        return self.subject.step(q, v, h)

    def trial(self, q: float, v: float, h: float) -> Trial:
        """One step that may fail. Raises NoAnswer if the call hangs, which is evidence of nothing."""
        made = {} if self.made is None else self.made
        if (q, v, h) not in made:
            made[q, v, h] = self._trial(q, v, h)
        return made[q, v, h]

    def _trial(self, q: float, v: float, h: float) -> Trial:
        given, call = (q, v, h), call_text(self.subject, q, v, h)
        try:
            return Trial(call, given, self.step(*given))
        except NotFinite as seen:
            return Trial(call, given, seen.answer)
        except StepRaised as seen:
            cause, raised = seen.__cause__, type(seen.__cause__).__name__
            return Trial(call, given, failure=f"raises {raised}: {' '.join(str(cause).split())}", raised=raised)
        except (WrongShape, NotANumber) as seen:
            return Trial(call, given, failure=str(seen).removeprefix("it "))

    @property
    def of_another_system(self) -> bool:
        """True if a system is built in on which a short step does not move v by -h q, as one of q'' = -q does."""
        (q, v), h = self.ordinary, 2 * float(self.format.u) ** 0.5
        answer = self.trial(q, v, h).answer
        oscillates = answer is not None and abs((answer[1] - v) / h + q) <= abs(q) / 2
        return self.subject.convention.kind == MAP and not oscillates

    @property
    def is_coarse(self) -> bool:
        """True if answers are rounded so that a state of ordinary size has no more than a few digits."""
        return self.grain > _SMALLER

    def number(self, x: float) -> float:
        """The number of the format nearest to x."""
        return float(_TYPES[self.format](x))

    def beside(self, x: float, towards: float) -> float:
        """The next number of the format on the way from x."""
        kind = _TYPES[self.format]
        return float(np.nextafter(kind(x), kind(towards)))


@once  # all checks of a stepper begin with it
def steady_runner(subject: ForeignStepper) -> TrialRunner:
    """The runner of a stepper that gives the same bits again after another call. Raises Unsteady if it does not."""
    small: PhasePoint = (ANOTHER[0] * _SMALLER, ANOTHER[1] * _SMALLER)
    first, between, again = (subject.step(*z, IRREGULAR_STEP) for z in (ORDINARY_STATE, small, ORDINARY_STATE))
    if not same(first, again):
        raise Unsteady("the same call does not give the same answer again")
    numbers = [*first, *between]
    narrow, grain = narrow_format(numbers), quantisation_of(numbers)
    found = TrialRunner(subject, narrow or subject.format, grain.size if grain else 0.0, made={})
    return replace(found, size=_size(found))


def _size(runner: TrialRunner) -> float:
    """The largest of a few sizes at which a very short step leaves an ordinary state alone; 1 if none does."""
    for size in SIZES:
        state = replace(runner, size=size).ordinary
        for h in (float(runner.format.eta), 0.0):
            with suppress(NoAnswer):
                answer = runner.trial(*state, h).answer or (inf, inf)
                if all(abs(x - z) <= runner.rounding * size for x, z in zip(answer, state, strict=True)):
                    return size
    return 1.0


def same(first: Sequence[float] | None, second: Sequence[float] | None) -> bool:
    """True if both are None, or the same numbers, NaN and the signs of zeros included."""
    return first is second if first is None or second is None else [*map(repr, first)] == [*map(repr, second)]


# The traits that a method may have or not. All other checks are of what everybody expects of a stepper.
TRAITS = frozenset(("symmetric", "reversible", "area_preserving", "norm_preserving", "linear"))


@dataclass(frozen=True)
class Trial:
    """One call, as a line of Python, with its answer in numbers, or else its `failure`; `given` is (q, v, h).

    `raised` is the name of the exception that the step raised.
    """

    call: str
    given: tuple[float, float, float]
    answer: tuple[float, ...] | None = None
    failure: str = ""
    raised: str = ""

    @property
    def finite(self) -> bool:
        """True if the answer is numbers, none of them NaN or infinite."""
        return self.answer is not None and all(map(isfinite, self.answer))

    @property
    def seen(self) -> str:
        """The answer or the failure as text: "(1.0, 0.75)", "raises ValueError: ..."."""
        return self.failure if self.answer is None else pair_text(self.answer)

    @property
    def refusal(self) -> str:
        """The failure as the end of a sentence."""
        return f"it {self.failure}" if self.failure.startswith(("raises", "returns")) else self.failure

    @property
    def line(self) -> str:
        """The call and its result, to be tried again."""
        return f"{self.call} -> {self.seen}"

    def as_dict(self) -> dict[str, Any]:
        """The trial for JSON; numbers are strings which give them back to the last bit."""
        answer = None if self.answer is None else [repr(x) for x in self.answer]
        given = dict(zip("qvh", map(repr, self.given), strict=True))
        return {"call": self.call, "given": given, "answer": answer, "failure": self.failure or None}


@dataclass(frozen=True)
class CheckResult:
    """One sentence about a stepper; `key` says what it is about, and `what` which of several answers verdicts ask for.

    `holds` is True if a duty is fulfilled or a trait is there, False if not, and None if that was not decided.
    """

    key: str
    holds: bool | None
    words: str
    example: tuple[Trial, ...] = ()
    what: str = ""

    @property
    def is_fault(self) -> bool:
        """True if something fails that everybody expects of a stepper."""
        return self.holds is False and self.key not in TRAITS

    def as_dict(self) -> dict[str, Any]:
        """The result for JSON."""
        example = [trial.as_dict() for trial in self.example]
        return {"key": self.key, "holds": self.holds, "words": self.words, "example": example}


def pair_text(numbers: tuple[float, ...]) -> str:
    """The numbers as "(1.0, 0.75)", to the last bit."""
    return f"({', '.join(map(repr, numbers))})"


# No decimals from here on are looked for: numbers of size 1000 have no more after the point. Every double has so many
# digits in all, which are 15.9.
_DECIMALS, _DIGITS = 12, 15
# With numbers down to 1/1000, more bits after the point than this are not those of a fixed point.
_FIXED_POINT = 40
# Floats have nearly all bits of their format as a rule, fixed-point numbers as many as fit: the last five bits of one
# float in 32 are 0 by chance.
_BITS_TO_SPARE = 5
# From here on all floats are whole numbers, in binary32 already.
_ALL_WHOLE = 2.0**23


@dataclass(frozen=True)
class Quantisation:
    """A rule that rounds: the spacing of its numbers, and the rule in words."""

    size: float
    words: str


def quantisation_of(numbers: Sequence[float]) -> Quantisation | None:
    """The coarsest spacing that all numbers are multiples of; None if there is none, as for plain floats."""
    if not (numbers := [x for x in numbers if abs(x) < _ALL_WHOLE]):
        return None
    if all(x.is_integer() for x in numbers):
        return Quantisation(1.0, "answers are whole numbers")
    most = max(map(abs, numbers))
    places = (k for k in range(1, _DECIMALS) if most * 10.0**k < 10.0**_DIGITS)
    decimals = next((k for k in places if all(round(x, k) == x for x in numbers)), None)
    if decimals is not None:
        return Quantisation(10.0**-decimals, f"answers are rounded to {counted(decimals, 'decimal')}")
    last = max(Fraction(x).denominator.bit_length() - 1 for x in numbers)  # bits after the point
    bits = sorted(significant_bits(x) for x in numbers if x)
    # Of floats, three in four have nearly as many bits as the longest.
    if last <= _FIXED_POINT and bits[len(bits) // 4] < bits[-1] - _BITS_TO_SPARE:
        return Quantisation(2.0**-last, f"answers are multiples of 2**-{last}")
    return None


def narrow_format(numbers: Sequence[float]) -> FloatFormat | None:
    """The narrowest format up to binary32 that holds all of these; None if none does, or if a coarser rule does."""
    if quantisation_of(numbers) is not None:
        return None
    widest = max(map(significant_bits, numbers))
    return next((fmt for fmt in (BINARY16, BINARY32) if widest <= fmt.precision), None)


def significant_bits(x: float) -> int:
    """The number of bits from the first to the last that is 1; 0 for 0."""
    n = abs(Fraction(x).numerator)
    return (n // (n & -n)).bit_length() if n else 0
