"""The call of a stepper as a line of Python that anybody can paste."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from driftproof.blackbox.stepper.array_adapters import ARRAYS, LISTS, SCALARS
from driftproof.blackbox.stepper.calling_conventions import (
    CARRIED,
    FIELD,
    FORCE,
    FUNCTION,
    GRID,
    POSITION,
    STATE,
    STEP,
    TIME,
    VELOCITY,
)
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper


def call_text(stepper: ForeignStepper, q: float, v: float, h: float) -> str:
    """The call of a step as a line of Python, `step` being the stepper."""
    calls = stepper.convention
    state_first = {STATE, TIME} <= {*calls.order} and calls.order.index(STATE) < calls.order.index(TIME)
    rates = f"lambda {'y, t' if state_first else 't, y'}: {_as_written(stepper, '[y[1], -y[0]]')}"
    names = {POSITION: "q", VELOCITY: "v", TIME: "t"}
    asked = ", ".join(names.get(role, f"_{place}") for place, role in enumerate(calls.asks or (POSITION,)))
    force = f"lambda {asked}: {-calls.factor:g} * q" if calls.factor != 1 else f"lambda {asked}: -q"
    function = {FORCE: force, FIELD: rates}.get(calls.kind, "")
    slope = (v, -q) if calls.kind == FIELD else (-calls.factor * q,)
    numbers = {POSITION: (q,), VELOCITY: (v,), STATE: (q, v), CARRIED: slope}
    texts = {FUNCTION: function, TIME: "0.0", STEP: _literal(h), GRID: f"[0.0, {_literal(h)}]"}
    arguments = [texts[role] if role in texts else _written(stepper, *numbers[role]) for role in calls.order]
    named = [f"{name}={text}" for name, text in zip(calls.names, arguments, strict=False)]
    extra = [f"{name}={value!r}" for name, value in calls.extra.items()]
    return f"step({', '.join([*(named or arguments), *extra])})"


def _literal(x: float) -> str:
    """x as Python reads it, to the last bit."""
    return repr(x) if isfinite(x) else f'float("{x!r}")'


def _written(stepper: ForeignStepper, *numbers: float) -> str:
    """The numbers as the stepper takes them, with the name of what makes them."""
    if stepper.adapter.shown:
        return _as_shown(stepper.adapter.shown, [*map(_literal, numbers)])
    texts = ", ".join(map(_literal, numbers))
    if stepper.adapter is SCALARS:
        return texts
    return _as_written(stepper, f"[{texts}]" if np.ndim(stepper.adapter.write(numbers)) else texts)


def _as_shown(shown: str, texts: Sequence[str]) -> str:
    return shown.format(*texts) if shown.count("{}") > 1 else shown.format(", ".join(texts))


def _as_written(stepper: ForeignStepper, text: str) -> str:
    if stepper.adapter.shown:
        inner = text[1:-1] if text.startswith("[") else text
        return _as_shown(stepper.adapter.shown, inner.split(", "))
    makers = {LISTS: "", ARRAYS: "numpy.array"}
    maker = makers.get(stepper.adapter, stepper.adapter.name)
    return f"{maker}({text})" if maker else text
