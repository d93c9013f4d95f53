"""Steppers made from objects that keep a state: somebody's body, solver or simulation."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import chain, islice
from math import isfinite
from operator import attrgetter
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.calling_conventions import TIME, role_of, stand_in
from driftproof.blackbox.stepper.states.array_adapters import as_array, floats_in
from driftproof.blackbox.stepper.states.forms_by_values import further_numbers
from driftproof.blackbox.stepper.states.named_answers import goes_on

Object: TypeAlias = Any
# Where an object keeps numbers: the name of an attribute, dotted if it lies deeper, or two functions, get and put.
Location: TypeAlias = str | tuple[Callable[[Object], Any], Callable[[Object, Any], object]]
# How an object takes a number: the name of a method of one argument, or of an attribute; or a function.
Act: TypeAlias = str | Callable[[Object, Any], object]
# The step by which it is tried whether an object keeps more than its state, and what of its end may differ.
_TRIED, _ALIKE = 0.25, 2.0**-20


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
    """Return the step (force, q, v, h) -> (q₁, v₁) of an object on q' = v, v' = force(q), or its (q, v, h) -> (q₁, v₁).

    `make(force)` builds an object that calls force(q) itself. `make()` builds one that calls nothing: `push` gives it
    the number force(q) before each step, or its system is built in. `position` and `velocity` are the places of q and
    v, each an attribute or a pair of functions (get, put); or `state` is the place of both, its first two numbers. Of
    several numbers, the first is used, and the others are 0, or those of a new object if its system is built in; a
    system that is not q'' = -q is judged by all of them. `advance` takes h.

    One object makes all steps, so that it shows whether it remembers more than its state. What it keeps from its last
    step, such as an acceleration, is brought up to date by a step of 0, if the next step begins with the same. After a
    step that is not finite a new object is made, since what that step leaves in the old one would affect all later
    steps. With `anew`, a new object makes each step. Raises TypeError if `make` takes other arguments.

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
    return ObjectStep(make, "q v h", anew, advance, (position, velocity) if state is None else (state,), push)


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
    """Return the step (f, t, y, h) -> y₁ of an object on y' = f(t, y), or (f, y, h) -> y₁ on y' = f(y) without `time`.

    `make(f)` builds the object, which calls f itself; `state` is where its y is, `time` where its t is. If `error` is
    where the object keeps its error estimate, or the other result of a pair, the step returns (y₁, error). If `dense`
    names its dense output, a function of the time or a method that makes one, the step returns that function last. All
    else is as for `stepper_of`.

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
    names, places = ("f y h", (state,)) if time is None else ("f t y h", (state, time))
    return ObjectStep(make, names, anew, advance, places, error=error, dense=dense)


@dataclass
class ObjectStep:
    """The step made by an object, which is made when it is first needed; each copy of it has an object of its own.

    `names` are those of its arguments. `places` are those of q and v, or of the state, and then of the time, if the
    object has one. `error` is where it keeps its error estimate, `dense` the name of its dense output or of a method
    that makes it. `function` is what the object calls at present.
    """

    make: Callable[..., Object]
    names: str
    anew: bool
    advance: Act
    places: Sequence[Location]
    push: Act | None = None
    error: Location | None = None
    dense: str | None = None
    made: Object = None
    function: Callable[..., Any] | None = None
    # What a step of 0 brings up to date, but its own steps do not.
    late: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Have the name of what is made, which reports show, and arguments with names. Raises TypeError."""
        for place in self.places:
            if not isinstance(place, str) and not (len(place) == 2 and all(map(callable, place))):
                raise TypeError(f"{place!r} is no place: give the name of an attribute, or two functions (get, put)")
        self.takes_function = _takes_function(self.make)
        pushed = self.names == "q v h" and (self.takes_function or self.push)
        self.parted = len(self.places) == 2
        stand_in(self, self.make, f"{'force ' if pushed else ''}{self.names}".split())

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Make one step."""
        given = inspect.signature(self).bind(*arguments, **named).arguments
        return (self.moved if "q" in given else self.solved)(**given)

    def moved(self, q: float, v: float, h: float, force: Callable[[float], float] | None = None) -> tuple[float, float]:
        """Write position and velocity into their places, advance the object, and read them."""
        ends = self._moved(force and partial(_by_first, force), self._filled(q, v), h)
        q1, v1 = (end[0] for end in ends[:2]) if ends[1:] else ends[0][:2]
        return q1, v1

    def of_all(self, y: Sequence[float], h: float) -> list[float]:
        """The step of a built-in system with all numbers of its object, in the order in which it `begun`."""
        numbers = iter(y)
        return list(chain(*self._moved(None, [[*islice(numbers, len(part))] for part in self.begun], h)))

    @cached_property
    def begun(self) -> list[list[float]]:
        """All numbers in each place of a new object whose system is built in; of another, as many as are set.

        Further numbers that its step moves have their places after these, unless they move q and v.
        """
        found = [[0.0] * (3 - len(self.places)) for _ in self.places]
        if not self.takes_function and self.push is None:
            made = self._new()
            for place, numbers in zip(self.places, found, strict=True):
                with suppress(Exception):  # functions, and what is not there before a step is made
                    seen = as_array(attrgetter(place)(made))  # type: ignore[arg-type]
                    numbers[:] = floats_in(seen, max(seen.size, len(numbers)))
            beside = self._beside(made, found)
            self.places, found = [*self.places, *beside], [*found, *beside.values()]
        return found

    def _beside(self, made: Object, begun: list[list[float]]) -> dict[str, list[float]]:
        """The further numbers of a new object that its step moves, and that do not move q and v, by name."""

        def ends(q: float, v: float, given: Mapping[str, float]) -> Mapping[str, Any]:
            body = self._new()
            for name, x in given.items():
                setattr(body, name, x)
            self._step(body, self._filled(q, v, begun), [_TRIED])
            moved = [_Accessor.of(x, len(part)).read(body) for x, part in zip(self.places, begun, strict=True)]
            return {"": moved, **{name: x for name, x in vars(body).items() if name not in self.places}}

        found = dict[str, list[float]]()
        for name in further_numbers(ends, getattr(made, "__dict__", {})):
            here, there = (ends(1.0, 0.5, {name: x})[""] for x in (0.5, 1.0))
            if here == there:
                found[name] = [float(getattr(made, name, 0.0))]
        return found

    @cached_property
    def reset(self) -> str:
        """What is not seen of it if each step sets a clock of its own to one time, as `advance` may; "" if not."""
        made, seen = self._new(), list[dict[str, Any]]()
        with suppress(Exception):
            for h in (_TRIED, 2 * _TRIED):
                self._step(made, self._filled(1.0, 0.5), [h])
                seen.append({name: x for name, x in vars(made).items() if role_of(name, (TIME,))})
            name = next(name for name, t in seen[0].items() if np.isclose(seen[1][name] - t, _TRIED))
            hidden = f"its steps all begin at one {name} of its own, on which its system may depend"
            return f"{hidden}; write a step that takes it"
        return ""

    def _filled(self, q: float, v: float, begun: Sequence[Sequence[float]] = ()) -> list[list[float]]:
        """The numbers of each place at this position and velocity, with the others of a new object."""
        numbers = [[*part] for part in begun or self.begun]
        if self.parted:
            numbers[0][0], numbers[1][0] = q, v
        else:
            numbers[0][:2] = q, v
        return numbers

    def _moved(self, function: Callable[..., Any] | None, parts: list[list[float]], h: float) -> list[list[float]]:
        """The numbers of each place after a step; an object that leaves one that is not finite is dropped."""
        body = self._ready(function)
        self._step(body, parts, [0.0, h] if self.upkeep[0] else [h])
        ends = self._read(body)
        if not all(map(isfinite, chain(*ends))):
            self.made = None
        return ends

    def _step(self, body: Object, parts: list[list[float]] | None, steps: Sequence[float]) -> None:
        """Make steps from these numbers, or from where the object is; its force is pushed if it calls none."""
        for place, numbers in zip(self.places, parts or (), strict=False):
            _Accessor.of(place, len(numbers) if numbers[1:] else None).write(body, numbers)
        for h in steps:
            if self.push is not None and self.function is not None:
                _act(body, self.push, self.function(parts[0][0] if parts else self._read(body)[0][0]))
            _act(body, self.advance, h)

    def _read(self, body: Object) -> list[list[float]]:
        return [_Accessor.of(x, len(part)).read(body) for x, part in zip(self.places, self.begun, strict=True)]

    @cached_property
    def upkeep(self) -> tuple[bool, list[str]]:
        """Whether a step of 0 comes before each step, and what of an object would still change the next one, by name.

        A step of 0 comes first where it brings up to date what an object keeps besides its state, as its own steps do.
        An object that goes on in another way is a method of several steps, or wrong, and is taken as it is.
        """
        function, self.function = self.function, lambda *asked: -1.0 * asked[0]
        try:
            return self._seen_upkeep() if "q" in self.names else (False, [])
        except Exception:  # of foreign code, of which the step itself will tell
            return False, []
        finally:
            self.function = function

    def _seen_upkeep(self) -> tuple[bool, list[str]]:
        start, other = self._filled(0.8125, 0.5), self._filled(-0.5625, 0.75)  # where no new object is

        def course(*begins: list[list[float]] | None, zero: bool) -> list[list[float]]:
            """The end of a new object that makes a step from each of these, or from its own place."""
            made = self._new()
            for parts in begins:
                self._step(made, parts, [0.0, _TRIED] if zero and parts else [_TRIED])
            return self._read(made)

        def alike(zero: bool) -> tuple[bool, bool]:
            """Is a step the same after another one? Does an object go on as one does that is put there?"""
            end = course(start, zero=zero)
            on, put = (course(*begins, zero=zero) for begins in ([start, None], [end]))
            return course(other, start, zero=zero) == end, np.allclose([*chain(*on)], [*chain(*put)], _ALIKE)

        made, places = self._new(), [x.partition(".")[0] for x in self.places if isinstance(x, str)]
        before = {name: repr(x) for name, x in vars(made).items()}
        for begin in (start, other):  # in the first of which a new object may have been as well
            self._step(made, begin, [_TRIED])
        kept = [name for name, x in vars(made).items() if repr(x) != before.get(name) and name not in places]
        same, on = alike(False)
        if not kept or (on and (same or self.anew)) or course(start, zero=False) != course(start, zero=False):
            return False, []  # nothing that matters, or random numbers
        with suppress(Exception):
            same, on = alike(True)
            if same:
                self.late = [] if on else kept
                return on, []

        def matters(name: str) -> bool:
            """Does an object with this of another one make another step?"""
            made, moved = self._new(), self._new()
            self._step(moved, other, [_TRIED])
            self._step(made, start, [])
            setattr(made, name, getattr(moved, name))
            self._step(made, None, [_TRIED])
            return self._read(made) != course(start, zero=False)

        return False, [*filter(matters, kept)] or kept

    def solved(self, f: Callable[..., Any], y: Sequence[float], h: float, t: float = 0.0) -> Any:
        """Write the state and the time, advance the object, and read its state, error estimate and dense output."""
        solver, state = self._ready(f), _Accessor.of(self.places[0], len(y))
        for place in self.places[1:]:
            _Accessor.of(place).write(solver, [t])
        state.write(solver, y)
        _act(solver, self.advance, h)
        for place in self.places[1:]:
            (clock,) = _Accessor.of(place).read(solver)
            if not goes_on(t, clock, h):
                raise RuntimeError(f"its clock goes from {t!r} to {clock!r} in a step of {h!r}")
        y1 = np.array(state.read(solver))
        if not np.isfinite(y1).all():
            self.made = None
        beside = [] if self.error is None else [as_array(_Accessor.of(self.error).get(solver))]
        if self.dense is not None:
            dense = attrgetter(self.dense)(solver)
            beside.append(dense if inspect.signature(dense).parameters else dense())
        return (y1, *beside) if beside else y1

    def _ready(self, function: Callable[..., Any] | None) -> Object:
        """The object, made if need be, which calls `function` from now on."""
        self.function = function
        if self.made is None or self.anew:
            self.made = self._new()
        return self.made

    def _new(self) -> Object:
        answer = lambda *arguments: self.function(*arguments)  # type: ignore[misc]
        return self.make(answer) if self.takes_function else self.make()


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
    """Access to one number of an object, or to an array of `size` numbers."""

    get: Callable[[Object], Any]
    put: Callable[[Object, Any], object]
    size: int | None

    @classmethod
    def of(cls, place: Location, size: int | None = None) -> _Accessor:
        if not isinstance(place, str):
            return cls(*place, size)
        owner, _, name = place.rpartition(".")

        def put(body: Object, value: Any) -> None:
            holder = attrgetter(owner)(body) if owner else body
            if name.isupper() and not hasattr(holder, name):  # a word that was to be replaced
                raise BadInput(f"{type(holder).__name__} has no attribute {name}: write the name of its own")
            setattr(holder, name, _shaped(value, getattr(holder, name, None)))

        return cls(attrgetter(place), put, size)

    def read(self, body: Object) -> list[float]:
        return [float(x) for x in as_array(self.get(body)).ravel()[: self.size or 1]]

    def write(self, body: Object, numbers: Sequence[Any]) -> None:
        """Write the numbers as floats, since numbers of another arithmetic would stay in the object."""
        floats = floats_in(numbers, self.size or 1)
        self.put(body, floats[0] if self.size is None else np.array(floats))


def _shaped(value: Any, old: Any) -> Any:
    """The value in the form of the old one: unchanged for a number, padded with 0 for a list, a tuple or an array."""
    if not hasattr(old, "__len__"):
        return value
    given = np.ravel(value).tolist()
    if isinstance(old, np.ndarray):
        filled = np.zeros_like(old, dtype=np.result_type(old, np.float32))
        filled.flat[: len(given)] = given
        return filled
    padded = [*given, *[0.0] * (len(old) - len(given))]
    return padded if isinstance(old, list) else tuple(padded)


def _by_first(force: Callable[..., Any], *arguments: Any) -> Any:
    """The force on the first of several numbers, which the object gives and takes together."""
    several = next((x for x in arguments if np.size(x) > 1), 0.0)
    return _shaped(force(*(np.ravel(x).tolist()[0] if np.size(x) > 1 else x for x in arguments)), several)


def _act(body: Object, act: Act, number: Any) -> None:
    if not isinstance(act, str):
        act(body, number)
    elif callable(method := getattr(body, act)):
        method(number)
    else:
        setattr(body, act, number)
