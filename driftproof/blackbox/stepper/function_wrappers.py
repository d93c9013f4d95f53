"""Wrappers of functions, ready to paste: steps with other arguments, of gradients, or of a list of the last states."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from copy import copy
from functools import partial, reduce
from itertools import chain, combinations, product
from operator import getitem
from typing import Any

import numpy as np

from driftproof.blackbox.stepper.calling_conventions import (
    BODY_LISTS,
    CARRIED,
    COUNTS,
    FIELD,
    FORCE,
    FUNCTION,
    MAP,
    MASSES,
    MOMENTA,
    POSITION,
    ROLES,
    RUN_ENDS,
    SPANS,
    STARTS,
    STATE,
    STEP,
    TIME,
    UNIT_PARAMETERS,
    VELOCITY,
    has_gradient,
    launch,
    matrices,
    names_with_step,
    parameters_of,
    required_names,
    role_of,
    size_name,
    stand_in,
    word_of,
)

# Of a step without a right-hand side, so many arguments that are not known are those of a built-in system.
_MOST_OPEN = 2
# The arguments of a wrapper by role, and all of them for a wrapper of each kind.
ARGUMENTS = {FUNCTION: "f", TIME: "t", STATE: "y", POSITION: "q", VELOCITY: "v", STEP: "h"}
HEADS = {MAP: "q, v, h", FORCE: "force, q, v, h", FIELD: "f, t, y, h"}
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
_BEFORE = re.compile("prev|old|last|before|nm1")
# The statements that stand before the one with a call.
_BEFOREHAND = re.compile(r"^(def wrapped\(.*?\): )(.*?)‹(.*?)›")
# This many steps are more than the start of any multistep method in use; and how near to each other two runs are.
_RUN, _SAME = 12, 2.0**-40
# Names of a list of the last states; a method in use looks back at no more than this many.
_LISTS, _MOST_STATES = re.compile("^ys$|^us$|^xs$|states|hist|past|prev"), 7
_SPANS = (*SPANS, "t_bound", "t_end", "tf", "t_final")
# The values of a wrapper's arguments with which a step is tried, in a field in which nothing moves by itself.
TRIAL_ARGUMENTS: dict[str, Any] = {
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
    return stated_first(_function_wrapper(step))


def stated_first(line: str) -> str:
    """The wrapper with the statements that a call needs before the one with the call."""
    return _BEFOREHAND.sub(r"\1\3; \2", line)


def _function_wrapper(step: Callable[..., Any]) -> str:
    if (names := names_with_step(step)) is None:
        return ""
    if _named(names, _SPANS) and not _named(names, COUNTS) and not any(role_of(each, (STEP,)) for each in names):
        return f"identify_solver({name_of(step)}), on the command line --solver, for a whole solver"
    if gradients := gradients_of(names):
        rest = [each for each in names if each not in gradients]
        return _call(step, names, {**gradients, **arguments_by_role(rest, FORCE)}, FORCE)
    if line := _two_forces_wrapper(step, names):
        return line
    roles = {plain_role(each): word_of(each) for each in names if each not in matrices(names)}
    forced = takes_force(names) or has_gradient(names) or roles.get(FUNCTION) == "a"
    of_state = POSITION not in roles or (VELOCITY not in roles and (TIME in roles or not forced))
    kind = MAP if FUNCTION not in roles else FIELD if of_state else FORCE
    given = arguments_by_role(names, kind)
    line = list_wrapper(step) or run_wrapper(step, names) or _pair_wrapper(step, names)
    if kind == MAP and not line and (called := with_global(step)):
        line = _function_wrapper(called)
        return line if line and "write values" not in line else ""
    states = [*given.values()]
    told = given and (kind != MAP or (len(names) - len(given) < _MOST_OPEN and states.count("[q, v]") < 2))
    return line or (_call(step, names, given, kind) if told else "")


def gradients_of(names: Sequence[str]) -> dict[str, str]:
    """The gradients by the positions and by the momenta among the names, each as it is given; nothing without both."""
    found = (
        next((each for each in names if has_gradient([each])), _named(names, _BY_POSITION)),
        _named(names, _BY_MOMENTUM),
    )
    texts = "lambda q, *p: -force(q)", "lambda *p: p[-1]"
    return {} if None in found else {str(each): text for each, text in zip(found, texts, strict=True)}


def called_functions(step: Callable[..., Any], names: Sequence[str]) -> list[str]:
    """The arguments that a step calls, though no name says so, that which it calls least last; nothing if none is seen.

    >>> called_functions(lambda u, N, L, dt: u + dt * (N(u) + L(u)), ["u", "N", "L", "dt"])
    ['N', 'L']
    """
    given = {**arguments_by_role(names, FIELD), **arguments_by_role(names, FORCE)}
    told = (STEP, TIME, POSITION, VELOCITY, STATE)
    if "h" not in given.values() or any(role_of(each, (FUNCTION,)) for each in names):
        return []
    others = [each for each in names if not role_of(each, told)]
    for chosen in chain.from_iterable(combinations(others, size) for size in (1, 2)):
        calls: dict[str, int] = dict.fromkeys(chosen, 0)

        def asks(name: str, *x: Any, calls: dict[str, int] = calls) -> Any:
            calls[name] += 1
            return 0.0 * max(x, key=np.size)

        with suppress(Exception):
            values = {each: TRIAL_ARGUMENTS.get(given.get(each, ""), 1.0) for each in names}
            step(**values | {each: partial(asks, each) for each in chosen})
            if all(calls.values()):
                return sorted(chosen, key=lambda name: -calls[name])
    return []


def _two_forces_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a step of two forces, of which it is given the one that it calls least, and 0 for the other."""
    roles, pair = {*map(plain_role, names)}, called_functions(step, names)
    if not {POSITION, VELOCITY} <= roles or len(pair) != 2:
        return ""
    given = arguments_by_role([each for each in names if each not in pair], FORCE)
    others = {x.name: x.default for x in (parameters_of(step) or {}).values()}
    counts = [each for each, x in others.items() if type(x) is int and x > 1]  # of inner steps, whose sums round more
    given, names = {**given, **dict.fromkeys(counts, "1")}, [*names, *counts]
    return _call(step, names, {**given, pair[0]: "lambda q, *rest: 0.0 * q", pair[1]: "force"}, FORCE)


def plain_role(name: str) -> str | None:
    """The role of an argument by its name."""
    return role_of(name, (FUNCTION, STEP, TIME, POSITION, VELOCITY, STATE))


def kind_by_names(names: Iterable[str]) -> str:
    """The kind of a step with these arguments: with a function, FORCE for a position and a velocity, else FIELD."""
    names = [*names]
    roles = {plain_role(each) for each in names if each not in matrices(names)}
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
                call = call_by_names(step, names, later_arguments(given, ys="ys[::-1]" if turned < 0 else "ys"))
                later = f"s(t + i * h, ys[-1]) if i < {size - 1} else {call}"
                line = run_of_steps(HEADS[FIELD], "y", later, f"s = lambda t, y: {FIRST_STEP}; ")
                return f"{line}  # begins with midpoint2"
    return ""


def run_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a run to a given end, in steps or in a number of them, or over a row of times, by its last state.

    It is "" unless the run is seen to begin at the start, or to stay there where nothing moves. If a run of several
    steps is not one step after the other, the wrapper takes their number: a multistep method has other steps at first.
    """
    kind = kind_by_names(names)
    begins = {each[:-1].strip("_") for each in names if each.endswith("0")}  # of x0 and x, the latter is the end
    end = next((each for each in names if word_of(each) in RUN_ENDS[1] or each == "T" or each in begins), "")
    given = arguments_by_role([each for each in names if each != end], kind)
    left, timed = [each for each in names if given.get(each, "0.0") == "0.0"], "t" in given.values()
    counted = [each for each in left if word_of(each) in COUNTS]
    if end:
        given[end] = "t + h" if timed else "h"
    elif left and left == counted and kind != FIELD:
        given[left[0]] = "1"
    elif len(left) == 1 and "h" not in given.values():
        timed = kind == FIELD
        given[left[0]] = "[t, t + h]" if timed else "[0.0, h]"
    else:
        return ""
    if len(given) < len(names):
        return ""
    head = HEADS[kind] if timed or kind != FIELD else "f, y, h"
    whole = {"1": "n", "t + h": "t + n * h", "h": "n * h", "[t, t + h]": "[t, t + n * h]"}
    counts = (1, _RUN) if kind == FIELD and "1" in given.values() else (1,)  # some cannot end before their start does
    if rows := {"[t, t + h]"} == {"[t, t + h]", "1"}.intersection(given.values()):
        whole["[t, t + h]"] = "[t + i * h for i in range(n + 1)]"
    for many, count in product((False, True), counts):
        with suppress(Exception):
            values = {key: np.array([x]) if many and key in ("q", "v") else x for key, x in TRIAL_ARGUMENTS.items()}
            values["1"], asked = count, list[Any]()
            values["f"] = lambda *x, seen=asked: seen.append(x) or 0.0 * max(x, key=np.size)
            found, of_all = step(*[copy(values[given[each]]) for each in names]), "{}"
            if inspect.isgenerator(found):
                found, of_all = [*found][-1], "[*{}][-1]"
            states = ("q", "v") if {"q", "v"} <= {*given.values()} else ("y",) if kind == FIELD else ("[q, v]",)
            places = [_end_of(found, values[each]) for each in states]
            if -1 not in places[0] and any(text.startswith("[0.0") or text == "[t, t + h]" for text in given.values()):
                return ""  # what is not known to be a row of times need not be one
            written = {
                each: _shifted(text, asked[0]) if text == "f" and not timed else text for each, text in given.items()
            }
            head = HEADS[kind] if written != given else head
            run = of_all.format(call_by_names(step, names, written))
            first, *last = ("".join(f"[{i!r}]" for i in place) for place in places)
            if last:
                return f"def wrapped({head}): run = {run}; return run{first}, run{last[0]}"
            if (rows or counts[1:]) and (count > 1 or _remembers(step, names, given, places[0])):
                run = call_by_names(step, names, {each: whole.get(text, text) for each, text in given.items()})
                return f"def wrapped({head}, n): return {run}{first.removesuffix('[-1]')}"
            return f"def wrapped({head}): return {run}{first}"
    return ""


def _shifted(function: str, asked: Sequence[Any]) -> str:
    """The function of a run that begins at its own time 0, as it calls it: later by t, if it gives a time."""
    taken = {"12": "s, y", "21": "y, s"}.get("".join(str(np.size(x)) for x in asked))
    return f"lambda {taken}: {function}(t + s, y)" if taken else function


def _end_of(answer: Any, start: Any) -> list[Any]:
    """The indices, or keys, of the state at the end in an answer. Raises ValueError if it is not seen.

    It is a part that is the start, or the last row of one whose first row is that, or a part of such a row.
    """
    if isinstance(answer, list) and isinstance(answer[0], tuple):
        return [-1, *_end_of(answer[0], start)]
    parts = [*enumerate(answer)] if isinstance(answer, tuple) else [*answer.items()] if isinstance(answer, dict) else []
    for place, part in ([], answer), *(([i], each) for i, each in parts):
        with suppress(Exception):
            found = np.asarray(part, float)
            if found.ndim > np.ndim(start) and np.array_equal(found[0], start):
                return [*place, -1]
            if np.array_equal(found, start):
                return [*place]
    raise ValueError("no state is seen")


def _remembers(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str], where: Sequence[int]) -> bool:
    """True if a run of some steps ends elsewhere than as many runs of one step."""

    def end(t: float, y: Any, n: int) -> Any:
        known = {**TRIAL_ARGUMENTS, "f": lambda *x: -max(x, key=np.size), "t": t, "y": y, "1": n, "t + h": t + n / 4}
        span = [0, n] if "1" in given.values() else range(n + 1)
        known |= {"h": n / 4, "[t, t + h]": np.array([t + i / 4 for i in span])}
        return np.asarray(reduce(getitem, where, step(*[known[given[each]] for each in names])), float)

    start = TRIAL_ARGUMENTS["y"]
    by_one: Any = reduce(lambda y, i: end(i / 4, y, 1), range(_RUN), start)
    return not np.allclose(by_one, end(0.0, start, _RUN), rtol=_SAME, atol=0)


def with_global(step: Callable[..., Any]) -> Callable[..., Any] | None:
    """The step with the function of its module that moves its system as its first argument; None if there is none.

    It is the only one that the step, or what it calls in that module, calls by the name of a right-hand side.
    """
    known, called = getattr(step, "__globals__", {}), [step]
    for function in called:  # which grows
        names = getattr(getattr(function, "__code__", None), "co_names", ())
        called += [x for name in names if inspect.isfunction(x := known.get(name)) and x not in called]
    moving = {x.__name__: x for x in called[1:] if role_of(x.__name__, (FUNCTION,))}
    moving = {name: x for name, x in moving.items() if known.get(name) is x}
    if len(moving) != 1 or (names := names_with_step(step)) is None:
        return None
    ((name, function),) = moving.items()
    plain = all(role_of(each, (POSITION, VELOCITY, TIME, STATE)) for each in required_names(function) or ())

    def replaced(given: Any, *arguments: Any) -> Any:
        known[name] = given
        try:
            return step(*arguments)
        finally:
            known[name] = function

    def written(given: str, *arguments: str) -> str:
        given = given if plain or given == "f" else f"lambda q, *rest: {given}(q)"
        return f'‹{name_of(step)}.__globals__["{name}"] = {given}›{name_of(step)}({", ".join(arguments)})'

    stand_in(replaced, step, [name, *names])
    replaced.written = written  # type: ignore[attr-defined]
    return replaced


def _pair_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a step of x' = f, v' = g with both functions as arguments; "" if it calls no two with x and v.

    Both are handed to it as parts of one right-hand side, so that all that each of them is asked shows.
    """
    functions = [each for each in names if role_of(each, (FUNCTION,)) or each in ("g", "G", "func2", "f2")]
    known = {time: "t" for time in names if role_of(time, (TIME,))} | {size_name(names): "h"}
    states = [each for each in names if each not in (*functions, *known)]
    if len(functions) != 2 or len(states) != 2:
        return ""
    asked: list[tuple[Any, ...]] = []

    def asks(*x: Any) -> float:
        asked.append(x)
        return 0.0

    trial = {"t": 0.0, "h": 0.25, "y[0]": 1.0, "y[1]": 0.5}
    given: dict[Any, str] = {**known, **dict(zip(states, ("y[0]", "y[1]"), strict=True))}
    with suppress(Exception):
        step(*[asks if each in functions else trial[given[each]] for each in names])
        first, second, *_ = (
            {text: x.index(trial[text]) for text in ("y[0]", "y[1]", "t") if trial[text] in x} for x in asked
        )
        if first == second and {"y[0]", "y[1]"} <= first.keys():
            time, x, v = (f"x[{first[each]}]" if each in first else each for each in ("t", "y[0]", "y[1]"))
            parts = [f"lambda *x: f({time}, numpy.array([{x}, {v}]))[{i}]" for i in (0, 1)]
            call = call_by_names(step, names, {**given, **dict(zip(functions, parts, strict=True))})
            return f"def wrapped({HEADS[FIELD]}): import numpy; return numpy.array({call})"
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
    head = HEADS[kind] if kind != FIELD or getattr(step, "timed", True) else "f, y, h"
    if kind == MAP and "[q, v]" in given.values():
        try:
            step(**{each: TRIAL_ARGUMENTS.get(given.get(each, ""), 0.0) for each in names})
        except ValueError:  # of a state of more numbers
            head, given = "y, h", {each: "y" if text == "[q, v]" else text for each, text in given.items()}
        except Exception:  # which a pasted wrapper will tell
            pass
    call = call_by_names(step, names, {each: each.upper() for each in left} | {**given})
    return f"def wrapped({head}): return {call}{said}"


def _two_step_call(step: Callable[..., Any], names: Sequence[str], given: Mapping[Any, str], kind: str) -> str:
    """The run of a function whose one argument not given is the state before; "" if it cannot be written."""
    given = dict.fromkeys(names, "ys[-2]") | {**given}
    if kind == FIELD and {"y", "h"} <= {*given.values()}:
        later = call_by_names(step, names, later_arguments(given))
        line = run_of_steps(HEADS[kind], f"y, {FIRST_STEP}", later, first=1)
        return f"{line}  # a run of n steps, whose first is one of midpoint2"
    if kind == FORCE and {*given.values()} == {"force", "q", "h", "ys[-2]"}:
        with suppress(Exception):
            pair = isinstance(step(**{each: TRIAL_ARGUMENTS[given[each]] for each in names}), tuple)
            later = call_by_names(step, names, later_arguments(given, q="ys[-1]")) + "[0]" * pair
            return run_of_steps(HEADS[kind], f"{BEFORE}, q", later, found=WITH_SPEEDS.format("ys[1:]", "ys[2:]"))
    states = [each for each in names if given[each] not in ("force", "h")]
    if kind == FORCE and [given[each] for each in states] == ["q", "v", "force(q)", "ys[-2]"]:
        with suppress(Exception):  # of the slope before, if it returns its state and both slopes in their order
            trial = {**TRIAL_ARGUMENTS, "force(q)": 2.0, "ys[-2]": 3.0}
            if [*step(**{each: trial[given[each]] for each in names})][3:] == [2.0]:
                later = call_by_names(step, names, given | {each: f"ys[-1][{i}]" for i, each in enumerate(states)})
                start, found = f"(q, v, force(q), force({BEFORE}))", "[y[0] for y in ys], [y[1] for y in ys]"
                return run_of_steps(HEADS[kind], start, later, found=found)
    return _with_a_force(step, names) if kind == MAP else ""


def _with_a_force(step: Callable[..., Any], names: Sequence[str]) -> str:
    head = f"def {name_of(step)}(force, {', '.join(names)}): ..."
    return f"{head}  # a method of two steps is read if its force is an argument"


def positions_wrapper(step: Callable[..., Any]) -> str:
    """The run of a method that returns positions alone, with their differences as velocities."""
    names = names_with_step(step) or []
    if (kind := kind_by_names(names)) != FORCE:
        return _with_a_force(step, names)
    given = arguments_by_role(names, kind) | {each: "n" for each in names if word_of(each) in COUNTS}
    run = call_by_names(step, names, given)
    return f"def wrapped({HEADS[kind]}, n): xs = {run}; return {WITH_SPEEDS.format('xs', 'xs[1:]')}"


def run_of_steps(head: str, states: str, later: str, begin: str = "", first: int = 0, found: str = "ys") -> str:
    """The wrapper of a run: the `states` before step number `first`, then `later`, which is a text in terms of ys."""
    steps = f"[ys.append({later}) for i in range({f'{first}, ' if first else ''}n)]"
    return f"def wrapped({head}, n): {begin}ys = [{states}]; {steps}; return {found}"


def later_arguments(given: Mapping[str, str], **of_last: str) -> dict[str, str]:
    """What step i of a run is given in place of the start."""
    of_last = {"t": "t + i * h", "y": "ys[-1]", "[q, v]": "ys[-1]"} | of_last
    return {each: of_last.get(text, text) for each, text in given.items()}


def call_by_names(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str]) -> str:
    """The call with what is given for each name, by place if that is the names' own order.

    What stands for a call of several statements is `written` by itself, those before the call between ‹ and ›.
    """
    if hasattr(step, "written"):
        return str(step.written(*(given[each] for each in names)))
    by_place = [*(parameters_of(step) or ())][: len(names)] == [*names]  # a step size with a default may not be
    passed = [f"{'' if by_place else f'{each}='}{given[each]}" for each in names]
    plain = ".py_func" if hasattr(step, "py_func") and not {"f", "force"}.isdisjoint(given.values()) else ""
    return f"{name_of(step)}{plain}({', '.join(passed)})"  # compiled code calls no function of Python


def arguments_by_role(names: Sequence[str], kind: str) -> dict[str, str]:
    """The wrapper's argument for each name whose role is known; a single state of a map is [q, v]."""
    given: dict[str, str] = {}
    if kind == FIELD and (pair := [each for each in names if word_of(each) in ("x", "x0", "y", "y0")])[1:]:
        given = dict(zip(pair, "ty", strict=False))  # of f(x, y) the first is the time
    sized, no_roles = size_name(names), (*matrices(names), *launch(names))
    carried = ROLES[CARRIED]  # of a and force, the latter is the function
    asked = (each for each in names if role_of(each, (FUNCTION,)))
    slopes = sorted(asked, key=lambda x: carried.index(word_of(x)) if word_of(x) in carried else len(carried))[:-1]
    no_roles += tuple(each for each in slopes if role_of(each, (CARRIED,)))
    for each in (name for name in names if name not in (*given, *no_roles)):
        wanted = (FUNCTION, STEP, TIME, *((STATE,) if kind == FIELD else (POSITION, VELOCITY, STATE)))
        roles = [x for x in wanted if ARGUMENTS[x] not in given.values() and (x != STEP or each == sized)]
        if kind != FIELD and "q" in given.values() and STATE in roles:
            roles.remove(STATE)
        if kind == FORCE and FUNCTION in roles and any("force" in text for text in given.values()):
            roles.remove(FUNCTION)
        role = role_of(each, roles) or (role_of(each.rstrip("_0"), roles) if kind != FIELD else None)
        if role is not None:
            function = "lambda x: -force(x)" if kind == FORCE and has_gradient([each]) else function_of(kind)
            given[each] = function if role == FUNCTION else ARGUMENTS[role]
    open_names = [each for each in names if each not in given]
    if kind == FIELD:
        ambiguous = ("a", "b", "alpha") if "h" in given.values() else ()  # are the ends and the start of a run
        for text, words in (("y", STARTS), ("t", RUN_ENDS[0]), ("t + h", RUN_ENDS[1]), ("1", COUNTS)):
            known = {*words} - {*ambiguous} if text != "1" or "h" not in given.values() else set()
            if text not in given.values():
                given |= {each: text for each in open_names if each not in given and word_of(each) in known}
    given |= {each: "()" for each in open_names if word_of(each) in _PARAMETERS}
    if kind == FORCE and any("force" in text for text in given.values()):
        given |= {each: "force(q)" for each in open_names if role_of(each, (CARRIED,))}
    if kind != FIELD:
        given |= {each: "1.0" for each in open_names if word_of(each) in (UNIT_PARAMETERS if kind == MAP else MASSES)}
    if kind == MAP and not {"q", "v"} <= {*given.values()}:
        speeds = [each for each in given if given[each] == "v" and word_of(each) not in MOMENTA]  # are no state
        given = {each: "[q, v]" if x in ("q", "v", "y") else x for each, x in given.items() if each not in speeds}
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
