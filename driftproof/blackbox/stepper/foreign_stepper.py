"""A foreign stepper as the instruments see it: called with floats, logged, and read back as floats."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, is_dataclass, replace
from itertools import permutations
from math import inf, isfinite
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, NotANumber, NotFinite, StepRaised, UnsupportedCall, WrongShape
from driftproof.blackbox.stepper.array_adapters import (
    ARRAYS,
    LISTS,
    SCALARS,
    AnyNumber,
    ArrayAdapter,
    Foreign,
    as_array,
    type_of,
)
from driftproof.blackbox.stepper.calling_conventions import (
    BESIDES,
    CARRIED,
    FIELD,
    FORCE,
    FUNCTION,
    GRID,
    MAP,
    POSITION,
    QUATERNION,
    STATE,
    STEP,
    TIME,
    VELOCITY,
    CallingConvention,
)
from driftproof.blackbox.stepper.fresh_copies import fresh_copy
from driftproof.blackbox.stepper.run_states import is_generator, states_of_generator, states_of_run
from driftproof.blackbox.stepper.state_forms import part_pair
from driftproof.methods.stepping import oscillator
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat

# A force, or a right-hand side of t and y, of ours: on numbers of the adapter.
ForceFunction: TypeAlias = Callable[[AnyNumber], AnyNumber]
# Of t, positions and velocities.
DraggedForce: TypeAlias = Callable[[AnyNumber, list[AnyNumber], list[AnyNumber]], Sequence[AnyNumber]]
FieldFunction: TypeAlias = Callable[[AnyNumber, list[AnyNumber]], Sequence[AnyNumber]]
# Longer answers are cut where a message shows them: a line of 120 characters holds one and what is said of it.
_MOST_SHOWN = 60
# What a step moves, position before velocity.
_MOVED = (POSITION, VELOCITY, STATE, QUATERNION)
# What is farther than this from a position of 1, a velocity of 3/4 and a time of 0, in a step of 1/4, is none of them.
_UNLIKE, _MOST_ASKED = 0.3, 4
# A sum of times in the narrowest format, with 8 bits after the first, is nearer than this to the true one.
_ABOUT = 2.0**-6


@dataclass
class CallLog:
    """What was seen besides the answers, over all calls: how many, types returned, arguments changed in place."""

    calls: int = 0
    types: set[str] = field(default_factory=set)  # of the answers, as the stepper's library calls them
    changes_its_arguments: bool = False
    works_in_place: bool = False
    beside: list[AnyNumber] | None = None  # what the last step returned after y1: its error estimate, or another y1
    dense: Callable[..., Foreign] | None = None  # its dense output, a function of the time, or of theta
    carried: Foreign = None  # the slope that the last step hands on
    layout: str | None = None  # where the end stands in what a run, or a generator, returns
    asks: tuple[str, ...] = ()  # the roles of what a force was called with first
    states: Sequence[Sequence[AnyNumber]] = ()  # of the last run, the start among them where all are returned


@dataclass
class ForeignStepper:
    """Somebody's stepper, called in its own way.

    `step_with` and `step` take and give numbers of the adapter, floats as a rule. Whatever the stepper does instead of
    answering comes as a `Misbehaviour`. `before` is told each call before it is made, and may refuse it by raising;
    `after` hears when it is over. `pristine` is the code before its first call, None where it cannot be copied; runs of
    fewer steps than `shortest` are not made. A `single` one takes one number, and no state of q and v.
    """

    function: Callable[..., Any]
    convention: CallingConvention
    adapter: ArrayAdapter
    format: FloatFormat = BINARY64
    log: CallLog = field(default_factory=CallLog)
    before: Callable[[str], None] = lambda call: None
    after: Callable[[], None] = lambda: None
    pristine: Callable[..., Any] | None = None
    shortest: int = 1
    single: bool = False

    def fresh(self, steps: int = 1) -> ForeignStepper:
        """The same, remembering nothing; of a code that makes runs, one that makes runs of so many steps.

        Raises UnsupportedCall where the code cannot be copied.
        """
        copied = None if self.pristine is None else fresh_copy(self.pristine)
        if copied is None:
            raise UnsupportedCall("no copy of it can be made that remembers nothing")
        log = CallLog(works_in_place=self.log.works_in_place, layout=self.log.layout)
        return replace(self, function=copied, convention=self.convention.of_steps(steps), log=log)

    def step(self, q: AnyNumber, v: AnyNumber, h: AnyNumber) -> tuple[AnyNumber, AnyNumber]:
        """One step of its own system, or of the oscillator where it takes a force or a right-hand side."""
        if self.convention.kind == MAP:
            return self._map(q, v, h)
        return self.step_with(oscillator, q, v, h)

    def step_with(self, force: ForceFunction, q: AnyNumber, v: AnyNumber, h: AnyNumber) -> tuple[AnyNumber, AnyNumber]:
        """One step of q' = v, v' = force(q). Raises UnsupportedCall where the system is built in."""
        q1, v1 = self.step_forced(lambda t, x: [force(x[0])], self.adapter.number(0.0), [q], [v], h)
        return q1, v1

    def step_forced(
        self,
        force: FieldFunction,
        t: AnyNumber,
        q: Sequence[AnyNumber],
        v: Sequence[AnyNumber],
        h: AnyNumber,
        *,
        interleaved: bool = False,
    ) -> list[AnyNumber]:
        """One step of q' = v, v' = force(t, q): the new positions, then the new velocities.

        A right-hand side is given y = [q..., v...], or [q, v, q, v, ...] where `interleaved`. A force may be asked for
        fewer positions at a time. Raises UnsupportedCall where the system is built in.
        """
        if self.convention.kind == FORCE:
            return self._forced(lambda at, x, velocity: force(at, x), t, q, v, h)
        places = [*range(0, 2 * len(q), 2), *range(1, 2 * len(q), 2)] if interleaved else [*range(2 * len(q))]

        def as_code(numbers: Sequence[AnyNumber]) -> list[AnyNumber]:
            return [numbers[places.index(i)] for i in range(len(numbers))]

        def rate(at: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
            state = [y[i] for i in places]
            return as_code([*state[len(q) :], *force(at, state[: len(q)])])

        stepped = self.step_field(rate, t, as_code([*q, *v]), h)
        return [stepped[i] for i in places]

    def step_dragged(
        self, force: DraggedForce, t: AnyNumber, q: Sequence[AnyNumber], v: Sequence[AnyNumber], h: AnyNumber
    ) -> list[AnyNumber]:
        """One step of q' = v, v' = force(t, q, v), of a code that hands velocities to its force.

        Raises UnsupportedCall for another one.
        """
        if not self.gives_velocities:
            raise UnsupportedCall("its force is given no velocity")
        return self._forced(force, t, q, v, h)

    @property
    def gives_velocities(self) -> bool:
        """True where its force is one of position and velocity."""
        return VELOCITY in self.convention.asks

    def step_field(self, rate: FieldFunction, t: AnyNumber, y: Sequence[AnyNumber], h: AnyNumber) -> list[AnyNumber]:
        """One step of y' = rate(t, y). Raises UnsupportedCall where there is no right-hand side to give."""
        if self.convention.kind != FIELD:
            raise UnsupportedCall(f"the stepper is called by {self.convention.kind!r}, which takes no right-hand side")
        size, write = len(y), self.adapter.write
        roles = {FUNCTION: self.callback(rate, t, size, write), TIME: t, STATE: write(y), STEP: h}
        if CARRIED in self.convention.order:
            roles[CARRIED] = write(rate(t, list(y)))
        if GRID in self.convention.order:
            roles[GRID] = np.array([t + n * h for n in range(self.convention.steps + 1)])
        answer = self.called(roles, f"t={t!r}, y={list(y)!r}, h={h!r}", y)
        return self.finite(self._read_state(answer, size, t + h), [*y, h])

    def callback(
        self, rate: FieldFunction, t: AnyNumber, size: int, write: Callable[[Any], Foreign]
    ) -> Callable[..., Foreign]:
        """What the code calls for rate(t, y), as it calls it: f(t, y), f(y, t), or f(y), of which t is the time."""
        order = self.convention.order
        time_first = TIME not in order or order.index(TIME) < order.index(STATE)

        def called(*arguments: Foreign) -> Foreign:
            state, time = (-1, 0) if time_first else (0, -1)
            try:
                asked = self.adapter.read(arguments[state], size)
            except WrongShape:  # it calls f(y, t), whichever way it takes them itself
                state, time = time, state
                asked = self.adapter.read(arguments[state], size)
            except NotANumber as refusal:
                place = str(refusal).replace("it returns", "it asks for its right-hand side at")
                raise NotANumber(place) from None
            at = self.adapter.read(arguments[time], 1)[0] if len(arguments) > 1 else t
            return write(rate(at, asked))

        return self.adapter.function(called)

    def step_batch(self, qs: Sequence[float], vs: Sequence[float], h: float) -> list[tuple[float, float]]:
        """One step of several states at once, as arrays; under the force -q where it takes one.

        Raises UnsupportedCall where position and velocity are not apart, so that an array is one state.
        """
        if POSITION not in self.convention.order:
            raise UnsupportedCall("position and velocity come in one array, which is one state")
        write = self._of_several.write
        factor, asks = self.convention.factor, self.convention.asks

        def force(*asked: Foreign) -> Foreign:
            return -factor * (asked[asks.index(POSITION)] if asks else max(asked, key=_size))  # a time is one number

        roles = {POSITION: write(qs), VELOCITY: write(vs), STEP: h, TIME: 0.0, CARRIED: write([-q for q in qs])}
        roles[FUNCTION] = force
        answer = self.called(roles, f"q={list(qs)!r}, v={list(vs)!r}, h={h!r}", [*qs, *vs])
        positions, velocities = self.two_parts(answer)
        return list(zip(*(self.adapter.read(part, len(qs)) for part in (positions, velocities)), strict=True))

    def _map(self, q: AnyNumber, v: AnyNumber, h: AnyNumber) -> tuple[AnyNumber, AnyNumber]:
        write = self.adapter.write
        if STATE in self.convention.order:
            words = f"state=[{q!r}, {v!r}], h={h!r}"
            answer = self.called({STATE: write([q, v]), STEP: h, TIME: 0.0}, words, [q, v])
            q1, v1 = self.finite(self._read_state(answer, 2, h), [q, v, h])
            return q1, v1
        roles = {POSITION: write([q]), VELOCITY: write([v]), STEP: h, TIME: 0.0}
        if CARRIED in self.convention.order:
            roles[CARRIED] = write([-q])
        q1, v1 = self._pair(roles, [q], [v], h)
        return q1, v1

    @property
    def _of_several(self) -> ArrayAdapter:
        """The adapter of several positions: what works on one float may work on an array of them."""
        return ARRAYS if self.adapter is SCALARS else self.adapter

    def _forced(
        self, force: DraggedForce, t: AnyNumber, q: Sequence[AnyNumber], v: Sequence[AnyNumber], h: AnyNumber
    ) -> list[AnyNumber]:
        """What the force is called with beside the position, and in which order, its first call tells."""
        adapter, order = self.adapter if len(q) == 1 else self._of_several, self.convention.order

        def callback(*arguments: Foreign) -> Foreign:
            roles = self.convention.asks or self.log.asks or self._roles_asked(adapter, arguments, q, v, t)
            self.log.asks = roles
            given = dict(zip(roles if len(roles) <= len(arguments) else (POSITION,), arguments, strict=False))
            position = given[POSITION]
            size = 1 if _size(position) == 1 else len(q)
            asked = adapter.read(position, size)
            at = adapter.read(given[TIME], 1)[0] if TIME in order and TIME in given else t
            moving = adapter.read(given[VELOCITY], size) if VELOCITY in given else []
            answering = SCALARS if adapter is ARRAYS and np.ndim(position) == 0 else adapter
            return answering.write(scaled(force(at, asked, moving)))

        def scaled(answers: Sequence[AnyNumber]) -> Sequence[AnyNumber]:
            return answers if factor == 1 else [factor * x for x in answers]

        factor, function = self.convention.factor, adapter.function(callback)
        roles = {FUNCTION: function, POSITION: adapter.write(q), VELOCITY: adapter.write(v), STEP: h, TIME: t}
        if CARRIED in order:
            roles[CARRIED] = adapter.write(scaled(force(t, list(q), list(v))))
        return self._pair(roles, q, v, h)

    def _roles_asked(
        self, adapter: ArrayAdapter, arguments: Sequence[Foreign], q: AnyNumber, v: AnyNumber, t: AnyNumber
    ) -> tuple[str, ...]:
        """What a first call's arguments are: what they are nearest to at the start of the step, or of no concern."""
        starts, many = {POSITION: q[0], VELOCITY: v[0], TIME: t}, len(arguments)
        if not 1 < many <= _MOST_ASKED:
            return (POSITION,)

        def off(role: str, asked: Foreign) -> float:
            try:
                return _UNLIKE if role == BESIDES else float(abs(adapter.read(asked, _size(asked))[0] - starts[role]))
            except (NotANumber, WrongShape):
                return inf

        choices = (roles for roles in permutations((*starts, *[BESIDES] * many), many) if POSITION in roles)
        return min(choices, key=lambda roles: sum(map(off, roles, arguments)))

    def _pair(
        self, roles: dict[str, Foreign], q: Sequence[AnyNumber], v: Sequence[AnyNumber], h: AnyNumber
    ) -> list[AnyNumber]:
        shown = [x[0] if len(x) == 1 else list(x) for x in (q, v)]
        answer = self.called(roles, f"q={shown[0]!r}, v={shown[1]!r}, h={h!r}", [*q, *v])
        return self.finite([x for part in self.two_parts(answer) for x in self.read(part, len(q))], [*q, *v, h])

    def two_parts(self, answer: Foreign) -> tuple[Foreign, Foreign]:
        """Position and velocity of an answer. Raises WrongShape."""
        try:
            position, velocity = part_pair(answer)
        except (TypeError, ValueError):
            raise WrongShape(f"it returns {_shown(answer)}, not a pair (q1, v1)") from None
        return position, velocity

    def called(self, roles: dict[str, Foreign], words: str, start: Sequence[AnyNumber]) -> Foreign:
        """What the code returns for these arguments, by role; `words` tell them, `start` are the numbers to be moved.

        Raises a Misbehaviour.
        """
        self.before(words)
        self.log.calls += 1
        values = [roles[role] for role in self.convention.order]
        named = dict(zip(self.convention.names, values, strict=False))  # all of them, or none
        arguments = () if named else values
        kept = {role: _copied(roles[role]) for role in _MOVED if role in roles}
        try:
            answer = self._ended(self.function(*arguments, **named, **self.convention.extra), start)
        except Misbehaviour:
            raise
        except (Exception, SystemExit) as error:
            raise StepRaised(f"step({words}) raises {type(error).__name__}: {' '.join(str(error).split())}") from error
        finally:
            self.after()
        return self._answer(answer, roles, kept)

    def _ended(self, answer: Foreign, start: Sequence[AnyNumber]) -> Foreign:
        """What stands at the end of the step: of a run its last state, of a generator the one after the start."""
        if CARRIED in self.convention.order and isinstance(answer, tuple) and len(answer) > 1:
            self.log.carried, answer = answer[-1], answer[:-1] if len(answer) > 2 else answer[0]
        steps = self.convention.steps
        if is_generator(answer):
            self.log.states, self.log.layout = states_of_generator(answer, start, self.log.layout, steps)
        elif self.convention.run:
            self.log.states, self.log.layout = states_of_run(answer, start, self.log.layout, steps)
        else:
            return answer
        end = self.log.states[-1]
        half = len(start) // 2
        return (end[:half], end[half:]) if POSITION in self.convention.order else end

    def _answer(self, answer: Foreign, roles: dict[str, Foreign], kept: dict[str, Foreign]) -> Foreign:
        """What was returned; where that is None, the arguments, if the step was written into them."""
        changed = any(_differs(roles[role], before) for role, before in kept.items())
        self.log.changes_its_arguments |= changed
        if answer is not None or not (changed or self.log.works_in_place):
            return answer
        self.log.works_in_place = True
        parts = tuple(roles[role] for role in kept if role in self.convention.order)
        return parts if len(parts) > 1 else parts[0]

    def read(self, answer: Foreign, size: int) -> list[AnyNumber]:
        """The numbers of an answer; its type is kept in the log. Raises WrongShape, NotANumber."""
        self.log.types.add(type_of(answer))
        return self.adapter.read(answer, size)

    def _read_state(self, answer: Foreign, size: int, end: AnyNumber) -> list[AnyNumber]:
        """The state that was returned: y1, (t1, y1), (y1, y1_hat), (y1, error), (t1, y1, error), with more behind.

        What comes after y1, an error as one number, too, or a function, is kept in the log. Of one number, what may be
        a time is one only if it is about the end of the step.
        """
        parts = [part for part in answer if not callable(part)] if isinstance(answer, tuple) else []
        self.log.dense = next(filter(callable, answer), None) if isinstance(answer, tuple) else None
        sizes, self.log.beside = [_size(part) for part in parts], None
        if sizes[:2] == [1, size] and (size > 1 or abs(self.adapter.read(parts[0], 1)[0] - end) <= _ABOUT * abs(end)):
            parts, sizes = parts[1:], sizes[1:]
        if sizes[:1] != [size]:
            return self.read(answer, size)
        if len(sizes) > 1 and sizes[1] in (1, size):
            with suppress(NotANumber):
                self.log.beside = self.adapter.read(parts[1], sizes[1])
        return self.read(parts[0], size)

    def finite(self, answer: list[AnyNumber], given: Sequence[AnyNumber]) -> list[AnyNumber]:
        """The answer. Raises NotFinite where what was given is finite, and the answer is not."""
        if all(map(_is_finite, given)) and not all(map(_is_finite, answer)):
            seen = f"from {', '.join(map(repr, given))} it returns {', '.join(map(repr, answer))}"
            raise NotFinite(seen, tuple(answer))
        return answer


def call_text(stepper: ForeignStepper, q: float, v: float, h: float) -> str:
    """The call of a step as a line of Python, `step` being the stepper."""
    calls = stepper.convention
    state_first = {STATE, TIME} <= {*calls.order} and calls.order.index(STATE) < calls.order.index(TIME)
    rates = f"lambda {'y, t' if state_first else 't, y'}: {_as_written(stepper, '[y[1], -y[0]]')}"
    names = {POSITION: "q", VELOCITY: "v", TIME: "t"}
    asked = ", ".join(names.get(role, f"_{place}") for place, role in enumerate(calls.asks or (POSITION,)))
    force = f"lambda {asked}: {-calls.factor:g} * q" if calls.factor != 1 else f"lambda {asked}: -q"
    function = {FORCE: force, FIELD: rates}.get(calls.kind, "")
    slope = (v, -q) if calls.kind == FIELD else (-calls.factor * q,)
    numbers = {POSITION: (q,), VELOCITY: (v,), STATE: (q, v), CARRIED: slope}
    texts = {FUNCTION: function, TIME: "0.0", STEP: _literal(h), GRID: f"[0.0, {_literal(h)}]"}
    arguments = [texts[role] if role in texts else _written(stepper, *numbers[role]) for role in calls.order]
    named = [f"{name}={text}" for name, text in zip(calls.names, arguments, strict=False)]
    extra = [f"{name}={value!r}" for name, value in calls.extra.items()]
    return f"step({', '.join([*(named or arguments), *extra])})"


def _literal(x: float) -> str:
    """x as Python reads it, to the last bit."""
    return repr(x) if isfinite(x) else f'float("{x!r}")'


def _written(stepper: ForeignStepper, *numbers: float) -> str:
    """The numbers as the stepper takes them, with the name of what makes them."""
    if stepper.adapter.shown:
        return _as_shown(stepper.adapter.shown, [*map(_literal, numbers)])
    texts = ", ".join(map(_literal, numbers))
    if stepper.adapter is SCALARS:
        return texts
    return _as_written(stepper, f"[{texts}]" if np.ndim(stepper.adapter.write(numbers)) else texts)


def _as_shown(shown: str, texts: Sequence[str]) -> str:
    return shown.format(*texts) if shown.count("{}") > 1 else shown.format(", ".join(texts))


def _as_written(stepper: ForeignStepper, text: str) -> str:
    if stepper.adapter.shown:
        inner = text[1:-1] if text.startswith("[") else text
        return _as_shown(stepper.adapter.shown, inner.split(", "))
    makers = {LISTS: "", ARRAYS: "numpy.array"}
    maker = makers.get(stepper.adapter, stepper.adapter.name)
    return f"{maker}({text})" if maker else text


def _is_finite(x: AnyNumber) -> bool:
    return not isinstance(x, float) or isfinite(x)


def _size(x: Foreign) -> int:
    try:
        return as_array(x).size
    except NotANumber:  # such as the numbers of another arithmetic
        return 1


def _copied(x: Foreign) -> Foreign:
    copied = getattr(x, "copy", None) or getattr(x, "clone", None)  # arrays and lists; tensors
    return copied() if copied is not None else copy(x) if is_dataclass(x) else x


def _differs(x: Foreign, before: Foreign) -> bool:
    try:  # NaN differs from itself: bytes are compared, not values
        return x is not before and as_array(x).tobytes() != as_array(before).tobytes()
    except NotANumber:  # such as the numbers of another arithmetic, which nobody watches
        return vars(x) != vars(before) if is_dataclass(x) else isinstance(x, dict) and x != before


def _shown(answer: Foreign) -> str:
    text = repr(answer)
    return text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]}..."
