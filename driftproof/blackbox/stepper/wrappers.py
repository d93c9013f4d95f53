"""Wrappers of one line, ready to paste, for steppers that cannot be opened as they are."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from driftproof.blackbox.stepper.calling_conventions import (
    COUNTS,
    FIELD,
    FORCE,
    FUNCTION,
    MAP,
    POSITION,
    ROLES,
    RUN_ENDS,
    SPANS,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    has_gradient,
    required_names,
)
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.plain_forms import BODY_LISTS

_ARGUMENTS = {FUNCTION: "f", TIME: "t", STATE: "y", POSITION: "q", VELOCITY: "v", STEP: "h"}
# The arguments of a wrapper of each kind.
_HEADS = {MAP: "q, v, h", FORCE: "force, q, v, h", FIELD: "f, t, y, h"}
_ADVANCES = ("step", "update", "advance", "integrate", "move", "tick", "do_step")
_PUSHES = ("apply_force", "add_force", "apply_central_force", "applyForce", "addForce")
# Gradients of an energy by the positions and by the momenta: H(q, p) = p^2/2 + V(q).
_BY_POSITION = ("dhdq", "dh_dq", "grad_q", "dhdx", "dh_dx", "gradq")
_BY_MOMENTUM = ("dhdp", "dh_dp", "grad_p", "dtdp", "dt_dp", "gradp")
_BEFORE = re.compile("prev|old|last|before|nm1")
# Names of a list of the last states; a method in use looks back at no more than this many.
_LISTS, _MOST_STATES = re.compile("^ys$|^us$|^xs$|states|hist|past|prev"), 7
_SPANS = (*SPANS, "t_bound", "t_end", "tf", "t_final")


def wrapper_line(step: Callable[..., Any]) -> str:
    """The wrapper to write, as the end of an error message; "" if none is known to fit."""
    line = _for_object(step) or ("" if inspect.isclass(step) else _for_function(step))
    return f": {line}" if line else ""


def template(step: Callable[..., Any]) -> str:
    """The shortest wrapper of a class or a function of which no more is known, with words in capitals to replace."""
    name = _name(step)
    if inspect.isclass(step):
        if line := _for_world(step):
            return line
        makes = f"lambda: {name}(...)" if required_names(step) else name
        places = f'position="POSITION", velocity="VELOCITY", advance="{_advance(step) or "STEP"}"'
        return f": from driftproof import stepper_of; wrapped = stepper_of({makes}, {places})  # the attributes' names"
    arguments = ", ".join(name.upper() for name in required_names(step) or ["..."])
    return f": def wrapped(f, t, y, h): return {name}({arguments})  # y at t + h, where y' = f(t, y)"


def _for_world(cls: type) -> str:
    """The wrapper of a class made from a list of bodies alone, of one body of its module; "" if there is no such class.

    A gravity g that the object keeps is where the force is given to it: it acts along y if the bodies have a vy.
    """
    held = next(iter(required_names(cls) or []), "")
    known = getattr(cls.__init__, "__globals__", {})  # type: ignore[misc]
    for name, body in [*known.items()] if held in BODY_LISTS and len(required_names(cls) or []) == 1 else []:
        with suppress(Exception):
            ones = [1.0] * len(required_names(body) or [])
            world, made = cls([body(*ones)]), body(*ones)
            push = next((each for each in ("g", "gravity") if isinstance(getattr(world, each, None), float)), "")
            upright = push and hasattr(made, "y") and hasattr(made, "vy")
            q, v = ("y", "vy") if upright else (_attribute(made, POSITION), _attribute(made, VELOCITY))
            if not (q and v and isinstance(getattr(world, held)[0], body) and isinstance(getattr(made, q), float)):
                continue
            place = f"{{}}=(lambda w: w.{held}[0].{{}}, lambda w, x: setattr(w.{held}[0], '{{}}', x))"
            makes = f"lambda: {cls.__name__}([{name}({', '.join(map(str, ones))})])"
            rest = [
                place.format("position", q, q),
                place.format("velocity", v, v),
                *([f'push="{push}"'] if push else []),
            ]
            options = f'{", ".join(rest)}, advance="{_advance(cls)}"'
            return f": from driftproof import stepper_of; wrapped = stepper_of({makes}, {options})"
    return ""


def uncalled(found: object) -> str:
    """What to hand over in place of an object that cannot be called: a wrapper of its method, or any function."""
    advance = "" if type(found).__module__ == "builtins" else _advance(type(found))
    if advance and (line := wrapper_line(getattr(found, advance)) or template(type(found))):
        return f"; its {advance} makes the step; write{line}"
    return "; hand over a function that makes one step, say: def step(f, t, y, h): return y + h * f(t, y)"


def _advance(cls: type) -> str:
    """The name of the method that makes a step: a usual one, or the only public one that takes one argument or none."""
    public = [each for each in dir(cls) if not each.startswith("_") and inspect.isfunction(getattr(cls, each))]
    alone = [each for each in public if len(required_names(getattr(cls, each)) or ()) in (1, 2)]
    return next((each for each in _ADVANCES if hasattr(cls, each)), alone[0] if len(alone) == 1 else "")


def increment_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that adds the state to a returned increment."""
    name, order = _name(subject.function), subject.convention.order
    head = ", ".join(_ARGUMENTS[role] for role in order if role in _ARGUMENTS)
    if STATE in order:
        return f"; write: def wrapped({head}): return y + {name}({head})"
    return f"; write: def wrapped({head}): dq, dv = {name}({head}); return q + dq, v + dv"


def exchange_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that returns the position before the velocity."""
    name, order = _name(subject.function), subject.convention.order
    head = ", ".join({**_ARGUMENTS, FUNCTION: "force"}[role] for role in order if role in _ARGUMENTS)
    return f"; write: def wrapped({head}): v1, q1 = {name}({head}); return q1, v1"


def turn_wrapper(subject: ForeignStepper) -> str:
    """The wrapper that puts the velocity first in a state of one array, in the argument and in the answer."""
    name, order = _name(subject.function), subject.convention.order
    head = ", ".join(_ARGUMENTS[role] for role in order if role in _ARGUMENTS)
    turned = {FUNCTION: "lambda t, y: turn(f(t, turn(y)))", STATE: "turn(y)"}
    arguments = ", ".join(turned.get(role, _ARGUMENTS[role]) for role in order if role in _ARGUMENTS)
    turn = "import numpy; turn = lambda x: numpy.roll(x, len(x) // 2)"
    return f"; write: def wrapped({head}): {turn}; return turn({name}({arguments}))"


def _name(step: Callable[..., Any]) -> str:
    name = str(getattr(step, "__qualname__", type(step).__name__)).rpartition("<locals>.")[2]
    return name if all(part.isidentifier() for part in name.split(".")) else "step"


def _for_object(step: Callable[..., Any]) -> str:
    """The `stepper_of` line for a class, or for a method that takes the step size alone; "" if no state is found."""
    made: Any = step
    if inspect.isclass(step):
        if line := _for_class(step):
            return line
        cls, advance = step, _advance(step) or "step"
        with suppress(Exception):
            made = cls(*[lambda *x: 0.0 for _ in required_names(cls) or ()])
    else:
        made, names = getattr(step, "__self__", None), required_names(step)
        if made is None or names is None or [*map(_role, names)] not in ([STEP], []):
            return ""
        cls, advance = type(made), step.__name__
    makes = required_names(cls) or []
    q, v, state, time = (_attribute(made, role) for role in (POSITION, VELOCITY, STATE, TIME))
    if not state and not (q and v):
        return ""
    make = cls.__name__ if len(makes) < 2 else f"lambda: {cls.__name__}(...)"
    where, maker = f'position="{q}", velocity="{v}"' if q and v else f'state="{state}"', "stepper_of"
    if not makes and (push := next((each for each in _PUSHES if hasattr(cls, each)), "")):
        of_x = type(getattr(made, q.partition(".")[0], 0.0)).__name__ if q.endswith(".x") else ""
        where += f", push=lambda body, f: body.{push}({of_x}(f, 0.0))" if of_x else f', push="{push}"'
    if [*map(_role, makes)] == [FUNCTION] and not (q and v):
        where, maker = f'{where}, time="{time}"' if time else where, "field_stepper_of"
    return f'from driftproof import {maker}; wrapped = {maker}({make}, {where}, advance="{advance}")'


def _attribute(made: Any, role: str) -> str:
    """The public attribute of an object with one of the role's names; "" if there is none."""
    named = vars(made) if hasattr(made, "__dict__") and not inspect.isclass(made) else {}
    found = next((name for name in named if not name.startswith("_") and _has_role(role, name)), "")
    return f"{found}.x" if found and hasattr(named[found], "x") and hasattr(named[found], "y") else found


def _for_class(cls: type) -> str:
    """The wrapper of a class made from f, whose method takes and returns the state or whose object keeps it."""
    names = required_names(cls) or []
    own = next((each for each in (*_ADVANCES, "__call__") if any(each in vars(base) for base in cls.__mro__)), None)
    taken = required_names(getattr(cls, own)) if own else None
    if not taken:
        return ""
    kind = FORCE if {POSITION, VELOCITY} <= {_role(each) for each in (*names, *taken)} else FIELD
    method = "" if own == "__call__" else f".{own}"
    made = _Made(kind, cls.__name__, _by_role(names, kind), _by_role(taken[1:], kind), method)
    if len(made.arguments) < len(names) or len(made.call) < len(taken) - 1:
        return ""
    if _function(kind) not in made.arguments.values():
        return ""
    if made.state <= {*made.call.values()}:
        return made.line(cls)
    if not made.state <= {*made.arguments.values()}:
        return ""
    with suppress(Exception):
        kept = made.new(cls, _START[kind], 0.0)
        places = [_attribute(kept, role) for role in ((POSITION, VELOCITY) if kind == FORCE else (STATE,))]
        time = _attribute(kept, TIME) if "t" not in made.arguments.values() else ""
        return made._replace(kept=places, time=time).line(cls) if all(places) else ""
    return ""


_START = {FIELD: (np.array([1.0, 0.5]),), FORCE: (1.0, 0.5), MAP: (1.0, 0.5)}
# Within this many steps a multistep method shows that it remembers, whatever its start: none in use remembers more.
_TRIED = 12


class _Made(NamedTuple):
    """A stepper that is made first: its kind, its maker, and the arguments of maker and step by the wrapper's names.

    `kept` are the attributes that hold its state, if it keeps one, and `time` is the attribute with its time.
    """

    kind: str
    maker: str
    arguments: dict[str, str]
    call: dict[str, str]
    method: str = ""
    kept: Sequence[str] = ()
    time: str = ""

    @property
    def state(self) -> set[str]:
        return {"y"} if self.kind == FIELD else {"q", "v"}

    def line(self, make: Callable[..., Any]) -> str:
        """The wrapper of one step; for a stepper that remembers, that of n steps, which do not start anew."""
        timed = self.kind != FIELD or self.time or "t" in (*self.arguments.values(), *self.call.values())
        head = _HEADS[self.kind] if timed else "f, y, h"
        made, call = f"{self.maker}({', '.join(self.arguments.values())})", ", ".join(self.call.values())
        begin = f"made = {made}; {f'made.{self.time} = t; ' if self.time else ''}"
        left, once = ", ".join(f"made.{each}" for each in self.kept), f"made{self.method}({call})"
        if not self._remembers(make):
            return f"def wrapped({head}): " + (f"{begin}{once}; return {left}" if left else f"return {made}{once[4:]}")
        state = "y" if self.kind == FIELD else "(q, v)"
        if left:
            copied = f"[*{left}]" if self.kind == FIELD else f"({left})"
            return f"def wrapped({head}, n): {begin}return [{state}] + [({once}, {copied})[1] for _ in range(n)]"
        of_last = {"t": "t + i * h", "q": "z[0]", "v": "z[1]", "y": "z", "[q, v]": "z"}
        later = f"made{self.method}({', '.join(of_last.get(each, each) for each in self.call.values())})"
        return f"def wrapped({head}, n): {begin}z = {state}; return [z] + [z := {later} for i in range(n)]"

    def new(self, make: Callable[..., Any], state: Sequence[Any], t: float) -> Any:
        made = make(*self._values(self.arguments, state, t))
        if self.time:
            setattr(made, self.time, t)
        return made

    def _values(self, names: dict[str, str], state: Sequence[Any], t: float) -> list[Any]:
        known = {"t": t, "h": 0.25, "[q, v]": np.array(state)}
        known |= dict.fromkeys(("f", "force"), lambda *x: x[0] - 0.5 * x[-1])  # of the time, too, where it is given
        known |= dict(zip("y" if self.kind == FIELD else "qv", map(copy, state), strict=True))
        return [known[name] for name in names.values()]

    def _remembers(self, make: Callable[..., Any]) -> bool:
        """True if some step differs from that of a new stepper in the same state; False if none can be made."""

        def stepped(made: Any, t: float) -> tuple[Any, ...]:
            step = getattr(made, self.method[1:]) if self.method else made
            found = step(*self._values(self.call, state, t))
            found = [getattr(made, each) for each in self.kept] if self.kept else found
            return tuple(map(copy, found if self.kept or self.kind != FIELD else [found]))

        with suppress(Exception):
            state = _START[self.kind]
            made = self.new(make, state, 0.0)
            for i in range(_TRIED):
                found, anew = stepped(made, i / 4), stepped(self.new(make, state, i / 4), i / 4)
                if not np.array_equal(np.array(found), np.array(anew)):
                    return True
                state = found
        return False


def _for_function(step: Callable[..., Any]) -> str:
    """The wrapper of a function: a maker of steppers, a step with gradients of an energy, a solver, or a plain step."""
    names, name = required_names(step), _name(step)
    if names is None:
        return ""
    words = [each.lower().strip("_") for each in names]
    if any(word in _SPANS for word in words) and not any(_has_role(STEP, word) for word in words):
        return f"identify_solver({name}), for a whole solver"
    by_position = next((each for each, word in zip(names, words, strict=True) if word in _BY_POSITION), None)
    by_momentum = next((each for each, word in zip(names, words, strict=True) if word in _BY_MOMENTUM), None)
    if by_position is not None and by_momentum is not None:
        gradients = {by_position: "lambda q, *p: -force(q)", by_momentum: "lambda *p: p[-1]"}
        rest = [each for each in names if each not in gradients]
        return _call(name, names, {**gradients, **_by_role(rest, FORCE)}, FORCE)
    roles = {*map(_role, names)}
    if roles <= {FUNCTION, STEP} and roles:
        return _for_maker(step, names, name)
    of_state = POSITION not in roles or (VELOCITY not in roles and TIME in roles)
    kind = MAP if FUNCTION not in roles else FIELD if of_state else FORCE
    if line := list_wrapper(step):
        return line[2:]
    if not (given := _by_role(names, kind)):
        return ""
    pairs = [*zip(names, words, strict=True)]
    end, count = (next((each for each, word in pairs if word in known), None) for known in (RUN_ENDS[1], COUNTS))
    if kind == FIELD and end is not None and count is not None and "h" not in given.values():
        given |= {end: "t + h", count: "1"}
        return f"{_call(name, names, given, kind)}{_last_state(step, names, given)}"
    return _call(name, names, given, kind)


def list_wrapper(step: Callable[..., Any]) -> str:
    """The run of n steps of a method that takes a list of the last states; "" if no list of up to seven is taken.

    Of y' = 1 every method finds the next state, t + h, if the list is in its own order.
    """
    name, names = _name(step), [] if inspect.isclass(step) else required_names(step) or []
    past = next((each for each in names if _LISTS.search(each.lower())), "")
    given = {past: "ys"} | _by_role([each for each in names if each != past], FIELD)
    if len(given) < len(names) or not {"f", "ys", "h"} <= {*given.values()} <= {"f", "t", "ys", "h"}:
        return ""
    for size, turned in product(range(2, _MOST_STATES + 1), (1, -1)):
        with suppress(Exception):
            ys = [np.array([i / 4, i / 4]) for i in range(1 - size, 1)][::turned]
            values = {"f": lambda *x: np.ones(2), "t": 0.0, "ys": ys, "h": 0.25}
            if np.allclose(step(*[values[given[each]] for each in names]), 0.25, rtol=0, atol=2.0**-20):
                shown = {"ys": "ys[::-1]" if turned < 0 else "ys", "t": "t + i * h"}
                call = f"{name}({', '.join(shown.get(given[each], given[each]) for each in names)})"
                first = "y + h * f(t + h / 2, y + h / 2 * f(t, y))"
                start = f"s = lambda t, y: {first}; ys = [y]"
                later = f"ys.append(s(t + i * h, ys[-1]) if i < {size - 1} else {call}) or ys[-1] for i in range(n)"
                return f": def wrapped(f, t, y, h, n): {start}; return [y, *({later})]  # begins with midpoint2"
    return ""


def _last_state(step: Callable[..., Any], names: Sequence[str], given: dict[Any, str]) -> str:
    """The index of the last state in what a solver returns, (times, states) or states; "" if that is not known."""
    values = {"f": lambda *x: 0 * x[-1], "t": 0.0, "y": np.array([1.0, 0.5]), "t + h": 0.25, "1": 1}
    with suppress(Exception):
        found = step(*[values[given[each]] for each in names])
        parts = [1] if isinstance(found, tuple) and len(found) == 2 else []
        states = np.asarray(found[1] if parts else found)
        if states.ndim == 2:
            return f"{'[1]' if parts else ''}[-1]"
    return ""


def _for_maker(step: Callable[..., Any], names: Sequence[str], name: str) -> str:
    """The wrapper of a function that makes a stepper from a right-hand side, from a step size, or from both."""
    made: Callable[..., Any] | None = None
    with suppress(Exception):
        made = step(*(0.25 if _role(each) == STEP else (lambda *x: x[-1]) for each in names))
    inner = required_names(made) if callable(made) else None
    if not inner:
        return ""
    positions = {POSITION, VELOCITY} <= {_role(each) for each in inner}
    kind = MAP if FUNCTION not in map(_role, names) else FORCE if positions else FIELD
    arguments = {each: "h" if _role(each) == STEP else _function(kind) for each in names}
    given = {each: each.upper() for each in inner} | _by_role(inner, kind)
    return _Made(kind, name, arguments, given).line(step)


def _call(name: str, names: Sequence[str], given: dict[Any, str], kind: str) -> str:
    arguments = ", ".join(given.get(each, each.upper()) for each in names)
    left = [each for each in names if each not in given]
    if len(left) == 1 and _BEFORE.search(left[0].lower()) and kind == FIELD and {"y", "h"} <= {*given.values()}:
        later = {"y": "ys[-1]", "t": "t + i * h"}
        call = ", ".join(later.get(text := given.get(each, "ys[-2]"), text) for each in names)
        second = "y + h * f(t + h / 2, y + h / 2 * f(t, y))"
        run = f"ys = [y, {second}]; return [*ys, *(ys.append({name}({call})) or ys[-1] for i in range(1, n))]"
        return f"def wrapped(f, t, y, h, n): {run}  # a run of n steps, whose first is one of midpoint2"
    said = f"  # write values for {', '.join(map(str.upper, left))}" if left else ""
    if len(left) == 1 and _BEFORE.search(left[0].lower()):
        said = f"  # a method of two steps: let an object keep its {left[0].upper()}, step(f, t, y, h) being its method"
    if kind == MAP and "h" not in given.values():
        said = "  # its h is built in: let it be an argument, or make the step anew for every h"
    if kind == MAP and any(each.lower().strip("_") in BODY_LISTS for each in left):
        said = "  # what moves its bodies is built in: let their force be an argument, which can then be given"
    return f"def wrapped({_HEADS[kind]}): return {name}({arguments}){said}"


def _by_role(names: Sequence[str], kind: str) -> dict[str, str]:
    """The wrapper's argument for each name whose role is known; a single state of a map is [q, v]."""
    given: dict[str, str] = {}
    for each in names:
        open_roles = [FUNCTION, STEP, TIME, *((STATE,) if kind == FIELD else (POSITION, VELOCITY, STATE))]
        role = next((r for r in open_roles if _has_role(r, each) and _ARGUMENTS[r] not in given.values()), None)
        if role is not None:
            function = "lambda x: -force(x)" if kind == FORCE and has_gradient([each]) else _function(kind)
            given[each] = function if role == FUNCTION else _ARGUMENTS[role]
    if kind == MAP and not {"q", "v"} <= {*given.values()}:
        given = {each: "[q, v]" if text in ("q", "v", "y") else text for each, text in given.items()}
    if kind != FIELD:
        given = {each: "0.0" if text == "t" else text for each, text in given.items()}
    return given


def _function(kind: str) -> str:
    return "f" if kind == FIELD else "force"


def _has_role(role: str, name: str) -> bool:
    return name.lower().strip("_") in ROLES[role]


def _role(name: str) -> str | None:
    return next((role for role in (FUNCTION, STEP, TIME, POSITION, VELOCITY, STATE) if _has_role(role, name)), None)
