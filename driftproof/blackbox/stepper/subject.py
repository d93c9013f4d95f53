"""A foreign stepper as the instruments see it: called with floats, watched, and read back as floats."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, TypeAlias

from driftproof.blackbox.findings import Misbehaviour, NoSuchDoor, NotANumber, NotFinite, StepRaised, WrongShape
from driftproof.blackbox.stepper.dialects import ARRAYS, SCALARS, Dialect, Foreign, Number, as_array, type_of
from driftproof.blackbox.stepper.doors import FIELD, FORCE, FUNCTION, MAP, POSITION, STATE, STEP, TIME, VELOCITY, Door
from driftproof.methods.problems import oscillator
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat

# A force, or a right-hand side of t and y, of ours: on numbers of the dialect.
Force: TypeAlias = Callable[[Number], Number]
Field: TypeAlias = Callable[[Number, list[Number]], Sequence[Number]]


# Longer answers are cut where a message shows them.
MOST_SHOWN = 60
# A sum of times in the narrowest format is nearer to the true one.
_ABOUT = 2.0**-6


@dataclass
class Watch:
    """What was seen besides the answers, over all calls: how many, types returned, arguments changed in place."""

    calls: int = 0
    types: set[str] = field(default_factory=set)  # of the answers, as the stepper's library calls them
    changes_its_arguments: bool = False
    works_in_place: bool = False


@dataclass
class Subject:
    """A stepper behind its door.

    `step_with` and `step` take and give numbers of the dialect, floats as a rule. Whatever the stepper does instead of
    answering comes as a `Misbehaviour`. `before` is told each call before it is made.
    """

    function: Callable[..., Any]
    door: Door
    dialect: Dialect
    format: FloatFormat = BINARY64
    watch: Watch = field(default_factory=Watch)
    before: Callable[[str], None] = lambda call: None

    def step(self, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        """One step of its own system, or of the oscillator where it takes a force or a right-hand side."""
        if self.door.kind == MAP:
            return self._map(q, v, h)
        return self.step_with(oscillator, q, v, h)

    def step_with(self, force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        """One step of q' = v, v' = force(q). Raises NoSuchDoor where the system is built in."""
        if self.door.kind == FORCE:
            return self._forced(force, q, v, h)
        q1, v1 = self.step_field(lambda t, y: [y[1], force(y[0])], self.dialect.number(0.0), [q, v], h)
        return q1, v1

    def step_field(self, rate: Field, t: Number, y: Sequence[Number], h: Number) -> list[Number]:
        """One step of y' = rate(t, y). Raises NoSuchDoor where there is no right-hand side to give."""
        if self.door.kind != FIELD:
            raise NoSuchDoor(f"the stepper has the door {self.door.kind!r}, which takes no right-hand side")
        size, write = len(y), self.dialect.write
        time_first = TIME not in self.door.order or self.door.order.index(TIME) < self.door.order.index(STATE)

        def callback(*arguments: Foreign) -> Foreign:
            state, time = (-1, 0) if time_first else (0, -1)
            try:
                asked = self.dialect.read(arguments[state], size)
            except WrongShape:  # it calls f(y, t), whichever way it takes them itself
                state, time = time, state
                asked = self.dialect.read(arguments[state], size)
            at = self.dialect.read(arguments[time], 1)[0] if len(arguments) > 1 else t
            return write(rate(at, asked))

        roles = {FUNCTION: callback, TIME: t, STATE: write(y), STEP: h}
        answer = self._call(roles, f"t={t!r}, y={list(y)!r}, h={h!r}")
        return self._finite(self._read_state(answer, size, t + h), [*y, h])

    def step_batch(self, qs: Sequence[float], vs: Sequence[float], h: float) -> list[tuple[float, float]]:
        """One step of several states at once, as arrays; under the force -q where it takes one.

        Raises NoSuchDoor where position and velocity are not apart, so that an array is one state.
        """
        if POSITION not in self.door.order:
            raise NoSuchDoor("position and velocity come in one array, which is one state")
        write = ARRAYS.write if self.dialect is SCALARS else self.dialect.write
        roles = {FUNCTION: lambda q, *_: -q, POSITION: write(qs), VELOCITY: write(vs), STEP: h, TIME: 0.0}
        answer = self._call(roles, f"q={list(qs)!r}, v={list(vs)!r}, h={h!r}")
        positions, velocities = self._two_parts(answer)
        return list(zip(*(self.dialect.read(part, len(qs)) for part in (positions, velocities)), strict=True))

    def _map(self, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        write = self.dialect.write
        if STATE in self.door.order:
            answer = self._call({STATE: write([q, v]), STEP: h, TIME: 0.0}, f"state=[{q!r}, {v!r}], h={h!r}")
            q1, v1 = self._finite(self._read_state(answer, 2, h), [q, v, h])
            return q1, v1
        return self._pair({POSITION: write([q]), VELOCITY: write([v]), STEP: h, TIME: 0.0}, q, v, h)

    def _forced(self, force: Force, q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        write = self.dialect.write

        def callback(position: Foreign, *_: Foreign) -> Foreign:
            return write([force(self.dialect.read(position, 1)[0])])

        roles = {FUNCTION: callback, POSITION: write([q]), VELOCITY: write([v]), STEP: h, TIME: 0.0}
        return self._pair(roles, q, v, h)

    def _pair(self, roles: dict[str, Foreign], q: Number, v: Number, h: Number) -> tuple[Number, Number]:
        answer = self._call(roles, f"q={q!r}, v={v!r}, h={h!r}")
        q1, v1 = self._finite([self._read(part, 1)[0] for part in self._two_parts(answer)], [q, v, h])
        return q1, v1

    def _two_parts(self, answer: Foreign) -> tuple[Foreign, Foreign]:
        try:
            position, velocity = answer
        except (TypeError, ValueError):
            raise WrongShape(f"it returns {_shown(answer)}, not a pair (q1, v1)") from None
        return position, velocity

    def _call(self, roles: dict[str, Foreign], words: str) -> Foreign:
        self.before(words)
        self.watch.calls += 1
        values = [roles[role] for role in self.door.order]
        named = dict(zip(self.door.names, values, strict=False))  # all of them, or none
        arguments = () if named else values
        kept = {role: _copied(x) for role, x in roles.items() if role in (POSITION, VELOCITY, STATE)}
        try:
            answer = self.function(*arguments, **named, **self.door.extra)
        except Misbehaviour:
            raise
        except (Exception, SystemExit) as error:
            raise StepRaised(f"step({words}) raises {type(error).__name__}: {' '.join(str(error).split())}") from error
        return self._answer(answer, roles, kept)

    def _answer(self, answer: Foreign, roles: dict[str, Foreign], kept: dict[str, Foreign]) -> Foreign:
        """What was returned; where that is None, the arguments, if the step was written into them."""
        changed = any(_differs(roles[role], before) for role, before in kept.items())
        self.watch.changes_its_arguments |= changed
        if answer is not None or not (changed or self.watch.works_in_place):
            return answer
        self.watch.works_in_place = True
        return roles[STATE] if STATE in self.door.order else (roles[POSITION], roles[VELOCITY])

    def _read(self, answer: Foreign, size: int) -> list[Number]:
        self.watch.types.add(type_of(answer))
        return self.dialect.read(answer, size)

    def _read_state(self, answer: Foreign, size: int, end: Number) -> list[Number]:
        """The state that was returned, alone or as (t1, y1); (y1, error) is refused, its first being no time.

        Of one number, what may be a time is one only if it is about the end of the step.
        """
        if isinstance(answer, tuple) and len(answer) == 2 and [_size(part) for part in answer] == [1, size]:
            first = self.dialect.read(answer[0], 1)[0]
            if size > 1 or abs(first - end) <= _ABOUT * abs(end):
                answer = answer[1]
        return self._read(answer, size)

    def _finite(self, answer: list[Number], given: Sequence[Number]) -> list[Number]:
        if all(map(_is_finite, given)) and not all(map(_is_finite, answer)):
            seen = f"from {', '.join(map(repr, given))} it returns {', '.join(map(repr, answer))}"
            raise NotFinite(seen, tuple(answer))
        return answer


def _is_finite(x: Number) -> bool:
    return not isinstance(x, float) or isfinite(x)


def _size(x: Foreign) -> int:
    try:
        return as_array(x).size
    except NotANumber:  # such as the numbers of another arithmetic
        return 1


def _copied(x: Foreign) -> Foreign:
    copy = getattr(x, "copy", None) or getattr(x, "clone", None)  # arrays and lists; tensors
    return x if copy is None else copy()


def _differs(x: Foreign, before: Foreign) -> bool:
    try:  # NaN differs from itself: bytes are compared, not values
        return x is not before and as_array(x).tobytes() != as_array(before).tobytes()
    except NotANumber:  # such as the numbers of another arithmetic, which nobody watches
        return False


def _shown(answer: Foreign) -> str:
    text = repr(answer)
    return text if len(text) <= MOST_SHOWN else f"{text[:MOST_SHOWN]}..."
