"""Checks of the step size: whether h is taken as it is, or fixed, bounded, rounded, or split into sub-steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import isfinite, ulp

from driftproof.blackbox.checks.borders import bisected_neighbours, short_name, shorter_number
from driftproof.blackbox.checks.trials import (
    TYPICAL_STEP,
    CheckResult,
    PhasePoint,
    Trial,
    TrialRunner,
    same,
    steady_runner,
)
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.support.plain_text import counted
from driftproof.symbolic.rounding.formats import power_of_two

STEP_SIZE, IGNORED = "step_size", "ignored"
_STILL = "at v = 1, q = 0 stays 0 for every h > 0, as at the ends of a grid or after a run that fills arrays of its own"
# From the position 0 a step moves by h v, which shows every bit of h. One speed is of ordinary size, one small: long
# steps may end at a border of the domain, and small speeds may be put to rest, whatever h is.
_SPEEDS = (0.5671432904097838, 0.5671432904097838 * 2.0**-20)
# Long enough for any bound in use, and short enough for a stepper that takes sub-steps of 1/10000.
_LONGEST, _SHORTEST = 16.0, 2.0**-40
# Among these, a step is sought that gives another answer than the longest or shortest: the bound lies in between.
_LENGTHS = (2.0**-20, 2.0**-10, TYPICAL_STEP, 1.0, 4.0, _LONGEST)
# The largest denominator of a fixed step that is shown as a fraction: 1/60, 1/240, ...
_DENOMINATORS = 1000
# An answer may be the same for a few neighbouring h: it has as many bits as h, and is made by a few roundings.
_ULPS = 16


def step_size(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check that the answer depends on h, for long and short steps and for nearly equal ones."""
    taken = _Taken(steady_runner(subject))
    if all(taken.alike(h, TYPICAL_STEP) for h in (taken.shortest, 2.0**-10, 1.0, _LONGEST)):
        away = [taken.runner.trial(*taken.runner.scaled((_SPEEDS[0], _SPEEDS[0])), h) for h in (TYPICAL_STEP, 1.0)]
        if all(trial.finite for trial in away) and not same(away[0].answer, away[1].answer):
            return (CheckResult(STEP_SIZE, None, "from q = 0 no step moves, as from a rest of its own system"),)
        return (_ignored(taken),)
    capped = _capped(taken)
    found = [rule for rule in (_raised(taken), capped or _in_whole_steps(taken)) if rule]
    for trial in map(taken.trial, () if found else (taken.shortest, _LONGEST)):
        if trial.answer is None:
            return (CheckResult(STEP_SIZE, None, f"h = {trial.given[2]:.3g} is refused: {trial.refusal}", (trial,)),)
    if not found:
        return (CheckResult(STEP_SIZE, True, "every h is used as given"),)
    words, examples = zip(*found, strict=True)
    return (CheckResult(STEP_SIZE, False, "; ".join(words), tuple(trial for example in examples for trial in example)),)


@dataclass(frozen=True)
class _Taken:
    """The answers from one state, at two speeds, as functions of h."""

    runner: TrialRunner

    @property
    def shortest(self) -> float:
        """The shortest h that is tried, so that h v is a normal number at ordinary speed: 2**-12 in binary16."""
        return max(_SHORTEST, 4 * float(power_of_two(self.runner.format.emin)))

    def trial(self, h: float, speed: float = _SPEEDS[0]) -> Trial:
        """The step of size h."""
        return self.runner.trial(*self.runner.scaled((0.0, speed)), h)

    def alike(self, h: float, other: float) -> bool:
        """True if both give the same finite answers."""
        pairs = ((self.trial(h, speed), self.trial(other, speed)) for speed in _SPEEDS)
        return all(one.finite and same(one.answer, two.answer) for one, two in pairs)

    def edge_of(self, like: float, unlike: float) -> tuple[float, float]:
        """Neighbours between the two h, the first with another answer than `like`, the second with the same."""
        return bisected_neighbours(lambda h: self.alike(h, like), unlike, like, self.runner)

    def bound(self, like: float, unlike: float) -> float:
        """The last h with the answer of `like`, on the way to `unlike`; in 12 digits if that makes no difference."""
        last = self.edge_of(like, unlike)[1]
        short = float(f"{last:.12g}")
        return short if abs(short - last) <= _ULPS * ulp(last) and self.alike(short, like) else last


_Found = tuple[str, tuple[Trial, ...]]


def _ignored(taken: _Taken) -> CheckResult:
    """The failed check with the step that is always taken, read from a free motion, which every method moves by h v."""
    runner, subject = taken.runner, taken.runner.subject
    if subject.convention.kind == MAP:
        length, words = runner.step(0.0, 1.0, TYPICAL_STEP)[0], "a step that moves (0, 1) by"
    else:
        length, words = subject.step_with(lambda q: 0.0 * q, 0.0, 1.0, TYPICAL_STEP)[0], "a step of"
    simple = Fraction(length).limit_denominator(_DENOMINATORS)
    told = simple.denominator > 1 and runner.number(float(simple)) == length
    name = str(simple) if told else short_name(length)
    words = f"h is ignored: {words} {name} is always taken" if length else f"nothing moves: {_STILL}"
    return CheckResult(STEP_SIZE, False, words, (taken.trial(TYPICAL_STEP), taken.trial(1.0)), IGNORED)


def _capped(taken: _Taken) -> _Found | None:
    """The finding that all long steps are taken with one h; None if they are not."""
    if not taken.alike(_LONGEST / 2, _LONGEST):
        return None
    unlike = next(h for h in reversed(_LENGTHS) if not taken.alike(h, _LONGEST))
    cap = taken.bound(_LONGEST, unlike)
    return f"h is capped at {short_name(cap)}", (taken.trial(cap), taken.trial(_LONGEST))


def _raised(taken: _Taken) -> _Found | None:
    """The finding that all short steps are taken with one h, or do nothing; None if neither is so."""
    least = taken.shortest
    if taken.runner.grain or not taken.alike(least, 2.0**10 * least):
        return None
    unlike = next(h for h in _LENGTHS if not taken.alike(h, least))
    shortest = taken.trial(least)
    if not same(shortest.answer, shortest.given[:2]):
        bound = taken.bound(least, unlike)
        return f"h is raised to {short_name(bound)}", (shortest, taken.trial(bound))
    ends = taken.edge_of(least, unlike)
    limit = shorter_number(*ends)
    where = "below" if limit == ends[0] else "up to"
    return f"h {where} {short_name(limit)} does nothing", (taken.trial(ends[1]), taken.trial(ends[0]))


def _in_whole_steps(taken: _Taken) -> _Found | None:
    """The finding that nearly equal h give the same answer; None if they do not."""
    alike = [taken.alike(TYPICAL_STEP, h) for h in (TYPICAL_STEP * (1 + 2.0**-10), taken.shortest, _LONGEST)]
    if taken.runner.grain or alike != [True, False, False]:
        return None
    least, most = taken.bound(TYPICAL_STEP, taken.shortest), taken.bound(TYPICAL_STEP, _LONGEST)
    words = f"h is rounded to whole steps: every h from {least:.6g} to {most:.6g} gives the same answer"
    return words, (taken.trial(least), taken.trial(most))


_SUB_STEPS = "sub_steps"
# Calls nearer to each other than this part of the range of all are one group: different nodes of a method are farther
# apart as a rule. An iteration makes three or more at one place: a guess, a correction, and one that changes nothing.
_CLOSE, _CALLS_IN_GROUP = 2.0**-6, 3
# Step sizes beyond the first that is made of two halves: the second one in twice the number of sub-steps comes later.
_IN_A_RANGE = (1 + 2.0**-7, 1 + 2.0**-4)


def sub_steps(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check whether steps above some length are made of shorter ones."""
    runner = steady_runner(subject)
    return (_by_halves(runner) if subject.convention.kind == MAP else _by_calls(runner),)


def _by_calls(runner: TrialRunner) -> CheckResult:
    lengths = [2.0**k for k in range(-10, 4)]
    first = len(_places(runner, lengths[0]))
    for shorter, longer in pairwise(lengths):
        if len(_places(runner, longer)) == first:
            continue
        ends = bisected_neighbours(lambda h: len(_places(runner, h)) != first, shorter, longer, runner)
        beyond = _places(runner, ends[1])
        if _halves_agree(runner, ends[1]) and _walks_in_halves(runner, ends[1], beyond):
            return _made_of_shorter(runner, ends, f": {first} of its force calls become {len(beyond)}")
        words = f"it calls the force {first} times at h = {ends[0]:.3g}, {len(beyond)} times from there on"
        why = "it iterates" if _closes_in(beyond) else "it iterates, or adapts a step of its own"
        return CheckResult(_SUB_STEPS, None, f"{words}: {why}")
    return CheckResult(_SUB_STEPS, True, f"one step calls the force {counted(first, 'time')}, whatever h is")


def _places(runner: TrialRunner, h: float, state: PhasePoint | None = None) -> list[float]:
    """The positions at which a step evaluates the force, in order."""
    places: list[float] = []

    def force(q: float) -> float:
        places.append(q)
        return -q

    runner.subject.step_with(force, *(state or runner.ordinary), h)
    return places


def _walks_in_halves(runner: TrialRunner, h: float, whole: Sequence[float]) -> bool:
    """True if the step of h evaluates the force where two steps of h/2 do, in that order.

    Equal ends prove nothing for a method of high order and a short step. If the last call of a step is the first one of
    the next, it may be made once.
    """
    middle = runner.step(*runner.ordinary, h / 2)
    halves = [*_places(runner, h / 2), *_places(runner, h / 2, middle)]
    allowed = runner.rounding * max(map(abs, (*whole, *halves)))
    mine, its = _moves(whole, allowed), _moves(halves, allowed)
    return len(mine) == len(its) and all(abs(x - y) <= allowed for x, y in zip(mine, its, strict=True))


def _moves(places: Sequence[float], allowed: float) -> list[float]:
    """The places without those that repeat the one before."""
    return [x for i, x in enumerate(places) if i == 0 or abs(x - places[i - 1]) > allowed]


def _closes_in(places: Sequence[float]) -> bool:
    """True if most calls are made close together, relative to the range of all, as those of an iteration are."""
    ordered = sorted(places)
    gap = _CLOSE * (ordered[-1] - ordered[0])
    groups = 1 + sum(y - x > gap for x, y in pairwise(ordered))
    return _CALLS_IN_GROUP * groups <= len(places)


def _by_halves(runner: TrialRunner) -> CheckResult:
    """Check where S(h) = S(h/2) S(h/2) begins to hold, as it does only for sub-steps in even number or the exact flow.

    For very short steps it holds to rounding for every method: what counts is that it begins to hold as h grows, and
    in a range of h; at a single h it may hold by chance, as for Heun's method on y' = -8y at h = 1, where
    R(-8) = R(-4)^2.
    """
    agree = {h: _halves_agree(runner, h) for h in (2.0**k for k in range(-14, 4))}
    for shorter, longer in pairwise(agree):
        if agree[longer] and not agree[shorter]:
            ends = bisected_neighbours(lambda h: _halves_agree(runner, h), shorter, longer, runner)
            if all(_halves_agree(runner, part * ends[1]) for part in _IN_A_RANGE):
                return _made_of_shorter(runner, ends, "")
    return CheckResult(_SUB_STEPS, True, "no sub-steps were detected")


def _halves_agree(runner: TrialRunner, h: float) -> bool:
    """True if one step of h is two steps of h/2, to rounding."""
    whole = runner.trial(*runner.ordinary, h).answer
    half = runner.trial(*runner.ordinary, h / 2).answer
    twice = None if half is None else runner.trial(half[0], half[1], h / 2).answer
    if whole is None or twice is None:
        return False
    size = max(map(abs, (*runner.ordinary, *whole, *twice)))
    return (
        isfinite(sum((*whole, *twice)))
        and max(abs(a - b) for a, b in zip(whole, twice, strict=True)) <= runner.rounding * size
    )


def _made_of_shorter(runner: TrialRunner, ends: tuple[float, float], more: str) -> CheckResult:
    limit = shorter_number(*ends)
    where = "above" if limit == ends[0] else "from"
    example = tuple(runner.trial(*runner.ordinary, h) for h in ends)
    words = f"{where} h = {short_name(limit)}{'' if where == 'above' else ' on'} it takes sub-steps{more}"
    return CheckResult(_SUB_STEPS, False, words, example)
