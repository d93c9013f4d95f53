"""Orders of methods with uncertain or rounded coefficients: a condition fails only if its residual excludes zero."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Any, Generic, NamedTuple, TypeAlias

from flint import arb, ctx, fmpq

from driftproof.symbolic.algebra.certified import endpoints
from driftproof.symbolic.linear.printed_digits import RoundedOrder, order_within_digits, roundings
from driftproof.symbolic.trees.elementary_weights import RingElement, Scalars, StageValues, TableauStages
from driftproof.symbolic.trees.order_conditions import Conditions, RungeKuttaConditions, TreeType
from driftproof.symbolic.trees.partitioned_trees import (
    OTHER_COLOUR,
    AlternatingConditions,
    NystromStages,
    Q,
    V,
    conditions_with_nodes,
)
from driftproof.symbolic.trees.rooted_trees import AnyTree, Tree, tree_table

# chosen: far more bits than sums of a few products of doubles use.
BALL_BITS = 256


class Ball(NamedTuple):
    """A number known up to an error: at most `radius` away from `center`."""

    center: Fraction
    radius: Fraction


# A `Ball`, or 0 for a coefficient known to be absent; Any, because the order conditions are typed for exact numbers.
Uncertain: TypeAlias = Any
_Row: TypeAlias = tuple[Uncertain, ...]


@dataclass(frozen=True)
class Balls:
    """Arb's balls as the ring of residuals: each ball contains the number that it stands for.

    `rounding` says how far a number that is no `Ball` may be from what it was rounded from.
    """

    rounding: Callable[[Fraction], Fraction] | None = None

    def lift(self, x: Uncertain) -> RingElement:
        """An Arb ball that contains every number that `x` may be."""
        center, radius = x if isinstance(x, Ball) else (x, self.rounding(Fraction(x)) if self.rounding else 0)
        point = arb(fmpq(center.numerator, center.denominator))
        return point + arb(0, 1) * arb(fmpq(radius.numerator, radius.denominator)) if radius else point

    def exact(self, x: RingElement) -> Fraction:
        """Raise TypeError: a ball is not an exact number."""
        raise TypeError(f"{x} is a ball and has no exact value")


@dataclass(frozen=True)
class ProvableFailure(Generic[TreeType]):
    """The first condition that provably fails, that of `failing_tree` with `order` + 1 vertices.

    `residual` is an interval that contains its Φ - 1/γ but not 0. Both are None if none provably fails up to the limit.
    """

    order: int
    failing_tree: TreeType | None
    residual: tuple[Fraction, Fraction] | None


class BallTableau(NamedTuple):
    """A, b and c of a Runge-Kutta method, each coefficient a ball or 0."""

    a: tuple[_Row, ...]
    b: _Row
    c: _Row


class BallNystrom(NamedTuple):
    """The coefficients of a Nyström method as balls or 0; without force a step moves q by drift·hv, ideally by hv."""

    c: _Row
    a: tuple[_Row, ...]
    b_position: _Row
    b_velocity: _Row
    drift: Uncertain


def ball_order(method: BallTableau | BallNystrom, limit: int, *, timed: bool = False) -> ProvableFailure[AnyTree]:
    """The largest p, at most `limit`, such that no condition of at most p vertices provably fails.

    The conditions are those for every y' = f(y) or, if `timed`, for every y' = f(t, y) with the given c; for a Nyström
    method, those for every q'' = F(q).
    """
    with ctx.workprec(BALL_BITS):
        if isinstance(method, BallNystrom):
            return _first_failure(AlternatingConditions(_Drifting(method), linear_drift=True), limit)
        if timed:
            return _first_failure(conditions_with_nodes(method, Balls()), limit)
        return _first_failure(RungeKuttaConditions(TableauStages(method.a, method.b, Balls())), limit)


def linear_ball_order(method: BallTableau | BallNystrom, limit: int) -> int:
    """The same as `ball_order` on linear problems, y' = My or q'' = Mq, where only trees without a fork matter."""
    with ctx.workprec(BALL_BITS):
        if isinstance(method, BallNystrom):
            chains = [_nystrom_chain(_Drifting(method), leaf) for leaf in (V, Q)]
        else:
            chains = [_chain(method)]
        return min(_first_wrong(chain, limit) for chain in chains)


def rounded_order(conditions: Callable[[Scalars], Conditions[Any]], method: Any, limit: int) -> RoundedOrder | None:
    """`order_within_digits` up to `limit` vertices, of the conditions of a method in any scalars; None over a field."""
    if method.field:
        return None
    with ctx.workprec(BALL_BITS):
        exactly, loosely = (conditions(Balls(by)) for by in (None, roundings(method)))

        def largest(n: int) -> list[tuple[arb, arb]]:
            pairs = zip(exactly.residuals(n), loosely.residuals(n), strict=True)
            return [(x.abs_upper(), y.rad()) for (_, x), (_, y) in pairs if not x.contains(0)]

        return order_within_digits(map(largest, range(1, min(limit, exactly.bound) + 2)), method.decimal)


def vanishing_order(method: BallTableau, limit: int) -> ProvableFailure[Tree]:
    """The largest q, at most `limit`, such that Σ bᵢ Φᵢ(t) = 0 provably fails for no tree of at most q vertices.

    Then h Σ bᵢ kᵢ = O(h^(q + 1)); if b is the difference of two rows of weights, this estimates the local error.
    """
    with ctx.workprec(BALL_BITS):
        conditions = RungeKuttaConditions(TableauStages(method.a, method.b, Balls()))
        weights = lambda n: zip(tree_table(n).ids(n), conditions.of_order(n), strict=True)
        return _first_failure(conditions, limit, weights)


def _first_failure(
    conditions: Conditions[TreeType], limit: int, of_order: Callable[[int], Iterable[tuple[Any, arb]]] | None = None
) -> ProvableFailure[TreeType]:
    """The first residual that excludes 0; `of_order`, if given, replaces the residuals of the trees of n vertices."""
    for n in range(1, limit + 1):
        for label, residual in (of_order or conditions.residuals)(n):
            if not residual.contains(0):
                return ProvableFailure(n - 1, conditions.tree(n, label), endpoints(residual))
    return ProvableFailure(limit, None, None)


def _first_wrong(weights: Iterator[RingElement], limit: int) -> int:
    for n, weight in zip(range(1, limit + 1), weights, strict=False):
        if not (weight - fmpq(1, factorial(n))).contains(0):
            return n - 1
    return limit


def _chain(method: BallTableau) -> Iterator[RingElement]:
    """b Aⁿ⁻¹ 1 for n = 1, 2, ..."""
    stages = TableauStages(method.a, method.b, Balls())
    values = stages.one
    while True:
        yield stages.weigh(values)
        values = stages.inner(values)


def _nystrom_chain(stages: NystromStages, colour: str) -> Iterator[RingElement]:
    """Φ of the trees without a fork whose leaf has this colour, the smallest first."""
    values = stages.ones(colour)
    while True:
        values, weight = stages.integrals(colour, values)
        yield weight
        colour = OTHER_COLOUR[colour]


class _Drifting(NystromStages):
    """The stages of a Nyström method that without force moves q by drift·hv instead of hv."""

    def __init__(self, method: BallNystrom) -> None:
        super().__init__(method, Balls())
        self._drift = Balls().lift(method.drift)

    def integrals(self, colour: str, u: StageValues) -> tuple[StageValues, RingElement]:
        """Return the integrals of `NystromStages`, with the drift as the integral of v itself."""
        values, weight = super().integrals(colour, u)
        return values, self._drift if colour == Q and u is None else weight
