"""The order that a stepper shows on the pendulum: how fast the error of one step falls with h. Evidence, no proof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from math import log2, sin
from typing import Any

import numpy as np
from flint import arb, arb_poly, ctx

from driftproof.blackbox.findings import Misbehaviour, NotANumber, WrongShape
from driftproof.blackbox.stepper.array_adapters import AnyNumber, ArrayAdapter
from driftproof.blackbox.stepper.foreign_stepper import CallLog, ForceFunction, ForeignStepper

# q'' = -sin q, from a state at which no derivative of the solution vanishes.
_START = (1.0, 0.75)
# At h = 2**-8 a method of order 12 errs by some 2**-110: balls of this precision are far narrower.
_BITS = 256
HALVINGS = range(-1, 9)  # h = 2**-k
# An error counts where it is this many times u: the rounding of some dozens of operations of ordinary size is below.
CLEARANCE = 128
# Slopes this near to a whole number show it, half way to the next being 0.5: for the methods of the catalogue the last
# are within 0.2. The last two have to agree where there are two.
SLACK = 0.3


@dataclass(frozen=True)
class MeasuredOrder:
    """The order p that a local error like C h^(p+1) shows, None where none is seen above the noise.

    `slopes` are log2 of the error's fall at each halving of h, those above the noise; `arithmetic` is what was run in.
    """

    order: int | None
    slopes: tuple[float, ...]
    arithmetic: str

    @property
    def words(self) -> str:
        """The finding in one line."""
        slopes = ", ".join(f"{slope:.2f}" for slope in self.slopes) or "none above the noise"
        shown = "no order is seen" if self.order is None else f"order {self.order} is seen"
        return f"{shown} on the pendulum (slopes of the local error: {slopes}; in {self.arithmetic})"


def measured_order(subject: ForeignStepper) -> MeasuredOrder:
    """The order on q'' = -sin q, in balls where the stepper runs on them, else in its own floats.

    In balls only the stepper's own constants are rounded. Raises UnsupportedCall where it takes no force.
    """
    with ctx.workprec(_BITS):
        for adapter in (BALLS, ARRAYS_OF_BALLS):
            try:
                errors = _errors(replace(subject, adapter=adapter, log=CallLog()), lambda q: -q.sin())
            except Misbehaviour:
                continue
            return _fitted(errors, [_noise(subject, h) for h in _steps()], "Arb balls")
        in_floats = _errors(subject, lambda q: -sin(q))
        return _fitted(in_floats, [_noise(subject, 1.0) for _ in _steps()], subject.format.name)


def _steps() -> list[float]:
    return [2.0**-k for k in HALVINGS]


def _noise(subject: ForeignStepper, size: float) -> float:
    return CLEARANCE * float(subject.format.u) * size


def _errors(subject: ForeignStepper, force: ForceFunction) -> list[float]:
    """The error of one step, in the larger component, for each h."""
    number = subject.adapter.number
    found = []
    for h in _steps():
        answer = subject.step_with(force, number(_START[0]), number(_START[1]), number(h))
        exact = pendulum(*_START, h)
        found.append(max(float(abs(arb(x) - y).mid()) for x, y in zip(answer, exact, strict=True)))
    return found


def _fitted(errors: Sequence[float], noise: Sequence[float], arithmetic: str) -> MeasuredOrder:
    """The slopes down to the first error that is in the noise, and the order that the last of them show."""
    clear = next((i for i, (e, n) in enumerate(zip(errors, noise, strict=True)) if e <= n), len(errors))
    slopes = tuple(log2(a / b) for a, b in pairwise(errors[:clear]))
    powers = {round(slope) if abs(slope - round(slope)) <= SLACK else None for slope in slopes[-2:]}
    power = powers.pop() if len(powers) == 1 else None
    return MeasuredOrder(None if power is None else power - 1, slopes, arithmetic)


@cache
def pendulum(q: float, v: float, t: float, pieces: int = 16, terms: int = 40) -> tuple[arb, arb]:
    """(q(t), v(t)) for q'' = -sin q, by its Taylor series, piece by piece.

    The error of cutting the series off is not in the balls; a second cut shows it (`tests`), far below what is read.
    """
    state, h = (arb(q), arb(v)), arb(t) / pieces
    for _ in range(pieces):
        state = _taylor(*state, h, terms)
    return state


def _taylor(q: arb, v: arb, h: arb, terms: int) -> tuple[arb, arb]:
    """With s = sin q and c = cos q, the series of q' = v, v' = -s, s' = c v, c' = -s v, term by term."""
    qs, vs, sines, cosines = [q], [v], [q.sin()], [q.cos()]
    for k in range(terms):
        qs.append(vs[k] / (k + 1))
        vs.append(-sines[k] / (k + 1))
        sines.append(_convolved(cosines, vs, k) / (k + 1))
        cosines.append(-_convolved(sines, vs, k) / (k + 1))
    return arb_poly(qs)(h), arb_poly(vs)(h)


def _convolved(a: Sequence[arb], b: Sequence[arb], k: int) -> arb:
    return sum((a[j] * b[k - j] for j in range(k + 1)), arb(0))


def _balls_in(value: Any, size: int) -> list[AnyNumber]:
    """The balls in a ball or in an array of them. Raises NotANumber where some of it is none, WrongShape."""
    balls = list(np.asarray(value, dtype=object).ravel())
    if len(balls) != size:
        raise WrongShape(f"{size} balls went in, {len(balls)} came out")
    if not all(isinstance(x, arb) for x in balls):
        raise NotANumber(f"{type(balls[0]).__name__} where a ball went in")
    return balls


BALLS = ArrayAdapter("Arb balls", lambda numbers: numbers[0], _balls_in, arb)
ARRAYS_OF_BALLS = ArrayAdapter("arrays of Arb balls", lambda numbers: np.array(numbers, dtype=object), _balls_in, arb)
