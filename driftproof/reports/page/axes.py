"""Axes: round limits, few round ticks with exact labels, and exact scales from numbers to places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from math import ceil, floor, log10

# Mantissas of the distances between ticks, and of the ends of a symmetric axis; each is at most twice the one before.
STEPS = (1, 2, 4, 5)
LIMITS = tuple(Fraction(m, 4) for m in (4, 5, 6, 8, 10, 12, 16, 20, 24, 32))
FEWEST_TICKS = 3
# Numbers of these decades are written out, others with a power of ten.
PLAIN = range(-4, 6)
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Scale:
    """The affine map of [low, high] to [start, end], exact; `start` is beyond `end` where the axis points up."""

    low: Fraction
    high: Fraction
    start: Fraction
    end: Fraction

    @cached_property
    def per_unit(self) -> Fraction:
        """The signed length of one unit of the axis."""
        return (self.end - self.start) / (self.high - self.low)

    def __call__(self, x: float | Fraction) -> Fraction:
        """The place of x. Raises OverflowError or ValueError for a float that is not finite."""
        return self.start + (Fraction(x) - self.low) * self.per_unit


def decade(x: Fraction) -> int:
    """The largest e with 10ᵉ <= x, for x > 0."""
    e = floor(log10(x.numerator) - log10(x.denominator))  # off by one at most: log10 of whole numbers has no overflow
    while Fraction(10) ** (e + 1) <= x:
        e += 1
    while Fraction(10) ** e > x:
        e -= 1
    return e


def symmetric_limit(largest: Fraction) -> Fraction:
    """The least m 10ᵏ, m in LIMITS, a twentieth or more beyond `largest`: the end of an axis from -L to L, 1 for 0.

    LIMITS grow by a third at most, so L <= 4/3 · 21/20 · largest: what is drawn reaches over 5/7 of the axis or more.
    """
    if largest == 0:
        return Fraction(1)
    wanted = largest * Fraction(21, 20)
    power = Fraction(10) ** decade(wanted)
    return next((m * power for m in LIMITS if m * power >= wanted), 10 * power)


def ticks(low: Fraction, high: Fraction) -> list[Fraction]:
    """The multiples in [low, high] of the coarsest m 10ᵏ, m in STEPS, of which there are at least FEWEST_TICKS.

    There are at most 6: the next coarser step is at most twice as long, and fewer than three of its multiples fit.
    Raises ValueError for an interval without length.
    """
    if not low < high:
        raise ValueError(f"an axis from {low} to {high} has no length")
    for step in _steps_down(high - low):
        found = [i * step for i in range(ceil(low / step), floor(high / step) + 1)]
        if len(found) >= FEWEST_TICKS:
            return found
    raise AssertionError("three multiples of s fit into an interval of length 3 s")


def _steps_down(span: Fraction) -> Iterator[Fraction]:
    power = Fraction(10) ** decade(span)
    while True:
        yield from (m * power for m in reversed(STEPS))
        power /= 10


def label(x: Fraction) -> str:
    """x in full, plain in ordinary decades, else like 4·10⁷. For decimals of at most 28 digits, which ticks are."""
    if x == 0:
        return "0"
    e = decade(abs(x))
    if e in PLAIN:
        return _decimal(x)
    mantissa = _decimal(x / Fraction(10) ** e)
    return ten_to(e) if mantissa == "1" else f"{mantissa}·{ten_to(e)}"


def ten_to(exponent: int) -> str:
    """10ᵉ as text; 1 for e = 0."""
    return f"10{str(exponent).translate(SUPERSCRIPTS)}" if exponent else "1"


def _decimal(x: Fraction) -> str:
    return f"{Decimal(x.numerator) / Decimal(x.denominator):f}".replace("-", "−")
