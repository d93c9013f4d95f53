"""The order of a method: decided exactly, with the first tree that fails and its residual; apart, to a tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

from flint import fmpq

from driftproof.methods.number_field import Exact
from driftproof.symbolic.trees.collocation import collocation_order
from driftproof.symbolic.trees.rooted import AnyTree, Tree, bush, number_of, shapes, vertices
from driftproof.symbolic.trees.scalars import Number, Scalars
from driftproof.symbolic.trees.table import tree_table
from driftproof.symbolic.trees.weights import (
    AnyMethod,
    ElementaryWeights,
    NodePolynomial,
    StageAlgebra,
    TableauStages,
    stage_algebra,
)

TreeType = TypeVar("TreeType", bound=AnyTree)
TreeTypeOut = TypeVar("TreeTypeOut", bound=AnyTree, covariant=True)
# What a family of conditions calls a tree: a number, or a number and a colour.
Label: TypeAlias = Any


class Conditions(Protocol[TreeTypeOut]):
    """The order conditions of a method on a class of problems: for each tree of a kind, Φ(t) = 1/γ(t)."""

    @property
    def scalars(self) -> Scalars:
        """The ring of the residuals."""

    @property
    def bound(self) -> int:
        """An order that no method with so many stages exceeds."""

    def residuals(self, vertices: int) -> Sequence[tuple[Label, Number]]:
        """The label of each tree with so many vertices, and its Φ - 1/γ."""

    def tree(self, vertices: int, label: Label) -> TreeTypeOut:
        """The tree with this label, among those with so many vertices."""

    def symmetry(self, vertices: int, label: Label) -> int:
        """Its σ."""


@dataclass(frozen=True)
class OrderFact(Generic[TreeType]):
    """Order p and not p + 1: every tree with at most `order` vertices has Φ = 1/γ, `failing_tree` has p + 1 and fails.

    `failing_tree` is the first such tree in the numbering of the tables, `residual` is its Φ - 1/γ, not zero.
    """

    order: int
    failing_tree: TreeType
    residual: Exact


@dataclass(frozen=True)
class PrincipalError(Generic[TreeType]):
    """The coefficients τ(t) = (Φ(t) - 1/γ(t))/σ(t) of the leading error term h^vertices Σ τ(t) F(t), all exact.

    `squared_norm` is Σ τ(t)², whose root is the usual measure of a method (hairer-norsett-wanner-1993, II.3).
    """

    vertices: int
    coefficients: tuple[tuple[TreeType, Exact], ...]
    squared_norm: Exact


class RungeKuttaConditions(ElementaryWeights):
    """The conditions of a Runge-Kutta method on every y' = f(y): one for each rooted tree.

    Explicit or implicit (hairer-norsett-wanner-1993, II.2 Theorem 2.13).
    """

    def __init__(self, algebra: StageAlgebra) -> None:
        """From A and b only; a c that disagrees with A's row sums is the subject of `symbolic.trees.bicoloured`."""
        super().__init__(algebra)
        self.scalars, self.bound = algebra.scalars, algebra.bound

    def tree(self, vertices: int, label: Label) -> Tree:
        """The tree with this number."""
        return shapes(vertices)[label]

    def symmetry(self, vertices: int, label: Label) -> int:
        """σ of the tree with this number."""
        return tree_table(vertices).symmetry[label]


def order(method: AnyMethod) -> OrderFact[Tree]:
    """The largest p with Φ(t) = 1/γ(t) for every tree of at most p vertices, by exact equality, and why not p + 1.

    Of collocation given by its nodes' polynomial, the trees need not be visited: its order is that of its quadrature
    formula, whose first failing condition is that of a bush (hairer-lubich-wanner-2006, II.1.2 Theorem 1.5).
    """
    if isinstance(method, NodePolynomial):
        quadrature = collocation_order(method.node_polynomial)
        return OrderFact(quadrature.order, bush(quadrature.order + 1), -quadrature.residual)
    return order_of(runge_kutta_conditions(method))


def embedded_order(method: AnyMethod) -> OrderFact[Tree] | None:
    """The order of the method's second row of weights, `b_embedded`; None for a method that has none."""
    conditions = embedded_conditions(method)
    return None if conditions is None else order_of(conditions)


def runge_kutta_conditions(method: AnyMethod) -> RungeKuttaConditions:
    """The conditions of a method that is given by its tableau, or by its nodes' polynomial."""
    return RungeKuttaConditions(stage_algebra(method))


def embedded_conditions(method: AnyMethod) -> RungeKuttaConditions | None:
    """The conditions of the method with its second row of weights; None for a method that has none."""
    second = getattr(method, "b_embedded", None)
    return None if second is None else RungeKuttaConditions(TableauStages(getattr(method, "a", ()), second))


def order_of(conditions: Conditions[TreeType]) -> OrderFact[TreeType]:
    """The largest p such that all conditions of at most p vertices hold exactly, and the first that then fails."""
    # Ends: bushes are conditions on a quadrature formula with finitely many nodes, whose order is finite.
    for n in count(1):
        for label, residual in conditions.residuals(n):
            if residual:
                return OrderFact(n - 1, conditions.tree(n, label), conditions.scalars.exact(residual))
    raise AssertionError("unreachable: count has no end")


def order_to_tolerance(conditions: Conditions[AnyTree], tolerance: Fraction | int, limit: int = 12) -> int:
    """The largest p with |Φ(t) - 1/γ(t)| <= `tolerance` for every tree of at most p vertices: this is not the order.

    At most `limit`, and at most `conditions.bound`: beyond the order that so many stages can have at all, residuals are
    small only because large trees weigh little. Raises TypeError for a float, ValueError below zero.
    """
    if isinstance(tolerance, bool) or not isinstance(tolerance, Fraction | int):
        raise TypeError(f"tolerance {tolerance!r} is {type(tolerance).__name__}; write a Fraction")
    if tolerance < 0:
        raise ValueError(f"tolerance {tolerance} is below zero")
    highest = min(limit, conditions.bound)
    for n in range(1, highest + 1):
        found = (conditions.scalars.exact(x) for _, x in conditions.residuals(n) if x)
        if any(x > tolerance or -x > tolerance for x in found):
            return n - 1
    return highest


def residuals(conditions: Conditions[TreeType], vertices: int) -> tuple[tuple[TreeType, Exact], ...]:
    """Φ(t) - 1/γ(t) for every tree with so many vertices, zeros included."""
    exact = conditions.scalars.exact
    return tuple((conditions.tree(vertices, label), exact(x)) for label, x in conditions.residuals(vertices))


def principal_error(conditions: Conditions[TreeType]) -> PrincipalError[TreeType]:
    """The leading error coefficients: those of the trees with p + 1 vertices, p the order."""
    n = next(n for n in count(1) if any(x for _, x in conditions.residuals(n)))
    errors = [(label, x * fmpq(1, conditions.symmetry(n, label))) for label, x in conditions.residuals(n)]
    exact, squared = conditions.scalars.exact, sum((x * x for _, x in errors), fmpq(0))
    return PrincipalError(n, tuple((conditions.tree(n, label), exact(x)) for label, x in errors), exact(squared))


def elementary_weight(method: AnyMethod, tree: Tree) -> Exact:
    """Φ(t), the method's weight of the tree (butcher-2016, 312); the exact solution's is 1/γ(t)."""
    size, algebra = vertices(tree), stage_algebra(method)
    position = number_of(tree) - tree_table(size).first[size]
    return algebra.scalars.exact(ElementaryWeights(algebra).of_order(size)[position])


def failing_condition(method: AnyMethod, vertices: int) -> tuple[Tree, Exact] | None:
    """The first tree with so many vertices whose Φ(t) - 1/γ(t) is not zero, with that residual; None if all hold."""
    return next(((tree, x) for tree, x in residuals(runge_kutta_conditions(method), vertices) if x), None)
