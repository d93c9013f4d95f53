"""Wrappers of functions, ready to paste: steps with other arguments, of two forces, of two functions, of gradients."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import chain, combinations
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper import wrapper_parts as common
from driftproof.blackbox.stepper.records import fields_of
from driftproof.blackbox.stepper.run_wrappers import list_wrapper, run_wrapper, two_step_run

# Of a step without a right-hand side, so many arguments that are not known are those of a built-in system.
_MOST_OPEN = 2
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
_SPANS = (*calling.SPANS, "t_bound", "t_end", "tf", "t_final")


def function_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function: a step with gradients of an energy, a run, a solver, or a plain step."""
    return common.stated_first(_function_wrapper(step))


def _function_wrapper(step: Callable[..., Any]) -> str:
    if (names := calling.names_with_step(step)) is None:
        return ""
    if (
        _named(names, _SPANS)
        and not _named(names, calling.COUNTS)
        and not any(calling.role_of(each, (calling.STEP,)) for each in names)
    ):
        return f"identify_solver({common.name_of(step)}), on the command line --solver, for a whole solver"
    if gradients := gradients_of(names):
        rest = [each for each in names if each not in gradients]
        return _call(step, names, {**gradients, **common.arguments_by_role(rest, calling.FORCE)}, calling.FORCE)
    if line := _two_forces_wrapper(step, names) or _run_of_records(step, names):
        return line
    kind = common.kind_by_names(names)
    given = common.arguments_by_role(names, kind)
    line = list_wrapper(step) or run_wrapper(step, names) or _pair_wrapper(step, names)
    if kind == calling.MAP and not line and (called := with_global(step)):
        line = _function_wrapper(called)
        return line if line and "write values" not in line else ""
    states = [*given.values()]
    told = given and (kind != calling.MAP or (len(names) - len(given) < _MOST_OPEN and states.count("[q, v]") < 2))
    return line or (_call(step, names, given, kind) if told else "")


def gradients_of(names: Sequence[str]) -> dict[str, str]:
    """The gradients by the positions and by the momenta among the names, each as it is given; nothing without both."""
    found = (
        next((each for each in names if calling.has_gradient([each])), _named(names, _BY_POSITION)),
        _named(names, _BY_MOMENTUM),
    )
    texts = "lambda q, *p: -force(q)", "lambda *p: p[-1]"
    return {} if None in found else {str(each): text for each, text in zip(found, texts, strict=True)}


def called_functions(step: Callable[..., Any], names: Sequence[str]) -> list[str]:
    """The arguments that a step calls, though no name says so, that which it calls least last; nothing if none is seen.

    >>> called_functions(lambda u, N, L, dt: u + dt * (N(u) + L(u)), ["u", "N", "L", "dt"])
    ['N', 'L']
    """
    given = {**common.arguments_by_role(names, calling.FIELD), **common.arguments_by_role(names, calling.FORCE)}
    told = (calling.STEP, calling.TIME, calling.POSITION, calling.VELOCITY, calling.STATE)
    if "h" not in given.values() or any(calling.role_of(each, (calling.FUNCTION,)) for each in names):
        return []
    others = [each for each in names if not calling.role_of(each, told)]
    for chosen in chain.from_iterable(combinations(others, size) for size in (1, 2)):
        calls: dict[str, int] = dict.fromkeys(chosen, 0)

        def asks(name: str, *x: Any, calls: dict[str, int] = calls) -> Any:
            calls[name] += 1
            return 0.0 * max(x, key=np.size)

        with suppress(Exception):
            values = {each: common.TRIAL_ARGUMENTS.get(given.get(each, ""), 1.0) for each in names}
            step(**values | {each: partial(asks, each) for each in chosen})
            if all(calls.values()):
                return sorted(chosen, key=lambda name: -calls[name])
    return []


def _two_forces_wrapper(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The wrapper of a step of two forces, of which it is given the one that it calls least, and 0 for the other."""
    roles, pair = {*map(common.plain_role, names)}, called_functions(step, names)
    if not {calling.POSITION, calling.VELOCITY} <= roles or len(pair) != 2:
        return ""
    given = common.arguments_by_role([each for each in names if each not in pair], calling.FORCE)
    others = {x.name: x.default for x in (calling.parameters_of(step) or {}).values()}
    counts = [each for each, x in others.items() if type(x) is int and x > 1]  # of inner steps, whose sums round more
    given, names = {**given, **dict.fromkeys(counts, "1")}, [*names, *counts]
    return _call(step, names, {**given, pair[0]: "lambda q, *rest: 0.0 * q", pair[1]: "force"}, calling.FORCE)


def _run_of_records(step: Callable[..., Any], names: Sequence[str]) -> str:
    """The run of a step of records that hold a position and the one before, and no velocity; "" if it takes none."""
    given = {
        each: {"f": "force"}.get(text, text) for each, text in common.arguments_by_role(names, calling.FIELD).items()
    }
    left = [each for each in names if given.get(each, "y") in ("y", "()")]
    if len(left) != 1 or not {"force", "h"} <= {*given.values()} - {given.get(left[0])}:
        return ""
    trial = {**common.TRIAL_ARGUMENTS, "force": lambda *x: 0.0}
    with suppress(Exception):
        read = lambda record: step(**{each: record if each in left else trial[given[each]] for each in names})
        name, make, _, needed = fields_of(step, read) or ("", dict, (), ())
        (before,) = filter(common.is_before, needed)
        (now,) = (each for each in needed if each != before)
        part, start = f"[{now!r}]" if make is dict else f".{now}", f"{name}({now}=q, {before}={common.BEFORE})"
        later = common.call_by_names(step, names, {**given, left[0]: "ys[-1]"})
        found = common.WITH_SPEEDS.format(*(f"[y{part} for y in {row}]" for row in ("ys", "ys[1:]")))
        line = common.run_of_steps(common.HEADS[calling.FORCE], start, later, found=found)
        return line if common.goes_straight(line, **{common.name_of(step): step, name: make}) else ""
    return ""


def _named(names: Sequence[str], known: Sequence[str]) -> str | None:
    """The first of the names that is a known one; None if none is."""
    return next((each for each in names if calling.word_of(each) in known), None)


def with_global(step: Callable[..., Any]) -> Callable[..., Any] | None:
    """The step with the function of its module that moves its system as its first argument; None if there is none.

    It is the only one that the step, or what it calls in that module, calls by the name of a right-hand side.
    """
    known, called = getattr(step, "__globals__", {}), [step]
    for function in called:  # which grows
        names = getattr(getattr(function, "__code__", None), "co_names", ())
        called += [x for name in names if inspect.isfunction(x := known.get(name)) and x not in called]
    moving = {x.__name__: x for x in called[1:] if calling.role_of(x.__name__, (calling.FUNCTION,))}
    moving = {name: x for name, x in moving.items() if known.get(name) is x}
    if len(moving) != 1 or (names := calling.names_with_step(step)) is None:
        return None
    ((name, function),) = moving.items()
    plain = all(
        calling.role_of(each, (calling.POSITION, calling.VELOCITY, calling.TIME, calling.STATE))
        for each in calling.required_names(function) or ()
    )

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
    functions = [
        each for each in names if calling.role_of(each, (calling.FUNCTION,)) or each in ("g", "G", "func2", "f2")
    ]
    known = {time: "t" for time in names if calling.role_of(time, (calling.TIME,))} | {calling.size_name(names): "h"}
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
            call = common.call_by_names(step, names, {**given, **dict(zip(functions, parts, strict=True))})
            return f"def wrapped({common.HEADS[calling.FIELD]}): import numpy; return numpy.array({call})"
    return ""


def _call(step: Callable[..., Any], names: Sequence[str], given: Mapping[Any, str], kind: str) -> str:
    """The wrapper that calls a function of these names with the arguments given; those left are in capitals."""
    left = [each for each in names if each not in given]
    time = ", t for the time" * (kind == calling.FIELD and len(left) == 1 and {"t", "t + h"}.isdisjoint(given.values()))
    said = f"  # write values for {', '.join(map(str.upper, left))}{time}" if left else ""
    if len(left) == 1 and common.is_before(left[0]):
        if line := two_step_run(step, names, given, kind):
            return line
        said = f"  # a method of two steps: let an object keep its {left[0].upper()}, step(f, t, y, h) being its method"
    if kind == calling.MAP and "h" not in given.values():
        said = "  # its h is built in: let it be an argument, or make the step anew for every h"
    if kind == calling.MAP and any(calling.word_of(each) in calling.BODY_LISTS for each in left):
        said = "  # what moves its bodies is built in: let their force be an argument, which can then be given"
    head = common.HEADS[kind] if kind != calling.FIELD or getattr(step, "timed", True) else "f, y, h"
    if kind == calling.MAP and "[q, v]" in given.values():
        try:
            step(**{each: common.TRIAL_ARGUMENTS.get(given.get(each, ""), 0.0) for each in names})
        except ValueError:  # of a state of more numbers
            head, given = "y, h", {each: "y" if text == "[q, v]" else text for each, text in given.items()}
        except Exception:  # which a pasted wrapper will tell
            pass
    call = common.call_by_names(step, names, {each: each.upper() for each in left} | {**given})
    return f"def wrapped({head}): return {call}{said}"
