"""Wrappers of steppers that are made first, ready to paste: from a class, or by a function that makes steppers."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from driftproof.blackbox.stepper import wrapper_parts as common
from driftproof.blackbox.stepper.asked_functions import CONTROL_INPUTS
from driftproof.blackbox.stepper.calling_conventions import (
    FIELD,
    FORCE,
    FUNCTION,
    POSITION,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    names_with_step,
    parameters_of,
    required_names,
)
from driftproof.blackbox.stepper.class_wrappers import (
    START,
    Made,
    attribute_of,
    class_run_wrapper,
    function_argument,
    public_methods,
)
from driftproof.blackbox.stepper.kept_state_wrappers import ADVANCES, advance_of, kept_state_wrapper, two_states_wrapper

# A right-hand side that is given inputs after its state.
_OF_STATE = "lambda y, *rest: f(y)"


def object_wrapper(step: Callable[..., Any], own: bool = False) -> str:
    """The wrapper of a class, or of a method that takes the step size alone; "" if no state is found.

    If its `own` system is to be judged, nothing of it is replaced.
    """
    if inspect.isclass(step):
        advance = advance_of(step) or "step"
        made, whole = _made_anyhow(step), class_run_wrapper(step)
        once = whole * whole.startswith("identify_solver") or _class_wrapper(step) or whole or _own_step(step)
        return once or kept_state_wrapper(step, made, advance, own)
    made, names = getattr(step, "__self__", None), required_names(step)
    if made is None or names is None or [*map(common.plain_role, names)] not in ([STEP], []):
        return ""
    cls = type(made)
    taken = function_argument(cls) and _class_wrapper(cls, step.__name__)
    return taken or kept_state_wrapper(cls, made, step.__name__, own)


def _own_step(cls: type) -> str:
    """The method of an object of the class that is a step already, of the state and a function or of q and v."""
    for each in (name for name in ADVANCES if hasattr(cls, name)):
        roles = {common.plain_role(name) for name in names_with_step(getattr(cls, each)) or ()}
        if {STEP, POSITION, VELOCITY} <= roles or ({STEP, FUNCTION} <= roles and roles & {STATE, POSITION}):
            given = ", ".join(name.upper() for name in required_names(cls) or ())
            return f"wrapped = {common.name_of(cls)}({given}).{each}{f'  # write values for {given}' if given else ''}"
    return ""


def _made_anyhow(cls: type) -> Any:
    """An object of the class, made with trial values, or a function, for each argument; else the class itself."""
    given = common.arguments_by_role(names := required_names(cls) or [], FIELD)
    for known in (given, {}):
        with suppress(Exception):
            return cls(*[common.TRIAL_ARGUMENTS.get(known.get(each, ""), lambda *x: 0.0) for each in names])
    return cls


def _class_wrapper(cls: type, own: str | None = None) -> str:
    """The wrapper of a class made from f, whose method takes and returns the state or whose object keeps it."""
    names = required_names(cls) or []
    ways = (each for base in cls.__mro__ for each in (*ADVANCES, "__call__") if each in vars(base))
    own = own or next(ways, None) or _only_step(cls)  # that of the class itself before that of a base
    taken = names_with_step(getattr(cls, own)) if own else None
    if not taken:
        return ""
    method = "" if own == "__call__" else f".{own}"
    if sum(map(common.is_before, names)) == 1:
        return two_states_wrapper(cls, own)
    with_size = names_with_step(cls) or []  # where a class is made with a step size that has a default, it is given
    if STEP not in map(common.plain_role, taken) and [*(parameters_of(cls) or ())][: len(with_size)] == with_size:
        names = with_size
    kind = common.kind_by_names((*names, *taken))
    made = Made(kind, cls, common.arguments_by_role(names, kind), common.arguments_by_role(taken[1:], kind), method)
    inputs = [each for each in taken[1:] if each not in made.call]
    if kind == FIELD and inputs and {*inputs} <= {*CONTROL_INPUTS}:  # which a step hands on to its function
        takes = {each: _OF_STATE if text == "f" else text for each, text in made.arguments.items()}
        made = made._replace(arguments=takes, call={each: made.call.get(each, "None") for each in taken[1:]})
    if kind == FORCE and {*made.call.values()} - {"h"} == {"q"}:  # of one argument, that is all of the state
        made = made._replace(call={x: "[q, v]" if text == "q" else text for x, text in made.call.items()})
    given, called = {"f" if x == _OF_STATE else x for x in made.arguments.values()}, {*made.call.values()}
    if (
        len(made.arguments) < len(names)
        or len(made.call) < len(taken) - 1
        or common.function_of(kind) not in given | called
    ):
        return ""
    if made.state <= called or "[q, v]" in called:
        made = made.fitted()
        with suppress(Exception):
            if made.state <= called and "t" not in given | called:
                clock = attribute_of(made.new(START[kind], 0.0)["made"], TIME)
                made = made._replace(puts={clock: "t"} if clock else {})
        return made.line()
    with suppress(Exception):
        kept = made.new(START[kind], 0.0)["made"]
        places = [attribute_of(kept, role) for role in ((POSITION, VELOCITY) if kind == FORCE else (STATE,))]
        puts = {attribute_of(kept, TIME) * ("t" not in given): "t"}
        puts |= {attribute_of(kept, STEP) * ("h" not in given | called): "h"}
        puts.pop("", None)
        return made._replace(kept=places, puts=puts).line() if all(places) and made.state <= given else ""
    return ""


def _only_step(cls: type) -> str:
    """The only method of a class that takes a state and a step size; "" if there are none, or several."""
    roles = {each: {*map(common.plain_role, names_with_step(getattr(cls, each)) or ())} for each in public_methods(cls)}
    found = [each for each, held in roles.items() if STEP in held and held & {POSITION, STATE}]
    return found[0] if len(found) == 1 else ""


def clock_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of an object with a clock of its own, which is set; if none is found, what to do."""
    if clock := attribute_of(getattr(step, "made", None), TIME):
        return f'; write time="{clock}" in the call of field_stepper_of'
    owner = getattr(step, "__self__", step)
    cls, method = type(owner), f".{step.__name__}" if inspect.ismethod(step) else ""
    if not (clock := attribute_of(owner, TIME)):
        return ": let the time be an argument, or make the step anew each time"
    given = {each: each.upper() for each in required_names(cls) or ()}
    call = common.arguments_by_role(required_names(step) or (), FIELD)
    return f"; write: {Made(FIELD, cls, given, call, method, puts={clock: 't'}).line()}"


def owner_of(step: Callable[..., Any]) -> Callable[..., Any]:
    """The class of which this function is a method, found by the name it has in its module; otherwise the function."""
    path = getattr(step, "__qualname__", "").split(".")[:-1]
    found: Any = sys.modules.get(getattr(step, "__module__", ""))
    for name in path if inspect.isfunction(step) else ():
        found = getattr(found, name, None)
    return found if inspect.isclass(found) else step


def maker_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function that makes a stepper from a right-hand side, from a step size, or from both."""
    names = required_names(step) or []
    made: Callable[..., Any] | None = None
    with suppress(Exception):
        made = step(*(0.25 if common.plain_role(each) == STEP else (lambda *x: x[-1]) for each in names))
    inner = required_names(made) if callable(made) else None
    if not inner:
        return ""
    kind = common.kind_by_names((*names, *inner))
    arguments = {each: "h" if common.plain_role(each) == STEP else common.function_of(kind) for each in names}
    given = {each: each.upper() for each in inner} | common.arguments_by_role(inner, kind)
    return Made(kind, step, arguments, given).line()
