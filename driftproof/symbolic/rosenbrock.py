"""Exact facts about Rosenbrock methods: the order with J = f'(y) and with any matrix J, and the stability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from flint import fmpq

from driftproof.methods.numbers.number_field import Exact, total
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.symbolic.linear.facts import IDENTITY, FactsOfFamily, LinearFacts, fact_names, fact_of_twin
from driftproof.symbolic.linear.printed_digits import RoundedOrder
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.pairs import EstimateFacts, described_estimate
from driftproof.symbolic.trees.elementary_weights import EXACT, RingElement, Scalars, StageValues, TableauStages
from driftproof.symbolic.trees.order_conditions import (
    OrderFact,
    RungeKuttaConditions,
    TreeLabel,
    order_of,
    order_to_tolerance,
)
from driftproof.symbolic.trees.order_in_balls import rounded_order
from driftproof.symbolic.trees.partitioned_trees import ColouredConditions
from driftproof.symbolic.trees.rooted_trees import ColouredTree, Tree, coloured_shapes

F, J = "f", "J"
# Beyond the order of every method of these families, so that the jump of the residuals after the order is seen.
MOST_VERTICES = 8


class RosenbrockStages:
    """The stages of a Rosenbrock method with J = f'(y): a vertex with one branch has A = α + γ, any other has A = α.

    So the values of a tree are a pair: those with A = α, for when another branch is joined, and the proper ones
    (hairer-wanner-1996, IV.7).
    """

    def __init__(self, method: Rosenbrock, weights: Sequence[Exact], scalars: Scalars = EXACT) -> None:
        """Take the weights b or the embedded ones."""
        self.scalars = scalars
        self.bound = method.stages + 1  # of R(z), whose poles are real, hairer-wanner-1996, IV.4
        self._alpha = TableauStages(method.alpha, weights, scalars)
        self._beta = TableauStages(method.linear_twin().a, weights, scalars)
        self.one: StageValues = (self._alpha.one, self._alpha.one)

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        """The values of u with the branch v joined to its root."""
        if u is self.one:
            return v
        both = self._alpha.times(u[0], v[0])
        return both, both

    def inner(self, u: StageValues) -> StageValues:
        """α u and (α + γ) u."""
        return self._alpha.inner(u[1]), self._beta.inner(u[1])

    def weigh(self, u: StageValues) -> RingElement:
        """b · u."""
        return self._alpha.weigh(u[1])


class WStages:
    """The stages of a W method: a vertex f has A = α; a vertex J, which has exactly one branch, has A = γ.

    Trees that do not occur, with J at a leaf or a fork, have weight 0. A value is the kind of the root and its stages.
    """

    def __init__(self, method: Rosenbrock, weights: Sequence[Exact], colour: str) -> None:
        """Make the stages for vertices of this colour."""
        self.scalars = EXACT
        self.bound = method.stages + 1
        self._alpha, self._gamma = TableauStages(method.alpha, weights), TableauStages(method.gamma, weights)
        self._zeros = [x * 0 for x in self._alpha.one]
        self.one: StageValues = (F, self._alpha.one) if colour == F else (J, self._zeros)

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        """The values of u with the branch v joined to its root."""
        kind, stages = u
        if kind == F:
            return F, self._alpha.times(stages, v[0])
        return "full", v[1] if kind == J else self._zeros

    def inner(self, u: StageValues) -> StageValues:
        """α u and γ u, of which the parent vertex takes one by its own colour."""
        return self._alpha.inner(u[1]), self._gamma.inner(u[1])

    def weigh(self, u: StageValues) -> RingElement:
        """b · u."""
        return self._alpha.weigh(u[1])


class WConditions(ColouredConditions):
    """The conditions of a W method for every J: Φ = 1/γ(t) for trees of f alone, Φ = 0 for trees with J (IV.7)."""

    def __init__(self, method: Rosenbrock) -> None:
        """Use the weights b."""
        colours = (WStages(method, method.b, colour) for colour in (F, J))
        super().__init__((F, J), *colours, internal=2, scalars=EXACT)

    def residuals(self, vertices: int) -> list[tuple[TreeLabel, RingElement]]:
        """The label of each tree with `vertices` vertices, and its residual."""
        table, trees = self.table(vertices), coloured_shapes(vertices, (F, J), 2)
        return [
            (t, weight if _has_j(trees[t]) else weight - fmpq(1, table.density[t]))
            for t, weight in zip(table.ids(vertices), self.of_order(vertices), strict=True)
        ]


def _has_j(tree: ColouredTree) -> bool:
    return tree[0] == J or any(map(_has_j, tree[1]))


class OrdersWithin(NamedTuple):
    """Orders to a tolerance: the largest p such that no condition up to p has a residual above `tolerance` in size."""

    tolerance: Fraction
    order: int
    w_order: int
    embedded_order: int | None


class RosenbrockFacts(FactsOfFamily[Rosenbrock]):
    """The exact facts about a Rosenbrock method, each derived when it is first asked for; R(z) is that with J = f'.

    >>> from driftproof.methods.catalogue import FURTHER_METHODS
    >>> facts = RosenbrockFacts(FURTHER_METHODS["ros3p"])
    >>> facts.order, facts.w_order, facts.a_stable, facts.l_stable
    (3, 1, True, False)
    """

    kind = "rosenbrock"

    @cached_property
    def diagonal(self) -> Exact | None:
        """The common diagonal entry of γ, so that one factorisation serves a step; None if the entries differ."""
        first, *others = (row[i] for i, row in enumerate(self.method.gamma))
        return first if all(x == first for x in others) else None

    @cached_property
    def alpha_sums(self) -> tuple[Exact, ...]:
        """Σⱼ αᵢⱼ: stage i evaluates f at the time t + h Σⱼ αᵢⱼ."""
        return tuple(map(total, self.method.alpha))

    @cached_property
    def gamma_sums(self) -> tuple[Exact, ...]:
        """Σⱼ γᵢⱼ, the factor of h ∂f/∂t in stage i."""
        return tuple(map(total, self.method.gamma))

    @cached_property
    def order(self) -> int:
        """The order on every y' = f(y) with J = f'(y)."""
        return self.order_fails.order

    @cached_property
    def order_fails(self) -> OrderFact[Tree]:
        """Why the order is not higher: the first tree whose condition fails, and its residual."""
        return order_of(self._conditions(self.method.b))

    @cached_property
    def order_but_for_rounding(self) -> RoundedOrder | None:
        """The order that rounded coefficients miss only by their rounding; None if there is no such order."""
        method = self.method
        if method.claimed_order == self.order:
            return None
        return rounded_order(lambda by: self._conditions(method.b, by), method, MOST_VERTICES)

    @cached_property
    def w_order(self) -> int:
        """The order with any matrix J, such as an old or approximate Jacobian: that of a W method."""
        return self.w_order_fails.order

    @cached_property
    def w_order_fails(self) -> OrderFact[ColouredTree]:
        """Why that order is not higher: the first tree that fails, with or without J, and its residual."""
        return order_of(WConditions(self.method))

    @cached_property
    def embedded_order(self) -> int | None:
        """The order of the embedded weights with J = f'(y); None without such weights."""
        return None if self.method.b_embedded is None else order_of(self._conditions(self.method.b_embedded)).order

    @cached_property
    def estimate(self) -> EstimateFacts | None:
        """The error estimate of a pair: its order, and E(z) on y' = λy; where E = 0 it is blind to linear problems."""
        b, other = self.method.b, self.method.b_embedded
        if other is None or other == b:
            return None
        conditions = self._conditions([x - y for x, y in zip(b, other, strict=True)])
        twin = self.method.linear_twin()
        difference = stability_function(twin) - stability_function(replace(twin, b=other))
        return described_estimate(conditions, difference, (None, None))

    @cached_property
    def stiffly_accurate(self) -> bool:
        """True if bᵢ = αₛᵢ + γₛᵢ and Σ αₛᵢ = 1; then y₁ solves f = 0 up to order h where f is very stiff."""
        return self.method.linear_twin().a[-1] == self.method.b and self.alpha_sums[-1] == 1

    stability_function = fact_of_twin("_linear", "stability_function")
    error_constant = fact_of_twin("_linear", "error_constant")
    limit_at_infinity = fact_of_twin("_linear", "limit_at_infinity")
    a_stable = fact_of_twin("_linear", "a_stable")
    a_stability = fact_of_twin("_linear", "a_stability")
    l_stable = fact_of_twin("_linear", "l_stable")
    stability_within_digits = fact_of_twin("_linear", "stability_within_digits")
    sector = fact_of_twin("_linear", "sector")
    real_limit = fact_of_twin("_linear", "real_limit")
    imaginary_limit = fact_of_twin("_linear", "imaginary_limit")

    def orders_within(self, tolerance: Fraction) -> OrdersWithin:
        """The orders to a tolerance, for decimal tables, whose conditions hold up to rounding. Raises ValueError."""
        rows = (self.method.b, self.method.b_embedded)
        orders = [None if x is None else order_to_tolerance(self._conditions(x), tolerance) for x in rows]
        w_order = order_to_tolerance(WConditions(self.method), tolerance)
        return OrdersWithin(tolerance, orders[0] or 0, w_order, orders[1])

    conditions = property(lambda self: self._conditions(self.method.b))

    @cached_property
    def _linear(self) -> LinearFacts:
        return LinearFacts(self.method.linear_twin())

    def _conditions(self, weights: Sequence[Exact], scalars: Scalars = EXACT) -> RungeKuttaConditions:
        return RungeKuttaConditions(RosenbrockStages(self.method, weights, scalars))


# Every fact by name, in the order in which a reader wants them.
ROSENBROCK_FACTS = tuple(dict.fromkeys((*IDENTITY, *fact_names(RosenbrockFacts))))
