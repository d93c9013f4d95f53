"""The dense output of a step, read as rows of weights b(theta): a step to theta has the stages of the whole step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import CoefficientRow, NotReadable
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.calling_conventions import STEP, TIME
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import Foreign

# Sixteenths are exact in every format. 16 of them fix a polynomial of degree 15; the last one confirms it.
THETAS = tuple(Fraction(k, 16) for k in range(17))
# Values between them: the golden section, and two others that are not fractions of small numbers.
BETWEEN = tuple(map(Fraction, (0.0857864376269049, 0.3819660112501052, 0.7320508075688772)))
# What a dense output may be a function of, from the start t of the step, its length h and theta.
_ARGUMENTS: dict[str, Callable[[float, float, float], float]] = {
    "the time": lambda t, h, theta: t + theta * h,
    "theta": lambda t, h, theta: theta,
    "the time since the start of the step": lambda t, h, theta: theta * h,
}


class DenseOutputDiffers(NotReadable):
    """The step is a sum of slopes, alike in all numbers, but its dense output is not."""

    kind = "not_alike"


@dataclass(frozen=True)
class DenseReading:
    """The dense output y(t + θh) ≈ y + h Σ bⱼ(θ) kⱼ of a step: `rows` are the b(θ) of the THETAS.

    `argument` says what it is a function of. `step` is the table with b(1). kⱼ is the answer to call j, where calls
    made for the dense output alone are included; `own` are the weights of y₁, 0 for such calls. `between` are pairs
    (θ, b(θ)) of other θ. The remarks of `step` are those on the dense output alone. `stages` are the calls that
    `merged` kept.
    """

    argument: str
    step: TableauReading
    rows: tuple[CoefficientRow, ...]
    own: CoefficientRow
    between: tuple[tuple[Fraction, CoefficientRow], ...]
    stages: Sequence[int] = ()

    def merged(self) -> DenseReading:
        """The reading with calls of equal arguments as one stage, as where slopes are evaluated anew for the output.

        Only the sum of their weights means anything. It may be off by the roundings of all calls.
        """
        kept, sums = _apart(self.step)

        def at(rows: Sequence[CoefficientRow]) -> tuple[CoefficientRow, ...]:
            return tuple(tuple(float(x) for x in row @ sums) for row in np.array(rows))

        a, c = at([self.step.a[i] for i in kept]), self.step.c and tuple(self.step.c[i] for i in kept)
        rows, (own,), between = at(self.rows), at([self.own]), at([row for _, row in self.between])
        error = self.step.stage_error + (self.step.calls - len(kept)) * float(self.step.format.u)
        step, places = replace(self.step, a=a, b=rows[-1], c=c, stage_error=error), (theta for theta, _ in self.between)
        return DenseReading(self.argument, step, rows, own, tuple(zip(places, between, strict=True)), kept)

    def step_to(self, theta: Fraction) -> TableauReading:
        """The step of length θh that ends at θ, in floats: A/θ, b(θ)/θ and c/θ. θ is one of THETAS, but not 0."""
        part, row = float(theta), self.rows[THETAS.index(theta)]
        a = tuple(tuple(x / part for x in entries) for entries in self.step.a)
        c = None if self.step.c is None else tuple(x / part for x in self.step.c)
        return replace(self.step, a=a, b=tuple(x / part for x in row), c=c, remarks=())


def _apart(step: TableauReading) -> tuple[list[int], np.ndarray[Any, Any]]:
    """The calls whose arguments no earlier one has, and the matrix that adds to their weights those of all others."""
    places, kept, sums = list[np.ndarray[Any, Any]](), list[int](), np.zeros((step.calls, step.calls))
    for i, row in enumerate(np.array(step.a)):
        place = np.append(row @ sums, step.c[i] if step.c else 0.0)
        allowed = step.rounding.of(1 + abs(place).sum())
        same = next((k for k, other in enumerate(places) if abs(place - other).max() <= allowed), len(places))
        if same == len(places):
            places.append(place)
            kept.append(i)
        sums[i, same] = 1.0
    return kept, sums[:, : len(kept)]


def read_dense(subject: ForeignStepper) -> DenseReading:
    """The dense output of a step (f, t, y, h) that returns (y1, dense), read as a step to each of 17 values of theta.

    `dense` is a function of t, of theta or of the time since the start; each step passes all controls of
    `read_tableau`. Raises NotReadable, UnsupportedCall if no function is returned, and DenseOutputDiffers if the
    step is readable and this is not.
    """
    state = _trial_state(subject)
    if subject.log.dense is None:
        raise UnsupportedCall("the stepper returns no dense output besides y1")
    argument = _argument(subject, state)
    own = read_tableau(subject)
    try:
        readings, between = (
            [read_tableau(_stepper_to(subject, float(theta), argument)) for theta in thetas]
            for thetas in (THETAS, BETWEEN)
        )
    except NotReadable as refusal:
        raise DenseOutputDiffers(str(refusal)) from None
    calls, *others = {reading.calls for reading in readings}
    if others or own.calls > calls:
        raise NotReadable("how many calls the dense output makes depends on theta")
    weights = (*own.b, *[0.0] * (calls - own.calls))
    remarks = () if own.remarks else next((reading.remarks for reading in readings if reading.remarks), ())
    step = replace(readings[-1], remarks=remarks)
    rows, further = (tuple(reading.b for reading in each) for each in (readings, between))
    return DenseReading(argument, step, rows, weights, tuple(zip(BETWEEN, further, strict=True)))


def _trial_state(subject: ForeignStepper) -> list[float]:
    for size in (2, 1):  # some take one number only
        with suppress(Misbehaviour):
            subject.step_field(lambda t, y: [0.0 * x for x in y], 0.0, [5.0] * size, 0.5)
            return [5.0] * size
    raise NotReadable("no step is made to look for a dense output")


def _argument(subject: ForeignStepper, state: Sequence[float]) -> str:
    """What the output is a function of: with slope 1 everywhere, y = 5 at t = 2 is 5.25 after half a step of 1/2.

    An output that is wrong half-way is recognised by what makes it right at the end.
    """
    for (theta, right), argument in product(((0.5, 5.25), (1.0, 5.5)), _ARGUMENTS):
        with suppress(Misbehaviour):  # outside its interval, say
            place = _stepper_to(subject, theta, argument)
            found = place.step_field(lambda t, y: [1.0 + 0.0 * x for x in y], 2.0, state, 0.5)
            if abs(found[0] - right) <= 2.0**-6:
                return argument
    raise DenseOutputDiffers("with the slope 1, the dense output is right neither half-way nor at the end of a step")


def _stepper_to(subject: ForeignStepper, theta: float, argument: str) -> ForeignStepper:
    """The stepper that goes as far as theta: it makes the whole step, and returns its dense output there."""
    order, names, place = subject.convention.order, subject.convention.names, _ARGUMENTS[argument]

    def function(*arguments: Any, **named: Any) -> Foreign:
        given = dict(zip(order, arguments or [named[name] for name in names], strict=False))
        dense = next(filter(callable, subject.function(*arguments, **named)))
        return dense(place(given.get(TIME, 0.0), given[STEP], theta))

    return replace(subject, function=function)
