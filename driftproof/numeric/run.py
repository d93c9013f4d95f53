"""Run an oscillator's scene in floats, and compute only the readouts that it asks for."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import partial
from math import isfinite
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.rationals import brief
from driftproof.methods.programs.stepping import Force, Step, oscillator
from driftproof.methods.schemes import Method
from driftproof.numeric import readouts
from driftproof.numeric.readouts import LARGEST_CHANGE, ON_THE_WAY, TRAJECTORY, FloatOrArray, FloatState
from driftproof.numeric.steppers import CountedForce, float_stepper

if TYPE_CHECKING:
    from driftproof.numeric.scenes import Scene

# Readout name -> value: floats, ints, pairs, arrays (trajectory), or None where undefined.
Readouts: TypeAlias = dict[str, Any]
Counter: TypeAlias = Callable[[int], Iterable[int]]

# About a minute of pure Python. The certified run answers any N at once, by squaring.
MOST_FLOAT_STEPS = 10**8
# The most that rounding t may move the exact state, whose speed is 1 on the unit circle; chosen: below what is shown.
COARSEST_TIME = Fraction(1, 2**30)


class RunEnded(ArithmeticError):
    """A float run that did not reach its end, or whose readout is not a finite float; the message is one line."""


class NonFiniteState(RunEnded):
    """The state left the range of floats at step `step`: overflow of the number format, not evidence of instability.

    Step 0 is a start that is not finite, before anything is computed.
    """

    def __init__(self, step: int, state: tuple[FloatOrArray, ...]) -> None:
        """Keep the first non-finite state and the number of its step."""
        overflow = f"overflow: the state is no longer finite after step {step}"
        super().__init__(overflow if step else "the start itself is not finite")
        self.step = step
        self.state = state


class NonFiniteReadout(RunEnded):
    """The state is finite, but a readout of it overflows the number format, or underflows to 0 without being 0."""


def integrate(
    step: Step,
    force: Force,
    start: FloatState,
    h: FloatOrArray,
    steps: int,
    record: Callable[[FloatOrArray, FloatOrArray], None] | None = None,
    counter: Counter = range,
) -> FloatState:
    """The state after `steps` steps of size h.

    `record(q, v)` is called after each step; `counter` is `range` or a progress bar like it. Raises NonFiniteState at
    the first state that is not finite, the start included.
    """
    q, v = start
    if not (isfinite(q) and isfinite(v)):
        raise NonFiniteState(0, start)
    for i in counter(steps):
        q, v = step(force, q, v, h)
        if not (isfinite(q) and isfinite(v)):
            raise NonFiniteState(i + 1, (q, v))
        if record is not None:
            record(q, v)
    return q, v


def require_float_steps(steps: int) -> None:
    """Raise ValueError for a float run of more than MOST_FLOAT_STEPS steps."""
    if steps > MOST_FLOAT_STEPS:
        raise ValueError(
            f"{brief(steps)} steps; a float run takes at most {MOST_FLOAT_STEPS}, and "
            "`driftproof run` gives a certified answer for any number"
        )


def run_method(scene: Scene, key: str, counter: Counter = range) -> Readouts:
    """The scene's readouts for the method `key`, computed in binary64; nothing else is computed or kept.

    Raises RunEnded, and ValueError if the scene asks for no readout or for more than MOST_FLOAT_STEPS steps.
    """
    if not scene.readouts:
        raise ValueError(f"scene {scene.name!r} names no readout; name at least one")
    require_float_steps(scene.steps)
    force = CountedForce(oscillator) if "evaluations" in scene.readouts else oscillator
    start = (nearest_double(scene.start[0], "start q"), nearest_double(scene.start[1], "start v"))
    h, t = nearest_double(scene.h, "h"), _nearest_time(scene.t)
    path = None if {*ON_THE_WAY}.isdisjoint(scene.readouts) else [start]
    record = (lambda q, v: path.append((q, v))) if path is not None else None
    state = integrate(_float_step(method_of(scene.method(key))), force, start, h, scene.steps, record, counter)

    def exact() -> FloatState:
        q, v = readouts.exact_state(start, t)
        if not (isfinite(q) and isfinite(v)):
            raise NonFiniteReadout(f"the exact state at t = {t:g} overflows binary64")
        return q, v

    def largest_error() -> float:
        true = readouts.exact_state(start, times_of_steps(scene.h, scene.steps))
        return float(readouts.state_error(tuple(np.array(path).T), true).max())

    def largest_change() -> float:
        changes = readouts.float_energy_change(tuple(np.array(path).T), start)
        return float(changes[np.abs(changes).argmax()])

    def not_lost(name: str, value: FloatOrArray, other: bool) -> float:
        """The energy, or its change, which is 0 for no `other` state than the origin, or the start."""
        if value == 0 and other and readouts.energy(state) == 0:
            raise NonFiniteReadout(f"{name} underflows binary64 at {at}")
        return float(value)

    at = f"the final state ({state[0]:g}, {state[1]:g})"
    change = partial(readouts.float_energy_change, state, start)
    read: dict[str, Callable[[], Any]] = {
        "final_state": lambda: state,
        "exact_state": lambda: tuple(map(float, exact())),
        "state_error": lambda: float(readouts.state_error(state, exact())),
        "energy": lambda: not_lost("energy", readouts.energy(state), any(state)),
        "energy_change": lambda: not_lost("energy_change", change(), state != start),
        readouts.ENERGY_ERROR: lambda: float(change()),  # the solution conserves it
        **dict.fromkeys((LARGEST_CHANGE, readouts.LARGEST_ERROR), largest_change),
        readouts.LARGEST_STATE_ERROR: largest_error,
        "phase_error": lambda: readouts.phase_error(state, exact()),
        "steps": lambda: scene.steps,
        "evaluations": lambda: getattr(force, "calls", None),
        TRAJECTORY: lambda: (times_of_steps(scene.h, scene.steps), np.array(path)),
    }
    return {name: finite(name, read[name], at) for name in scene.readouts}


def finite(name: str, read: Callable[[], Any], at: str) -> Any:
    """The value of a readout. Raises NonFiniteReadout for a float that is not finite, at the state that `at` names."""
    with np.errstate(over="ignore", invalid="ignore"):
        value = read()
    if isinstance(value, float) and not isfinite(value):
        raise NonFiniteReadout(f"{name} overflows binary64 at {at}")
    return value


def _float_step(method: Method) -> Step:
    """The method's step; an implicit one solves its stages by Newton's method, whose evaluations of the force count."""
    if method.explicit:
        return float_stepper(method)
    from driftproof.numeric.steps.implicit import StageEquationsUnsolved, implicit_runner

    run = implicit_runner(method, VectorField(("y1", "-y0")))

    def step(force: Force, q: FloatOrArray, v: FloatOrArray, h: FloatOrArray) -> FloatState:
        before = run.calls
        try:
            q, v = run((q, v), h, 0, 1)
        except StageEquationsUnsolved as error:
            raise RunEnded(str(error)) from None
        if isinstance(force, CountedForce):
            force.calls += run.calls - before
        return q, v

    return step


def times_of_steps(h: Fraction, steps: int) -> Any:
    """The times i·h for i = 0..steps in binary64, each rounded once and never accumulated.

    Raises OverflowError unless steps times h's numerator, and h's denominator, stay below 2**53, where they are exact.
    """
    if max(steps * abs(h.numerator), h.denominator) >= 2**53:
        raise OverflowError(f"the times of {steps} steps of {h} round more than once; shorten the run or simplify h")
    return np.arange(steps + 1) * h.numerator / h.denominator


def nearest_double(x: Fraction, what: str) -> float:
    """The double nearest to x. Raises ValueError if it is infinite, or if it is 0 although x is not."""
    try:
        nearest = float(x)
    except OverflowError:
        raise ValueError(f"{what} is larger than the largest binary64, about 1.8e308") from None
    if nearest == 0 and x != 0:
        raise ValueError(f"{what} rounds to 0: the smallest positive binary64 is about 4.9e-324")
    return nearest


def _nearest_time(t: Fraction) -> float:
    """The double nearest to t. Raises ValueError unless it is near enough for its cosine and sine to mean anything."""
    nearest = nearest_double(t, "t")
    if abs(Fraction(nearest) - t) > COARSEST_TIME:
        raise ValueError("t is too large: no binary64 is near enough to it; `driftproof run` gives a certified answer")
    return nearest
