"""Wrappers of classes made anew for each step or run: those with a method solve, those whose force can be replaced."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from copy import copy
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
# The state from which an object of each kind is tried.
START: dict[str, tuple[Any, ...]] = dict.fromkeys((calling.FORCE, calling.MAP), (1.0, 0.5))
START[calling.FIELD] = (np.array([1.0, 0.5]),)
# Within this many steps a multistep method shows that it remembers, whatever its start: none in use remembers more.
_TRIED = 12


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
        places = [each for each, text in puts.items() if text in ("q", "v", "y")]
        found = Made(kind, cls, start, call, f".{advance}", places, puts, vector)
        with suppress(Exception):
            if found.moves_by():
                return found.line(timed)
    return ""


class Made(NamedTuple):
    """A stepper that is made first: its kind, what makes it, and the arguments of that and of the step in the wrapper.

    `kept` are the attributes that hold its state, if it keeps one; `puts` are what is put into attributes. If its
    numbers are held in vectors, `vector` is their class. What the wrapper does is seen by running its parts.
    """

    kind: str
    make: Callable[..., Any]
    arguments: Mapping[str, str]
    call: Mapping[str, str]
    method: str = ""
    kept: Sequence[str] = ()
    puts: Mapping[str, str] = {}
    vector: Any = None

    @property
    def state(self) -> set[str]:
        """The names of its state in the wrapper."""
        return {"y"} if self.kind == calling.FIELD else {"q", "v"}

    @property
    def _once(self) -> str:
        return f"made{self.method}({', '.join(self.call.values())})"

    def _begin(self, made: str) -> str:
        """The statements before the step: what is `made`, and what is put into it."""
        names, texts = (", ".join(some) for some in ([f"made.{x}" for x in self.puts], self._held(self.puts)))
        return f"made = {made}; {names} = {texts}; " if self.puts else f"made = {made}; "

    def _held(self, texts: Mapping[str, str]) -> list[str]:
        held = ("q", "v", "force(q)") if self.vector else ()
        return [f"{self.vector.__name__}({text}, 0.0)" if text in held else text for text in texts.values()]

    def line(self, timed: bool | None = None) -> str:
        """The wrapper of one step; for a stepper that remembers, that of n steps, which do not start anew."""
        if timed is None:
            given = (*self.arguments.values(), *self.call.values(), *self.puts.values())
            timed = self.kind != calling.FIELD or "t" in given
        head, name, once = common.HEADS[self.kind] if timed else "f, y, h", common.name_of(self.make), self._once
        made = f"{name}({', '.join(self._held(self.arguments))})"
        left, begin = ", ".join(f"made.{each}{'.x' if self.vector else ''}" for each in self.kept), self._begin(made)
        if not self._carries():
            ends = f"{once}; return {left}" if left else f"return {once}"
            return f"def wrapped({head}): {f'{begin}{ends}' if left or self.puts else f'return {made}{once[4:]}'}"
        if not (left or self.arguments or self.puts):  # its steps may have several lengths
            return f"wrapped = {made}{self.method}"
        arguments = common.later_arguments(self.call, q="ys[-1][0]", v="ys[-1][1]").values()
        later = f"made{self.method}({', '.join(arguments)})"
        if left:
            # What is kept may be changed in place, and so may be what it is given.
            copied = ", ".join(f"1.0 * made.{each}" for each in self.kept)
            later = f"({once}, {f'[*{left}]' if self.kind == calling.FIELD else f'({copied})'})[1]"
            copies = {"q": "1.0 * q", "v": "1.0 * v"} if self.kind == calling.FORCE else {}
            begin = self._begin(f"{name}({', '.join(copies.get(x, x) for x in self.arguments.values())})")
        return common.run_of_steps(head, "y" if self.kind == calling.FIELD else "(q, v)", later, begin)

    def new(self, state: Sequence[Any], t: float, function: Callable[..., Any] | None = None) -> dict[str, Any]:
        """The names in the wrapper when its object is made, and the function that it is given."""
        texts = (*self.arguments.values(), *self.call.values())
        names: dict[str, Any] = {text: None for text in texts if text.isidentifier() and text.isupper()}
        names |= {getattr(self.vector, "__name__", "vector"): self.vector, "make": self.make, "h": 0.25}
        # Of the time, too, where it is given.
        names |= dict.fromkeys(("f", "force"), function or (lambda *x: x[0] - 0.5 * x[-1]))
        self._fill(names, state, t, f"make({', '.join(self._held(self.arguments))})")
        return names

    def _fill(self, names: dict[str, Any], state: Sequence[Any], t: float, made: str = "made") -> None:
        """Put a state and a time into the object."""
        names |= {"t": t} | dict(zip("y" if self.kind == calling.FIELD else "qv", map(copy, state), strict=True))
        exec(self._begin(made), names)

    def stepped(self, names: dict[str, Any], state: Sequence[Any], t: float) -> tuple[Any, ...]:
        """The state that is left or returned after a step of what was made."""
        self._fill(names, state, t)
        exec(f"found = {self._once}", names)
        found = [getattr(names["made"], each) for each in self.kept] if self.kept else names["found"]
        found = [x.x for x in found] if self.vector else found
        return tuple(map(copy, found if self.kept or self.kind != calling.FIELD else [found]))

    def moves_by(self) -> bool:
        """True if it stands still, or goes straight on, where nothing is pushed, and is moved by what pushes it."""
        start = START[self.kind]
        still, moved = (
            np.ravel(self.stepped(self.new(start, 0.0, pushed), start, 0.0))
            for pushed in (lambda *x: 0.0 * max(x, key=np.size), lambda *x: 0.0 * max(x, key=np.size) + 1.0)
        )
        first = np.ravel(start)
        right = np.array_equal(still, first) if self.kind == calling.FIELD else still[1] == first[1]
        return bool(right and still[1] != moved[1] and (self.kind == calling.FIELD or not self._carries()))

    def _carries(self) -> bool:
        """True if steps change more than its state and its time, or are not those of a new stepper in the same state.

        What an object changes besides does not count where its state is put. It is False if no step can be made.
        """
        with suppress(Exception):
            names = self.new(START[self.kind], 0.0)
            before = {each: repr(x) for each, x in getattr(names["made"], "__dict__", {}).items()}
            if self._departs(names):
                return True
            after = getattr(names["made"], "__dict__", {}).items()
            changed = {each for each, x in after if repr(x) != before.get(each)}
            changed -= {*self.kept, attribute_of(names["made"], calling.TIME)}
            return bool(changed) and not self.state <= {*self.puts.values()}
        return False

    def _departs(self, names: dict[str, Any]) -> bool:
        """True if one of some steps of an object is not that of a new one in the same state."""
        state = START[self.kind]
        for i in range(_TRIED):
            found, anew = (self.stepped(each, state, i / 4) for each in (names, self.new(state, i / 4)))
            if not np.array_equal(np.array(found), np.array(anew)):
                return True
            state = found
        return False

    def fitted(self) -> Made:
        """Itself; or made for as many numbers as the state has, or from an object with the method that it calls."""
        start, function = START[self.kind], common.function_of(self.kind)
        try:
            self.stepped(self.new(start, 0.0), start, 0.0)
        except Exception as failure:
            texts = {"1": "len(y)"} if self.kind == calling.FIELD else {}
            if isinstance(failure, AttributeError) and callable(failure.obj):
                texts = {function: f'type("Made", (), {{"{failure.name}": staticmethod({function})}})'}
            other = self._replace(arguments={each: texts.get(text, text) for each, text in self.arguments.items()})
            with suppress(Exception):
                other.stepped(other.new(start, 0.0), start, 0.0)
                return other
        return self
