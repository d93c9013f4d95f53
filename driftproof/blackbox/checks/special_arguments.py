"""Checks of special arguments: h = 0, h < 0, NaN, infinity, and the time t."""

from __future__ import annotations

from dataclasses import replace
from math import inf, nan
from typing import Any

from driftproof.blackbox.checks.trials import (
    ORDINARY_STATE,
    TYPICAL_STEP,
    CheckResult,
    PhasePoint,
    Trial,
    TrialRunner,
    same,
    steady_runner,
)
from driftproof.blackbox.stepper.calling_conventions import FIELD, TIME
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

_ZERO, _NEGATIVE = "zero_step", "negative_step"


def zero_step(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that h = 0 gives the state back."""
    runner = steady_runner(subject)
    trials = [runner.trial(q, v, 0.0) for q, v in (runner.scaled((1.0, 0.75)), runner.ordinary)]
    trial = next((trial for trial in trials if trial.answer != trial.given[:2]), None)
    if trial is None:
        return (CheckResult(_ZERO, True, "h = 0 returns the state unchanged", (trials[0],)),)
    if "ZeroDivisionError" in trial.failure:
        holds, words = False, "it divides by h = 0: it raises ZeroDivisionError"
    elif trial.answer is None:
        return (CheckResult(_ZERO, None, f"h = 0 is refused: {trial.refusal}", (trial,)),)
    elif not trial.finite:
        holds, words = False, f"it divides by h = 0 and returns {trial.seen}"
    else:
        moved = max(abs(after - before) for after, before in zip(trial.answer, trial.given, strict=False))
        holds, words = moved <= runner.rounding, f"h = 0 returns the state except for rounding by {moved:.1g}"
        words = words if holds else f"h = 0 moves the state: {trial.given[:2]} becomes {trial.seen}"
    return (CheckResult(_ZERO, holds, words, (trial,)),)


def negative_step(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that h < 0 steps back in time."""
    runner = steady_runner(subject)
    forth, back = (runner.trial(*runner.ordinary, sign * TYPICAL_STEP) for sign in (1, -1))
    if back.answer is None:
        return (CheckResult(_NEGATIVE, None, f"h < 0 is refused: {back.refusal}", (back,)),)
    if not back.finite:
        return (CheckResult(_NEGATIVE, False, f"h < 0 gives {back.seen}", (back,)),)
    if same(back.answer, runner.ordinary):
        return (CheckResult(_NEGATIVE, False, "h < 0 does nothing: the state is returned unchanged", (back,)),)
    if same(back.answer, forth.answer):
        return (CheckResult(_NEGATIVE, False, "h < 0 is treated as |h|", (back, forth)),)
    return (_backward(runner, back),)


def _backward(runner: TrialRunner, shown: Trial) -> CheckResult:
    """Check that a short step back is opposite to the short step forth, as it is for every consistent method."""
    for h in (TYPICAL_STEP, 2.0**-10):
        forth, back = (runner.trial(*runner.ordinary, sign * h).answer for sign in (1, -1))
        if forth is None or back is None:
            continue
        d, e = ([x - z for x, z in zip(answer, runner.ordinary, strict=True)] for answer in (forth, back))
        along, length = sum(x * y for x, y in zip(d, e, strict=True)), sum(x * x for x in d)
        if abs(along + length) < length / 4:
            return CheckResult(_NEGATIVE, True, "h < 0 steps back in time", (shown,))
    return CheckResult(_NEGATIVE, False, "h < 0 does something other than step back", (shown,))


def not_a_number(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that a NaN is handed on or refused."""
    return _noticed(subject, "not_a_number", "NaN", (nan, 0.75), (1.0, nan))


def infinity(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that an infinite position or velocity is handed on or refused."""
    return _noticed(subject, "infinity", "an infinity", (inf, 0.75), (1.0, inf), (-inf, 0.75), (1.0, -inf))


def not_a_number_step(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that h = NaN is handed on or refused."""
    return _noticed(subject, "not_a_number_step", "h = NaN", (1.0, 0.75), h=nan)


def _noticed(
    subject: ForeignStepper, key: str, name: str, *states: PhasePoint, h: float = TYPICAL_STEP
) -> tuple[CheckResult, ...]:
    trials = [steady_runner(subject).trial(*z, h) for z in states]
    for trial in trials:
        if trial.finite:
            return (CheckResult(key, False, f"{name} gives finite numbers: {trial.line}", (trial,)),)
    for trial in trials:
        if trial.answer is None:
            return (CheckResult(key, None, f"{name} is refused: {trial.refusal}", (trial,)),)
    return (CheckResult(key, True, f"{name} propagates", (trials[0],)),)


_KEY = "time"
_LATE = (1.0, 1000.0, -0.25)


def time_argument(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that the answer does not depend on t, as the system does not, and that the right-hand side gets t."""
    if TIME not in subject.convention.order:
        return ()
    runner = steady_runner(subject)
    start = runner.step(*runner.ordinary, TYPICAL_STEP)
    for t in _LATE:
        later = TrialRunner(_at(subject, t)).trial(*runner.ordinary, TYPICAL_STEP)
        if not same(later.answer, start):
            words = f"the answer depends on t: from the same state, t = 0 gives {start}, t = {t} gives {later.seen}"
            return (CheckResult(_KEY, False, words),)
    independent = CheckResult(_KEY, True, "the answer does not depend on t")
    return (_times_in_the_step(subject) if subject.convention.kind == FIELD else independent,)


def _at(subject: ForeignStepper, t: float) -> ForeignStepper:
    """The same stepper, called at the time t."""
    place = subject.convention.order.index(TIME)

    def later(*arguments: Any, **named: Any) -> Any:
        if subject.convention.names:
            return subject.function(**{**named, subject.convention.names[place]: t})
        return subject.function(*arguments[:place], t, *arguments[place + 1 :])

    return replace(subject, function=later)


def _times_in_the_step(subject: ForeignStepper) -> CheckResult:
    """Check that the right-hand side is evaluated at a time within the step."""
    asked: list[float] = []
    t, h = 8.0, TYPICAL_STEP

    def rate(at: float, y: list[float]) -> list[float]:
        asked.append(at)
        return [*y]

    subject.step_field(rate, t, list(ORDINARY_STATE), h)
    if any(t <= at <= t + h for at in asked):
        return CheckResult(_KEY, True, "the answer does not depend on t, and the right-hand side gets t")
    words = f"the right-hand side gets a time outside the step: from t = {t} with h = {h} it is called at {asked[0]}"
    return CheckResult(_KEY, False, words)
