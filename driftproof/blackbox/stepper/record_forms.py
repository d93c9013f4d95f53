"""Steppers that take a record and a force, as integrate(state, t, dt, acceleration), as plain functions of q and v."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from functools import partial
from typing import Any

import numpy as np

from driftproof.blackbox.stepper.array_adapters import Foreign
from driftproof.blackbox.stepper.calling_conventions import (
    FUNCTION,
    MASS,
    MASSES,
    STATE,
    STEP,
    TIME,
    has_gradient,
    names_with_step,
    role_of,
    word_of,
)
from driftproof.blackbox.stepper.state_forms import Record, clock_names, record_of

_TAKEN = (FUNCTION, STEP, TIME, STATE)


def record_forms(step: Callable[..., Any]) -> Iterator[Callable[..., Any]]:
    """Yield the step(force, q, v, h), or with t before h, that a step of a dict or an object and a force may be.

    The force may be asked with the record, which it then sees as it is, or with a position; it answers with a number,
    or, in the second form, with a record of both slopes. A mass in the record is 2 unless the function's name says that
    it is an acceleration.

    >>> def kick_and_drift(body, force, dt):
    ...     body["v"] += dt * force(body["x"])
    ...     body["x"] += dt * body["v"]
    >>> next(record_forms(kick_and_drift))(lambda x: -x, 1.0, 0.0, 0.5)
    (0.75, -0.5)
    """
    names = names_with_step(step) or []
    roles: dict[str, str] = {}
    for name in names:
        role = role_of(name, [each for each in _TAKEN if each not in roles])
        roles |= {} if role is None else {role: name}
    if len(names) != len(roles) or not {FUNCTION, STEP, STATE} <= {*roles}:
        return

    def called(function: Callable[..., Any], state: Foreign, t: float, h: float) -> Foreign:
        given = {FUNCTION: function, STATE: state, TIME: t, STEP: h}
        return step(**{name: given[role] for role, name in roles.items()})

    pushed = word_of(roles[FUNCTION])
    sign = -1.0 if has_gradient([pushed]) else 1.0
    for answer, stub in ((_number, lambda *asked: 0.0), (_slopes, lambda *asked: min(asked, key=np.isscalar))):
        record = record_of(step, lambda state, stub=stub: called(stub, state, 0.0, 0.25))
        if record is not None:
            masses = {name: MASS for name in record.given if word_of(name) in MASSES and "acc" not in pushed}
            form = partial(_moved, called, record, answer, masses, sign * (MASS if masses else 1.0))
            yield _timed(form) if TIME in roles else _untimed(form)


def _timed(form: Callable[..., Any]) -> Callable[..., Any]:
    return lambda force, q, v, t, h: form(force, q, v, t, h)


def _untimed(form: Callable[..., Any]) -> Callable[..., Any]:
    return lambda force, q, v, h: form(force, q, v, 0.0, h)


def _moved(
    step: Callable[..., Any],
    record: Record,
    answer: Callable[..., Foreign],
    masses: Mapping[str, float],
    factor: float,
    force: Callable[..., Any],
    q: Foreign,
    v: Foreign,
    t: float,
    h: float,
) -> tuple[Foreign, Foreign]:
    """A step of q'' = force(q, v, t), read from what the step returns or from the record that it changes.

    What it calls is `factor` times the force: the mass, -1 for a gradient.
    """

    def asked(*arguments: Foreign) -> Foreign:
        places = next((pair for pair in map(record.pair, arguments) if pair is not None), ())
        pushed = force(*places, *(x for x in arguments if record.pair(x) is None))
        return answer(record, places, pushed, factor)

    state = record.filled(copy(q), copy(v), **masses, **dict.fromkeys(clock_names(record), t))
    found = step(asked, state, t, h)
    pair = record.pair(state if found is None else found)
    return tuple(found) if pair is None else pair


def _number(record: Record, places: Sequence[Foreign], pushed: Foreign, factor: float) -> Foreign:
    """The answer of a force."""
    return factor * pushed


def _slopes(record: Record, places: Sequence[Foreign], pushed: Foreign, factor: float) -> Foreign:
    """The answer of a right-hand side: a record of the slopes of position and velocity."""
    return record.filled(places[1], pushed)
