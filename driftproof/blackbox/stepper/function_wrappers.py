"""Wrappers of functions, ready to paste: steps with other arguments, of gradients, or of a list of the last states."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
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
    UNIT_PARAMETERS,
    VELOCITY,
    has_gradient,
    names_with_step,
    parameters_of,
    required_names,
    role_of,
    word_of,
)
from driftproof.blackbox.stepper.plain_forms import BODY_LISTS

# The arguments of a wrapper by role, and all of them for a wrapper of each kind.
ARGUMENTS = {FUNCTION: "f", TIME: "t", STATE: "y", POSITION: "q", VELOCITY: "v", STEP: "h"}
HEADS = {MAP: "q, v, h", FORCE: "force, q, v, h", FIELD: "f, t, y, h"}
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
_BEFORE = re.compile("prev|old|last|before|nm1")
# Names of a list of the last states; a method in use looks back at no more than this many.
_LISTS, _MOST_STATES = re.compile("^ys$|^us$|^xs$|states|hist|past|prev"), 7
_SPANS = (*SPANS, "t_bound", "t_end", "tf", "t_final")
# The values of a wrapper's arguments with which a step is tried, in a field in which nothing moves by itself.
TRIAL_ARGUMENTS = {
    **dict.fromkeys(("f", "force"), lambda *x: 0.0 * max(x, key=np.size)),
    **{"t": 0.0, "0.0": 0.0, "h": 0.25, "t + h": 0.25, "q": 1.0, "ys[-2]": 1.0, "v": 0.5, "1.0": 1.0, "1": 1, "()": ()},
    **dict.fromkeys(("y", "[q, v]"), np.array([1.0, 0.5])),
    **dict.fromkeys(("[t, t + h]", "[0.0, h]"), np.array([0.0, 0.25])),
}
_PARAMETERS = ("args", "params", "parameters", "kwargs")
# Of a method for q'' = F(q) that takes two positions: the position before, and the pairs, with velocities of order 1.
BEFORE, WITH_SPEEDS = "q - h * v + h**2 / 2 * force(q)", "{0}, [v, *((b - a) / h for a, b in zip({0}, {1}))]"
# The step of second order that stands in for the first steps of a method that takes earlier states.
FIRST_STEP, FIRST_STEP_UNTIMED = "y + h * f(t + h / 2, y + h / 2 * f(t, y))", "y + h * f(y + h / 2 * f(y))"


def function_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function: a step with gradients of an energy, a run, a solver, or a plain step."""
    if (names := names_with_step(step)) is None:
        return ""
    if _named(names, _SPANS) and not any(role_of(each, (STEP,)) for each in names):
        return f"identify_solver({name_of(step)}), for a whole solver"
    by_position = next((each for each in names if has_gradient([each])), _named(names, _BY_POSITION))
    by_momentum = _named(names, _BY_MOMENTUM)
    if by_position is not None and by_momentum is not None:
        gradients = {by_position: "lambda q, *p: -force(q)", by_momentum: "lambda *p: p[-1]"}
        rest = [each for each in names if each not in gradients]
        return _call(step, names, {**gradients, **arguments_by_role(rest, FORCE)}, FORCE)
    roles = {plain_role(each): word_of(each) for each in names}
    forced = takes_force(names) or has_gradient(names) or roles.get(FUNCTION) == "a"
    of_state = POSITION not in roles or (VELOCITY not in roles and (TIME in roles or not forced))
    kind = MAP if FUNCTION not in roles else FIELD if of_state else FORCE
    given = arguments_by_role(names, kind)
    line = list_wrapper(step) or _run_wrapper(step, names) or _pair_wrapper(step, names, given)
    return line or (_call(step, names, given, kind) if given else "")


def plain_role(name: str) -> str | None:
    """The role of an argument by its name."""
    return role_of(name, (FUNCTION, STEP, TIME, POSITION, VELOCITY, STATE))


def kind_by_names(names: Iterable[str]) -> str:
    """The kind of a step with these arguments: with a function, FORCE for a position and a velocity, else FIELD."""
    roles = {*map(plain_role, names)}
    return MAP if FUNCTION not in roles else FORCE if {POSITION, VELOCITY} <= roles else FIELD


def takes_force(names: Iterable[str]) -> bool:
    """True if one of these is the name of a force or an acceleration."""
    return any(word in each.lower() for each in names for word in ("acc", "force"))


def _named(names: Sequence[str], known: Sequence[str]) -> str | None:
    """The first of the names that is a known one; None if none is."""
    return next((each for each in names if word_of(each) in known), None)


def list_wrapper(step: Callable[..., Any]) -> str:
    """The run of n steps of a method that takes a list of the last states; "" if no list of up to seven is taken.

    Of y' = 1 every method finds the next state, t + h, if the list is in its own order.
    """
    names = [] if inspect.isclass(step) else required_names(step) or []
    past = next((each for each in names if _LISTS.search(each.lower())), "")
    given = {past: "ys"} | arguments_by_role([each for each in names if each != past], FIELD)
    if len(given) < len(names) or not {"f", "ys", "h"} <= {*given.values()} <= {"f", "t", "ys", "h"}:
        return ""
    for size, turned in product(range(2, _MOST_STATES + 1), (1, -1)):
        with suppress(Exception):
            ys = [np.array([i / 4, i / 4]) for i in range(1 - size, 1)][::turned]
            values = {"f": lambda *x: np.ones(2), "t": 0.0, "ys": ys, "h": 0.25}
            if np.allclose(step(*[values[given[each]] for each in names]), 0.25, rtol=0, atol=2.0**-20):
                call = _called(step, names, later_arguments(given, ys="ys[::-1]" if turned < 0 else "ys"))
                later = f"s(t + i * h, ys[-1]) if i < {size - 1} else {call}"
                line = run_of_steps(HEADS[FIELD], "y", later, f"s = lambda t, y: {FIRST_STEP}; ")
                return f"{line}  # begins with midpoint2"
    return ""


def _run_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a run to a given end, or over a row of times whatever their name, by its last state.

    It is "" unless the run is seen to begin at the start: the first row of a part of its answer is the state there.
    """
    kind = kind_by_names(names)
    end = next((each for each in names if word_of(each) in RUN_ENDS[1] or each == "T"), "")
    given = arguments_by_role([each for each in names if each != end], kind)
    left, timed = [each for each in names if given.get(each, "0.0") == "0.0"], "t" in given.values()
    if end:
        given[end] = "t + h" if timed else "h"
    elif len(left) == 1 and "h" not in given.values():
        timed = kind == FIELD
        given[left[0]] = "[t, t + h]" if timed else "[0.0, h]"
    else:
        return ""
    with suppress(Exception):
        found = step(*[TRIAL_ARGUMENTS[given[each]] for each in names])
        parts = found if isinstance(found, tuple) else (found,)
        at = {repr(np.asarray(part, float).tolist()[0]): f"[{i}]" for i, part in enumerate(parts) if np.ndim(part)}
        head, run = HEADS[kind] if timed or kind != FIELD else "f, y, h", _called(step, names, given)
        if {"q", "v"} <= {*given.values()}:
            return f"def wrapped({head}): run = {run}; return run{at['1.0']}[-1], run{at['0.5']}[-1]"
        return f"def wrapped({head}): return {run}{at['[1.0, 0.5]'] * (parts is found)}[-1]"
    return ""


def _pair_wrapper(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str]) -> str:
    """The wrapper of a step of x' = f, v' = g with both functions as arguments; "" if it calls no two with x and v."""
    functions = [each for each in names if given.get(each, "force") == "force"]
    if len(functions) != 2 or not {"q", "v"} <= {*given.values()}:
        return ""
    asked: list[tuple[Any, ...]] = []

    def asks(*x: Any) -> float:
        asked.append(x)
        return 0.0

    values = {each: TRIAL_ARGUMENTS.get(given.get(each, "")) for each in names} | dict.fromkeys(functions, asks)
    with suppress(Exception):
        step(*[values[each] for each in names])
        at_q, at_v = (asked[0].index(TRIAL_ARGUMENTS[each]) for each in "qv")
        both = dict(zip(functions, (f"lambda *x: x[{at_v}]", f"lambda *x: force(x[{at_q}])"), strict=True))
        return f"def wrapped({HEADS[FORCE]}): return {_called(step, names, {**given, **both})}"
    return ""


def _call(step: Callable[..., Any], names: Sequence[str], given: Mapping[Any, str], kind: str) -> str:
    """The wrapper that calls a function of these names with the arguments given; those left are in capitals."""
    left = [each for each in names if each not in given]
    time = ", t for the time" * (kind == FIELD and len(left) == 1 and {"t", "t + h"}.isdisjoint(given.values()))
    said = f"  # write values for {', '.join(map(str.upper, left))}{time}" if left else ""
    if len(left) == 1 and is_before(left[0]):
        if line := _two_step_call(step, names, given, kind):
            return line
        said = f"  # a method of two steps: let an object keep its {left[0].upper()}, step(f, t, y, h) being its method"
    if kind == MAP and "h" not in given.values():
        said = "  # its h is built in: let it be an argument, or make the step anew for every h"
    if kind == MAP and any(word_of(each) in BODY_LISTS for each in left):
        said = "  # what moves its bodies is built in: let their force be an argument, which can then be given"
    call = _called(step, names, {each: each.upper() for each in left} | {**given})
    return f"def wrapped({HEADS[kind]}): return {call}{said}"


def _two_step_call(step: Callable[..., Any], names: Sequence[str], given: Mapping[Any, str], kind: str) -> str:
    """The run of a function whose one argument not given is the state before; "" if it cannot be written."""
    given = dict.fromkeys(names, "ys[-2]") | {**given}
    if kind == FIELD and {"y", "h"} <= {*given.values()}:
        later = _called(step, names, later_arguments(given))
        line = run_of_steps(HEADS[kind], f"y, {FIRST_STEP}", later, first=1)
        return f"{line}  # a run of n steps, whose first is one of midpoint2"
    if kind == FORCE and {*given.values()} == {"force", "q", "h", "ys[-2]"}:
        with suppress(Exception):
            pair = isinstance(step(**{each: TRIAL_ARGUMENTS[given[each]] for each in names}), tuple)
            later = _called(step, names, later_arguments(given, q="ys[-1]")) + "[0]" * pair
            return run_of_steps(HEADS[kind], f"{BEFORE}, q", later, found=WITH_SPEEDS.format("ys[1:]", "ys[2:]"))
    if kind == MAP:
        head = f"def {name_of(step)}(force, {', '.join(names)}): ..."
        return f"{head}  # a method of two steps is read if its force is an argument"
    return ""


def run_of_steps(head: str, states: str, later: str, begin: str = "", first: int = 0, found: str = "ys") -> str:
    """The wrapper of a run: the `states` before step number `first`, then `later`, which is a text in terms of ys."""
    steps = f"[ys.append({later}) for i in range({f'{first}, ' if first else ''}n)]"
    return f"def wrapped({head}, n): {begin}ys = [{states}]; {steps}; return {found}"


def later_arguments(given: Mapping[str, str], **of_last: str) -> dict[str, str]:
    """What step i of a run is given in place of the start."""
    of_last = {"t": "t + i * h", "y": "ys[-1]", "[q, v]": "ys[-1]"} | of_last
    return {each: of_last.get(text, text) for each, text in given.items()}


def _called(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str]) -> str:
    """The call with what is given for each name, by place if that is the names' own order."""
    by_place = [*(parameters_of(step) or ())][: len(names)] == [*names]  # a step size with a default may not be
    passed = [f"{'' if by_place else f'{each}='}{given[each]}" for each in names]
    return f"{name_of(step)}({', '.join(passed)})"


def arguments_by_role(names: Sequence[str], kind: str) -> dict[str, str]:
    """The wrapper's argument for each name whose role is known; a single state of a map is [q, v]."""
    given: dict[str, str] = {}
    if kind == FIELD and (pair := [each for each in names if word_of(each) in ("x", "x0", "y", "y0")])[1:]:
        given = dict(zip(pair, "ty", strict=False))  # of f(x, y) the first is the time
    for each in (name for name in names if name not in given):
        wanted = (FUNCTION, STEP, TIME, *((STATE,) if kind == FIELD else (POSITION, VELOCITY, STATE)))
        role = role_of(each, [role for role in wanted if ARGUMENTS[role] not in given.values()])
        if role is not None:
            function = "lambda x: -force(x)" if kind == FORCE and has_gradient([each]) else function_of(kind)
            given[each] = function if role == FUNCTION else ARGUMENTS[role]
    open_names = [each for each in names if each not in given]
    if kind == FIELD:
        sized = "h" in given.values()
        given |= {each: "t + h" for each in open_names if word_of(each) in RUN_ENDS[1] and (each != "b" or not sized)}
        given |= {each: "1" for each in open_names if word_of(each) in COUNTS and not sized}
    given |= {each: "()" for each in open_names if word_of(each) in _PARAMETERS}
    if kind == MAP:
        given |= {each: "1.0" for each in open_names if word_of(each) in UNIT_PARAMETERS}
    if kind == MAP and not {"q", "v"} <= {*given.values()}:
        given = {each: "[q, v]" if text in ("q", "v", "y") else text for each, text in given.items()}
    if kind != FIELD:
        given = {each: "0.0" if text == "t" else text for each, text in given.items()}
    return {each: given[each] for each in names if each in given}


def is_before(name: str) -> bool:
    """True if it is the name of a state or a slope before the present one."""
    return bool(_BEFORE.search(name.lower()))


def function_of(kind: str) -> str:
    """The name that a wrapper of this kind has for the function that it is given."""
    return "f" if kind == FIELD else "force"


def name_of(step: Callable[..., Any]) -> str:
    """The name by which a wrapper calls the code."""
    name = str(getattr(step, "__qualname__", type(step).__name__)).rpartition("<locals>.")[2]
    if inspect.ismethod(step) and not inspect.isclass(step.__self__):
        name = f"made.{step.__name__}"
    return name if all(part.isidentifier() for part in name.split(".")) else "step"
