"""Orders of coefficients known up to an error, or rounded: a condition fails only where its residual excludes zero."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Any, Generic, NamedTuple, TypeAlias

from flint import arb, ctx, fmpq

from driftproof.methods.schemes import Nystrom, RungeKutta, Splitting
from driftproof.symbolic.algebra.certified import AWAY, endpoints, scientific
from driftproof.symbolic.trees.elementary_weights import RingElement, StageValues, TableauStages
from driftproof.symbolic.trees.order_conditions import Conditions, RungeKuttaConditions, TreeType
from driftproof.symbolic.trees.partitioned_trees import (
    OTHER_COLOUR,
    AlternatingConditions,
    NystromStages,
    Q,
    V,
    conditions_with_nodes,
    general_conditions,
)
from driftproof.symbolic.trees.rooted_trees import AnyTree, Tree, tree_table

# Rounding errors of the same digits, summed over the products of a tree's weight, stay within three decimal digits of
# each other; coefficients of four digits or more leave as much between them and the next condition.
JUMP = 1000
# Digits of residuals: they are sizes.
RESIDUAL_DIGITS = 3

# Doubles and sums of a few products of them are far from using up so many bits.
BALL_BITS = 256


class Ball(NamedTuple):
    """Some number at most `radius` from `center`."""

    center: Fraction
    radius: Fraction


# A `Ball`, or 0 for a coefficient that is known not to be there. The trees' tables are typed for exact numbers.
Uncertain: TypeAlias = Any
_Row: TypeAlias = tuple[Uncertain, ...]


@dataclass(frozen=True)
class Balls:
    """The numbers of Arb: every one of them encloses what it stands for."""

    def lift(self, x: Uncertain) -> RingElement:
        """A ball around every number that `x` may be."""
        if isinstance(x, Ball):
            return self.lift(x.center) + arb(0, 1) * self.lift(x.radius)
        return arb(fmpq(x.numerator, x.denominator))

    def exact(self, x: RingElement) -> Fraction:
        """Raises TypeError: a ball is no exact number."""
        raise TypeError(f"{x} is a ball, which stands for no exact number")


@dataclass(frozen=True)
class ProvableFailure(Generic[TreeType]):
    """No condition of at most `order` vertices provably fails; the one of `failing_tree`, with one more, does.

    `residual` encloses its Φ - 1/γ, and excludes 0. Both are None if no condition was found to fail up to the limit.
    """

    order: int
    failing_tree: TreeType | None
    residual: tuple[Fraction, Fraction] | None


class RoundedOrder(NamedTuple):
    """An order but for rounding, the largest residual of its conditions, and that of the conditions of one order more.

    Both in three digits, the first rounded up: no condition misses by more.
    """

    order: int
    residual: str
    next_residual: str


class BallTableau(NamedTuple):
    """A, b and c of a Runge-Kutta method, as far as they are known."""

    a: tuple[_Row, ...]
    b: _Row
    c: _Row


class BallNystrom(NamedTuple):
    """c, A and both rows of weights of a Nyström method, as far as they are known, and its drift, which should be 1."""

    c: _Row
    a: tuple[_Row, ...]
    b_position: _Row
    b_velocity: _Row
    drift: Uncertain


def ball_order(method: BallTableau | BallNystrom, limit: int, *, timed: bool = False) -> ProvableFailure[AnyTree]:
    """The largest p, at most `limit`, such that no condition of at most p vertices provably fails.

    On every y' = f(y), or on every y' = f(t, y) with the c given if `timed`; of a Nyström method, on every q'' = F(q).
    """
    with ctx.workprec(BALL_BITS):
        if isinstance(method, BallNystrom):
            return _first_failure(AlternatingConditions(_Drifting(method), linear_drift=True), limit)
        if timed:
            return _first_failure(conditions_with_nodes(method, Balls()), limit)
        return _first_failure(RungeKuttaConditions(TableauStages(method.a, method.b, Balls())), limit)


def linear_ball_order(method: BallTableau | BallNystrom, limit: int) -> int:
    """The same on linear problems, y' = My or q'' = Mq: there, only the trees without a fork matter."""
    with ctx.workprec(BALL_BITS):
        if isinstance(method, BallNystrom):
            chains = [_nystrom_chain(_Drifting(method), leaf) for leaf in (V, Q)]
        else:
            chains = [_chain(method)]
        return min(_first_wrong(chain, limit) for chain in chains)


def order_but_for_rounding(method: RungeKutta | Splitting | Nystrom, limit: int) -> RoundedOrder | None:
    """`rounded_order` on the problems of the family; the coefficients are rational."""
    with ctx.workprec(BALL_BITS):
        return rounded_order(general_conditions(method, Balls()), limit)


def rounded_order(conditions: Conditions[Any], limit: int) -> RoundedOrder | None:
    """The order p of which the conditions fail by rounded coefficients alone: by far less than one of p + 1 vertices.

    Residuals of that kind are sums of rounding errors, much alike for every number of vertices; the first that is more
    than `JUMP` times as large as all before is the method's own. None where there is no such jump up to `limit`
    vertices, and for a method that no rounding keeps from its order. Residuals are balls, or rational.
    """
    with ctx.workprec(BALL_BITS):
        largest, n = arb(0), 0
        while JUMP * largest < 1 and n <= min(limit, conditions.bound):  # weights, and so residuals, are about 1
            n += 1
            balls = (arb(x) for _, x in conditions.residuals(n))
            sizes = [x.abs_upper() for x in balls if not x.contains(0)]
            found = max(sizes, default=arb(0))
            if largest > 0 and JUMP * largest < found:
                most = scientific(endpoints(largest)[1], RESIDUAL_DIGITS, AWAY)
                return RoundedOrder(n - 1, most, scientific(endpoints(found)[1], RESIDUAL_DIGITS))
            largest = max(largest, found)
    return None


def vanishing_order(method: BallTableau, limit: int) -> ProvableFailure[Tree]:
    """The largest q, at most `limit`, such that no Σ bᵢ Φᵢ(t) = 0 of a tree of at most q vertices provably fails.

    Then h Σ bᵢ kᵢ is of order q + 1 in h: of the difference of two rows of weights, an estimate of the local error.
    """
    with ctx.workprec(BALL_BITS):
        conditions = RungeKuttaConditions(TableauStages(method.a, method.b, Balls()))
        weights = lambda n: zip(tree_table(n).ids(n), conditions.of_order(n), strict=True)
        return _first_failure(conditions, limit, weights)


def _first_failure(
    conditions: Conditions[TreeType], limit: int, of_order: Callable[[int], Iterable[tuple[Any, arb]]] | None = None
) -> ProvableFailure[TreeType]:
    """The first that is not 0 of the residuals, or of what else is given for each tree of n vertices."""
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
    """Φ of the trees without a fork, with a leaf of this colour."""
    values = stages.ones(colour)
    while True:
        values, weight = stages.integrals(colour, values)
        yield weight
        colour = OTHER_COLOUR[colour]


class _Drifting(NystromStages):
    """The stages of a Nyström method that without a force moves by drift·hv instead of hv."""

    def __init__(self, method: BallNystrom) -> None:
        super().__init__(method, Balls())
        self._drift = Balls().lift(method.drift)

    def integrals(self, colour: str, u: StageValues) -> tuple[StageValues, RingElement]:
        """As of any Nyström method, but for the integral of v itself."""
        values, weight = super().integrals(colour, u)
        return values, self._drift if colour == Q and u is None else weight
