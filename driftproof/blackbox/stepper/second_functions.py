"""Steppers that take a Jacobian or a second right-hand side; with these given, each takes one function only."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import LISTS, SCALARS, AnyNumber, Foreign, Parted, as_array

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
    state = order.index(calling.STATE)

    def step(*arguments: Foreign, **named: Foreign) -> Foreign:
        given: dict[int, Foreign] = dict(zip(kept, arguments, strict=False))
        if names:
            given = {place: named.pop(names[place]) for place in kept}
        size = as_array(given[state]).size
        t = given[order.index(calling.TIME)] if calling.TIME in order else untimed
        for place, role in enumerate(order):
            if place not in given:
                write = partial(_matrix, subject) if role == calling.JACOBIAN else subject.adapter.write
                given[place] = subject.callback(functions[role], t, size, write)
        values = [given[place] for place in range(len(order))]
        by_name = dict(zip(names, values, strict=True)) if names else {}
        return subject.function(*([] if names else values), **by_name, **named)

    left, called = (tuple(each[place] for place in kept if each) for each in (order, names))
    return replace(
        subject, function=step, convention=replace(subject.convention, kind=calling.FIELD, order=left, names=called)
    )


# The part of a number by which it is shifted for a derivative: half of the digits of binary64 are left.
_SHIFT = 2.0**-26


def with_own_jacobian(step: Callable[..., Any]) -> Callable[..., Any]:
    """The code of f alone that hands on differences of f where it needs a Jacobian; itself if it needs none.

    >>> def step(f, jac, t, y, h):
    ...     return y + h * f(t, y) / (1 - h * jac(t, y))
    >>> print(with_own_jacobian(step)(lambda t, y: -y, 0.0, 1.0, 1.0))
    0.5
    """
    parameters = calling.parameters_of(step) or {}
    needed = calling.required_names(step) or ()
    roles = {
        name: calling.role_of(name, (calling.FUNCTION, calling.JACOBIAN, calling.TIME, calling.STATE))
        for name in needed
    }
    named = {role: name for name, role in reversed(roles.items())}
    if not {calling.FUNCTION, calling.JACOBIAN} <= {*named}:
        return step
    f, jacobian = named[calling.FUNCTION], named[calling.JACOBIAN]
    told = [role for role in roles.values() if role in (calling.TIME, calling.STATE)]
    left = inspect.Signature([p for name, p in parameters.items() if name != jacobian])

    def alone(*given: Foreign, **options: Foreign) -> Foreign:
        named = left.bind(*given, **options).arguments
        return step(**named, **{jacobian: lambda *at: differences(named[f], at, told[:1] == [calling.TIME])})

    calling.stand_in(alone, step, left.parameters.values())
    return alone


def differences(f: Callable[..., Foreign], at: Sequence[Foreign], last: bool) -> Foreign:
    """The derivative of f by its state, the largest argument; of several numbers, the last or else the first one."""
    place = max(range(len(at)), key=lambda i: (np.size(at[i]), np.ndim(at[i]), i if last else -i))
    y, here = at[place], np.asarray(f(*at))

    def slope(way: Any) -> Any:
        shift = _SHIFT * max(1.0, float(np.max(np.abs(y))))
        return (np.asarray(f(*at[:place], y + shift * way, *at[place + 1 :])) - here) / shift

    if np.ndim(y) == 0 or isinstance(y, Parted):
        return slope(1.0)[()]
    return np.array([slope(way) for way in np.eye(np.size(y))]).T


def _matrix(subject: ForeignStepper, rows: Sequence[Sequence[AnyNumber]]) -> Foreign:
    """The rows as a matrix of the stepper's own kind."""
    if subject.adapter is LISTS:
        return [[float(x) for x in row] for row in rows]
    return subject.adapter.write(rows[0]) if subject.adapter is SCALARS else np.array(rows, dtype=np.float64)
