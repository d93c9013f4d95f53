"""The call of a stepper as a line of Python, ready to paste."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

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
from driftproof.blackbox.stepper.states.array_adapters import ARRAYS, LISTS, SCALARS


def call_text(stepper: ForeignStepper, q: float, v: float, h: float) -> str:
    """The call of one step as a line of Python, in which the stepper is named `step`."""
    calls = stepper.convention
    seen = calls.asks or calls.order
    state_first = {STATE, TIME} <= {*seen} and seen.index(STATE) < seen.index(TIME)
    rates = f"lambda {'y, t' if state_first else 't, y'}: {_constructed(stepper, ('y[1]', '-y[0]'), True)}"
    names = {POSITION: "q", VELOCITY: "v", TIME: "t"}
    asked = ", ".join(names.get(role, f"_{place}") for place, role in enumerate(calls.asks or (POSITION,)))
    force = f"lambda {asked}: {-calls.factor:g} * q" if calls.factor != 1 else f"lambda {asked}: -q"
    function = {FORCE: force, FIELD: rates}.get(calls.kind, "")
    slope = (v, -q) if calls.kind == FIELD else (-calls.carried * q,)
    numbers = {POSITION: (q,), VELOCITY: (calls.momentum * v,), STATE: (q, v), CARRIED: slope}
    texts = {FUNCTION: function, TIME: "0.0", STEP: _literal(h), GRID: f"[0.0, {_literal(h)}]"}
    arguments = [texts[role] if role in texts else _written(stepper, *numbers[role]) for role in calls.order]
    named = [f"{name}={text}" for name, text in zip(calls.names, arguments, strict=False)]
    extra = [f"{name}={value!r}" for name, value in calls.extra.items()]
    return f"step({', '.join([*(named or arguments), *extra])})"


def _literal(x: float) -> str:
    """A Python expression for x, exact to the last bit."""
    return repr(x) if isfinite(x) else f'float("{x!r}")'


def _written(stepper: ForeignStepper, *numbers: float) -> str:
    adapter = stepper.adapter
    array = not adapter.shown and adapter is not SCALARS and np.ndim(adapter.write(numbers)) > 0
    return _constructed(stepper, [*map(_literal, numbers)], array)


def _constructed(stepper: ForeignStepper, texts: Sequence[str], array: bool) -> str:
    shown, text = stepper.adapter.shown, ", ".join(texts)
    if shown:
        return shown.format(*texts) if shown.count("{}") > 1 else shown.format(text)
    maker = {SCALARS: "", LISTS: "", ARRAYS: "numpy.array"}.get(stepper.adapter, stepper.adapter.name)
    text = f"[{text}]" if array else text
    return f"{maker}({text})" if maker else text
