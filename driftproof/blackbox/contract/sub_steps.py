"""Whether a long step is one step: calls of the force are followed, or two steps of half the length compared."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from driftproof.blackbox.contract.bench import Bench, State, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.contract.thresholds import edge, named, rounder
from driftproof.blackbox.stepper.doors import MAP
from driftproof.blackbox.stepper.subject import Subject

_KEY = "sub_steps"
# Calls nearer to each other than this part of the way of all are of one group; an iteration makes at least so many.
_CLOSE, _CALLS_IN_GROUP = 2.0**-6, 3


def sub_steps(subject: Subject) -> tuple[Clause, ...]:
    """Whether steps above some length are made of shorter ones."""
    bench = steady_bench(subject)
    return (_by_halves(bench) if subject.door.kind == MAP else _by_calls(bench),)


def _by_calls(bench: Bench) -> Clause:
    lengths = [2.0**k for k in range(-10, 4)]
    first = len(_places(bench, lengths[0]))
    for shorter, longer in pairwise(lengths):
        if len(_places(bench, longer)) == first:
            continue
        ends = edge(lambda h: len(_places(bench, h)) != first, shorter, longer, bench)
        beyond = _places(bench, ends[1])
        if _halves_agree(bench, ends[1]) and _walks_in_halves(bench, ends[1], beyond):
            return _made_of_shorter(bench, ends, f": {first} of its force calls become {len(beyond)}")
        words = f"it calls the force {first} times at h = {ends[0]:.3g}, {len(beyond)} times from there on"
        why = "it iterates" if _closes_in(beyond) else "it iterates, or adapts a step of its own"
        return Clause(_KEY, None, f"{words}: {why}")
    return Clause(_KEY, True, f"one step is {first} call{'s' * (first != 1)} of the force, whatever h is")


def _places(bench: Bench, h: float, state: State | None = None) -> list[float]:
    """Where a step calls the force, in order."""
    places: list[float] = []

    def force(q: float) -> float:
        places.append(q)
        return -q

    bench.subject.step_with(force, *(state or bench.ordinary), h)
    return places


def _walks_in_halves(bench: Bench, h: float, whole: Sequence[float]) -> bool:
    """True when the step of h calls the force where two steps of h/2 do, in that order.

    That the ends agree tells nothing of a method of high order and a short step. Where the last call of a step is the
    next one's first, it may be made once.
    """
    middle = bench.step(*bench.ordinary, h / 2)
    halves = [*_places(bench, h / 2), *_places(bench, h / 2, middle)]
    near = bench.rounding * max(map(abs, (*whole, *halves)))
    mine, its = _moves(whole, near), _moves(halves, near)
    return len(mine) == len(its) and all(abs(x - y) <= near for x, y in zip(mine, its, strict=True))


def _moves(places: Sequence[float], near: float) -> list[float]:
    """The places without those that repeat the one before."""
    return [x for i, x in enumerate(places) if i == 0 or abs(x - places[i - 1]) > near]


def _closes_in(places: Sequence[float]) -> bool:
    """True when most calls are made close together, as those of an iteration are, seen from all its calls."""
    ordered = sorted(places)
    gap = _CLOSE * (ordered[-1] - ordered[0])
    groups = 1 + sum(y - x > gap for x, y in pairwise(ordered))
    return _CALLS_IN_GROUP * groups <= len(places)


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
