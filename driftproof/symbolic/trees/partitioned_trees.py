"""Order conditions on trees of two colours: separable problems, Nyström methods, and problems y' = f(t, y)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from operator import ne
from typing import Any

from flint import fmpq

from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.symbolic.trees.elementary_weights import (
    EXACT,
    ElementaryWeights,
    RingElement,
    Scalars,
    StageAlgebra,
    StageValues,
    Table,
    TableauStages,
    TreeMethod,
)
from driftproof.symbolic.trees.order_conditions import (
    Conditions,
    OrderFact,
    RungeKuttaConditions,
    TreeLabel,
    order_of,
    runge_kutta_conditions,
)
from driftproof.symbolic.trees.rooted_trees import (
    ColouredTree,
    Tree,
    alternately_coloured,
    canonical_tree,
    coloured_shapes,
    shapes,
    tree_table,
)

# A vertex of colour q stands for f in q' = f(v) or a derivative of f, one of colour v for g in v' = g(q).
Q, V = "q", "v"
OTHER_COLOUR = {Q: V, V: Q}
# In trees for y' = f(t, y), a vertex of the second colour is a leaf for the time.
_STATE, _TIME = "y", "t"


class SplittingStages:
    """The stages of a splitting: v-vertices are evaluated at its kicks, q-vertices at its drifts.

    A splitting is a partitioned Runge-Kutta method in which aᵢⱼ is the coefficient of sub-step j if that comes before
    sub-step i, else 0 (hairer-lubich-wanner-2006, II.5), so its integrals are running sums.
    """

    def __init__(self, method: Splitting, scalars: Scalars = EXACT) -> None:
        """Take the sub-steps as they are; those with coefficient zero do no harm."""
        self.scalars = scalars
        self.bound = max(2 * sum(kind == "kick" for kind, _ in method.parts), 1)
        self._parts = [(V if kind == "kick" else Q, self.scalars.lift(c)) for kind, c in method.parts]

    def ones(self, colour: str) -> StageValues:
        """The empty product at the stages of this colour: a one for each of its sub-steps."""
        return [self.scalars.lift(1) for part, _ in self._parts if part == colour]

    def integrals(self, colour: str, u: StageValues) -> tuple[StageValues, RingElement]:
        """The integrals of `u`, given at the stages of `colour`, up to those of the other one and over the step."""
        total, at_others, values = self.scalars.lift(0), [], iter(u)
        for part, c in self._parts:
            if part == colour:
                total += c * next(values)
            else:
                at_others.append(total)
        return at_others, total


class NystromStages:
    """The stages of a Nyström method, at which v-vertices are evaluated; q' = v is integrated exactly.

    A q-vertex has one branch, whose values it passes on, or none. Then it stands for v at the start of the step, which
    is None here (hairer-norsett-wanner-1993, II.14).
    """

    def __init__(self, method: Table, scalars: Scalars = EXACT) -> None:
        """Lift the coefficients by `scalars`."""
        self.scalars = scalars
        self.bound = 2 * len(method.c)
        self._velocity = TableauStages(method.a, method.b_velocity, self.scalars)
        self._position = TableauStages(method.a, method.b_position, self.scalars)
        self._nodes = [self.scalars.lift(x) for x in method.c]

    def ones(self, colour: str) -> StageValues:
        """The empty product: a one for every stage, or None for a q-vertex."""
        return [self.scalars.lift(1)] * len(self._nodes) if colour == V else None

    def integrals(self, colour: str, u: StageValues) -> tuple[StageValues, RingElement]:
        """For a v-vertex u, which a q-vertex integrates twice, b_velocity · u; for a q-vertex A u, b_position · u."""
        if colour == V:
            return u, self._velocity.weigh(u)
        if u is None:
            return self._nodes, self.scalars.lift(1)
        return self._position.inner(u), self._position.weigh(u)


class AlternatingConditions:
    """The order conditions of the trees with alternating colours and a root of either colour.

    With `linear_drift`, which means q' = v instead of q' = f(v), only trees whose q-vertices have at most one branch
    count. The label of a tree is its number and the colour of its root.
    """

    def __init__(self, stages: SplittingStages | NystromStages, *, linear_drift: bool) -> None:
        self.scalars, self.bound = stages.scalars, stages.bound
        self._stages = stages
        self._numbers = _nystrom_numbers if linear_drift else lambda vertices, _: tree_table(vertices).ids(vertices)
        self._products: dict[tuple[int, str], StageValues] = {}
        self._integrals: dict[tuple[int, str], StageValues] = {}
        self._found: list[list[tuple[TreeLabel, RingElement]]] = []

    def residuals(self, vertices: int) -> Sequence[tuple[TreeLabel, RingElement]]:
        """The label of each tree with `vertices` vertices, and its residual Φ - 1/γ; roots of colour v first."""
        for n in range(len(self._found) + 1, vertices + 1):
            self._found.append(list(self._extended(n)))
        return self._found[vertices - 1]

    def tree(self, vertices: int, label: TreeLabel) -> ColouredTree:
        """The coloured tree with this label."""
        number, colour = label
        return alternately_coloured(shapes(vertices)[number], colour, OTHER_COLOUR[colour])

    def symmetries(self, vertices: int) -> Sequence[int]:
        """σ of each tree, which is that of the uncoloured tree, since the root's colour determines all others."""
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
    """The order conditions of a splitting with drifts q ← q + c·h·f(v) for every q' = f(v), v' = g(q).

    They are those of hairer-lubich-wanner-2006, III.2.2, for the trees whose colours alternate.
    """
    return AlternatingConditions(SplittingStages(method, scalars), linear_drift=False)


def nystrom_conditions(method: Splitting | Nystrom, scalars: Scalars = EXACT) -> AlternatingConditions:
    """The order conditions of a splitting or a Nyström method for every q'' = F(q), F a gradient or not.

    Since q' = v is linear, only trees whose q-vertices have at most one branch matter
    (hairer-norsett-wanner-1993, II.14). Roots of colour q give conditions on the position, those of v on the velocity.
    """
    if isinstance(method, Splitting):
        return AlternatingConditions(SplittingStages(method, scalars), linear_drift=True)
    return AlternatingConditions(NystromStages(method, scalars), linear_drift=True)


def general_conditions(method: Method, scalars: Scalars = EXACT) -> Conditions[Any]:
    """The order conditions for the family's problems: y' = f(t, y), separable for splittings, q'' = F(q) for Nyström.

    If the c of a table are the row sums of A, as usual, time is one more component of y' = f(y).
    """
    if isinstance(method, Splitting):
        return separable_conditions(method, scalars)
    if isinstance(method, Nystrom):
        return nystrom_conditions(method, scalars)
    if isinstance(method, RungeKutta) and _has_other_nodes(method):
        return conditions_with_nodes(method, scalars)
    return runge_kutta_conditions(method, scalars)


def _has_other_nodes(method: RungeKutta) -> bool:
    return any(map(ne, method.c, map(sum, method.a)))


def embedded_conditions(method: TreeMethod) -> Conditions[Any] | None:
    """The order conditions of the method with its embedded weights; None for a method without them."""
    if isinstance(method, Collocation) or method.b_embedded is None:
        return None
    if _has_other_nodes(method):
        return conditions_with_nodes(replace(method, b=method.b_embedded))
    return RungeKuttaConditions(TableauStages(method.a, method.b_embedded))


def embedded_order(method: TreeMethod) -> OrderFact[Any] | None:
    """The order of the method with its embedded weights `b_embedded`; None for a method without them."""
    conditions = embedded_conditions(method)
    return None if conditions is None else order_of(conditions)


def nystrom_order(method: Splitting | Nystrom) -> OrderFact[ColouredTree]:
    """The order on every q'' = F(q); for a splitting at least its order on separable problems, and sometimes higher."""
    return order_of(nystrom_conditions(method))


def _nystrom_numbers(vertices: int, colour: str) -> Sequence[int]:
    permitted = _nystrom_columns(vertices)[colour]
    return [t for t in tree_table(vertices).ids(vertices) if permitted[t]]


@cache
def _nystrom_columns(order: int) -> dict[str, list[bool]]:
    """For each colour of the root and every tree of the table: True if no q-vertex has more than one branch."""
    table = tree_table(order)
    permitted = {Q: [True], V: [True]}
    for rest, branch in zip(table.rest[1:], table.branch[1:], strict=True):
        from_q, from_v = permitted[Q][branch], permitted[V][branch]
        permitted[Q].append(rest == 0 and from_v)
        permitted[V].append(permitted[V][rest] and from_q)
    return permitted


class ColouredConditions(ElementaryWeights):
    """The order conditions of trees with two colours of vertices, of which the first `internal` may carry branches."""

    def __init__(self, names: tuple[str, str], *algebras: StageAlgebra, internal: int, scalars: Scalars) -> None:
        """Take the name and the stage algebra of each colour; `scalars` is the ring of all coefficients."""
        super().__init__(*algebras, internal=internal)
        self.scalars, self.bound = scalars, max(algebra.bound for algebra in algebras)
        self._names = names

    def tree(self, vertices: int, label: TreeLabel) -> ColouredTree:
        """The tree with this number."""
        return coloured_shapes(vertices, self._names, self.internal)[label]


def conditions_with_nodes(method: Table, scalars: Scalars = EXACT) -> ColouredConditions:
    """The order conditions for every y' = f(t, y), with f called at the times t + cᵢh of the method's own c.

    They give the order of A and b if c is A's row sums (hairer-norsett-wanner-1993, II.1); with another c, the order
    may be lower. Trees have a second kind of leaf, coloured t, for derivatives with respect to t.
    """
    stages = TableauStages(method.a, method.b, scalars)
    return _TimedConditions((_STATE, _TIME), stages, _Clock(method.c, scalars), internal=1, scalars=scalars)


class _TimedConditions(ColouredConditions):
    def tree(self, vertices: int, label: TreeLabel) -> Any:
        """The tree with this number, without colours if no leaf is a derivative with respect to t."""
        tree = super().tree(vertices, label)
        return tree if _has_time(tree) else _without_colours(tree)


def _has_time(tree: ColouredTree) -> bool:
    return tree[0] == _TIME or any(map(_has_time, tree[1]))


def _without_colours(tree: ColouredTree) -> Tree:
    return canonical_tree(tuple(map(_without_colours, tree[1])))


class _Clock:
    """The stages of t' = 1: at stage i the time is t + cᵢh, and after the step t + h."""

    def __init__(self, c: Sequence[Any], scalars: Scalars) -> None:
        self.scalars = scalars
        self.bound = 2 * len(c)
        self.one: StageValues = None
        self._nodes = [scalars.lift(x) for x in c]

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        raise NotImplementedError("a vertex for the time cannot have branches")

    def inner(self, u: StageValues) -> StageValues:
        del u
        return self._nodes

    def weigh(self, u: StageValues) -> RingElement:
        del u
        return self.scalars.lift(1)
