"""The irreducible form of a Runge-Kutta method: stages that agree made one, stages that do not count left out."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from methods.number_field import Exact
from symbolic.trees.weights import Tableau


@dataclass(frozen=True)
class Form:
    """A, b and c, and nothing else."""

    a: tuple[tuple[Exact, ...], ...]
    b: tuple[Exact, ...]
    c: tuple[Exact, ...]


def irreducible(method: Tableau) -> Form:
    """The same method with as few stages as can be: on every problem it takes the same step.

    First, stages whose rows have the same sums over each class of equal stages are one (S-reducibility); then, stages
    on which the step depends in no way are left out (DJ-reducibility) (hairer-wanner-1996, IV.12). c is A's row sums.
    """
    classes = _equal_stages(method.a)
    members = [[i for i, label in enumerate(classes) if label == k] for k in range(max(classes) + 1)]
    a = [[_sum([method.a[group[0]][j] for j in other]) for other in members] for group in members]
    b = [_sum([method.b[i] for i in group]) for group in members]
    kept = _used_stages(a, b)
    rows = tuple(tuple(a[i][j] for j in kept) for i in kept)
    return Form(rows, tuple(b[i] for i in kept), tuple(_sum(row) for row in rows))


def _equal_stages(a: Sequence[Sequence[Exact]]) -> list[int]:
    """The class of each stage in the coarsest partition in which equal stages have equal row sums over each class."""
    classes, number = [0] * len(a), 1
    while True:
        seen: dict[Hashable, int] = {}
        refined = []
        for label, row in zip(classes, a, strict=True):
            sums = tuple(_sum([x for x, other in zip(row, classes, strict=True) if other == k]) for k in range(number))
            refined.append(seen.setdefault((label, sums), len(seen)))
        if len(seen) == number:
            return refined
        classes, number = refined, len(seen)


def _used_stages(a: Sequence[Sequence[Exact]], b: Sequence[Exact]) -> list[int]:
    """The stages with a weight, and those that they depend on; one that does nothing if there is no other."""
    used = {i for i, x in enumerate(b) if x != 0}
    fresh = set(used)
    while fresh:
        fresh = {j for i in fresh for j, x in enumerate(a[i]) if x != 0} - used
        used |= fresh
    return sorted(used) or [0]


def _sum(terms: Sequence[Exact]) -> Exact:
    total: Exact = Fraction(0)
    for x in terms:
        total = total + x
    return total
