"""States held in records: dataclasses, named tuples, typed dicts, dicts, objects; steps of these as steps of q, v."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from functools import partial
from typing import Any, get_type_hints

import numpy as np

from driftproof.blackbox.findings import WrongShape
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber, ArrayAdapter, Foreign, floats_in
from driftproof.blackbox.stepper.states.forms_by_values import further_numbers
from driftproof.blackbox.stepper.states.handed_slopes import with_own_slope
from driftproof.blackbox.stepper.states.named_answers import (
    CLOCK_ERROR,
    is_before,
    named_parts,
    parts_of,
    role_in_state,
)
from driftproof.blackbox.stepper.states.step_forms import StepForm


def record_of(step: Callable[..., Any], call: Callable[[Any], object]) -> Record | None:
    """The first class of a record in the annotations, or else a record of the keys or attributes that `call` reads.

    None if a field with the name of a time, beside others without a role, does not go on by the step size that `call`
    gives, 1/4: it may be a temperature.
    """
    found = fields_of(step, call)
    if (record := _record(*found) if found else None) and role_in_state(record.position) is None and record.clock:
        filled, clock = record.filled, record.clock
        return record if _keeps_time(call, lambda x: filled(x, x), clock) else None
    return record


def further_fields(record: Record, step: Callable[[Any], object]) -> list[str]:
    """The fields of a record that a step of its built-in system moves besides its position and velocity.

    A clock is one of them if it drives both and has no name of a time, by which it would be set.
    """

    def end(q: float, v: float, given: Mapping[str, float]) -> Foreign:
        state = record.filled(q, v, **unread, **given)
        found = step(state)
        return state if found is None else found

    def ends(q: float, v: float, given: Mapping[str, float]) -> Mapping[str, Foreign]:
        known, found = {record.position, record.velocity}, parts_of(end(q, v, given))
        return {name: x for name, x in found.items() if name not in known and not _is_slope(name)}

    def drives(name: str, x: float) -> bool:
        with suppress(Exception):  # of foreign code, and of what is no number
            here, later = (end(1.0, 0.75, {name: at}) for at in (x, x + 0.5))
            by, too = parts_of(here)[name] - x, parts_of(later)[name] - x - 0.5
            return bool(by and np.isclose(by, too, CLOCK_ERROR) and record.pair(here) != record.pair(later))
        return False

    unread = {name: 0.0 for name, needed in record.slopes.items() if needed}
    begun = dict(parts_of(record.filled(1.0, 0.75, **unread)))
    others = begun.keys() - {record.position, record.velocity, *record.slopes, record.clock}
    return [*further_numbers(ends, begun), *(name for name in begun if name in others and drives(name, begun[name]))]


def fields_of(
    step: Callable[..., Any], call: Callable[[Any], object]
) -> tuple[str, Any, Sequence[str], Sequence[str]] | None:
    """The name of such a record, what makes it, the names of its fields, and those that are needed; None if none is."""
    hints: Mapping[str, Any] = {}
    with suppress(Exception):  # foreign annotations may name what does not exist
        hints = get_type_hints(step if inspect.isroutine(step) else type(step).__call__)
    named = next((hint for name, hint in hints.items() if name != "return" and _fields(hint)[0]), None)
    if named is not None:
        return named.__name__, named, *_fields(named)
    asked = _Asked()
    with suppress(Exception, SystemExit):
        call(asked)
    keys, attributes = list(asked), list(dict.fromkeys(asked.__dict__["attributes"]))
    if keys:
        return "dict", dict, keys, keys
    make = dataclasses.make_dataclass("State", attributes) if all(map(str.isidentifier, attributes)) else None
    return ("State", make, attributes, attributes) if attributes and make else None


def _fields(record: Any) -> tuple[list[str], list[str]]:
    """The names of all fields, and those of the fields without a default."""
    if dataclasses.is_dataclass(record):
        fields = [field for field in dataclasses.fields(record) if field.init]
        plain = (dataclasses.MISSING, dataclasses.MISSING)
        return [f.name for f in fields], [f.name for f in fields if (f.default, f.default_factory) == plain]
    if isinstance(record, type) and issubclass(record, tuple) and hasattr(record, "_fields"):
        names = list(record._fields)
        return names, [name for name in names if name not in getattr(record, "_field_defaults", {})]
    keys = list(getattr(record, "__annotations__", {})) if hasattr(record, "__total__") else []
    return keys, keys


class _Asked(dict[str, float]):
    """A state that has every key and attribute, and records which of them are read."""

    def __init__(self) -> None:
        super().__init__()
        self.__dict__["attributes"] = []

    def __missing__(self, key: object) -> float:
        if not isinstance(key, str):
            raise KeyError(key)
        self[key] = 1.0
        return 1.0

    def __getattr__(self, name: str) -> float:
        if name.startswith("_"):
            raise AttributeError(name)
        self.__dict__["attributes"].append(name)
        return 1.0


@dataclasses.dataclass(frozen=True)
class Record:
    """A record with a position and a velocity: its class, the names of both, and the values of its other fields.

    `given` are those of them that are parameters of the oscillator; `slopes` are those that may hold the force
    at its position, each with whether it has no default.
    """

    name: str
    make: Any
    position: str
    velocity: str
    known: Mapping[str, float]
    given: Mapping[str, float]
    slopes: Mapping[str, bool] = dataclasses.field(default_factory=dict)

    @property
    def clock(self) -> str:
        """The name of the time that it holds, one number; "" if it holds none."""
        unread = dict.fromkeys(self.slopes, 0.0)
        for name, x in parts_of(self.filled(1.0, 0.75, **unread)).items():
            if role_in_state(name) == calling.TIME and isinstance(x, int | float):
                with suppress(TypeError):  # of a field that nobody sets
                    self.filled(1.0, 0.75, **{**unread, name: 0.0})
                    return name
        return ""

    def filled(self, q: Foreign, v: Foreign, **other: Foreign) -> Foreign:
        """A new record at this position, with this velocity."""
        return self.make(**{**self.known, **other, self.position: q, self.velocity: v})

    def pair(self, value: Foreign) -> tuple[Foreign, Foreign] | None:
        """The position and the velocity of a record; None if the value is none."""
        take = value.get if isinstance(value, Mapping) else partial(getattr, value)
        parts = take(self.position, None), take(self.velocity, None)
        return None if any(part is None for part in parts) else parts


def _is_slope(name: str) -> bool:
    """True if a field may hold the force that a step reads or hands on."""
    return bool(calling.has_gradient([name]) or calling.role_of(name, (calling.CARRIED,)))


def _record(name: str, make: Any, names: Sequence[str], needed: Sequence[str]) -> Record | None:
    """The record with these fields, some of which are needed; None if some of those are not known."""
    roles = {each: role_in_state(each) for each in names}
    places = [
        next((each for each in names if roles[each] == role), None) for role in (calling.POSITION, calling.VELOCITY)
    ]
    plain = [each for each in names if roles[each] != calling.TIME]
    if None in places and len(plain) == 2 and not any(map(is_before, names)):
        places = list(plain)
    given = {each: 1.0 for each in names if each.lower() in calling.UNIT_PARAMETERS and each not in places}
    known = {each: 0.0 for each in needed if roles[each] == calling.TIME} | {x: 1.0 for x in given if x in needed}
    left = [each for each in names if each not in places]
    slopes = {x: x in needed for x in left if _is_slope(x)}
    if None in places or set(needed) - {*known, *places, *slopes}:
        return None
    return Record(name, make, str(places[0]), str(places[1]), known, given, slopes)


def adapter_of(record: Record) -> ArrayAdapter:
    """The adapter of a step that takes the record in place of a state."""

    def write(numbers: Sequence[AnyNumber]) -> Foreign:
        return record.filled(*(np.array(x, dtype=float) if np.ndim(x) else float(x) for x in numbers))

    def read(value: Foreign, size: int) -> list[AnyNumber]:
        parts, pair = parts_of(value), record.pair(value)
        for each in record.given.keys() & record.known.keys() & parts.keys():
            if parts[each] != record.known[each]:
                raise WrongShape(f"a record whose {each} is {record.known[each]:g} comes back with {parts[each]}")
        return floats_in(value if pair is None else [*pair], size)

    clock = record.clock
    arguments = [f"{each}={x!r}" for each, x in record.known.items()]
    shown = f"{record.name}({', '.join([*arguments, f'{record.position}={{}}', f'{record.velocity}={{}}'])})"
    return ArrayAdapter(
        f"{record.name} with {record.position}, {record.velocity}",
        write,
        read,
        shown=shown,
        parts=(record.position, record.velocity),
        parameters=record.given,
        with_parameters=lambda values: adapter_of(
            dataclasses.replace(record, known={**record.known, **values}, given={**record.given, **values})
        ),
        at=(lambda t: adapter_of(dataclasses.replace(record, known={**record.known, clock: t}))) if clock else None,
    )


def record_forms(step: Callable[..., Any]) -> Iterator[Callable[..., Any]]:
    """Yield the step(force, q, v, h), or with t before h, that a step of a dict or an object and a force may be.

    Or the step(q, v, h) that one without a force may be.

    The force may be asked with the record, which it then sees as it is, or with a position; it answers with a number,
    or, in the second form, with a record of both slopes. A mass in the record is 2 unless the function's name says that
    it is an acceleration.

    >>> def kick_and_drift(body, force, dt):
    ...     body["v"] += dt * force(body["x"])
    ...     body["x"] += dt * body["v"]
    >>> next(record_forms(kick_and_drift))(lambda x: -x, 1.0, 0.0, 0.5)
    (0.75, -0.5)
    """
    roles: dict[str, str] = {}
    names = calling.names_with_step(step) or []
    for name in names:
        if role := calling.role_of(
            name, [each for each in (calling.FUNCTION, calling.STEP, calling.TIME, calling.STATE) if each not in roles]
        ):
            roles[role] = name
    left = [name for name in names if name not in roles.values()]
    if calling.STATE not in roles and len(left) == 1:  # a record may have any name
        roles[calling.STATE] = left.pop()
    if left or not {calling.STEP, calling.STATE} <= {*roles}:
        return

    def called(function: Any, state: Foreign, t: float = 0.0, h: float = 0.25) -> Foreign:
        given = {calling.FUNCTION: function, calling.STATE: state, calling.TIME: t, calling.STEP: h}
        return step(**{name: given[role] for role, name in roles.items()})

    if calling.FUNCTION not in roles:
        alone = partial(called, None)
        record = record_of(step, alone)
        further = further_fields(record, alone) if record is not None else []
        if record is not None and not further:
            if handing := handed_on(partial(called, None), record):  # a step of 0 makes the slope that is handed on
                yield with_own_slope(handing) or handing
            elif not record.slopes:
                yield _with_parameters(called, record)
        elif found := fields_of(step, alone):
            name, make, fields, needed = found
            yield from _of_numbers(alone, name, make, list(dict.fromkeys([*needed, *further])), fields)
        return
    pushed = calling.word_of(roles[calling.FUNCTION])
    for stub, slopes in ((lambda *asked: 0.0, False), (lambda *asked: min(asked, key=np.isscalar), True)):
        if (record := record_of(step, partial(called, stub))) is not None:
            yield _form(called, record, slopes, pushed, calling.TIME in roles)
    seen: list[Foreign] = []
    with suppress(Exception):
        called(lambda *asked: seen.extend(asked) or 0.0, (1.0, 0.5))  # type: ignore[func-returns-value]
    if seen and not any(map(np.ndim, seen)):  # a pair, which the step takes apart
        yield _form(called, Record("tuple", lambda q, v: (q, v), "q", "v", {}, {}), False, pushed, False)


def _with_parameters(step: Callable[..., Foreign], record: Record) -> StepForm:
    """The step(q, v, h) of a record with its system built in, and what makes it of other parameters."""
    free = _form(step, record, False, "", timed := bool(record.clock))
    return StepForm(
        (lambda q, v, t, h: free(None, q, v, t, h)) if timed else lambda q, v, h: free(None, q, v, h),
        others={name: x for name, x in record.known.items() if name in record.given},
        of_others=lambda others: _with_parameters(step, dataclasses.replace(record, known={**record.known, **others})),
    )


def _keeps_time(step: Callable[..., Foreign], made: Callable[[float], Foreign], clock: str) -> bool:
    """True if this field of records goes on by the step size, 1/4, in steps from 0, whatever x they are made with."""
    with suppress(Exception):  # of foreign code, and of what is no number
        pairs = [(state, step(state)) for state in (made(0.75), made(-0.5))]
        ends = [float(named_parts(state if found is None else found)[clock]) for state, found in pairs]
        return bool(np.allclose(ends, 0.25, CLOCK_ERROR))
    return False


def _of_numbers(
    step: Callable[..., Foreign], name: str, make: Any, needed: Sequence[str], fields: Sequence[str]
) -> Iterator[Callable[..., Any]]:
    """Yield the step(y, h) of a record of several numbers, in the order in which it returns them.

    Or the step(t, y, h), if one of its fields is a clock.
    """

    def at_zero(x: float, clock: str) -> Foreign:
        return make(**{**dict.fromkeys(needed, x), clock: 0.0})

    likely = [each for each in fields if role_in_state(each) == calling.TIME]
    clock = next((each for each in likely if _keeps_time(step, partial(at_zero, clock=each), each)), None)
    order = [each for each in needed if each != clock]
    if len(order) <= 2 or any(map(is_before, order)):
        return
    # A dict that a step changes has no order but that in which it is read, of velocities before positions, too.
    order.sort(key=lambda name: calling.role_of(name, (calling.VELOCITY,)) is not None)
    with suppress(Exception):
        made = make(**dict.fromkeys((*order, *([clock] if clock else ())), 0.5))
        returned = [each for each in named_parts(step(made)) if each != clock]
        order = returned if {*returned} == {*order} else order

    def moved(t: float, y: Sequence[float], h: float) -> list[Foreign]:
        state = make(**dict(zip(order, map(float, y), strict=True)), **({clock: t} if clock else {}))
        found = step(state, t, h)
        parts = named_parts(state if found is None else found)
        return [parts[each] for each in order]

    call = moved if clock else lambda y, h: moved(0.0, y, h)
    yield StepForm(call, f"the state: {', '.join(order)} of a {name}", state_names=order)


def _form(step: Callable[..., Any], record: Record, slopes: bool, pushed: str, timed: bool) -> Callable[..., Any]:
    """The step of q'' = force(q, v, t) that a step of records makes, without t unless it is `timed`.

    The step calls the function of the name `pushed`: a multiple of the force, or, with `slopes`, what answers with a
    record of the slopes of position and velocity. If the step reads a slope that the record hands on, it is the
    step(force, q, v, acc, h) that returns that at its end as well.
    """
    heavy = bool(pushed) and not calling.is_acceleration(pushed)
    masses = {name: calling.MASS for name in record.given if heavy and calling.word_of(name) in calling.MASSES}
    clocks = [*filter(None, [record.clock])]
    factor = (-1.0 if calling.has_gradient([pushed]) else 1.0) * (calling.MASS if masses else 1.0)

    def end(force: Any, q: Foreign, v: Foreign, t: float, h: float, **handed: Foreign) -> Foreign:
        def asked(*arguments: Foreign) -> Foreign:
            pairs = [pair for pair in map(record.pair, arguments) if pair is not None]
            pushed = force(*pairs[0] if pairs else (), *(x for x in arguments if record.pair(x) is None))
            return record.filled(pairs[0][1], pushed) if slopes else factor * pushed

        unread = {name: 0.0 * q for name, needed in record.slopes.items() if needed}
        state = record.filled(copy(q), copy(v), **{**masses, **dict.fromkeys(clocks, t), **unread, **handed})
        found = step(asked, state, t, h)
        return state if found is None else found

    def moved(force: Any, q: Foreign, v: Foreign, t: float, h: float) -> tuple[Foreign, Foreign]:
        found = end(force, q, v, t, h)
        return record.pair(found) or tuple(found)

    for name, needed in record.slopes.items():
        with suppress(Exception):
            ends = [end(np.negative, 1.0, 0.5, 0.0, 0.25, **{name: x}) for x in (1.0, 2.0)]
            if record.pair(ends[0]) == record.pair(ends[1]) or not (needed or named_parts(ends[0])[name]):
                continue  # it is not read, or is a sum of forces that each step empties
            by = factor if calling.has_gradient([name]) == (factor < 0) else -factor
            by /= abs(by) if calling.is_acceleration(name) or calling.has_gradient([name]) else 1.0
            return _handing_on(end, record, name, by)
    return moved if timed else lambda force, q, v, h: moved(force, q, v, 0.0, h)


def handed_on(step: Callable[..., Any], record: Record) -> Callable[..., Any] | None:
    """The step(q, v, a, h) of a step of a record that reads and hands on the slope of its own system, if it does."""
    form = _form(lambda _, state, t, h: step(state, t, h), record, False, "", False)
    return (lambda q, v, a, h: form(None, q, v, a, h)) if "acc" in inspect.signature(form).parameters else None


def _handing_on(end: Callable[..., Foreign], record: Record, name: str, by: float) -> Callable[..., Any]:
    """The step that is handed the acceleration, of which the record's slope is a multiple, and hands it on."""

    def carried(force: Any, q: Foreign, v: Foreign, acc: Foreign, h: float) -> tuple[Foreign, ...]:
        found = end(force, q, v, 0.0, h, **{name: by * acc})
        return (*(record.pair(found) or tuple(found)), named_parts(found)[name] / by)

    return carried
