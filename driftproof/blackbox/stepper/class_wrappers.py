"""Wrappers of classes made anew for each step or run: those with a method solve, those whose force can be replaced."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper import wrapper_parts as common
from driftproof.blackbox.stepper.run_wrappers import run_wrapper

_RUNS = ("solve", "run", "integrate", "simulate", "propagate", "evolve")
# The attributes, in small letters, by which an object is given its force; and the coordinates besides the first.
PUSHED = ("ax", "acc", "accel", "acceleration", "a", "force", "f", "fx")
_ASIDE = ("y", "z", "vx", "vy", "vz", "ay", "az")


def function_argument(cls: type) -> str:
    """The argument of a class by which its objects are given the function that they call; "" if there is none."""
    return next((each for each in calling.required_names(cls) or () if common.plain_role(each) == calling.FUNCTION), "")


def attribute_of(made: Any, role: str) -> str:
    """The public attribute of an object with one of the role's names; "" if there is none."""
    named = {} if inspect.isclass(made) else attributes_of(made)
    found = next((name for name in named if not name.startswith("_") and calling.role_of(name, (role,))), "")
    return f"{found}.x" if found and hasattr(named[found], "x") and hasattr(named[found], "y") else found


def attributes_of(made: Any) -> dict[str, Any]:
    """The attributes of an object by name, those in slots as well."""
    slots = [each for cls in type(made).__mro__ for each in getattr(cls, "__slots__", ()) if hasattr(made, each)]
    return {each: getattr(made, each) for each in slots} | getattr(made, "__dict__", {})


def class_run_wrapper(cls: type) -> str:
    """The wrapper of a class with a method for a run; one with tolerances is a whole solver; "" if none is known."""
    if (run := run_of_class(cls)) is None:
        return ""
    if any(calling.word_of(each) in (*calling.TOLERANCE_NAMES[0], "tol") for each in calling.parameters_of(cls) or ()):
        return f"identify_solver({common.name_of(cls)}), on the command line --solver, for a whole solver"
    return common.stated_first(run_wrapper(run, calling.required_names(run) or []))


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
    methods = {each: getattr(cls, each) for each in public_methods(cls)}
    run = next((each for each in _RUNS if each in methods), "")
    if not run or not function_argument(cls):
        return None
    taken = {each: [*(calling.parameters_of(method) or {}).values()][1:] for each, method in methods.items()}
    rest = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    taken = {each: [x for x in found if x.kind not in rest] for each, found in taken.items()}
    taken[""] = [*(calling.parameters_of(cls) or {}).values()]
    order = ["", run]
    if not _begins(x.name for each in order for x in taken[each]):
        setter = next((x for x in methods if len(taken[x]) == 1 and _begins([taken[x][0].name])), None)
        if setter is None:
            return None
        order.insert(1, setter)
    left: list[str] = []  # the attributes in which a run leaves what it does not return

    def solve(*arguments: Any, **named: Any) -> Any:
        given = inspect.signature(solve).bind(*arguments, **named).arguments
        found = made = cls(**{x.name: given[x.name] for x in taken[""] if x.name in given})
        for each in order[1:]:
            found = getattr(made, each)(**{x.name: given[x.name] for x in taken[each] if x.name in given})
        if found is None:
            new = [each for each in vars(made) if each not in given]
            left[:] = (
                next(each for each in (*new, *given) if calling.role_of(each, (role,)))
                for role in (calling.GRID, calling.STATE)
            )
            found = tuple(getattr(made, each) for each in left)
        return found

    def written(*texts: str) -> str:
        given = dict(zip(calling.required_names(solve) or (), texts, strict=True))
        calls = []
        for each in order:
            arguments = ", ".join(given[x.name] for x in taken[each] if x.name in given)
            calls.append(f"made.{each}({arguments})" if each else f"made = {common.name_of(cls)}({arguments})")
        end = f"({', '.join(f'made.{each}' for each in left)})" if left else calls.pop()
        return f"‹{'; '.join(calls)}›{end}"

    named = {x.name: x.replace(kind=x.POSITIONAL_OR_KEYWORD) for each in order for x in taken[each]}
    made_run: Any = solve
    calling.stand_in(made_run, cls, ())
    made_run.__signature__ = inspect.Signature(sorted(named.values(), key=lambda x: x.default is not x.empty))
    made_run.written = written
    return solve


def public_methods(cls: type) -> list[str]:
    """The names of a class's methods that are for others."""
    return [each for each in dir(cls) if not each.startswith("_") and inspect.isfunction(getattr(cls, each))]


def _begins(names: Iterable[str]) -> bool:
    return any(calling.word_of(each) in (*calling.STARTS, *calling.ROLES[calling.STATE]) for each in names)


def put_wrapper(cls: type, made: Any, advance: str) -> str:
    """The wrapper of an object that is made for each step, and given its state, its step size and its force.

    What is given replaces a method that is its force or its right-hand side, or an attribute that holds its force. It
    is "" unless the object is seen to move by what is given, and by nothing else.
    """
    kept = vars(made) if hasattr(made, "__dict__") and not inspect.isclass(made) else {}
    method, makes = getattr(cls, advance, None), calling.required_names(cls) or []
    q, v, state, size, time = (
        attribute_of(made, x).partition(".")[0]
        for x in (calling.POSITION, calling.VELOCITY, calling.STATE, calling.STEP, calling.TIME)
    )
    if not inspect.isfunction(method) or function_argument(cls) or not (state or (q and v)):
        return ""
    vector = next((type(x) for x in kept.values() if hasattr(x, "x") and hasattr(x, "y")), None)
    kind = calling.FORCE if q and v else calling.FIELD
    taken = (calling.names_with_step(method) or [""])[1:]
    call, start = (common.arguments_by_role(each, kind) for each in (taken, makes))
    start = {each: start.get(each, "0.0" if each.lower() in _ASIDE else "1.0") for each in makes}
    asked = {
        x: (calling.required_names(getattr(cls, x)) or [])[1:]
        for x in public_methods(cls)
        if calling.role_of(x, (calling.FUNCTION,))
    }
    pushed = [each for each in kept if each.lower() in PUSHED and kind == calling.FORCE]
    # An input is None, if it is only handed on; the object has its state.
    without = {each: "None" if call.get(each, "y") == "y" else call[each] for each in taken}
    calls = [without, *[call] * (without != call and len(call) == len(taken))]
    for name, call in product((*asked, *pushed), calls):
        names, function = asked.get(name, []), common.function_of(kind)
        timed = kind == calling.FORCE or any(calling.role_of(each, (calling.TIME,)) for each in names)
        if name not in asked:
            function = "force(q)"
        elif kind == calling.FORCE and not all(
            calling.role_of(each, (calling.POSITION, calling.VELOCITY, calling.TIME)) for each in names
        ):
            function = "lambda q, *rest: force(q)"
        elif kind == calling.FORCE and not names:
            function = f"lambda: force(made.{q})"
        elif kind == calling.FIELD and "None" in call.values():
            function = f"lambda y, *rest: f({'t, ' * timed}y)"
        puts = {q: "q", v: "v"} if kind == calling.FORCE else {state: "y", time * timed: "t"}
        puts = {each: text for each, text in (puts | {size: "h", name: function}).items() if each}
        found = _Put(cls, start, puts, advance, [*call.values()], kind, vector)
        with suppress(Exception):
            if found.moves_by():
                return found.line(common.HEADS[kind] if timed else "f, y, h")
    return ""


class _Put(NamedTuple):
    """An object made anew for each step: what its class takes, what is put into it, and the call that advances it.

    If its numbers are held in vectors, `vector` is their class.
    """

    cls: type
    start: dict[str, str]
    puts: dict[str, str]
    advance: str
    call: Sequence[str]
    kind: str
    vector: Any

    @property
    def places(self) -> list[str]:
        """The attributes with its state."""
        return [each for each, text in self.puts.items() if text in ("q", "v", "y")]

    def line(self, head: str) -> str:
        """The wrapper of a step; of n steps, if an object that has made steps makes others than a new one."""
        numbers = ("q", "v", "force(q)") if self.vector else ()
        write = lambda text: f"{self.vector.__name__}({text}, 0.0)" if text in numbers else text
        begin = f"made = {common.name_of(self.cls)}({', '.join(map(write, self.start.values()))}); "
        begin += f"{', '.join(f'made.{each}' for each in self.puts)} = {', '.join(map(write, self.puts.values()))}; "
        act = f"made.{self.advance}({', '.join(self.call)})"
        if self.kind == calling.FIELD and self.remembers():
            return common.run_of_steps(head, "y", f"({act}, [*made.{self.places[0]}])[1]", begin)
        ends = ", ".join(f"made.{each}{'.x' if self.vector else ''}" for each in self.places)
        return f"def wrapped({head}): {begin}{act}; return {ends}"

    def moves_by(self) -> bool:
        """True if it stands still, or goes straight on, where nothing is pushed, and is moved by what pushes it."""
        start = np.array([1.0, 0.5])
        still, moved = (self.step(self.new(start, pushed)) for pushed in (lambda x: 0.0 * x, lambda x: 0.0 * x + 1.0))
        right = np.array_equal(still, start) if self.kind == calling.FIELD else still[1] == start[1]
        return bool(right and still[1] != moved[1] and (self.kind == calling.FIELD or not self.remembers()))

    def remembers(self) -> bool:
        """True if an object that has made a step makes another one than a new object."""
        made = self.new(np.array([1.0, 0.5]), np.negative)
        state = self.step(made)
        again = self.step(self.filled(made, state, np.negative))
        return not np.array_equal(again, self.step(self.new(state, np.negative)))

    def new(self, state: Any, pushed: Callable[[Any], Any]) -> Any:
        """An object in a state, pushed by a function of the place."""
        values = self._values(state, pushed, None)
        return self.filled(self.cls(*[values[text] for text in self.start.values()]), state, pushed)

    def filled(self, made: Any, state: Any, pushed: Callable[[Any], Any]) -> Any:
        """The object with all that is put into it."""
        values = self._values(state, pushed, made)
        for each, text in self.puts.items():
            setattr(made, each, values.get(text, values["f" if self.kind == calling.FIELD else "force"]))
        return made

    def step(self, made: Any) -> Any:
        """The state of an object after a step, as two numbers."""
        values = self._values([0.0, 0.0], np.negative, made)
        getattr(made, self.advance)(*[values[text] for text in self.call])
        found = [getattr(made, each) for each in self.places]
        return np.array([x.x for x in found] if self.vector else found, float).ravel()

    def _values(self, state: Any, pushed: Callable[[Any], Any], made: Any) -> dict[str, Any]:
        numbers = {"q": float(state[0]), "v": float(state[1]), "force(q)": float(pushed(float(state[0])))}
        held = {each: self.vector(x, 0.0) if self.vector else x for each, x in numbers.items()}
        force = lambda *x: pushed(x[0] if x else getattr(made, self.places[0]))
        field = lambda *x: pushed(np.asarray(max(x, key=np.size), float))
        known = {"h": 0.25, "t": 0.0, "None": None, "0.0": 0.0, "1.0": 1.0, "f": field, "force": force}
        return {**held, **known, "y": np.array(state)}
