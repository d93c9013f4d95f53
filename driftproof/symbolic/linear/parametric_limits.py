"""Stability limits of a family as functions of its parameter: exact, piece by piece, each a branch of a curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

from driftproof.methods.families import Family
from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.bivariate import (
    Bivariate,
    at_parameter,
    difference,
    in_square,
    irreducible_factors,
    merging_values,
    product,
    signed,
    slope,
    text,
    total,
    without_root_zero,
)
from driftproof.symbolic.algebra.polynomials import scalar
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.algebra.real_roots import ZERO, RealRoot, positive_roots, vanishes_at
from driftproof.symbolic.algebra.text import rational_text
from driftproof.symbolic.linear.families import family_stability
from driftproof.symbolic.linear.limits import INFINITY, Limit, data, imaginary_limit, real_limit
from driftproof.symbolic.linear.parameter_sets import Interval, Line, margin_on_axis
from driftproof.symbolic.linear.stability_function import stability_function


@dataclass(frozen=True)
class Branch:
    """The positive real root number `root` (from 1, ascending) of the irreducible curve number `curve` in x."""

    curve: int
    root: int


# A limit that does not depend on the parameter, or the branch of a curve on which it lies.
Value: TypeAlias = Limit | Branch
Limits: TypeAlias = Callable[[RationalFunction], Limit]


@dataclass(frozen=True)
class ParametricLimit:
    """A limit as a function of the parameter: on each of the `pieces`, which are disjoint, one value or one branch.

    `curves` are the irreducible F(x, parameter) = 0 on which the limit x lies wherever it is neither 0 nor oo.
    """

    parameter: str
    curves: list[Bivariate]
    pieces: list[tuple[Value, Interval]]

    def data(self) -> list[dict[str, Any]]:
        """A record for each piece: `where`, `interval`, and either `limit`, or `curve` with `root`, and `formula`.

        `formula` solves the curve for x where it is linear in x or in x**2.
        """
        return [self._record(value, interval) for value, interval in self.pieces]

    def _record(self, value: Value, interval: Interval) -> dict[str, Any]:
        place = {"where": str(interval), "interval": interval.data()}
        if not isinstance(value, Branch):
            return {**place, "limit": data(value), "curve": None, "root": None, "formula": None}
        curve = self.curves[value.curve]
        branch = {"curve": text(curve, "x", self.parameter), "root": value.root, "formula": self._formula(curve)}
        return {**place, "limit": None, **branch}

    def _formula(self, curve: Bivariate) -> str | None:
        powers = [k for k, c in enumerate(curve) if c != 0]
        if powers not in ([0, 1], [0, 2]):
            return None
        solved = rational_text(fraction(-curve[0], curve[-1]), self.parameter)
        return solved if powers == [0, 1] else f"sqrt({solved})"


def parametric_real_limit(family: Family) -> ParametricLimit:
    """The real limit: (Q - P)(Q + P) at -x vanishes there."""
    r = family_stability(family)
    margin = without_root_zero(signed(product(difference(r.den, r.num), total(r.den, r.num))))
    return _pieces(family, margin, margin, real_limit)


def parametric_imaginary_limit(family: Family) -> ParametricLimit:
    """The imaginary limit: |Q(ix)|² - |P(ix)|² vanishes there, a polynomial in x**2."""
    margin = margin_on_axis(family_stability(family))
    return _pieces(family, margin, in_square(margin), imaginary_limit)


def _pieces(family: Family, margin: Bivariate, in_limit: Bivariate, limit_of: Limits) -> ParametricLimit:
    """On an open cell between critical values the number of positive roots and the signs between them are constant.

    So is, there, the number of the root at which the limit lies: one rational value decides it. Critical are the roots
    of the first and last coefficient of the margin and of its first nonzero subresultant with its derivative, and the
    values where a factor of R cancels (basu-pollack-roy-2006, chapter 5).
    """
    r = family_stability(family)
    critical = [merging_values(margin, slope(margin)), merging_values(r.num, r.den)]
    ends = [p for rows in (margin, r.num, r.den) if rows for p in (rows[0], rows[-1])]
    line = Line.cut(family, [*ends, *(p for p in critical if p is not None)])
    curves = irreducible_factors(in_limit)
    values = list(line.values())
    limits = [None if v is None else limit_of(stability_function(family.member(v))) for v in values]
    cells = [_value(curves, v, x) for v, x in zip(values[::2], limits[::2], strict=True)]
    labels: list[Value | None] = []
    for k, cell in enumerate(cells):
        labels.append(cell)
        if k < len(line.points):
            labels.append(_at_point(curves, values[2 * k + 1], limits[2 * k + 1], cells[k : k + 2]))
    return ParametricLimit(family.parameter, curves, [(v, where) for v, where in line.runs(labels) if v is not None])


def _value(curves: list[Bivariate], value: Exact | None, limit: Limit | None) -> Value | None:
    """The branch on which the limit lies at a value that is not critical; the limit itself on a curve free of it."""
    if value is None or not isinstance(limit, RealRoot) or limit == ZERO:
        return limit
    found = (k for k, curve in enumerate(curves) if vanishes_at(at_parameter(curve, scalar(value)), limit))
    curve = next(found)
    if all(c.degree() <= 0 for c in curves[curve]):
        return limit
    return Branch(curve, _roots(curves[curve], value).index(limit) + 1)


def _at_point(curves: list[Bivariate], value: Exact | None, limit: Limit | None, beside: list[Value | None]) -> Any:
    """The value of a cell beside the point, left before right, if the limit at the point continues it."""
    if value is None or limit is None:
        return None
    for cell in beside:
        if cell == limit or (isinstance(cell, Branch) and _continues(curves, value, limit, cell)):
            return cell
    return limit


def _continues(curves: list[Bivariate], value: Exact, limit: Limit, branch: Branch) -> bool:
    roots = _roots(curves[branch.curve], value)
    return limit is not INFINITY and limit in roots[branch.root - 1 : branch.root]


def _roots(curve: Bivariate, value: Exact) -> list[RealRoot]:
    """The positive real roots of the curve at a value of the parameter, ascending."""
    polynomial = at_parameter(curve, scalar(value))
    return [root for root in positive_roots([polynomial]) if vanishes_at(polynomial, root)]
