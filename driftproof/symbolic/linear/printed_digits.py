"""The order and the stability of a table of rounded coefficients, as far as its printed digits decide them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb, arb_mat, arb_poly, ctx, fmpq_poly, fmpz

from driftproof.methods.numbers.flint_rationals import as_fmpq
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.algebra.certified import AWAY, HALF_EVEN, endpoints, scientific, significant
from driftproof.symbolic.algebra.polynomials import reflected
from driftproof.symbolic.algebra.real_roots import ZERO_ROOT
from driftproof.symbolic.linear.a_stability import is_hurwitz, negative_point
from driftproof.symbolic.linear.stability_function import stability_function
from driftproof.symbolic.linear.stability_limits import INFINITY, nonnegative_limit

# Significant digits of R(oo) and its bound; chosen: only their order of magnitude matters.
SIZE_DIGITS = 3
# Significant digits of a limit that the last digits of the coefficients move.
LIMIT_DIGITS = 5
# Bits of precision in addition to those of the digits, so that the width of the balls comes from the radii alone.
SPARE_BITS = 64

# Residuals that come from rounding all coefficients to the same digits are within a factor of 1000 of each other; with
# coefficients of four digits or more, the first condition that fails by itself is larger by at least as much again.
JUMP = 1000
# Where residuals jump, what the digits explain counts tenfold, as with one digit less: the last ones that are printed
# are not always right (docs/differences.md; the embedded weights of dop853 miss by seven times their rounding).
MARGIN = 10
# Chosen: shorter decimals are exact, as nobody rounds a table to two digits.
FEWEST_DIGITS = 3
# Digits of a residual in text, where only its magnitude matters.
RESIDUAL_DIGITS = 3


class RoundedOrder(NamedTuple):
    """The order apart from rounding, the largest residual up to that order, and the largest one order higher.

    Both have three digits. `residual` is rounded up, so that no condition up to the order misses by more.
    `next_residual` is None if digits explain every condition that is tried.
    """

    order: int
    residual: str
    next_residual: str | None


def order_within_digits(orders: Iterable[Sequence[tuple[arb, arb]]], decimal: bool) -> RoundedOrder | None:
    """The order p but for rounded coefficients; None if no condition fails by rounding, or if nothing tells p.

    `orders` has, for the orders 1, 2, ..., the size of each residual, and how far the rounding of the entries can move
    it: the radius of the condition in ball arithmetic, each entry being a ball of half a unit of its last digit. A
    residual above `MARGIN` times that is the method's own, and ends the order. It proves the rounding of those before
    it if it is more than `JUMP` times as large. Where a table only says that it is rounded, `decimal`, nothing but
    residuals within the radius itself count, and the first beyond it ends the order.
    """
    largest, within = arb(0), None
    for n, found in enumerate(orders, 1):
        size = max((x for x, _ in found), default=arb(0))
        texts = (
            scientific(endpoints(largest)[1], RESIDUAL_DIGITS, AWAY),
            scientific(endpoints(size)[1], RESIDUAL_DIGITS),
        )
        here = RoundedOrder(n - 1, *texts) if largest > 0 else None
        if within is None and any(x > radius for x, radius in found):
            within = (here,)
        if any(x > MARGIN * radius for x, radius in found):
            return here if JUMP * largest < size else within[0] if within and decimal else None
        largest = max(largest, size)
    return RoundedOrder(n, scientific(endpoints(largest)[1], RESIDUAL_DIGITS, AWAY), None) if largest > 0 else None


class StabilityWithinDigits(NamedTuple):
    """The stability that the printed digits do not exclude, R(oo) as written, and the largest |R(oo)| they allow."""

    i_stable: bool
    a_stable: bool
    l_stable: bool
    limit_at_infinity: str
    digits_allow: str


def stability_within_digits(method: RungeKutta) -> StabilityWithinDigits | None:
    """The I-, A- and L-stability that the rounding of the coefficients does not exclude.

    The rounding is at most half a unit of the last digit of a decimal, and 1/q² for a ratio p/q, as convergents of a
    number are that close to it (hardy-wright-2008, 10.9). Balls of these radii around A and b give balls around the
    coefficients of R = P/Q; entries that are printed alike count as equal. I-stability is excluded if even the upper
    ends of |Q(iy)|² - |P(iy)|² are negative at some y. A-stability also needs that the written table has no pole with
    Re z <= 0, and L-stability that the ball around R(oo) contains 0. None for explicit methods, for irrational
    coefficients, and if R may have no limit.
    """
    if method.field or method.explicit:
        return None
    exact, places = stability_function(method), _longest(method)
    with ctx.workprec(4 * places + SPARE_BITS):
        num, den = _in_balls(method, places)
        if num.degree() > den.degree() or den[den.degree()].contains(0):
            return None
        at_infinity = num[den.degree()] / den[den.degree()]
        on_axis = negative_point(_margins(num, den)[1]) is None
        half_plane = on_axis and is_hurwitz(reflected(exact.den))
        written = exact.at_infinity() or Fraction(0)
        return StabilityWithinDigits(
            on_axis,
            half_plane,
            half_plane and bool(at_infinity.contains(0)),
            scientific(written, SIZE_DIGITS, HALF_EVEN),
            scientific(max(abs(end) for end in endpoints(at_infinity)), SIZE_DIGITS, AWAY),
        )


def imaginary_limit_within_digits(method: RungeKutta) -> str | None:
    """How far along the imaginary axis the rounding of an explicit table does not exclude |R| <= 1, in a few digits.

    A rounding lets |R| exceed 1 next to 0, and then a limit of 3 becomes one of 0. None if the digits do not prove
    |R| < 1 half-way there, if there is no limit, and for irrational coefficients.
    """
    if method.field or not method.explicit:
        return None
    places = _longest(method)
    with ctx.workprec(4 * places + SPARE_BITS):
        low, high = _margins(*_in_balls(method, places))
    square = nonnegative_limit(high)
    if square in (ZERO_ROOT, INFINITY) or low(as_fmpq(square.interval()[0] / 4)) <= 0:
        return None
    return significant(square.square_root().ball, LIMIT_DIGITS)


def roundings(method: Any) -> Callable[[Exact], Fraction]:
    """How far each entry of a table may be from what it was rounded from, by its digits or the source's `places`."""
    places = getattr(method, "places", None)
    longest = _longest(method) if isinstance(method, RungeKutta) else max(map(_digits, method.coefficients()))
    return lambda x: _rounding(x, longest) if places is None else Fraction(1, 2 * 10**places)


def _longest(method: RungeKutta) -> int:
    """The most digits of an entry of A or b, on which R depends."""
    return max(_digits(x) for row in (*method.a, method.b) for x in row)


def _digits(x: Exact) -> int:
    """The number of significant digits of a finite decimal; for any other number, of digits of its denominator."""
    assert isinstance(x, Fraction)
    places = _places(x)
    return len(str(fmpz(x.denominator if places is None else int(x * 10**places))).lstrip("-0"))


def _places(x: Exact) -> int | None:
    """The number of digits after the point of a finite decimal; None for any other number."""
    assert isinstance(x, Fraction)
    rest, places = x.denominator, 0
    for prime in (2, 5):
        power = 0
        while rest % prime == 0:
            rest, power = rest // prime, power + 1
        places = max(places, power)
    return places if rest == 1 else None


def _ball(x: Exact, longest: int) -> arb:
    """x with its rounding as radius."""
    assert isinstance(x, Fraction)
    return arb(as_fmpq(x)) + arb(0, 1) * arb(as_fmpq(_rounding(x, longest)))


def _rounding(x: Exact, longest: int) -> Fraction:
    """How far x may be from what it was rounded from; 0 for integers and what has too few digits, such as 0.25 or 1/3.

    These are fewer than `FEWEST_DIGITS`, or than half of the longest, unless as many places are printed as those.
    """
    assert isinstance(x, Fraction)
    places, few = _places(x), 2 * _digits(x) < max(longest, 2 * FEWEST_DIGITS - 1)
    if x.denominator == 1 or (few and (places or 0) < max(longest, FEWEST_DIGITS + 1)):
        return Fraction(0)
    return Fraction(1, x.denominator**2 if places is None else 2 * 10**places)


def _in_balls(method: RungeKutta, places: int) -> tuple[arb_poly, arb_poly]:
    """Numerator and denominator of R, with balls as coefficients; entries that are printed alike count as equal."""
    size = range(method.stages)
    a, b = [[_ball(x, places) for x in row] for row in method.a], [_ball(x, places) for x in method.b]
    shifted = [[arb(0) if method.a[i][j] == method.b[j] else a[i][j] - b[j] for j in size] for i in size]
    return _determinant(shifted), _determinant(a)


def _margins(num: arb_poly, den: arb_poly) -> tuple[fmpq_poly, fmpq_poly]:
    """The lower and the upper ends of |Q(iy)|² - |P(iy)|² for y > 0, as polynomials in y²."""
    ends = (endpoints(c) for c in (_square_on_axis(den) - _square_on_axis(num)).coeffs())
    low, high = ([as_fmpq(x) for x in row] for row in zip(*ends, strict=True))
    return fmpq_poly(low), fmpq_poly(high)


def _determinant(rows: list[list[arb]]) -> arb_poly:
    """det(I - zM) in balls, without the indices whose row or column is 0, which would only add terms with factor 0."""
    kept = list(range(len(rows)))
    while (fewer := [i for i in kept if not all(rows[i][j].is_zero() for j in kept)]) != kept or (
        fewer := [j for j in kept if not all(rows[i][j].is_zero() for i in kept)]
    ) != kept:
        kept = fewer
    inner = arb_mat([[rows[i][j] for j in kept] for i in kept])
    return arb_poly(inner.charpoly().coeffs()[::-1]) if kept else arb_poly([1])


def _square_on_axis(p: arb_poly) -> arb_poly:
    """|p(iy)|² as a polynomial in y²."""
    even, odd = (arb_poly([-c if k % 2 else c for k, c in enumerate(p.coeffs()[start::2])]) for start in (0, 1))
    return even * even + arb_poly([0, 1]) * odd * odd
