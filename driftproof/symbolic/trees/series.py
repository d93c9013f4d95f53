"""B-series with exact coefficients: of a method and of the exact flow, composed, inverted and substituted."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

from flint import fmpq

from driftproof.methods.number_field import Exact
from driftproof.symbolic.trees.rooted import Tree, number_of, shapes, vertices
from driftproof.symbolic.trees.scalars import Number, Rationals, Scalars
from driftproof.symbolic.trees.table import TreeTable, tree_table
from driftproof.symbolic.trees.weights import AnyMethod, ElementaryWeights, stage_algebra

# A formal sum of trees: the coefficient of each by the tree's number.
Sum: TypeAlias = dict[int, Number]
Key = TypeVar("Key")


@dataclass(frozen=True)
class BSeries:
    """B(a, y) = a(∅) y + Σ h^r(t)/σ(t) a(t) F(t)(y), for trees of at most `order` vertices, exact.

    The normalisation is that of hairer-lubich-wanner-2006, III.1.1 Definition 1.8: the exact flow has a(t) = 1/γ(t).
    `coefficients` are numbers of `scalars`, in the numbering of the tables; `coefficient` reads one as it is written.
    """

    order: int
    empty: Number
    coefficients: tuple[Number, ...]
    scalars: Scalars

    def coefficient(self, tree: Tree) -> Exact:
        """a(t). Raises KeyError for a tree with more than `order` vertices."""
        if vertices(tree) > self.order:
            raise KeyError(f"a tree of {vertices(tree)} vertices in a B-series of order {self.order}")
        return self.scalars.exact(self.coefficients[number_of(tree)])

    def items(self) -> Iterator[tuple[Tree, Exact]]:
        """The pairs (t, a(t)), smallest trees first."""
        return zip(shapes(self.order), map(self.scalars.exact, self.coefficients), strict=True)

    def truncated(self, order: int) -> BSeries:
        """The same series to a lower order."""
        return BSeries(order, self.empty, self.coefficients[: tree_table(order).first[order + 1]], self.scalars)


def method_series(method: AnyMethod, order: int) -> BSeries:
    """The B-series of one step of a Runge-Kutta method: a(∅) = 1, a(t) = Φ(t) (hairer-lubich-wanner-2006, III.1.1)."""
    weights = ElementaryWeights(stage_algebra(method))
    coefficients = [x for n in range(1, order + 1) for x in weights.of_order(n)]
    return BSeries(order, fmpq(1), tuple(coefficients), weights.colours[0].scalars)


def exact_series(order: int) -> BSeries:
    """The B-series of the exact flow: a(∅) = 1, a(t) = 1/γ(t) (hairer-norsett-wanner-1993, II.2 Theorem 2.6)."""
    return BSeries(order, fmpq(1), tuple(fmpq(1, x) for x in tree_table(order).density), Rationals())


def compose(first: BSeries, second: BSeries) -> BSeries:
    """B(second, B(first, y)): one step of `first`, then one of `second`, to the lower of their orders.

    The coefficient of t is Σ second(s) first(t - s) over the subtrees s at t's root
    (hairer-lubich-wanner-2006, III.1.4 Theorem 1.10). Raises ValueError if first(∅) is not 1.
    """
    order = min(first.order, second.order)
    first = first.truncated(order)
    found = tuple(
        second.empty * a + _dot(subtrees, second.coefficients)
        for a, subtrees in zip(first.coefficients, _root_subtrees(first), strict=True)
    )
    return BSeries(order, first.empty * second.empty, found, _wider(first, second))


def inverse(series: BSeries) -> BSeries:
    """The B-series whose composition with `series` is the identity: one step taken back."""
    found: list[Number] = []
    for t, (a, subtrees) in enumerate(zip(series.coefficients, _root_subtrees(series), strict=True)):
        del subtrees[t]  # what multiplies the unknown itself, which is 1
        found.append(-a - _dot(subtrees, found))
    return BSeries(series.order, series.empty, tuple(found), series.scalars)


def reversed_step(series: BSeries) -> BSeries:
    """B(a, y) with -h for h: the coefficient of t times (-1)^r(t)."""
    size = tree_table(series.order).size
    signed = (-a if n % 2 else a for a, n in zip(series.coefficients, size, strict=True))
    return BSeries(series.order, series.empty, tuple(signed), series.scalars)


def adjoint(series: BSeries) -> BSeries:
    """The B-series of the adjoint method, the inverse of a step with -h (hairer-lubich-wanner-2006, II.3)."""
    return inverse(reversed_step(series))


def symmetric_to_order(series: BSeries) -> int:
    """The largest n, up to the order of the series, with a*(t) = a(t) for all trees of n vertices and fewer."""
    mirrored = adjoint(series).coefficients
    differing = (t for t, (a, b) in enumerate(zip(series.coefficients, mirrored, strict=True)) if a != b)
    first = next(differing, None)
    return series.order if first is None else tree_table(series.order).size[first] - 1


def substitute(field: BSeries, series: BSeries) -> BSeries:
    """The `series` of the vector field B(field, ·)/h in place of f, as a B-series of f, to the lower of the orders.

    The substitution law: t falls into connected blocks in all ways; each block counts with its coefficient in `field`,
    and the tree that is left when blocks shrink to vertices with its own in `series`
    (chartier-hairer-vilmart-2010, section 3). Raises ValueError if field(∅) is not 0.
    """
    if field.empty != 0:
        raise ValueError(f"a vector field has no coefficient of the empty tree, this one has {field.empty}")
    order = min(field.order, series.order)
    found = tuple(_dot(skeletons, series.coefficients) for skeletons in _skeletons(field.truncated(order)))
    return BSeries(order, series.empty, found, _wider(field, series))


def symplectic_to_order(series: BSeries) -> int:
    """The largest n up to the order with a(u∘v) + a(v∘u) = a(u) a(v) wherever u and v have at most n vertices together.

    For all n: every quadratic invariant of every problem is kept (hairer-lubich-wanner-2006, VI.7.2).
    """
    return _holds_to_order(series, lambda a, b: a * b)


def hamiltonian_to_order(field: BSeries) -> int:
    """The largest n up to the order with b(u∘v) + b(v∘u) = 0 wherever u and v have at most n vertices together.

    For all n: the vector field is Hamiltonian whenever f is (hairer-lubich-wanner-2006, IX.9.2).
    """
    return _holds_to_order(field, lambda a, b: 0)


def _root_subtrees(series: BSeries) -> list[Sum]:
    """For each tree t the sum Σ a(t - s) s over the subtrees s that contain its root."""
    if series.empty != 1:
        raise ValueError(f"only a series near the identity is a step: a(∅) is {series.empty}, not 1")
    table, a = tree_table(series.order), series.coefficients
    found: list[Sum] = [{0: fmpq(1)}]
    for rest, branch in zip(table.rest[1:], table.branch[1:], strict=True):
        cut = a[branch]
        total = {s: x * cut for s, x in found[rest].items()}
        for s, x in found[rest].items():
            for u, y in found[branch].items():
                _add(total, table.join(s, u), x * y)
        found.append(total)
    return found


def _skeletons(field: BSeries) -> list[Sum]:
    """For each tree the sum of what is left of it when its blocks shrink, with the product of their coefficients."""
    table, b = tree_table(field.order), field.coefficients
    # While the root's block still grows, both it and the skeleton around it are kept.
    open_: list[dict[tuple[int, int], Number]] = [{(0, 0): fmpq(1)}]
    closed: list[Sum] = [{0: b[0]}]
    for rest, branch in zip(table.rest[1:], table.branch[1:], strict=True):
        growing: dict[tuple[int, int], Number] = {}
        for (block, skeleton), x in open_[rest].items():
            for u, y in closed[branch].items():
                _add(growing, (block, table.join(skeleton, u)), x * y)
            for (more, u), y in open_[branch].items():
                _add(growing, (table.join(block, more), _merge(table, skeleton, u)), x * y)
        total: Sum = {}
        for (block, skeleton), x in growing.items():
            _add(total, skeleton, b[block] * x)
        open_.append(growing)
        closed.append(total)
    return closed


def _merge(table: TreeTable, u: int, v: int) -> int:
    """The tree with the branches of u and those of v at one root."""
    while table.branch[v] >= 0:
        u, v = table.join(u, table.branch[v]), table.rest[v]
    return u


def _add(total: dict[Key, Number], key: Key, x: Number) -> None:
    total[key] = total[key] + x if key in total else x


def _dot(total: Sum, coefficients: tuple[Number, ...] | list[Number]) -> Number:
    return sum((x * coefficients[t] for t, x in total.items()), fmpq(0))


def _holds_to_order(series: BSeries, expected: Callable[[Number, Number], Number]) -> int:
    table, a = tree_table(series.order), series.coefficients
    for n in range(2, series.order + 1):
        for u in range(table.first[n]):
            # Each pair once: v is the larger tree, or as large.
            for v in table.ids(n - table.size[u]) if 2 * table.size[u] <= n else ():
                if a[table.join(u, v)] + a[table.join(v, u)] != expected(a[u], a[v]):
                    return n - 1
    return series.order


def _wider(first: BSeries, second: BSeries) -> Scalars:
    """The ring of both: the field, if one of them has irrational coefficients. Raises TypeError for two fields."""
    if isinstance(first.scalars, Rationals) or first.scalars == second.scalars:
        return second.scalars
    if isinstance(second.scalars, Rationals):
        return first.scalars
    raise TypeError("two B-series over different number fields have no common exact arithmetic here")
