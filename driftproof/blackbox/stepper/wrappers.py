"""The function of one line to write around a stepper that is not opened as it is: ready to paste."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from driftproof.blackbox.stepper.calling_conventions import (
    FIELD,
    FORCE,
    FUNCTION,
    MAP,
    POSITION,
    ROLES,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    required_names,
)
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.plain_forms import BODY_LISTS

_ARGUMENTS = {FUNCTION: "f", TIME: "t", STATE: "y", POSITION: "q", VELOCITY: "v", STEP: "h"}
# How a wrapper is called, of each kind.
_HEADS = {MAP: "q, v, h", FORCE: "force, q, v, h", FIELD: "f, t, y, h"}
_ADVANCES = ("step", "update", "advance", "integrate", "move", "tick", "do_step")
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
# Of a solver that takes so many steps: where they end, and how many.
_ENDS = ("t1", "tend", "t_end", "tf", "t_final", "tmax", "t_max", "t_stop", "tstop")
_COUNTED = ("n", "steps", "n_steps", "nsteps", "num_steps", "nt", "n_iter")
_SPANS = ("t_span", "tspan", "interval", "t_bound", "t_end", "tf", "t_final")


def wrapper_line(step: Callable[..., Any]) -> str:
    """What to write, as the end of a refusal; nothing where nothing is known to fit."""
    line = _of_object(step) or _of_names(step)
    return f": {line}" if line else ""


def increment_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that adds the state to what is returned."""
    name, order = _name(subject.function), subject.convention.order
    head = ", ".join(_ARGUMENTS[role] for role in order if role in _ARGUMENTS)
    if STATE in order:
        return f"; write: def wrapped({head}): return y + {name}({head})"
    return f"; write: def wrapped({head}): dq, dv = {name}({head}); return q + dq, v + dv"


def exchange_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that puts the position first."""
    name, order = _name(subject.function), subject.convention.order
    head = ", ".join({**_ARGUMENTS, FUNCTION: "force"}[role] for role in order if role in _ARGUMENTS)
    return f"; write: def wrapped({head}): v1, q1 = {name}({head}); return q1, v1"


def turn_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that gives the velocity first, and takes it so, of a state in one array."""
    name, order = _name(subject.function), subject.convention.order
    head = ", ".join(_ARGUMENTS[role] for role in order if role in _ARGUMENTS)
    turned = {FUNCTION: "lambda t, y: turn(f(t, turn(y)))", STATE: "turn(y)"}
    arguments = ", ".join(turned.get(role, _ARGUMENTS[role]) for role in order if role in _ARGUMENTS)
    turn = "import numpy; turn = lambda x: numpy.roll(x, len(x) // 2)"
    return f"; write: def wrapped({head}): {turn}; return turn({name}({arguments}))"


def _name(step: Callable[..., Any]) -> str:
    name = str(getattr(step, "__qualname__", type(step).__name__)).rpartition("<locals>.")[2]
    return name if all(part.isidentifier() for part in name.split(".")) else "step"


def _of_object(step: Callable[..., Any]) -> str:
    """Of a class, or of the method of an object, that takes the step size alone: `stepper_of`."""
    names = required_names(step)
    if inspect.isclass(step) and (line := _of_class(step)):
        return line
    owner = step if inspect.isclass(step) else getattr(step, "__self__", None)
    if owner is None or (not inspect.isclass(step) and (names is None or [*map(_role, names)] not in ([STEP], []))):
        return ""
    made, cls = owner, owner if inspect.isclass(owner) else type(owner)
    if inspect.isclass(owner):
        with suppress(Exception):
            made = cls(*[lambda *x: 0.0 for _ in required_names(cls) or []])
    advance = next((each for each in _ADVANCES if hasattr(cls, each)), "step")
    if not inspect.isclass(step):
        advance = getattr(step, "__name__", advance)
    attributes = [name for name in (vars(made) if hasattr(made, "__dict__") else {}) if not name.startswith("_")]
    places = [next((name for name in attributes if _is(role, name)), "") for role in (POSITION, VELOCITY)]
    make = cls.__name__ if len(required_names(cls) or []) < 2 else f"lambda: {cls.__name__}(...)"
    state = next((name for name in attributes if _is(STATE, name)), "state")
    where = f'position="{places[0]}", velocity="{places[1]}"' if all(places) else f'state="{state}"'
    return f'from driftproof import stepper_of; wrapped = stepper_of({make}, {where}, advance="{advance}")'


def _of_class(cls: type) -> str:
    """Of a class that is made of f: its method takes the state and gives it back, or the object keeps the state."""
    names = required_names(cls) or []
    advance = next((each for each in _ADVANCES if hasattr(cls, each)), None)
    taken = required_names(getattr(cls, advance)) if advance else None
    given = _by_role(names, FIELD)
    if not taken or len(given) < len(names) or not {"f", *_ARGUMENTS.values()}.issuperset(given.values()):
        return ""
    of_step = _by_role(taken[1:], FIELD)
    if "f" not in given.values() or len(of_step) < len(taken) - 1:
        return ""
    arguments = ", ".join(given[each] for each in names)
    call = f"{advance}({', '.join(of_step[each] for each in taken[1:])})"
    if "y" in of_step.values():
        return f"def wrapped(f, t, y, h): return {cls.__name__}({arguments}).{call}"
    if "y" not in given.values():
        return ""
    with suppress(Exception):
        values = {"f": lambda *x: 0 * x[-1], "t": 0.0, "y": np.array([1.0, 0.5]), "h": 0.25}
        kept = [*vars(cls(*[values[given[each]] for each in names]))]
        state = next(name for name in kept if _is(STATE, name))
        time = next((f"made.{name} = t; " for name in kept if _is(TIME, name) and "t" not in given.values()), "")
        return f"def wrapped(f, t, y, h): made = {cls.__name__}({arguments}); {time}made.{call}; return made.{state}"
    return ""


def _of_names(step: Callable[..., Any]) -> str:
    """Of a function: a maker of steppers, gradients of an energy, a solver; else what is known of its arguments."""
    names, name = required_names(step), _name(step)
    if names is None:
        return ""
    words = [each.lower().strip("_") for each in names]
    if any(word in _SPANS for word in words) and not any(_is(STEP, word) for word in words):
        return f"a whole solver is examined by identify_solver({name})"
    by_position = next((each for each, word in zip(names, words, strict=True) if word in _BY_POSITION), None)
    by_momentum = next((each for each, word in zip(names, words, strict=True) if word in _BY_MOMENTUM), None)
    if by_position is not None and by_momentum is not None:
        gradients = {by_position: "lambda q, *p: -force(q)", by_momentum: "lambda *p: p[-1]"}
        rest = [each for each in names if each not in gradients]
        return _call(name, names, {**gradients, **_by_role(rest, FORCE)}, FORCE)
    roles = {*map(_role, names)}
    if roles <= {FUNCTION, STEP} and roles:
        return _of_maker(step, names, name)
    of_state = POSITION not in roles or (VELOCITY not in roles and TIME in roles)
    kind = MAP if FUNCTION not in roles else FIELD if of_state else FORCE
    if not (given := _by_role(names, kind)):
        return ""
    ends = [each for each, word in zip(names, words, strict=True) if word in _ENDS]
    counts = [each for each, word in zip(names, words, strict=True) if word in _COUNTED]
    if kind == FIELD and ends and counts and "h" not in given.values():
        given |= {ends[0]: "t + h", counts[0]: "1"}
        return f"{_call(name, names, given, kind)}{_last_state(step, names, given)}"
    return _call(name, names, given, kind)


def _last_state(step: Callable[..., Any], names: Sequence[str], given: dict[Any, str]) -> str:
    """What takes the last state out of what a solver returns: of (times, states), or of states; nothing if unknown."""
    values = {"f": lambda *x: 0 * x[-1], "t": 0.0, "y": np.array([1.0, 0.5]), "t + h": 0.25, "1": 1}
    with suppress(Exception):
        found = step(*[values[given[each]] for each in names])
        parts = [1] if isinstance(found, tuple) and len(found) == 2 else []
        states = np.asarray(found[1] if parts else found)
        if states.ndim == 2:
            return f"{'[1]' if parts else ''}[-1]"
    return ""


def _of_maker(step: Callable[..., Any], names: Sequence[str], name: str) -> str:
    """Of what makes a stepper of a right-hand side, of a step size, or of both."""
    made: Callable[..., Any] | None = None
    with suppress(Exception):
        made = step(*(0.25 if _role(each) == STEP else (lambda *x: x[-1]) for each in names))
    inner = required_names(made) if callable(made) else None
    if not inner:
        return ""
    positions = {POSITION, VELOCITY} <= {_role(each) for each in inner}
    kind = MAP if FUNCTION not in map(_role, names) else FORCE if positions else FIELD
    outer = ", ".join("h" if _role(each) == STEP else _function(kind) for each in names)
    given = _by_role(inner, kind)
    head = _HEADS[kind] if kind != FIELD or "t" in given.values() else "f, y, h"
    return f"def wrapped({head}): return {name}({outer})({', '.join(given.get(each, each.upper()) for each in inner)})"


def _call(name: str, names: Sequence[str], given: dict[Any, str], kind: str) -> str:
    arguments = ", ".join(given.get(each, each.upper()) for each in names)
    left = [each for each in names if each not in given]
    said = f"  # write values for {', '.join(map(str.upper, left))}" if left else ""
    if kind == MAP and any(each.lower().strip("_") in BODY_LISTS for each in left):
        said = "  # what moves its bodies is built in: let their force be an argument, which can then be given"
    return f"def wrapped({_HEADS[kind]}): return {name}({arguments}){said}"


def _by_role(names: Sequence[str], kind: str) -> dict[str, str]:
    """The wrapper's argument for each name whose role is known; a state that a map takes is [q, v]."""
    given: dict[str, str] = {}
    for each in names:
        open_roles = [FUNCTION, STEP, TIME, *((STATE,) if kind == FIELD else (POSITION, VELOCITY, STATE))]
        role = next((r for r in open_roles if _is(r, each) and _ARGUMENTS[r] not in given.values()), None)
        if role is not None:
            given[each] = _function(kind) if role == FUNCTION else _ARGUMENTS[role]
    if kind == MAP and "v" not in given.values():
        given = {each: "[q, v]" if text in ("q", "y") else text for each, text in given.items()}
    if kind != FIELD:
        given = {each: "0.0" if text == "t" else text for each, text in given.items()}
    return given


def _function(kind: str) -> str:
    return "f" if kind == FIELD else "force"


def _is(role: str, name: str) -> bool:
    return name.lower().strip("_") in ROLES[role]


def _role(name: str) -> str | None:
    return next((role for role in (FUNCTION, STEP, TIME, POSITION, VELOCITY, STATE) if _is(role, name)), None)
