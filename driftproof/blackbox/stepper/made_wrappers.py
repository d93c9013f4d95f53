"""Wrappers of steppers that are made first, ready to paste: from a class, or by a function that makes steppers."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from driftproof.blackbox.stepper import wrapper_parts as common
from driftproof.blackbox.stepper.asked_functions import CONTROL_INPUTS
from driftproof.blackbox.stepper.calling_conventions import (
    FIELD,
    FORCE,
    FUNCTION,
    MAP,
    POSITION,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    names_with_step,
    parameters_of,
    required_names,
)
from driftproof.blackbox.stepper.class_wrappers import (
    attribute_of,
    class_run_wrapper,
    function_argument,
    public_methods,
)
from driftproof.blackbox.stepper.kept_state_wrappers import ADVANCES, advance_of, kept_state_wrapper

# A right-hand side that is given inputs after its state.
_OF_STATE = "lambda y, *rest: f(y)"
_START = {FIELD: (np.array([1.0, 0.5]),), FORCE: (1.0, 0.5), MAP: (1.0, 0.5)}
# Within this many steps a multistep method shows that it remembers, whatever its start: none in use remembers more.
_TRIED = 12


def object_wrapper(step: Callable[..., Any], own: bool = False) -> str:
    """The wrapper of a class, or of a method that takes the step size alone; "" if no state is found.

    If its `own` system is to be judged, nothing of it is replaced.
    """
    if inspect.isclass(step):
        advance = advance_of(step) or "step"
        made, whole = _made_anyhow(step), class_run_wrapper(step)
        once = whole * whole.startswith("identify_solver") or _class_wrapper(step) or whole or _own_step(step)
        return once or kept_state_wrapper(step, made, advance, own)
    made, names = getattr(step, "__self__", None), required_names(step)
    if made is None or names is None or [*map(common.plain_role, names)] not in ([STEP], []):
        return ""
    cls = type(made)
    taken = function_argument(cls) and _class_wrapper(cls, step.__name__)
    return taken or kept_state_wrapper(cls, made, step.__name__, own)


def _own_step(cls: type) -> str:
    """The method of an object of the class that is a step already, of the state and a function or of q and v."""
    for each in (name for name in ADVANCES if hasattr(cls, name)):
        roles = {common.plain_role(name) for name in names_with_step(getattr(cls, each)) or ()}
        if {STEP, POSITION, VELOCITY} <= roles or ({STEP, FUNCTION} <= roles and roles & {STATE, POSITION}):
            given = ", ".join(name.upper() for name in required_names(cls) or ())
            return f"wrapped = {common.name_of(cls)}({given}).{each}{f'  # write values for {given}' if given else ''}"
    return ""


def _made_anyhow(cls: type) -> Any:
    """An object of the class, made with trial values, or a function, for each argument; else the class itself."""
    given = common.arguments_by_role(names := required_names(cls) or [], FIELD)
    for known in (given, {}):
        with suppress(Exception):
            return cls(*[common.TRIAL_ARGUMENTS.get(known.get(each, ""), lambda *x: 0.0) for each in names])
    return cls


def _class_wrapper(cls: type, own: str | None = None) -> str:
    """The wrapper of a class made from f, whose method takes and returns the state or whose object keeps it."""
    names = required_names(cls) or []
    ways = (each for base in cls.__mro__ for each in (*ADVANCES, "__call__") if each in vars(base))
    own = own or next(ways, None) or _only_step(cls)  # that of the class itself before that of a base
    taken = names_with_step(getattr(cls, own)) if own else None
    if not taken:
        return ""
    method = "" if own == "__call__" else f".{own}"
    if sum(map(common.is_before, names)) == 1:
        return _two_step_wrapper(cls, method, names, taken[1:])
    with_size = names_with_step(cls) or []  # where a class is made with a step size that has a default, it is given
    if STEP not in map(common.plain_role, taken) and [*(parameters_of(cls) or ())][: len(with_size)] == with_size:
        names = with_size
    kind = common.kind_by_names((*names, *taken))
    kind = FORCE if common.takes_force(names) and POSITION in map(common.plain_role, taken) else kind
    made = _Made(kind, cls, common.arguments_by_role(names, kind), common.arguments_by_role(taken[1:], kind), method)
    inputs = [each for each in taken[1:] if each not in made.call]
    if kind == FIELD and inputs and {*inputs} <= {*CONTROL_INPUTS}:  # which a step hands on to its function
        takes = {each: _OF_STATE if text == "f" else text for each, text in made.arguments.items()}
        made = made._replace(arguments=takes, call={each: made.call.get(each, "None") for each in taken[1:]})
    if kind == FORCE and {*made.call.values()} - {"h"} == {"q"}:  # of one argument, that is all of the state
        made = made._replace(call={x: "[q, v]" if text == "q" else text for x, text in made.call.items()})
    given, called = {"f" if x == _OF_STATE else x for x in made.arguments.values()}, {*made.call.values()}
    if (
        len(made.arguments) < len(names)
        or len(made.call) < len(taken) - 1
        or common.function_of(kind) not in given | called
    ):
        return ""
    if made.state <= called or "[q, v]" in called:
        made = made.fitted()
        with suppress(Exception):
            clock = attribute_of(made.new(_START[kind], 0.0), TIME) if "t" not in given | called else ""
            made = made._replace(time=clock if made.state <= called else "")
        return made.line()
    with suppress(Exception):
        kept = made.new(_START[kind], 0.0)
        places = [attribute_of(kept, role) for role in ((POSITION, VELOCITY) if kind == FORCE else (STATE,))]
        time = attribute_of(kept, TIME) if "t" not in given else ""
        size = attribute_of(kept, STEP) if "h" not in given | called else ""
        return made._replace(kept=places, time=time, size=size).line() if all(places) and made.state <= given else ""
    return ""


def _only_step(cls: type) -> str:
    """The only method of a class that takes a state and a step size; "" if there are none, or several."""
    roles = {each: {*map(common.plain_role, names_with_step(getattr(cls, each)) or ())} for each in public_methods(cls)}
    found = [each for each, held in roles.items() if STEP in held and held & {POSITION, STATE}]
    return found[0] if len(found) == 1 else ""


def clock_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of an object with a clock of its own, which is set; if none is found, what to do."""
    if clock := attribute_of(getattr(step, "made", None), TIME):
        return f'; write time="{clock}" in the call of field_stepper_of'
    owner = getattr(step, "__self__", step)
    cls, method = type(owner), f".{step.__name__}" if inspect.ismethod(step) else ""
    if not (clock := attribute_of(owner, TIME)):
        return ": let the time be an argument, or make the step anew each time"
    given = {each: each.upper() for each in required_names(cls) or ()}
    call = common.arguments_by_role(required_names(step) or (), FIELD)
    return f"; write: {_Made(FIELD, cls, given, call, method, time=clock).line()}"


def _two_step_wrapper(cls: type, method: str, names: Sequence[str], taken: Sequence[str]) -> str:
    """The run of an object made from its state and the one before, which it keeps; "" if they are not seen."""
    kind = FORCE if common.takes_force((*names, *taken)) else FIELD
    (before,) = filter(common.is_before, names)
    given, call = (common.arguments_by_role([x for x in some if x != before], kind) for some in (names, taken))
    given[before], now = (common.BEFORE, "q") if kind == FORCE else ("y", common.FIRST_STEP_UNTIMED)
    tried = {**common.TRIAL_ARGUMENTS, common.BEFORE: 0.75, now: common.TRIAL_ARGUMENTS["y"] if kind == FIELD else 1.0}
    given = {each: now if x == "y" and each != before else x for each, x in given.items()}
    with suppress(Exception):
        made = cls(*[tried[given[each]] for each in names])
        kept = attribute_of(made, POSITION if kind == FORCE else STATE)
        getattr(made, method[1:] or "__call__")(*[tried[call[each]] for each in taken])
        begin = f"made = {cls.__name__}({', '.join(given[each] for each in names)}); "
        step = f"made{method}({', '.join(call[each] for each in taken)})"
        if kept and kind == FORCE:
            later, found = f"({step}, 1.0 * made.{kept})[1]", common.WITH_SPEEDS.format("ys", "ys[1:]")
            return common.run_of_steps(common.HEADS[kind], "q", later, begin, found=found)
        if kept:
            return common.run_of_steps("f, y, h", f"y, [*made.{kept}]", f"({step}, [*made.{kept}])[1]", begin, first=1)
    return ""


def owner_of(step: Callable[..., Any]) -> Callable[..., Any]:
    """The class of which this function is a method, found by the name it has in its module; otherwise the function."""
    path = getattr(step, "__qualname__", "").split(".")[:-1]
    found: Any = sys.modules.get(getattr(step, "__module__", ""))
    for name in path if inspect.isfunction(step) else ():
        found = getattr(found, name, None)
    return found if inspect.isclass(found) else step


def maker_wrapper(step: Callable[..., Any]) -> str:
    """The wrapper of a function that makes a stepper from a right-hand side, from a step size, or from both."""
    names = required_names(step) or []
    made: Callable[..., Any] | None = None
    with suppress(Exception):
        made = step(*(0.25 if common.plain_role(each) == STEP else (lambda *x: x[-1]) for each in names))
    inner = required_names(made) if callable(made) else None
    if not inner:
        return ""
    kind = common.kind_by_names((*names, *inner))
    arguments = {each: "h" if common.plain_role(each) == STEP else common.function_of(kind) for each in names}
    given = {each: each.upper() for each in inner} | common.arguments_by_role(inner, kind)
    return _Made(kind, step, arguments, given).line()


class _Made(NamedTuple):
    """A stepper that is made first: its kind, what makes it, and the arguments of that and of the step in the wrapper.

    `kept` are the attributes that hold its state, if it keeps one, `time` and `size` those of its time and step size.
    """

    kind: str
    make: Callable[..., Any]
    arguments: dict[str, str]
    call: dict[str, str]
    method: str = ""
    kept: Sequence[str] = ()
    time: str = ""
    size: str = ""

    @property
    def state(self) -> set[str]:
        return {"y"} if self.kind == FIELD else {"q", "v"}

    def line(self) -> str:
        """The wrapper of one step; for a stepper that remembers, that of n steps, which do not start anew."""
        timed = self.kind != FIELD or self.time or "t" in (*self.arguments.values(), *self.call.values())
        head = common.HEADS[self.kind] if timed else "f, y, h"
        made, call = f"{common.name_of(self.make)}({', '.join(self.arguments.values())})", ", ".join(self.call.values())
        begin = f"made = {made}; {f'made.{self.time} = t; ' if self.time else ''}"
        begin += f"made.{self.size} = h; " * bool(self.size)
        left, once = ", ".join(f"made.{each}" for each in self.kept), f"made{self.method}({call})"
        if not self._carries():
            ends = f"{once}; return {left}" if left else f"return {once}"
            return f"def wrapped({head}): {f'{begin}{ends}' if left or self.time else f'return {made}{once[4:]}'}"
        if not (left or self.arguments or self.time) and self._alone():  # whose steps may have several lengths
            return f"wrapped = {made}{self.method}"
        arguments = common.later_arguments(self.call, q="ys[-1][0]", v="ys[-1][1]").values()
        later = f"made{self.method}({', '.join(arguments)})"
        if left:
            copied = ", ".join(f"1.0 * made.{each}" for each in self.kept)  # what is kept may be changed in place
            later = f"({once}, {f'[*{left}]' if self.kind == FIELD else f'({copied})'})[1]"
            copies = {"q": "1.0 * q", "v": "1.0 * v"} if self.kind == FORCE else {}  # so may be what it is given
            given = ", ".join(copies.get(each, each) for each in self.arguments.values())
            begin = begin.replace(made, f"{common.name_of(self.make)}({given})", 1)
        return common.run_of_steps(head, "y" if self.kind == FIELD else "(q, v)", later, begin)

    def _alone(self) -> bool:
        """True if the object itself is a step: it looks back at its steps, or goes on from any state as a new one."""
        with suppress(Exception):
            made, state = self.new(_START[self.kind], 0.0), _START[self.kind]
            for i in range(_TRIED):
                found, anew = (self.stepped(each, state, i / 4) for each in (made, self.new(state, i / 4)))
                if not np.array_equal(np.array(found), np.array(anew)):
                    return True
                state = found
            on, anew = (self.stepped(each, _START[self.kind], 0.0) for each in (made, self.new(_START[self.kind], 0.0)))
            return bool(np.array_equal(np.array(on), np.array(anew)))
        return False

    def fitted(self) -> _Made:
        """Itself; or made for as many numbers as the state has, or from an object with the method that it calls."""
        start, function = _START[self.kind], common.function_of(self.kind)
        try:
            self.stepped(self.new(start, 0.0), start, 0.0)
        except Exception as failure:
            texts = {"1": "len(y)"} if self.kind == FIELD else {}
            if isinstance(failure, AttributeError) and callable(failure.obj):
                texts = {function: f'type("Made", (), {{"{failure.name}": staticmethod({function})}})'}
            other = self._replace(arguments={each: texts.get(text, text) for each, text in self.arguments.items()})
            with suppress(Exception):
                other.stepped(other.new(start, 0.0), start, 0.0)
                return other
        return self

    def stepped(self, made: Any, state: Sequence[Any], t: float) -> tuple[Any, ...]:
        """The state that is left or returned after a step of what was made."""
        step = getattr(made, self.method[1:]) if self.method else made
        found = step(*self._values(self.call, state, t))
        found = [getattr(made, each) for each in self.kept] if self.kept else found
        return tuple(map(copy, found if self.kept or self.kind != FIELD else [found]))

    def new(self, state: Sequence[Any], t: float) -> Any:
        made = self.make(*self._values(self.arguments, state, t))
        for place, x in ((self.time, t), (self.size, 0.25)):
            if place:
                setattr(made, place, x)
        return made

    def _values(self, names: dict[str, str], state: Sequence[Any], t: float) -> list[Any]:
        known: dict[str, Any] = {"t": t, "h": 0.25, "[q, v]": np.array(state), "1": 1, "len(y)": np.size(state[0])}
        known |= dict.fromkeys(("f", "force"), lambda *x: x[0] - 0.5 * x[-1])  # of the time, too, where it is given
        known[_OF_STATE] = lambda y, *rest: known["f"](y)
        known |= dict(zip("y" if self.kind == FIELD else "qv", map(copy, state), strict=True))
        known |= {name: SimpleNamespace(**{name.split('"')[3]: known["f"]}) for name in names.values() if '"' in name}
        return [known.get(name) for name in names.values()]

    def _carries(self) -> bool:
        """True if steps change more than its state and its time, or are not those of a new stepper in the same state.

        It is False if no step can be made.
        """

        with suppress(Exception):
            state = _START[self.kind]
            made = self.new(state, 0.0)
            before = {each: repr(x) for each, x in getattr(made, "__dict__", {}).items()}
            for i in range(_TRIED):
                found, anew = (self.stepped(each, state, i / 4) for each in (made, self.new(state, i / 4)))
                changed = {each for each, x in getattr(made, "__dict__", {}).items() if repr(x) != before.get(each)}
                changed -= {*self.kept, self.time, attribute_of(made, TIME)}
                if changed or not np.array_equal(np.array(found), np.array(anew)):
                    return True
                state = found
        return False
