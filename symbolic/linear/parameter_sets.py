"""For which values of its parameter a family of methods has a property: exact unions of intervals."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import groupby

from flint import fmpq

from methods.number_field import Exact, NumberField
from symbolic.linear.families import Family, FamilyStability, family_stability
from symbolic.linear.polynomials import ZERO, Polynomial, evaluate, exact, reflected
from symbolic.linear.radicals import decimal, radical_form
from symbolic.linear.rational_functions import RationalFunction
from symbolic.linear.real_roots import ZERO as ORIGIN
from symbolic.linear.real_roots import RealRoot, positive_roots, samples, vanishes_at
from symbolic.linear.stability_function import stability_function
from symbolic.linear.subresultants import Pair, critical_polynomial

# A polynomial in x whose coefficients, by powers of x, are polynomials in the parameter.
Bivariate = list[Polynomial]


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


def parameter_set(family: Family, decide: Callable[[RationalFunction], object]) -> list[Interval]:
    """The values of the parameter at which `decide` of R(z) is true: disjoint intervals, ascending.

    For A-, I- and L-stability and whatever else depends on the degrees of R in lowest terms, on the sign pattern of
    |Q(iy)|² - |P(iy)|² and on the side of the imaginary axis where the poles lie: between critical values none of these
    changes, so one rational value decides each interval; critical values are decided in their number fields.
    """
    points = _real_roots(critical_polynomials(family))
    cells = _samples(points)
    verdicts: list[bool] = []
    for k, inner in enumerate(cells):
        verdicts.append(bool(decide(stability_function(family.member(exact(inner))))))
        if k < len(points):
            defined = not vanishes_at(family.poles(), points[k])
            verdicts.append(defined and bool(decide(stability_function(family.member(_number(points[k]))))))
    return _intervals(points, verdicts)


def critical_polynomials(family: Family) -> list[Polynomial]:
    """Polynomials in the parameter, one of which vanishes wherever the facts named in `parameter_set` can change."""
    r, poles = family_stability(family), family.poles()
    num, den = _cleared(r, poles)
    even, odd = _signed(den[::2]), _signed(den[1::2])
    margin = _difference(_size_on_axis(den), _size_on_axis(num))
    pairs = [(num, den), (even, odd), (margin, _slope(margin))]
    merging = [critical_polynomial(_pair(p, q)) for p, q in pairs if p and q]
    ends = [p for rows in (num, den, margin) if rows for p in (rows[0], rows[-1])]
    return [p for p in (poles, *ends, *merging) if p is not None and p != 0]


def describe(intervals: Iterable[Interval]) -> str:
    """The union, e.g. "[1/4, oo)"; "empty" for none."""
    return " U ".join(map(str, intervals)) or "empty"


def _cleared(r: FamilyStability, poles: Polynomial) -> tuple[Bivariate, Bivariate]:
    """Numerator and denominator in z with polynomial coefficients, after multiplication by one polynomial."""
    common = poles ** max(len(r.num), len(r.den))
    num, den = ([c.num * (common // c.den) for c in row] for row in (r.num, r.den))
    return num, den


def _signed(rows: Bivariate) -> Bivariate:
    """p(-x), leading zeros dropped."""
    return _trimmed([-c if k % 2 else c for k, c in enumerate(rows)])


def _size_on_axis(rows: Bivariate) -> Bivariate:
    """|p(iy)|² by powers of x = y²."""
    even, odd = _signed(rows[::2]), _signed(rows[1::2])
    square: Bivariate = [ZERO] * (2 * len(rows))
    for part, shift in ((even, 0), (odd, 1)):
        for i, a in enumerate(part):
            for j, b in enumerate(part):
                square[i + j + shift] = square[i + j + shift] + a * b
    return square


def _difference(a: Bivariate, b: Bivariate) -> Bivariate:
    """a - b without leading zeros and without common powers of x."""
    size = max(len(a), len(b))
    rows = [x - y for x, y in zip(a + [ZERO] * (size - len(a)), b + [ZERO] * (size - len(b)), strict=True)]
    return _trimmed(_trimmed(rows)[::-1])[::-1]


def _trimmed(rows: Bivariate) -> Bivariate:
    while rows and rows[-1] == 0:
        rows = rows[:-1]
    return rows


def _slope(rows: Bivariate) -> Bivariate:
    return [c * k for k, c in enumerate(rows)][1:]


def _pair(p: Bivariate, q: Bivariate) -> Pair:
    reaches = tuple(max(int(c.degree()) for c in rows) for rows in (p, q))

    def at(value: fmpq) -> tuple[Polynomial, Polynomial]:
        first, second = (_polynomial_at(rows, value) for rows in (p, q))
        return first, second

    return Pair(at, (len(p) - 1, len(q) - 1), (reaches[0], reaches[1]))


def _polynomial_at(rows: Bivariate, value: fmpq) -> Polynomial:
    total = ZERO
    for c in reversed(rows):
        total = total.left_shift(1) + evaluate(c, value)
    return total


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


def _number(root: RealRoot) -> Exact:
    """The root as exact data of `methods`."""
    if root.rational is not None:
        return root.rational
    low, high = root.interval()
    return NumberField("alpha", root.minimal, low, high).generator


def _intervals(points: list[RealRoot], verdicts: list[bool]) -> list[Interval]:
    """Runs of true verdicts; verdict 2k is that of the open interval before point k, 2k + 1 that of point k."""
    found = []
    for holds, run in groupby(enumerate(verdicts), key=lambda item: item[1]):
        if holds:
            places = [place for place, _ in run]
            first, last = places[0], places[-1]
            low = points[(first - 1) // 2] if first else None
            high = points[last // 2] if last < 2 * len(points) else None
            found.append(Interval(low, high, first % 2 == 1, last % 2 == 1))
    return found


def _text(root: RealRoot) -> str:
    return radical_form(root) or decimal(root)
