"""The order of a family of Runge-Kutta methods as a function of its parameter, by rooted trees."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count
from typing import Any

from flint import fmpq, fmpq_poly

from driftproof.methods.families import Family
from driftproof.symbolic.algebra.polynomials import ZERO, Polynomial, greatest_common_divisor
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import vanishes_at
from driftproof.symbolic.linear.families import cleared, poles
from driftproof.symbolic.linear.parameter_sets import Interval, Line
from driftproof.symbolic.trees.rooted import Tree, shapes
from driftproof.symbolic.trees.weights import ElementaryWeights, TableauStages


@dataclass(frozen=True)
class FamilyOrder:
    """Order `order` for all values of the parameter that are no poles, and at single values more.

    `failing_tree` is the first with order + 1 vertices whose Φ - 1/γ, the function `residual`, is not zero for all
    values; `sets` are the values of order at least 1, 2, ..., up to the first order that no value has.
    """

    order: int
    failing_tree: Tree
    residual: RationalFunction
    sets: list[list[Interval]]


class _Polynomials:
    """Q[parameter] as the ring of order conditions."""

    def lift(self, x: Any) -> Polynomial:
        """The polynomial itself, or an integer as one."""
        return fmpq_poly([x]) if isinstance(x, int) else x

    def exact(self, x: Polynomial) -> Any:
        """The polynomial itself."""
        return x


def family_residuals(family: Family, vertices: int) -> list[tuple[Tree, RationalFunction]]:
    """Φ(t) - 1/γ(t) as a function of the parameter, for every tree with so many vertices.

    Φ is homogeneous in the entries of A and b, of degree n for n vertices: so with A = A'/d and b = b'/d it is that of
    (A', b'), a polynomial, over dⁿ.
    """
    common = poles(family)
    rows = [cleared(row, common) for row in family.a]
    weights = ElementaryWeights(TableauStages(rows, cleared(family.b, common), _Polynomials()))
    table, scale = weights.table(vertices), common**vertices
    return [
        (tree, fraction(weight - scale * fmpq(1, table.density[label]), scale))
        for tree, label, weight in zip(
            shapes(vertices)[table.first[vertices] :], table.ids(vertices), weights.of_order(vertices), strict=True
        )
    ]


def family_order(family: Family) -> FamilyOrder:
    """The order for all values of the parameter, why it is no higher, and the values where it is."""
    failing: tuple[int, Tree, RationalFunction] | None = None
    shared: Polynomial = ZERO  # vanishes exactly where all conditions so far hold
    sets: list[list[Interval]] = []
    for n in count(1):
        for tree, residual in family_residuals(family, n):
            if residual.num != 0:
                failing = failing or (n - 1, tree, residual)
                shared = greatest_common_divisor(shared, residual.num)
        sets.append(_roots(family, shared))
        if failing and not sets[-1]:
            return FamilyOrder(*failing, sets)
    raise AssertionError("unreachable: count has no end")


def _roots(family: Family, p: Polynomial) -> list[Interval]:
    """The values of the parameter at which p vanishes and no entry has a pole."""
    line = Line.cut(family, [p])
    open_cells = [p == 0] * (len(line.points) + 1)
    at_points = [vanishes_at(p, point) and not vanishes_at(line.poles, point) for point in line.points]
    labels = [label for pair in zip(open_cells, [*at_points, False], strict=True) for label in pair][:-1]
    return [interval for holds, interval in line.runs(labels) if holds]
