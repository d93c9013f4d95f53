"""Coefficients read from float code: how far one is from an exact number, and which fraction it stands for."""

from __future__ import annotations

from fractions import Fraction

from driftproof.blackbox.probes.simple_rationals import simple_rational
from driftproof.methods.number_field import Exact
from driftproof.symbolic.algebra.certified import settle
from driftproof.symbolic.rounding.formats import FloatFormat, exponent, power_of_two

# An exact number longer than this is shown as a decimal.
LONGEST_SHOWN = 24


def is_nearest(x: float, exact: Exact, fmt: FloatFormat) -> bool:
    """True when x is the number of the format nearest to `exact`: correctly rounded."""
    return bool(settle(exact, fmt.nearest) == Fraction(x))


def half_spacing(x: float, fmt: FloatFormat) -> Fraction:
    """How far the numbers that the format rounds to x may be from it: u times the power of two below |x|, at least."""
    return power_of_two(max(exponent(Fraction(x)), fmt.emin) - fmt.precision) if x else Fraction(0)


def shown(x: float, fmt: FloatFormat, slack: float = 0.0) -> str:
    """The fraction that x is the rounding of, as "1/3", if that is no coincidence; else its shortest decimals.

    With `slack`, the fraction may be so much farther away: of a number that was not read but computed.
    """
    fraction = simple_rational(x, half_spacing(x, fmt) + Fraction(slack))
    return repr(x) if fraction is None else str(fraction)


def exact_shown(exact: Exact) -> str:
    """The exact number as it is written; a long one as a decimal."""
    text = str(exact)
    return text if len(text) <= LONGEST_SHOWN else repr(float(exact))


def difference(name: str, seen: float, exact: Exact, fmt: FloatFormat, slack: float = 0.0) -> str:
    """One coefficient that is not what it should be, in words."""
    return f"{name}: {shown(seen, fmt, slack)} instead of {exact_shown(exact)}"
