"""Whether several states can be stepped at once, and come out as they do one by one."""

from __future__ import annotations

from driftproof.blackbox.contract.bench import IRREGULAR_STEP, steady_bench
from driftproof.blackbox.contract.clauses import Clause
from driftproof.blackbox.findings import Misbehaviour, NoSuchDoor
from driftproof.blackbox.stepper.subject import Subject

_KEY = "batches"
_STATES = ((1.0, 0.75), (-0.625, 0.25), (0.1, -1.3))


def batches(subject: Subject) -> tuple[Clause, ...]:
    """Arrays of three states against the same three, one after the other: the same bits, or said not to be."""
    bench = steady_bench(subject)
    states = [(bench.size * q, bench.size * v) for q, v in _STATES]
    h = bench.number(IRREGULAR_STEP)
    try:
        together = subject.step_batch([q for q, _ in states], [v for _, v in states], h)
    except NoSuchDoor:
        return ()
    except Misbehaviour:
        return (Clause(_KEY, None, "takes one state at a time"),)
    trials = tuple(bench.trial(q, v, h) for q, v in states)
    for trial, answer in zip(trials, together, strict=True):
        if trial.answer != answer:
            words = f"several states at once come out otherwise than one by one: {answer} in place of {trial.line}"
            return (Clause(_KEY, False, words, (trial,)),)
    return (Clause(_KEY, True, "several states at once come out as they do one by one", trials[:1]),)
