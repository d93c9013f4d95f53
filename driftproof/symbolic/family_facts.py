"""Exact facts about a family of Runge-Kutta methods as functions of its parameter: order, limits, stability."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias, TypeVar

from flint import fmpq, fmpq_poly

from driftproof.methods.families import Family
from driftproof.methods.numbers.number_field import Exact, UndecidedError
from driftproof.symbolic.algebra.bivariate import (
    Bivariate,
    at_parameter,
    bivariate_text,
    degree_in_t,
    in_square_of_x,
    irreducible_factors,
    reflected_in_x,
    rows_in_x,
    without_root_zero,
)
from driftproof.symbolic.algebra.polynomials import ZERO, Polynomial, greatest_common_divisor, scalar
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction, rational_function_text
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT as ORIGIN
from driftproof.symbolic.algebra.real_roots import RealRoot, positive_roots, vanishes_at
from driftproof.symbolic.linear.a_stability import a_stability, i_stability, l_stability
from driftproof.symbolic.linear.fact_values import ExactFunction, Formula
from driftproof.symbolic.linear.facts import fact_names
from driftproof.symbolic.linear.families import (
    FamilyStability,
    Interval,
    Line,
    ParameterSet,
    cleared,
    critical_values,
    family_error_constant,
    family_stability,
    parameter_set,
    poles,
)
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import Limit, imaginary_limit, real_limit
from driftproof.symbolic.trees.elementary_weights import ElementaryWeights, TableauStages
from driftproof.symbolic.trees.rooted_trees import Tree, shapes

_T = TypeVar("_T")


class FailingTree(NamedTuple):
    """The first tree whose condition does not hold for all values of the parameter, and its residual Φ - 1/γ."""

    tree: Tree
    residual: Formula


class FamilyFunction(NamedTuple):
    """A rational function of z, its coefficients being functions of the parameter, constant term first."""

    num: list[Formula]
    den: list[Formula]


class FamilyTerm(NamedTuple):
    """coefficient * z**power, the coefficient a function of the parameter."""

    power: int
    coefficient: Formula


class OrderSet(NamedTuple):
    """The values of the parameter at which the order is at least `order`."""

    order: int
    values: ParameterSet


class Branch(NamedTuple):
    """The positive real root number `root` (from 1, ascending) of the irreducible curve number `curve` in x."""

    curve: int
    root: int


class LimitPiece(NamedTuple):
    """A limit x on an interval of the parameter: a number, or a root of an irreducible curve F(x, parameter) = 0.

    `root` counts the positive roots of the curve, from 1, ascending; `formula` solves it where it is linear in x or in
    x**2. Both are in SymPy's syntax.
    """

    where: Interval
    limit: Limit | None = None
    curve: str | None = None
    root: int | None = None
    formula: str | None = None


class FamilyFacts:
    """The exact facts about a family: those of almost all members, and at which values of the parameter a fact holds.

    Each is derived when it is first asked for. A set or a limit is an UndecidedError if a critical value of the
    parameter lies in too large a number field. FAMILY_FACTS lists all names.
    """

    def __init__(self, method: Family) -> None:
        self.method = method

    @cached_property
    def family(self) -> str:
        """The family of methods that the members belong to."""
        return "runge_kutta"

    @cached_property
    def defined(self) -> ParameterSet:
        """The values of the parameter at which no coefficient has a pole."""
        return Line.cut(self.method, []).where(lambda value: True)

    @cached_property
    def order(self) -> int:
        """The order that holds for all values of the parameter other than poles."""
        return self._order[0]

    @cached_property
    def order_fails(self) -> FailingTree:
        """Why that order is not higher: the first tree that fails for some value, and its residual."""
        return self._order[1]

    @cached_property
    def order_sets(self) -> list[OrderSet]:
        """The values with order at least 1, 2, ..., up to the first order that no value has."""
        return self._order[2]

    @cached_property
    def stability_function(self) -> FamilyFunction:
        """R(z), with coefficients that are functions of the parameter."""
        num, den = family_stability(self.method).coefficients()
        return FamilyFunction(*([self._formula(c) for c in row] for row in (num, den)))

    @cached_property
    def error_constant(self) -> FamilyTerm:
        """The leading term of R(z) - exp z, its coefficient a function of the parameter."""
        power, constant = family_error_constant(self.method)
        return FamilyTerm(power, self._formula(constant))

    @cached_property
    def real_limit(self) -> list[LimitPiece] | UndecidedError:
        """The largest x with |R| <= 1 on [-x, 0], piecewise in the parameter."""
        return self._decided(parametric_real_limit)

    @cached_property
    def imaginary_limit(self) -> list[LimitPiece] | UndecidedError:
        """The largest y with |R| <= 1 on [0, iy], piecewise in the parameter."""
        return self._decided(parametric_imaginary_limit)

    @cached_property
    def a_stable(self) -> ParameterSet | UndecidedError:
        """The values at which the method is A-stable."""
        return self._decided(lambda family: parameter_set(family, a_stability))

    @cached_property
    def i_stable(self) -> ParameterSet | UndecidedError:
        """The values at which the method is stable on the imaginary axis."""
        return self._decided(lambda family: parameter_set(family, i_stability))

    @cached_property
    def l_stable(self) -> ParameterSet | UndecidedError:
        """The values at which the method is L-stable."""
        return self._decided(lambda family: parameter_set(family, l_stability))

    @cached_property
    def _order(self) -> tuple[int, FailingTree, list[OrderSet]]:
        return family_order(self.method)

    def _formula(self, f: RationalFunction) -> Formula:
        return ExactFunction(f, self.method.parameter).as_formula()

    def _decided(self, fact: Callable[[Family], _T]) -> _T | UndecidedError:
        try:
            return fact(self.method)
        except UndecidedError as reason:
            return UndecidedError(f"at a critical value of {self.method.parameter}: {reason}")


# Every fact by name, in the order in which a reader wants them.
_IDENTITY = ("method", "title", "family", "parameter", "source", "stages", "explicit", "defined", "claimed_order")
FAMILY_FACTS = tuple(dict.fromkeys((*_IDENTITY, *fact_names(FamilyFacts))))


class _Polynomials:
    """Q[parameter] as the ring of order conditions."""

    def lift(self, x: Any) -> Polynomial:
        return fmpq_poly([x]) if isinstance(x, int) else x

    def exact(self, x: Polynomial) -> Any:
        return x


def family_residuals(family: Family, vertices: int) -> list[tuple[Tree, RationalFunction]]:
    """Φ(t) - 1/γ(t) as a function of the parameter, for every tree with `vertices` vertices.

    Φ is homogeneous in the entries of A and b, of degree n for n vertices: so with A = A'/d and b = b'/d it is the Φ of
    (A', b'), a polynomial, divided by dⁿ.
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


def family_order(family: Family) -> tuple[int, FailingTree, list[OrderSet]]:
    """The order for all values of the parameter, why it is not higher, and the values at which it is."""
    failing: tuple[int, FailingTree] | None = None
    shared: Polynomial = ZERO  # vanishes exactly where all conditions so far hold
    sets: list[OrderSet] = []
    while True:
        n = len(sets) + 1
        for tree, residual in family_residuals(family, n):
            if residual.num:
                failing = failing or (n - 1, FailingTree(tree, ExactFunction(residual, family.parameter).as_formula()))
                shared = greatest_common_divisor(shared, residual.num)
        sets.append(OrderSet(n, _vanishing(family, shared)))
        if failing and not sets[-1].values.intervals:
            return (*failing, sets)


def _vanishing(family: Family, p: Polynomial) -> ParameterSet:
    """The values of the parameter at which p vanishes and no entry has a pole."""
    line = Line.cut(family, [p])
    at_points = (vanishes_at(p, point) and not vanishes_at(line.poles, point) for point in line.points)
    return line.marked([not p, *(label for at_point in at_points for label in (at_point, not p))])


# A limit that does not depend on the parameter, or the branch of a curve on which it lies.
_Value: TypeAlias = Limit | Branch


def parametric_real_limit(family: Family) -> list[LimitPiece]:
    """The real limit, piecewise in the parameter: a zero of (Q - P)(Q + P) at -x."""
    r = family_stability(family)
    margin = without_root_zero(reflected_in_x(r.den * r.den - r.num * r.num))
    return _pieces(family, r, margin, margin, real_limit)


def parametric_imaginary_limit(family: Family) -> list[LimitPiece]:
    """The imaginary limit, piecewise in the parameter: a zero of |Q(ix)|² - |P(ix)|², a polynomial in x**2."""
    r = family_stability(family)
    margin = r.margin_on_axis()
    return _pieces(family, r, margin, in_square_of_x(margin), imaginary_limit)


def _pieces(
    family: Family,
    r: FamilyStability,
    margin: Bivariate,
    in_limit: Bivariate,
    limit_of: Callable[[RationalFunction], Limit],
) -> list[LimitPiece]:
    """The limit on the open cells between critical values and at these values, neighbours with the same branch merged.

    On a cell the number of positive roots and the signs between them are constant, and so is the number of the root at
    which the limit lies: one rational value decides it. Critical are the roots of the first and last coefficient of the
    margin and of its first nonzero subresultant with its derivative, and the values where a factor of R cancels
    (basu-pollack-roy-2006, chapter 5).
    """
    line = Line.cut(family, critical_values(r, margin))
    curves = irreducible_factors(in_limit)
    values = list(line.values())
    limits = [None if v is None else limit_of(stability_function(family.member(v))) for v in values]
    cells = [_value(curves, v, x) for v, x in zip(values[::2], limits[::2], strict=True)]
    labels: list[_Value | None] = []
    for beside, v, x in zip(pairwise(cells), values[1::2], limits[1::2], strict=True):
        labels += [beside[0], _at_point(curves, v, x, beside)]
    labels.append(cells[-1])
    return [_piece(curves, family.parameter, x, where) for x, where in line.runs(labels) if x is not None]


def _piece(curves: list[Bivariate], parameter: str, value: _Value, where: Interval) -> LimitPiece:
    if not isinstance(value, Branch):
        return LimitPiece(where, value)
    curve, formula = curves[value.curve], None
    rows = rows_in_x(curve)
    powers = [k for k, c in enumerate(rows) if c]
    if powers in ([0, 1], [0, 2]):
        solved = rational_function_text(fraction(-rows[0], rows[-1]), parameter)
        formula = solved if powers == [0, 1] else f"sqrt({solved})"
    return LimitPiece(where, None, bivariate_text(curve, "x", parameter), value.root, formula)


def _value(curves: list[Bivariate], value: Exact | None, limit: Limit | None) -> _Value | None:
    """The branch on which the limit lies at a value in a cell; the limit itself if it does not depend on the value."""
    if value is None or not isinstance(limit, RealRoot) or limit == ORIGIN:
        return limit
    found = (k for k, curve in enumerate(curves) if vanishes_at(at_parameter(curve, scalar(value)), limit))
    curve = next(found)
    if not degree_in_t(curves[curve]):
        return limit
    return Branch(curve, _roots(curves[curve], value).index(limit) + 1)


def _at_point(
    curves: list[Bivariate], value: Exact | None, limit: Limit | None, beside: Sequence[_Value | None]
) -> _Value | None:
    """The value on the left cell, else the right one, that the limit at the point continues; else the limit itself."""
    if value is None:
        return None
    for cell in beside:
        if cell == limit:
            return cell
        if isinstance(cell, Branch):
            roots = _roots(curves[cell.curve], value)
            if roots[cell.root - 1 : cell.root] == [limit]:
                return cell
    return limit


def _roots(curve: Bivariate, value: Exact) -> list[RealRoot]:
    """The positive real roots of the curve at a value of the parameter, ascending."""
    polynomial_ = at_parameter(curve, scalar(value))
    return [root for root in positive_roots([polynomial_]) if vanishes_at(polynomial_, root)]
