"""What a stepper does to its arguments and to its earlier answers, and what types it takes and gives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from driftproof.blackbox.contract.bench import TYPICAL_STEP, Bench, same, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.findings import Misbehaviour, NotANumber
from driftproof.blackbox.stepper.dialects import ARRAYS, LISTS, SCALARS, Dialect, Foreign, Number, as_array
from driftproof.blackbox.stepper.subject import Subject, Watch

_WHOLE = (3, 1)


def arguments(subject: Subject) -> tuple[Clause, ...]:
    """Whether arguments and earlier answers are left alone, also of a stepper of scalars that is given arrays."""
    bench = steady_bench(subject)
    own = _keeping(bench, subject)
    if subject.dialect is not SCALARS:
        return own
    try:
        arrays = _keeping(bench, replace(subject, dialect=ARRAYS))
    except Misbehaviour:  # it takes no arrays, as it need not
        return own
    return tuple(a if a.holds else replace(a, words=f"given arrays, {a.words}") for a in arrays)


class _Recorder:
    """A stepper, with its last answer as it came."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.answer: Foreign = None

    def __call__(self, *arguments: Foreign, **named: Foreign) -> Foreign:
        self.answer = self.function(*arguments, **named)
        return self.answer


def _keeping(steady: Bench, subject: Subject) -> tuple[Clause, Clause]:
    recorder, watch = _Recorder(subject.function), Watch()
    bench = Bench(replace(subject, function=recorder, watch=watch))
    bench.step(*steady.ordinary, TYPICAL_STEP)
    trial = bench.trial(*steady.ordinary, TYPICAL_STEP)
    answer, before = recorder.answer, _numbers(recorder.answer)
    bench.step(*steady.another, TYPICAL_STEP)
    if same(before, _numbers(answer)):
        answers = Clause("keeps_answers", True, "earlier answers are left as they are")
    else:
        answers = Clause("keeps_answers", False, "an answer is overwritten by the next", (trial,))
    return _arguments_clause(watch, trial), answers


def _arguments_clause(watch: Watch, trial: Trial) -> Clause:
    if watch.works_in_place:
        return Clause("keeps_arguments", False, "it writes its answer into its arguments and returns nothing", (trial,))
    if watch.changes_its_arguments:
        return Clause("keeps_arguments", False, "it changes its arguments, besides returning an answer", (trial,))
    return Clause("keeps_arguments", True, "its arguments are left as they are")


def _numbers(answer: Foreign) -> list[float]:
    """All numbers in an answer as they are now; none where they are not to be read."""
    parts = answer if isinstance(answer, tuple | list) else [answer]
    try:
        return [float(x) for part in parts for x in as_array(part).ravel()]
    except NotANumber:
        return []


def types(subject: Subject) -> tuple[Clause, ...]:
    """What types of numbers come back, and whether integers may be given."""
    bench = steady_bench(subject)
    watch = Watch(works_in_place=subject.watch.works_in_place)
    watched = Bench(replace(subject, watch=watch))
    watched.step(*bench.ordinary, TYPICAL_STEP)
    found = sorted(watch.types)
    if all(name.rpartition(".")[2].startswith(("int", "uint", "bool")) for name in found):
        trial = bench.trial(1.0, 0.75, 0.0)
        rounded = trial.answer is not None and trial.answer != (1.0, 0.75)
        words = f"returns integers{': at h = 0, (1.0, 0.75) becomes ' + trial.seen if rounded else ''}"
        returns = Clause("returns", False, words, (trial,))
    else:
        returns = Clause("returns", True, f"returns {' and '.join(found)}")
    return returns, *_integers(bench)


def _integers(bench: Bench) -> tuple[Clause, ...]:
    """Whether integers give what the floats give; nothing for numbers that are neither."""
    dialect = _INTEGERS.get(bench.subject.dialect.name)
    if dialect is None:
        return ()
    given = Bench(replace(bench.subject, dialect=dialect))
    q, v = _WHOLE
    for h in (TYPICAL_STEP, 1):
        floats, whole = bench.trial(float(q), float(v), float(h)), given.trial(q, v, h)
        if whole.answer is None:
            words = f"integers are refused: {whole.refusal}"
            return (Clause("takes_integers", None, words, (whole,)),)
        if not same(floats.answer, whole.answer):
            cut = floats.answer and whole.answer == tuple(map(float, map(int, floats.answer)))
            words = (
                f"integers {'cut the answer off' if cut else 'give another answer'}: {floats.seen} becomes {whole.seen}"
            )
            return (Clause("takes_integers", False, words, (floats, whole)),)
    return (Clause("takes_integers", True, "integers give what the same floats give"),)


def _whole(numbers: Sequence[Number]) -> list[Number]:
    return [int(x) for x in numbers] if all(x == int(x) for x in numbers) else list(numbers)


# Numbers that are whole go in as integers; the others, as of a force, as they are.
_INTEGERS = {
    SCALARS.name: Dialect("int", lambda numbers: _whole(numbers)[0], SCALARS.read),
    ARRAYS.name: Dialect("numpy.array", lambda numbers: np.array(_whole(numbers)), ARRAYS.read),
    LISTS.name: Dialect("list", _whole, LISTS.read),
}
