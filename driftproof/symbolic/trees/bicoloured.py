"""Orders by trees of two colours: partitioned methods, and Runge-Kutta methods whose nodes are what they state."""

from __future__ import annotations

from collections.abc import Sequence

from driftproof.methods.number_field import Exact
from driftproof.symbolic.trees.order import Label, OrderFact, order_of
from driftproof.symbolic.trees.rooted import ColouredTree, coloured_shapes
from driftproof.symbolic.trees.scalars import Number, Scalars, scalars_for
from driftproof.symbolic.trees.weights import ElementaryWeights, StageAlgebra, Stages, Tableau, TableauStages


class ColouredConditions(ElementaryWeights):
    """The conditions for the trees with vertices of two colours, of which the first `internal` may carry branches."""

    def __init__(self, names: tuple[str, str], *algebras: StageAlgebra, internal: int, scalars: Scalars) -> None:
        """One stage algebra for each colour; `scalars` holds the coefficients of both."""
        super().__init__(*algebras, internal=internal)
        self.scalars, self.bound = scalars, max(algebra.bound for algebra in algebras)
        self._names = names

    def tree(self, vertices: int, label: Label) -> ColouredTree:
        """The tree with this number."""
        return coloured_shapes(vertices, self._names, self.internal)[label]

    def symmetry(self, vertices: int, label: Label) -> int:
        """σ of the tree with this number: only automorphisms that keep the colours count."""
        return self.table(vertices).symmetry[label]


def partitioned_conditions(
    a: Sequence[Sequence[Exact]], b: Sequence[Exact], a_hat: Sequence[Sequence[Exact]], b_hat: Sequence[Exact]
) -> ColouredConditions:
    """The conditions of the pair (A, b) for q and (Â, b̂) for v on every q' = f(q, v), v' = g(q, v).

    One for every tree with vertices of two colours (hairer-lubich-wanner-2006, III.2.2).
    """
    scalars = scalars_for([*b, *b_hat, *(x for row in (*a, *a_hat) for x in row)])
    return ColouredConditions(("q", "v"), TableauStages(a, b), TableauStages(a_hat, b_hat), internal=2, scalars=scalars)


def conditions_with_nodes(method: Tableau, scalars: Scalars | None = None) -> ColouredConditions:
    """The conditions on every y' = f(t, y), where f is called at the times t + cᵢh that the method states.

    They are those of A and b if c is A's row sums (hairer-norsett-wanner-1993, II.1); a table that states
    another c may fail earlier. Trees have a second kind of leaf, coloured t, for derivatives in t. With `scalars`, the
    coefficients are whatever these lift.
    """
    scalars = scalars or scalars_for([*method.b, *method.c, *(x for row in method.a for x in row)])
    stages = TableauStages(method.a, method.b, scalars)
    return ColouredConditions(("y", "t"), stages, _Clock(method.c, scalars), internal=1, scalars=scalars)


def partitioned_order(
    a: Sequence[Sequence[Exact]], b: Sequence[Exact], a_hat: Sequence[Sequence[Exact]], b_hat: Sequence[Exact]
) -> OrderFact[ColouredTree]:
    """The order of the pair (A, b) for q and (Â, b̂) for v on every q' = f(q, v), v' = g(q, v)."""
    return order_of(partitioned_conditions(a, b, a_hat, b_hat))


def order_with_nodes(method: Tableau) -> OrderFact[ColouredTree]:
    """The order on every y' = f(t, y) with the c that the method states: `order` if c is A's row sums, at most that."""
    return order_of(conditions_with_nodes(method))


class _Clock:
    """The stages of t' = 1: at stage i the time is t + cᵢh, and after the step t + h."""

    def __init__(self, c: Sequence[Exact], scalars: Scalars) -> None:
        """Only leaves have this colour, so that there is nothing else to integrate."""
        self.scalars = scalars
        self.bound = 2 * len(c)
        self.one: Stages = None
        self._nodes = [scalars.lift(x) for x in c]

    def times(self, u: Stages, v: Stages) -> Stages:
        """Never called: a leaf has no branches."""
        raise NotImplementedError("a vertex that stands for the time has no branches")

    def inner(self, u: Stages) -> Stages:
        """c, the times of the stages."""
        del u
        return self._nodes

    def weigh(self, u: Stages) -> Number:
        """The length of the step."""
        del u
        return self.scalars.lift(1)
