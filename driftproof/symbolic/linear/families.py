"""Families of Runge-Kutta methods with a parameter: R(z), and the exact sets of values with a kind of stability."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple, TypeVar

from flint import fmpq

from driftproof.methods.families import Family, ParameterFunction
from driftproof.methods.numbers.number_field import Exact
from driftproof.symbolic.algebra.bivariate import (
    Bivariate,
    even_and_odd_part,
    from_rows,
    merging_values,
    modulus_squared_in_x,
    rows_in_x,
    without_root_zero,
)
from driftproof.symbolic.algebra.certified import sign_of_ball
from driftproof.symbolic.algebra.matrices import faddeev_leverrier
from driftproof.symbolic.algebra.polynomials import ZERO, Polynomial, descend, exact, reflected
from driftproof.symbolic.algebra.polynomials import quotient as polynomial_quotient
from driftproof.symbolic.algebra.radicals import radical_form, root_decimal
from driftproof.symbolic.algebra.rational_functions import RationalFunction, exponential_series, fraction
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT as ORIGIN
from driftproof.symbolic.algebra.real_roots import RealRoot, positive_roots, root_as_number, samples, vanishes_at
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import common_denominator

# Significant digits, in text, of an interval end without radicals; chosen, as the records hold its minimal polynomial.
DIGITS_OF_ENDS = 12
_Label = TypeVar("_Label", bound=Hashable)


@dataclass(frozen=True)
class FamilyStability:
    """R(z) = P/Q in lowest terms over Q(t) for the parameter t; `num` is P and `den` is Q, polynomials in x = z and t.

    At single values of t a further factor may cancel; at the roots of Q(z = 0) there may be no method.
    """

    num: Bivariate
    den: Bivariate

    def coefficients(self) -> tuple[list[RationalFunction], list[RationalFunction]]:
        """The coefficients of P and Q in z as functions of the parameter, scaled such that Q(0) = 1."""
        first = rows_in_x(self.den)[0]
        num, den = ([fraction(c, first) for c in rows_in_x(p)] for p in (self.num, self.den))
        return num, den

    def margin_on_axis(self) -> Bivariate:
        """|Q(iy)|² - |P(iy)|² as a polynomial in x = y² and the parameter, divided by powers of x."""
        return without_root_zero(modulus_squared_in_x(self.den) - modulus_squared_in_x(self.num))


def poles(family: Family) -> Polynomial:
    """The least common multiple of the denominators of all coefficients: it vanishes where no method is defined."""
    return common_denominator([*family.a, family.b, family.c])


def cleared(entries: Sequence[ParameterFunction], common: Polynomial) -> list[Polynomial]:
    """The entries times a common multiple of their denominators: polynomials in the parameter."""
    return [f.num * polynomial_quotient(common, f.den) for f in entries]


def family_stability(family: Family) -> FamilyStability:
    """R(z) = det(I - zA + z1bᵀ) / det(I - zA) as a function of z and of the parameter."""
    common = poles(family)
    rows, weights = [cleared(row, common) for row in family.a], cleared(family.b, common)
    shifted = [[x - y for x, y in zip(row, weights, strict=True)] for row in rows]
    num, den = (_determinant(matrix, common) for matrix in (shifted, rows))
    shared = num.gcd(den)
    return FamilyStability(num // shared, den // shared)


def _determinant(rows: Sequence[Sequence[Polynomial]], common: Polynomial) -> Bivariate:
    """det(I - zA) times commonˢ, for A = rows/common: coefficient k is that of `rows` times common**(s - k)."""
    found = [descend(c) for c in faddeev_leverrier(rows)[0]]
    return from_rows([c * common ** (len(rows) - k) for k, c in enumerate(found)])


def family_error_constant(family: Family) -> tuple[int, RationalFunction]:
    """(power, C) with R(z) - eᶻ = C(parameter) z**power + ..., C not zero; at the roots of C the order is higher.

    Such a term exists: R agrees with exp at most up to the power deg P + deg Q, as for a single method.
    """
    r = family_stability(family)
    num, den = (rows_in_x(p) for p in (r.num, r.den))
    num += [ZERO] * len(den)
    wanted = exponential_series(len(num))
    differences = (p - sum((q * x for q, x in zip(den, wanted[k::-1], strict=False)), ZERO) for k, p in enumerate(num))
    power, first = next((k, p) for k, p in enumerate(differences) if p)
    return power, fraction(first, den[0])  # of (P - Q eᶻ)/Q


@dataclass(frozen=True)
class Interval:
    """The numbers between `low` and `high` (None: unbounded), with each end closed or open."""

    low: RealRoot | None
    high: RealRoot | None
    low_closed: bool
    high_closed: bool

    def __str__(self) -> str:
        """The interval as text, e.g. "[1/4, oo)" or "{1 - sqrt(2)/2}"."""
        if self.low is not None and self.low == self.high:
            return f"{{{_text(self.low)}}}"
        left, right = "[" if self.low_closed else "(", "]" if self.high_closed else ")"
        low, high = ("-oo" if self.low is None else _text(self.low), "oo" if self.high is None else _text(self.high))
        return f"{left}{low}, {high}{right}"


class ParameterSet(NamedTuple):
    """A union of disjoint intervals, ascending."""

    intervals: tuple[Interval, ...]

    def __str__(self) -> str:
        """The union as text, e.g. "[1/4, oo)"; "empty" without intervals."""
        return " U ".join(map(str, self.intervals)) or "empty"


@dataclass(frozen=True)
class Line:
    """The line of the parameter, cut at `points`: open cell 0, point 0, open cell 1, and so on.

    The roots of `poles` are among the points, but no method belongs to them.
    """

    points: list[RealRoot]
    poles: Polynomial

    @classmethod
    def cut(cls, family: Family, polynomials: Iterable[Polynomial]) -> Line:
        """Cut the line of the family's parameter at its poles and at the real roots of the nonzero polynomials."""
        common = poles(family)
        return cls(_real_roots([p for p in (common, *polynomials) if p]), common)

    def values(self) -> Iterator[Exact | None]:
        """Yield a rational number of each open cell and each point itself, ascending; None for a pole.

        Raises `methods.numbers.number_field.UndecidedError` at a point of degree above 12, for which no number field is built.
        """
        for k, inner in enumerate(_samples(self.points)):
            yield exact(inner)
            if k < len(self.points):
                point = self.points[k]
                yield None if vanishes_at(self.poles, point) else root_as_number(point)

    def runs(self, labels: Sequence[_Label]) -> list[tuple[_Label, Interval]]:
        """The maximal intervals of equal labels; cell k before point k has labels[2k], point k has labels[2k + 1]."""
        found = []
        for label, run in groupby(enumerate(labels), key=lambda item: item[1]):
            places = [place for place, _ in run]
            first, last = places[0], places[-1]
            low = self.points[(first - 1) // 2] if first else None
            high = self.points[last // 2] if last < 2 * len(self.points) else None
            found.append((label, Interval(low, high, first % 2 == 1, last % 2 == 1)))
        return found

    def where(self, holds: Callable[[Exact], object]) -> ParameterSet:
        """The set of values for which `holds` is true; `holds` must be constant on each open cell."""
        return self.marked([value is not None and bool(holds(value)) for value in self.values()])

    def marked(self, verdicts: Sequence[bool]) -> ParameterSet:
        """The union of the cells and points whose verdict is True."""
        return ParameterSet(tuple(interval for verdict, interval in self.runs(verdicts) if verdict))


def parameter_set(family: Family, decide: Callable[[RationalFunction], object]) -> ParameterSet:
    """The set of values of the parameter for which decide(R) is true.

    `decide` may depend on the degrees of R in lowest terms, the sign pattern of |Q(iy)|² - |P(iy)|² and the side of the
    imaginary axis on which each pole lies, as A-, I- and L-stability do. None of these changes between critical values,
    so one rational value decides each interval; the critical values are decided in their number fields.
    """
    r = family_stability(family)
    line = Line.cut(family, critical_values(r, r.margin_on_axis(), even_and_odd_part(r.den)))
    return line.where(lambda value: decide(stability_function(family.member(value))))


def critical_values(r: FamilyStability, margin: Bivariate, *pairs: tuple[Bivariate, Bivariate]) -> list[Polynomial]:
    """Polynomials in the parameter that vanish where a degree changes, or a root becomes 0, or two roots merge.

    Degrees and zero roots are those of P, Q and the margin; roots merge if one is of P and one of Q, if both are of the
    margin, or if each is of one polynomial of a pair.
    """
    merging = [merging_values(p, q) for p, q in ((r.num, r.den), *pairs, (margin, margin.derivative(0)))]
    ends = [p for f in (r.num, r.den, margin) if f for p in (rows_in_x(f)[0], rows_in_x(f)[-1])]
    return [p for p in (*ends, *merging) if p is not None]


def _real_roots(polynomials: list[Polynomial]) -> list[RealRoot]:
    """All real roots of the polynomials, ascending."""
    negative = [root.negated() for root in positive_roots([reflected(p) for p in polynomials])]
    middle = [] if all(p[0] for p in polynomials) else [ORIGIN]
    return [*reversed(negative), *middle, *positive_roots(polynomials)]


def _samples(points: list[RealRoot]) -> list[fmpq]:
    """A rational number in each of the open intervals that the ascending points cut the line into."""
    negative = [p.negated() for p in points if sign_of_ball(p.ball()) == -1][::-1]
    positive = [p for p in points if sign_of_ball(p.ball()) == 1]
    below, above = [-x for x in samples(negative)][::-1], samples(positive)
    return [*below, *above] if ORIGIN in points else [*below[:-1], fmpq(0), *above[1:]]


def _text(root: RealRoot) -> str:
    """The number in radicals, or else rounded to DIGITS_OF_ENDS digits after a tilde."""
    return radical_form(root) or f"~{root_decimal(root, DIGITS_OF_ENDS)}"
