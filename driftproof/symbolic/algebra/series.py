"""Truncated power series over any exact field: lists of coefficients, constant term first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from flint import fmpq

from driftproof.symbolic.algebra.polynomials import Scalar, dot
from driftproof.symbolic.algebra.rational_functions import RationalFunction

Series: TypeAlias = list[Scalar]


def expand(f: RationalFunction, terms: int) -> Series:
    """The first `terms` Taylor coefficients of f at 0. Raises ZeroDivisionError where 0 is a pole."""
    return divide(_padded(f.num.coeffs(), terms), _padded(f.den.coeffs(), terms))


def exponential(terms: int) -> Series:
    """1, 1, 1/2, 1/6, ...: the Taylor coefficients of exp."""
    coefficients = [fmpq(1)]
    for k in range(1, terms):
        coefficients.append(coefficients[-1] / k)
    return coefficients[:terms]


def multiply(a: Series, b: Series) -> Series:
    """The product, to the length of a."""
    b = _padded(b, len(a))
    return [dot(a[: k + 1], b[k::-1]) for k in range(len(a))]


def divide(a: Series, b: Series) -> Series:
    """The quotient, to the length of a. Raises ZeroDivisionError where b(0) = 0."""
    b = _padded(b, len(a))
    inverse, result = 1 / b[0], []  # type: tuple[Scalar, Series]
    for k, c in enumerate(a):
        result.append((c - dot(result, b[k:0:-1])) * inverse)
    return result


def logarithm(a: Series) -> Series:
    """log a, for a(0) = 1: from a' = a (log a)'. Raises ValueError for another constant term."""
    _demand_one(a)
    slope: Series = []  # the coefficients k lₖ of z (log a)'
    for k, c in enumerate(a):
        slope.append(c * k - dot(slope, a[k:0:-1]))
    return [c / k if k else c for k, c in enumerate(slope)]


def square_root(a: Series) -> Series:
    """The root with constant term 1, for a(0) = 1. Raises ValueError for another constant term."""
    _demand_one(a)
    result: Series = [fmpq(1)]
    for k in range(1, len(a)):
        result.append((a[k] - dot(result[1:], result[:0:-1])) / 2)
    return result[: len(a)]


def integral(a: Series) -> Series:
    """The antiderivative that vanishes at 0, one term longer."""
    return [fmpq(0), *(c / (k + 1) for k, c in enumerate(a))]


def derivative(a: Series) -> Series:
    """The derivative, one term shorter."""
    return [c * k for k, c in enumerate(a)][1:]


def _padded(a: Sequence[Scalar], terms: int) -> Series:
    return [*a[:terms], *[fmpq(0)] * (terms - len(a))]


def _demand_one(a: Series) -> None:
    if not a or a[0] != 1:
        raise ValueError("the constant term must be 1")
