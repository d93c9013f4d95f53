"""Steppers that take a Jacobian or a second right-hand side; with these given, each takes one function only."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.stepper.array_adapters import LISTS, SCALARS, AnyNumber, Foreign, as_array
from driftproof.blackbox.stepper.calling_conventions import FIELD, JACOBIAN, STATE, TIME
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

# A function of t and y that returns slopes, or the rows of a matrix.
SecondFunction: TypeAlias = Callable[[AnyNumber, Sequence[AnyNumber]], Sequence[Any]]


def zeros(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
    """Slopes of 0."""
    return [0.0 * x for x in y]


def with_functions(
    subject: ForeignStepper, functions: Mapping[str, SecondFunction], untimed: AnyNumber = 0.0
) -> ForeignStepper:
    """The subject as a step(f, t, y, h) with its other functions given by role; roles that it lacks are ignored.

    If the subject is given no time, these functions are called at the time `untimed`.
    """
    order, names = subject.convention.order, subject.convention.names
    kept = [place for place, role in enumerate(order) if role not in functions]
    state = order.index(STATE)

    def step(*arguments: Foreign, **named: Foreign) -> Foreign:
        given: dict[int, Foreign] = dict(zip(kept, arguments, strict=False))
        if names:
            given = {place: named.pop(names[place]) for place in kept}
        size = as_array(given[state]).size
        t = given[order.index(TIME)] if TIME in order else untimed
        for place, role in enumerate(order):
            if place not in given:
                write = partial(_matrix, subject) if role == JACOBIAN else subject.adapter.write
                given[place] = subject.callback(functions[role], t, size, write)
        values = [given[place] for place in range(len(order))]
        by_name = dict(zip(names, values, strict=True)) if names else {}
        return subject.function(*([] if names else values), **by_name, **named)

    left, called = (tuple(each[place] for place in kept if each) for each in (order, names))
    return replace(subject, function=step, convention=replace(subject.convention, kind=FIELD, order=left, names=called))


def _matrix(subject: ForeignStepper, rows: Sequence[Sequence[AnyNumber]]) -> Foreign:
    """The rows as a matrix of the stepper's own kind."""
    if subject.adapter is LISTS:
        return [[float(x) for x in row] for row in rows]
    return subject.adapter.write(rows[0]) if subject.adapter is SCALARS else np.array(rows, dtype=np.float64)
