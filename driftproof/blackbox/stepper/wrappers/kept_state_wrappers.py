"""Wrappers of objects that keep their state, ready to paste: by `stepper_of`, as runs, as steps of their numbers."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy, deepcopy
from itertools import product
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, FUNCTION, STEP, TIME, required_names, role_of
from driftproof.blackbox.stepper.wrappers import made_wrappers as objects
from driftproof.blackbox.stepper.wrappers import wrapper_parts as common
from driftproof.blackbox.stepper.wrappers.asked_functions import CONTROL_INPUTS
from driftproof.blackbox.stepper.wrappers.function_wrappers import class_run_wrapper
from driftproof.blackbox.stepper.wrappers.made_wrappers import (
    ADVANCES,
    Made,
    attribute_of,
    attributes_of,
    function_argument,
)
from driftproof.blackbox.stepper.wrappers.wrapper_parts import name_of, plain_role

# The usual names of a method that is given a force.
_PUSHES = ("apply_force", "add_force", "apply_central_force", "applyForce", "addForce")
# What stands for the wrapper's arguments where an object is made.
_AT_REST = {"h": "0.1", "t": "0.0", "t + h": 'float("inf")', "y": "[1.0, 0.0]", "q": "1.0", "v": "0.0"}
# A step so short that a number moves by its rate, to this part.
_SHORT, _NEAR = 2.0**-20, 2.0**-6


def object_wrapper(step: Callable[..., Any], own: bool = False) -> str:
    """The wrapper of a class, or of a method that takes the step size alone; "" if no state is found.

    If its `own` system is to be judged, nothing of it is replaced.
    """
    if inspect.isclass(step):
        advance, whole = advance_of(step) or "step", class_run_wrapper(step)
        once = whole * whole.startswith("identify_solver") or _class_wrapper(step) or whole or _own_step(step)
        return once or _kept_state_wrapper(step, _made_anyhow(step), advance, own)
    made, names = getattr(step, "__self__", None), required_names(step)
    if made is None or names is None or [*map(plain_role, names)] not in ([STEP], []):
        return ""
    cls = type(made)
    taken = function_argument(cls) and _class_wrapper(cls, step.__name__)
    return taken or _kept_state_wrapper(cls, made, step.__name__, own)


def _class_wrapper(cls: type, own: str | None = None) -> str:
    """The wrapper of a class by what it and a method take: its own method before that of a base, or the only one."""
    ways = (each for base in cls.__mro__ for each in (*ADVANCES, "__call__") if each in vars(base))
    if not (own := own or next(ways, None) or _only_step(cls)) or not calling.names_with_step(getattr(cls, own)):
        return ""
    if sum(map(common.is_before, required_names(cls) or ())) == 1:
        return _two_states_wrapper(cls, own)
    return objects.class_wrapper(cls, own)


def _only_step(cls: type) -> str:
    """The only method of a class that takes a state and a step size; "" if there are none, or several."""
    roles = {each: _roles(cls, each) for each in objects.public_methods(cls)}
    found = [each for each, held in roles.items() if STEP in held and held & {calling.POSITION, calling.STATE}]
    return found[0] if len(found) == 1 else ""


def _roles(cls: type, method: str) -> set[str | None]:
    return {*map(plain_role, objects.names_taken(cls, method))}


def _own_step(cls: type) -> str:
    """The method of an object of the class that is a step already, of the state and a function or of q and v."""
    for each in (name for name in ADVANCES if hasattr(cls, name)):
        roles, place = _roles(cls, each), calling.POSITION
        if {STEP, place, calling.VELOCITY} <= roles or ({STEP, FUNCTION} <= roles and roles & {calling.STATE, place}):
            given = ", ".join(name.upper() for name in required_names(cls) or ())
            return f"wrapped = {name_of(cls)}({given}).{each}{f'  # write values for {given}' if given else ''}"
    return ""


def _made_anyhow(cls: type) -> Any:
    """An object of the class, made with trial values, or a function, for each argument; else the class itself."""
    names = required_names(cls) or []
    for known in (common.arguments_by_role(names, FIELD), {}):
        with suppress(Exception):
            return cls(*[common.TRIAL_ARGUMENTS.get(known.get(each, ""), lambda *x: 0.0) for each in names])
    return cls


def _kept_state_wrapper(cls: type, made: Any, advance: str, own: bool) -> str:
    """The wrapper of an object that keeps its state and maybe its system; "" if its method takes more than a size."""
    pushed = own or (not required_names(cls) and any(hasattr(cls, each) for each in _PUSHES))
    line = "" if pushed else objects.put_wrapper(cls, made, advance)
    if line or not {*further_names(cls, advance)} <= {*CONTROL_INPUTS}:
        return line
    return _two_states_wrapper(cls, advance) or _state_wrapper(cls, made, advance)


def making(cls: type, kind: str, made: Any = None) -> str:
    """The text that makes an object of a class, from the function that it calls if it takes one, and from nothing else.

    What else it takes is what `made` was given.
    """
    texts, taken = [*_start_of(cls, kind, made).values()], common.function_of(kind) * bool(function_argument(cls))
    call = f"{name_of(cls)}({', '.join(texts)})"
    return name_of(cls) if texts in ([], [taken]) else f"lambda {taken}: {call}".replace("lambda :", "lambda:")


def _start_of(cls: type, kind: str, made: Any) -> dict[str, str]:
    """What a class is given for each argument: its function, and those of some start for a state.

    Its other arguments get the numbers that the object `made` keeps under their names, 1 for masses and the like, also
    for those by default that divide what it calls.
    """
    names = required_names(cls) or []
    masses = objects.unit_masses(cls) if function_argument(cls) and kind == FORCE else {}
    kept = {each: repr(x) for each, x in getattr(made, "__dict__", {}).items() if isinstance(x, int | float)}
    given = {each: _AT_REST.get(text, text) for each, text in common.arguments_by_role(names, kind).items()}
    given |= {each: "1.0" for each in names if each not in given and calling.word_of(each) in calling.UNIT_PARAMETERS}
    given |= masses
    return {each: given.get(each, kept.get(each, each.upper())) for each in (*names, *masses)}


def _two_states_wrapper(cls: type, advance: str) -> str:
    """The run of an object that keeps its state and the one before, and no velocity; "" if it is not one.

    Its force is given to it or to its method, pushed, or put where it keeps one; a function of another name is a
    right-hand side. It goes straight on where no force acts, or where y' = 1/2.
    """
    with suppress(Exception):
        names, function, taken = required_names(cls) or [], function_argument(cls), objects.names_taken(cls, advance)
        begun = cls(*[(lambda *x: 0.0) if each == function else 0.0 for each in names])
        before = next(each for each in vars(begun) if common.is_before(each))
        now = next(each for each in vars(begun) if role_of(each, (calling.POSITION, calling.STATE)))
        handed = function or any(plain_role(each) == FUNCTION for each in taken)
        kind = FORCE if common.takes_force((*names, *taken)) or not handed else FIELD
        given = common.arguments_by_role(taken, kind)
        if any(role_of(each, (calling.VELOCITY,)) for each in vars(begun)) or {*given.values()} - {"f", "force", "h"}:
            return ""
        start = {each: "f" if each == function else "y" for each in names}
        puts = {before: "y", now: common.FIRST_STEP_UNTIMED}
        made = Made(kind, cls, start, {each: given[each] for each in taken}, f".{advance}", puts=puts)
        if kind == FIELD:
            later = f"({made.once}, [*made.{now}])[-1]"
            line = common.run_of_steps(FIELD, f"y, [*made.{now}]", later, made.begin, first=1)
            found = _ran(line, cls, lambda y: 0.5 + 0.0 * y, np.array([1.0, 0.5]), 0.25, 2)
        else:
            line = _run_of_positions(made, begun, now, before)
            found = _ran(line, cls, lambda *x: 0.0, 1.0, 0.5, 0.25, 2)[0]
        return line if [float(np.ravel(x)[0]) for x in found] == [1.0, 1.125, 1.25] else ""
    return ""


def _run_of_positions(made: Made, begun: Any, now: str, before: str) -> str:
    """The run of an object that keeps two positions; of one in space, all coordinates are the same.

    Raises IndexError if it has no place for a force.
    """
    kept, function, mass = vars(begun), function_argument(type(begun)), objects.mass_of(begun)
    vector = type(kept[now]).__name__ if hasattr(kept[now], "x") and hasattr(kept[now], "y") else ""
    first, whole = ("[0]", f"0 * made.{now} + ") if np.size(kept[now]) > 1 else (".x" * bool(vector), "")
    put: Callable[[str], str] = lambda x: f"{vector}({x}, 0.0)" if vector else f"{whole}{x}"
    force = f"lambda p, *rest: {put(f'force(p{first})')}"
    whole = whole or f"0 * made.{now} + " * isinstance(kept[now], np.ndarray)  # of one number, with a copy()
    start = {each: force if each == function else "0.0" for each in made.arguments}
    begin = made._replace(arguments=start, puts={now: put("q"), before: put(common.BEFORE)}).begin
    begin += f"; made.{mass} = 1.0" * bool(mass)
    pushed = ""
    if common.function_of(FORCE) not in made.call.values() and not function:
        ways = [f"made.{each}(" for each in _PUSHES if hasattr(type(begun), each)]
        ways += [f'setattr(made, "{each}", ' for each in kept if each.lower() in objects.PUSHED]
        pushed = f"{ways[0]}force(made.{now}{first})), "
    return common.run_of_positions(f"({pushed}{made.once}, 1.0 * made.{now}{first})[-1]", begin)


def _ran(line: str, cls: type, *given: Any) -> Any:
    """What a wrapper returns where it is pasted after the class."""
    exec(line, names := objects.scope_of(cls))
    return names["wrapped"](*given)


def _state_wrapper(cls: type, made: Any, advance: str) -> str:
    """The `stepper_of` line for an object whose attributes hold its state; "" if their names do not tell where."""
    q, v, state, time = (attribute_of(made, role) for role in (calling.POSITION, calling.VELOCITY, calling.STATE, TIME))
    moved, (q, v) = _moved_numbers(made, advance, (q, v))
    push, of_function = next((each for each in _PUSHES if hasattr(cls, each)), ""), function_argument(cls)
    arrays = [each for each in moved if np.ndim(getattr(made, each))]
    apart = not {q, v} <= {*moved} and not arrays
    alone = arrays in ([], moved[:1])
    if moved and not (of_function or push) and (apart or (alone and _is_driven(made, advance, time, moved))):
        return _numbers_wrapper(cls, made, advance, moved)
    if not (q and v) and (not state or common.takes_force([of_function])):
        return ""
    where, maker = f'position="{q}", velocity="{v}"' if q and v else f'state="{state}"', "stepper_of"
    if push and not required_names(cls):
        where += f", push={_pushing(made, q, push)}"
    if of_function and not (q and v):
        where, maker = f'{where}, time="{time}"' if time else where, "field_stepper_of"
    make = making(cls, FORCE if q and v else FIELD, made)
    others = [each for each in objects.names_taken(made, advance) if plain_role(each) != STEP]
    meant = f"  # {', '.join(others)} = 0.0, or what is meant" * bool(others)
    line = f"from driftproof import {maker}; wrapped = {maker}({make}, {where}, advance={_advancing(made, advance)})"
    return line + meant


def _pushing(made: Any, q: str, push: str) -> str:
    """The way in which `stepper_of` gives an object at q the force that its method `push` takes."""
    mass = objects.mass_of(made)
    force = f"body.{mass} * f" if mass else "f"
    if q.endswith(".x"):
        force = f"{type(getattr(made, q.partition('.')[0], 0.0)).__name__}({force}, 0.0)"
    return f'"{push}"' if force == "f" else f"lambda body, f: body.{push}({force})"


def _advancing(made: Any, advance: str) -> str:
    """The way in which `stepper_of` has an object make a step of h."""
    size, taken = attribute_of(made, STEP), [*_taken_by(made, advance, "h", "0.0").values()]
    call = f"made.{advance}({', '.join(taken)})"
    if size and "h" not in taken:
        return f"lambda made, h: (setattr(made, '{size}', h), {call})"
    return f"lambda made, h: {call}" if "0.0" in taken else f'"{advance}"'


def _is_driven(made: Any, advance: str, time: str, moved: Sequence[str]) -> bool:
    """True if the end of a step depends on the time that an object keeps."""
    ends = list[list[float]]()
    with suppress(Exception):  # of foreign code
        for t in (0.25, 0.75) if time else ():
            setattr(body := deepcopy(made), time, t)
            getattr(body, advance)(*_taken_by(made, advance, 0.25, 0.0).values())
            ends.append([x for each in moved for x in np.ravel(getattr(body, each)).tolist()])
    return len(ends) == 2 and ends[0] != ends[1]


def _numbers_wrapper(cls: type, made: Any, advance: str, moved: Sequence[str]) -> str:
    """The step of an object, made anew, whose system is built in, of the time and of the numbers that its step moves.

    Or of the one array that it moves.
    """
    start, call = _start_of(cls, calling.MAP, made), _taken_by(made, advance, "h", "0.0")
    puts = {attribute_of(made, STEP): "h"} if "h" not in call.values() else {}
    puts |= {attribute_of(made, TIME): "t"}
    found = Made(calling.STATE, cls, start, call, f".{advance}", puts={each: x for each, x in puts.items() if each})
    places = objects.made_places(moved)
    if np.ndim(getattr(made, moved[0])):
        return common.defined(found.kind, found.begin, f"{places} = 1.0 * y", found.once, f"return {places}")
    begin, end = f"import numpy; {found.begin}; [{places}] = 1.0 * y", f"return numpy.array([{places}])"
    return common.defined(found.kind, begin, found.once, end)


def _moved_numbers(made: Any, advance: str, named: tuple[str, str]) -> tuple[list[str], tuple[str, str]]:
    """The numbers and arrays of an object, but its time, that a short step moves; a position and its velocity.

    The position moves by its velocity, which moves itself; else they are those named so; else the one that moves by
    another number; else the only ones there are, though it moves them wrongly.
    """
    with suppress(Exception):
        moved = deepcopy(made)
        known = {each: x for each, x in attributes_of(moved).items() if isinstance(x, float | np.ndarray)}
        for i, (each, x) in enumerate(known.items()):
            setattr(moved, each, _SHORT if plain_role(each) == STEP else x * 0.0 + 1 / (i + 2))
        before = {each: copy(getattr(moved, each)) for each in known}
        getattr(moved, advance)(*_taken_by(made, advance, _SHORT, 0.0).values())
        rates = {each: (getattr(moved, each) - x) / _SHORT for each, x in before.items() if plain_role(each) != TIME}
        rates = {each: rate for each, rate in rates.items() if np.any(rate)}
        others = product(rates.items(), before.items())
        pairs = [(x, y) for (x, rate), (y, v) in others if x != y and np.shape(rate) == np.shape(v)]
        near = [(x, y) for x, y in pairs if np.allclose(rates[x], before[y], _NEAR, 0)]
        both = [pair for pair in near if pair[1] in rates]
        found = [*[named] * (named in both), *both, *[named] * all(named), *near, *pairs * (len(pairs) == 1), named]
        return [*rates], found[0]
    return [], named


def _taken_by(made: Any, advance: str, size: Any, other: Any) -> dict[str, Any]:
    """What a method is given by name besides its object: a step size, and `other` things."""
    cls = made if inspect.isclass(made) else type(made)
    return {each: size if plain_role(each) == STEP else other for each in objects.names_taken(cls, advance)}


def further_names(cls: type, advance: str) -> list[str]:
    """What a method of a class needs besides its object and the step size."""
    return [each for each in (required_names(getattr(cls, advance, int)) or [])[1:] if plain_role(each) != STEP]


def advance_of(cls: type) -> str:
    """The name of the method that makes a step: a usual one, or the only public one that takes one argument or none."""
    alone = [each for each in objects.public_methods(cls) if len(required_names(getattr(cls, each)) or ()) in (1, 2)]
    alone = [each for each in alone if any(word in each for word in ADVANCES)] or alone
    return next((each for each in ADVANCES if hasattr(cls, each)), alone[0] if len(alone) == 1 else "")


def kept_wrapper(kept: Sequence[str], advance: Any) -> str:
    """What to write in a call of `stepper_of` to set what an object keeps from its last step, with words to replace."""
    puts = ", ".join(f"setattr(made, '{name}', {name.upper()}_AT_ITS_STATE)" for name in kept)
    if not isinstance(advance, str):
        return f"; if its advance sets {', '.join(kept)} already, the step itself makes something else of what it kept"
    return f"; write advance=lambda made, h: ({puts}, made.{advance}(h)) in the call of stepper_of"
