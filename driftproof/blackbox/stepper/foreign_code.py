"""Calls of foreign code: arguments by role, answers read in any of their forms, and a log of what was seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, is_dataclass
from itertools import islice
from math import isfinite
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.findings import Misbehaviour, NotANumber, NotFinite, PositionsAlone, StepRaised, WrongShape
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.array_adapters import AnyNumber, ArrayAdapter, Foreign, as_array, type_of
from driftproof.blackbox.stepper.records import clock_of, in_parts, part_pair, parts_of, run_parts
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat

FieldFunction: TypeAlias = Callable[[AnyNumber, list[AnyNumber]], Sequence[AnyNumber]]
# Messages cut longer answers: a line of 120 characters then holds the answer and what is said about it.
_MOST_SHOWN = 60
# The roles of the arguments that a step moves, position before velocity.
_MOVED = (calling.POSITION, calling.VELOCITY, calling.STATE, calling.QUATERNION)
# A sum of times in the narrowest format, with 8 bits after the first, is closer than this to the exact one.
_ABOUT = 2.0**-6
# Complex steps for a Jacobian are shorter; they are answered by differences between states this far apart.
_COMPLEX_STEP, _SHIFT = 1e-7, 2.0**-20
# Where the states stand in what a run returns; _END if only the last one comes.
_ROWS, _COLUMNS, _END = "rows", "columns", "end"
# The start comes back rounded to the format of the run, which has at least 11 bits.
_SAME = 2.0**-10


@dataclass
class CallLog:
    """What all calls showed besides their answers: the types returned, arguments changed in place, and so on."""

    calls: int = 0
    types: set[str] = field(default_factory=set)  # of the numbers in answers, as their library calls them
    changes_its_arguments: bool = False
    slopes: list[tuple[Foreign, Foreign]] = field(default_factory=list)  # that the last call got, with copies of them
    changes_slopes: bool = False
    works_in_place: bool = False
    beside: list[AnyNumber] | None = None  # after y1 in the last answer: an error estimate or another y1
    dense: Callable[..., Foreign] | None = None  # the last dense output, a function of the time or of theta
    carried: Foreign = None  # the slope that the last step hands on
    layout: str | None = None  # where the end stands in what a run, or a generator, returns
    timed: bool | None = None  # whether the last answer of several parts begins with a time
    clock: float | None = None  # the time in the last answer, or what stands in its place
    asks: tuple[str, ...] = ()  # the roles of the arguments in the first call of a force
    states: Sequence[Sequence[AnyNumber]] = ()  # of the last run, with the start where all are returned


@dataclass(eq=False)
class ForeignCode:
    """Foreign code, called by its own convention; whatever it does instead of answering is raised as a `Misbehaviour`.

    `before` receives each call as text before it is made and may refuse it by raising; `after` is called when it is
    over. `pristine` is the code before its first call, or None if it cannot be copied. Runs of fewer steps than
    `shortest` are not made. `single` is true for code that takes one number, so that q and v do not fit into its state.
    `begun` is the first step of all, as a function of the code that makes it again, with the end that it had. If it is
    made `anew`, a copy without memory makes each step.
    """

    function: Callable[..., Any]
    convention: calling.CallingConvention
    adapter: ArrayAdapter
    format: FloatFormat = BINARY64
    log: CallLog = field(default_factory=CallLog)
    before: Callable[[str], None] = lambda call: None
    after: Callable[[], None] = lambda: None
    pristine: Callable[..., Any] | None = None
    shortest: int = 1
    single: bool = False
    begun: tuple[Callable[[Any], Sequence[float]], Sequence[float]] | None = None
    anew: bool = False

    def callback(
        self, rate: FieldFunction, t: AnyNumber, size: int, write: Callable[[Any], Foreign]
    ) -> Callable[..., Foreign]:
        """The function that the code calls for rate(t, y), as f(t, y), f(y, t), or f(y), where `t` is then the time.

        With a single number, sizes do not tell the two arguments apart. The first call of all then decides: the time is
        the argument closer to the time at which the step begins.
        """
        order = self.convention.order

        def called(*passed: Foreign) -> Foreign:
            arguments = [x for x in passed if x is not None and np.size(x)] or passed  # without empty parameters
            known = self.convention.asks or self.log.asks
            likely = known or order
            time_first = calling.TIME not in likely or likely.index(calling.TIME) < likely.index(calling.STATE)
            if not known and size == 1 and len(arguments) > 1:
                first, last = (abs(x - t) for i in (0, -1) for x in self.adapter.read(arguments[i], 1))
                time_first = first < last or (first == last and time_first)
            state, time = (-1, 0) if time_first else (0, -1)
            try:
                asked = self.adapter.read(arguments[state], size)
            except WrongShape:  # it calls f in the other order than it takes them itself
                state, time = time, state
                asked = self.adapter.read(arguments[state], size)
            except NotANumber as refusal:
                near = np.asarray(arguments[state])
                if near.dtype.kind == "c" and 0 < (off := abs(near.imag).max()) < _COMPLEX_STEP:
                    ends = [
                        called(*(near.real + by * near.imag if x is arguments[state] else x for x in passed))
                        for by in (0.0, _SHIFT / off)
                    ]
                    return ends[0] + 1j * np.subtract(ends[1], ends[0]) * (off / _SHIFT)
                place = str(refusal).replace("it returns", "it asks for its right-hand side at")
                raise NotANumber(place) from None
            if len(arguments) > 1 and not known:
                self.log.asks = (calling.STATE, calling.TIME) if time else (calling.TIME, calling.STATE)
            (at,) = self.adapter.read(arguments[time], 1) if len(arguments) > 1 else (t,)
            return self.answered(write(rate(at, asked)))

        return self.adapter.function(called)

    def answered(self, slopes: Foreign) -> Foreign:
        """The slopes, which are an answer to the code; it is logged if the code changes them."""
        self.log.slopes.append((slopes, _copied(slopes)))
        return slopes

    def two_parts(self, answer: Foreign) -> tuple[Foreign, Foreign]:
        """The position and the velocity in an answer. Raises WrongShape."""
        try:
            first, second = part_pair(answer)
        except (TypeError, ValueError):
            text = repr(answer)
            shown = text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]}..."
            raise WrongShape(f"it returns {shown}, not a pair (q1, v1)") from None
        return (second, first) if self.convention.velocity_first else (first, second)

    def called(self, roles: dict[str, Foreign], words: str, start: Sequence[AnyNumber]) -> Foreign:
        """What the code returns for these arguments, given by role. Raises a Misbehaviour.

        `words` are the call as text, `start` holds the numbers that the step moves.
        """
        self.before(words)
        self.log.calls += 1
        self.log.slopes.clear()
        values = [roles[role] for role in self.convention.order]
        named = dict(zip(self.convention.names, values, strict=False))  # either all arguments or none
        arguments = () if named else values
        kept = {role: _copied(roles[role]) for role in _MOVED if role in roles}
        call = lambda: self._ended(self.function(*arguments, **named, **self.convention.extra), start)
        return self._answer(guarded_call(f"step({words})", call, self.after), roles, kept)

    def _ended(self, answer: Foreign, start: Sequence[AnyNumber]) -> Foreign:
        """The state at the end: the last one of a run, or the one that a generator yields after the start."""
        parts = len(answer) if isinstance(answer, tuple) and calling.CARRIED in self.convention.order else 0
        pair = parts == 2 and calling.POSITION in self.convention.order and size_of(answer[0]) == len(start) // 2
        if parts > 1 and not pair:
            self.log.carried, answer = answer[-1], answer[:-1] if len(answer) > 2 else answer[0]
        steps = self.convention.steps
        if answer is None:  # a run may be made in place
            return None
        if hasattr(answer, "__next__"):
            self.log.states, self.log.layout = _states_of_generator(answer, start, self.log.layout, steps)
        elif self.convention.run:
            self.log.states, self.log.layout = _states_of_run(answer, start, self.log.layout, steps)
        else:
            return answer
        end = self.log.states[-1]
        half = len(start) // 2
        return (end[:half], end[half:]) if calling.POSITION in self.convention.order else end

    def _answer(self, answer: Foreign, roles: dict[str, Foreign], kept: dict[str, Foreign]) -> Foreign:
        """What was returned; if that is None and the step was written into its arguments, these."""
        changed = any(_differs(roles[role], before) for role, before in kept.items())
        self.log.changes_its_arguments |= changed
        self.log.changes_slopes |= any(_differs(*pair) for pair in self.log.slopes)
        if answer is not None or not (changed or self.log.works_in_place):
            return answer
        self.log.works_in_place = True
        parts = tuple(roles[role] for role in kept if role in self.convention.order)
        if self.convention.run:
            self.log.states = [np.concatenate([as_array(part).ravel() for part in parts]).tolist()]
        return parts if len(parts) > 1 else parts[0]

    def read(self, answer: Foreign, size: int) -> list[AnyNumber]:
        """The numbers in an answer, whose type is logged. Raises WrongShape or NotANumber."""
        self.log.types.add(type_of(answer))
        if size_of(answer) % max(1, self.adapter.together):
            raise WrongShape(f"{size_of(answer)} numbers of a vector came out")
        return self.adapter.read(answer, size)

    def _read_state(self, answer: Foreign, size: int, end: AnyNumber) -> list[AnyNumber]:
        """The state in an answer y1, (t1, y1), (y1, y1_hat), (y1, error) or (t1, y1, error), or in a longer tuple.

        What follows y1 is logged: the other solution, an error estimate, which may be one number, or a dense output. If
        the state is one number, the first answer of all decides whether it begins with the time, close to `end`.
        """
        if self.convention.kind == calling.FIELD and not isinstance(self.function, type):  # which makes an object
            answer = in_parts(answer)
        parts = [part for part in answer if not callable(part)] if isinstance(answer, tuple) else []
        self.log.dense = next(filter(callable, answer), None) if isinstance(answer, tuple) else None
        sizes, self.log.beside = [size_of(part) for part in parts], None
        if len(sizes) > 1:
            timed = self.convention.timed if size == 1 else sizes[:2] == [1, size]
            if timed is None and (timed := sizes[:2] == [1, 1]):
                timed = any(abs(x - end) <= _ABOUT * abs(end) for x in self.adapter.read(parts[0], 1))
            (self.log.clock,) = self.adapter.read(parts[0], 1) if timed else (None,)
            self.log.timed, parts, sizes = timed, parts[timed:], sizes[timed:]
        elif (clock := clock_of(answer)) is not None:
            self.log.clock = float(clock)
        if sizes[:1] != [size]:
            return self.read(answer, size)
        if len(sizes) > 1 and sizes[1] in (1, size):
            with suppress(NotANumber):
                self.log.beside = self.adapter.read(parts[1], sizes[1])
        return self.read(parts[0], size)

    def finite(self, answer: list[AnyNumber], given: Sequence[AnyNumber]) -> list[AnyNumber]:
        """The answer itself. Raises NotFinite if it is not finite although all given numbers are."""
        if all(map(_is_finite, given)) and not all(map(_is_finite, answer)):
            seen = f"from {', '.join(map(repr, given))} it returns {', '.join(map(repr, answer))}"
            raise NotFinite(seen, tuple(answer))
        return answer


def guarded_call(words: str, call: Callable[[], Foreign], after: Callable[[], None]) -> Foreign:
    """What a call of foreign code returns; `after` is called when it is over. Raises StepRaised for its exceptions."""
    try:
        return call()
    except Misbehaviour:
        raise
    except (Exception, SystemExit) as error:
        raise StepRaised(f"{words} raises {type(error).__name__}: {' '.join(str(error).split())}") from error
    finally:
        after()


def _is_finite(x: AnyNumber) -> bool:
    return not isinstance(x, float) or isfinite(x)


def size_of(x: Foreign) -> int:
    """How many numbers x holds."""
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
    except NotANumber:  # such as the numbers of another arithmetic; they are not compared
        return parts_of(x) != parts_of(before)


def _states_of_run(answer: Any, start: Sequence[Any], layout: str | None, steps: int) -> tuple[Any, str]:
    """The states of a run and their layout, known or detected: rows, columns, or the end alone. Raises WrongShape."""
    size, table = len(start), _table(answer, len(start))
    if table.ndim == 3 and len(table) == 2 and _is_start(start, table[:, 0].ravel()):  # rows of q, and rows of v
        table = np.concatenate(table, axis=-1).T
    if table.size == size:
        return [table.ravel()], _END
    if table.shape == (steps + 1, size) and (layout == _ROWS or (layout is None and _is_start(start, table[0]))):
        return table, _ROWS
    if table.shape == (size, steps + 1) and (layout == _COLUMNS or _is_start(start, table[:, 0])):
        return table.T, _COLUMNS
    if steps > 1 and table.size * 2 == (steps + 1) * size and np.array_equal(table[0].ravel(), start[: size // 2]):
        raise PositionsAlone(f"of {steps} steps it returns {steps + 1} positions and no velocities")
    made = "one step" if steps == 1 else f"{steps} steps"
    why = f"not {'two' if steps == 1 else steps + 1} states"
    if table.shape == (steps + 1, size):
        alike = bool(np.all(table == table[0]))
        why = "whose rows are all equal, as of one array appended again and again" if alike else "not from the start on"
    raise WrongShape(f"of {made} from {list(start)!r} it returns an array of shape {table.shape}, {why}")


def _states_of_generator(
    generator: Any, start: Sequence[Any], layout: str | None, steps: int
) -> tuple[Sequence[Any], str]:
    """The states that a generator yields, after the start, and their layout. Raises NotANumber if there are none."""
    parts = (each if isinstance(each, tuple) else (each,) for each in islice(generator, steps + 1))
    # In (t, y) and (q, v), the numbers of the state come last.
    states = [np.concatenate([as_array(part).ravel() for part in each])[-len(start) :] for each in parts]
    if not states:
        raise NotANumber("the generator ends before it yields a state")
    if len(states) == len(start) and all(state.size == 1 for state in states):  # one state, number by number
        return [np.concatenate(states)], _END
    found = layout or (_ROWS if _is_start(start, states[0]) else _END)
    return (states if found == _ROWS else [np.array(start), *states[:steps]]), found


def _is_start(start: Sequence[Any], state: np.ndarray[Any, Any]) -> bool:
    return state.shape == (len(start),) and bool(np.allclose(state, start, rtol=_SAME))


def _table(answer: Any, size: int) -> np.ndarray[Any, Any]:
    """The states of (ts, ys), (ts, qs, vs) or (qs, vs) as one array, without the times; or of these by name."""
    answer = run_parts(answer)
    parts = list(answer) if isinstance(answer, tuple) else []
    if len(parts) > 1 and np.ndim(parts[0]) == 1 and (len(parts) == size + 1 or np.ndim(parts[1]) == 2):
        answer = parts[1:] if len(parts) > 2 else parts[1]
    return as_array(answer)
