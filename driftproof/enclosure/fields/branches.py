"""Runs of f with each outcome that its comparisons may have, where they cannot be decided."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TypeAlias, TypeVar

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused

# chosen: each combination of outcomes takes a run; measured data of 60 points have so many.
MOST_OUTCOMES = 64
# A comparison as names of its two numbers, with the sign between them, > or >=.
Condition: TypeAlias = tuple[Hashable, str, Hashable]
_Made = TypeVar("_Made")


class Branching(Evaluation):
    """A run whose comparisons come out as told, those behind them as true; what some of them imply is not asked."""

    def __init__(self, outcomes: Sequence[bool], *, forward: bool = False) -> None:
        super().__init__(forward=forward)
        self.outcomes, self.known = outcomes, dict[Condition, bool]()

    def outcome(self, a: Hashable, b: Hashable, at_zero: bool) -> bool:
        """Whether a > b, or a >= b if `at_zero`, by names that two numbers share only if they are equal.

        What is said of two names is always consistent.
        """
        sign, other = (">=", ">") if at_zero else (">", ">=")
        if (b, other, a) in self.known:  # a > b, unless b >= a
            return not self.known[b, other, a]
        if self.known.get((a, other, b)) is at_zero or self.known.get((b, sign, a)) is (not at_zero):
            return at_zero  # a > b tells a >= b, and not b > a
        at = len(self.known)
        _require_few(at)  # in a loop, too, that ends by a comparison
        return self.known.setdefault((a, sign, b), self.outcomes[at] if at < len(self.outcomes) else True)


def on_all_branches(
    run: Callable[[Sequence[bool]], tuple[_Made, Branching]], chosen: Callable[[Condition, _Made, _Made], _Made]
) -> _Made:
    """What all runs make, given the outcomes of their first comparisons; `chosen` joins what two of them make."""
    runs = 0

    def made_behind(outcomes: Sequence[bool]) -> _Made:
        nonlocal runs
        runs += 1
        _require_few(runs)
        made, branch = run(outcomes)
        conditions, told = list(branch.known), list(branch.known.values())
        for at in reversed(range(len(outcomes), len(conditions))):
            made = chosen(conditions[at], made, made_behind([*told[:at], False]))
        return made

    return made_behind(())


def _require_few(outcomes: int) -> None:
    """Raise Refused if there are too many."""
    if outcomes > MOST_OUTCOMES:
        raise Refused(f"f compares numbers with more than {MOST_OUTCOMES} outcomes; certify takes such an f")
