"""The rounding bound of a definition: valid for every order in which its sums and products are evaluated.

A program made of +, -, * and constants returns the sum of its monomials, each multiplied by one factor (1 + a),
|a| <= d, for each rounding that it passes. A product passes on the counts of its two factors, added, and one more; in
a sum of n terms, no order takes a term through more than n - 1. So a monomial m errs by at most ((1+d)^k - 1)|m| with a
k that no order exceeds, and no monomial is cancelled against another. Underflow adds at most eta/2 at each of the at
most k products in m, times the factors still to come: together at most ((1+eta/2)^k - 1)(1+d)^k times m with each
factor that may be below 1 raised (constants to 1, |h| to 1 + |h|, the state to 1 + |q| + |v|).
Fusing a product into a sum only drops factors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from methods.schemes import Method
from symbolic.one_step import rational
from symbolic.rounding.formats import BINARY64, FloatFormat, power_of_two
from symbolic.rounding.number import Rounded
from symbolic.rounding.polynomials import RING, D, H, Polynomial, Q, V, majorant
from symbolic.rounding.step import StepBound
from symbolic.rounding.trace import Terms, at_state, at_step, in_format, program, trace


@dataclass(frozen=True)
class AnyOrderBound:
    """|fl(step(z)) - M(h) z| <= the sum over the monomials c D^k m of `counted` of c ((1+d)^k - 1)|m|, and underflow.

    `counted` holds them for dq and dv: here the power of D is the count k. `raised` is the same with small factors
    raised. Holds for every program that associates and commutes the definition's sums and products as it likes, fuses
    them or not, and rounds each coefficient, if nothing overflows. Whether some other program is inside, one that
    multiplies out a bracket say, is for `covers` to decide.
    """

    format: FloatFormat
    counted: tuple[Polynomial, Polynomial]
    raised: tuple[Polynomial, Polynomial]

    @property
    def roundings(self) -> int:
        """The most roundings that a monomial passes, in any order."""
        return max(int(polynomial.degree(D)) for polynomial in self.counted)

    def error_of(self, h: Fraction, q: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """The bounds on |dq| and |dv| of one step from (q, v)."""
        dq, dv = (at_state(at_step(terms, abs(h)), abs(q), abs(v)) for terms in self._terms)
        return dq, dv

    def covers(self, bound: StepBound) -> bool:
        """True when a program's own bound is nowhere above this one: coefficient by coefficient, so for all h, q, v."""
        own = [in_format(x.error, bound.format) for x in bound.outputs]
        return bound.format == self.format and all(
            coefficient <= mine.get(powers, 0)
            for theirs, mine in zip(own, self._terms, strict=True)
            for powers, coefficient in theirs.items()
        )

    @cached_property
    def _terms(self) -> list[Terms]:
        growth, loss = 1 + self.format.relative_error, 1 + self.format.eta / 2
        return [
            _summed(
                _weighted(counted, lambda k: growth**k - 1) + _weighted(raised, lambda k: (loss**k - 1) * growth**k)
            )
            for counted, raised in zip(self.counted, self.raised, strict=True)
        ]


def any_order_bound(method: Method, fmt: FloatFormat = BINARY64, *, multiplied_out: bool = False) -> AnyOrderBound:
    """The any-order bound of a definition.

    With `multiplied_out` also of programs that multiply out its brackets: where z + h (w₁k₁ + w₂k₂) may be computed as
    z + hw₁k₁ + hw₂k₂, z is a term of the longer sum, and any of its terms may be the one that passes every addition.
    The force is called with one number, so no bracket reaches through it. Raises MethodError for an implicit method,
    ValueError for a coefficient in the format's underflow range.
    """
    q, v = (_tally_of(output, multiplied_out) for output in trace(method, fmt))
    return AnyOrderBound(fmt, (q.finished, v.finished), (q.finished_raised, v.finished_raised))


def _weighted(polynomial: Polynomial, weight: Callable[[int], Fraction]) -> list[tuple[tuple[int, ...], Fraction]]:
    """The terms (powers of h, q, v; coefficient) with each power k of D replaced by weight(k)."""
    return [
        (tuple(powers), Fraction(int(c.numerator), int(c.denominator)) * weight(k))
        for (k, _, *powers), c in polynomial.terms()
    ]


def _summed(terms: list[tuple[tuple[int, ...], Fraction]]) -> Terms:
    total: Terms = {}
    for powers, c in terms:
        total[powers] = total.get(powers, Fraction(0)) + c
    return total


class _Tally(NamedTuple):
    """Sums of |monomials|, as they are and with small factors raised; a power of D counts a monomial's roundings.

    Still to be counted are the `additions` of the sum that ends here: any term may be the one that passes them all.
    """

    plain: Polynomial
    raised: Polynomial
    additions: int = 0

    @property
    def finished(self) -> Polynomial:
        """`plain` with the additions counted."""
        return self.plain * D**self.additions

    @property
    def finished_raised(self) -> Polynomial:
        """`raised` with the additions counted."""
        return self.raised * D**self.additions


def _tally_of(output: Rounded, multiplied_out: bool) -> _Tally:
    found: dict[int, _Tally] = {}
    for x in program([output]):
        found[id(x)] = _tally(x, [found[id(operand)] for operand, _ in x.operands], multiplied_out)
    return found[id(output)]


def _tally(x: Rounded, operands: list[_Tally], multiplied_out: bool) -> _Tally:
    if not operands:
        return _leaf(x)
    if len(operands) == 1:  # a negation: the force -q, which is called with a finished number
        (a,) = operands
        return _Tally(a.finished, a.finished_raised) if multiplied_out else a
    a, b = operands
    if not x.fusible:
        return _Tally(a.plain + b.plain, a.raised + b.raised, a.additions + b.additions + 1)
    for (factor, _), other in zip(x.operands, (b, a), strict=True):
        if factor.held in (1, -1):  # no product at all: a sum behind it may be merged with the sum before it
            return other
    if multiplied_out and 0 in (a.additions, b.additions):
        return _Tally(D * a.plain * b.plain, D * a.raised * b.raised, a.additions + b.additions)
    return _Tally(D * a.finished * b.finished, D * a.finished_raised * b.finished_raised)


def _leaf(x: Rounded) -> _Tally:
    size = majorant(x.exact)
    if x.held is None:
        return _Tally(size, 1 + H if size == H else 1 + Q + V)
    if 0 < size.LC < rational(power_of_two(x.format.emin)):
        raise ValueError(f"the coefficient {size.LC} is in the underflow range of {x.format.name}")
    # A coefficient that this format holds may be another program's rounded one.
    count = RING.one if size == 1 else D
    return _Tally(count * size, count * max(size.LC, 1))
