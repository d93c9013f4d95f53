"""Polynomials with rational coefficients, constant term first: division, Sturm's count of real roots."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import pairwise
from math import gcd, lcm
from typing import TypeAlias

# Coefficients of a polynomial over Q, constant term first, no trailing zero; () is zero.
Polynomial: TypeAlias = tuple[Fraction, ...]
Coefficients: TypeAlias = Sequence[Fraction | int]


def trimmed(coefficients: Coefficients) -> Polynomial:
    """The same polynomial without trailing zeros, its coefficients as fractions."""
    end = len(coefficients)
    while end and not coefficients[end - 1]:
        end -= 1
    return tuple(Fraction(x) for x in coefficients[:end])


def product(a: Coefficients, b: Coefficients) -> Polynomial:
    """a b."""
    result = [Fraction(0)] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] += x * y
    return trimmed(result)


def divide(a: Coefficients, b: Coefficients) -> tuple[Polynomial, Polynomial]:
    """Quotient and remainder of a by b; b is trimmed and not zero."""
    rest, quotient = [Fraction(x) for x in a], [Fraction(0)] * max(len(a) - len(b) + 1, 0)
    for i in reversed(range(len(quotient))):
        factor = quotient[i] = rest[i + len(b) - 1] / b[-1]
        for j, y in enumerate(b):
            rest[i + j] -= factor * y
    return trimmed(quotient), trimmed(rest)


def derivative(a: Coefficients) -> Polynomial:
    """a'."""
    return trimmed([k * Fraction(x) for k, x in enumerate(a)][1:])


def value_at(a: Coefficients, x: Fraction) -> Fraction:
    """a(x), by Horner's rule."""
    value = Fraction(0)
    for coefficient in reversed(a):
        value = value * x + coefficient
    return value


def primitive(a: Coefficients) -> tuple[int, ...]:
    """The positive rational multiple of a with coprime integer coefficients; () for zero."""
    fractions = trimmed(a)
    common = lcm(*(x.denominator for x in fractions))
    integers = [int(x * common) for x in fractions]
    content = gcd(*integers) or 1
    return tuple(x // content for x in integers)


def sturm_chain(a: Coefficients) -> list[tuple[int, ...]]:
    """a, a', and on, each the negative remainder of the two before it, up to positive factors (sturm-1835)."""
    chain = [primitive(a), primitive(derivative(a))]
    while chain[-1]:
        chain.append(primitive([-x for x in divide(chain[-2], chain[-1])[1]]))
    return chain[:-1]


def is_square_free(a: Coefficients) -> bool:
    """True when a, which is not zero, has no multiple root, real or complex."""
    return len(sturm_chain(a)[-1]) == 1


def real_roots_between(a: Coefficients, low: Fraction, high: Fraction) -> int:
    """The number of distinct real roots in (low, high], where neither end is a multiple root, by Sturm's theorem."""
    chain = sturm_chain(a)
    below, above = ([value_at(p, x) for p in chain] for x in (low, high))
    return _sign_changes(below) - _sign_changes(above)


def count_real_roots(a: Coefficients) -> int:
    """The number of distinct real roots of a polynomial that is not constant, by Sturm's theorem at -oo and oo."""
    chain = sturm_chain(a)
    below = [p[-1] * (-1) ** (len(p) - 1) for p in chain]
    return _sign_changes(below) - _sign_changes([p[-1] for p in chain])


def _sign_changes(values: Iterable[Fraction | int]) -> int:
    return sum(x * y < 0 for x, y in pairwise(x for x in values if x))
