"""Wrappers of classes and of makers of steppers, ready to paste: an object is made for each step, or for each run."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dis import get_instructions
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, FUNCTION, STEP, TIME, required_names, role_of
from driftproof.blackbox.stepper.wrappers import wrapper_parts as common
from driftproof.blackbox.stepper.wrappers.asked_functions import CONTROL_INPUTS
from driftproof.blackbox.stepper.wrappers.wrapper_parts import arguments_by_role, defined, name_of, plain_role

# The usual names of a method that makes a step.
ADVANCES = ("step", "update", "advance", "integrate", "move", "tick", "do_step")
# The attributes, in small letters, by which an object is given its force; and the coordinates besides the first.
PUSHED = ("ax", "acc", "accel", "acceleration", "a", "force", "f", "fx")
_ASIDE = ("y", "z", "vx", "vy", "vz", "ay", "az")
# A right-hand side that is given inputs after its state.
_OF_STATE = "lambda y, *rest: f(y)"
# The state from which an object of each kind is tried.
_START: dict[str, tuple[Any, ...]] = dict.fromkeys((FORCE, calling.MAP), (1.0, 0.5))
_START[FIELD] = (np.array([1.0, 0.5]),)
# Within this many steps a multistep method shows that it remembers, whatever its start: none in use remembers more.
_TRIED = 12


class Made(NamedTuple):
    """A stepper that is made first: its kind, what makes it, and the arguments of that and of the step in the wrapper.

    `kept` are the attributes that hold its state, if it keeps one; `puts` are what is put into attributes. What the
    wrapper does is seen by running its parts.
    """

    kind: str
    make: Callable[..., Any]
    arguments: Mapping[str, str]
    call: Mapping[str, str]
    method: str = ""
    kept: Sequence[str] = ()
    puts: Mapping[str, str] = {}

    @property
    def given(self) -> set[str]:
        """What is given to what makes it, to its step, or is put into its attributes."""
        return {*self.arguments.values(), *self.call.values(), *self.puts.values()}

    @property
    def begin(self) -> str:
        """The statements that make it, and put what is put into its attributes."""
        return "; ".join(filter(None, [f"made = {self._making}", self._putting]))

    @property
    def once(self) -> str:
        """The call that makes a step."""
        return f"made{self.method}({', '.join(self.call.values())})"

    @property
    def _making(self) -> str:
        return f"{name_of(self.make)}({', '.join(self.arguments.values())})"

    @property
    def _putting(self) -> str:
        return f"{made_places(self.puts)} = {', '.join(self.puts.values())}" if self.puts else ""

    def line(self) -> str:
        """The wrapper of one step; for a stepper that remembers, that of n steps, which do not start anew."""
        if self._remembers():
            return self._of_run()
        if self.kept:
            return defined(self.kind, self.begin, self.once, f"return {made_places(self.kept)}")
        if self.puts:
            return defined(self.kind, self.begin, f"return {self.once}")
        return defined(self.kind, f"return {self._making}{self.once.removeprefix('made')}")

    def _of_run(self) -> str:
        """The wrapper of n steps of one object."""
        if not (self.kept or self.arguments or self.puts):  # its steps may have several lengths
            return f"wrapped = {self._making}{self.method}"
        begun, of_field = self, self.kind == FIELD
        if self.kept:
            # What is kept may be changed in place, and so may be what it is given.
            copied = f"[*{made_places(self.kept)}]" if of_field else f"({made_places(self.kept, '1.0 * ')})"
            later = f"({self.once}, {copied})[1]"
            copies = {} if of_field else {"q": "1.0 * q", "v": "1.0 * v"}
            begun = self._replace(arguments={x: copies.get(text, text) for x, text in self.arguments.items()})
        else:
            later = self._replace(call=common.later_arguments(self.call, q="ys[-1][0]", v="ys[-1][1]")).once
        return common.run_of_steps(self.kind, "y" if of_field else "(q, v)", later, begun.begin)

    def new(
        self, t: float = 0.0, state: Sequence[Any] = (), function: Callable[..., Any] | None = None
    ) -> dict[str, Any]:
        """The names in the wrapper when its object is made, and the function that it is given."""
        names = scope_of(self.make) | {text: None for text in self.given if text.isidentifier() and text.isupper()}
        # Of the time, too, where it is given.
        names |= {"h": 0.25, **dict.fromkeys(("f", "force"), function or (lambda *x: x[0] - 0.5 * x[-1]))}
        return self._done(names, state or _START[self.kind], t, self.begin)

    def _done(self, names: dict[str, Any], state: Sequence[Any], t: float, statements: str) -> dict[str, Any]:
        """The names after some statements of the wrapper in a state."""
        names |= {"t": t} | dict(zip("y" if self.kind == FIELD else "qv", map(copy, state), strict=True))
        exec(statements, names)
        return names

    def stepped(self, names: dict[str, Any], state: Sequence[Any] = (), t: float = 0.0) -> tuple[Any, ...]:
        """The state that is left or returned after a step of what was made."""
        left = f"found = {made_places(self.kept)}" if self.kept else ""
        made = "; ".join(filter(None, [self._putting, f"found = {self.once}", left]))
        found = self._done(names, state or _START[self.kind], t, made)["found"]
        return tuple(map(copy, [found] if self.kind == FIELD else found))

    def moves_by(self) -> bool:
        """True if it stands still, or goes straight on, where nothing is pushed, and is moved by what pushes it."""
        with suppress(Exception):
            pushes = (lambda *x: 0.0 * max(x, key=np.size)), (lambda *x: 0.0 * max(x, key=np.size) + 1.0)
            still, moved = (np.ravel(self.stepped(self.new(function=pushed))) for pushed in pushes)
            first = np.ravel(_START[self.kind])
            right = np.array_equal(still, first) if self.kind == FIELD else still[1] == first[1]
            return bool(right and still[1] != moved[1] and (self.kind == FIELD or not self._remembers()))
        return False

    def _remembers(self) -> bool:
        """True if steps change more than its state and its time, or are not those of a new stepper in the same state.

        What an object changes besides does not count where its state is put. It is False if no step can be made.
        """
        with suppress(Exception):
            names, state = self.new(), _START[self.kind]
            before = {each: repr(x) for each, x in getattr(names["made"], "__dict__", {}).items()}
            for i in range(_TRIED):
                found, anew = (self.stepped(each, state, i / 4) for each in (names, self.new(i / 4, state)))
                if not np.array_equal(np.array(found), np.array(anew)):
                    return True
                state = found
            after = getattr(names["made"], "__dict__", {}).items()
            changed = {each for each, x in after if repr(x) != before.get(each)}
            put = self.kept and {each.partition(".")[0] for each in self.kept} <= self.puts.keys()
            return not put and bool(changed - {*self.kept, attribute_of(names["made"], TIME)})
        return False

    def fitted(self) -> Made:
        """Itself; or made for as many numbers as the state has, or from an object with the method that it calls."""
        try:
            self.stepped(self.new())
        except Exception as failure:
            texts, function = {"1": "len(y)"} if self.kind == FIELD else {}, common.function_of(self.kind)
            if isinstance(failure, AttributeError) and callable(failure.obj):
                texts = {function: f'type("Made", (), {{"{failure.name}": staticmethod({function})}})'}
            other = self._replace(arguments={each: texts.get(text, text) for each, text in self.arguments.items()})
            with suppress(Exception):
                other.stepped(other.new())
                return other
        return self


def made_places(attributes: Iterable[str], by: str = "") -> str:
    """The attributes of what is made as a text, each after `by`."""
    return ", ".join(f"{by}made.{each}" for each in attributes)


def function_argument(cls: type) -> str:
    """The argument of a class by which its objects are given the function that they call; "" if there is none."""
    return next((each for each in required_names(cls) or () if plain_role(each) == FUNCTION), "")


def attribute_of(made: Any, role: str) -> str:
    """The public attribute of an object with one of the role's names; "" if there is none."""
    named = {} if inspect.isclass(made) else attributes_of(made)
    found = next((name for name in named if not name.startswith("_") and role_of(name, (role,))), "")
    return f"{found}.x" if found and hasattr(named[found], "x") and hasattr(named[found], "y") else found


def mass_of(made: Any) -> str:
    """The attribute of an object that holds a mass other than 1, by which it divides forces; "" if there is none."""
    known = attributes_of(made).items()
    numbers = [each for each, x in known if isinstance(x, int | float) and x != 1]
    return next((each for each in numbers if calling.word_of(each) in calling.MASSES), "")


def unit_masses(cls: type) -> dict[str, str]:
    """What sets masses, or inverse ones, that a class has by default and that are not 1 to 1, as further arguments."""
    given = [x.name for x in (calling.parameters_of(cls) or {}).values() if x.default not in (x.empty, 1)]
    heavy = (*calling.MASSES, *calling.INVERSE_MASSES)
    return {each: f"{each}=1.0" for each in given if calling.word_of(each) in heavy}


def attributes_of(made: Any) -> dict[str, Any]:
    """The attributes of an object by name, those in slots as well."""
    slots = [each for cls in type(made).__mro__ for each in getattr(cls, "__slots__", ()) if hasattr(made, each)]
    return {each: getattr(made, each) for each in slots} | getattr(made, "__dict__", {})


def public_methods(cls: type) -> list[str]:
    """The names of a class's methods that are for others."""
    return [each for each in dir(cls) if not each.startswith("_") and inspect.isfunction(getattr(cls, each))]


def names_taken(cls: type, method: str) -> list[str]:
    """The names of what a method of a class is given besides its object, with a step size that has a default."""
    return (calling.names_with_step(getattr(cls, method, int)) or [])[1:]


def owner_of(step: Callable[..., Any]) -> Callable[..., Any]:
    """The class of which this function is a method, found by the name it has in its module; otherwise the function."""
    path = getattr(step, "__qualname__", "").split(".")[:-1]
    found: Any = sys.modules.get(getattr(step, "__module__", ""))
    for name in path if inspect.isfunction(step) else ():
        found = getattr(found, name, None)
    return found if inspect.isclass(found) else step


def scope_of(step: Callable[..., Any]) -> dict[str, Any]:
    """The names that a wrapper may use where it is pasted: those of the code's module, and of the code itself."""
    made = getattr(step, "__self__", None)
    owner = owner_of(step) if made is None or inspect.isclass(made) else type(made)
    parts = [*vars(owner).values()] if inspect.isclass(owner) else [owner]
    module = next((each.__globals__ for each in parts if hasattr(each, "__globals__")), {})
    return {**module, name_of(owner): owner, "made": made, name_of(step): step}


def class_wrapper(cls: type, own: str) -> str:
    """The wrapper of a class made from f, whose method takes and returns the state or whose object keeps it."""
    if (made := _by_names(cls, own)) is None:
        return ""
    state = {"y"} if made.kind == FIELD else {"q", "v"}
    returns = state <= {*made.call.values()} or "[q, v]" in made.call.values()
    if returns:
        made = made.fitted()
    with suppress(Exception):
        kept = made.new()["made"]
        roles = (calling.POSITION, calling.VELOCITY) if made.kind == FORCE else (calling.STATE,)
        places = [] if returns else [attribute_of(kept, role) for role in roles]
        texts = {TIME: "t", STEP: "h"} if made.kind == FIELD else {STEP: "h"}
        puts = {attribute_of(kept, role): text for role, text in texts.items() if text not in made.given}
        puts.pop("", None)
        if returns or (all(places) and state <= {*made.arguments.values()}):
            return made._replace(kept=places, puts=puts).line()
    return made.line() if returns else ""


def _by_names(cls: type, own: str) -> Made | None:
    """A class with its method as the names of all arguments tell; None if they do not, or none is a function."""
    names, taken = required_names(cls) or [], names_taken(cls, own)
    with_size = calling.names_with_step(cls) or []  # where a class is made with a step size that has a default
    if STEP not in map(plain_role, taken) and [*(calling.parameters_of(cls) or ())][: len(with_size)] == with_size:
        names = with_size
    kind = common.kind_by_names((*names, *taken))
    given, call = (arguments_by_role(each, kind) for each in (names, taken))
    inputs = {each for each in taken if each not in call}
    if kind == FIELD and inputs and inputs <= {*CONTROL_INPUTS}:  # which a step hands on to its function
        given = {each: _OF_STATE if text == "f" else text for each, text in given.items()}
        call = {each: call.get(each, "None") for each in taken}
    if kind == FORCE and {*call.values()} - {"h"} == {"q"}:  # of one argument, that is all of the state
        call = {each: "[q, v]" if text == "q" else text for each, text in call.items()}
    made, functions = (
        Made(kind, cls, given, call, f".{own}" * (own != "__call__")),
        {common.function_of(kind), _OF_STATE},
    )
    if len(given) < len(names) or len(call) < len(taken) or not functions & made.given:
        return None
    return made._replace(arguments={**given, **unit_masses(cls)}) if kind == FORCE else made


def put_wrapper(cls: type, made: Any, advance: str) -> str:
    """The wrapper of an object that is made for each step, and given its state, its step size and its force.

    What is given replaces a method that is its force or its right-hand side, or an attribute that holds its force. It
    is "" unless the object is seen to move by what is given, and by nothing else.
    """
    return next((each.line() for each in _put(cls, made, advance) if each.moves_by()), "")


def _put(cls: type, made: Any, advance: str) -> Iterator[Made]:
    """Yield the object with its state put into it, and what may be its force or its right-hand side."""
    kept = vars(made) if hasattr(made, "__dict__") and not inspect.isclass(made) else {}
    makes = required_names(cls) or []
    roles = (calling.POSITION, calling.VELOCITY, calling.STATE, STEP, TIME)
    q, v, state, size, time = (attribute_of(made, role).partition(".")[0] for role in roles)
    if not inspect.isfunction(getattr(cls, advance, None)) or function_argument(cls) or not (state or (q and v)):
        return
    vector = next((type(x).__name__ for x in kept.values() if hasattr(x, "x") and hasattr(x, "y")), "")
    kind, parts = FORCE if q and v else FIELD, ("q", "v", "force(q)") if vector else ()
    held: Callable[[str], str] = lambda text: f"{vector}({text}, 0.0)" if text in parts else text
    taken, replaced = names_taken(cls, advance), _functions_of(cls)
    call, start = (arguments_by_role(each, kind) for each in (taken, makes))
    start = {each: held(start.get(each, "0.0" if each.lower() in _ASIDE else "1.0")) for each in makes}
    pushed = [each for each in kept if each.lower() in PUSHED and kind == FORCE]
    # An input is None, if it is only handed on; the object has its state.
    without = {each: "None" if call.get(each, "y") == "y" else call[each] for each in taken}
    calls = [without, *[call] * (without != call and len(call) == len(taken))]
    places = [f"{each}{'.x' * bool(vector)}" for each in ((q, v) if kind == FORCE else (state,))]
    for name, call in product((*replaced, *pushed), calls):
        function = _replacing(replaced[name], kind, q, "None" in call.values()) if name in replaced else "force(q)"
        timed = any(role_of(each, (TIME,)) for each in replaced.get(name, ()))
        puts = {mass_of(made): "1.0", q: "q", v: "v"} if kind == FORCE else {state: "y", time * timed: "t"}
        puts = {each: held(text) for each, text in (puts | {size: "h", name: function}).items() if each}
        yield Made(kind, cls, start, call, f".{advance}", places, puts)


def _functions_of(cls: type) -> dict[str, list[str]]:
    """The methods of a class that are called as a function is, with the names that each takes.

    One that sets attributes, as of an integral that it advances, is a part of the step.
    """
    found = [each for each in public_methods(cls) if role_of(each, (FUNCTION,))]
    found = [each for each in found if all(x.opname != "STORE_ATTR" for x in get_instructions(getattr(cls, each)))]
    return {each: (required_names(getattr(cls, each)) or [])[1:] for each in found}


def _replacing(names: Sequence[str], kind: str, q: str, handed_on: bool) -> str:
    """What is put in place of a method with these arguments, which may be `handed_on` inputs after the state."""
    told = (calling.POSITION, calling.VELOCITY, TIME)
    if kind == FORCE and not names:
        return f"lambda: force(made.{q})"
    if kind == FORCE:
        return "force" if all(role_of(each, told) for each in names) else "lambda q, *rest: force(q)"
    if handed_on:
        return "lambda t, y, *rest: f(t, y)" if names and role_of(names[0], (TIME,)) else _OF_STATE
    return "f"


def maker_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function that makes a stepper from a right-hand side, from a step size, or from both."""
    names = required_names(step) or []
    made: Callable[..., Any] | None = None
    with suppress(Exception):
        made = step(*(0.25 if plain_role(each) == STEP else (lambda *x: x[-1]) for each in names))
    inner = required_names(made) if callable(made) else None
    if not inner:
        return ""
    kind = common.kind_by_names((*names, *inner))
    arguments = {each: "h" if plain_role(each) == STEP else common.function_of(kind) for each in names}
    given = {each: each.upper() for each in inner} | arguments_by_role(inner, kind)
    return Made(kind, step, arguments, given).line()


def clock_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of an object with a clock of its own, which is set; if none is found, what to do."""
    if clock := attribute_of(getattr(step, "made", None), TIME):
        return f'; write time="{clock}" in the call of field_stepper_of'
    owner = getattr(step, "__self__", step)
    cls, method = type(owner), f".{step.__name__}" if inspect.ismethod(step) else ""
    if not (clock := attribute_of(owner, TIME)):
        return ": let the time be an argument, or make the step anew each time"
    given = {each: each.upper() for each in required_names(cls) or ()}
    call = arguments_by_role(required_names(step) or (), FIELD)
    return f"; write: {Made(FIELD, cls, given, call, method, puts={clock: 't'}).line()}"
