"""Wrappers of functions, ready to paste: steps with other arguments, of gradients, or of a list of the last states."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import product
from typing import Any

import numpy as np

from driftproof.blackbox.stepper.calling_conventions import (
    COUNTS,
    FIELD,
    FORCE,
    FUNCTION,
    MAP,
    POSITION,
    RUN_ENDS,
    SPANS,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    has_gradient,
    required_names,
    role_of,
    word_of,
)
from driftproof.blackbox.stepper.plain_forms import BODY_LISTS

# The arguments of a wrapper by role, and all of them for a wrapper of each kind.
ARGUMENTS = {FUNCTION: "f", TIME: "t", STATE: "y", POSITION: "q", VELOCITY: "v", STEP: "h"}
HEADS = {MAP: "q, v, h", FORCE: "force, q, v, h", FIELD: "f, t, y, h"}
# Roles in the order in which a name is tried for them.
PLAIN_ROLES = (FUNCTION, STEP, TIME, POSITION, VELOCITY, STATE)
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
_BEFORE = re.compile("prev|old|last|before|nm1")
# Names of a list of the last states; a method in use looks back at no more than this many.
_LISTS, _MOST_STATES = re.compile("^ys$|^us$|^xs$|states|hist|past|prev"), 7
_SPANS = (*SPANS, "t_bound", "t_end", "tf", "t_final")
# The step of second order that stands in for the first steps of a method that takes earlier states.
_FIRST_STEP = "y + h * f(t + h / 2, y + h / 2 * f(t, y))"


def function_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function: a step with gradients of an energy, a solver, or a plain step."""
    names, name = required_names(step), name_of(step)
    if names is None:
        return ""
    if _named(names, _SPANS) and not any(role_of(each, (STEP,)) for each in names):
        return f"identify_solver({name}), for a whole solver"
    by_position, by_momentum = (_named(names, known) for known in (_BY_POSITION, _BY_MOMENTUM))
    if by_position is not None and by_momentum is not None:
        gradients = {by_position: "lambda q, *p: -force(q)", by_momentum: "lambda *p: p[-1]"}
        rest = [each for each in names if each not in gradients]
        return _call(name, names, {**gradients, **arguments_by_role(rest, FORCE)}, FORCE)
    roles = {role_of(each, PLAIN_ROLES) for each in names}
    of_state = POSITION not in roles or (VELOCITY not in roles and TIME in roles)
    kind = MAP if FUNCTION not in roles else FIELD if of_state else FORCE
    if line := list_wrapper(step):
        return line[2:]
    if not (given := arguments_by_role(names, kind)):
        return ""
    end, count = (_named(names, known) for known in (RUN_ENDS[1], COUNTS))
    if kind == FIELD and end is not None and count is not None and "h" not in given.values():
        given |= {end: "t + h", count: "1"}
        return f"{_call(name, names, given, kind)}{_last_state(step, names, given)}"
    return _call(name, names, given, kind)


def _named(names: Sequence[str], known: Sequence[str]) -> str | None:
    """The first of the names that is a known one; None if none is."""
    return next((each for each in names if word_of(each) in known), None)


def list_wrapper(step: Callable[..., Any]) -> str:
    """The run of n steps of a method that takes a list of the last states; "" if no list of up to seven is taken.

    Of y' = 1 every method finds the next state, t + h, if the list is in its own order.
    """
    name, names = name_of(step), [] if inspect.isclass(step) else required_names(step) or []
    past = next((each for each in names if _LISTS.search(each.lower())), "")
    given = {past: "ys"} | arguments_by_role([each for each in names if each != past], FIELD)
    if len(given) < len(names) or not {"f", "ys", "h"} <= {*given.values()} <= {"f", "t", "ys", "h"}:
        return ""
    for size, turned in product(range(2, _MOST_STATES + 1), (1, -1)):
        with suppress(Exception):
            ys = [np.array([i / 4, i / 4]) for i in range(1 - size, 1)][::turned]
            values = {"f": lambda *x: np.ones(2), "t": 0.0, "ys": ys, "h": 0.25}
            if np.allclose(step(*[values[given[each]] for each in names]), 0.25, rtol=0, atol=2.0**-20):
                shown = {"ys": "ys[::-1]" if turned < 0 else "ys", "t": "t + i * h"}
                call = f"{name}({', '.join(shown.get(given[each], given[each]) for each in names)})"
                start = f"s = lambda t, y: {_FIRST_STEP}; ys = [y]"
                later = f"ys.append(s(t + i * h, ys[-1]) if i < {size - 1} else {call}) or ys[-1] for i in range(n)"
                return f": def wrapped(f, t, y, h, n): {start}; return [y, *({later})]  # begins with midpoint2"
    return ""


def _last_state(step: Callable[..., Any], names: Sequence[str], given: dict[Any, str]) -> str:
    """The index of the last state in what a solver returns, (times, states) or states; "" if that is not known."""
    values = {"f": lambda *x: 0 * x[-1], "t": 0.0, "y": np.array([1.0, 0.5]), "t + h": 0.25, "1": 1}
    with suppress(Exception):
        found = step(*[values[given[each]] for each in names])
        parts = [1] if isinstance(found, tuple) and len(found) == 2 else []
        states = np.asarray(found[1] if parts else found)
        if states.ndim == 2:
            return f"{'[1]' if parts else ''}[-1]"
    return ""


def _call(name: str, names: Sequence[str], given: dict[Any, str], kind: str) -> str:
    """The wrapper that calls a function of these names with the arguments given; those left are in capitals."""
    arguments = ", ".join(given.get(each, each.upper()) for each in names)
    left = [each for each in names if each not in given]
    if len(left) == 1 and _BEFORE.search(left[0].lower()) and kind == FIELD and {"y", "h"} <= {*given.values()}:
        later = {"y": "ys[-1]", "t": "t + i * h"}
        call = ", ".join(later.get(text := given.get(each, "ys[-2]"), text) for each in names)
        run = f"ys = [y, {_FIRST_STEP}]; return [*ys, *(ys.append({name}({call})) or ys[-1] for i in range(1, n))]"
        return f"def wrapped(f, t, y, h, n): {run}  # a run of n steps, whose first is one of midpoint2"
    said = f"  # write values for {', '.join(map(str.upper, left))}" if left else ""
    if len(left) == 1 and _BEFORE.search(left[0].lower()):
        said = f"  # a method of two steps: let an object keep its {left[0].upper()}, step(f, t, y, h) being its method"
    if kind == MAP and "h" not in given.values():
        said = "  # its h is built in: let it be an argument, or make the step anew for every h"
    if kind == MAP and any(word_of(each) in BODY_LISTS for each in left):
        said = "  # what moves its bodies is built in: let their force be an argument, which can then be given"
    return f"def wrapped({HEADS[kind]}): return {name}({arguments}){said}"


def arguments_by_role(names: Sequence[str], kind: str) -> dict[str, str]:
    """The wrapper's argument for each name whose role is known; a single state of a map is [q, v]."""
    given: dict[str, str] = {}
    for each in names:
        wanted = (FUNCTION, STEP, TIME, *((STATE,) if kind == FIELD else (POSITION, VELOCITY, STATE)))
        role = role_of(each, [role for role in wanted if ARGUMENTS[role] not in given.values()])
        if role is not None:
            function = "lambda x: -force(x)" if kind == FORCE and has_gradient([each]) else function_of(kind)
            given[each] = function if role == FUNCTION else ARGUMENTS[role]
    if kind == MAP and not {"q", "v"} <= {*given.values()}:
        given = {each: "[q, v]" if text in ("q", "v", "y") else text for each, text in given.items()}
    if kind != FIELD:
        given = {each: "0.0" if text == "t" else text for each, text in given.items()}
    return given


def function_of(kind: str) -> str:
    """The name that a wrapper of this kind has for the function that it is given."""
    return "f" if kind == FIELD else "force"


def name_of(step: Callable[..., Any]) -> str:
    """The name by which a wrapper calls the code."""
    name = str(getattr(step, "__qualname__", type(step).__name__)).rpartition("<locals>.")[2]
    return name if all(part.isidentifier() for part in name.split(".")) else "step"
