"""Wrappers of runs, ready to paste: functions that make all steps to an end, and steps from a list of last states."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from copy import copy
from functools import reduce
from itertools import product
from operator import getitem
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.wrapper_parts import (
    BEFORE,
    FIRST_STEP,
    HEADS,
    TRIAL_ARGUMENTS,
    WITH_SPEEDS,
    arguments_by_role,
    call_by_names,
    kind_by_names,
    later_arguments,
    name_of,
    run_of_steps,
)

# This many steps are more than the start of any multistep method in use; and how near to each other two runs are.
_RUN, _SAME = 12, 2.0**-40
# Names of a list of the last states; a method in use looks back at no more than this many.
_LISTS, _MOST_STATES = re.compile("^ys$|^us$|^xs$|states|hist|past|prev"), 7


def run_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a run to a given end, in steps or in a number of them, or over a row of times, by its last state.

    It is "" unless the run is seen to begin at the start, or to stay there where nothing moves. If a run of several
    steps is not one step after the other, the wrapper takes their number: a multistep method has other steps at first.
    """
    kind = kind_by_names(names)
    begins = {each[:-1].strip("_") for each in names if each.endswith("0")}  # of x0 and x, the latter is the end
    end = next(
        (each for each in names if calling.word_of(each) in calling.RUN_ENDS[1] or each == "T" or each in begins), ""
    )
    given = arguments_by_role([each for each in names if each != end], kind)
    left, timed = [each for each in names if given.get(each, "0.0") == "0.0"], "t" in given.values()
    counted = [each for each in left if calling.word_of(each) in calling.COUNTS]
    if end:
        given[end] = "t + h" if timed else "h"
    elif left and left == counted and kind != calling.FIELD:
        given[left[0]] = "1"
    elif len(left) == 1 and "h" not in given.values():
        timed = kind == calling.FIELD
        given[left[0]] = "[t, t + h]" if timed else "[0.0, h]"
    else:
        return ""
    if len(given) < len(names):
        return ""
    head = HEADS[kind] if timed or kind != calling.FIELD else "f, y, h"
    whole = {"1": "n", "t + h": "t + n * h", "h": "n * h", "[t, t + h]": "[t, t + n * h]"}
    # Some cannot end before their start does.
    counts = (1, _RUN) if kind == calling.FIELD and "1" in given.values() else (1,)
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
            states = ("q", "v") if {"q", "v"} <= {*given.values()} else ("y",) if kind == calling.FIELD else ("[q, v]",)
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
                run = call_by_names(step, names, {each: whole.get(text, text) for each, text in written.items()})
                return f"def wrapped({head}, n): return {run}{first.removesuffix('[-1]')}"
            return f"def wrapped({head}): return {run}{first}"
    return ""


def list_wrapper(step: Callable[..., Any]) -> str:
    """The run of n steps of a method that takes a list of the last states; "" if no list of up to seven is taken.

    Of y' = 1 every method finds the next state, t + h, if the list is in its own order.
    """
    names = [] if inspect.isclass(step) else calling.required_names(step) or []
    past = next((each for each in names if _LISTS.search(each.lower())), "")
    given = {past: "ys"} | arguments_by_role([each for each in names if each != past], calling.FIELD)
    if len(given) < len(names) or not {"f", "ys", "h"} <= {*given.values()} <= {"f", "t", "ys", "h"}:
        return ""
    for size, turned in product(range(2, _MOST_STATES + 1), (1, -1)):
        with suppress(Exception):
            ys = [np.array([i / 4, i / 4]) for i in range(1 - size, 1)][::turned]
            values = {"f": lambda *x: np.ones(2), "t": 0.0, "ys": ys, "h": 0.25}
            if np.allclose(step(*[values[given[each]] for each in names]), 0.25, rtol=0, atol=2.0**-20):
                call = call_by_names(step, names, later_arguments(given, ys="ys[::-1]" if turned < 0 else "ys"))
                later = f"s(t + i * h, ys[-1]) if i < {size - 1} else {call}"
                line = run_of_steps(HEADS[calling.FIELD], "y", later, f"s = lambda t, y: {FIRST_STEP}; ")
                return f"{line}  # begins with midpoint2"
    return ""


def positions_wrapper(step: Callable[..., Any]) -> str:
    """The run of a method that returns positions alone, with their differences as velocities."""
    names = calling.names_with_step(step) or []
    if (kind := kind_by_names(names)) != calling.FORCE:
        return _with_a_force(step, names)
    given = arguments_by_role(names, kind) | {each: "n" for each in names if calling.word_of(each) in calling.COUNTS}
    run = call_by_names(step, names, given)
    return f"def wrapped({HEADS[kind]}, n): xs = {run}; return {WITH_SPEEDS.format('xs', 'xs[1:]')}"


def two_step_run(step: Callable[..., Any], names: Sequence[str], given: Mapping[Any, str], kind: str) -> str:
    """The run of a function whose one argument not given is the state before; "" if it cannot be written."""
    given = dict.fromkeys(names, "ys[-2]") | {**given}
    if kind == calling.FIELD and {"y", "h"} <= {*given.values()}:
        later = call_by_names(step, names, later_arguments(given))
        line = run_of_steps(HEADS[kind], f"y, {FIRST_STEP}", later, first=1)
        return f"{line}  # a run of n steps, whose first is one of midpoint2"
    if kind == calling.FORCE and {*given.values()} == {"force", "q", "h", "ys[-2]"}:
        with suppress(Exception):
            pair = isinstance(step(**{each: TRIAL_ARGUMENTS[given[each]] for each in names}), tuple)
            later = call_by_names(step, names, later_arguments(given, q="ys[-1]")) + "[0]" * pair
            return run_of_steps(HEADS[kind], f"{BEFORE}, q", later, found=WITH_SPEEDS.format("ys[1:]", "ys[2:]"))
    return _with_a_force(step, names) if kind == calling.MAP else ""


def _with_a_force(step: Callable[..., Any], names: Sequence[str]) -> str:
    head = f"def {name_of(step)}(force, {', '.join(names)}): ..."
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
