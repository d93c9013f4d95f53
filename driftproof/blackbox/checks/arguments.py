"""Checks of arguments and answers: what is done to them, and their types; h = 0, h < 0, NaN, infinity and the time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import inf, nan
from typing import Any

import numpy as np

from driftproof.blackbox.checks.determinism import FEW_ULPS
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
from driftproof.blackbox.findings import Misbehaviour, NotANumber
from driftproof.blackbox.stepper.calling_conventions import FIELD, TIME
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states import array_adapters as adapters

_WHOLE = (3, 1)
# What integers may change in a step of numbers of this size, as sums of integers are exact.
_ROUNDED = FEW_ULPS * 2.0**-52


def arguments(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that arguments and earlier answers are left as they are, also by a stepper of scalars on arrays."""
    runner = steady_runner(subject)
    own = _keeping(runner, subject)
    if subject.adapter is not adapters.SCALARS:
        return own
    try:
        arrays = _keeping(runner, replace(subject, adapter=adapters.ARRAYS))
    except Misbehaviour:  # a stepper of scalars need not take arrays
        return own
    return tuple(a if a.holds else replace(a, words=f"given arrays, {a.words}") for a in arrays)


def _keeping(steady: TrialRunner, subject: ForeignStepper) -> tuple[CheckResult, ...]:
    came, given = list[adapters.Foreign](), list[adapters.Foreign]()

    def recorded(*arguments: adapters.Foreign, **named: adapters.Foreign) -> adapters.Foreign:
        given.extend([*arguments, *named.values()])
        came.append(subject.function(*arguments, **named))
        return came[-1]

    log = CallLog()
    runner = TrialRunner(replace(subject, function=recorded, log=log))
    runner.step(*steady.ordinary, TYPICAL_STEP)
    trial = runner.trial(*steady.ordinary, TYPICAL_STEP)
    _, answer = came
    before = _numbers(answer)
    runner.step(*steady.another, TYPICAL_STEP)
    answers = CheckResult("keeps_answers", True, "earlier answers are not changed")
    if not same(before, _numbers(answer)):
        answers = CheckResult("keeps_answers", False, "an answer is overwritten by the next call", (trial,))
    slopes = "it writes into the arrays that its function returns: a function that keeps one is changed"
    others = (answers, *[CheckResult("keeps_slopes", False, slopes, (trial,))] * log.changes_slopes)
    if not log.changes_its_arguments:
        return CheckResult("keeps_arguments", True, "its arguments are not changed"), *others
    in_place = "it writes its answer into its arguments and returns nothing"
    words = in_place if log.works_in_place else "it changes its arguments, besides returning an answer"
    if not log.works_in_place and any(each is answer for each in given):
        words = "it changes its argument and returns it: the states of a run, kept in a list, are all the last one"
    return CheckResult("keeps_arguments", log.works_in_place, words, (trial,)), *others


def _numbers(answer: adapters.Foreign) -> list[float]:
    """All numbers in an answer as they are now; an empty list if it cannot be read."""
    parts = answer if isinstance(answer, tuple | list) else [answer]
    try:
        return [float(x) for part in parts for x in adapters.as_array(part).ravel()]
    except NotANumber:
        return []


def types(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check what types of numbers come back, and whether integers may be given."""
    runner = steady_runner(subject)
    log = CallLog(works_in_place=subject.log.works_in_place)
    logged = TrialRunner(replace(subject, log=log))
    logged.step(*runner.ordinary, TYPICAL_STEP)
    found = sorted(log.types)
    if all(name.rpartition(".")[2].startswith(("int", "uint", "bool")) for name in found):
        trial = runner.trial(1.0, 0.75, 0.0)
        rounded = f": at h = 0, (1.0, 0.75) becomes {trial.seen}" * (trial.answer not in (None, (1.0, 0.75)))
        returns = CheckResult("returns", False, f"returns integers{rounded}", (trial,))
    else:
        returns = CheckResult("returns", True, f"returns {' and '.join(found)}")
    return returns, *_integers(runner)


def _integers(runner: TrialRunner) -> tuple[CheckResult, ...]:
    """Check that integers give what the floats give; nothing for adapters that cannot pass integers."""
    adapter = _INTEGERS.get(runner.subject.adapter)
    if adapter is None:
        return ()
    given = TrialRunner(replace(runner.subject, adapter=adapter))
    q, v = _WHOLE
    for h in (TYPICAL_STEP, 1):
        floats, whole = runner.trial(float(q), float(v), float(h)), given.trial(q, v, h)
        if whole.answer is None:
            words = f"integers are refused: {whole.refusal}"
            return (CheckResult("takes_integers", None, words, (whole,)),)
        near = floats.answer is not None and np.allclose(floats.answer, whole.answer, _ROUNDED, _ROUNDED)
        if not near and not same(floats.answer, whole.answer):
            cut = floats.answer and whole.answer == tuple(map(float, map(int, floats.answer)))
            how = "truncate the answer" if cut else "give a different answer"
            words = f"integers {how}: {floats.seen} becomes {whole.seen}"
            return (CheckResult("takes_integers", False, words, (floats, whole)),)
    return (CheckResult("takes_integers", True, "integers give the same results as floats"),)


def _whole(numbers: Sequence[adapters.AnyNumber]) -> list[adapters.AnyNumber]:
    return [int(x) for x in numbers] if all(x == int(x) for x in numbers) else list(numbers)


# Adapters that pass whole numbers as integers, and others, such as those of a force, as they are.
_INTEGERS = {
    adapters.SCALARS: replace(adapters.SCALARS, name="int", write=lambda x: adapters.one_number(_whole(x))),
    adapters.ARRAYS: replace(adapters.ARRAYS, name="numpy.array", write=lambda x: np.array(_whole(x))),
    adapters.LISTS: replace(adapters.LISTS, name="list", write=_whole),
}


# What a step of h = 0 does: by a fault that is no other method, as steps in displacements divide by h squared; rounded.
ZERO_STEP, DIVIDES, ROUNDED = "zero_step", "divides", "rounded"


def zero_step(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that h = 0 gives the state back."""
    runner = steady_runner(subject)
    trials = [runner.trial(q, v, 0.0) for q, v in (runner.scaled((1.0, 0.75)), runner.ordinary)]
    trial = next((trial for trial in trials if trial.answer != trial.given[:2]), None)
    if trial is None:
        return (CheckResult(ZERO_STEP, True, "h = 0 returns the state unchanged", (trials[0],)),)
    result = partial(CheckResult, ZERO_STEP, example=(trial,))
    if trial.raised == "ZeroDivisionError":
        return (result(False, "it divides by h = 0: it raises ZeroDivisionError", what=DIVIDES),)
    if trial.answer is None:
        return (result(None, f"h = 0 is refused: {trial.refusal}"),)
    if not trial.finite:
        return (result(False, f"it divides by h = 0 and returns {trial.seen}", what=DIVIDES),)
    moved = max(abs(after - before) for after, before in zip(trial.answer, trial.given, strict=False))
    if moved <= runner.rounding:
        return (result(True, f"h = 0 returns the state except for rounding by {moved:.1g}", what=ROUNDED),)
    return (result(False, f"h = 0 moves the state: {trial.given[:2]} becomes {trial.seen}"),)


def negative_step(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that h < 0 steps back in time."""
    runner = steady_runner(subject)
    forth, back = (runner.trial(*runner.ordinary, sign * TYPICAL_STEP) for sign in (1, -1))
    if back.answer is None:
        return (CheckResult("negative_step", None, f"h < 0 is refused: {back.refusal}", (back,)),)
    if not back.finite:
        return (CheckResult("negative_step", False, f"h < 0 gives {back.seen}", (back,)),)
    if same(back.answer, runner.ordinary) and same(forth.answer, runner.ordinary):
        return (CheckResult("negative_step", None, "the state stays the same, for h < 0 as for h > 0", (back, forth)),)
    if same(back.answer, runner.ordinary):
        return (CheckResult("negative_step", False, "h < 0 does nothing: the state is returned unchanged", (back,)),)
    if same(back.answer, forth.answer):
        return (CheckResult("negative_step", False, "h < 0 is treated as |h|", (back, forth)),)
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
            return CheckResult("negative_step", True, "h < 0 steps back in time", (shown,))
    return CheckResult("negative_step", False, "h < 0 does something other than step back", (shown,))


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


_LATE = (1.0, 1000.0, -0.25)


def time_argument(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that the answer does not depend on t, unless a built-in system does, and that a right-hand side gets t."""
    if TIME not in subject.convention.order:
        return ()
    runner = steady_runner(subject)
    start = runner.step(*runner.ordinary, TYPICAL_STEP)
    for t in _LATE:
        later = TrialRunner(_at(subject, t)).trial(*runner.ordinary, TYPICAL_STEP)
        if not same(later.answer, start):
            words = f"the answer depends on t: from the same state, t = 0 gives {start}, t = {t} gives {later.seen}"
            driven = runner.of_another_system or TrialRunner(_at(subject, t)).of_another_system
            return (CheckResult("time", None if driven else False, words),)
    independent = CheckResult("time", True, "the answer does not depend on t")
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
        return CheckResult("time", True, "the answer does not depend on t, and the right-hand side gets t")
    words = f"the right-hand side gets a time outside the step: from t = {t} with h = {h} it is called at {asked[0]}"
    return CheckResult("time", False, words)
