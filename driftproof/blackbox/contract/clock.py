"""What a stepper that takes the time does with it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from driftproof.blackbox.contract.bench import ORDINARY, TYPICAL_STEP, Bench, same, steady_bench
from driftproof.blackbox.contract.clauses import Clause
from driftproof.blackbox.stepper.doors import FIELD, TIME
from driftproof.blackbox.stepper.subject import Subject

_KEY = "time"
_LATE = (1.0, 1000.0, -0.25)


def clock(subject: Subject) -> tuple[Clause, ...]:
    """Whether the answer depends on t though the system does not, and whether the right-hand side is told t."""
    if TIME not in subject.door.order:
        return ()
    bench = steady_bench(subject)
    start = bench.step(*bench.ordinary, TYPICAL_STEP)
    for t in _LATE:
        later = Bench(_at(subject, t)).trial(*bench.ordinary, TYPICAL_STEP)
        if not same(later.answer, start):
            words = f"the answer depends on t: from the same state, t = 0 gives {start}, t = {t} gives {later.seen}"
            return (Clause(_KEY, False, words),)
    return (_told(subject) if subject.door.kind == FIELD else Clause(_KEY, True, "the answer does not depend on t"),)


def _at(subject: Subject, t: float) -> Subject:
    """The same stepper at another time."""
    place = subject.door.order.index(TIME)

    def later(*arguments: Any, **named: Any) -> Any:
        if subject.door.names:
            return subject.function(**{**named, subject.door.names[place]: t})
        return subject.function(*arguments[:place], t, *arguments[place + 1 :])

    return replace(subject, function=later)


def _told(subject: Subject) -> Clause:
    """Whether the times at which the right-hand side is asked lie in the step."""
    asked: list[float] = []
    t, h = 8.0, TYPICAL_STEP

    def rate(at: float, y: list[float]) -> list[float]:
        asked.append(at)
        return [y[1], -y[0]]

    subject.step_field(rate, t, list(ORDINARY), h)
    if any(t <= at <= t + h for at in asked):
        return Clause(_KEY, True, "the answer does not depend on t, which the right-hand side is told")
    words = f"the right-hand side is told another time: from t = {t} with h = {h} it is asked at {asked[0]}"
    return Clause(_KEY, False, words)
