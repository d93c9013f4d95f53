"""Wrappers of functions and of runs, ready to paste: of other arguments, to an end, from earlier states, of classes."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from copy import copy
from functools import reduce
from itertools import chain, product
from operator import getitem
from textwrap import dedent
from typing import Any, NamedTuple

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, MAP, STATE, word_of
from driftproof.blackbox.stepper.states.named_answers import is_before
from driftproof.blackbox.stepper.wrappers import wrapper_parts as common
from driftproof.blackbox.stepper.wrappers.made_wrappers import function_argument, public_methods
from driftproof.blackbox.stepper.wrappers.wrapper_parts import (
    TRIAL_ARGUMENTS,
    arguments_by_role,
    call_by_names,
    defined,
)

# Of a step without a right-hand side, so many arguments that are not known are those of a built-in system.
_MOST_OPEN = 2
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
_SPANS = (*calling.SPANS, "t_bound", "t_end", "tf", "t_final")
# The usual names of a method that makes a run.
_RUNS = ("solve", "run", "integrate", "simulate", "propagate", "evolve")
# This many steps are more than the start of any multistep method in use; and how near to each other two runs are.
_RUN, _SAME = 12, 2.0**-40


def function_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function: a step with gradients of an energy, a run, a solver, or a plain step."""
    if (names := calling.names_with_step(step)) is None:
        return ""
    if _named(names, _SPANS) and not _named(names, calling.COUNTS) and not calling.size_name(names):
        return common.whole_solver(step)
    if gradients := gradients_of(names):
        rest = [each for each in names if each not in gradients]
        return _call(step, names, {**gradients, **arguments_by_role(rest, FORCE)}, FORCE)
    kind = common.kind_by_names(names)
    given = arguments_by_role(names, kind)
    if kind == FORCE and (force := _named(names, calling.ROLES[calling.CARRIED])) and not _is_called(step, force):
        return _handing_on(step, names)
    line = run_wrapper(step, names)
    states = [*given.values()]
    told = given and (kind != MAP or (len(names) - len(given) < _MOST_OPEN and states.count("[q, v]") < 2))
    return line or (_call(step, names, given, kind) if told else "")


def _is_called(step: Callable[..., Any], name: str) -> bool:
    """True unless the source of the step uses this argument, but neither calls it nor hands it to another function."""
    with suppress(OSError, TypeError, SyntaxError):
        parts = [*ast.walk(ast.parse(dedent(inspect.getsource(step))))]
        calls = [x for x in parts if isinstance(x, ast.Call)]
        handed = [part for x in calls for part in (x.func, *x.args, *(each.value for each in x.keywords))]
        used, called = ([x for x in of if isinstance(x, ast.Name) and x.id == name] for of in (parts, handed))
        return bool(called) or not used
    return True


def _handing_on(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a step that is given a force, as numbers, and hands on the next one; "" if nothing is to write."""
    parts = (calling.POSITION, calling.VELOCITY, calling.CARRIED, calling.FUNCTION, calling.STEP, calling.TIME)
    left = [each for each in names if not calling.role_of(each, parts)]
    call = call_by_names(step, names, {each: each.upper() if each in left else each for each in names})
    taken = ", ".join(each for each in names if each not in left)
    said = f"# write values for {', '.join(map(str.upper, left))}; its forces are its own: verify --system"
    return f"def wrapped({taken}): return {call}  {said}" if left else ""


def gradients_of(names: Sequence[str]) -> dict[str, str]:
    """The gradients by the positions and by the momenta among the names, each as it is given; nothing without both."""
    by_position = next((each for each in names if calling.has_gradient([each])), _named(names, _BY_POSITION))
    by_momentum = _named(names, _BY_MOMENTUM)
    if not by_position or not by_momentum:
        return {}
    return {by_position: "lambda q, *p: -force(q)", by_momentum: "lambda *p: p[-1]"}


def _named(names: Sequence[str], known: Sequence[str]) -> str:
    """The first of the names that is a known one; "" if none is."""
    return next((each for each in names if word_of(each) in known), "")


def _call(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str], kind: str) -> str:
    """The wrapper that calls a function of these names with the arguments given; those left are in capitals."""
    left = [each for each in names if each not in given]
    time = ", t for the time" * (kind == FIELD and len(left) == 1 and {"t", "t + h"}.isdisjoint(given.values()))
    said = f"  # write values for {', '.join(map(str.upper, left))}{time}" if left else ""
    if len(left) == 1 and is_before(left[0]):
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
    given = _arguments_of_a_run(names, kind := common.kind_by_names(names))
    if len(given) < len(names):
        return ""
    # Some cannot end before their start does.
    run = _Run(step, names, given, kind, (1, _RUN) if kind == FIELD and "1" in given.values() else (1,))
    for many, count in product((False, True), run.counts):
        with suppress(Exception):
            return run.tried(many, count)
    return ""


class _Run(NamedTuple):
    """A run with what it is given for each name, in which it makes one step; `counts` are numbers of steps to try."""

    step: Callable[..., Any]
    names: Sequence[str]
    given: Mapping[str, str]
    kind: str
    counts: Sequence[int]

    def of(self, values: Mapping[str, Any]) -> Any:
        """What the run returns where the arguments of its wrapper have these values."""
        return self.step(*[values[self.given[each]] for each in self.names])

    def tried(self, many: bool, count: int) -> str:
        """The wrapper as a run of so many steps shows it, maybe of arrays. Raises ValueError if no state is seen."""
        values = {key: np.array([x]) if many and key in ("q", "v") else x for key, x in TRIAL_ARGUMENTS.items()}
        values["1"], asked = count, list[Any]()
        values["f"] = lambda *x: asked.append(x) or 0.0 * max(x, key=np.size)  # type: ignore[func-returns-value]
        found, of_all, texts = self.of({key: copy(x) for key, x in values.items()}), "{}", {*self.given.values()}
        if inspect.isgenerator(found):
            found, of_all = [*found][-1], "[*{}][-1]"
        states = ("q", "v") if {"q", "v"} <= texts else ("y",) if self.kind == FIELD else ("[q, v]",)
        places = [_end_of(found, values[each]) for each in states]
        if -1 not in places[0] and {"[0.0, h]", "[t, t + h]"} & texts:
            return ""  # what is not known to be a row of times need not be one
        shift = texts.isdisjoint(("t", "t + h", "[t, t + h]"))
        written = {x: _shifted(text, asked[0]) if shift and text == "f" else text for x, text in self.given.items()}
        run = of_all.format(call_by_names(self.step, self.names, written))
        first, *last = ("".join(f"[{i!r}]" for i in place) for place in places)
        if last:
            return defined(self.kind, f"run = {run}", f"return run{first}, run{last[0]}")
        rows = {"[t, t + h]"} == {"[t, t + h]", "1"} & texts
        if (rows or self.counts[1:]) and (count > 1 or self.remembers(places[0])):
            times = "[t + i * h for i in range(n + 1)]" if rows else "[t, t + n * h]"
            whole = {"1": "n", "t + h": "t + n * h", "h": "n * h", "[t, t + h]": times}
            run = call_by_names(self.step, self.names, {each: whole.get(text, text) for each, text in written.items()})
            return defined(self.kind, f"return {run}{first.removesuffix('[-1]')}", run=True)
        return defined(self.kind, f"return {run}{first}")

    def remembers(self, where: Sequence[int]) -> bool:
        """True if a run of some steps ends elsewhere than as many of one step, with slopes that depend on its time."""
        timed = not {"t", "[t, t + h]"}.isdisjoint(self.given.values())  # any other run begins at a time of its own

        def rate(*x: Any) -> Any:
            return timed * sum(each for each in x if np.size(each) == 1) - max(x, key=np.size)

        def end(t: float, y: Any, n: int) -> Any:
            known = {**TRIAL_ARGUMENTS, "f": rate, "t": t, "y": y, "1": n, "t + h": t + n / 4}
            span = [0, n] if "1" in self.given.values() else range(n + 1)
            known |= {"h": n / 4, "[t, t + h]": np.array([t + i / 4 for i in span])}
            return np.asarray(reduce(getitem, where, self.of(known)), float)

        start = TRIAL_ARGUMENTS["y"]
        by_one: Any = reduce(lambda y, i: end(i / 4, y, 1), range(_RUN), start)
        return not np.allclose(by_one, end(0.0, start, _RUN), rtol=_SAME, atol=0)


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
    head = f"def {common.name_of(step)}(force, {', '.join(names)}): ..."
    return f"{head}  # a method of two steps is read if its force is an argument" if kind == MAP else ""


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


def class_run_wrapper(cls: type) -> str:
    """The wrapper of a class with a method for a run; one with tolerances is a whole solver; "" if none is known."""
    if (run := run_of_class(cls)) is None:
        return ""
    if any(calling.word_of(each) in (*calling.TOLERANCE_NAMES[0], "tol") for each in calling.parameters_of(cls) or ()):
        return common.whole_solver(cls)
    return run_wrapper(run, calling.required_names(run) or [])


def run_of_class(cls: type) -> Callable[..., Any] | None:
    """The run solve(f, ...) of a class made from f that has a method for it, and maybe one that takes the start.

    It takes what the class and both methods take. What a method that returns nothing leaves in the object is returned
    as times and states.

    >>> class Euler:
    ...     def __init__(self, f):
    ...         self.f = f
    ...     def set_initial_condition(self, u0):
    ...         self.u0 = u0
    ...     def solve(self, span, n):
    ...         return span, [self.u0, self.u0 + (span[1] - span[0]) * self.f(span[0], self.u0)]
    >>> run_of_class(Euler)(lambda t, u: -u, 1.0, (0.0, 0.5), 1)
    ((0.0, 0.5), [1.0, 0.5])
    """
    methods = {each: _parameters(getattr(cls, each))[1:] for each in public_methods(cls)}
    run = next((each for each in _RUNS if each in methods), "")
    if not run or not function_argument(cls):
        return None
    calls = {"": _parameters(cls), run: methods[run]}
    if not any(map(_begins, chain(*calls.values()))):
        setter = next((each for each, taken in methods.items() if len(taken) == 1 and _begins(taken[0])), None)
        if setter is None:
            return None
        calls = {"": calls[""], setter: methods[setter], run: methods[run]}
    left: list[str] = []  # the attributes in which a run leaves what it does not return

    def passed(each: str, given: Mapping[str, Any]) -> dict[str, Any]:
        return {x.name: given[x.name] for x in calls[each] if x.name in given}

    def solve(*arguments: Any, **named: Any) -> Any:
        given = inspect.signature(solve).bind(*arguments, **named).arguments
        found = made = cls(**passed("", given))
        for each in [*calls][1:]:
            found = getattr(made, each)(**passed(each, given))
        if found is None:
            names = *(each for each in vars(made) if each not in given), *given
            left[:] = (next(x for x in names if calling.role_of(x, (role,))) for role in (calling.GRID, calling.STATE))
            found = tuple(getattr(made, each) for each in left)
        return found

    def written(*texts: str) -> str:
        given = dict(zip(calling.required_names(solve) or (), texts, strict=True))
        lines = [f"made.{each}({', '.join(passed(each, given).values())})" for each in calls]
        lines[0] = lines[0].replace("made.", f"made = {common.name_of(cls)}", 1)
        end = f"({', '.join(f'made.{each}' for each in left)})" if left else lines.pop()
        return f"‹{'; '.join(lines)}›{end}"

    named = {x.name: x.replace(kind=x.POSITIONAL_OR_KEYWORD) for x in chain(*calls.values())}
    made_run: Any = solve
    taken = sorted(named.values(), key=lambda x: x.default is not x.empty)
    calling.stand_in(made_run, cls, taken)
    made_run.written = written
    return solve


def _parameters(code: Callable[..., Any]) -> list[inspect.Parameter]:
    """What a class or a method takes, but for any number of further arguments."""
    taken = (calling.parameters_of(code) or {}).values()
    return [x for x in taken if x.kind not in (x.VAR_POSITIONAL, x.VAR_KEYWORD)]


def _begins(taken: inspect.Parameter) -> bool:
    return calling.word_of(taken.name) in (*calling.STARTS, *calling.ROLES[calling.STATE])
