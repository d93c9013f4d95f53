"""Checks that the same call gives the same answer: noise, memory of earlier calls, several states at once."""

from __future__ import annotations

import numpy as np

from driftproof.blackbox.checks.trials import (
    ANOTHER,
    IRREGULAR_STEP,
    ORDINARY_STATE,
    CheckResult,
    PhasePoint,
    Trial,
    TrialRunner,
    same,
    steady_runner,
)
from driftproof.blackbox.findings import Misbehaviour, StepFinding, UnsupportedCall
from driftproof.blackbox.probes.coefficients import half_spacing
from driftproof.blackbox.stepper.calling_conventions import FIELD
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.symbolic.rounding.formats import FloatFormat

# A last bit at random is the same in this many calls once in 128.
_REPETITIONS = 8
# Differences up to this many ulp are those of another order of summation: no sum in the catalogue has over 18 terms.
FEW_ULPS = 16
# A solver that begins with its last solution changes a step by less than this part, a method with memory by more. An
# explicit step solves nothing, and repeats to a few ulp.
ALIKE = 2.0**-10
# More steps than the start of any method of the catalogue has, and than codes leave between some action that is not of
# every step.
MANY = 40
_THIRD: PhasePoint = (-1.4142135623730951, -0.2360679774997898)
CALL_BEFORE = "the answer depends on the previous call"
SAME, MEMORY = "same_answer_twice", "no_memory"


def repeats(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that a call gives the same bits again, at once and after other calls."""
    runner = TrialRunner(subject)
    at_once = [_fixed_call(runner) for _ in range(3)]
    after = [_fixed_call(runner, other) for other in (ANOTHER, _THIRD, ANOTHER, _THIRD)]
    answers: list[tuple[float, ...]] = [*at_once, *after]
    alike = all(same(answer, at_once[0]) for answer in answers)
    if not alike and same(at_once[1], at_once[2]) and same(after[0], after[2]) and same(after[1], after[3]):
        return _remembers(runner)
    again = first_call_again(subject)
    if again.holds is False:
        return _varies(f"its answers change from call to call: {again.words}")
    if alike:
        return (
            CheckResult(SAME, True, "the same call gives the same bits"),
            CheckResult(MEMORY, True, "it does not remember earlier calls"),
        )
    trials = tuple(runner.trial(*ORDINARY_STATE, IRREGULAR_STEP) for _ in range(_REPETITIONS))
    answers += [trial.answer for trial in trials if trial.answer is not None]
    spread = max(max(part) - min(part) for part in zip(*answers, strict=True))
    apart = f"{_distance(spread, answers[0], runner.subject.format)} apart"
    example = tuple({trial.answer: trial for trial in trials}.values())[:2]
    return _varies(f"the same call gives answers {apart}", example)


def first_call_again(subject: ForeignStepper, explicit: bool = False) -> StepFinding:
    """Whether the first step of all, made many times again, ends where it did; None if it cannot be repeated.

    That of an `explicit` method does so but for a few ulp of its largest number, since nothing is solved in it.
    """
    if subject.begun is None or subject.convention.momentum != 1:
        return StepFinding(None, "its first step cannot be repeated")
    step, end = subject.begun
    size, most = float(np.max(np.abs(end))), 0.0
    few = 2 * FEW_ULPS * float(half_spacing(size, subject.format))
    for again in (step(subject) for _ in range(MANY)):
        off = np.abs(np.subtract(again, end))
        if not np.all(off <= (few if explicit else ALIKE * np.abs(end))):
            first, last = (", ".join(f"{x:.16g}" for x in numbers) for numbers in (end, again))
            seen = f"its first step ended at ({first}), and the same step, made again after others, at ({last})"
            return StepFinding(False, seen + stale_in(subject))
        most = max(most, float(off.max()))
    told = f"to {most / size:.1e} of its size" if most else "to the last bit"
    return StepFinding(True, f"its first step, made {MANY} times again after all others, ends where it did, {told}")


def stale_in(subject: ForeignStepper) -> str:
    """What an object keeps from its last step that a step of 0 would bring up to date, in words; "" if nothing."""
    names = ", ".join(getattr(subject.function, "late", ()))
    of = f"; what it keeps, {names}, is not that of where it goes on: a stale force, as one asked before positions"
    return f"{of} move, or a method of several steps" if names else ""


def _fixed_call(runner: TrialRunner, before: PhasePoint | None = None) -> PhasePoint:
    """The answer to one fixed call, made after another one if `before` is given."""
    if before is not None:
        runner.step(*before, IRREGULAR_STEP)
    return runner.step(*ORDINARY_STATE, IRREGULAR_STEP)


def _remembers(runner: TrialRunner) -> tuple[CheckResult, ...]:
    """The checks of a stepper whose answer depends on the call before."""
    example = tuple(runner.trial(*z, IRREGULAR_STEP) for before in (ANOTHER, _THIRD) for z in (before, ORDINARY_STATE))
    repeated = CheckResult(SAME, True, "the same call gives the same bits after the same previous call")
    return repeated, CheckResult(MEMORY, False, CALL_BEFORE, example)


def _varies(words: str, example: tuple[Trial, ...] = ()) -> tuple[CheckResult, ...]:
    """The checks of a stepper whose answers differ in no order of the calls."""
    varies = CheckResult(SAME, False, words, example)
    return varies, CheckResult(MEMORY, None, "not tested: the answers vary from call to call")


def _distance(spread: float, answer: tuple[float, ...], fmt: FloatFormat) -> str:
    """The distance in words: in ulp if it is a few of them, else relative to the size of ordinary states."""
    ulps = round(spread / (2 * float(half_spacing(max(map(abs, answer)), fmt))))
    if ulps <= FEW_ULPS:
        return f"up to {max(1, ulps)} ulp"
    return f"up to {spread / max(map(abs, ORDINARY_STATE)):.1e} of their size"


_KEY = "batches"
_STATES = ((1.0, 0.75), (-0.625, 0.25), (0.1, -1.3))


def several_states(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that three states in arrays give the same bits as one by one; nothing if no arrays can be passed."""
    runner = steady_runner(subject)
    if subject.convention.kind == FIELD:
        return ()
    states = [(runner.size * q, runner.size * v) for q, v in _STATES]
    h = runner.number(IRREGULAR_STEP)
    try:
        together = subject.step_batch([q for q, _ in states], [v for _, v in states], h)
    except UnsupportedCall:
        return ()
    except Misbehaviour:
        together = []
    if not together:
        return (CheckResult(_KEY, None, "takes one state at a time"),)
    trials = tuple(runner.trial(q, v, h) for q, v in states)
    for trial, answer in zip(trials, together, strict=True):
        if trial.answer != answer:
            words = f"several states in one call give other results than one by one: {answer} instead of {trial.line}"
            # Of another system than q'' = -q several numbers may be one vector.
            holds = None if runner.of_another_system else False
            return (CheckResult(_KEY, holds, words, (trial,)),)
    return (CheckResult(_KEY, True, "several states in one call give the same results as one by one", trials[:1]),)
