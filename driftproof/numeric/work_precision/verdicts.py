"""Verdicts on error against cost: the goals that are looked at, and methods that others dominate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import NamedTuple, TypeVar

GOALS = (1e-3, 1e-6, 1e-10)
Name = TypeVar("Name")


class Priced(NamedTuple):
    """A point: its error and its cost, in evaluations or in seconds; the cost is infinite if it was not timed."""

    error: float
    cost: float


def goal_text(goal: float) -> str:
    """The error as in 1e-3 or 2.5e-8."""
    mantissa, _, exponent = f"{goal:e}".partition("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"


def dominators(curves: Mapping[Name, Sequence[Priced]]) -> dict[Name, list[Name]]:
    """For each dominated method the methods that dominate it, the one that beats most of its points first.

    A point is dominated if a point of another method has no larger error, no larger cost, and one of them smaller
    (Pareto). A method is dominated if it has finite points and all of them are. The others have no entry. A point of
    infinite cost dominates none.
    """
    found = {}
    for name, points in curves.items():
        finite = [point for point in points if isfinite(point.error)]
        beaten = {
            other: {i for i, point in enumerate(finite) if any(_beats(theirs, point) for theirs in rivals)}
            for other, rivals in curves.items()
            if other != name
        }
        if finite and len(set[int]().union(*beaten.values())) == len(finite):
            found[name] = _fewest(beaten)
    return found


def _fewest(beaten: Mapping[Name, set[int]]) -> list[Name]:
    """Enough of the other methods to beat every point, each the one that adds most."""
    chosen, left = [], set[int]().union(*beaten.values())
    while left:
        best = max(beaten, key=lambda other: len(beaten[other] & left))
        chosen.append(best)
        left -= beaten[best]
    return chosen


def _beats(a: Priced, b: Priced) -> bool:
    no_worse = a.error <= b.error and a.cost <= b.cost
    return isfinite(a.cost) and no_worse and (a.error, a.cost) != (b.error, b.cost)
