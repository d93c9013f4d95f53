"""Steppers that take a record and a force, as integrate(state, t, dt, acceleration), as plain functions of q and v."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
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
from driftproof.blackbox.stepper.records import Record, record_of


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
    roles: dict[str, str] = {}
    names = names_with_step(step) or []
    for name in names:
        if role := role_of(name, [each for each in (FUNCTION, STEP, TIME, STATE) if each not in roles]):
            roles[role] = name
    if len(names) != len(roles) or not {FUNCTION, STEP, STATE} <= {*roles}:
        return

    def called(function: Callable[..., Any], state: Foreign, t: float, h: float) -> Foreign:
        given = {FUNCTION: function, STATE: state, TIME: t, STEP: h}
        return step(**{name: given[role] for role, name in roles.items()})

    pushed = word_of(roles[FUNCTION])
    for stub, slopes in ((lambda *asked: 0.0, False), (lambda *asked: min(asked, key=np.isscalar), True)):
        record = record_of(step, partial(_with_step, called, stub))
        if record is not None:
            masses = {name: MASS for name in record.given if word_of(name) in MASSES and "acc" not in pushed}
            factor = (-1.0 if has_gradient([pushed]) else 1.0) * (MASS if masses else 1.0)
            form = _form(called, record, slopes, masses, factor)
            yield form if TIME in roles else _untimed(form)


def _with_step(called: Callable[..., Any], stub: Callable[..., Any], state: Foreign) -> Foreign:
    return called(stub, state, 0.0, 0.25)


def _untimed(form: Callable[..., Any]) -> Callable[..., Any]:
    return lambda force, q, v, h: form(force, q, v, 0.0, h)


def _form(
    step: Callable[..., Any], record: Record, slopes: bool, masses: Mapping[str, float], factor: float
) -> Callable[..., Any]:
    """The step of q'' = force(q, v, t) that a step of records makes, which calls a function `factor` times the force.

    Or, with `slopes`, a function that answers with a record of the slopes of position and velocity.
    """

    def moved(force: Callable[..., Any], q: Foreign, v: Foreign, t: float, h: float) -> tuple[Foreign, Foreign]:
        def asked(*arguments: Foreign) -> Foreign:
            pairs = [pair for pair in map(record.pair, arguments) if pair is not None]
            pushed = force(*pairs[0] if pairs else (), *(x for x in arguments if record.pair(x) is None))
            return record.filled(pairs[0][1], pushed) if slopes else factor * pushed

        clocks = {name: t for name in record.known if role_of(name, (TIME,))}
        state = record.filled(copy(q), copy(v), **masses, **clocks)
        found = step(asked, state, t, h)
        pair = record.pair(state if found is None else found)
        return tuple(found) if pair is None else pair

    return moved
