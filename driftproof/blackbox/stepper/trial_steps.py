"""The first steps of a stepper, and what they show: its precision, increments, momenta, slopes and times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TypeAlias

import numpy as np

from driftproof.blackbox.findings import (
    Exchanged,
    Increment,
    Misbehaviour,
    NotANumber,
    OwnClock,
    StaleSlope,
    WrongAnswer,
    WrongShape,
)
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.second_functions import SecondFunction, with_functions, zeros
from driftproof.blackbox.stepper.states import array_adapters as adapters
from driftproof.blackbox.stepper.states.named_answers import goes_on
from driftproof.blackbox.stepper.states.state_forms import COMPLEX, SYSTEMS
from driftproof.blackbox.stepper.turning import Push, step_in_fields, turn_quaternion
from driftproof.blackbox.stepper.wrappers.kept_state_wrappers import kept_wrapper
from driftproof.blackbox.stepper.wrappers.made_wrappers import clock_wrapper
from driftproof.blackbox.stepper.wrappers.wrappers import call_wrapper, increment_wrapper
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64, FloatFormat

# The state and the step size of trials: nothing cancels, and every term of a step is of ordinary size.
TRIAL_STATE, TRIAL_STEP = (1.0, 0.75), 0.25
# No part of an answer is near the numbers of both states unless it is position or velocity.
_ANOTHER_STATE = (-0.375, 1.75)
# A step of 1/4 does not halve the oscillator's state. If an answer is smaller and a step of 2^-10, which moves numbers
# by no more than that, returns 0 to within the third, it is an increment.
_SUSPICIOUS, TINY, NEAR = 0.5, 2.0**-10, 2.0**-8
# A run of this many steps is longer than the start of any multistep method in use.
LONGER = 8
# The relative distance allowed to times, velocities and masses: numbers of 11 bits are closer.
_AS_CARRIED = 2.0**-8
# That allowed to the slope at the end: what a solver in use leaves there, or some roundings of a narrow format.
_AT_END, _ROUNDINGS = 2.0**-20, 16
# The format for each ending of the name of an answer's type; of several, the widest is that of the step.
_FORMATS = {"float16": BINARY16, "float32": BINARY32, "float64": BINARY64}
# A step of this size from the trial state, returning its end: of the oscillator, or of y' = -y with one number.
TrialStep: TypeAlias = Callable[[ForeignStepper, float], Sequence[float]]


def one_step(subject: ForeignStepper, h: float) -> Sequence[float]:
    """A step of the oscillator."""
    return subject.step(*TRIAL_STATE, h)


def one_number_step(subject: ForeignStepper, h: float) -> Sequence[float]:
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


ONE_WITH_DERIVATIVE = _with_jacobian(one_number_step, [[-1.0]])
TRIALS: dict[str, tuple[TrialStep, ...]] = {
    calling.FIELD: (one_step, one_number_step),
    calling.ROSENBROCK: (_with_jacobian(one_step, [[0.0, 1.0], [-1.0, 0.0]]), ONE_WITH_DERIVATIVE),
    calling.IMEX: (_with_jacobian(one_step, []),),
    calling.MAGNETIC: (_in_fields, partial(_in_fields, size=2)),
    calling.ROTATION: (lambda subject, h: turn_quaternion(subject, (0.5, 0.5, 0.5, 0.5), (1.0, 0.5, 0.25), h),),
}


def tried(subject: ForeignStepper, trial: TrialStep) -> ForeignStepper:
    """The subject after a trial; a run that fails at one step is tried with more, as its start may need several."""
    convention = subject.convention
    try:
        return _with_momentum(_with_strong_floats(_after_trial(subject, trial), trial))
    except Misbehaviour as failure:
        if trial is one_step and (places := _places_of_pair(subject)):
            return tried(replace(subject, convention=replace(convention, places=places), log=CallLog()), trial)
        # A time after (q1, v1) is no slope, nor is an error estimate, and none is handed on.
        none = not convention.places and np.array_equal(subject.log.carried, TRIAL_STEP)
        none |= convention.kind == calling.FIELD and subject.log.returned == 2 and _vanishes(subject, trial)
        for place in (*range(subject.log.returned - 1), *[None] * none) if convention.handed == -1 else ():
            with suppress(Misbehaviour):
                found = tried(replace(subject, convention=replace(convention, handed=place), log=CallLog()), trial)
                end = trial(found, TINY**2)  # where x = -a, a may pass for the position and x for the slope
                if np.allclose(end, TRIAL_STATE[: len(end)], rtol=0, atol=NEAR):
                    return found
        if convention.run and not isinstance(failure, Exchanged):
            with suppress(Misbehaviour):
                longer = _after_trial(replace(subject, convention=convention.of_steps(LONGER)), trial)
                return replace(longer, convention=longer.convention.of_steps(1), shortest=LONGER)
        raise


def _vanishes(subject: ForeignStepper, trial: TrialStep) -> bool:
    """True if what may be a slope that is handed on is small beside h in a short step, as an error estimate is."""
    short = replace(subject, log=CallLog())
    with suppress(Misbehaviour):
        trial(short, TINY)
    found = short.log.carried
    return found is not None and bool(np.abs(adapters.as_array(found)).max() <= TINY * NEAR)


def _places_of_pair(subject: ForeignStepper) -> tuple[int, ...]:
    """The places of position and velocity in an answer of more parts: those where very short steps leave them.

    Nothing if there are no such places, if they are known, or if several parts are as near.
    """
    found = list[set[tuple[int, ...]]]()
    for state in (TRIAL_STATE, _ANOTHER_STATE) if subject.log.parts and not subject.convention.places else ():
        subject.log.parts = list[adapters.Foreign]()
        with suppress(Misbehaviour):
            subject.step(*state, TINY**2)
        near = [[i for i, part in enumerate(subject.log.parts) if _is_near(part, x)] for x in state]
        found.append({*product(*near)})
    places = set.intersection(*found) if found else set()
    return places.pop() if len(places) == 1 else ()


def _after_trial(subject: ForeignStepper, trial: TrialStep) -> ForeignStepper:
    """The subject after a trial step, with the format of its answers and only the log entries needed to read them."""
    end = trial(subject, TRIAL_STEP)
    subject.begun = (lambda again: trial(again, TRIAL_STEP)), end
    _require_steps_of_run(subject, trial, end)
    _require_state_kept(subject, end)
    if subject.log.carried is not None:
        _require_slope_at_end(subject, end)
        _require_time_of_end(subject, TRIAL_STATE[: len(end)])
    _require_time_returned(subject, TRIAL_STATE[: len(end)])
    _require_no_clock(subject, TRIAL_STATE[: len(end)])
    if kept := getattr(subject.function, "upkeep", ("", ()))[1]:
        line = kept_wrapper(kept, subject.function.advance)  # type: ignore[attr-defined]
        raise OwnClock(f"a step depends on what it keeps from the last one, {', '.join(kept)}{line}")
    if _returns_velocity_first(subject, trial, end):
        of_velocity_first = replace(subject.convention, velocity_first=True)
        return _after_trial(replace(subject, convention=of_velocity_first, log=CallLog()), trial)
    _require_no_increment(subject, trial, end)
    return _as_read(subject)


def _require_steps_of_run(subject: ForeignStepper, trial: TrialStep, end: Sequence[float]) -> None:
    """Raise WrongAnswer if the run of two steps ends where that of one does: no count of steps, but of numbers."""
    convention = subject.convention
    if not convention.run or calling.GRID in convention.order:
        return
    two: Sequence[float] = []
    still = calling.POSITION in convention.order and end[0] == TRIAL_STATE[0]
    required = subject.log.works_in_place or still  # other runs may have a fault, which is told later
    with nullcontext() if required else suppress(Misbehaviour):
        two = trial(replace(subject, convention=convention.of_steps(2), log=CallLog()), TRIAL_STEP)
    if np.array_equal(two, end) or (two and [*end[1:]] == [*TRIAL_STATE[1 : len(end)]] != [*two[1:]]):
        raise WrongAnswer("a run of two steps ends where one of one step does, or moves more numbers")


def _require_state_kept(subject: ForeignStepper, end: Sequence[float]) -> None:
    """Raise WrongShape for a complex state read the wrong way, WrongAnswer if a short step moves a whole system."""
    if subject.adapter is COMPLEX and end[0] < TRIAL_STATE[0]:
        raise WrongShape("z moves as q - i v")
    if subject.adapter in SYSTEMS:
        start = adapters.as_array(subject.adapter.write(TRIAL_STATE)).tolist()
        if not np.allclose(subject.step_state(start, TINY**8), start, rtol=0, atol=NEAR):
            raise WrongAnswer(f"{len(start)} numbers jump, however short the step is")


def _returns_velocity_first(subject: ForeignStepper, trial: TrialStep, end: Sequence[float]) -> bool:
    """True for a step of (v, q) that returns (v1, q1). Raises Exchanged for one of (q, v) that does."""
    convention, order = subject.convention, subject.convention.order
    if convention.kind not in (calling.MAP, calling.FORCE) or end[0] >= end[1] or convention.velocity_first:
        return False
    ends = trial(subject, TINY), end  # the longer step moves away
    if [np.allclose(x, TRIAL_STATE[::-1], rtol=0, atol=NEAR) for x in ends] != [True, False]:
        return False
    if calling.STATE in order or order.index(calling.POSITION) < order.index(calling.VELOCITY):
        line = call_wrapper(subject, "v1, q1 = {}; return q1, v1")
        raise Exchanged(f"it returns (v1, q1), the velocity first{line}")
    return True


def _require_no_increment(subject: ForeignStepper, trial: TrialStep, end: Sequence[float]) -> None:
    """Raise Exchanged if a step turns the velocity round, Increment if it returns what is to be added to the state."""
    turned = subject.convention.kind == calling.FORCE and end[1] < 0 and trial(subject, TINY)
    if turned and np.allclose(turned, np.array(TRIAL_STATE) * (1, -1), rtol=0, atol=NEAR):
        line = call_wrapper(subject, "q1, v1 = {}; return q1, -v1")
        raise Exchanged(f"it returns (q1, -v1), the velocity turned around{line}")
    # A stiff state decays in longer steps.
    if 0 < np.max(np.abs(end)) < _SUSPICIOUS and np.max(np.abs(trial(subject, TINY**4))) < NEAR:
        raise Increment(f"as h goes to 0 it returns 0, not the state: an increment{increment_wrapper(subject)}")


def _as_read(subject: ForeignStepper) -> ForeignStepper:
    """The subject with what the log of its trials says of its calls and its answers."""
    asks, timed = subject.log.asks, subject.log.timed
    subject.format = format_of_answers(subject.log)
    run = subject.convention.run or subject.log.layout is not None  # a generator yields a run
    subject.convention = replace(subject.convention, run=run, asks=asks, timed=timed)
    if subject.gives_velocities and not _velocity_varies(subject):
        asks = tuple(calling.BESIDES if role == calling.VELOCITY else role for role in asks)
        subject.convention = replace(subject.convention, asks=asks)
    # A step from rest changes nothing, so that a stepper which works in place must be known by then.
    subject.log = CallLog(works_in_place=subject.log.works_in_place, layout=subject.log.layout)
    return subject


def _is_near(part: adapters.Foreign, x: float) -> bool:
    with suppress(NotANumber):
        return bool(np.allclose(adapters.as_array(part).ravel()[:1], x, rtol=0, atol=NEAR))
    return False


def format_of_answers(log: CallLog) -> FloatFormat:
    """The widest format of the answers in a log."""
    found = (next((x for ending, x in _FORMATS.items() if name.endswith(ending)), BINARY64) for name in log.types)
    return min(found, key=lambda x: x.u, default=BINARY64)


def _with_strong_floats(subject: ForeignStepper, trial: TrialStep) -> ForeignStepper:
    """The subject called with numpy.float64 if its answers to these are binary64, and to Python's floats are narrower.

    A product of a Python float and a float32 constant is a float32; with arrays the constant's error alone remains.
    """
    if subject.adapter is adapters.SCALARS and subject.format is not BINARY64:
        strong = replace(subject, adapter=adapters.adapters_of(np.float64)[1], format=BINARY64, log=CallLog())
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
    rate = (subject.step_with(lambda x: 0 * x, q, v, TINY)[0] - q) / TINY
    heavy = np.isclose(rate, v / mass, rtol=_AS_CARRIED, atol=0)
    return replace(subject, convention=replace(found, momentum=mass if heavy else 1.0))


def _velocity_varies(subject: ForeignStepper) -> bool:
    """True if the apparent velocity argument of the force is the velocity in another state, and no constant."""
    seen: list[float] = []

    def force(t: float, q: Sequence[float], v: Sequence[float]) -> Sequence[float]:
        seen.extend((*q, *v))
        return [0.0]

    subject.step_dragged(force, 0.0, [3.0], [-2.0], TINY)
    return np.allclose(seen[:2], [3.0, -2.0], rtol=0, atol=_AS_CARRIED)


def _require_slope_at_end(subject: ForeignStepper, end: Sequence[float]) -> None:
    """Raise StaleSlope unless the slope that a step hands on is the slope at its end."""
    found, convention = adapters.as_array(subject.log.carried).ravel(), subject.convention
    if convention.kind == calling.FIELD:
        expected = [end[1], -end[0]] if len(end) > 1 else [-end[0]]
    else:
        expected = [-end[0] * convention.carried]
    near = max(_AT_END, _ROUNDINGS * float(format_of_answers(subject.log).u))
    if found.size < len(expected) or not np.allclose(found[: len(expected)], expected, rtol=near, atol=0):
        shown, right = (", ".join(f"{x:g}" for x in numbers) for numbers in (found, expected))
        of = ", that of q'' = -q" * (convention.kind == calling.MAP)
        raise StaleSlope(f"it passes on {shown} as the slope at its end, not {right}{of}")


def _require_time_of_end(subject: ForeignStepper, state: Sequence[float]) -> None:
    """Raise StaleSlope if the slope handed on is of another time than the end, unless the step ignores times."""
    if subject.convention.kind not in (calling.FIELD, calling.FORCE):
        return
    start, asked = 1.0, list[adapters.AnyNumber]()

    def clock(t: adapters.AnyNumber, y: Sequence[adapters.AnyNumber]) -> list[adapters.AnyNumber]:
        asked.append(t)
        return [t for _ in y]

    if subject.convention.kind == calling.FIELD:
        subject.step_field(clock, start, state, TRIAL_STEP)
    else:
        subject.step_forced(clock, start, state[:1], state[1:], TRIAL_STEP)
    seen = float(adapters.as_array(subject.log.carried).ravel()[-1]) / subject.convention.carried
    if any(t != start for t in asked) and not np.isclose(seen, start + TRIAL_STEP, rtol=_AS_CARRIED, atol=0):
        raise StaleSlope(f"it passes on the slope at t + {seen - start:g} as that at its end, t + {TRIAL_STEP:g}")


def _require_time_returned(subject: ForeignStepper, state: Sequence[float]) -> None:
    """Raise StaleSlope if the time that the step returns is neither that at its end nor, left to its caller, the start.

    In a tuple, a number that does not move with t is no time, but a step size or an error.
    """
    clock = subject.log.clock
    if clock is None or goes_on(0.0, clock, TRIAL_STEP):
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
    asked = list[adapters.AnyNumber]()

    def still(t: adapters.AnyNumber, y: Sequence[adapters.AnyNumber]) -> list[adapters.AnyNumber]:
        asked.append(t)
        return zeros(t, y)

    for size in (1, 2):  # in another state than that at the end, whose slope may be kept
        calls = len(asked)
        subject.step_field(still, 0.0, [size * x for x in state], TRIAL_STEP)
    if calls < len(asked) and np.isclose(asked[calls] - asked[0], TRIAL_STEP, rtol=_AS_CARRIED, atol=0):
        raise OwnClock(f"it keeps a clock of its own, which goes on with each step{clock_wrapper(subject.function)}")
