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

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar, Self

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Method
from driftproof.methods.stepping import oscillator, stepper
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat, power_of_two
from driftproof.symbolic.rounding.polynomials import (
    D,
    ErrorPolynomial,
    H,
    Q,
    V,
    absolute_value,
    constant_polynomial,
    rational_above,
    terms,
)
from driftproof.symbolic.rounding.step_bound import Terms, at_state, at_step


@dataclass(frozen=True)
class AnyEvaluationOrderBound:
    """|fl(step(z)) - M(h) z| <= the sum over the monomials c D^k m of `counted` of c ((1+d)^k - 1)|m|, and underflow.

    `counted` holds them for dq and dv: here the power of D is the count k. `raised` is the same with small factors
    raised. Holds for every program that associates and commutes the definition's sums and products as it likes, fuses
    them or not, and rounds each coefficient, if nothing overflows.
    """

    format: FloatFormat
    counted: tuple[ErrorPolynomial, ErrorPolynomial]
    raised: tuple[ErrorPolynomial, ErrorPolynomial]

    @property
    def roundings(self) -> int:
        """The most roundings that a monomial passes, in any order."""
        return max(int(p.degrees()[0]) for p in self.counted)

    def error_of(self, h: Fraction, q: Fraction, v: Fraction) -> tuple[Fraction, Fraction]:
        """The bounds on |dq| and |dv| of one step from (q, v)."""
        dq, dv = (at_state(at_step(found, abs(h)), abs(q), abs(v)) for found in self.error_terms)
        return dq, dv

    @cached_property
    def error_terms(self) -> tuple[Terms, Terms]:
        """The bounds on |dq| and |dv| as polynomials in |h|, |q|, |v| in this format."""
        growth, loss = 1 + self.format.relative_error, 1 + self.format.eta / 2
        found: tuple[Terms, Terms] = ({}, {})
        for total, counted, raised in zip(found, self.counted, self.raised, strict=True):
            weighted = [(powers, c * (growth**k - 1)) for (k, _, *powers), c in terms(counted)]
            weighted += [(powers, c * (loss**k - 1) * growth**k) for (k, _, *powers), c in terms(raised)]
            for powers, c in weighted:
                total[tuple(powers)] = total.get(tuple(powers), Fraction(0)) + c
        return found


def any_evaluation_order_bound(
    method: Method, fmt: FloatFormat = BINARY64, *, multiplied_out: bool = False
) -> AnyEvaluationOrderBound:
    """The rounding bound of a definition, whatever the order of evaluation.

    With `multiplied_out` also of programs that multiply out its brackets: where z + h (w₁k₁ + w₂k₂) may be computed as
    z + hw₁k₁ + hw₂k₂, z is a term of the longer sum, and any of its terms may be the one that passes every addition.
    The force is called with one number, so no bracket reaches through it. Raises MethodError for an implicit method,
    ValueError for a coefficient in the format's underflow range.
    """
    tally = _MultipliedOutPolynomialTally if multiplied_out else _PolynomialTally

    def sizes(q: Any, v: Any, h: Any, least: Fraction) -> tuple[ErrorPolynomial, ErrorPolynomial]:
        step = stepper(method, lambda exact: tally.of_coefficient(exact, fmt, least))
        q1, v1 = step(oscillator, tally(q), tally(v), tally(h))
        return q1.finished, v1.finished

    state = 1 + Q + V
    return AnyEvaluationOrderBound(fmt, sizes(Q, V, H, Fraction(0)), sizes(state, state, 1 + H, Fraction(1)))


class ErrorTally:
    """A sum of |monomials| whose roundings are counted, over any type of sizes with +, * and truth (False for zero).

    A subclass names the `rounding` of its type: the size by which another is multiplied to count one rounding more.
    For polynomials that is D, whose power is the count, monomial by monomial; for pairs (size, count) with
    (a, k) + (b, l) = (a + b, max(k, l)) and (a, k)(b, l) = (ab, k + l) it is (1, 1): only the largest count is kept.
    Still to be counted are the `additions` of the sum that ends here: any term may be the one that passes them all.
    `factor` is the number itself where it is a known constant: a product with 1 or -1 is none.
    """

    rounding: ClassVar[Any]
    __slots__ = ("additions", "factor", "size")

    def __init__(self, size: Any, additions: int = 0, factor: Exact | int | None = None) -> None:
        """Without `additions`, a number that is finished."""
        self.size, self.additions, self.factor = size, additions, factor

    @property
    def finished(self) -> Any:
        """The size with the additions counted."""
        return self.size * self.rounding**self.additions

    def __add__(self, other: Self) -> Self:
        """x + y: one addition more for any term; a zero is no term."""
        if not self.size or not other.size:
            return self if self.size else other
        return type(self)(self.size + other.size, self.additions + other.additions + 1)

    __sub__ = __add__

    def __neg__(self) -> Self:
        """-x, exact."""
        return self

    def __mul__(self, other: Self) -> Self:
        """x y."""
        for x, y in ((self, other), (other, self)):
            if x.factor in (1, -1):  # no product at all: a sum behind it may be merged with the sum before it
                return y
        return self._times(other)

    def _times(self, other: Self) -> Self:
        return type(self)(self.rounding * self.finished * other.finished)


class _PolynomialTally(ErrorTally):
    """The tally in polynomials in D, |h|, |q|, |v|."""

    rounding = D
    __slots__ = ()

    @classmethod
    def of_coefficient(cls, exact: Exact, fmt: FloatFormat, least: Fraction) -> Self:
        """A coefficient, `least` if that is more: one that this format holds may be another program's rounded one.

        Raises ValueError.
        """
        size = size_of_coefficient(exact, fmt)
        counted = constant_polynomial(max(size, least))
        return cls(counted if size == 1 else D * counted, factor=exact)


class MultipliedOutTally(ErrorTally):
    """The tally where brackets may be multiplied out, but not through the force, which is called with one number."""

    __slots__ = ()

    def __neg__(self) -> Self:
        """The force -q of a finished number."""
        return self if self.factor is not None else type(self)(self.finished)

    def _times(self, other: Self) -> Self:
        if 0 not in (self.additions, other.additions):
            return super()._times(other)
        return type(self)(self.rounding * self.size * other.size, self.additions + other.additions)


class _MultipliedOutPolynomialTally(MultipliedOutTally, _PolynomialTally):
    """The same in polynomials."""

    __slots__ = ()


def size_of_coefficient(exact: Exact, fmt: FloatFormat) -> Fraction:
    """A rational at or just above the size of a coefficient. Raises ValueError where it may underflow."""
    size = rational_above(absolute_value(exact))
    if 0 < size < power_of_two(fmt.emin):
        raise ValueError(f"the coefficient {size} is in the underflow range of {fmt.name}")
    return size
