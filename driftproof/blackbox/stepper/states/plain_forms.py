"""Steppers that write into arrays they are given, or move objects in a list, as plain functions of the state."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from driftproof.blackbox.findings import StaleSlope, WrongShape
from driftproof.blackbox.stepper.calling_conventions import (
    BODY_LISTS,
    CARRIED,
    FUNCTION,
    MASSES,
    POSITION,
    ROLES,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    VERBS,
    conventions_of,
    has_gradient,
    is_acceleration,
    required_names,
    word_of,
)
from driftproof.blackbox.stepper.states.array_adapters import Foreign
from driftproof.blackbox.stepper.states.forms_by_values import Numbers, forms_of_an_array
from driftproof.blackbox.stepper.states.step_forms import StepForm

# Further arguments of such steppers: how many numbers, an array for the result, masses, and objects in a list.
_SIZE, _OUT, _MASS, _BODIES, _SPACE = "size", "out", "mass", "bodies", "space"
_NAMES: Mapping[str, Sequence[str]] = {
    _SIZE: (
        *("n", "neq", "nvar", "dim", "ndim", "size", "d", "n_bodies", "nbodies", "num_bodies", "n_particles", "nn"),
        *("natoms", "n_atoms"),
    ),
    _MASS: MASSES,
    _BODIES: BODY_LISTS,
    STEP: ROLES[STEP],
    FUNCTION: (*ROLES[FUNCTION], "accelerations", "derivatives"),
    CARRIED: (*ROLES[CARRIED], "dydx", "dydt", "dy", "ydot"),
    TIME: ROLES[TIME],
    VELOCITY: ROLES[VELOCITY],
    STATE: ("y", "state", "z", "u", "s"),
    POSITION: ROLES[POSITION],
}
# Names of arrays that are written into: out, yout, y_out, out_q, result, y_new, y1; and yerr, for an error estimate.
_INTO, _ESTIMATE = re.compile(r"^(out|result|res|dest)_?|_?(out|new|next|1|err|error)$"), re.compile(r"err(or)?$")
# Names of arrays in which it works, if there are several.
_WORK = re.compile(r"k[1-9]|(y?_?(tmp|temp)|yt|work|wrk|dy[mt]|scratch|buf)\d?")
# The coordinates of a body in space; those that it has one by one, and what each is of the first, so that none of them
# stands for another.
_IN_SPACE = 3
_AXES = {name: i % _IN_SPACE for i, name in enumerate(("x", "y", "z", "vx", "vy", "vz"))}
_SHARES = (1.0, 0.5, 0.25)
# In so short a step, every method moves a body on a spring back; in a long one the force changes by its own size.
_SHORT, _LONG = 2.0**-10, 0.25
# Unequal masses other than 1 show whether each force is divided by its own mass; accelerations are not divided.
_HEAVY = (2.0, 4.0, 8.0)
# Coordinates that differ by a smaller part move alike.
_ALIKE = 2.0**-20
# What stands in an array for the result, which a step that adds to it would take for its own.
_LEFT_THERE = 0.59375
# A kick that differs by this part is one by another force: of two multistep methods, short kicks differ by less.
_A_PART = 2.0**-5
_TRIAL = np.arange(1.0, 7.0)


def plain_forms(step: Callable[..., Any]) -> Iterator[Callable[..., Any]]:
    """Yield the step(force, q, v, h), step(f, t, y, h), step(q, v, h) or step(y, h) that such a stepper may be.

    Each call passes new arrays, their size if it is asked for, and an array for each result that is written in place.
    For a list of objects, each number or row of q becomes one object, with its position, velocity and mass under the
    names by which the stepper asks for them. A force receives the object it acts on, and sees all objects as they are
    at that moment.

    >>> def euler(y, n, h, out):
    ...     out[0], out[1] = y[0] + h * y[1], y[1] - h * y[0]
    >>> step = next(plain_forms(euler))
    >>> step([1.0, 0.5], 0.5).tolist()
    [1.25, 0.0]
    """
    names = required_names(step) or []
    for function in (*_functions(names), ""):  # an argument a may be a function, or a slope that is handed on
        roles = _roles(names, function)
        held = {*roles.values()} if roles else set()
        if roles is None or not {_SIZE, _OUT, _BODIES, _MASS, _SPACE} & held or STEP not in held:
            continue
        if held <= {_SIZE, _MASS, STATE, POSITION, VELOCITY, TIME, STEP} and not _is_told(step):
            numbers = Numbers.of(step)  # an n or an m may be part of the state
            if numbers and {roles[name] for name in numbers.names} & {_SIZE, _MASS}:
                yield numbers.form
                return
        yield from _forms_of(_Call(step, names, roles), held)
    if not _is_told(step):
        if numbers := Numbers.of(step):
            yield numbers.form
        if names[:1] != _functions(names)[:1]:  # an a after a state may be an acceleration, a number
            yield from forms_of_an_array(step)


def _is_told(step: Callable[..., Any]) -> bool:
    """True if the names of its arguments tell what each of them is."""
    with suppress(ValueError):
        return bool(conventions_of(step))
    return False


def _forms_of(call: _Call, held: set[str]) -> Iterator[Callable[..., Any]]:
    """Yield the form of a call with these roles, if it has one; it has no parameters besides those of the form."""
    of_force = FUNCTION in held
    if _BODIES in held or {POSITION, VELOCITY} <= held:
        if not of_force and _BODIES in held:
            call.see_axes()
        springs = not of_force and _pulls_back(call)
        call.attract = not of_force and not springs
        known = of_force or springs or _BODIES in held  # the force on each place
        for places in (_TRIAL, _TRIAL.reshape(2, 3)) * known:  # does it ask at one place without naming the body?
            with suppress(Exception):
                call.see_what_is_left(places)
        if of_force:
            unequal = not call.alike and len(call.heavy) > 1
            yield StepForm(lambda force, q, v, h: call.moved(force, q, v, h), unequal_masses=unequal)
        elif call.stale or springs:
            yield lambda q, v, h: call.moved(None, q, v, h)
        else:  # bodies that attract each other: three in space or in the plane, of unequal masses
            call.heavy, shape = _HEAVY, (2, len(_HEAVY), call.axes or _IN_SPACE)
            try:
                call.moved(None, *np.cos(np.arange(np.prod(shape))).reshape(shape), _SHORT)  # type: ignore[call-arg]
            except Exception:
                call.column = True
            moved = lambda y, h: np.ravel(call.moved(None, *np.reshape(y, shape), h))  # type: ignore[call-arg]
            yield StepForm(moved, masses=np.array(_HEAVY) if {_BODIES, _MASS} & held else None)
    elif STATE in held and of_force:
        yield (
            (lambda f, t, y, h: call.solved(f, t, y, h)) if TIME in held else lambda f, y, h: call.solved(f, 0.0, y, h)
        )
    elif STATE in held:
        yield lambda y, h: call.solved(None, 0.0, y, h)


def _pulls_back(call: _Call) -> bool:
    """True if the built-in system pulls one body back, as a spring does; mutual attraction does not move it."""
    call.attract = True  # what is handed on is its own
    with suppress(Exception):
        return bool(call.moved(None, 1.0, 0.0, _SHORT)[1] < 0)
    return False


def _functions(names: Sequence[str]) -> list[str]:
    """The names that may be a function, the likeliest first: of compute_acc and acc, the latter is a slope."""
    words = {name: word_of(name) for name in names}
    bare = {name: VERBS.sub("", word) for name, word in words.items()}
    called = [name for name in names if bare[name] in _NAMES[FUNCTION]]
    return sorted(called, key=lambda name: (words[name] in _NAMES[CARRIED], bare[name] == words[name]))


def _roles(names: Sequence[str], function: str) -> dict[str, str] | None:
    """The role of each name, _OUT for an array that is written into; None if a name has no role."""
    found = {function: FUNCTION} if function else {}
    for name in names:
        if name == function:
            continue
        word = word_of(name)
        taken = {*found.values()}
        if _WORK.fullmatch(word) and sum(map(bool, map(_WORK.fullmatch, names))) > 1:
            found[name] = _SPACE
            continue
        role = next((r for r, known in _NAMES.items() if word in known and r not in taken and r != FUNCTION), None)
        found[name] = role or (_OUT if _INTO.search(word) else "")
    held, meant = {*found.values()}, dict[str, str]()
    if VELOCITY not in held:  # in f(x, y), x is the time; x alone is the state
        meant = {POSITION: TIME if STATE in held else STATE}
    elif POSITION not in held:
        meant = {STATE: POSITION}
    return None if "" in held else {name: meant.get(role, role) for name, role in found.items()}


class _Call:
    """Calls of one stepper, with arguments made from a plain state."""

    def __init__(self, step: Callable[..., Any], names: Sequence[str], roles: Mapping[str, str]) -> None:
        self.step, self.names, self.roles = step, names, roles
        function = next((name for name, role in roles.items() if role == FUNCTION), "")
        self.of_force, self.alike, self.sign = "force" in function.lower(), False, 1 - 2 * has_gradient([function])
        divided = {_MASS, _BODIES} & {*roles.values()} and (self.of_force or is_acceleration(function))
        self.heavy = _HEAVY if divided else (1.0,)
        self.left, self.stale = dict[str, Any](), ""
        self.attract, self.column = False, False  # do bodies attract each other? are their masses a column?
        self.asked, self.axes = set[str](), 0  # the names of a body's parts; how many coordinates it has one by one

    def see_axes(self) -> None:
        """Note how many coordinates a body has, if it is asked for each by its name."""
        with suppress(Exception):
            self.moved(None, 1.0, 0.5, _LONG)
        self.axes = max(_AXES[each] + 1 for each in self.asked & {*_AXES}) if {"x", "y"} <= self.asked else 0

    def see_what_is_left(self, places: Any) -> None:
        """Note the names of what a step leaves in objects or slopes if it changes the next one by part of a kick."""
        force, h = np.negative if FUNCTION in self.roles.values() else None, _SHORT
        if _BODIES not in self.roles.values():  # whose memory of a step before may be that of a multistep method
            h = _LONG
        q, v = self.moved(force, places, places, h)
        left, (_, new) = self.left, self.moved(force, q, v, h)
        if left and np.max(np.abs(self.moved(force, q, v, h, left)[1] - new)) > _A_PART * np.max(np.abs(new - v)):
            names = [name for name, role in self.roles.items() if role == CARRIED]
            for body in left[_BODIES][:1]:
                names = [name for name in vars(body) if name not in vars(_Body(0.0, 0.0, 1.0))]
            self.stale = ", ".join(names)

    def solved(self, f: Callable[..., Any] | None, t: float, y: Foreign, h: float) -> Foreign:
        """A step of y' = f(t, y), or of the built-in system if f is None."""
        state = np.array(y, dtype=float)

        def rate(*asked: Foreign) -> Foreign:
            (place, *others), times = _arrays_and_numbers(asked, len(np.atleast_1d(state)))
            assert f is not None
            at = [*times, t][: bool(times) or TIME in self.roles.values()]
            return _written(np.asarray(f(*at, place), float), others)

        given = {STATE: state, TIME: t, STEP: h, FUNCTION: rate}
        if CARRIED in self.roles.values() and f is not None:
            given[CARRIED] = np.asarray(rate(t, state), float)
        answer, outs = self._called(given, state)
        if answer is None and any(map(_ESTIMATE.search, self.names)):
            return tuple(outs)
        return answer if answer is not None else outs[0] if outs else state

    def moved(
        self, force: Callable[..., Any] | None, q: Foreign, v: Foreign, h: float, left: Mapping[str, Any] | None = None
    ) -> Foreign:
        """A step of q'' = force(q), or of the built-in system if force is None, with what another step `left`."""
        if self.stale:
            raise StaleSlope(f"a second step with the {self.stale} that the first one left is not one of its own state")
        if np.shape(q) == (_IN_SPACE**2,) and _MASS in self.roles.values():
            with suppress(Exception):  # as many bodies as coordinates: masses then divide columns as well as rows
                rows = (_IN_SPACE, _IN_SPACE)
                return tuple(x.ravel() for x in self.moved(force, np.reshape(q, rows), np.reshape(v, rows), h))
        alike, handed = self.alike, next((word_of(name) for name, role in self.roles.items() if role == CARRIED), "")
        system = _System(self, force, q, v, (left or {}).get(_BODIES))
        given: dict[str, Foreign] = {POSITION: system.places, VELOCITY: system.speeds, STEP: h, TIME: 0.0}
        given |= {FUNCTION: lambda *arguments: system.asked(*arguments), _MASS: system.masses, _BODIES: system.bodies}
        if handed:
            given[CARRIED] = system.pushes(system.places) / system.factors ** is_acceleration(handed)
        given |= {_MASS: system.masses[:, None]} if self.column else {}
        if handed and self.attract:
            given[CARRIED] = self._own_pushes(given)
        given |= left or {}
        answer, outs = self._called(given, system.places)
        kept = answer is None or answer is system.bodies
        self.left = {role: given.get(role) for role in (_BODIES, CARRIED)} if kept else {}
        if handed and isinstance(answer, tuple) and np.shape(answer[-1]) == system.places.shape and len(answer) > 2:
            self.left = {_BODIES: system.bodies, CARRIED: answer[-1]}
            ends = given | {POSITION: answer[0], VELOCITY: answer[1]}
            if self.attract and not np.allclose(answer[-1], self._own_pushes(ends), _ALIKE):
                raise StaleSlope("the slope that it passes on is not the one at its end")
        if self.alike > alike:  # a force that does not know its body: begin again with equal masses
            return self.moved(force, q, v, h)
        return system.ends(answer, outs)

    def _own_pushes(self, given: Mapping[str, Foreign]) -> Foreign:
        """What bodies that attract each other hand on from here: that of a step of 0."""
        found = np.zeros_like(given[POSITION])
        answer, _ = self._called({**given, CARRIED: found, STEP: 0.0}, found)
        return answer[-1] if isinstance(answer, tuple) and len(answer) > 2 else found

    def _called(self, given: Mapping[str, Foreign], state: Any) -> tuple[Foreign, list[Foreign]]:
        """What the stepper returns, and the arrays it writes into, the position before the velocity, an error last."""
        outs = {name: np.full_like(state, _LEFT_THERE) for name, role in self.roles.items() if role == _OUT}
        spaces = {name: np.empty_like(state) for name, role in self.roles.items() if role == _SPACE}
        known = {**given, _SIZE: len(state)}
        held = {**outs, **spaces}
        answer = self.step(*[held[name] if name in held else known[self.roles[name]] for name in self.names])
        answer = None if isinstance(answer, int) else answer  # a status, as of C
        last = lambda name: (bool(_ESTIMATE.search(name)), _INTO.sub("", word_of(name)) in _NAMES[VELOCITY])
        ordered = sorted(outs, key=last)
        return answer, [outs[name] for name in ordered]


class _System:
    """Positions, velocities and masses as a stepper takes them, in arrays or bodies, and the force on them."""

    def __init__(
        self, call: _Call, force: Callable[..., Any] | None, q: Foreign, v: Foreign, bodies: Sequence[_Body] | None
    ) -> None:
        self.call, self.force, self.shape = call, force, np.shape(q)
        self.places, self.speeds = (np.array(x, dtype=float, ndmin=1) for x in (q, v))
        self.masses = np.resize(call.heavy[:1] if call.alike else call.heavy, len(self.places))
        self.factors = call.sign * self.masses.reshape(-1, *[1] * (self.places.ndim - 1)) ** call.of_force
        shares = np.array(_SHARES[: call.axes]) if call.axes else 1.0
        one: Callable[[Any], Any] = lambda x: x.copy() if np.ndim(x) else x * shares
        each = zip(self.places, self.speeds, self.masses, strict=True) if _BODIES in call.roles.values() else ()
        self.bodies = bodies or [_Body(one(q), one(v), float(mass), call) for q, v, mass in each]

    def pushes(self, at: Any, whose: int | None = None) -> Any:
        """The forces at these places, in their shape, times the masses unless they are accelerations, or gradients."""
        whole = at.size == self.places.size
        pushed = -at if self.force is None else self.force(at.reshape(self.shape) if whole else at)
        if whole:
            return (np.asarray(pushed, float).reshape(self.places.shape) * self.factors).reshape(at.shape)
        self.call.alike |= whose is None
        return np.asarray(pushed, float).reshape(at.shape) * self.factors[whose or 0]

    def asked(self, *arguments: Foreign) -> Foreign:
        if self.bodies:
            return _answer_of_bodies(self.pushes, arguments, self.bodies)
        arrays, _ = _arrays_and_numbers(arguments, self.places.size)
        place, *others = [x for x in arrays if x is not self.masses] or arguments
        return _written(self.pushes(np.asarray(place, float)), [x for x in others if x is not self.speeds])

    def ends(self, answer: Foreign, outs: Sequence[Foreign]) -> Foreign:
        """The new positions and velocities: those of bodies, those returned, or those written into the arrays."""
        if self.bodies:
            moved = answer if isinstance(answer, list | tuple) and len(answer) == len(self.bodies) else self.bodies
            return tuple(self._first([getattr(b, role) for b in moved]).reshape(self.shape) for role in ("pos", "vel"))
        pair = answer if answer is not None else outs if len(outs) == 2 else (self.places, self.speeds)
        return tuple(np.reshape(x, self.shape) for x in pair[:2])

    def _first(self, numbers: Sequence[Foreign]) -> Any:
        """The numbers of all bodies; of coordinates that began as parts of the first, the first, if they still are."""
        found = np.array(numbers)
        if self.places.ndim > 1 or not self.call.axes:
            return found
        if not np.allclose(found, found[:, :1] * _SHARES[: self.call.axes], _ALIKE, 0):
            raise WrongShape("the coordinates of a body do not move alike")
        return found[:, 0]


def _arrays_and_numbers(asked: Sequence[Foreign], size: int) -> tuple[list[Foreign], list[Foreign]]:
    """The arrays among the arguments, and the numbers that are not the size."""
    arrays = [x for x in asked if np.ndim(x)]
    return arrays, [x for x in asked if not np.ndim(x) and not (isinstance(x, int) and x == size)]


def _written(slopes: Any, arrays: Sequence[Foreign]) -> Any:
    """The slopes, copied into the last of the arrays if that holds as many numbers."""
    if arrays and len(arrays[-1]) == len(slopes):
        arrays[-1][:] = slopes
    return slopes


class _Body:
    """An object with a position, a velocity and a mass, each under any of its usual names, or one by one."""

    def __init__(self, pos: Any, vel: Any, mass: float, call: _Call | None = None) -> None:
        self.pos, self.vel, self.mass = pos, vel, mass
        self.__dict__["call"] = call

    def __getattr__(self, name: str) -> Any:
        known = _attribute(name)
        if name.startswith("__") or known == name:
            raise AttributeError(name)
        if self.call is not None:
            self.call.asked.add(name)
        one_by_one = self.call is not None and self.call.axes and name in _AXES
        return getattr(self, known)[_AXES[name]] if one_by_one else getattr(self, known)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _AXES and self.call is not None and self.call.axes:
            self.__dict__[_attribute(name)][_AXES[name]] = value
        else:
            self.__dict__[_attribute(name)] = value


def _attribute(name: str) -> str:
    kinds = {"pos": (*_NAMES[POSITION], "z"), "vel": (*_NAMES[VELOCITY], "vz"), "mass": _NAMES[_MASS]}
    return next((kind for kind, names in kinds.items() if name.lower() in names), name)


def _answer_of_bodies(pushes: Callable[..., Any], asked: Sequence[Foreign], bodies: Sequence[_Body]) -> Foreign:
    """The force on one object alone, on one object among those of a list, on all of these, or at a place."""
    first = asked[0]
    among = next((x for x in asked if isinstance(x, list | tuple) and len(x) == len(bodies)), None)
    if among is None:  # a force on one body, which sees no others
        alone = first.pos if isinstance(first, _Body) else first
        known = [i for i, body in enumerate(bodies) if body is first or np.array_equal(body.pos, alone)]
        return pushes(np.asarray(alone, float), *(known if len(known) == 1 else ()))
    found = pushes(np.array([body.pos for body in among], float))
    return found if first is among else found[next(i for i, body in enumerate(among) if body is first)]
