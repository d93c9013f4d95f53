"""The any-order bound of a definition on the oscillator in balls: polynomials in |h|, for many stages, too.

The polynomials in D of `any_evaluation_order` have thousands of terms for forty stages. What is asked of them is the
sum of c (g^k - 1) m over their monomials c D^k m, and that is their value at D = g less that at D = 1: the same tally
runs on numbers. A difference loses as many bits as g is near to 1, which the precision adds.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Self, TypeAlias

from flint import arb, arb_poly, ctx

from driftproof.methods.number_field import Exact
from driftproof.methods.schemes import Method
from driftproof.methods.stepping import oscillator, stepper
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.rounding.any_evaluation_order import MultipliedOutTally, size_of_coefficient
from driftproof.symbolic.rounding.formats import FloatFormat, power_of_two

# What is linear in the state: a polynomial in h, in balls, for |q|, one for |v|, one for 1.
Columns: TypeAlias = Sequence[arb_poly]


class LinearSizes:
    """A size that is linear in |q| and |v|, its coefficients polynomials in |h|. Of two factors one is free of both."""

    __slots__ = ("columns",)

    def __init__(self, q: arb_poly, v: arb_poly, one: arb_poly) -> None:
        """The coefficients."""
        self.columns = (q, v, one)

    @classmethod
    def constant(cls, x: arb) -> Self:
        """A number."""
        return cls(arb_poly([]), arb_poly([]), arb_poly([x]))

    def __bool__(self) -> bool:
        """False for zero."""
        return any(column.length() for column in self.columns)

    def __add__(self, other: LinearSizes) -> LinearSizes:
        """The sum."""
        return LinearSizes(*(x + y for x, y in zip(self.columns, other.columns, strict=True)))

    def __mul__(self, other: LinearSizes) -> LinearSizes:
        """The product. Raises ValueError for one that is quadratic in the state."""
        free, linear = sorted((self, other), key=lambda each: any(column.length() for column in each.columns[:2]))
        if any(column.length() for column in free.columns[:2]):
            raise ValueError("a product of two sizes that depend on the state")
        return LinearSizes(*(free.columns[2] * column for column in linear.columns))

    def __pow__(self, n: int) -> LinearSizes:
        """The power of a number."""
        return LinearSizes(arb_poly([]), arb_poly([]), self.columns[2] ** n)


def _sizes(method: Method, fmt: FloatFormat, growth: arb, factor: arb | None = None) -> tuple[Columns, Columns]:
    """The tally at D = `growth`. With a factor small sizes are raised, and h, q and v multiplied by it."""

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


def _difference(more: Columns, less: Columns) -> list[arb_poly]:
    """Coefficients that do not differ are 0: a count of one or more makes them differ by far more than a radius."""
    return [arb_poly([0 if c.contains(0) else c for c in (x - y).coeffs()]) for x, y in zip(more, less, strict=True)]


@lru_cache(maxsize=64)
def any_order_columns(method: Method, fmt: FloatFormat, bits: int, lost: Fraction) -> list[Columns]:
    """The bound on |dq| and on |dv|, of programs that multiply out brackets, too, with some `bits` that are right.

    At most `lost` is lost by each product: eta/2 where numbers underflow gradually. Raises as
    `any_evaluation_order_bound` does.
    """
    with ctx.workprec(bits + fmt.precision - 2 * fmt.emin):
        growth, loss = 1 + enclose(fmt.relative_error), 1 + enclose(lost)
        values = [_sizes(method, fmt, at) for at in (growth, arb(1))]
        values += [_sizes(method, fmt, at, arb(1)) for at in (growth * loss, growth)]
        (more, exact, raised, rounded) = values
        return [
            [x + y for x, y in zip(_difference(more[i], exact[i]), _difference(raised[i], rounded[i]), strict=True)]
            for i in range(2)
        ]


@lru_cache(maxsize=64)
def flushed_columns(method: Method, fmt: FloatFormat, bits: int) -> list[Columns]:
    """What flushing to zero adds: of a monomial with n factors and k roundings, n + k numbers may lose 2**emin each.

    A loss is passed on as an underflow is (`any_evaluation_order`): times the other factors of the monomial, raised to
    at least 1, and their roundings.
    """
    with ctx.workprec(bits + fmt.precision - 2 * fmt.emin):
        growth, loss = 1 + enclose(fmt.relative_error), 1 + enclose(power_of_two(fmt.emin))
        more, less = _sizes(method, fmt, growth * loss, loss), _sizes(method, fmt, growth, arb(1))
        return [_difference(x, y) for x, y in zip(more, less, strict=True)]


@lru_cache(maxsize=64)
def size_columns(method: Method, fmt: FloatFormat, bits: int) -> list[Columns]:
    """The sum of |monomials| of the definition's expressions, before anything cancels."""
    with ctx.workprec(bits):
        return list(_sizes(method, fmt, arb(1)))
