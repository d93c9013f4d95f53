"""Functions of other names, or with control inputs, seen by what a step calls them with; plain steps of these."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from contextlib import suppress
from itertools import product
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.wrappers import wrapper_parts as common

# Names of control inputs, which a step hands on to its function; 0 is given where it computes with them as well.
CONTROL_INPUTS = ("u", "uk", "u_k", "control", "controls", "ctrl", "action", "input", "inputs", "torque", "thrust")
# The time and the step size of a trial, by which a time shows among what a function is called with.
_AT, _LONG = 8.0, 0.25


def asked_step(step: Callable[..., Any]) -> Callable[..., Any] | None:
    """The step with its function under a usual name, which is given its time and its state alone; None if none is seen.

    What else it takes, if it only hands that on to its function, is None, or 0 for a control input.

    >>> def euler(x, u, dt, model):
    ...     return x + dt * model(x, u)
    >>> print(asked_step(euler)(1.0, 0.5, lambda x: -x))
    0.5
    """
    names = [] if inspect.isclass(step) else calling.names_with_step(step) or []
    kind = calling.FORCE if {calling.POSITION, calling.VELOCITY} <= {*map(common.plain_role, names)} else calling.FIELD
    usual = [each for each in names if common.plain_role(each) == calling.FUNCTION]
    others = [each for each in names if each not in common.arguments_by_role(names, kind)]
    for function, value in product(usual or others, (None, 0.0)):
        known = {each: each for each in names if each not in others} | {function: (*usual, common.function_of(kind))[0]}
        counts = [each for each in others if each != function and calling.word_of(each) in calling.COUNTS]
        known |= {each: each for each in counts if kind == calling.FIELD}
        inputs = {each: 1 if each in counts else value for each in names if each not in known}
        if value is None or inputs.keys() <= {*CONTROL_INPUTS}:
            with suppress(Exception):
                if found := _asked(step, names, {each: known[each] for each in names if each in known}, inputs, kind):
                    return found
    return None


def _asked(
    step: Callable[..., Any], names: list[str], known: dict[str, str], inputs: dict[str, Any], kind: str
) -> Callable[..., Any] | None:
    """The step of what is `known`, by its usual name, after a trial; None if its function is not called, or usual."""
    (function,) = (each for each, name in known.items() if common.plain_role(name) == calling.FUNCTION)
    given, asked = common.arguments_by_role([*known.values()], kind), list[tuple[Any, ...]]()
    trial = {**common.TRIAL_ARGUMENTS, "t": _AT, "t + h": _AT + _LONG, "h": _LONG}
    size = np.size(trial["y" if kind == calling.FIELD else "q"])

    def places(x: tuple[Any, ...]) -> tuple[int, ...]:
        """The places of the time, if there is one, and of the state."""
        state = next(i for i, each in enumerate(x) if np.size(each) == size and each is not None)
        times = [i for i, each in enumerate(x) if i != state and isinstance(each, float) and _AT <= each <= _AT + _LONG]
        return (*times[: kind == calling.FIELD], state)

    def asks(*x: Any) -> Any:
        asked.append(x)
        return 0.0 * x[places(x)[-1]]

    values = {each: trial[given.get(name, "1")] for each, name in known.items()} | inputs | {function: asks}
    step(*[values[each] for each in names])
    ((used, count),) = {(places(x), len(x)) for x in asked}
    plain = len(used) == count or (kind == calling.FORCE and not inputs)
    if not inputs and known[function] == function and plain:
        return None
    taken = "{}" if plain else f"lambda *x: {{}}({', '.join(f'x[{i}]' for i in used)})"

    def passed(texts: Iterable[str]) -> dict[str, str]:
        written = {each: repr(x) for each, x in inputs.items()} | dict(zip(known, texts, strict=True))
        text = written[function]
        return written | {function: taken.format(f"({text})" if "lambda" in text and not plain else text)}

    made: Any = common.called_with(step, names, passed(known.values()), [*known.values()])
    made.written = lambda *texts: common.call_by_names(step, names, passed(texts))
    return made  # type: ignore[no-any-return]
