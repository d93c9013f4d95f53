"""Answers about the oscillator: readouts of steps, runs and the exact flow."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

from flint import arb

from driftproof.methods.schemes import Method, RungeKutta
from driftproof.symbolic.algebra.certified import CertifiableReal, enclose
from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.rational_functions import polynomial_text, sum_text
from driftproof.symbolic.runs import OscillatorRun, exact_flow
from driftproof.texts.questions.answer import CERTIFIED, COUNTED, DERIVED, Answer
from driftproof.texts.questions.arithmetic import NUMBER_FUNCTIONS

_State = tuple[Fraction, Fraction]

DEGREES, RADIANS, TURNS = "degrees", "radians", "turns"
# Chosen: a run of more steps must be a mistake.
LARGEST_STEP_COUNT = 10**18


def _exact_component(start: _State, t: Fraction, index: int) -> Answer:
    """The exact flow at time t: q cos t + v sin t for index 0, v cos t - q sin t for index 1."""
    q, v = start
    of_cosine, of_sine = ((q, v), (v, -q))[index]
    if t == 0 or not any(start):
        return Answer("", of_cosine)
    terms = ((of_cosine, f"cos({t})"), (of_sine, f"sin({t})"))
    form = sum_text(polynomial_text(polynomial([0, c]), name) for c, name in terms if c)
    return Answer("", lambda: exact_flow(start, t)[index], CERTIFIED, form=form)


# Readout -> the function of start and time that gives it for the exact flow.
EXACT_READOUTS: dict[str, Callable[[_State, Fraction], Answer]] = {
    "q": lambda start, t: _exact_component(start, t, 0),
    "v": lambda start, t: _exact_component(start, t, 1),
    "energy": lambda start, t: Answer("", (start[0] ** 2 + start[1] ** 2) / 2),
}


def _answer(x: CertifiableReal | None) -> Answer:
    return Answer("", x, CERTIFIED if callable(x) else DERIVED)


def _phase_error(run: OscillatorRun) -> Answer:
    found = run.phase_error
    if found is None:
        raise ValueError("the phase error is undefined because a state is the origin")
    return replace(_answer(found), unit=DEGREES)


def _relative_error(run: OscillatorRun) -> Answer:
    """The state error over the radius of the exact state, which equals that of the start."""
    q, v = run.start
    if not (q or v):
        raise ValueError("the exact state is the origin, so the relative error is undefined")
    return NUMBER_FUNCTIONS["ratio"][0](_answer(run.state_error), NUMBER_FUNCTIONS["sqrt"][0](Answer("", q**2 + v**2)))


def evaluations(method: Method, steps: int) -> Answer:
    """The calls of the right-hand side, counted on a float step. Raises ValueError for an implicit method."""
    from driftproof.numeric.steppers import evaluations_per_step

    if not method.explicit:
        raise ValueError(f"{method.key} is implicit: its evaluations depend on how its equations are solved")
    return Answer("", Fraction(steps * evaluations_per_step(method)), COUNTED)


RUN_READOUTS: dict[str, Callable[[OscillatorRun], Answer]] = {
    "q": lambda run: _answer(run.final_state[0]),
    "v": lambda run: _answer(run.final_state[1]),
    "energy": lambda run: _answer(run.energy),
    "energy_change": lambda run: _answer(run.energy_change),
    "state_error": lambda run: _answer(run.state_error),
    "relative_error": _relative_error,
    "phase_error": _phase_error,
    "exact.q": lambda run: _exact_component(run.start, run.t, 0),
    "exact.v": lambda run: _exact_component(run.start, run.t, 1),
    "steps": lambda run: Answer("", Fraction(run.steps)),
    "evaluations": lambda run: evaluations(run.method, run.steps),
    "h": lambda run: Answer("", run.h),
    "t": lambda run: Answer("", run.t),
}


def run_readouts(method: Method) -> dict[str, Callable[[OscillatorRun], Answer]]:
    """The readouts of a run; of an explicit Runge-Kutta method also the slopes k1.q, k1.v, ... of its first step."""
    if not (isinstance(method, RungeKutta) and method.explicit):
        return RUN_READOUTS

    def slope(i: int, j: int, run: OscillatorRun) -> Answer:
        return _answer(explicit_slopes(method, lambda _, y: (y[1], -y[0]), Fraction(0), run.start, run.h)[i][j])

    slopes = {f"k{i + 1}.{'qv'[j]}": partial(slope, i, j) for i in range(method.stages) for j in (0, 1)}
    return RUN_READOUTS | slopes


def explicit_slopes(
    method: RungeKutta,
    rate: Callable[[Any, Any], Sequence[Any]],
    t: Fraction,
    y: Sequence[Any],
    h: Fraction,
    lift: Callable[[Any], Any] = lambda x: x,
) -> list[Sequence[Any]]:
    """The slopes kᵢ = f(t + cᵢ h, y + h Σⱼ aᵢⱼ kⱼ) of an explicit method, `lift` making numbers of the type of y."""
    found: list[Sequence[Any]] = []
    for c, row in zip(method.c, method.a, strict=True):
        known = [(lift(h) * lift(a), k) for a, k in zip(row, found, strict=False)]
        at = [sum((a * k[i] for a, k in known), x) for i, x in enumerate(y)]
        found.append(rate(lift(t) + lift(h) * lift(c), at))
    return found


def in_unit(angle: Answer, unit: str) -> Answer:
    """The angle, given in degrees, in another unit; an exact 0 stays exact."""
    x, of_degrees = angle.exact, {RADIANS: lambda: arb.pi() / 180, TURNS: lambda: arb(1) / 360}
    moved = (lambda: enclose(x) * of_degrees[unit]()) if callable(x) and unit in of_degrees else x
    return replace(angle, exact=moved, unit=unit)


# Unit as written -> its name.
UNITS = {"deg": DEGREES, DEGREES: DEGREES, "rad": RADIANS, RADIANS: RADIANS, TURNS: TURNS}


def run_of(method: Method, h: Fraction, t: Fraction, start: _State) -> OscillatorRun:
    """The exact run. Raises ValueError if h does not divide t, M has a pole at h, or the steps are too many."""
    run = OscillatorRun(method, h, t, start)
    if run.steps > LARGEST_STEP_COUNT:
        raise ValueError("more than 10**18 steps, which is the largest number allowed")
    _ = run.final_state  # evaluated now, so that a pole raises here and not later
    return run
