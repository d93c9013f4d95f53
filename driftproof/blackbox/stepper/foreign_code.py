"""Calls of foreign code: arguments by role, answers read in any of their forms, and a log of what was seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, is_dataclass
from itertools import islice, takewhile
from math import isfinite
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.findings import (
    ArgumentsExchanged,
    AskedAtNoState,
    Misbehaviour,
    NotANumber,
    NotFinite,
    NothingReturned,
    StepRaised,
    WrongAnswer,
    WrongShape,
)
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber, ArrayAdapter, Foreign, as_array, type_of
from driftproof.blackbox.stepper.states.named_answers import (
    clock_of,
    in_parts,
    named_pair,
    part_pair,
    parts_of,
    run_parts,
)
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
    returned: int = 0  # how many parts the answer has that holds it
    layout: str | None = None  # where the end stands in what a run, or a generator, returns
    timed: int | None = None  # how many numbers stand before the state in the last answer of several parts
    parts: Sequence[Foreign] = ()  # of the last answer of more than two whose places are not known
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

        def called(*passed: Foreign) -> Foreign:
            arguments = [x for x in passed if x is not None and np.size(x)] or passed  # without empty parameters
            known = self.convention.asks or self.log.asks
            state, time = self._places_asked(arguments, t, size)
            try:
                asked = self.adapter.read(arguments[state], size)
            except WrongShape:  # it calls f in the other order than it takes them itself
                state, time = time, state
                asked = self.adapter.read(arguments[state], size)
                if known:
                    first, other = ("f(y, t)", "f(t, y)")[:: 1 if time == 0 else -1]
                    raise ArgumentsExchanged(f"of the calls in a step one is {other}, others are {first}") from None
            except NotANumber as refusal:
                near = np.asarray(arguments[state])
                if near.dtype.kind == "c" and 0 < (off := abs(near.imag).max()) < _COMPLEX_STEP:
                    ways = (near.real + by * near.imag for by in (0.0, _SHIFT / off))
                    start, end = (called(*(y if x is arguments[state] else x for x in passed)) for y in ways)
                    return start + 1j * np.subtract(end, start) * (off / _SHIFT)
                place = str(refusal).replace("it returns", "it asks for its right-hand side at")
                raise AskedAtNoState(place) from None
            if len(arguments) > 1 and not known:
                self.log.asks = (calling.STATE, calling.TIME) if time else (calling.TIME, calling.STATE)
            (at,) = self.adapter.read(arguments[time], 1) if len(arguments) > 1 else (t,)
            return self.answered(write(rate(at, asked)))

        return self.adapter.function(called)

    def _places_asked(self, arguments: Sequence[Foreign], t: AnyNumber, size: int) -> tuple[int, int]:
        """The likeliest places of the state and of the time among the arguments of its function."""
        known = self.convention.asks or self.log.asks
        likely = known or self.convention.order
        time_first = calling.TIME not in likely or likely.index(calling.TIME) < likely.index(calling.STATE)
        if not known and size == 1 and len(arguments) > 1:
            first, last = (abs(x - t) for i in (0, -1) for x in self.adapter.read(arguments[i], 1))
            time_first = first < last or (first == last and time_first)
        return (-1, 0) if time_first else (0, -1)

    def answered(self, slopes: Foreign) -> Foreign:
        """The slopes, which are an answer to the code; it is logged if the code changes them."""
        self.log.slopes.append((slopes, _copied(slopes)))
        return slopes

    def two_parts(self, answer: Foreign) -> tuple[Foreign, Foreign]:
        """The position and the velocity in an answer, by their places if more stands there. Raises WrongShape."""
        parts: list[Foreign] = []
        try:
            parts = unfolded([*part_pair(answer)])
            first, second = [parts[i] for i in self.convention.places] or parts
        except (TypeError, ValueError, IndexError):
            self.log.parts, text = parts, repr(answer)
            shown = text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]}..."
            kind = NothingReturned if answer is None else WrongShape
            raise kind(f"it returns {shown}, not a pair (q1, v1)") from None
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
        """The state at the end: the last one of a run, or the one that a generator yields after the start, or alone."""
        parts = len(answer) if isinstance(answer, tuple) and calling.CARRIED in self.convention.order else 0
        pair = parts == 2 and calling.POSITION in self.convention.order and size_of(answer[0]) == len(start) // 2
        if parts > 1 and not pair and (place := self.convention.handed) is not None:
            self.log.carried, self.log.returned = answer[place], parts
            answer = tuple(x for i, x in enumerate(answer) if i != place % parts)
            answer = answer if len(answer) > 1 else answer[0]
        steps = self.convention.steps
        if answer is None:  # a run may be made in place
            return None
        yielded = [*islice(answer, steps + 1)] if hasattr(answer, "__next__") else []
        if len(yielded) == 1 and self.log.layout is None:
            return yielded[0]
        if hasattr(answer, "__next__"):
            self.log.states, self.log.layout = _states_of_generator(yielded, start, self.log.layout, steps)
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
        parts = tuple(roles[role] for role in kept if role in self.convention.order)
        if not (changed or self.log.works_in_place) or not (answer is None or self._beside(answer, parts)):
            return answer
        self.log.works_in_place = True
        if self.convention.run:
            self.log.states = [np.concatenate([as_array(part).ravel() for part in parts]).tolist()]
        return parts if len(parts) > 1 else parts[0]

    def _beside(self, answer: Foreign, parts: Sequence[Foreign]) -> bool:
        """True if a step that writes into its arguments returns something else: fewer numbers, such as the time."""
        with suppress(NotANumber):
            return self.log.works_in_place or as_array(answer).size < sum(map(size_of, parts))
        return False

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
        if not self.adapter.parts and not isinstance(self.function, type):  # a class makes an object
            pair = named_pair(answer) if self.convention.kind == calling.MAP else []
            answer = np.concatenate([as_array(x).ravel() for x in pair]) if pair else in_parts(answer)
        parts = [part for part in answer if not callable(part)] if _is_of_parts(answer) else []
        self.log.dense = next(filter(callable, answer), None) if parts else None
        sizes, self.log.beside = [size_of(part) for part in parts], None
        if len(sizes) > 1:
            before = self.convention.timed if size == 1 else len([*takewhile(lambda n: n == 1, sizes)])
            first: list[AnyNumber] = []
            with suppress(NotANumber):
                first = self.adapter.read(parts[0], 1) if sizes[0] == 1 else []
            if before is None:
                before = int(sizes[1] == 1 and any(abs(x - end) <= _ABOUT * abs(end) for x in first))
            elif sizes[before : before + 1] != [size]:
                before = 0
            self.log.clock = first[0] if first and before == 1 else None
            self.log.timed, parts, sizes = before, parts[before:], sizes[before:]
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


def _is_of_parts(answer: Foreign) -> bool:
    """True for a tuple, and for a list that is no array, such as [t1, y1]."""
    try:
        return isinstance(answer, tuple) or (isinstance(answer, list) and len({*map(np.shape, answer)}) > 1)
    except ValueError:  # of a part that is none either
        return True


def unfolded(parts: list[Foreign]) -> list[Foreign]:
    """The parts (q1, v1, t1) of ((q1, v1), t1), where one of two is larger than all others; else as they are.

    >>> unfolded([0.25, (1.0, 0.5)])
    [0.25, 1.0, 0.5]
    """
    sizes = [*map(size_of, parts)]
    place = sizes.index(max(sizes))
    if sizes.count(sizes[place]) > 1 or sizes[place] == 1 or len(parts[place]) != 2:
        return parts
    return [*parts[:place], *parts[place], *parts[place + 1 :]]


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
        raise WrongShape(f"of {steps} steps it returns {steps + 1} positions and no velocities")
    made = "one step" if steps == 1 else f"{steps} steps"
    why = f"not {'two' if steps == 1 else steps + 1} states"
    said = f"of {made} from {list(start)!r} it returns an array of shape {table.shape}, "
    if table.shape == (steps + 1, size):
        if np.all(table == table[0]):
            raise WrongAnswer(f"{said}whose rows are all equal, as of one array appended again and again")
        why = "not from the start on"
    raise WrongShape(said + why)


def _states_of_generator(
    yielded: Sequence[Any], start: Sequence[Any], layout: str | None, steps: int
) -> tuple[Sequence[Any], str]:
    """The states that a generator yields, after the start, and their layout. Raises NotANumber if there are none."""
    parts = (each if isinstance(each, tuple) else (each,) for each in yielded)
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
