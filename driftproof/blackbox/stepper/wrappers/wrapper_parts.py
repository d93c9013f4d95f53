"""What every wrapper is made of: arguments by role, the call of the code by their names, the line that is pasted."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, FUNCTION, MAP, STATE, STEP, role_of, word_of

# The arguments of a wrapper by role, and all of them for a wrapper of each kind; STATE has a map of one array.
ARGUMENTS = {FUNCTION: "f", calling.TIME: "t", STATE: "y", calling.POSITION: "q", calling.VELOCITY: "v", STEP: "h"}
_HEADS = {MAP: "q, v, h", FORCE: "force, q, v, h", FIELD: "f, t, y, h", STATE: "t, y, h"}
# What asks for a time, and the statements that stand before the one with a call.
_TIMED, _BEFOREHAND = re.compile(r"(?<![.\w])t\b"), re.compile("‹(.*?)›")
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


def defined(kind: str, *statements: str, run: bool = False) -> str:
    """The line of a wrapper of a kind that makes these statements; of a run, it takes a number n of steps.

    It takes a time if one of them asks for it, or if a right-hand side leaves values to be written. What has to be done
    before a call stands in it between ‹ and ›.
    """
    body = "; ".join(filter(None, statements))
    body = "; ".join([*_BEFOREHAND.findall(body), _BEFOREHAND.sub("", body)])
    timed = _TIMED.search(body) or (kind == FIELD and "# write" in body)
    head = _HEADS[kind] if timed else _HEADS[kind].replace("t, ", "")
    return f"def wrapped({head}{', n' * run}): {body}"


def run_of_steps(kind: str, states: str, later: str, begin: str = "", first: int = 0, found: str = "ys") -> str:
    """The wrapper of a run: the `states` before step number `first`, then `later`, which is a text in terms of ys."""
    steps = f"[ys.append({later}) for i in range({f'{first}, ' if first else ''}n)]"
    return defined(kind, begin, f"ys = [{states}]", steps, f"return {found}", run=True)


def run_of_positions(later: str, begin: str = "") -> str:
    """The run of a method for q'' = F(q) that takes the last two positions; its velocities are their differences."""
    return run_of_steps(FORCE, f"{BEFORE}, q", later, begin, found=WITH_SPEEDS.format("ys[1:]", "ys[2:]"))


def called_with(
    step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str], taken: Sequence[str]
) -> Callable[..., Any]:
    """The step that takes other arguments and calls this one with what is `given`, as a wrapper would be written."""
    call = ", ".join(f"{each}={given[each]}" for each in names)
    exec(f"make = lambda step_: lambda {', '.join(taken)}: step_({call})", known := dict[str, Any]())
    made = known["make"](step)  # which holds the step itself, so that a copy has a copy of it
    calling.stand_in(made, step, taken)
    return made  # type: ignore[no-any-return]


def whole_solver(step: Callable[..., Any]) -> str:
    """What to write for a whole solver."""
    name = name_of(step)
    asserted = f"in a test assert_verified_solver({name}, method)"
    return f"identify_solver({name}), {asserted}, on the command line --solver, for a whole solver"


def plain_role(name: str) -> str | None:
    """The role of an argument by its name."""
    return role_of(name, (FUNCTION, STEP, calling.TIME, calling.POSITION, calling.VELOCITY, STATE))


def kind_by_names(names: Sequence[str]) -> str:
    """The kind of a step with these arguments: with a function, FORCE for a position and what is moved, else FIELD.

    Without a velocity or a time, a position is moved by what has the name of a force or a gradient; a and b are the
    ends of a run.
    """
    plain = [each for each in names if each not in calling.matrices(names)]
    roles = {plain_role(each) for each in plain}
    pushed = takes_force(plain) or calling.has_gradient(plain) or {"a", "b"} & {*map(word_of, plain)} == {"a"}
    moved = calling.POSITION in roles and (calling.VELOCITY in roles or (calling.TIME not in roles and pushed))
    return MAP if FUNCTION not in roles else FORCE if moved else FIELD


def takes_force(names: Iterable[str]) -> bool:
    """True if one of these is the name of a force or an acceleration."""
    return any(word in each.lower() for each in names for word in ("acc", "force"))


def arguments_by_role(names: Sequence[str], kind: str) -> dict[str, str]:
    """The wrapper's argument for each name whose role is known; a single state of a map is [q, v]."""
    given: dict[str, str] = {}
    if kind == FIELD and (pair := [each for each in names if word_of(each) in ("x", "x0", "y", "y0")])[1:]:
        given = dict(zip(pair, "ty", strict=False))  # of f(x, y) the first is the time
    sized, no_roles = calling.size_name(names), _without_role(names)
    for each in (name for name in names if name not in (*given, *no_roles)):
        roles = [role for role in _open_roles(kind, given) if role != STEP or each == sized]
        role = role_of(each, roles) or (role_of(each.rstrip("_0"), roles) if kind != FIELD else None)
        if role == FUNCTION:
            given[each] = "lambda x: -force(x)" if kind == FORCE and calling.has_gradient([each]) else function_of(kind)
        elif role is not None:
            given[each] = ARGUMENTS[role]
    for text, words in _further_arguments(kind, {*given.values()}):
        given |= {each: text for each in names if each not in given and word_of(each) in words}
    if kind != FIELD:
        given = {each: "0.0" if text == "t" else text for each, text in given.items()}
    if kind == MAP and not {"q", "v"} <= {*given.values()}:
        speeds = [x for x, text in given.items() if text == "v" and word_of(x) not in calling.MOMENTA]  # are no state
        given = {each: "[q, v]" if x in ("q", "v", "y") else x for each, x in given.items() if each not in speeds}
    return {each: given[each] for each in names if each in given}


def _without_role(names: Sequence[str]) -> list[str]:
    """The names of matrices, of a launch, and of what is a slope beside a likelier function: of a and force, the a."""
    likely = calling.ROLES[calling.CARRIED]  # where the function is last
    asked = [each for each in names if role_of(each, (FUNCTION,))]
    slopes = sorted(asked, key=lambda x: likely.index(word_of(x)) if word_of(x) in likely else len(likely))[:-1]
    return [*calling.matrices(names), *calling.launch(names), *(each for each in slopes if word_of(each) in likely)]


def _open_roles(kind: str, given: Mapping[str, str]) -> list[str]:
    """The roles of a wrapper's arguments that no name has yet; a state is none beside a position."""
    texts = {*given.values()}
    states = (STATE,) if kind == FIELD else (calling.POSITION, calling.VELOCITY, *[STATE] * ("q" not in texts))
    forced = kind == FORCE and any("force" in text for text in texts)
    roles = (*[FUNCTION] * (not forced), STEP, calling.TIME, *states)
    return [role for role in roles if ARGUMENTS[role] not in texts]


def _further_arguments(kind: str, texts: Collection[str]) -> Iterator[tuple[str, Collection[str]]]:
    """Yield what a name of no role is given beside these texts, each with the words for it."""
    if kind == FIELD:
        sized = "h" in texts
        ambiguous = {"a", "b", "alpha"} if sized else set()  # are the ends and the start of a run
        ends = {"y": calling.STARTS, "t": calling.RUN_ENDS[0], "t + h": calling.RUN_ENDS[1]}
        yield from ((text, {*words} - ambiguous) for text, words in ends.items() if text not in texts)
        if not sized:
            yield "1", calling.COUNTS
    yield "()", _PARAMETERS
    if kind == FORCE and any("force" in text for text in texts):
        yield "force(q)", calling.ROLES[calling.CARRIED]
    if kind != FIELD:
        yield "1.0", calling.UNIT_PARAMETERS if kind == MAP else calling.MASSES


def function_of(kind: str) -> str:
    """The name that a wrapper of this kind has for the function that it is given."""
    return "f" if kind == FIELD else "force"


def name_of(step: Callable[..., Any]) -> str:
    """The name by which a wrapper calls the code."""
    name = str(getattr(step, "__qualname__", type(step).__name__)).rpartition("<locals>.")[2]
    if inspect.ismethod(step) and not inspect.isclass(step.__self__):
        name = f"made.{step.__name__}"
    return name if all(part.isidentifier() for part in name.split(".")) else "step"


def call_by_names(step: Callable[..., Any], names: Sequence[str], given: Mapping[str, str]) -> str:
    """The call with what is given for each name, by place if that is the names' own order.

    What stands for a call of several statements is `written` by itself, those before the call between ‹ and ›.
    """
    if hasattr(step, "written"):
        return str(step.written(*(given[each] for each in names)))
    by_place = [*(calling.parameters_of(step) or ())][: len(names)] == [*names]  # a step size with a default may not be
    passed = [f"{'' if by_place else f'{each}='}{given[each]}" for each in names]
    plain = ".py_func" if hasattr(step, "py_func") and not {"f", "force"}.isdisjoint(given.values()) else ""
    return f"{name_of(step)}{plain}({', '.join(passed)})"  # compiled code calls no function of Python


def later_arguments(given: Mapping[str, str], **of_last: str) -> dict[str, str]:
    """What step i of a run is given in place of the start."""
    of_last = {"t": "t + i * h", "y": "ys[-1]", "[q, v]": "ys[-1]"} | of_last
    return {each: of_last.get(text, text) for each, text in given.items()}
