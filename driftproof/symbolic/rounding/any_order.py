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
from typing import Any, Self, TypeAlias

from flint import fmpq, fmpq_mpoly_ctx

from driftproof.methods.number_field import Exact
from driftproof.methods.problems import oscillator
from driftproof.methods.schemes import Method
from driftproof.methods.stepping import stepper
from driftproof.symbolic.derivation.one_step import rational
from driftproof.symbolic.rounding.formats import BINARY64, FloatFormat, power_of_two
from driftproof.symbolic.rounding.irrational import above, size
from driftproof.symbolic.rounding.polynomials import RING, D, Polynomial
from driftproof.symbolic.rounding.step import StepBound
from driftproof.symbolic.rounding.trace import Terms, at_state, at_step, in_format

# Polynomials in D, |h|, |q|, |v| with non-negative coefficients, while they are formed: in `RING` that takes minutes.
Sizes: TypeAlias = Any
_FORMED = fmpq_mpoly_ctx.get(("d", "h", "q", "v"))
_D, _H, _Q, _V = _FORMED.gens()
_ONE = _FORMED.constant(1)


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
    tally = _MultipliedOut if multiplied_out else _Tally
    q, v, h = tally(_Q, 1 + _Q + _V), tally(_V, 1 + _Q + _V), tally(_H, 1 + _H)
    q1, v1 = stepper(method, lambda exact: tally.of_coefficient(exact, fmt))(oscillator, q, v, h)
    counted, raised = ((_in_ring(x), _in_ring(y)) for x, y in zip(q1.finished, v1.finished, strict=True))
    return AnyOrderBound(fmt, counted, raised)


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


class _Tally:
    """Sums of |monomials|, as they are and with small factors raised; a power of D counts a monomial's roundings.

    Still to be counted are the `additions` of the sum that ends here: any term may be the one that passes them all.
    A `factor` is None where it is not known to be a constant.
    """

    __slots__ = ("additions", "factor", "plain", "raised")

    def __init__(self, plain: Sizes, raised: Sizes, additions: int = 0, factor: Exact | None = None) -> None:
        """Without `additions`, a number that is finished."""
        self.plain, self.raised, self.additions, self.factor = plain, raised, additions, factor

    @classmethod
    def of_coefficient(cls, exact: Exact, fmt: FloatFormat) -> Self:
        """A coefficient: one that this format holds may be another program's rounded one. Raises ValueError."""
        most = above(size(exact))
        if 0 < most < power_of_two(fmt.emin):
            raise ValueError(f"the coefficient {most} is in the underflow range of {fmt.name}")
        count = _ONE if most == 1 else _D
        return cls(count * _rational(most), count * _rational(max(most, Fraction(1))), factor=exact)

    @property
    def finished(self) -> tuple[Sizes, Sizes]:
        """`plain` and `raised` with the additions counted."""
        counted = _D**self.additions
        return self.plain * counted, self.raised * counted

    def __add__(self, other: Self) -> Self:
        """x + y: one addition more for any term."""
        additions = self.additions + other.additions + 1
        return type(self)(self.plain + other.plain, self.raised + other.raised, additions)

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
        (a, a_raised), (b, b_raised) = self.finished, other.finished
        return type(self)(_D * a * b, _D * a_raised * b_raised)


class _MultipliedOut(_Tally):
    """The tally where brackets may be multiplied out, but not through the force, which is called with one number."""

    __slots__ = ()

    def __neg__(self) -> Self:
        """The force -q of a finished number."""
        return self if self.factor is not None else type(self)(*self.finished)

    def _times(self, other: Self) -> Self:
        if 0 not in (self.additions, other.additions):
            return super()._times(other)
        additions = self.additions + other.additions
        return type(self)(_D * self.plain * other.plain, _D * self.raised * other.raised, additions)


def _in_ring(sizes: Sizes) -> Polynomial:
    """The same polynomial in `RING`."""
    terms = sizes.to_dict().items()
    return RING.from_dict(
        {(int(d), 0, *map(int, powers)): rational(Fraction(int(c.p), int(c.q))) for (d, *powers), c in terms}
    )


def _rational(x: Fraction) -> fmpq:
    return fmpq(x.numerator, x.denominator)
