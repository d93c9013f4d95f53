"""Orders by trees of two colours: separable problems, Nyström methods, and problems that depend on the time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from flint import fmpq

from driftproof.methods.schemes import Method, Nystrom, Splitting
from driftproof.symbolic.trees.elementary_weights import (
    EXACT,
    ElementaryWeights,
    RingElement,
    Scalars,
    StageAlgebra,
    StageValues,
    Table,
    TableauStages,
)
from driftproof.symbolic.trees.order_conditions import (
    Conditions,
    OrderFact,
    TreeLabel,
    order_of,
    runge_kutta_conditions,
)
from driftproof.symbolic.trees.rooted_trees import (
    ColouredTree,
    alternately_coloured,
    coloured_shapes,
    shapes,
    tree_table,
)

# A vertex of colour q stands for f in q' = f(v) or a derivative of f, one of colour v for g in v' = g(q).
Q, V = "q", "v"
OTHER_COLOUR = {Q: V, V: Q}


class SplittingStages:
    """The stages of a splitting: v-vertices are evaluated at its kicks, q-vertices at its drifts.

    A splitting is a partitioned Runge-Kutta method with a coefficient of one sub-step wherever it comes before
    another (hairer-lubich-wanner-2006, II.5), so its integrals are running sums.
    """

    def __init__(self, method: Splitting, scalars: Scalars = EXACT) -> None:
        """The sub-steps are taken as they come; those with coefficient zero do no harm."""
        self.scalars = scalars
        self.bound = max(2 * sum(kind == "kick" for kind, _ in method.parts), 1)
        self._parts = [(V if kind == "kick" else Q, self.scalars.lift(c)) for kind, c in method.parts]

    def ones(self, colour: str) -> StageValues:
        """The empty product at the stages at which vertices of this colour are evaluated: one for every sub-step."""
        return [self.scalars.lift(1) for part, _ in self._parts if part == colour]

    def integrals(self, colour: str, u: StageValues) -> tuple[StageValues, RingElement]:
        """Of `u`, given at the stages of `colour`, the integrals up to the stages of the other, and over the step: the
        running sum of c u over the sub-steps of the colour, as it stands at each of the others and last.
        """
        total, at_others, values = self.scalars.lift(0), [], iter(u)
        for part, c in self._parts:
            if part == colour:
                total += c * next(values)
            else:
                at_others.append(total)
        return at_others, total


class NystromStages:
    """The stages of a Nyström method, at which v-vertices are evaluated; q' = v is integrated exactly.

    A q-vertex has one branch, whose values it hands on, or none: then it stands for v at the start of the step,
    written None here (hairer-norsett-wanner-1993, II.14).
    """

    def __init__(self, method: Table, scalars: Scalars = EXACT) -> None:
        """The coefficients are whatever `scalars` lift."""
        self.scalars = scalars
        self.bound = 2 * len(method.c)
        self._velocity = TableauStages(method.a, method.b_velocity, self.scalars)
        self._position = TableauStages(method.a, method.b_position, self.scalars)
        self._nodes = [self.scalars.lift(x) for x in method.c]

    def ones(self, colour: str) -> StageValues:
        """One for every stage; None for a q-vertex."""
        return [self.scalars.lift(1)] * len(self._nodes) if colour == V else None

    def integrals(self, colour: str, u: StageValues) -> tuple[StageValues, RingElement]:
        """Of a v-vertex: u, for a q-vertex to integrate twice, and b_velocity · u. Of a q-vertex: the position."""
        if colour == V:
            return u, self._velocity.weigh(u)
        if u is None:
            return self._nodes, self.scalars.lift(1)
        return self._position.inner(u), self._position.weigh(u)


class AlternatingConditions:
    """The conditions of a method for the trees of alternating colours, rooted at v and at q.

    With `linear_drift`, only for those whose q-vertices have at most one branch: q' = v instead of q' = f(v). A tree
    is labelled by its number and the colour of its root.
    """

    def __init__(self, stages: SplittingStages | NystromStages, *, linear_drift: bool) -> None:
        """Nothing is computed until an order is asked for."""
        self.scalars, self.bound = stages.scalars, stages.bound
        self._stages = stages
        self._numbers = _nystrom_numbers if linear_drift else lambda vertices, _: tree_table(vertices).ids(vertices)
        self._products: dict[tuple[int, str], StageValues] = {}
        self._integrals: dict[tuple[int, str], StageValues] = {}
        self._found: list[list[tuple[TreeLabel, RingElement]]] = []

    def residuals(self, vertices: int) -> Sequence[tuple[TreeLabel, RingElement]]:
        """The label of each tree with so many vertices, and its Φ - 1/γ; roots of colour v first."""
        for n in range(len(self._found) + 1, vertices + 1):
            self._found.append(list(self._extended(n)))
        return self._found[vertices - 1]

    def tree(self, vertices: int, label: TreeLabel) -> ColouredTree:
        """The tree with its colours."""
        number, colour = label
        return alternately_coloured(shapes(vertices)[number], colour, OTHER_COLOUR[colour])

    def symmetries(self, vertices: int) -> Sequence[int]:
        """σ, which is that of the uncoloured tree, as the root's colour settles all others."""
        symmetry = tree_table(vertices).symmetry
        return [symmetry[t] for colour in (V, Q) for t in self._numbers(vertices, colour)]

    def _extended(self, vertices: int) -> Iterator[tuple[TreeLabel, RingElement]]:
        table = tree_table(vertices)
        for colour in (V, Q):
            for t in self._numbers(vertices, colour):
                product = self._product(colour, table.rest[t], table.branch[t])
                self._products[t, colour] = product
                self._integrals[t, colour], weight = self._stages.integrals(colour, product)
                yield (t, colour), weight - fmpq(1, table.density[t])

    def _product(self, colour: str, rest: int, branch: int) -> StageValues:
        if branch < 0:
            return self._stages.ones(colour)
        integrals = self._integrals[branch, OTHER_COLOUR[colour]]
        if rest == 0:
            return integrals
        return [x * y for x, y in zip(self._products[rest, colour], integrals, strict=True)]


def separable_conditions(method: Splitting, scalars: Scalars = EXACT) -> AlternatingConditions:
    """The conditions of a splitting on every q' = f(v), v' = g(q), its drifts being q ← q + c·h·f(v).

    They are those of hairer-lubich-wanner-2006, III.2.2, for the trees whose colours alternate.
    """
    return AlternatingConditions(SplittingStages(method, scalars), linear_drift=False)


def nystrom_conditions(method: Splitting | Nystrom, scalars: Scalars = EXACT) -> AlternatingConditions:
    """The conditions of a splitting or a Nyström method on every q'' = F(q), F a gradient or not.

    Since q' = v is linear, only trees whose q-vertices have at most one branch matter
    (hairer-norsett-wanner-1993, II.14). Roots of both colours: for the position and for the velocity.
    """
    if isinstance(method, Splitting):
        return AlternatingConditions(SplittingStages(method, scalars), linear_drift=True)
    return AlternatingConditions(NystromStages(method, scalars), linear_drift=True)


def general_conditions(method: Method, scalars: Scalars = EXACT) -> Conditions[Any]:
    """The conditions on the widest class of problems that the family is for: any y' = f(y) for Runge-Kutta and
    collocation, separable Hamiltonians for splittings, q'' = F(q) for Nyström methods.
    """
    if isinstance(method, Splitting):
        return separable_conditions(method, scalars)
    if isinstance(method, Nystrom):
        return nystrom_conditions(method, scalars)
    return runge_kutta_conditions(method, scalars)


def nystrom_order(method: Splitting | Nystrom) -> OrderFact[ColouredTree]:
    """The order on every q'' = F(q): of a splitting at least its order on separable problems, and sometimes higher."""
    return order_of(nystrom_conditions(method))


def _nystrom_numbers(vertices: int, colour: str) -> Sequence[int]:
    permitted = _nystrom_columns(vertices)[colour]
    return [t for t in tree_table(vertices).ids(vertices) if permitted[t]]


@cache
def _nystrom_columns(order: int) -> dict[str, list[bool]]:
    """For every tree of the table and both colours of its root: has no q-vertex more than one branch?"""
    table = tree_table(order)
    permitted = {Q: [True], V: [True]}
    for rest, branch in zip(table.rest[1:], table.branch[1:], strict=True):
        from_q, from_v = permitted[Q][branch], permitted[V][branch]
        permitted[Q].append(rest == 0 and from_v)
        permitted[V].append(permitted[V][rest] and from_q)
    return permitted


class ColouredConditions(ElementaryWeights):
    """The conditions for the trees with vertices of two colours, of which the first `internal` may carry branches."""

    def __init__(self, names: tuple[str, str], *algebras: StageAlgebra, internal: int, scalars: Scalars) -> None:
        """One stage algebra for each colour; `scalars` holds the coefficients of both."""
        super().__init__(*algebras, internal=internal)
        self.scalars, self.bound = scalars, max(algebra.bound for algebra in algebras)
        self._names = names

    def tree(self, vertices: int, label: TreeLabel) -> ColouredTree:
        """The tree with this number."""
        return coloured_shapes(vertices, self._names, self.internal)[label]


def conditions_with_nodes(method: Table, scalars: Scalars = EXACT) -> ColouredConditions:
    """The conditions on every y' = f(t, y), where f is called at the times t + cᵢh that the method states.

    They are those of A and b if c is A's row sums (hairer-norsett-wanner-1993, II.1); a table that states
    another c may fail earlier. Trees have a second kind of leaf, coloured t, for derivatives in t. The coefficients are
    whatever `scalars` lift.
    """
    stages = TableauStages(method.a, method.b, scalars)
    return ColouredConditions(("y", "t"), stages, _Clock(method.c, scalars), internal=1, scalars=scalars)


class _Clock:
    """The stages of t' = 1: at stage i the time is t + cᵢh, and after the step t + h."""

    def __init__(self, c: Sequence[Any], scalars: Scalars) -> None:
        """Only leaves have this colour, so that there is nothing else to integrate."""
        self.scalars = scalars
        self.bound = 2 * len(c)
        self.one: StageValues = None
        self._nodes = [scalars.lift(x) for x in c]

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        """Never called: a leaf has no branches."""
        raise NotImplementedError("a vertex that stands for the time has no branches")

    def inner(self, u: StageValues) -> StageValues:
        """c, the times of the stages."""
        del u
        return self._nodes

    def weigh(self, u: StageValues) -> RingElement:
        """The length of the step."""
        del u
        return self.scalars.lift(1)
