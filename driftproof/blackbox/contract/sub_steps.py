"""Whether a long step is one step: calls of the force are counted, or two steps of half the length compared."""

from __future__ import annotations

from itertools import pairwise

from driftproof.blackbox.contract.bench import Bench, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.contract.thresholds import edge, named, rounder
from driftproof.blackbox.stepper.doors import MAP
from driftproof.blackbox.stepper.subject import Subject
from methods.problems import oscillator
from numeric.steppers import CountedForce

_KEY = "sub_steps"


def sub_steps(subject: Subject) -> tuple[Clause, ...]:
    """Whether steps above some length are made of shorter ones."""
    bench = steady_bench(subject)
    return (_by_halves(bench) if subject.door.kind == MAP else _by_calls(bench),)


def _by_calls(bench: Bench) -> Clause:
    lengths = [2.0**k for k in range(-10, 4)]
    first = _calls(bench, lengths[0])
    for shorter, longer in pairwise(lengths):
        if _calls(bench, longer) == first:
            continue
        ends = edge(lambda h: _calls(bench, h) != first, shorter, longer, bench)
        beyond = _calls(bench, ends[1])
        if _halves_agree(bench, ends[1]):
            return _made_of_shorter(bench, ends, f": {first} of its force calls become {beyond}")
        words = f"it calls the force {first} times at h = {ends[0]:.3g}, {beyond} times from there on"
        return Clause(_KEY, None, f"{words}: it iterates, or adapts a step of its own")
    return Clause(_KEY, True, f"one step is {first} call{'s' * (first != 1)} of the force, whatever h is")


def _calls(bench: Bench, h: float) -> int:
    force = CountedForce(oscillator)
    bench.subject.step_with(force, *bench.ordinary, h)
    return force.calls


def _by_halves(bench: Bench) -> Clause:
    """S(h) = S(h/2) S(h/2) is true of a step of h made of an even number of steps, and of no other but the exact flow.

    It is true of very short steps of all methods, to rounding: what tells is that it becomes true as h grows.
    """
    lengths = [2.0**k for k in range(-14, 4)]
    agree = [_halves_agree(bench, h) for h in lengths]
    for place in range(1, len(lengths)):
        if agree[place] and not agree[place - 1]:
            ends = edge(lambda h: _halves_agree(bench, h), lengths[place - 1], lengths[place], bench)
            return _made_of_shorter(bench, ends, "")
    return Clause(_KEY, True, "no sub-steps are seen")


def _halves_agree(bench: Bench, h: float) -> bool:
    """True when one step of h is two steps of h/2, to rounding."""
    whole = bench.trial(*bench.ordinary, h).answer
    half = bench.trial(*bench.ordinary, h / 2).answer
    twice = None if half is None else bench.trial(half[0], half[1], h / 2).answer
    if whole is None or twice is None:
        return False
    size = max(map(abs, (*bench.ordinary, *whole, *twice)))
    return max(abs(a - b) for a, b in zip(whole, twice, strict=True)) <= bench.rounding * size


def _made_of_shorter(bench: Bench, ends: tuple[float, float], more: str) -> Clause:
    limit = rounder(*ends)
    where = "above" if limit == ends[0] else "from"
    example: tuple[Trial, ...] = tuple(bench.trial(*bench.ordinary, h) for h in ends)
    words = f"{where} h = {named(limit)}{'' if where == 'above' else ' on'} it takes sub-steps{more}"
    return Clause(_KEY, False, words, example)
