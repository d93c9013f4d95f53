"""Elementary weights of a method in exact numbers: the stages of each tree are made once, from two smaller trees."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import lcm
from operator import mul
from typing import Any, Protocol, Self, TypeAlias

from flint import fmpq, fmpq_poly, fmpz

from driftproof.methods.number_field import Algebraic, Exact, as_fmpq, as_fraction
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.symbolic.trees.rooted_trees import TreeTable, tree_table

# A number of some `Scalars`: it has +, -, * among its kind and with fmpq. FLINT's numbers have no static types.
RingElement: TypeAlias = Any


class Scalars(Protocol):
    """A ring that holds the rationals, with exact ways in and out."""

    def lift(self, x: Exact | int) -> RingElement:
        """The number `x` as an element of the ring. Raises TypeError for anything that is not exact."""

    def exact(self, x: RingElement) -> Exact:
        """The element `x` as a coefficient is written: a Fraction, or an Algebraic."""


@dataclass(frozen=True)
class ExactScalars:
    """Q and number fields: rationals as FLINT's fmpq, irrational numbers as Algebraic, which mix within one field."""

    def lift(self, x: Exact | int) -> RingElement:
        """The number as it computes. Raises TypeError for a float."""
        return x if isinstance(x, Algebraic) else as_fmpq(x)

    def exact(self, x: RingElement) -> Exact:
        """The number as a Fraction where it is rational."""
        if isinstance(x, Algebraic):
            return x.as_fraction() if x.is_rational else x
        return as_fraction(x if isinstance(x, fmpq) else as_fmpq(x))


@dataclass(frozen=True)
class IntegerScalars(ExactScalars):
    """Integers, FLINT's fmpz, for A and b times `unit`: their sums need no common denominator."""

    unit: int

    def lift(self, x: Exact | int) -> RingElement:
        """The integer as it computes."""
        return fmpz(int(x))  # type: ignore[arg-type]

    def weight(self, x: RingElement, vertices: int) -> RingElement:
        """Φ of so many vertices, homogeneous of that degree in A and b."""
        return fmpq(x, self.unit**vertices)


EXACT: Scalars = ExactScalars()

# The values of something at all stages of a method. Its type is the stage algebra's own.
StageValues: TypeAlias = Any

# A method whose order is that of its trees.
TreeMethod: TypeAlias = RungeKutta | Collocation
# A RungeKutta or a Nystrom, or what else has its rows of coefficients, of which it is known how they are lifted.
Table: TypeAlias = Any


class StageAlgebra(Protocol):
    """What a Runge-Kutta method is to a rooted tree: a ring of stages, the map A on it and the functional b."""

    scalars: Scalars
    bound: int  # no method with so many stages has a higher order
    one: StageValues

    def times(self, u: StageValues, v: StageValues) -> StageValues:
        """The product of u and v, stage by stage."""

    def inner(self, u: StageValues) -> StageValues:
        """A u: the integral of u up to each stage, as the method approximates it."""

    def weigh(self, u: StageValues) -> RingElement:
        """b · u: the integral of u over the step, as the method approximates it."""


class TableauStages:
    """Lists of s numbers, with A and b from a tableau (butcher-2016, 312)."""

    def __init__(self, a: Sequence[Sequence[Any]], b: Sequence[Any], scalars: Scalars = EXACT) -> None:
        """Zero coefficients are dropped here, so that an explicit method costs half.

        The coefficients are whatever `scalars` lift: polynomials in a parameter, say, and then so are the conditions.
        """
        self.scalars = scalars
        lift = self.scalars.lift
        self._rows = [[(j, lift(x)) for j, x in enumerate(row) if x] for row in a]
        self._weights = [(i, lift(x)) for i, x in enumerate(b) if x]
        self._zero = lift(0)
        self.one = [lift(1)] * len(b)
        explicit = all(not x for i, row in enumerate(a) for x in row[i:])
        # If explicit, Aˢ = 0 and the tall tree of order s + 1 fails; else, a quadrature formula has order 2s at most.
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
    """Polynomials modulo M(x) = Π (x - cᵢ), standing for their values at the nodes: collocation without radicals.

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
    """M as a polynomial of FLINT. Raises ValueError unless it has degree 1 or more and no multiple root."""
    polynomial = fmpq_poly([as_fmpq(x) for x in nodes])
    if polynomial.degree() < 1 or polynomial.gcd(polynomial.derivative()).degree() > 0:
        raise ValueError(f"{tuple(map(str, nodes))} is no node polynomial: s >= 1 distinct nodes are needed")
    return polynomial


def stage_algebra(method: TreeMethod) -> StageAlgebra:
    """The stages of a method that is given by its node polynomial, or else by its tableau."""
    if isinstance(method, Collocation):
        return NodeStages(method.node_polynomial)
    (stages,) = tableau_stages(method.a, method.b)
    return stages


def tableau_stages(a: Sequence[Sequence[Exact]], *weights: Sequence[Exact]) -> list[TableauStages]:
    """A with each of the rows of weights; where all are rational in integers, times their least common denominator."""
    numbers = [x for row in (*a, *weights) for x in row]
    if any(isinstance(x, Algebraic) for x in numbers):
        return [TableauStages(a, row) for row in weights]
    unit = lcm(*(x.denominator for x in numbers))  # type: ignore[union-attr]
    rows = [[x.numerator * (unit // x.denominator) for x in row] for row in (*a, *weights)]  # type: ignore[union-attr]
    return [TableauStages(rows[: len(a)], row, IntegerScalars(unit)) for row in rows[len(a) :]]


class ElementaryWeights:
    """Φ(t) = b · Π A(...) of a method for one tree after another, the stages of every smaller tree made only once.

    One stage algebra for each colour of vertex, the first `internal` of which may carry branches; one for ordinary
    trees. All of them have the same stages, and differ in A and b.
    """

    def __init__(self, *colours: StageAlgebra, internal: int = 1) -> None:
        """Nothing is computed until an order is asked for."""
        self.colours = colours
        self.internal = internal
        self._products: list[StageValues] = [colour.one for colour in colours]  # of each tree, over its branches
        self._inner: list[StageValues] = []  # A times that

    def of_order(self, vertices: int) -> list[RingElement]:
        """Φ of the trees with so many vertices, in the order of the table."""
        table, (first, *_) = self.table(vertices), self.colours
        for n in range(vertices + 1):
            self._extend(table, n)
        weights = [self.colours[table.kind[t]].weigh(self._products[t]) for t in table.ids(vertices)]
        scalars = first.scalars
        return [scalars.weight(x, vertices) for x in weights] if isinstance(scalars, IntegerScalars) else weights

    def residuals(self, vertices: int) -> list[tuple[int, RingElement]]:
        """The number of each tree with so many vertices, and its Φ - 1/γ."""
        table = self.table(vertices)
        weights = zip(table.ids(vertices), self.of_order(vertices), strict=True)
        return [(t, weight - fmpq(1, table.density[t])) for t, weight in weights]

    def symmetries(self, vertices: int) -> Sequence[int]:
        """σ of each tree with so many vertices; only automorphisms that keep the colours count."""
        table = self.table(vertices)
        return table.symmetry[table.first[vertices] :]

    def weighed_by(self, algebra: StageAlgebra) -> Self:
        """The same of ordinary trees with another b, and the same A: the stages of each tree are made once for both."""
        other = type(self)(algebra)
        other._products, other._inner = self._products, self._inner
        return other

    def table(self, order: int) -> TreeTable:
        """The table of the trees with these colours."""
        return tree_table(order, len(self.colours), self.internal)

    def _extend(self, table: TreeTable, vertices: int) -> None:
        """Make the products of the trees with so many vertices, once those of all smaller trees are there."""
        inner, products, colours = self._inner, self._products, self.colours
        for t in range(len(inner), table.first[vertices]):
            inner.append(colours[table.kind[t]].inner(products[t]))
        times = colours[0].times
        for t in range(len(products), table.first[vertices + 1]):
            products.append(times(products[table.rest[t]], inner[table.branch[t]]))
