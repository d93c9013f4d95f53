"""The wrappers that refusals show, of one line, ready to paste, for steppers that cannot be opened as they are."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.wrappers.asked_functions import asked_step
from driftproof.blackbox.stepper.wrappers.function_wrappers import function_wrapper
from driftproof.blackbox.stepper.wrappers.kept_state_wrappers import advance_of, further_names, making, object_wrapper
from driftproof.blackbox.stepper.wrappers.made_wrappers import maker_wrapper, owner_of
from driftproof.blackbox.stepper.wrappers.wrapper_parts import ARGUMENTS, kind_by_names, name_of, plain_role

# What to write where no wrapper is known, and where a right-hand side is built in.
OWN_STEP = " a step(f, t, y, h), or step(force, q, v, h), of your own"
_WITHOUT = " a step that takes its right-hand side, which no argument is: def "


def wrapper_line(step: Callable[..., Any], own: bool = False) -> str:
    """The wrapper to write, as the end of an error message, maybe one that keeps the `own` system; "" if none fits."""
    step = owner_of(step)
    line = object_wrapper(step, own)
    if not line and inspect.isclass(step) and (further := further_names(step, advance_of(step))):
        return f"{_WITHOUT}{advance_of(step)}({', '.join(dict.fromkeys(('f', *further, 'h')))}): ..."
    if not line and not inspect.isclass(step):
        roles = {*map(plain_role, calling.required_names(step) or ())}
        line = maker_wrapper(step) if roles and roles <= {calling.FUNCTION, calling.STEP} else function_wrapper(step)
        if (not line or "  # " in line) and (asked := asked_step(step)):
            line = function_wrapper(asked) or line
    return f": {line}" if line else ""


def template(step: Callable[..., Any]) -> str:
    """The shortest wrapper of a class or a function of which no more is known, with words in capitals to replace."""
    step = owner_of(step)
    name = name_of(step)
    if inspect.isclass(step):
        makes = making(step, calling.FORCE)
        places = f'position="POSITION", velocity="VELOCITY", advance="{advance_of(step) or "STEP"}"'
        wrapper = f"from driftproof import stepper_of; wrapped = stepper_of({makes}, {places})"
        return f': {wrapper}  # attributes\' names, or state="STATE"'
    names = calling.required_names(step) or []
    if kind_by_names(names) == calling.MAP and calling.size_name(names):
        if calling.launch(names):
            return " one step of it, step(q, v, h): it takes no state, but is a run from a launch"
        state = next(
            (each for each in names if each not in calling.matrices(names) and calling.role_of(each, (calling.STATE,))),
            names[0],
        )
        taken = ", ".join(filter(None, ("f", state, calling.size_name(names))))
        return f"{_WITHOUT}{name}({taken}): ..."
    if len(names) == 2:
        return f": wrapped = lambda y, h: {name}(y, h)  # where {names[0]} is its state and {names[1]} its step size"
    return f"{OWN_STEP} that calls it with its state"


def uncalled(found: object) -> str:
    """What to hand over in place of an object that cannot be called: a wrapper of its method, or any function."""
    advance = "" if type(found).__module__ == "builtins" else advance_of(type(found))
    if advance and (line := wrapper_line(getattr(found, advance)) or template(type(found))):
        return f"; its {advance} makes the step; write{line}"
    return "; hand over a function that makes one step, say: def step(f, t, y, h): return y + h * f(t, y)"


def increment_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that adds the state to a returned increment."""
    of_state = calling.STATE in subject.convention.order
    return call_wrapper(subject, "return y + {}" if of_state else "dq, dv = {}; return q + dq, v + dv")


def answer_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that returns the new state alone, of which only the place in the answer is not known.

    There is none, "", of a step that takes more than a state, f, a time and a step size.
    """
    if {*subject.convention.order} - {*ARGUMENTS}:
        return ""
    of_state = calling.STATE in subject.convention.order
    body, what = ("{}[HERE]", "the new state stands") if of_state else ("[{}[i] for i in HERE]", "q1 and v1 stand")
    return f"{call_wrapper(subject, f'return {body}')}  # HERE: where {what}"


def turn_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that puts the velocity first in a state of one array, in the argument and in the answer."""
    body = "import numpy; turn = lambda x: numpy.roll(x, len(x) // 2); return turn({})"
    return call_wrapper(subject, body, function="lambda t, y: turn(f(t, turn(y)))", state="turn(y)")


def substeps_wrapper(subject: ForeignStepper) -> str:
    """The wrapper of one step of several in a call, by the only count among its defaults; "" if there is none."""
    given = calling.parameters_of(subject.function) or {}
    counts = [name for name, x in given.items() if type(x.default) is int and x.default > 1]
    if len(counts) != 1:
        return ""
    found = subject.convention
    return call_wrapper(replace(subject, convention=replace(found, extra={**found.extra, counts[0]: 1})), "return {}")


def call_wrapper(subject: ForeignStepper, body: str, **given: str) -> str:
    """The wrapper that makes this of its call of the step with its own arguments, or what is `given` for a role."""
    convention, forced = subject.convention, subject.convention.kind == calling.FORCE
    order = [role for role in convention.order if role in ARGUMENTS]
    names = ARGUMENTS | ({calling.FUNCTION: "force"} if forced else {})
    gradient = {calling.FUNCTION: "lambda x: -force(x)"} if forced and convention.factor < 0 else {}
    passed = names | gradient | given
    texts = [passed[role] for role in order]
    if convention.names:
        texts = [f"{name}={text}" for name, text in zip(convention.names, texts, strict=False)]
    texts += [f"{name}={x:g}" for name, x in convention.extra.items()]
    call = f"{name_of(subject.function)}({', '.join(texts)})"
    return f"; write: def wrapped({', '.join(names[role] for role in order)}): {body.format(call)}"
