"""An object with a state, somebody's body, solver or simulation, as a stepper of one of the calling conventions."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.stepper.array_adapters import as_array, floats_in

Object: TypeAlias = Any
# Where an object keeps numbers: the name of an attribute, dotted where it lies deeper, or two functions, get and put.
Location: TypeAlias = str | tuple[Callable[[Object], Any], Callable[[Object, Any], object]]
# What is done to an object with a number: the name of a method of one argument, or of an attribute; or a function.
Act: TypeAlias = str | Callable[[Object, Any], object]


def stepper_of(
    make: Callable[..., Object],
    *,
    position: Location = "position",
    velocity: Location = "velocity",
    state: Location | None = None,
    advance: Act = "step",
    push: Act | None = None,
    anew: bool = False,
) -> Callable[..., tuple[float, float]]:
    """The step (force, q, v, h) -> (q₁, v₁) of an object on q' = v, v' = force(q); or its (q, v, h) -> (q₁, v₁).

    `make(force)` builds the object, which then calls force(q) where it likes; `make()` one that calls nothing: it is
    given the number force(q) before each step by `push`, or has its system built in. `position` and `velocity` are
    where q and v are: an attribute with a number, or with several, of which the first is meant, and the others become
    0. Or both are in `state`, the first two of its numbers. `advance` takes h.

    One object makes all steps, so that it shows if it remembers more than its state, until a step is not finite: what
    is left of that in an object would speak for all later steps. With `anew`, each step is made by a new one.
    Raises TypeError where `make` takes other arguments.

    >>> from driftproof import stepper_of
    >>> class Body:
    ...     def __init__(self, force):
    ...         self.x, self.v, self.force = 0.0, 0.0, force
    ...     def update(self, h):
    ...         self.v += h * self.force(self.x)
    ...         self.x += h * self.v
    >>> stepper_of(Body, position="x", velocity="v", advance="update")(lambda q: -q, 1.0, 0.0, 0.5)
    (0.75, -0.5)
    """
    held = _Held(make, anew, advance, (position, velocity) if state is None else (state,), push)
    return (ForcedObject if held.takes_function or push is not None else FreeObject)(held)


def field_stepper_of(
    make: Callable[[Callable[..., Any]], Object],
    *,
    state: Location = "y",
    time: Location | None = None,
    error: Location | None = None,
    dense: str | None = None,
    advance: Act = "step",
    anew: bool = False,
) -> Callable[..., Any]:
    """The step (f, t, y, h) -> y₁ of an object on y' = f(t, y); without `time`, its (f, y, h) -> y₁ on y' = f(y).

    `make(f)` builds the object, which calls f as it is used to; `state` is where its y is, `time` its t. Where the
    object keeps its error estimate, or the other result of a pair, in `error`, the step is (y₁, error); where `dense`
    names its dense output, a function of the time or what makes one, that function follows. The rest is as for
    `stepper_of`.

    >>> from driftproof import field_stepper_of
    >>> class Solver:
    ...     def __init__(self, f):
    ...         self.f, self.t, self.y = f, 0.0, None
    ...     def step(self, h):
    ...         self.y, self.t = self.y + h * self.f(self.t, self.y), self.t + h
    >>> step = field_stepper_of(Solver, state="y", time="t", advance="step")
    >>> float(step(lambda t, y: -y, 0.0, [1.0], 0.5)[0])
    0.5
    """
    places = (state,) if time is None else (state, time)
    held = _Held(make, anew, advance, places, error=error, dense=dense)
    return (UntimedSolver if time is None else TimedSolver)(held)


@dataclass
class _OfObject:
    """A step of an object, which has the names of its arguments; a copy of it has an object of its own."""

    held: _Held


class FreeObject(_OfObject):
    """The step (q, v, h)."""

    def __call__(self, q: float, v: float, h: float) -> tuple[float, float]:
        """One step."""
        return self.held.moved(None, q, v, h)


class ForcedObject(_OfObject):
    """The step (force, q, v, h)."""

    def __call__(self, force: Callable[[float], float], q: float, v: float, h: float) -> tuple[float, float]:
        """One step."""
        return self.held.moved(force, q, v, h)


class UntimedSolver(_OfObject):
    """The step (f, y, h)."""

    def __call__(self, f: Callable[..., Any], y: Sequence[float], h: float) -> Any:
        """One step."""
        return self.held.solved(f, [], y, h)


class TimedSolver(_OfObject):
    """The step (f, t, y, h)."""

    def __call__(self, f: Callable[..., Any], t: float, y: Sequence[float], h: float) -> Any:
        """One step."""
        return self.held.solved(f, [t], y, h)


@dataclass
class _Held:
    """The object, made when it is first needed, how it is moved, and the function that it calls at present.

    `places` are those of q and v, or of the state; then of the time, if it has one. `error` is where the object keeps
    its error estimate, `dense` the name of its dense output or of what makes it.
    """

    make: Callable[..., Object]
    anew: bool
    advance: Act
    places: Sequence[Location]
    push: Act | None = None
    error: Location | None = None
    dense: str | None = None
    made: Object = None
    function: Callable[..., Any] | None = None

    def __post_init__(self) -> None:
        """Look at what makes it. Raises TypeError."""
        self.takes_function = _takes_function(self.make)

    def moved(self, force: Callable[[float], float] | None, q: float, v: float, h: float) -> tuple[float, float]:
        """Put position and velocity in their two places or in one, advance, and read them."""
        body = self._ready(force)
        apart = len(self.places) == 2
        places = [_Accessor.of(place, None if apart else 2) for place in self.places]
        for place, numbers in zip(places, ([q], [v]) if apart else ([q, v],), strict=True):
            place.write(body, numbers)
        if self.push is not None and force is not None:
            _act(body, self.push, force(q))
        _act(body, self.advance, h)
        q1, v1 = self._left([x for place in places for x in place.read(body)])
        return q1, v1

    def solved(self, f: Callable[..., Any], times: Sequence[float], y: Sequence[float], h: float) -> Any:
        """Put the state and the time where they belong, advance, and read the state, and what is beside it."""
        solver, state = self._ready(f), _Accessor.of(self.places[0], len(y))
        for place in self.places[1:]:
            _Accessor.of(place).write(solver, times)
        state.write(solver, y)
        _act(solver, self.advance, h)
        y1 = np.array(self._left(state.read(solver)))
        beside = [] if self.error is None else [as_array(_Accessor.of(self.error).get(solver))]
        if self.dense is not None:
            dense = attrgetter(self.dense)(solver)
            beside.append(dense if inspect.signature(dense).parameters else dense())
        return (y1, *beside) if beside else y1

    def _ready(self, function: Callable[..., Any] | None) -> Object:
        """The object; what it calls from now on is `function`."""
        self.function = function
        if self.made is None or self.anew:
            self.made = self.make(self._answer) if self.takes_function else self.make()
        return self.made

    def _left(self, numbers: list[float]) -> list[float]:
        """The numbers that a step has left; an object in which they are not finite is used no more."""
        if not np.isfinite(numbers).all():
            self.made = None
        return numbers

    def _answer(self, *arguments: Any) -> Any:
        assert self.function is not None
        return self.function(*arguments)


def _takes_function(make: Callable[..., Object]) -> bool:
    parameters = inspect.signature(make).parameters.values()
    by_place = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    required = [p.name for p in parameters if p.default is p.empty and p.kind in by_place]
    if len(required) > 1:
        names = ", ".join(required)
        raise TypeError(f"make({names}) has to take the function that the object calls, or nothing; bind the others")
    return bool(required)


@dataclass(frozen=True)
class _Accessor:
    """How one number, or an array of `size` of them, is read off an object and written to it."""

    get: Callable[[Object], Any]
    put: Callable[[Object, Any], object]
    size: int | None

    @classmethod
    def of(cls, place: Location, size: int | None = None) -> _Accessor:
        """Of an attribute or of two functions."""
        if not isinstance(place, str):
            return cls(*place, size)
        owner, _, name = place.rpartition(".")

        def put(body: Object, value: Any) -> None:
            holder = attrgetter(owner)(body) if owner else body
            setattr(holder, name, _shaped(value, getattr(holder, name, None)))

        return cls(attrgetter(place), put, size)

    def read(self, body: Object) -> list[float]:
        """The numbers."""
        return [float(x) for x in as_array(self.get(body)).ravel()[: self.size or 1]]

    def write(self, body: Object, numbers: Sequence[Any]) -> None:
        """Put them where they belong, as floats: the numbers of another arithmetic would stay in the object."""
        floats = floats_in(numbers, self.size or 1)
        self.put(body, floats[0] if self.size is None else np.array(floats))


def _shaped(value: Any, old: Any) -> Any:
    """The value as the old one is held: as it comes, or its numbers as the first of a list, a tuple or an array."""
    if not hasattr(old, "__len__"):
        return value
    given = np.ravel(value).tolist()
    if isinstance(old, np.ndarray):
        filled = np.zeros_like(old, dtype=np.result_type(old, np.float32))
        filled.flat[: len(given)] = given
        return filled
    padded = [*given, *[0.0] * (len(old) - len(given))]
    return padded if isinstance(old, list) else tuple(padded)


def _act(body: Object, act: Act, number: Any) -> None:
    if not isinstance(act, str):
        act(body, number)
    elif callable(method := getattr(body, act)):
        method(number)
    else:
        setattr(body, act, number)
