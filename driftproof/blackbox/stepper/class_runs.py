"""Classes made from a right-hand side that have a method for a whole run, as one function that makes the run."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from itertools import chain
from typing import Any

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.calling_conventions import required_names, role_of
from driftproof.blackbox.stepper.function_wrappers import run_wrapper
from driftproof.blackbox.stepper.made_wrappers import function_argument, public_methods
from driftproof.blackbox.stepper.wrapper_parts import name_of, whole_solver

# The usual names of a method that makes a run.
_RUNS = ("solve", "run", "integrate", "simulate", "propagate", "evolve")


def class_run_wrapper(cls: type) -> str:
    """The wrapper of a class with a method for a run; one with tolerances is a whole solver; "" if none is known."""
    if (run := run_of_class(cls)) is None:
        return ""
    if any(calling.word_of(each) in (*calling.TOLERANCE_NAMES[0], "tol") for each in calling.parameters_of(cls) or ()):
        return whole_solver(cls)
    return run_wrapper(run, required_names(run) or [])


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
            left[:] = (next(x for x in names if role_of(x, (role,))) for role in (calling.GRID, calling.STATE))
            found = tuple(getattr(made, each) for each in left)
        return found

    def written(*texts: str) -> str:
        given = dict(zip(required_names(solve) or (), texts, strict=True))
        lines = [f"made.{each}({', '.join(passed(each, given).values())})" for each in calls]
        lines[0] = lines[0].replace("made.", f"made = {name_of(cls)}", 1)
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
