"""The bench of the contract: steps that may fail, steps that repeat, and the numbers of the stepper's own format."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from driftproof.blackbox.contract.clauses import Trial
from driftproof.blackbox.contract.grain import grain_of, narrow_format
from driftproof.blackbox.findings import Misbehaviour, NotANumber, NotFinite, StepRaised, WrongShape
from driftproof.blackbox.stepper.dialects import ARRAYS, LISTS, SCALARS
from driftproof.blackbox.stepper.doors import FIELD, FORCE, FUNCTION, POSITION, STATE, STEP, TIME, VELOCITY
from driftproof.blackbox.stepper.subject import Subject
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat

State = tuple[float, float]

# States with 53 bits each, of ordinary size: the fixed point of the cosine, the solution of x exp(x) = 1, and others.
ORDINARY: State = (0.7390851332151607, 0.5671432904097838)
ANOTHER: State = (0.5772156649015329, -0.9159655941772190)
TYPICAL_STEP = 0.25
# A step whose own bits are not few.
IRREGULAR_STEP = 0.2
# Defects up to this many u count as rounding: no step in the catalogue rounds as often, and a solver of implicit
# stages that means to be exact stops below.
ROUNDINGS = 1024
# A stepper may be made for a small domain: a car in a valley has speeds below 0.07.
SIZES = (1.0, 2.0**-3, 2.0**-6, 2.0**-9)
# Beside a state of ordinary size, one by which a fixed point is told from a floating one.
_SMALLER = 2.0**-7
# In binary16 so many would be half of the number.
_MOST_ROUNDING = 2.0**-5
# A few steps with rounded answers, each off by half a grain.
_GRAINS = 4

_TYPES: dict[FloatFormat, type[np.floating]] = {BINARY64: np.float64, BINARY32: np.float32, BINARY16: np.float16}


class Unsteady(Misbehaviour):
    """The same call gives different answers, so that no other question can be asked."""

    kind = "unsteady"


@dataclass(frozen=True)
class Bench:
    """A stepper on the bench; `format` is that of the numbers it returns, or a narrower one in which they all lie.

    `grain` is the distance between its answers where a rule rounds them, else 0. `size` is 1, or a power of two below
    it by which ordinary states lie in a smaller domain. Where a call is known to give the same answer again, `made`
    keeps the trials that were made.
    """

    subject: Subject
    format: FloatFormat = BINARY64
    grain: float = 0.0
    size: float = 1.0
    made: dict[tuple[float, float, float], Trial] | None = None

    @property
    def ordinary(self) -> State:
        """A state of ordinary size with all the bits of the format."""
        return self.scaled(ORDINARY)

    @property
    def another(self) -> State:
        """Another such state."""
        return self.scaled(ANOTHER)

    def scaled(self, state: State) -> State:
        """A state of ordinary size, in the domain and the format of the stepper."""
        return self.number(self.size * state[0]), self.number(self.size * state[1])

    @property
    def rounding(self) -> float:
        """The largest defect of a state of ordinary size that counts as rounding, relative to it."""
        return min(ROUNDINGS * float(self.format.u), _MOST_ROUNDING) + _GRAINS * self.grain

    def step(self, q: float, v: float, h: float) -> State:
        """One step where nothing should go wrong. Raises the `Misbehaviour` if something does."""
        q1, v1 = self.subject.step(q, v, h)
        return q1, v1

    def trial(self, q: float, v: float, h: float) -> Trial:
        """One step where anything may come."""
        if self.made is None:
            return self._trial(q, v, h)
        if (q, v, h) not in self.made:
            self.made[q, v, h] = self._trial(q, v, h)
        return self.made[q, v, h]

    def _trial(self, q: float, v: float, h: float) -> Trial:
        given = (q, v, h)
        call = call_text(self.subject, *given)
        try:
            return Trial(call, given, self.step(*given))
        except NotFinite as seen:
            return Trial(call, given, seen.answer)
        except StepRaised as seen:
            cause = seen.__cause__
            return Trial(call, given, failure=f"raises {type(cause).__name__}: {' '.join(str(cause).split())}")
        except (WrongShape, NotANumber) as seen:
            return Trial(call, given, failure=str(seen).removeprefix("it "))

    @property
    def is_coarse(self) -> bool:
        """True when answers are rounded so that a state of ordinary size has no more than a few digits."""
        return self.grain > _SMALLER

    def number(self, x: float) -> float:
        """The number of the format nearest to x."""
        return float(_TYPES[self.format](x))

    def beside(self, x: float, towards: float) -> float:
        """The next number of the format on the way from x."""
        kind = _TYPES[self.format]
        return float(np.nextafter(kind(x), kind(towards)))


def steady_bench(subject: Subject) -> Bench:
    """The bench of a stepper whose call gives the same bits again, with another call in between. Raises Unsteady."""
    bench = Bench(subject)
    small: State = (ANOTHER[0] * _SMALLER, ANOTHER[1] * _SMALLER)
    first, between, again = (bench.step(*z, IRREGULAR_STEP) for z in (ORDINARY, small, ORDINARY))
    if not same(first, again):
        raise Unsteady("the same call does not give the same answer again")
    numbers = [*first, *between]
    narrow, grain = narrow_format(numbers), grain_of(numbers)
    fmt = narrow if narrow is not None and narrow.precision < subject.format.precision else subject.format
    found = Bench(subject, fmt, grain.size if grain else 0.0, made={})
    return replace(found, size=_size(found))


def _size(bench: Bench) -> float:
    """The largest of a few sizes at which a very short step leaves an ordinary state alone; 1 if none does."""
    for size in SIZES:
        state = replace(bench, size=size).ordinary
        for h in (float(bench.format.eta), 0.0):
            answer = bench.trial(*state, h).answer
            if answer is not None and all(
                abs(x - z) <= bench.rounding * size for x, z in zip(answer, state, strict=True)
            ):
                return size
    return 1.0


def same(first: Sequence[float] | None, second: Sequence[float] | None) -> bool:
    """True when both are the same numbers, NaN and the signs of zeros included, or none."""
    if first is None or second is None:
        return first is second
    return list(map(repr, first)) == list(map(repr, second))


def call_text(subject: Subject, q: float, v: float, h: float) -> str:
    """The call of a step as a line of Python, `step` being the stepper."""
    door = subject.door
    state_first = {STATE, TIME} <= {*door.order} and door.order.index(STATE) < door.order.index(TIME)
    rates = f"lambda {'y, t' if state_first else 't, y'}: {_as_written(subject, '[y[1], -y[0]]')}"
    function = {FORCE: "lambda q: -q", FIELD: rates}.get(door.kind, "")
    numbers = {POSITION: (q,), VELOCITY: (v,), STATE: (q, v)}
    texts = {FUNCTION: function, TIME: "0.0", STEP: literal(h)}
    arguments = [texts[role] if role in texts else _written(subject, *numbers[role]) for role in door.order]
    named = [f"{name}={text}" for name, text in zip(door.names, arguments, strict=False)]
    extra = [f"{name}={value!r}" for name, value in door.extra.items()]
    return f"step({', '.join([*(named or arguments), *extra])})"


def literal(x: float) -> str:
    """x as Python reads it, to the last bit."""
    return repr(x) if isfinite(x) else f'float("{x!r}")'


def _written(subject: Subject, *numbers: float) -> str:
    """The numbers as the stepper takes them, with the name of what makes them."""
    texts = ", ".join(map(literal, numbers))
    if subject.dialect is SCALARS:
        return texts
    return _as_written(subject, f"[{texts}]" if np.ndim(subject.dialect.write(numbers)) else texts)


def _as_written(subject: Subject, text: str) -> str:
    makers = {LISTS: "", ARRAYS: "numpy.array"}
    maker = makers.get(subject.dialect, subject.dialect.name)
    return f"{maker}({text})" if maker else text
