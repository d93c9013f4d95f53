"""Checks of a stepper's arguments and answers: what it does to them, and of what types they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from driftproof.blackbox.checks.trials import TYPICAL_STEP, CheckResult, TrialRunner, same, steady_runner
from driftproof.blackbox.findings import Misbehaviour, NotANumber
from driftproof.blackbox.stepper import array_adapters as adapters
from driftproof.blackbox.stepper.foreign_code import CallLog
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

_WHOLE = (3, 1)


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
    came: list[adapters.Foreign] = []

    def recorded(*arguments: adapters.Foreign, **named: adapters.Foreign) -> adapters.Foreign:
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
    adapter = _INTEGERS.get(runner.subject.adapter.name)
    if adapter is None:
        return ()
    given = TrialRunner(replace(runner.subject, adapter=adapter))
    q, v = _WHOLE
    for h in (TYPICAL_STEP, 1):
        floats, whole = runner.trial(float(q), float(v), float(h)), given.trial(q, v, h)
        if whole.answer is None:
            words = f"integers are refused: {whole.refusal}"
            return (CheckResult("takes_integers", None, words, (whole,)),)
        if not same(floats.answer, whole.answer):
            cut = floats.answer and whole.answer == tuple(map(float, map(int, floats.answer)))
            how = "truncate the answer" if cut else "give a different answer"
            words = f"integers {how}: {floats.seen} becomes {whole.seen}"
            return (CheckResult("takes_integers", False, words, (floats, whole)),)
    return (CheckResult("takes_integers", True, "integers give the same results as floats"),)


def _whole(numbers: Sequence[adapters.AnyNumber]) -> list[adapters.AnyNumber]:
    return [int(x) for x in numbers] if all(x == int(x) for x in numbers) else list(numbers)


# Adapters that pass whole numbers as integers, and others, such as those of a force, as they are.
_INTEGERS = {
    adapters.SCALARS.name: replace(adapters.SCALARS, name="int", write=lambda x: adapters.one_number(_whole(x))),
    adapters.ARRAYS.name: replace(adapters.ARRAYS, name="numpy.array", write=lambda x: np.array(_whole(x))),
    adapters.LISTS.name: replace(adapters.LISTS, name="list", write=_whole),
}
