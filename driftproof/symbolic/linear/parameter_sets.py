"""For which values of its parameter a family of methods has a property: exact unions of intervals."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, TypeVar

from flint import fmpq

from driftproof.methods.families import Family
from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.algebraic_numbers import number_of
from driftproof.symbolic.algebra.bivariate import (
    Bivariate,
    difference,
    merging_values,
    signed,
    size_on_axis,
    slope,
    without_root_zero,
)
from driftproof.symbolic.algebra.polynomials import Polynomial, exact, reflected
from driftproof.symbolic.algebra.radicals import decimal, radical_form
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.real_roots import ZERO as ORIGIN
from driftproof.symbolic.algebra.real_roots import RealRoot, positive_roots, samples, vanishes_at
from driftproof.symbolic.linear.families import FamilyStability, family_stability, poles
from driftproof.symbolic.linear.limits import data
from driftproof.symbolic.linear.stability_function import stability_function

# Of an end without a radical form, in text; the data has them all.
DIGITS_SHOWN = 12
Label = TypeVar("Label", bound=Hashable)


@dataclass(frozen=True)
class Interval:
    """The numbers between `low` and `high` (None: no bound), with the ends that are closed."""

    low: RealRoot | None
    high: RealRoot | None
    low_closed: bool
    high_closed: bool

    def __str__(self) -> str:
        """E.g. "[1/4, oo)", "{1 - sqrt(2)/2}"."""
        if self.low is not None and self.low == self.high:
            return f"{{{_text(self.low)}}}"
        left, right = "[" if self.low_closed else "(", "]" if self.high_closed else ")"
        low, high = ("-oo" if self.low is None else _text(self.low), "oo" if self.high is None else _text(self.high))
        return f"{left}{low}, {high}{right}"

    def data(self) -> dict[str, Any]:
        """{"low", "high", "low_closed", "high_closed"}: ends as `limits.data` writes numbers, or "-oo", "oo"."""
        low, high = "-oo" if self.low is None else data(self.low), "oo" if self.high is None else data(self.high)
        return {"low": low, "high": high, "low_closed": self.low_closed, "high_closed": self.high_closed}


@dataclass(frozen=True)
class Line:
    """The line cut at the real roots of polynomials in the parameter: open cell 0, point 0, open cell 1, and so on.

    Points where the family has a pole are kept as points, and left out as values.
    """

    points: list[RealRoot]
    poles: Polynomial

    @classmethod
    def cut(cls, family: Family, polynomials: Iterable[Polynomial]) -> Line:
        """The line of the family's parameter, cut at its poles and at the roots of the nonzero ones of these."""
        common = poles(family)
        return cls(_real_roots([p for p in (common, *polynomials) if p != 0]), common)

    def values(self) -> Iterator[Exact | None]:
        """A rational number of each open cell, and each point itself, ascending; None at a pole.

        Raises `methods.number_field.UndecidedError` at a point of degree above 12, which has no number field here.
        """
        for k, inner in enumerate(_samples(self.points)):
            yield exact(inner)
            if k < len(self.points):
                point = self.points[k]
                yield None if vanishes_at(self.poles, point) else number_of(point)

    def runs(self, labels: Sequence[Label]) -> list[tuple[Label, Interval]]:
        """Intervals of equal labels, ascending; label 2k is that of the open cell before point k, 2k + 1 its own."""
        found = []
        for label, run in groupby(enumerate(labels), key=lambda item: item[1]):
            places = [place for place, _ in run]
            first, last = places[0], places[-1]
            low = self.points[(first - 1) // 2] if first else None
            high = self.points[last // 2] if last < 2 * len(self.points) else None
            found.append((label, Interval(low, high, first % 2 == 1, last % 2 == 1)))
        return found

    def where(self, holds: Callable[[Exact], object]) -> list[Interval]:
        """The values at which `holds` is true, if it is constant on each open cell: disjoint intervals, ascending."""
        verdicts = [value is not None and bool(holds(value)) for value in self.values()]
        return [interval for verdict, interval in self.runs(verdicts) if verdict]


def parameter_set(family: Family, decide: Callable[[RationalFunction], object]) -> list[Interval]:
    """The values of the parameter at which `decide` of R(z) is true: disjoint intervals, ascending.

    For A-, I- and L-stability and whatever else depends on the degrees of R in lowest terms, on the sign pattern of
    |Q(iy)|² - |P(iy)|² and on the side of the imaginary axis where the poles lie: between critical values none of these
    changes, so one rational value decides each interval; critical values are decided in their number fields.
    """
    line = Line.cut(family, critical_polynomials(family))
    return line.where(lambda value: decide(stability_function(family.member(value))))


def critical_polynomials(family: Family) -> list[Polynomial]:
    """Polynomials in the parameter, one of which vanishes wherever the facts named in `parameter_set` can change."""
    r = family_stability(family)
    even, odd = signed(r.den[::2]), signed(r.den[1::2])
    margin = margin_on_axis(r)
    merging = [merging_values(p, q) for p, q in ((r.num, r.den), (even, odd), (margin, slope(margin)))]
    ends = [p for rows in (r.num, r.den, margin) if rows for p in (rows[0], rows[-1])]
    return [p for p in (*ends, *merging) if p is not None and p != 0]


def margin_on_axis(r: FamilyStability) -> Bivariate:
    """|Q(iy)|² - |P(iy)|² by powers of y², without common ones."""
    return without_root_zero(difference(size_on_axis(r.den), size_on_axis(r.num)))


def describe(intervals: Iterable[Interval]) -> str:
    """The union, e.g. "[1/4, oo)"; "empty" for none."""
    return " U ".join(map(str, intervals)) or "empty"


def set_data(intervals: Sequence[Interval]) -> dict[str, Any]:
    """{"set": "[1/4, oo)", "intervals": [...]}, the same set for readers and for programs."""
    return {"set": describe(intervals), "intervals": [interval.data() for interval in intervals]}


def _real_roots(polynomials: list[Polynomial]) -> list[RealRoot]:
    """All real roots, ascending."""
    negative = [root.negated() for root in positive_roots([reflected(p) for p in polynomials])]
    middle = [ORIGIN] if any(p[0] == 0 for p in polynomials) else []
    return [*reversed(negative), *middle, *positive_roots(polynomials)]


def _samples(points: list[RealRoot]) -> list[fmpq]:
    """A rational number in each of the open intervals that the ascending points cut the line into."""
    negative = [p.negated() for p in points if p.ball() < 0][::-1]
    positive = [p for p in points if p.ball() > 0]
    below, above = [-x for x in samples(negative)][::-1], samples(positive)
    return [*below, *above] if ORIGIN in points else [*below[:-1], fmpq(0), *above[1:]]


def _text(root: RealRoot) -> str:
    """In radicals, or else with few digits and a sign that they are not all."""
    return radical_form(root) or f"~{decimal(root, DIGITS_SHOWN)}"
