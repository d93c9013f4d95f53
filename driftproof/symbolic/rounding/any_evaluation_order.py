"""The rounding bound of a definition: valid for every order in which its sums and products are evaluated.

A program made of +, -, * and constants returns the sum of its monomials, each multiplied by one factor (1 + a),
|a| <= d, for each rounding that it passes. A product has as many roundings as its two factors together, and one more;
in a sum of n terms, no order takes a term through more than n - 1. So a monomial m errs by at most ((1+d)^k - 1)|m|,
where no order has more than k roundings of m; no monomial is cancelled against another. Underflow adds at most eta/2 at
each of the at most k products in m, times the factors still to come: together at most ((1+eta/2)^k - 1)(1+d)^k times m
with each factor that may be below 1 raised (constants to 1, |h| to 1 + |h|, the state to 1 + |q| + |v|).
Fusing a product into a sum only drops factors.

The sum of c (g^k - 1) m over all monomials c m is the sum of c g^k m minus its value at g = 1. So the monomials, which
are thousands for forty stages, are never listed: the tally runs on polynomials in |h| whose coefficients, like g, are
balls. The difference loses the more bits the closer g is to 1; the working precision is higher by that many.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any, ClassVar, Self, TypeAlias

from flint import arb, arb_poly, ctx

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.methods.schemes import Method
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.rounding.formats import FloatFormat, power_of_two
from driftproof.symbolic.rounding.polynomials import absolute_value, rational_above

# A bound linear in the state: polynomials in |h| with balls as coefficients, one for |q|, one for |v|, one for 1.
Columns: TypeAlias = Sequence[arb_poly]


class ErrorTally:
    """A sum of |monomials| whose roundings are counted, over any type of sizes with +, * and bool (False for zero).

    A subclass defines the `rounding` of its type: the factor of a size that counts one more rounding.
    For numbers that is 1 + d; for pairs (size, count) with (a, k) + (b, l) = (a + b, max(k, l)) and
    (a, k)(b, l) = (ab, k + l) it is (1, 1): only the largest count is kept.
    The `additions` of the sum that ends here are not yet counted: any term may be the one that passes all of them.
    `factor` is the number itself if it is a known constant: multiplying by 1 or -1 rounds nothing.
    """

    rounding: ClassVar[Any]
    __slots__ = ("additions", "factor", "size")

    def __init__(self, size: Any, additions: int = 0, factor: Exact | int | None = None) -> None:
        """Take the size, the additions not yet counted in it, and the constant, if it is one."""
        self.size, self.additions, self.factor = size, additions, factor

    @property
    def finished(self) -> Any:
        """The size with the additions counted."""
        return self.size * self.rounding**self.additions

    def __add__(self, other: Self) -> Self:
        """x + y, one more addition for every term; a zero is no term."""
        if not self.size or not other.size:
            return self if self.size else other
        return type(self)(self.size + other.size, self.additions + other.additions + 1)

    __sub__ = __add__

    def __neg__(self) -> Self:
        return self

    def __mul__(self, other: Self) -> Self:
        """x y, one more rounding unless a factor is 1 or -1."""
        for x, y in ((self, other), (other, self)):
            if x.factor in (1, -1):  # no rounding: y may be a sum that is merged with the sum it enters
                return y
        return self._times(other)

    def _times(self, other: Self) -> Self:
        return type(self)(self.rounding * self.finished * other.finished)


class MultipliedOutTally(ErrorTally):
    """The tally of programs that may multiply out brackets, though not across the force, which takes a single number.

    If z + h (w₁k₁ + w₂k₂) may be computed as z + hw₁k₁ + hw₂k₂, z is a term of that longer sum, and any term of it may
    be the one that passes every addition.
    """

    __slots__ = ()

    def __neg__(self) -> Self:
        """-x: a negated constant, or else the force -q of a finished number."""
        return self if self.factor is not None else type(self)(self.finished)

    def _times(self, other: Self) -> Self:
        # In a step, one of the two factors is a coefficient or h, and so no sum.
        return type(self)(self.rounding * self.size * other.size, self.additions + other.additions)


class LinearSizes:
    """A size that is linear in |q| and |v|, with polynomials in |h| as coefficients."""

    __slots__ = ("columns",)

    def __init__(self, q: arb_poly, v: arb_poly, one: arb_poly) -> None:
        """Take the coefficients of |q|, |v| and 1."""
        self.columns = (q, v, one)

    @classmethod
    def constant(cls, x: arb) -> Self:
        """The size of a number."""
        return cls(arb_poly([]), arb_poly([]), arb_poly([x]))

    def __bool__(self) -> bool:
        return any(column.length() for column in self.columns)

    def __add__(self, other: LinearSizes) -> LinearSizes:
        return LinearSizes(*(x + y for x, y in zip(self.columns, other.columns, strict=True)))

    def __mul__(self, other: LinearSizes) -> LinearSizes:
        """The product. Raises ValueError if it is quadratic in the state."""
        free, linear = sorted((self, other), key=lambda each: any(column.length() for column in each.columns[:2]))
        if any(column.length() for column in free.columns[:2]):
            raise ValueError("the step multiplies two sizes that depend on the state")
        return LinearSizes(*(free.columns[2] * column for column in linear.columns))

    def __pow__(self, n: int) -> LinearSizes:
        """The n-th power, for a size that does not depend on the state."""
        return LinearSizes(arb_poly([]), arb_poly([]), self.columns[2] ** n)


def _sizes(method: Method, fmt: FloatFormat, growth: arb, factor: arb | None = None) -> tuple[Columns, Columns]:
    """The sizes of q1 and v1 with g = `growth`; a `factor` multiplies h, q and v, and raises small sizes."""

    class Tally(MultipliedOutTally):
        rounding = LinearSizes.constant(growth)
        __slots__ = ()

    def number(exact: Exact) -> Tally:
        size = size_of_coefficient(exact, fmt)
        counted = LinearSizes.constant(enclose(max(size, Fraction(factor is not None))))
        return Tally(counted if size == 1 else Tally.rounding * counted, factor=exact)

    nil, raised, times = arb_poly([]), arb_poly([] if factor is None else [1]), arb_poly([factor or 1])
    q, v, h = LinearSizes(times, nil, raised), LinearSizes(nil, times, raised), raised + times * arb_poly([0, 1])
    if factor is not None:
        q = v = LinearSizes(times, times, raised)
    q1, v1 = stepper(method, number)(oscillator, Tally(q), Tally(v), Tally(LinearSizes(nil, nil, h)))
    return q1.finished.columns, v1.finished.columns


def _differences(more: tuple[Columns, Columns], less: tuple[Columns, Columns]) -> list[Columns]:
    """The differences of bounds, which are >= 0; where a ball contains 0, a bound of its size: nothing is lost."""
    return [
        [
            arb_poly([c.abs_upper() if c.contains(0) else c for c in (x - y).coeffs()])
            for x, y in zip(*pair, strict=True)
        ]
        for pair in zip(more, less, strict=True)
    ]


@lru_cache
def any_order_columns(method: Method, fmt: FloatFormat, bits: int) -> list[Columns]:
    """The bounds on |dq| and |dv| for any order of evaluation, brackets multiplied out or not, to about `bits` bits.

    Raises MethodError for an implicit method, ValueError for a coefficient in the format's underflow range.
    """
    with ctx.workprec(bits + fmt.precision - fmt.emin):
        growth, loss = 1 + enclose(fmt.relative_error), 1 + enclose(fmt.eta / 2)
        rounded = _differences(_sizes(method, fmt, growth), _sizes(method, fmt, arb(1)))
        lost = _differences(_sizes(method, fmt, growth * loss, arb(1)), _sizes(method, fmt, growth, arb(1)))
        return [[x + y for x, y in zip(*pair, strict=True)] for pair in zip(rounded, lost, strict=True)]


@lru_cache
def flushed_columns(method: Method, fmt: FloatFormat, bits: int) -> list[Columns]:
    """What flushing to zero adds: in a monomial with n factors and k roundings, n + k numbers may lose 2**emin each.

    Like an underflow, a loss is multiplied by the monomial's other factors, raised to at least 1, and their roundings.
    """
    with ctx.workprec(bits + fmt.precision - fmt.emin):
        growth, loss = 1 + enclose(fmt.relative_error), 1 + enclose(power_of_two(fmt.emin))
        return _differences(_sizes(method, fmt, growth * loss, loss), _sizes(method, fmt, growth, arb(1)))


@lru_cache
def size_columns(method: Method, fmt: FloatFormat, bits: int) -> list[Columns]:
    """The sum of |monomials| of the definition's expressions, before anything cancels."""
    with ctx.workprec(bits):
        return list(_sizes(method, fmt, arb(1)))


def size_of_coefficient(exact: Exact, fmt: FloatFormat) -> Fraction:
    """A rational at or just above the size of a coefficient. Raises ValueError if that may underflow."""
    size = rational_above(absolute_value(exact))
    if 0 < size < power_of_two(fmt.emin):
        raise ValueError(f"the coefficient {size} is so small that it underflows in {fmt.name}")
    return size
