"""Wrappers of objects that keep their state, ready to paste: by `stepper_of`, as runs, as steps of their numbers."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy, deepcopy
from itertools import product
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import wrapper_parts as common
from driftproof.blackbox.stepper.asked_functions import CONTROL_INPUTS
from driftproof.blackbox.stepper.calling_conventions import (
    FIELD,
    FORCE,
    FUNCTION,
    MAP,
    POSITION,
    STATE,
    STEP,
    TIME,
    UNIT_PARAMETERS,
    VELOCITY,
    has_gradient,
    names_with_step,
    required_names,
    role_of,
    word_of,
)
from driftproof.blackbox.stepper.class_wrappers import (
    PUSHED,
    attribute_of,
    attributes_of,
    function_argument,
    public_methods,
    put_wrapper,
)

# The usual names of a method that makes a step, and of one that is given a force.
ADVANCES = ("step", "update", "advance", "integrate", "move", "tick", "do_step")
_PUSHES = ("apply_force", "add_force", "apply_central_force", "applyForce", "addForce")
# What stands for the wrapper's arguments where an object is made.
_AT_REST = {"h": "0.1", "t": "0.0", "t + h": 'float("inf")', "y": "[1.0, 0.0]", "q": "1.0", "v": "0.0"}
# A step so short that a number moves by its rate, to this part.
_SHORT, _NEAR = 2.0**-20, 2.0**-6


def kept_state_wrapper(cls: type, made: Any, advance: str, own: bool = False) -> str:
    """The wrapper of an object that keeps its state and maybe its system; "" if its method takes more than a size."""
    pushed = own or (not required_names(cls) and any(hasattr(cls, each) for each in _PUSHES))
    line = "" if pushed else put_wrapper(cls, made, advance)
    if line or not {*further_names(cls, advance)} <= {*CONTROL_INPUTS}:
        return line
    return two_states_wrapper(cls, advance) or _state_wrapper(cls, made, advance)


def making(cls: type, kind: str, made: Any = None) -> str:
    """The text that makes an object of a class, from the function that it calls if it takes one, and from nothing else.

    Its other arguments get the numbers that the object `made` keeps under their names, 1 for masses and the like, and
    those of some start for a state.
    """
    names, name = required_names(cls) or [], common.name_of(cls)
    taken = common.function_of(kind) * bool(function_argument(cls))
    if len(names) == bool(taken) and not has_gradient(names):
        return name
    kept = {each: repr(x) for each, x in getattr(made, "__dict__", {}).items() if isinstance(x, int | float)}
    given = {each: _AT_REST.get(text, text) for each, text in common.arguments_by_role(names, kind).items()}
    given |= {each: "1.0" for each in names if each not in given and word_of(each) in UNIT_PARAMETERS}
    arguments = ", ".join(given.get(each, kept.get(each, each.upper())) for each in names)
    return f"lambda {taken}: {name}({arguments})".replace("lambda :", "lambda:")


def two_states_wrapper(cls: type, advance: str) -> str:
    """The run of an object that keeps its state and the one before, and no velocity; "" if it is not one.

    Of an object in space, all coordinates are the same. Its force is given to it or to its method, pushed, or put where
    it keeps one; a function of another name is a right-hand side.
    """
    with suppress(Exception):
        names, function, taken = required_names(cls) or [], function_argument(cls), _names_taken(cls, advance)
        kept = vars(cls(*[(lambda *x: 0.0) if each == function else 0.0 for each in names]))
        before = next(each for each in kept if common.is_before(each))
        now = next(each for each in kept if role_of(each, (POSITION, STATE)))
        handed = function or any(common.plain_role(each) == FUNCTION for each in taken)
        kind = FORCE if common.takes_force((*names, *taken)) or not handed else FIELD
        given = common.arguments_by_role(taken, kind)
        if any(role_of(each, (VELOCITY,)) for each in kept) or not {*given.values()} <= {"f", "force", "h"}:
            return ""
        call, cls_name = f"made.{advance}({', '.join(given[each] for each in taken)})", common.name_of(cls)
        if kind == FIELD:
            start = ", ".join("f" if each == function else "y" for each in names)
            begin = f"made = {cls_name}({start}); made.{before}, made.{now} = y, {common.FIRST_STEP_UNTIMED}; "
            later = f"({call}, [*made.{now}])[-1]"
            line = common.run_of_steps("f, y, h", f"y, [*made.{now}]", later, begin, first=1)
            return line if common.goes_straight(line, **{cls_name: cls}) else ""
        vector = type(kept[now]).__name__ if hasattr(kept[now], "x") and hasattr(kept[now], "y") else ""
        first, whole = ("[0]", f"0 * made.{now} + ") if np.size(kept[now]) > 1 else (".x" * bool(vector), "")
        put: Callable[[str], str] = lambda x: f"{vector}({x}, 0.0)" if vector else f"{whole}{x}"
        force = f"lambda p, *rest: {put(f'force(p{first})')}"
        start = ", ".join(force if each == function else "0.0" for each in names)
        begin = f"made = {cls_name}({start}); made.{now}, made.{before} = {put('q')}, {put(common.BEFORE)}; "
        push = next((f"made.{each}(" for each in _PUSHES if hasattr(cls, each)), "")
        push = push or next((f'setattr(made, "{each}", ' for each in kept if each.lower() in PUSHED), "")
        if not (push or handed):
            return ""
        pushed = "" if handed else f"{push}force(made.{now}{first})), "
        found = common.WITH_SPEEDS.format("ys[1:]", "ys[2:]")
        later = f"({pushed}{call}, 1.0 * made.{now}{first})[-1]"
        line = common.run_of_steps(common.HEADS[FORCE], f"{common.BEFORE}, q", later, begin, found=found)
        return line if common.goes_straight(line, **{cls_name: cls, vector: type(kept[now])}) else ""
    return ""


def _state_wrapper(cls: type, made: Any, advance: str) -> str:
    """The `stepper_of` line for an object whose attributes hold its state; "" if their names do not tell where."""
    q, v, state, time = (attribute_of(made, role) for role in (POSITION, VELOCITY, STATE, TIME))
    moved, pair = _moved_numbers(made, advance)
    q, v = _pushed_pair(made, advance) or (q, v) if q and v else pair or (q, v)
    built_in = not (function_argument(cls) or any(hasattr(cls, each) for each in _PUSHES))
    if built_in and moved and not {q, v} <= {*moved} and not any(np.ndim(getattr(made, each)) for each in moved):
        return _numbers_wrapper(cls, made, advance, moved)
    if not (q and v) and (not state or common.takes_force([function_argument(cls)])):
        return ""
    where, maker = f'position="{q}", velocity="{v}"' if q and v else f'state="{state}"', "stepper_of"
    if not required_names(cls) and (push := next((each for each in _PUSHES if hasattr(cls, each)), "")):
        of_x = type(getattr(made, q.partition(".")[0], 0.0)).__name__ if q.endswith(".x") else ""
        where += f", push=lambda body, f: body.{push}({of_x}(f, 0.0))" if of_x else f', push="{push}"'
    if function_argument(cls) and not (q and v):
        where, maker = f'{where}, time="{time}"' if time else where, "field_stepper_of"
    make = making(cls, FORCE if q and v else FIELD, made)
    act, size = f'"{advance}"', attribute_of(made, STEP)
    taken = _taken_by(made, advance, "h", "0.0")
    call = f"made.{advance}({', '.join(taken)})"
    if size and "h" not in taken:
        act = f"lambda made, h: (setattr(made, '{size}', h), {call})"
    elif "0.0" in taken:
        act = f"lambda made, h: {call}"
    return f"from driftproof import {maker}; wrapped = {maker}({make}, {where}, advance={act})"


def _numbers_wrapper(cls: type, made: Any, advance: str, moved: Sequence[str]) -> str:
    """The step of an object, made anew, whose system is built in, of the time and the numbers that its step moves."""
    taken, size, time = _taken_by(made, advance, "h", "0.0"), attribute_of(made, STEP), attribute_of(made, TIME)
    call = ", ".join(taken)
    put, make = f"made.{size} = h; " if size and "h" not in taken else "", making(cls, MAP, made)
    places, put = ", ".join(f"made.{each}" for each in moved), put + f"made.{time} = t; " * bool(time)
    makes = make.removeprefix("lambda: ") if make.startswith("lambda") else f"{make}()"
    puts = f"made = {makes}; {put}[{places}] = 1.0 * y; made.{advance}({call})"
    return f"def wrapped({'t, ' * bool(time)}y, h): import numpy; {puts}; return numpy.array([{places}])"


def _moved_numbers(made: Any, advance: str) -> tuple[list[str], tuple[str, str] | None]:
    """The numbers and arrays of an object, but its time, that a short step moves; and the first that another one moves.

    That other one is its velocity.
    """
    with suppress(Exception):
        moved = deepcopy(made)
        known = {each: x for each, x in attributes_of(moved).items() if isinstance(x, float | np.ndarray)}
        for i, (each, x) in enumerate(known.items()):
            setattr(moved, each, _SHORT if common.plain_role(each) == STEP else x * 0.0 + 1 / (i + 2))
        before = {each: copy(getattr(moved, each)) for each in known}
        getattr(moved, advance)(*_taken_by(made, advance, _SHORT, 0.0))
        rates = {
            each: (getattr(moved, each) - x) / _SHORT for each, x in before.items() if common.plain_role(each) != TIME
        }
        rates = {each: rate for each, rate in rates.items() if np.any(rate)}
        others = product(rates.items(), before.items())
        pairs = [(x, y) for (x, rate), (y, v) in others if x != y and np.shape(rate) == np.shape(v)]
        near = [(x, y) for x, y in pairs if np.allclose(rates[x], before[y], _NEAR, 0)]
        return [*rates], next(iter(near or pairs * (len(pairs) == 1)), None)  # the only one, though it moves it wrongly
    return [], None


def _pushed_pair(made: Any, advance: str) -> tuple[str, str] | None:
    """The coordinate, of several with a velocity of their own, whose velocity a step changes; None if there is none."""
    with suppress(Exception):
        moved, kept = deepcopy(made), attributes_of(made)
        getattr(moved, advance)(*_taken_by(made, advance, 0.25, 0.0))
        pairs = [(each, f"v{each}") for each in "xyz" if each in kept and f"v{each}" in kept]
        return next(((q, v) for q, v in pairs if getattr(moved, v) != kept[v]), None)
    return None


def _names_taken(made: Any, advance: str) -> list[str]:
    """The names of what a method is given besides its object, with a step size that has a default."""
    return (names_with_step(getattr(made if inspect.isclass(made) else type(made), advance, int)) or [])[1:]


def _taken_by(made: Any, advance: str, size: Any, other: Any) -> list[Any]:
    """What a method is given besides its object: a step size, and `other` things."""
    return [size if common.plain_role(each) == STEP else other for each in _names_taken(made, advance)]


def further_names(cls: type, advance: str) -> list[str]:
    """What a method of a class needs besides its object and the step size."""
    return [each for each in (required_names(getattr(cls, advance, int)) or [])[1:] if common.plain_role(each) != STEP]


def advance_of(cls: type) -> str:
    """The name of the method that makes a step: a usual one, or the only public one that takes one argument or none."""
    alone = [each for each in public_methods(cls) if len(required_names(getattr(cls, each)) or ()) in (1, 2)]
    alone = [each for each in alone if any(word in each for word in ADVANCES)] or alone
    return next((each for each in ADVANCES if hasattr(cls, each)), alone[0] if len(alone) == 1 else "")


def kept_wrapper(kept: Sequence[str], advance: Any) -> str:
    """What to write in a call of `stepper_of` to set what an object keeps from its last step, with words to replace."""
    puts = ", ".join(f"setattr(made, '{name}', {name.upper()}_AT_ITS_STATE)" for name in kept)
    if not isinstance(advance, str):
        return f"; if its advance sets {', '.join(kept)} already, the step itself makes something else of what it kept"
    return f"; write advance=lambda made, h: ({puts}, made.{advance}(h)) in the call of stepper_of"
