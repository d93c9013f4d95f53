"""Whether a stepper takes the h that it is given, or another: a fixed one, one within bounds, whole steps."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ulp

from driftproof.blackbox.contract.bench import TYPICAL_STEP, Bench, same, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.contract.thresholds import edge, named, rounder
from driftproof.blackbox.stepper.doors import MAP
from driftproof.blackbox.stepper.subject import Subject

_KEY = "step_size"
# From a position of 0 it goes h v at once: every bit of h shows. One speed is of ordinary size, one small: long steps
# may end at a border of the domain, and small speeds be put to rest, whatever h is.
_SPEEDS = (0.5671432904097838, 0.5671432904097838 * 2.0**-20)
# Long enough for any bound in use, and short enough for a stepper that takes sub-steps of 1/10000.
_LONGEST, _SHORTEST = 16.0, 2.0**-40
# Fixed steps with names: 1/60, 1/240, ...
_DENOMINATORS = 1000
# An answer may be the same for a few neighbouring h.
_ULPS = 16


def step_size(subject: Subject) -> tuple[Clause, ...]:
    """Whether the answer depends on h, for long and short steps and for nearly equal ones."""
    taken = _Taken(steady_bench(subject))
    if all(taken.alike(h, TYPICAL_STEP) for h in (_SHORTEST, 2.0**-10, 1.0, _LONGEST)):
        return (_ignored(taken),)
    capped = _capped(taken)
    found = [rule for rule in (_raised(taken), capped or _in_whole_steps(taken)) if rule]
    if not found:
        return (Clause(_KEY, True, "every h is taken as it is"),)
    words, examples = zip(*found, strict=True)
    return (Clause(_KEY, False, "; ".join(words), tuple(trial for example in examples for trial in example)),)


@dataclass(frozen=True)
class _Taken:
    """The answers to one state, by h."""

    bench: Bench

    def trial(self, h: float, speed: float = _SPEEDS[0]) -> Trial:
        """The step of h."""
        return self.bench.trial(*self.bench.scaled((0.0, speed)), h)

    def alike(self, h: float, other: float) -> bool:
        """True when both give the same finite answers."""
        pairs = ((self.trial(h, speed), self.trial(other, speed)) for speed in _SPEEDS)
        return all(one.finite and same(one.answer, two.answer) for one, two in pairs)

    def edge_of(self, like: float, unlike: float) -> tuple[float, float]:
        """Neighbours between the two h, the first with another answer than `like`, the second with the same."""
        return edge(lambda h: self.alike(h, like), unlike, like, self.bench)

    def bound(self, like: float, unlike: float) -> float:
        """The last h with the same answer, on the way to the other; by its short name if that makes no difference."""
        last = self.edge_of(like, unlike)[1]
        short = float(f"{last:.12g}")
        return short if abs(short - last) <= _ULPS * ulp(last) and self.alike(short, like) else last


_Found = tuple[str, tuple[Trial, ...]]


def _ignored(taken: _Taken) -> Clause:
    """A clause with the step that is always taken: read from a free motion, of which every method gives h v."""
    bench, subject = taken.bench, taken.bench.subject
    if subject.door.kind == MAP:
        length, words = bench.step(0.0, 1.0, TYPICAL_STEP)[0], "the step by which (0, 1) moves by"
    else:
        length, words = subject.step_with(lambda q: 0.0 * q, 0.0, 1.0, TYPICAL_STEP)[0], "a step of"
    simple = Fraction(length).limit_denominator(_DENOMINATORS)
    name = str(simple) if bench.number(float(simple)) == length else named(length)
    words = f"h is ignored: {words} {name} is always taken"
    return Clause(_KEY, False, words, (taken.trial(TYPICAL_STEP), taken.trial(1.0)))


def _capped(taken: _Taken) -> _Found | None:
    """Whether all long steps are one step."""
    if not taken.alike(_LONGEST / 2, _LONGEST):
        return None
    unlike = next(h for h in (4.0, 1.0, TYPICAL_STEP, 2.0**-10, _SHORTEST) if not taken.alike(h, _LONGEST))
    cap = taken.bound(_LONGEST, unlike)
    return f"h is capped at {named(cap)}", (taken.trial(cap), taken.trial(_LONGEST))


def _raised(taken: _Taken) -> _Found | None:
    """Whether all short steps are one step, or none."""
    if taken.bench.grain or not taken.alike(_SHORTEST, 2.0**-30):
        return None
    unlike = next(h for h in (2.0**-20, 2.0**-10, TYPICAL_STEP, 1.0, 4.0, _LONGEST) if not taken.alike(h, _SHORTEST))
    shortest = taken.trial(_SHORTEST)
    if not same(shortest.answer, shortest.given[:2]):
        least = taken.bound(_SHORTEST, unlike)
        return f"h is raised to {named(least)}", (taken.trial(_SHORTEST), taken.trial(least))
    ends = taken.edge_of(_SHORTEST, unlike)
    limit = rounder(*ends)
    where = "below" if limit == ends[0] else "up to"
    return f"h {where} {named(limit)} does nothing", (taken.trial(ends[1]), taken.trial(ends[0]))


def _in_whole_steps(taken: _Taken) -> _Found | None:
    """Whether nearly equal h give the same answer."""
    if taken.bench.grain or not taken.alike(TYPICAL_STEP, TYPICAL_STEP * (1 + 2.0**-10)):
        return None
    longer = next((h for h in (0.5, 1.0, _LONGEST) if not taken.alike(h, TYPICAL_STEP)), None)
    shorter = next((h for h in (0.125, 2.0**-10, _SHORTEST) if not taken.alike(h, TYPICAL_STEP)), None)
    if longer is None or shorter is None:
        return None
    least, most = taken.bound(TYPICAL_STEP, shorter), taken.bound(TYPICAL_STEP, longer)
    words = f"h is taken in whole steps: every h from {least:.6g} to {most:.6g} gives the same answer"
    return words, (taken.trial(least), taken.trial(most))
