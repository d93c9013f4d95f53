"""One formula, many arithmetics: floats search, balls certify, sizes bound, functions are printed, series compared."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb, arb_series, ctx

from driftproof.blackbox.linear.sizes import COEFFICIENT_ROUNDINGS, Sized, exponential
from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.certified import enclose
from driftproof.symbolic.algebra.polynomials import ONE, X, polynomial
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction
from driftproof.symbolic.rounding.formats import BINARY64
from driftproof.symbolic.runs import Entries

# A number of one of the arithmetics below.
Number: TypeAlias = Any

# Balls of this precision are far narrower than any rounding error that is compared with them.
BITS = 256
# Powers of h in a series: enough for an order below it.
SERIES_LENGTH = 24


@dataclass(frozen=True)
class Arithmetic:
    """How an exact coefficient becomes a number of this arithmetic, and what its exponential is."""

    name: str
    number: Callable[[Exact], Number]
    exponential: Callable[[Number], Number]


@dataclass(frozen=True)
class Function:
    """A rational function of h, with the four operations."""

    value: RationalFunction

    def __add__(self, other: Function) -> Function:
        """The sum."""
        return Function(self.value + other.value)

    def __sub__(self, other: Function) -> Function:
        """The difference."""
        return Function(self.value - other.value)

    def __neg__(self) -> Function:
        """The negative."""
        return Function(-self.value)

    def __mul__(self, other: Function) -> Function:
        """The product."""
        return Function(self.value * other.value)

    def __truediv__(self, other: Function) -> Function:
        """The quotient. Raises ZeroDivisionError."""
        return Function(self.value * fraction(other.value.den, other.value.num))


def _sized(x: Exact) -> Sized:
    value = float(x)
    return Sized(value, abs(value), 0 if abs(value) in (0, 1) else COEFFICIENT_ROUNDINGS)


def _function(x: Exact) -> Function:
    return Function(RationalFunction(polynomial([x]), ONE))


def _no_function(x: Function) -> Function:
    raise ValueError("an exponential is no rational function")


def _series(x: Exact) -> arb_series:
    return arb_series([enclose(x)], SERIES_LENGTH)


FLOATS = Arithmetic("floats", float, math.exp)
BALLS = Arithmetic("balls", enclose, lambda x: x.exp())
SIZES = Arithmetic("sizes", _sized, exponential)
FUNCTIONS = Arithmetic("functions", _function, _no_function)
SERIES = Arithmetic("series", _series, lambda x: x.exp())


def printed(x: Exact) -> arb_series:
    """A decimal as its source prints it, right to a rounding of binary64: a ball around it."""
    radius = abs(Fraction(x)) * BINARY64.u if isinstance(x, Fraction) else Fraction(0)
    return arb_series([enclose(x) + arb(0, 1) * enclose(radius)], SERIES_LENGTH)


def step_function() -> Function:
    """h as a rational function of h."""
    return Function(fraction(X))


def step_series() -> arb_series:
    """h as a power series in h."""
    return arb_series([0, 1], SERIES_LENGTH)


@contextmanager
def precise() -> Iterator[None]:
    """Within, balls have BITS bits, and series SERIES_LENGTH terms."""
    terms = ctx.cap
    try:
        ctx.cap = SERIES_LENGTH
        with ctx.workprec(BITS):
            yield
    finally:
        ctx.cap = terms


def horner(coefficients: Sequence[Number], x: Number) -> Number:
    """The polynomial with these coefficients, constant term first, at x."""
    total = coefficients[-1]
    for c in coefficients[-2::-1]:
        total = total * x + c
    return total


def inverse(m: Entries) -> Entries:
    """The inverse matrix."""
    qq, qv, vq, vv = m
    determinant = qq * vv - qv * vq
    return vv / determinant, -qv / determinant, -vq / determinant, qq / determinant


def identity(arithmetic: Arithmetic) -> Entries:
    """The matrix of no step at all."""
    one, zero = arithmetic.number(Fraction(1)), arithmetic.number(Fraction(0))
    return one, zero, zero, one
