"""Rational numbers as FLINT's and back, and the ends of its balls: exact, whatever the precision.

FLINT is loaded with the first of them.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import arb, fmpq


def as_fmpq(x: object) -> fmpq:
    """An integer, Fraction or fmpq as an fmpq, FLINT's rational number. Raises TypeError for anything else.

    >>> as_fmpq(Fraction(2, 6))
    1/3
    """
    import flint  # faster than `from flint import fmpq`, which counts in a function that is called so often

    if isinstance(x, flint.fmpq):
        return x
    if isinstance(x, int | Fraction) and not isinstance(x, bool):
        return flint.fmpq(x.numerator, x.denominator)
    raise TypeError(f"{x!r} ({type(x).__name__}) is not rational; exact arithmetic takes int or Fraction")


def as_fraction(x: fmpq) -> Fraction:
    """FLINT's rational number as a Fraction."""
    return Fraction(int(x.p), int(x.q))


def dyadic(exact_ball: arb) -> Fraction:
    """The exact value of a ball of radius 0."""
    return as_fraction(exact_ball.fmpq())


def ends_of(ball: arb) -> tuple[Fraction, Fraction]:
    """The lower and the upper end of a ball, exactly."""
    middle, radius = dyadic(ball.mid()), dyadic(ball.rad())
    return middle - radius, middle + radius
