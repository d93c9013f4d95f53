"""Exact elementary weights of a method: each tree's stage values are computed once, from those of two smaller trees."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import mul
from typing import Any, Protocol, Self, TypeAlias

from flint import fmpq, fmpq_poly

from driftproof.methods.numbers.flint_rationals import as_fmpq, as_fraction
from driftproof.methods.numbers.number_field import Algebraic, Exact
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.trees.rooted_trees import TreeTable, tree_table

# An element of the ring of some `Scalars`: it has +, -, * with its like and with fmpq. FLINT has no static types.
RingElement: TypeAlias = Any


class Scalars(Protocol):
    """A ring that contains the rationals, with exact conversions into it and out of it."""

    def lift(self, x: Exact | int) -> RingElement:
        """The number `x` as an element of the ring. Raises TypeError for anything that is not exact."""

    def exact(self, x: RingElement) -> Exact:
        """The element `x` as a Fraction or, where it is irrational, as an Algebraic."""


@dataclass(frozen=True)
class ExactScalars:
    """Q or one number field: rational numbers as FLINT's fmpq, irrational ones as Algebraic."""

    def lift(self, x: Exact | int) -> RingElement:
        """The number as an fmpq or an Algebraic. Raises TypeError for a float."""
        return x if isinstance(x, Algebraic) else as_fmpq(x)

    def exact(self, x: RingElement) -> Exact:
        """The number as a Fraction or, where it is irrational, as an Algebraic."""
        if isinstance(x, Algebraic):
            return x.as_fraction() if x.is_rational else x
        return as_fraction(x if isinstance(x, fmpq) else as_fmpq(x))


EXACT: Scalars = ExactScalars()

# The values of a function at all stages of a method. Each stage algebra has a type of its own for them.
StageValues: TypeAlias = Any

# A method with one order condition for each rooted tree.
TreeMethod: TypeAlias = RungeKutta | Collocation
# A RungeKutta, a Nystrom, or another object with such rows of coefficients, which the `Scalars` at hand can lift.
Table: TypeAlias = Any


class StageAlgebra(Protocol):
    """A Runge-Kutta method as the trees see it: a ring of stage values, the map A on it and the functional b."""

    scalars: Scalars
    bound: int  # no method with this many stages has a higher order
    one: StageValues

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        """The product of u and v, stage by stage."""

    def inner(self, u: StageValues) -> StageValues:
        """A u: the integral of u up to each stage, as the method approximates it."""

    def weigh(self, u: StageValues) -> RingElement:
        """b · u: the integral of u over the step, as the method approximates it."""


class TableauStages:
    """Stage values as lists of s numbers, with A and b from a tableau (butcher-2016, 312)."""

    def __init__(self, a: Sequence[Sequence[Any]], b: Sequence[Any], scalars: Scalars = EXACT) -> None:
        """Lift the nonzero coefficients, so that an explicit method costs half.

        `scalars` decides what they may be. Polynomials in a parameter, say, give conditions that are polynomials.
        """
        self.scalars = scalars
        lift = self.scalars.lift
        self._rows = [[(j, lift(x)) for j, x in enumerate(row) if x] for row in a]
        self._weights = [(i, lift(x)) for i, x in enumerate(b) if x]
        self._zero = lift(0)
        self.one = [lift(1)] * len(b)
        explicit = all(not x for i, row in enumerate(a) for x in row[i:])
        # Explicit: Aˢ = 0, so the tall tree of order s + 1 fails. Implicit: a quadrature formula has order 2s at most.
        self.bound = len(b) if explicit else 2 * len(b)

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        """The products uᵢ vᵢ."""
        return list(map(mul, u, v))

    def inner(self, u: StageValues) -> StageValues:
        """The sums Σⱼ aᵢⱼ uⱼ."""
        return [self._dot(row, u) for row in self._rows]

    def weigh(self, u: StageValues) -> RingElement:
        """The sum Σ bᵢ uᵢ."""
        return self._dot(self._weights, u)

    def _dot(self, row: list[tuple[int, RingElement]], u: StageValues) -> RingElement:
        total = self._zero
        for j, x in row:
            total += x * u[j]
        return total


class NodeStages:
    """Polynomials modulo M(x) = Π (x - cᵢ) in place of their values at the nodes: collocation without radicals.

    A polynomial u of degree below s is determined by its values u(cᵢ), products of values are products modulo M, and
    collocation integrates such polynomials exactly: A u = ∫₀ˣ u modulo M and b · u = ∫₀¹ u
    (hairer-lubich-wanner-2006, II.1.2 Theorem 1.4). Raises ValueError if M has a multiple root.
    """

    scalars: Scalars

    def __init__(self, nodes: Sequence[Exact]) -> None:
        """`nodes` holds the coefficients of M, constant term first, its leading one not zero."""
        self.modulus = distinct_nodes(nodes)
        self.scalars = EXACT
        self.one = fmpq_poly([1]) % self.modulus
        self.bound = 2 * int(self.modulus.degree())

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        """The product modulo M."""
        return u * v % self.modulus

    def inner(self, u: StageValues) -> StageValues:
        """∫₀ˣ u modulo M."""
        return u.integral() % self.modulus

    def weigh(self, u: StageValues) -> RingElement:
        """∫₀¹ u."""
        return u.integral()(fmpq(1))


def distinct_nodes(nodes: Sequence[Exact]) -> fmpq_poly:
    """The node polynomial M as an fmpq_poly. Raises ValueError if it is constant or has a multiple root."""
    polynomial = fmpq_poly([as_fmpq(x) for x in nodes])
    if polynomial.degree() < 1 or polynomial.gcd(polynomial.derivative()).degree() > 0:
        raise ValueError(f"{tuple(map(str, nodes))} is not a node polynomial: it needs at least one node, all distinct")
    return polynomial


def stage_algebra(method: TreeMethod, scalars: Scalars = EXACT) -> StageAlgebra:
    """The stage algebra of a method; exact, whatever `scalars`, if it is given by a node polynomial."""
    if isinstance(method, Collocation):
        return NodeStages(method.node_polynomial)
    return TableauStages(method.a, method.b, scalars)


class ElementaryWeights:
    """The elementary weights Φ(t) = b · Π A(...) of a method, order by order; stage values are computed once per tree.

    Each colour of vertex has a stage algebra; ordinary trees have one colour. Only the first `internal` colours may
    carry branches. All algebras have the same stages, and differ in A and b.
    """

    def __init__(self, *colours: StageAlgebra, internal: int = 1) -> None:
        self.colours = colours
        self.internal = internal
        self._products: list[StageValues] = [colour.one for colour in colours]  # Π A(branch) for each tree
        self._inner: list[StageValues] = []  # A applied to each product

    def of_order(self, vertices: int) -> list[RingElement]:
        """Φ of the trees with `vertices` vertices, in the order of the table."""
        table = self.table(vertices)
        for n in range(vertices + 1):
            self._extend(table, n)
        return [self.colours[table.kind[t]].weigh(self._products[t]) for t in table.ids(vertices)]

    def residuals(self, vertices: int) -> list[tuple[int, RingElement]]:
        """The number of each tree with `vertices` vertices, and its residual Φ - 1/γ."""
        table = self.table(vertices)
        weights = zip(table.ids(vertices), self.of_order(vertices), strict=True)
        return [(t, weight - fmpq(1, table.density[t])) for t, weight in weights]

    def symmetries(self, vertices: int) -> Sequence[int]:
        """σ of each tree with `vertices` vertices, where only automorphisms that keep the colours count."""
        table = self.table(vertices)
        return table.symmetry[table.first[vertices] :]

    def weighed_by(self, algebra: StageAlgebra) -> Self:
        """The weights of ordinary trees with the same A and the b of `algebra`; both share their stage values."""
        other = type(self)(algebra)
        other._products, other._inner = self._products, self._inner
        return other

    def table(self, order: int) -> TreeTable:
        """The table of the trees with these colours."""
        return tree_table(order, len(self.colours), self.internal)

    def _extend(self, table: TreeTable, vertices: int) -> None:
        """Compute the products of the trees with `vertices` vertices from those of all smaller trees."""
        inner, products, colours = self._inner, self._products, self.colours
        for t in range(len(inner), table.first[vertices]):
            inner.append(colours[table.kind[t]].inner(products[t]))
        times = colours[0].times
        for t in range(len(products), table.first[vertices + 1]):
            products.append(times(products[table.rest[t]], inner[table.branch[t]]))
