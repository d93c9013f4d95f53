"""Opening a stepper: detect its calling convention, find the numbers it takes, and see its precision."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, product
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.findings import (
    BadInput,
    Exchanged,
    Increment,
    Misbehaviour,
    NotANumber,
    OwnClock,
    StaleSlope,
    WrongShape,
)
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.array_adapters import (
    ARRAYS,
    LISTS,
    SCALARS,
    AnyNumber,
    ArrayAdapter,
    adapters_of,
    as_array,
)
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.fresh_copies import fresh_copy
from driftproof.blackbox.stepper.function_wrappers import list_wrapper, name_of, positions_wrapper
from driftproof.blackbox.stepper.handed_slopes import with_slopes_kept
from driftproof.blackbox.stepper.made_wrappers import clock_wrapper, kept_wrapper, owner_of
from driftproof.blackbox.stepper.named_forms import named_forms
from driftproof.blackbox.stepper.plain_forms import Numbers, plain_forms
from driftproof.blackbox.stepper.records import record_forms
from driftproof.blackbox.stepper.second_functions import SecondFunction, with_functions, with_own_jacobian, zeros
from driftproof.blackbox.stepper.state_forms import COMPLEX, SYSTEMS, forms_of
from driftproof.blackbox.stepper.turning import Push, step_in_fields, turn_quaternion
from driftproof.blackbox.stepper.wrappers import (
    OWN_STEP,
    exchange_wrapper,
    increment_wrapper,
    negation_wrapper,
    template,
    uncalled,
    wrapper_line,
)
from driftproof.support.environment import imported_object
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat

# The state and the step size of trials: nothing cancels, and every term of a step is of ordinary size.
TRIAL_STATE, TRIAL_STEP = (1.0, 0.75), 0.25
# A step of 1/4 does not halve the oscillator's state. If an answer is smaller and a step of 2^-10, which moves numbers
# by no more than that, returns 0 to within the third, it is an increment.
_SUSPICIOUS, _TINY, _NEAR = 0.5, 2.0**-10, 2.0**-8
# A short step where y' = 1 goes this many times as far as h at most, or the part of it at least.
_WITHIN = 8
# A run of this many steps is longer than the start of any multistep method in use.
_LONGER = 8
# The relative distance allowed to times, velocities and masses: numbers of 11 bits are closer.
_AS_CARRIED = 2.0**-8
# That allowed to the slope at the end: what a solver in use leaves there, or some roundings of a narrow format.
_AT_END, _ROUNDINGS = 2.0**-20, 16
# The arguments of a wrapper that is a function, and names in it.
_HEAD, _WORD = re.compile(r"def wrapped\((.*?)\): "), re.compile(r"[A-Za-z_]\w*")
# The format for each ending of the name of an answer's type; of several, the widest is that of the step.
_FORMATS = {"float16": BINARY16, "float32": BINARY32, "float64": BINARY64}


def opened(
    step: Callable[..., Any],
    calls: str | None = None,
    array: Callable[[Any], Any] | None = None,
    before: Callable[[str], None] = lambda call: None,
    after: Callable[[], None] = lambda: None,
) -> ForeignStepper:
    """Open the stepper: return it as a `ForeignStepper`, with the first adapter in which it answers.

    `array` makes the stepper's own numbers from a list of floats (torch.tensor, ...) or from one float (numpy.float32).
    `before` receives each call as text before it is made; `after` is called when it is over. Raises ValueError if no
    calling convention fits, and OwnClock. If no adapter gets an answer, raises StaleSlope if there was one, else the
    `Misbehaviour` of the most natural adapter.
    """
    own = with_own_jacobian(step) if calls == calling.FIELD else step
    given, step, failures = step, with_slopes_kept(own), list[Misbehaviour]()

    def first_of(attempts: Iterable[Callable[[], ForeignStepper]]) -> ForeignStepper | None:
        for attempt in attempts:
            try:
                return attempt()
            except OwnClock:
                raise
            except Misbehaviour as failure:
                failures.append(failure)
            except BadInput as refused:  # of a form, which another one may fit
                failures.append(WrongShape(str(refused)))
        return None

    def as_plain() -> ForeignStepper | None:
        forms = chain(plain_forms(step), record_forms(step)) if calls is None else ()
        return first_of(partial(opened, form, None, array, before, after) for form in forms)

    def as_named() -> ForeignStepper | None:
        return first_of(partial(_read_by_values, form, calls, array, before, after) for form in named_forms(step))

    try:
        conventions = calling.conventions_of(step, calls)
    except ValueError as error:
        if found := as_plain() or as_named():
            return found
        if stale := [failure for failure in failures if isinstance(failure, StaleSlope)]:
            raise stale[0] from None
        line = _tried_out(wrapper_line(given), given)
        if calls is not None:
            raise BadInput(f"{error}{line * line.startswith(':')}") from None
        raise BadInput(f"{_unfitting(given)}{line or template(given)}") from None
    if calling.MASSES[-1] in (calling.required_names(step) or ()) and (found := as_plain()):
        return found  # with unequal masses, before one of all
    made = partial(ForeignStepper, step, before=before, after=after, pristine=fresh_copy(step))
    trials = (
        partial(_tried, made(convention, adapter, single=trial in (_one_number, _ONE_WITH_DERIVATIVE)), trial)
        for convention in conventions
        for adapters in _adapters(step, convention, array)
        for trial, adapter in product(_TRIALS.get(convention.kind, (_one_step,)), adapters)
    )
    found = first_of(trials)
    doubtful = not found or found.convention.kind == calling.MAP
    if doubtful and calls in (None, calling.MAP) and array is None and (form := _of_more_numbers(step, conventions[0])):
        return opened(form, None, None, before, after)
    if found and not _stands_still(found):
        alone = (
            found.convention.run if found.single else {*found.convention.extra} & {*calling.MASSES} and drifts(found)
        )
        return (as_plain() if alone else None) or found  # of n numbers, or of bodies that attract each other
    # Of three numbers, or of a grid.
    lacking = found or isinstance(failures[0], WrongShape) or isinstance(failures[0].__cause__, ValueError | IndexError)
    states = (each for each in conventions if lacking and each.kind == calling.MAP and calling.STATE in each.order)
    systems = first_of(partial(_tried, made(*each), _one_step) for each in product(states, SYSTEMS))
    if systems and systems.adapter is SYSTEMS[0] and _moves_one(systems):  # as the cell between those at the borders
        systems = first_of([partial(_tried, made(systems.convention, SYSTEMS[1]), _one_step)]) or systems
    if found := systems if systems and not _stands_still(systems) else found:
        return found
    line = _tried_out(wrapper_line(step), step) if inspect.isclass(step) else list_wrapper(given)
    if any(failure.kind == "positions_alone" for failure in failures):
        line = positions_wrapper(given)
    if inspect.isclass(step) and isinstance(failures[0], NotANumber):  # its call makes an object
        line = line or template(given)
    if line:
        raise BadInput(f"{_unfitting(given)}{'' if inspect.isclass(step) else ': '}{line}")
    if not any(isinstance(failure, StaleSlope) for failure in failures) and (found := as_plain()):
        return found
    why = next((failure for failure in failures if isinstance(failure, StaleSlope)), failures[0])
    asked = why.__cause__
    if isinstance(asked, BadInput):
        raise asked
    if isinstance(asked, AttributeError) and isinstance(asked.obj, np.ndarray | list | tuple | float):
        theirs = f"asks what it is given for .{asked.name}, and what else that holds is not known; write"
        raise BadInput(f"{calling.signature_text(given)} {theirs}{OWN_STEP} that makes it") from asked
    raise why


def _read_by_values(form: Callable[..., Any], *options: Any) -> ForeignStepper:
    """The subject of a form whose names are a guess, which a short step has to leave where it is."""
    found = opened(form, *options)
    for trial in _TRIALS.get(found.convention.kind, (_one_step,)):
        with suppress(Misbehaviour):
            end = trial(found, _TINY**2)
            if np.allclose(end, TRIAL_STATE[: len(end)], rtol=0, atol=_NEAR):
                return found
    raise WrongShape("a short step does not leave its state where it is")


def _of_more_numbers(step: Callable[..., Any], found: calling.CallingConvention) -> Callable[..., Any] | None:
    """The form of a step that returns, by their values, more of its arguments than those that names make its state.

    Only a step that takes something besides a state is tried, as a copy, so that a step does not notice it.
    """
    doubtful = found.kind in (calling.MAGNETIC, calling.ROTATION) or (found.kind == calling.MAP and found.extra)
    if not doubtful or (copy := fresh_copy(step)) is None or (numbers := Numbers.of(copy)) is None:
        return None
    roles = (calling.POSITION, calling.VELOCITY, calling.STATE)
    states = {name for role, name in found.named(step) if role in roles}
    return replace(numbers, step=step).form if states < {*numbers.names} else None


def _stands_still(subject: ForeignStepper) -> bool:
    """True if the state of a built-in system is where it was after its first step, as both ends of a grid are."""
    given = subject.convention
    still = subject.begun is not None and np.array_equal(subject.begun[1], TRIAL_STATE)
    return still and given.kind == calling.MAP and calling.STATE in given.order


def _moves_one(subject: ForeignStepper) -> bool:
    """True if a step of a built-in system moves one of its numbers alone."""
    start = as_array(subject.adapter.write(TRIAL_STATE)).tolist()
    return int(np.count_nonzero(np.subtract(subject.step_state(start, TRIAL_STEP), start))) == 1


def drifts(subject: ForeignStepper) -> bool:
    """True if no force acts in the system that is built in, as on one body where bodies attract each other."""
    (q, v), end = TRIAL_STATE, subject.begun and subject.begun[1]
    return subject.convention.kind == calling.MAP and np.array_equal(end or (), (q + TRIAL_STEP * v, v))


def _tried_out(line: str, step: Callable[..., Any]) -> str:
    """The wrapper, if it makes a short step of y' = 1 or q'' = 1 when it is pasted after the code; else what it lacks.

    One that leaves something to write cannot be tried. What is wrong with the code itself is told when it is pasted.
    """
    text, _, said = line.removeprefix(": ").partition("  # ")
    if "wrapped" not in text:
        return line
    if "built in" in said:
        return f"{OWN_STEP}: {said}"
    head = _HEAD.match(text)
    if head and {"y", "q", "v"} & {*head[1].split(", ")} - {*_WORD.findall(text, head.end())}:
        return f"{OWN_STEP} that calls it with its state"
    try:
        exec(compile(text, "<wrapper>", "exec"), known := _scope_of(step))
        kind = calling.conventions_of(known["wrapped"])[0].kind
        subject = opened(known["wrapped"], kind)
        state = TRIAL_STATE[: 2 - subject.single] if kind == calling.FIELD else TRIAL_STATE[1:]
        steps = _LONGER if subject.convention.run else 1
        subject = replace(subject, convention=subject.convention.of_steps(steps))
        if kind == calling.FIELD:
            ends = [subject.step_field(rate, 1.0, state, _TINY) for rate in (lambda t, y: [1.0 for _ in y], zeros)]
        elif kind == calling.FORCE:
            ends = [
                [*subject.step_with(push, *TRIAL_STATE, _TINY)] for push in (lambda q: 1.0 + 0.0 * q, lambda q: 0.0 * q)
            ]
        else:
            return line
    except (StaleSlope, OwnClock, Exchanged, Increment):
        return line
    except Exception as failure:
        if isinstance(failure, NameError) or "NameError" in str(failure):
            return line
        seen = " ".join(str((isinstance(failure, BadInput) and failure.__cause__) or failure).split())
    else:
        end = ends[0][-len(state) :]
        moved = [abs(x - y) / _TINY / steps for x, y in zip(end, state, strict=True)]
        # A step that stays where nothing moves, and is moved, is called as it should be, whatever its faults.
        called = np.allclose(ends[1][-len(state) :], state, rtol=0, atol=_NEAR) and ends[0] != ends[1]
        if max(moved) < _WITHIN and (called or min(moved) > 1 / _WITHIN):
            return line
        seen = f"a step of {_TINY:g} where y' = 1 goes from {list(state)} to {list(end)}"
    return f"{OWN_STEP} that calls it; tried: {text}: {seen}"


def _scope_of(step: Callable[..., Any]) -> dict[str, Any]:
    """The names that a wrapper may use where it is pasted: those of the code's module, and of the code itself."""
    made = getattr(step, "__self__", None)
    owner = owner_of(step) if made is None or inspect.isclass(made) else type(made)
    parts = [*vars(owner).values()] if inspect.isclass(owner) else [owner]
    module = next((each.__globals__ for each in parts if hasattr(each, "__globals__")), {})
    return {**module, name_of(owner).partition(".")[0]: owner, "made": made, name_of(step): step}


def _unfitting(step: Callable[..., Any]) -> str:
    """The refusal that stands before a wrapper; it is short, because a summary of tests cuts the line."""
    return f"{calling.signature_text(step)} does not fit any calling convention of `driftproof verify --help`; write"


def _tried(subject: ForeignStepper, trial: TrialStep) -> ForeignStepper:
    """The subject after a trial; a run that fails at one step is tried with more, as its start may need several."""
    convention = subject.convention
    try:
        return _with_momentum(_with_strong_floats(_after_trial(subject, trial), trial))
    except Misbehaviour as failure:
        if convention.run and not isinstance(failure, Exchanged):
            with suppress(Misbehaviour):
                longer = _after_trial(replace(subject, convention=convention.of_steps(_LONGER)), trial)
                return replace(longer, convention=longer.convention.of_steps(1), shortest=_LONGER)
        raise


def _adapters(
    step: Callable[..., Any], convention: calling.CallingConvention, array: Callable[[Any], Any] | None
) -> Iterator[Iterable[ArrayAdapter]]:
    """Yield the usual adapters; then, to be tried if none of them gets an answer, other forms of a state."""
    if array is not None:
        yield adapters_of(array)
        return
    vectors = convention.kind in _TRIALS or (convention.kind == calling.MAP and calling.STATE in convention.order)
    yield (ARRAYS, LISTS, SCALARS) if vectors else (SCALARS, ARRAYS)
    yield list(forms_of(step, convention))


# A step of this size from the trial state, returning its end: of the oscillator, or of y' = -y with one number.
TrialStep: TypeAlias = Callable[[ForeignStepper, float], Sequence[float]]


def _one_step(subject: ForeignStepper, h: float) -> Sequence[float]:
    return subject.step(*TRIAL_STATE, h)


def _one_number(subject: ForeignStepper, h: float) -> Sequence[float]:
    """A step of y' = -y, for a stepper that takes one number only."""
    return subject.step_field(lambda t, y: [-x for x in y], 0.0, TRIAL_STATE[:1], h)


def _with_jacobian(trial: TrialStep, rows: Sequence[Sequence[float]]) -> TrialStep:
    """The trial with the Jacobian of its system, or with an implicit part of 0."""
    functions: dict[str, SecondFunction] = dict.fromkeys((calling.TIME_SLOPE, calling.IMPLICIT), zeros)
    functions[calling.JACOBIAN] = lambda t, y: rows
    return lambda subject, h: trial(with_functions(subject, functions), h)


def _in_fields(subject: ForeignStepper, h: float, size: int = 3) -> Sequence[float]:
    """A velocity in fields of three components, or in the plane, where B is one number."""
    x, v, electric = (all_of[:size] for all_of in ((1.0, 0.5, 0.25), (0.75, 1.0, 0.5), (0.5, 0.25, 1.0)))
    found = step_in_fields(subject, Push(x, v, electric, (0.25, 1.0, 0.5) if size == 3 else (0.25,), h))
    return [*found.x, *found.v]


_ONE_WITH_DERIVATIVE = _with_jacobian(_one_number, [[-1.0]])
_TRIALS: dict[str, tuple[TrialStep, ...]] = {
    calling.FIELD: (_one_step, _one_number),
    calling.ROSENBROCK: (_with_jacobian(_one_step, [[0.0, 1.0], [-1.0, 0.0]]), _ONE_WITH_DERIVATIVE),
    calling.IMEX: (_with_jacobian(_one_step, []),),
    calling.MAGNETIC: (_in_fields, partial(_in_fields, size=2)),
    calling.ROTATION: (lambda subject, h: turn_quaternion(subject, (0.5, 0.5, 0.5, 0.5), (1.0, 0.5, 0.25), h),),
}


def _after_trial(subject: ForeignStepper, trial: TrialStep) -> ForeignStepper:
    """The subject after a trial step, with the format of its answers and only the log entries needed to read them."""
    end = trial(subject, TRIAL_STEP)
    subject.begun = (lambda again: trial(again, TRIAL_STEP)), end
    if subject.convention.run and subject.log.works_in_place:  # a count of steps, or of numbers
        two = trial(replace(subject, convention=subject.convention.of_steps(2), log=CallLog()), TRIAL_STEP)
        if np.array_equal(two, end) or [*end[1:]] == [*TRIAL_STATE[1 : len(end)]] != [*two[1:]]:
            raise WrongShape("a run of two steps ends where one of one step does, or moves more numbers")
    if subject.convention.run and calling.POSITION in subject.convention.order and end[0] == TRIAL_STATE[0]:
        trial(replace(subject, convention=subject.convention.of_steps(2), log=CallLog()), TRIAL_STEP)
    if subject.adapter is COMPLEX and end[0] < TRIAL_STATE[0]:
        raise WrongShape("z moves as q - i v")
    if subject.adapter in SYSTEMS:
        start = as_array(subject.adapter.write(TRIAL_STATE)).tolist()
        if not np.allclose(subject.step_state(start, _TINY**2), start, rtol=0, atol=_NEAR):
            raise WrongShape(f"{len(start)} numbers jump, however short the step is")
    if subject.log.carried is not None:
        _require_slope_at_end(subject, end)
        _require_time_of_end(subject, TRIAL_STATE[: len(end)])
    _require_time_returned(subject, TRIAL_STATE[: len(end)])
    _require_no_clock(subject, TRIAL_STATE[: len(end)])
    if kept := getattr(subject.function, "upkeep", ("", ()))[1]:
        line = kept_wrapper(kept, subject.function.advance)  # type: ignore[attr-defined]
        raise OwnClock(f"a step depends on what it keeps from the last one, {', '.join(kept)}{line}")
    read_as = subject.convention
    if read_as.kind in (calling.MAP, calling.FORCE) and end[0] < end[1] and not read_as.velocity_first:
        ends = trial(subject, _TINY), end  # the longer step moves away
        if [np.allclose(x, TRIAL_STATE[::-1], rtol=0, atol=_NEAR) for x in ends] == [True, False]:
            return _after_trial(_with_velocity_first(subject), trial)
    turned = read_as.kind == calling.FORCE and end[1] < 0 and trial(subject, _TINY)
    if turned and np.allclose(turned, np.array(TRIAL_STATE) * (1, -1), rtol=0, atol=_NEAR):
        raise Exchanged(f"it returns (q1, -v1), the velocity turned around{negation_wrapper(subject)}")
    moved = np.max(np.abs(end))
    if 0 < moved < _SUSPICIOUS and np.max(np.abs(trial(subject, _TINY))) < _NEAR:
        raise Increment(f"as h goes to 0 it returns 0, not the state: an increment{increment_wrapper(subject)}")
    asks, timed = subject.log.asks, subject.log.timed
    subject.format = _format_of_answers(subject.log)
    run = subject.convention.run or subject.log.layout is not None  # a generator yields a run
    subject.convention = replace(subject.convention, run=run, asks=asks, timed=timed)
    if subject.gives_velocities and not _velocity_varies(subject):
        asks = tuple(calling.BESIDES if role == calling.VELOCITY else role for role in asks)
        subject.convention = replace(subject.convention, asks=asks)
    # A step from rest changes nothing, so that a stepper which works in place must be known by then.
    subject.log = CallLog(works_in_place=subject.log.works_in_place, layout=subject.log.layout)
    return subject


def _format_of_answers(log: CallLog) -> FloatFormat:
    found = (next((x for ending, x in _FORMATS.items() if name.endswith(ending)), BINARY64) for name in log.types)
    return min(found, key=lambda x: x.u, default=BINARY64)


def _with_strong_floats(subject: ForeignStepper, trial: TrialStep) -> ForeignStepper:
    """The subject called with numpy.float64 if its answers to these are binary64, and to Python's floats are narrower.

    A product of a Python float and a float32 constant is a float32; with arrays the constant's error alone remains.
    """
    if subject.adapter is SCALARS and subject.format is not BINARY64:
        strong = replace(subject, adapter=adapters_of(np.float64)[1], format=BINARY64, log=CallLog())
        with suppress(Misbehaviour):
            return found if (found := _after_trial(strong, trial)).format is BINARY64 else subject
    return subject


def _with_momentum(subject: ForeignStepper) -> ForeignStepper:
    """The subject given p = m v for v, if its p moves the position by p/m."""
    found = subject.convention
    name = dict(zip(found.order, found.names, strict=False)).get(calling.VELOCITY, "")
    mass = next((x for each, x in found.extra.items() if each.lower() in calling.MASSES), 1.0)
    if found.kind != calling.FORCE or mass == 1 or name.lower() not in calling.MOMENTA:
        return subject
    q, v = TRIAL_STATE
    rate = (subject.step_with(lambda x: 0 * x, q, v, _TINY)[0] - q) / _TINY
    heavy = np.isclose(rate, v / mass, rtol=_AS_CARRIED, atol=0)
    return replace(subject, convention=replace(found, momentum=mass if heavy else 1.0))


def _with_velocity_first(subject: ForeignStepper) -> ForeignStepper:
    """The subject read as returning (v1, q1), if it also takes v before q. Raises Exchanged if it does not."""
    order = subject.convention.order
    if calling.STATE in order or order.index(calling.POSITION) < order.index(calling.VELOCITY):
        raise Exchanged(f"it returns (v1, q1), the velocity first{exchange_wrapper(subject)}")
    return replace(subject, convention=replace(subject.convention, velocity_first=True), log=CallLog())


def _velocity_varies(subject: ForeignStepper) -> bool:
    """True if the apparent velocity argument of the force is the velocity in another state, and no constant."""
    seen: list[float] = []

    def force(t: float, q: Sequence[float], v: Sequence[float]) -> Sequence[float]:
        seen.extend((*q, *v))
        return [0.0]

    subject.step_dragged(force, 0.0, [3.0], [-2.0], _TINY)
    return np.allclose(seen[:2], [3.0, -2.0], rtol=0, atol=_AS_CARRIED)


def _require_slope_at_end(subject: ForeignStepper, end: Sequence[float]) -> None:
    """Raise StaleSlope unless the slope that a step hands on is the slope at its end."""
    found, convention = as_array(subject.log.carried).ravel(), subject.convention
    if convention.kind == calling.FIELD:
        expected = [end[1], -end[0]] if len(end) > 1 else [-end[0]]
    else:
        expected = [-end[0] * convention.carried]
    near = max(_AT_END, _ROUNDINGS * float(_format_of_answers(subject.log).u))
    if found.size < len(expected) or not np.allclose(found[: len(expected)], expected, rtol=near, atol=0):
        shown, right = (", ".join(f"{x:g}" for x in numbers) for numbers in (found, expected))
        raise StaleSlope(f"it passes on {shown} as the slope at its end, not {right}")


def _require_time_of_end(subject: ForeignStepper, state: Sequence[float]) -> None:
    """Raise StaleSlope if the slope handed on is of another time than the end, unless the step ignores times."""
    if subject.convention.kind not in (calling.FIELD, calling.FORCE):
        return
    start, asked = 1.0, list[AnyNumber]()

    def clock(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
        asked.append(t)
        return [t for _ in y]

    if subject.convention.kind == calling.FIELD:
        subject.step_field(clock, start, state, TRIAL_STEP)
    else:
        subject.step_forced(clock, start, state[:1], state[1:], TRIAL_STEP)
    seen = float(as_array(subject.log.carried).ravel()[-1]) / subject.convention.carried
    if any(t != start for t in asked) and not np.isclose(seen, start + TRIAL_STEP, rtol=_AS_CARRIED, atol=0):
        raise StaleSlope(f"it passes on the slope at t + {seen - start:g} as that at its end, t + {TRIAL_STEP:g}")


def _require_time_returned(subject: ForeignStepper, state: Sequence[float]) -> None:
    """Raise StaleSlope if the time that the step returns is neither that at its end nor, left to its caller, the start.

    In a tuple, a number that does not move with t is no time, but a step size or an error.
    """
    clock = subject.log.clock
    if clock is None or np.isclose(clock, (0.0, TRIAL_STEP), rtol=_AS_CARRIED, atol=0).any():
        return
    if subject.convention.kind == calling.FIELD:
        subject.step_field(zeros, 1.0, state, TRIAL_STEP)
        if subject.log.clock is None or not np.isclose(subject.log.clock - clock, 1, rtol=_AS_CARRIED, atol=0):
            return
    raise StaleSlope(f"it returns the time t + {clock:g} with the state at its end, t + {TRIAL_STEP:g}")


def _require_no_clock(subject: ForeignStepper, state: Sequence[float]) -> None:
    """Raise OwnClock if a step that takes no time begins h later than the one before it."""
    found = subject.convention
    if found.kind != calling.FIELD or {calling.TIME, calling.GRID} & {*found.order} or not subject.log.asks:
        return
    asked = list[AnyNumber]()

    def still(t: AnyNumber, y: Sequence[AnyNumber]) -> list[AnyNumber]:
        asked.append(t)
        return zeros(t, y)

    for size in (1, 2):  # in another state than that at the end, whose slope may be kept
        calls = len(asked)
        subject.step_field(still, 0.0, [size * x for x in state], TRIAL_STEP)
    if calls < len(asked) and np.isclose(asked[calls] - asked[0], TRIAL_STEP, rtol=_AS_CARRIED, atol=0):
        raise OwnClock(f"it keeps a clock of its own, which goes on with each step{clock_wrapper(subject.function)}")


@dataclass(frozen=True)
class Target:
    """The stepper to examine, a callable or `package.module:name`, and its convention and array maker where needed."""

    step: Callable[..., Any] | str
    calls: str | None = None
    array: Callable[[Any], Any] | str | None = None

    @property
    def name(self) -> str:
        """The name that reports use."""
        if isinstance(self.step, str):
            return self.step
        module = getattr(self.step, "__module__", None)
        name: str = getattr(self.step, "__qualname__", type(self.step).__name__)
        return f"{module}:{name}" if module else name

    @property
    def by_name(self) -> bool:
        """True if another interpreter can import the stepper and its array maker."""
        return isinstance(self.step, str) and not callable(self.array)

    def open(
        self, before: Callable[[str], None] = lambda call: None, after: Callable[[], None] = lambda: None
    ) -> ForeignStepper:
        """Open the stepper, or a method of a copy of its object. Raises ValueError or a `Misbehaviour`."""
        array, step = None if self.array is None else imported(self.array), imported(self.step)
        own = fresh_copy(step) if inspect.ismethod(step) else None
        return opened(own or step, self.calls, array, before, after)


def imported(named: Callable[..., Any] | str, what: str = "stepper") -> Callable[..., Any]:
    """The callable that `package.module:name` names, also found from the current directory; a callable as it is.

    Raises ValueError, with a message of one line, for a text of another form and for what cannot be imported or called.
    """
    if not isinstance(named, str):
        return _callable(named, "what was given", what)
    try:
        found = imported_object(named, what)
    except ValueError as error:
        raise BadInput(str(error)) from error.__cause__
    return _callable(found, named, what)


def _callable(found: Any, named: str, what: str) -> Callable[..., Any]:
    """The callable that was found; raises BadInput for anything else, with a wrapper if an object has a step."""
    if not callable(found):
        shown = "None" if found is None else f"{type(found).__name__}, which cannot be called"
        raise BadInput(f"{named} is {shown}{uncalled(found) if what == 'stepper' else ''}")
    function: Callable[..., Any] = found
    return function
