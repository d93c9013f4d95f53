"""Whether the same call gives the same answer: noise, memory of the calls before, and whose memory it is."""

from __future__ import annotations

import random
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace

import numpy as np

from driftproof.blackbox.contract.bench import ANOTHER, IRREGULAR_STEP, ORDINARY, Bench, State, same
from driftproof.blackbox.contract.clauses import Clause
from driftproof.blackbox.probes.coefficients import half_spacing
from driftproof.blackbox.stepper.subject import Subject
from driftproof.symbolic.rounding.formats import FloatFormat

_REPETITIONS = 8
# So many and fewer are those of sums taken in another order.
_FEW_ULPS = 16
_THIRD: State = (-1.4142135623730951, -0.2360679774997898)
SAME, _MEMORY = "same_answer_twice", "no_memory"


def repeats(subject: Subject) -> tuple[Clause, ...]:
    """Whether a call gives the same bits again, at once and after other calls."""
    bench = Bench(subject)
    at_once = [_asked(bench) for _ in range(3)]
    after = [_asked(bench, other) for other in (ANOTHER, _THIRD, ANOTHER, _THIRD)]
    if all(same(answer, at_once[0]) for answer in (*at_once, *after)):
        return (
            Clause(SAME, True, "the same call gives the same bits"),
            Clause(_MEMORY, True, "it does not remember the calls before"),
        )
    if same(at_once[1], at_once[2]) and same(after[0], after[2]) and same(after[1], after[3]):
        return _remembers(bench)
    return _varies(bench)


def _asked(bench: Bench, before: State | None = None) -> State:
    """The answer to one and the same call, made after another one."""
    if before is not None:
        bench.step(*before, IRREGULAR_STEP)
    return bench.step(*ORDINARY, IRREGULAR_STEP)


def _remembers(bench: Bench) -> tuple[Clause, ...]:
    """The answer depends on the call before, and on nothing else that changes."""
    example = tuple(bench.trial(*z, IRREGULAR_STEP) for before in (ANOTHER, _THIRD) for z in (before, ORDINARY))
    found = (
        Clause(SAME, True, "the same call gives the same bits after the same call before"),
        Clause(_MEMORY, False, "the answer depends on the call before", example),
    )
    return found + _memory_of_another(bench)


def _memory_of_another(bench: Bench) -> tuple[Clause, ...]:
    """Whether a copy of the stepper changes what this one remembers; nothing where there is no copy."""
    other = _copy(bench)
    if other is None:
        return ()
    alone = _asked(bench, ANOTHER)
    bench.step(*ANOTHER, IRREGULAR_STEP)
    other.step(*_THIRD, IRREGULAR_STEP)
    if same(_asked(bench), alone):
        return (Clause("own_memory", True, "a second object has a memory of its own"),)
    return (Clause("own_memory", False, "a second object shares the memory"),)


def _copy(bench: Bench) -> Bench | None:
    """The bench of a second object; None where a copy is the same object, as of a function, or cannot be made."""
    function = bench.subject.function
    try:
        other = deepcopy(function)
    except Exception:  # other people's objects raise what they like
        return None
    return None if other is function else Bench(replace(bench.subject, function=other))


def _varies(bench: Bench) -> tuple[Clause, ...]:
    """Every call gives another answer: drawn at random, by a count of its own, or for no reason seen from outside."""
    trials = tuple(bench.trial(*ORDINARY, IRREGULAR_STEP) for _ in range(_REPETITIONS))
    answers = [trial.answer for trial in trials if trial.answer is not None]
    spread = max(max(part) - min(part) for part in zip(*answers, strict=True))
    apart = f"{_distance(spread, answers[0], bench.subject.format)} apart"
    example = tuple({trial.answer: trial for trial in trials}.values())[:2]
    if _draws(bench):
        why = "it draws on the random numbers of Python or NumPy"
    elif _repeats_when(bench, _copy):
        words = f"every call changes something that it remembers: the same call gives answers {apart}"
        return Clause(SAME, False, words, example), Clause(_MEMORY, False, "it remembers every call", example)
    else:
        why = "noise, or something that it remembers outside"
    words = f"the same call gives answers {apart}: {why}"
    return Clause(SAME, False, words, example), Clause(_MEMORY, None, "not asked: the answers vary by themselves")


def _distance(spread: float, answer: tuple[float, ...], fmt: FloatFormat) -> str:
    """Up to 2 ulp, where it is a few of them; else relative to the size of ordinary states."""
    ulps = round(spread / (2 * float(half_spacing(max(map(abs, answer)), fmt))))
    if ulps <= _FEW_ULPS:
        return f"up to {max(1, ulps)} ulp"
    return f"up to {spread / max(map(abs, ORDINARY)):.1e} of their size"


def _repeats_when(bench: Bench, prepared: Callable[[Bench], Bench | None]) -> bool:
    """True when two series of the same calls agree, each begun from the same preparation."""
    series = []
    for _ in range(2):
        ready = prepared(bench)
        if ready is None:
            return False
        series.append([_asked(ready) for _ in range(3)])
    return all(map(same, *series))


def _draws(bench: Bench) -> bool:
    """True when the answers come from the generators of random numbers that everybody shares; these are put back."""
    pythons, numpys = random.getstate(), np.random.get_state()
    try:
        return _repeats_when(bench, _seeded)
    finally:
        random.setstate(pythons)
        np.random.set_state(numpys)


def _seeded(bench: Bench) -> Bench:
    random.seed(0)
    np.random.seed(0)
    return bench
