"""Stages that do nothing or do the same: the irreducible form of Runge-Kutta and Nyström methods."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, TypeAlias

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Nystrom, RungeKutta

Row: TypeAlias = tuple[Exact, ...]


class Stages(NamedTuple):
    """A and c, and the rows of weights: (b,) of a Runge-Kutta method, (b_position, b_velocity) of a Nyström method."""

    a: tuple[Row, ...]
    weights: tuple[Row, ...]
    c: Row

    @property
    def b(self) -> Row:
        """The weights of a Runge-Kutta method; of a Nyström method, those of the velocity."""
        return self.weights[-1]


def stages_of(method: RungeKutta | Nystrom) -> Stages:
    """The coefficients of `method`, b_embedded left out."""
    if isinstance(method, Nystrom):
        return Stages(method.a, (method.b_position, method.b_velocity), method.c)
    return Stages(method.a, (method.b,), method.c)


def reduced(stages: Stages) -> Stages:
    """The same method without stages that do not count, and with stages merged that are equal on every problem.

    The former make it DJ-reducible, the latter S-reducible (hairer-wanner-1996, IV.12). What holds for a method if and
    only if it holds for its coefficients does so for these. Autonomous problems are meant: the c of a Runge-Kutta
    method do not count.
    """
    while True:
        smaller = _merged(_restricted(stages))
        if len(smaller.a) == len(stages.a):
            return stages
        stages = smaller


def matchings(stages: Stages, other: Stages, chosen: tuple[int, ...] = ()) -> Iterator[tuple[int, ...]]:
    """The orders p of the stages such that stage pᵢ of `other` has the coefficients of stage i, found one by one."""
    i = len(chosen)
    if i == len(stages.a):
        yield chosen
        return
    for k in range(len(stages.a)):
        if k not in chosen and _fits(stages, other, (*chosen, k)):
            yield from matchings(stages, other, (*chosen, k))


def total(values: Iterable[Exact]) -> Exact:
    """The sum of at least one value."""
    first, *rest = values
    for value in rest:
        first = first + value
    return first


def _fits(stages: Stages, other: Stages, chosen: tuple[int, ...]) -> bool:
    """The newest of the chosen stages agrees in its weights, and in its entries of A with those chosen before."""
    i, k = len(chosen) - 1, chosen[-1]
    if any(row[i] != matched[k] for row, matched in zip(stages.weights, other.weights, strict=True)):
        return False
    if len(stages.weights) > 1 and stages.c[i] != other.c[k]:
        return False
    a, b = stages.a, other.a
    return all(a[i][j] == b[k][m] and a[j][i] == b[m][k] for j, m in enumerate(chosen))


def _restricted(stages: Stages) -> Stages:
    """The stages from which a chain of nonzero aᵢⱼ leads to a nonzero weight; at least one."""
    counted = {i for row in stages.weights for i, x in enumerate(row) if x != 0}
    while True:
        reached = counted | {j for i in counted for j, x in enumerate(stages.a[i]) if x != 0}
        if reached == counted:
            break
        counted = reached
    kept = sorted(counted) or [0]
    return Stages(
        tuple(tuple(stages.a[i][j] for j in kept) for i in kept),
        tuple(tuple(row[i] for i in kept) for row in stages.weights),
        tuple(stages.c[i] for i in kept),
    )


def _merged(stages: Stages) -> Stages:
    """Stages are equal on every problem in one class of the coarsest partition in which Σ aᵢⱼ over each class depends
    on the class of i only (for Nyström methods, c too).
    """
    labels = _coarsest_partition(stages)
    firsts = [i for i, k in enumerate(labels) if k == i]
    members = [[j for j, k in enumerate(labels) if k == i] for i in firsts]
    return Stages(
        tuple(tuple(total(stages.a[i][j] for j in group) for group in members) for i in firsts),
        tuple(tuple(total(row[j] for j in group) for group in members) for row in stages.weights),
        tuple(stages.c[i] for i in firsts),
    )


def _coarsest_partition(stages: Stages) -> list[int]:
    """For each stage the first stage of its class: classes are split until the sums over them agree."""
    labels = _labels(stages.c if len(stages.weights) > 1 else (0,) * len(stages.a))
    while True:
        classes = [[j for j, k in enumerate(labels) if k == first] for first in sorted({*labels})]
        sums = [tuple(total(row[j] for j in group) for group in classes) for row in stages.a]
        refined = _labels(list(zip(labels, sums, strict=True)))
        if refined == labels:
            return labels
        labels = refined


def _labels(values: Sequence[object]) -> list[int]:
    """The index of the first equal value, for each."""
    return [values.index(value) for value in values]
