"""Wrappers of functions, ready to paste: steps with other arguments, runs to an end, and steps from earlier states."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from copy import copy
from functools import partial, reduce
from itertools import combinations, product
from operator import getitem
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper import wrapper_parts as common
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, MAP, STATE, role_of, word_of
from driftproof.blackbox.stepper.wrapper_parts import TRIAL_ARGUMENTS, arguments_by_role, call_by_names, defined

# Of a step without a right-hand side, so many arguments that are not known are those of a built-in system.
_MOST_OPEN = 2
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
_SPANS = (*calling.SPANS, "t_bound", "t_end", "tf", "t_final")
# This many steps are more than the start of any multistep method in use; and how near to each other two runs are.
_RUN, _SAME = 12, 2.0**-40
# Names of a list of the last states; a method in use looks back at no more than this many.
_LISTS, _MOST_STATES = re.compile("^ys$|^us$|^xs$|states|hist|past|prev"), 7


def function_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function: a step with gradients of an energy, a run, a solver, or a plain step."""
    if (names := calling.names_with_step(step)) is None:
        return ""
    if _named(names, _SPANS) and not _named(names, calling.COUNTS) and not calling.size_name(names):
        return common.whole_solver(step)
    if gradients := gradients_of(names):
        rest = [each for each in names if each not in gradients]
        return _call(step, names, {**gradients, **arguments_by_role(rest, FORCE)}, FORCE)
    if line := _two_forces_wrapper(step, names):
        return line
    kind = common.kind_by_names(names)
    given = arguments_by_role(names, kind)
    line = list_wrapper(step) or run_wrapper(step, names) or _pair_wrapper(step, names)
    if kind == MAP and not line and (called := with_global(step)):
        line = function_wrapper(called)
        return line if "write values" not in line else ""
    states = [*given.values()]
    told = given and (kind != MAP or (len(names) - len(given) < _MOST_OPEN and states.count("[q, v]") < 2))
    return line or (_call(step, names, given, kind) if told else "")


def gradients_of(names: Sequence[str]) -> dict[str, str]:
    """The gradients by the positions and by the momenta among the names, each as it is given; nothing without both."""
    by_position = next((each for each in names if calling.has_gradient([each])), _named(names, _BY_POSITION))
    by_momentum = _named(names, _BY_MOMENTUM)
    if not by_position or not by_momentum:
        return {}
    return {by_position: "lambda q, *p: -force(q)", by_momentum: "lambda *p: p[-1]"}


def called_functions(step: Callable[..., Any], names: Sequence[str]) -> list[str]:
    """The two arguments that a step calls, though no name says so, that which it calls least last; nothing without two.

    >>> called_functions(lambda u, N, L, dt: u + dt * (N(u) + L(u)), ["u", "N", "L", "dt"])
    ['N', 'L']
    """
    given = {**arguments_by_role(names, FIELD), **arguments_by_role(names, FORCE)}
    if "h" not in given.values() or any(role_of(each, (calling.FUNCTION,)) for each in names):
        return []
    others = [each for each in names if not common.plain_role(each)]
    for chosen in combinations(others, 2):
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
    roles, pair = {*map(common.plain_role, names)}, called_functions(step, names)
    if not {calling.POSITION, calling.VELOCITY} <= roles or not pair:
        return ""
    given = arguments_by_role([each for each in names if each not in pair], FORCE)
    others = {x.name: x.default for x in (calling.parameters_of(step) or {}).values()}
    counts = [each for each, x in others.items() if type(x) is int and x > 1]  # of inner steps, whose sums round more
    given, names = {**given, **dict.fromkeys(counts, "1")}, [*names, *counts]
    return _call(step, names, {**given, pair[0]: "lambda q, *rest: 0.0 * q", pair[1]: "force"}, FORCE)


def _named(names: Sequence[str], known: Sequence[str]) -> str:
    """The first of the names that is a known one; "" if none is."""
    return next((each for each in names if word_of(each) in known), "")


def with_global(step: Callable[..., Any]) -> Callable[..., Any] | None:
    """The step with the function of its module that moves its system as its first argument; None if there is none.

    It is the only one that the step, or what it calls in that module, calls by the name of a right-hand side.
    """
    known, called = getattr(step, "__globals__", {}), [step]
    for function in called:  # which grows
        names = getattr(getattr(function, "__code__", None), "co_names", ())
        called += [x for name in names if inspect.isfunction(x := known.get(name)) and x not in called]
    moving = {x.__name__: x for x in called[1:] if role_of(x.__name__, (calling.FUNCTION,))}
    moving = {name: x for name, x in moving.items() if known.get(name) is x}
    if len(moving) != 1 or (names := calling.names_with_step(step)) is None:
        return None
    ((name, function),) = moving.items()
    told = (calling.POSITION, calling.VELOCITY, calling.TIME, STATE)
    plain = all(role_of(each, told) for each in calling.required_names(function) or ())

    def replaced(given: Any, *arguments: Any) -> Any:
        known[name] = given
        try:
            return step(*arguments)
        finally:
            known[name] = function

    def written(given: str, *arguments: str) -> str:
        given = given if plain or given == "f" else f"lambda q, *rest: {given}(q)"
        return f'‹{common.name_of(step)}.__globals__["{name}"] = {given}›{common.name_of(step)}({", ".join(arguments)})'

    calling.stand_in(replaced, step, [name, *names])
    replaced.written = written  # type: ignore[attr-defined]
    return replaced


def _pair_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a step of x' = f, v' = g with both functions as arguments; "" if it calls no two with x and v.

    Both are handed to it as parts of one right-hand side, so that all that each of them is asked shows.
    """
    functions = [each for each in names if role_of(each, (calling.FUNCTION,)) or each in ("g", "G", "func2", "f2")]
    given = {time: "t" for time in names if role_of(time, (calling.TIME,))} | {calling.size_name(names): "h"}
    states = [each for each in names if each not in (*functions, *given)]
    if len(functions) != 2 or len(states) != 2:
        return ""
    given |= dict(zip(states, ("y[0]", "y[1]"), strict=True))
    trial, asked = {"t": 0.0, "h": 0.25, "y[0]": 1.0, "y[1]": 0.5}, list[tuple[Any, ...]]()
    asks = lambda *x: asked.append(x) or 0.0  # type: ignore[func-returns-value]
    with suppress(Exception):
        step(*[asks if each in functions else trial[given[each]] for each in names])
        first, second, *_ = ({text: x.index(trial[text]) for text in trial if trial[text] in x} for x in asked)
        if first == second and {"y[0]", "y[1]"} <= first.keys():
            time, x, v = (f"x[{first[each]}]" if each in first else each for each in ("t", "y[0]", "y[1]"))
            parts = [f"lambda *x: f({time}, numpy.array([{x}, {v}]))[{i}]" for i in (0, 1)]
            call = call_by_names(step, names, {**given, **dict(zip(functions, parts, strict=True))})
            return defined(FIELD, "import numpy", f"return numpy.array({call})")
    return ""


def _call(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str], kind: str) -> str:
    """The wrapper that calls a function of these names with the arguments given; those left are in capitals."""
    left = [each for each in names if each not in given]
    time = ", t for the time" * (kind == FIELD and len(left) == 1 and {"t", "t + h"}.isdisjoint(given.values()))
    said = f"  # write values for {', '.join(map(str.upper, left))}{time}" if left else ""
    if len(left) == 1 and common.is_before(left[0]):
        if line := _two_step_run(step, names, given, kind):
            return line
        said = f"  # a method of two steps: let an object keep its {left[0].upper()}, step(f, t, y, h) being its method"
    if kind == MAP and "h" not in given.values():
        said = "  # its h is built in: let it be an argument, or make the step anew for every h"
    if kind == MAP and any(word_of(each) in calling.BODY_LISTS for each in left):
        said = "  # what moves its bodies is built in: let their force be an argument, which can then be given"
    if kind == MAP and "[q, v]" in given.values():
        try:
            step(**{each: TRIAL_ARGUMENTS.get(given.get(each, ""), 0.0) for each in names})
        except ValueError:  # of a state of more numbers
            kind, given = STATE, {each: "y" if text == "[q, v]" else text for each, text in given.items()}
        except Exception:  # which a pasted wrapper will tell
            pass
    call = call_by_names(step, names, {each: each.upper() for each in left} | {**given})
    return defined(kind, f"return {call}{said}")


def run_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a run to a given end, in steps or in a number of them, or over a row of times, by its last state.

    It is "" unless the run is seen to begin at the start, or to stay there where nothing moves. If a run of several
    steps is not one step after the other, the wrapper takes their number: a multistep method has other steps at first.
    """
    kind = common.kind_by_names(names)
    given = _arguments_of_a_run(names, kind)
    texts = {*given.values()}
    if len(given) < len(names):
        return ""
    # Some cannot end before their start does.
    counts = (1, _RUN) if kind == FIELD and "1" in texts else (1,)
    whole = {"1": "n", "t + h": "t + n * h", "h": "n * h", "[t, t + h]": "[t, t + n * h]"}
    if rows := {"[t, t + h]"} == {"[t, t + h]", "1"} & texts:
        whole["[t, t + h]"] = "[t + i * h for i in range(n + 1)]"
    states = ("q", "v") if {"q", "v"} <= texts else ("y",) if kind == FIELD else ("[q, v]",)
    for many, count in product((False, True), counts):
        with suppress(Exception):
            values = {key: np.array([x]) if many and key in ("q", "v") else x for key, x in TRIAL_ARGUMENTS.items()}
            values["1"], asked = count, list[Any]()
            values["f"] = lambda *x, seen=asked: seen.append(x) or 0.0 * max(x, key=np.size)
            found, of_all = step(*[copy(values[given[each]]) for each in names]), "{}"
            if inspect.isgenerator(found):
                found, of_all = [*found][-1], "[*{}][-1]"
            places = [_end_of(found, values[each]) for each in states]
            if -1 not in places[0] and {"[0.0, h]", "[t, t + h]"} & texts:
                return ""  # what is not known to be a row of times need not be one
            shift = texts.isdisjoint(("t", "t + h", "[t, t + h]"))
            written = {x: _shifted(text, asked[0]) if shift and text == "f" else text for x, text in given.items()}
            run = of_all.format(call_by_names(step, names, written))
            first, *last = ("".join(f"[{i!r}]" for i in place) for place in places)
            if last:
                return defined(kind, f"run = {run}", f"return run{first}, run{last[0]}")
            if (rows or counts[1:]) and (count > 1 or _remembers(step, names, given, places[0])):
                run = call_by_names(step, names, {each: whole.get(text, text) for each, text in written.items()})
                return defined(kind, f"return {run}{first.removesuffix('[-1]')}", run=True)
            return defined(kind, f"return {run}{first}")
    return ""


def _arguments_of_a_run(names: Sequence[str], kind: str) -> dict[str, str]:
    """What a run to an end is given for each name, in which it makes one step; some are lacking if it is no run."""
    begins = {each[:-1].strip("_") for each in names if each.endswith("0")}  # of x0 and x, the latter is the end
    ends = (each for each in names if word_of(each) in calling.RUN_ENDS[1] or each == "T" or each in begins)
    end = next(ends, "")
    given = arguments_by_role([each for each in names if each != end], kind)
    left = [each for each in names if given.get(each, "0.0") == "0.0"]
    if end:
        return given | {end: "t + h" if "t" in given.values() else "h"}
    if left and kind != FIELD and all(word_of(each) in calling.COUNTS for each in left):
        return given | {left[0]: "1"}
    if len(left) == 1 and "h" not in given.values():
        return given | {left[0]: "[t, t + h]" if kind == FIELD else "[0.0, h]"}
    return {}


def list_wrapper(step: Callable[..., Any]) -> str:
    """The run of n steps of a method that takes a list of the last states; "" if no list of up to seven is taken.

    Of y' = 1 every method finds the next state, t + h, if the list is in its own order.
    """
    names = [] if inspect.isclass(step) else calling.required_names(step) or []
    past = next((each for each in names if _LISTS.search(each.lower())), "")
    given = {past: "ys"} | arguments_by_role([each for each in names if each != past], FIELD)
    if len(given) < len(names) or not {"f", "ys", "h"} <= {*given.values()} <= {"f", "t", "ys", "h"}:
        return ""
    for size, turned in product(range(2, _MOST_STATES + 1), (1, -1)):
        with suppress(Exception):
            ys = [np.array([i / 4, i / 4]) for i in range(1 - size, 1)][::turned]
            values = {"f": lambda *x: np.ones(2), "t": 0.0, "ys": ys, "h": 0.25}
            if np.allclose(step(*[values[given[each]] for each in names]), 0.25, rtol=0, atol=2.0**-20):
                call = call_by_names(step, names, common.later_arguments(given, ys="ys[::-1]" if turned < 0 else "ys"))
                later = f"s(t + i * h, ys[-1]) if i < {size - 1} else {call}"
                line = common.run_of_steps(FIELD, "y", later, f"s = lambda t, y: {common.FIRST_STEP}")
                return f"{line}  # begins with midpoint2"
    return ""


def positions_wrapper(step: Callable[..., Any]) -> str:
    """The run of a method that returns positions alone, with their differences as velocities."""
    names = calling.names_with_step(step) or []
    if (kind := common.kind_by_names(names)) != FORCE:
        return _with_a_force(step, names)
    given = arguments_by_role(names, kind) | {each: "n" for each in names if word_of(each) in calling.COUNTS}
    run = call_by_names(step, names, given)
    return defined(kind, f"xs = {run}", f"return {common.WITH_SPEEDS.format('xs', 'xs[1:]')}", run=True)


def _two_step_run(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str], kind: str) -> str:
    """The run of a function whose one argument not given is the state before; "" if it cannot be written."""
    given = dict.fromkeys(names, "ys[-2]") | {**given}
    later = call_by_names(step, names, common.later_arguments(given, q="ys[-1]"))
    if kind == FIELD and {"y", "h"} <= {*given.values()}:
        line = common.run_of_steps(kind, f"y, {common.FIRST_STEP}", later, first=1)
        return f"{line}  # a run of n steps, whose first is one of midpoint2"
    if kind == FORCE and {*given.values()} == {"force", "q", "h", "ys[-2]"}:
        with suppress(Exception):
            pair = isinstance(step(**{each: TRIAL_ARGUMENTS[given[each]] for each in names}), tuple)
            return common.run_of_positions(later + "[0]" * pair)
    return _with_a_force(step, names) if kind == MAP else ""


def _with_a_force(step: Callable[..., Any], names: Sequence[str]) -> str:
    head = f"def {common.name_of(step)}(force, {', '.join(names)}): ..."
    return f"{head}  # a method of two steps is read if its force is an argument"


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
    """True if a run of some steps ends elsewhere than as many runs of one step, with slopes that depend on its time."""
    timed = not {"t", "[t, t + h]"}.isdisjoint(given.values())  # any other run begins at a time of its own

    def rate(*x: Any) -> Any:
        return timed * sum(each for each in x if np.size(each) == 1) - max(x, key=np.size)

    def end(t: float, y: Any, n: int) -> Any:
        known = {**TRIAL_ARGUMENTS, "f": rate, "t": t, "y": y, "1": n, "t + h": t + n / 4}
        span = [0, n] if "1" in given.values() else range(n + 1)
        known |= {"h": n / 4, "[t, t + h]": np.array([t + i / 4 for i in span])}
        return np.asarray(reduce(getitem, where, step(*[known[given[each]] for each in names])), float)

    start = TRIAL_ARGUMENTS["y"]
    by_one: Any = reduce(lambda y, i: end(i / 4, y, 1), range(_RUN), start)
    return not np.allclose(by_one, end(0.0, start, _RUN), rtol=_SAME, atol=0)
