"""Nonlinear problems with known solutions, with the time in them: what tells steps apart that linear ones do not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import exp
from typing import TypeAlias

from flint import arb

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.stepper.array_adapters import AnyNumber
from driftproof.blackbox.stepper.calling_conventions import FIELD
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

_State: TypeAlias = list[AnyNumber]
# Not 0, so that a clock that stands at 0 or is started again shows. Of the starts, spacings of the bells and strengths
# of the coupling that were tried, these let most orders of the catalogue be seen: all but those of two pairs.
START, _SPACING, _STRENGTH = 0.25, 0.5, 4
# How many numbers a right-hand side has, the most first; some codes take two, or one.
_SIZES = (4, 2, 1)
# Beyond its logarithm a double overflows; a step that goes there is wrong whatever follows.
_LARGEST_EXPONENT = 700.0


@dataclass(frozen=True)
class NonlinearProblem:
    """y' = rate(t, y), over floats and over balls, and its solution in balls; or q'' = F(t, q) with y = [q, v].

    `force` is F where it does not depend on t: then a stepper that takes a force can be asked.
    """

    words: str
    rate: Callable[[AnyNumber, Sequence[AnyNumber]], _State]
    solution: Callable[[arb], list[arb]]
    force: Callable[[AnyNumber], AnyNumber] | None = None

    def stepped(self, subject: ForeignStepper, t: float, y: Sequence[AnyNumber], h: float) -> _State:
        """One step of the stepper, from numbers of its adapter."""
        at, size = subject.adapter.number(t), subject.adapter.number(h)
        if subject.convention.kind == FIELD:
            return subject.step_field(self.rate, at, y, size)
        if self.force is None:
            raise ValueError(f"{self.words} depends on t, and a force does not")
        q, v = y
        return [*subject.step_with(self.force, q, v, size)]


def field_problem(subject: ForeignStepper) -> NonlinearProblem:
    """The problem of as many numbers as a step(f, t, y, h) takes; with t if it hands on any.

    Raises the Misbehaviour of the first size if it takes none, UnsupportedCall where there is no right-hand side.
    """
    failure: Misbehaviour | None = None
    for size in _SIZES:
        try:
            timed = _hands_on_time(subject, size)
        except Misbehaviour as found:
            failure = failure or found
            continue
        numbers = f"{size} number{'s' * (size > 1)}"
        if timed or size > 1:
            words = f"a nonlinear problem of {numbers}, {'with t' if timed else 'without t: the code hands on no time'}"
            return NonlinearProblem(words, _driven(timed), _solution(size, timed))
        words = "y' = exp(-y), without t: the code hands on no time"
        return NonlinearProblem(words, lambda t, y: [_exp(-y[0])], lambda t: [(1 + t).log()])
    raise failure if failure is not None else ValueError("no size of problem is tried")


def force_problem(subject: ForeignStepper, *, timed: bool = True) -> NonlinearProblem:
    """q'' = exp(-2q) with q = log cosh t; where that is asked for and a right-hand side hands on times, a F(t, q)."""
    if timed and subject.convention.kind == FIELD:
        with suppress(Misbehaviour):
            if _hands_on_time(subject, 2):
                return NonlinearProblem("a nonlinear q'' = F(t, q)", _pushed, _of_pushed)
    return WALL


def _hands_on_time(subject: ForeignStepper, size: int) -> bool:
    """True where the right-hand side is given a time; without one, it gets the very object that we made."""
    clock, given = float(START), []

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        given.append(t is not clock)
        return [0.0 * x for x in y]

    subject.step_field(rate, clock, [float(k) for k in range(1, size + 1)], 0.25)
    return any(given)


def _bell(i: int, t: AnyNumber) -> tuple[AnyNumber, AnyNumber]:
    """x = t + i/2 and 1/(1 + x²), no derivative of which is 0 for long."""
    x = t + _SPACING * i
    return x, 1 / (1 + x * x)


def _coupled(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
    """4 (1 + t) y_(i+1) y_(i+2)/(1 + y_i²): mixed derivatives of all orders, in t, too."""
    n = len(y)
    return [_STRENGTH * (1 + t) * y[(i + 1) % n] * y[(i + 2) % n] / (1 + y[i] * y[i]) for i in range(n)]


def _driven(timed: bool) -> Callable[[AnyNumber, Sequence[AnyNumber]], _State]:
    """y' = φ'(t) + G(t, y) - G(t, φ(t)), solved by φ, the bells; without time the last number is the clock."""

    def rate(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
        at, state = (t, y) if timed else (y[-1], y[:-1])
        bells = [_bell(i, at) for i in range(len(state))]
        pairs = zip(bells, _coupled(at, state), _coupled(at, [bell for _, bell in bells]), strict=True)
        slopes = [mine - its - 2 * x * bell * bell for (x, bell), mine, its in pairs]
        return slopes if timed else [*slopes, at * 0 + 1]

    return rate


def _solution(size: int, timed: bool) -> Callable[[arb], list[arb]]:
    def solution(t: arb) -> list[arb]:
        return [_bell(i, t)[1] for i in range(size)] if timed else [*(_bell(i, t)[1] for i in range(size - 1)), t]

    return solution


def _pushed(t: AnyNumber, y: Sequence[AnyNumber]) -> _State:
    """q'' = φ''(t) + S(q) - S(φ(t)) with S(q) = 1/(1 + q²), solved by the first bell."""
    q, v = y
    x, bell = _bell(0, t)
    return [v, 8 * x * x * bell**3 - 2 * bell * bell + 1 / (1 + q * q) - 1 / (1 + bell * bell)]


def _of_pushed(t: arb) -> list[arb]:
    x, bell = _bell(0, t)
    return [bell, -2 * x * bell * bell]


def _exp(x: AnyNumber) -> AnyNumber:
    return x.exp() if isinstance(x, arb) else exp(min(x, _LARGEST_EXPONENT))


def _wall(q: AnyNumber) -> AnyNumber:
    return _exp(-2 * q)


WALL = NonlinearProblem(
    "q'' = exp(-2q)", lambda t, y: [y[1], _wall(y[0])], lambda t: [t.cosh().log(), t.tanh()], force=_wall
)
