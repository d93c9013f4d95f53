"""What a stepper does with an h of 0 and with one below 0."""

from __future__ import annotations

from driftproof.blackbox.contract.bench import TYPICAL_STEP, Bench, same, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.stepper.subject import Subject

_ZERO, _NEGATIVE = "zero_step", "negative_step"


def zero_step(subject: Subject) -> tuple[Clause, ...]:
    """Whether h = 0 gives the state back."""
    bench = steady_bench(subject)
    trials = [bench.trial(q, v, 0.0) for q, v in (bench.scaled((1.0, 0.75)), bench.ordinary)]
    for trial in trials:
        if trial.answer != trial.given[:2]:
            return (_not_the_state(bench, trial),)
    return (Clause(_ZERO, True, "h = 0 gives the state back", (trials[0],)),)


def _not_the_state(bench: Bench, trial: Trial) -> Clause:
    if "ZeroDivisionError" in trial.failure:
        return Clause(_ZERO, False, "h = 0 is divided by: it raises ZeroDivisionError", (trial,))
    if trial.answer is None:
        return Clause(_ZERO, None, f"h = 0 is refused: {trial.refusal}", (trial,))
    if not trial.finite:
        return Clause(_ZERO, False, f"h = 0 is divided by: {trial.seen} comes back", (trial,))
    moved = max(abs(after - before) for after, before in zip(trial.answer, trial.given, strict=False))
    if moved <= bench.rounding:
        return Clause(_ZERO, True, f"h = 0 gives the state back but for rounding by {moved:.1g}", (trial,))
    return Clause(_ZERO, False, f"h = 0 moves the state: {trial.given[:2]} becomes {trial.seen}", (trial,))


def negative_step(subject: Subject) -> tuple[Clause, ...]:
    """Whether h < 0 steps back in time."""
    bench = steady_bench(subject)
    forth, back = (bench.trial(*bench.ordinary, sign * TYPICAL_STEP) for sign in (1, -1))
    if back.answer is None:
        return (Clause(_NEGATIVE, None, f"h < 0 is refused: {back.refusal}", (back,)),)
    if not back.finite:
        return (Clause(_NEGATIVE, False, f"h < 0 gives {back.seen}", (back,)),)
    if same(back.answer, bench.ordinary):
        return (Clause(_NEGATIVE, False, "h < 0 does nothing: the state comes back", (back,)),)
    if same(back.answer, forth.answer):
        return (Clause(_NEGATIVE, False, "h < 0 acts as |h|", (back, forth)),)
    return (_backward(bench, back),)


def _backward(bench: Bench, shown: Trial) -> Clause:
    """Whether a short step back is opposite to the short step forth, as it is for every consistent method."""
    for h in (TYPICAL_STEP, 2.0**-10):
        forth, back = (bench.trial(*bench.ordinary, sign * h).answer for sign in (1, -1))
        if forth is None or back is None:
            continue
        d, e = ([x - z for x, z in zip(answer, bench.ordinary, strict=True)] for answer in (forth, back))
        along, length = sum(x * y for x, y in zip(d, e, strict=True)), sum(x * x for x in d)
        if abs(along + length) < length / 4:
            return Clause(_NEGATIVE, True, "h < 0 steps back in time", (shown,))
    return Clause(_NEGATIVE, False, "h < 0 does something else than step back", (shown,))
