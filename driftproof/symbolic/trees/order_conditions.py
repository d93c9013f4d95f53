"""The exact order of a method, the first tree that fails, leading error coefficients, and B(p), C(q), D(r)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import count
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

from flint import fmpq, fmpq_poly

from driftproof.methods.numbers.flint_rationals import as_fraction
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation
from driftproof.symbolic.algebra.polynomials import dot
from driftproof.symbolic.trees.elementary_weights import (
    EXACT,
    ElementaryWeights,
    RingElement,
    Scalars,
    StageAlgebra,
    TreeMethod,
    distinct_nodes,
    stage_algebra,
)
from driftproof.symbolic.trees.rooted_trees import AnyTree, Tree, bush, shapes, tree_number, tree_table, vertices

TreeType = TypeVar("TreeType", bound=AnyTree)
TreeTypeOut = TypeVar("TreeTypeOut", bound=AnyTree, covariant=True)
# The label of a tree in a set of conditions: its number, or its number and the colour of its root.
TreeLabel: TypeAlias = Any


class Conditions(Protocol[TreeTypeOut]):
    """The order conditions of a method on a class of problems: Φ(t) = 1/γ(t) for each tree of some kind."""

    @property
    def scalars(self) -> Scalars:
        """The ring of the residuals."""

    @property
    def bound(self) -> int:
        """An order that no method with this many stages exceeds."""

    def residuals(self, vertices: int) -> Sequence[tuple[TreeLabel, RingElement]]:
        """The label of each tree with `vertices` vertices, and its residual Φ - 1/γ."""

    def tree(self, vertices: int, label: TreeLabel) -> TreeTypeOut:
        """The tree with this label among those with `vertices` vertices."""

    def symmetries(self, vertices: int) -> Sequence[int]:
        """σ of each tree with `vertices` vertices, in the order of the residuals."""


@dataclass(frozen=True)
class OrderFact(Generic[TreeType]):
    """The order p of a method: Φ = 1/γ for every tree with at most p vertices; `failing_tree`, with p + 1, fails.

    `failing_tree` is the first such tree in the numbering of the tables, and `residual` ≠ 0 is its Φ - 1/γ.
    """

    order: int
    failing_tree: TreeType
    residual: Exact


@dataclass(frozen=True)
class PrincipalError(Generic[TreeType]):
    """The coefficients τ(t) = (Φ(t) - 1/γ(t))/σ(t) of the leading error term h^vertices Σ τ(t) F(t), all exact.

    `squared_norm` is Σ τ(t)², whose root is the usual measure of a method (hairer-norsett-wanner-1993, II.3); `errors`
    pairs each tree's label in `conditions` with its τ.
    """

    vertices: int
    squared_norm: Exact
    errors: Sequence[tuple[TreeLabel, RingElement]]
    conditions: Conditions[TreeType] = field(compare=False, repr=False)

    @cached_property
    def coefficients(self) -> tuple[tuple[TreeType, Exact], ...]:
        """Each tree with its τ, zeros included."""
        tree, exact = self.conditions.tree, self.conditions.scalars.exact
        return tuple((tree(self.vertices, label), exact(x)) for label, x in self.errors)


class RungeKuttaConditions(ElementaryWeights):
    """The conditions of a Runge-Kutta method, one for each tree (hairer-norsett-wanner-1993, II.2 Theorem 2.13)."""

    def __init__(self, algebra: StageAlgebra) -> None:
        """Use A and b only; `conditions_with_nodes` is for a c that differs from the row sums of A."""
        super().__init__(algebra)
        self.scalars, self.bound = algebra.scalars, algebra.bound

    def tree(self, vertices: int, label: TreeLabel) -> Tree:
        """The tree with this number."""
        return shapes(vertices)[label]


def order(method: TreeMethod) -> OrderFact[Tree]:
    """The largest p with Φ(t) = 1/γ(t), exactly, for every tree of at most p vertices, and the first tree that fails.

    For collocation given by its node polynomial no tree is visited.
    """
    if isinstance(method, Collocation):
        return collocation_order(method.node_polynomial)
    return order_of(runge_kutta_conditions(method))


def collocation_order(nodes: Sequence[Exact]) -> OrderFact[Tree]:
    """The order p = s + k of the collocation method at the s roots of M, which is that of its quadrature formula.

    M is orthogonal on [0, 1] to the first k powers (hairer-lubich-wanner-2006, II.1.2 Theorem 1.5); Gauss has k = s. A
    bush fails: its residual Σ bᵢ cᵢᵖ - 1/(p + 1), for xᵖ, is -∫₀¹ M(x) xᵏ dx, M monic. `nodes` is M's coefficients,
    constant term first. Raises ValueError if M is constant or has a multiple root.
    """
    polynomial = distinct_nodes(nodes)
    power = fmpq_poly([0, 1])
    moments = ((k, (polynomial * power**k).integral()(1)) for k in count())
    k, moment = next(found for found in moments if found[1])  # at k = s, since M is not orthogonal to itself
    p = int(polynomial.degree()) + k
    return OrderFact(p, bush(p + 1), -as_fraction(moment / polynomial.leading_coefficient()))


def runge_kutta_conditions(method: TreeMethod, scalars: Scalars = EXACT) -> RungeKuttaConditions:
    """The order conditions of a method; exact, whatever `scalars`, if it is given by a node polynomial."""
    return RungeKuttaConditions(stage_algebra(method, scalars))


def order_of(conditions: Conditions[TreeType]) -> OrderFact[TreeType]:
    """The largest p such that all conditions of at most p vertices hold exactly, and the first condition that fails."""
    # This ends: bushes are the conditions of a quadrature formula with finitely many nodes, whose order is finite.
    fails = ((n, label, residual) for n in count(1) for label, residual in conditions.residuals(n) if residual)
    n, label, residual = next(fails)
    return OrderFact(n - 1, conditions.tree(n, label), conditions.scalars.exact(residual))


# The most vertices for an order to a tolerance. chosen: order 12 has 4,766 trees, order 13 has 12,486.
TOLERANCE_ORDER = 12


def order_to_tolerance(conditions: Conditions[AnyTree], tolerance: Fraction | int, limit: int = TOLERANCE_ORDER) -> int:
    """The largest p with |Φ(t) - 1/γ(t)| <= `tolerance` for every tree of at most p vertices: this is not the order.

    It is at most `limit` and `conditions.bound`: beyond the highest order that the stages allow, residuals are small
    only because large trees have small weights. Raises ValueError for a negative tolerance.
    """
    if tolerance < 0:
        raise ValueError(f"tolerance {tolerance} is negative; it must be >= 0")
    highest = min(limit, conditions.bound)
    for n in range(1, highest + 1):
        found = (conditions.scalars.exact(x) for _, x in conditions.residuals(n) if x)
        if any(max(x, -x) > tolerance for x in found):
            return n - 1
    return highest


def principal_error(conditions: Conditions[TreeType], order: int) -> PrincipalError[TreeType]:
    """The leading error coefficients, those of the trees with p + 1 vertices; the order p is at least `order`.

    Raises TooManyTrees.
    """
    found = ((n, conditions.residuals(n)) for n in count(order + 1))
    n, left = next((n, left) for n, left in found if any(x for _, x in left))
    errors = [(label, x * fmpq(1, sigma)) for (label, x), sigma in zip(left, conditions.symmetries(n), strict=True)]
    squared = sum((x * x for _, x in errors), fmpq(0))
    return PrincipalError(n, conditions.scalars.exact(squared), errors, conditions)


def elementary_weight(method: TreeMethod, tree: Tree) -> Exact:
    """Φ(t), the method's weight of the tree (butcher-2016, 312); the exact solution's is 1/γ(t)."""
    size, algebra = vertices(tree), stage_algebra(method)
    position = tree_number(tree) - tree_table(size).first[size]
    return algebra.scalars.exact(ElementaryWeights(algebra).of_order(size)[position])


@dataclass(frozen=True)
class Simplifying:
    """The largest p, q, r for which B(p), C(q), D(r) hold; None where the conditions hold for every k.

    B(p): Σ bᵢ cᵢᵏ⁻¹ = 1/k; C(q): Σⱼ aᵢⱼ cⱼᵏ⁻¹ = cᵢᵏ/k; D(r): Σᵢ bᵢ cᵢᵏ⁻¹ aᵢⱼ = bⱼ (1 - cⱼᵏ)/k, for k = 1, ... up
    to p, q or r (hairer-norsett-wanner-1993, II.7; butcher-2016, 321).
    """

    b: int
    c: int | None
    d: int | None

    @property
    def stage_order(self) -> int:
        """The largest q with B(q) and C(q): stages and step both approximate the solution to this order."""
        return self.b if self.c is None else min(self.b, self.c)


def simplifying_assumptions(method: TreeMethod) -> Simplifying:
    """The largest p, q, r for which the simplifying assumptions B, C, D hold, with the method's own c.

    For collocation at s nodes with a quadrature formula of order p, they are p, s and p - s.
    """
    if isinstance(method, Collocation):
        order, stages = collocation_order(method.node_polynomial).order, len(method.node_polynomial) - 1
        return Simplifying(order, stages, order - stages)
    weights, nodes, *rows = ([EXACT.lift(x) for x in row] for row in (method.b, method.c, *method.a))
    columns = list(zip(*rows, strict=True))

    def powers(k: int) -> list[RingElement]:
        return [x**k for x in nodes]

    def of_b(k: int) -> list[RingElement]:
        return [dot(weights, powers(k - 1)) - fmpq(1, k)]

    def of_c(k: int) -> list[RingElement]:
        return [dot(row, powers(k - 1)) - x * fmpq(1, k) for row, x in zip(rows, powers(k), strict=True)]

    def of_d(k: int) -> list[RingElement]:
        weighted = [w * x for w, x in zip(weights, powers(k - 1), strict=True)]
        expected = [w * (1 - x) * fmpq(1, k) for w, x in zip(weights, powers(k), strict=True)]
        return [dot(weighted, column) - x for column, x in zip(columns, expected, strict=True)]

    # Π (x - cⱼ)², of degree 2s, is 0 at all nodes but its integrals are not: 2s + 1 conditions that hold imply all.
    tried = range(1, 2 * len(weights) + 2)
    b, c, d = (next((k - 1 for k in tried if any(condition(k))), None) for condition in (of_b, of_c, of_d))
    assert b is not None  # a quadrature formula with s nodes has order 2s at most
    return Simplifying(b, c, d)
