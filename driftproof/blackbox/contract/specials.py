"""Whether NaN and infinities are handed on or refused; a stepper should make no ordinary numbers of them."""

from __future__ import annotations

from math import inf, nan

from driftproof.blackbox.contract.bench import State, steady_bench
from driftproof.blackbox.contract.clauses import Clause
from driftproof.blackbox.stepper.subject import Subject


def not_a_number(subject: Subject) -> tuple[Clause, ...]:
    """What becomes of a NaN."""
    return (_noticed(subject, "not_a_number", "NaN", ((nan, 0.75), (1.0, nan))),)


def infinity(subject: Subject) -> tuple[Clause, ...]:
    """What becomes of an infinite position or velocity."""
    return (_noticed(subject, "infinity", "an infinity", ((inf, 0.75), (1.0, inf), (-inf, 0.75), (1.0, -inf))),)


def not_a_number_step(subject: Subject) -> tuple[Clause, ...]:
    """What becomes of h = NaN."""
    return (_noticed(subject, "not_a_number_step", "h = NaN", ((1.0, 0.75),), nan),)


def _noticed(subject: Subject, key: str, name: str, states: tuple[State, ...], h: float = 0.25) -> Clause:
    bench = steady_bench(subject)
    trials = [bench.trial(*z, h) for z in states]
    for trial in trials:
        if trial.finite:
            words = f"{name} goes in and ordinary numbers come out: {trial.line}"
            return Clause(key, False, words, (trial,))
    for trial in trials:
        if trial.answer is None:
            return Clause(key, None, f"{name} is refused: {trial.refusal}", (trial,))
    return Clause(key, True, f"{name} is handed on", (trials[0],))
