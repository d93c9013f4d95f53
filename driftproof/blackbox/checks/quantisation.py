"""Numbers that a rule has rounded: to whole numbers, decimals, multiples of a power of two, or narrower floats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from driftproof.support.plain_text import counted
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, FloatFormat

# No decimals from here on are looked for: numbers of size 1000 have no more after the point.
_DECIMALS = 12
# With numbers down to 1/1000, more bits after the point than this are not those of a fixed point.
_FIXED_POINT = 40
# Floats have nearly all bits of their format as a rule, fixed-point numbers as many as fit: the last five bits of one
# float in 32 are 0 by chance.
_BITS_TO_SPARE = 5
# From here on all floats are whole numbers, in binary32 already.
_ALL_WHOLE = 2.0**23


@dataclass(frozen=True)
class Quantisation:
    """A rule that rounds: the spacing of its numbers, and the rule in words."""

    size: float
    words: str


def quantisation_of(numbers: Sequence[float]) -> Quantisation | None:
    """The coarsest spacing that all numbers are multiples of; None if there is none, as for plain floats."""
    if not (numbers := [x for x in numbers if abs(x) < _ALL_WHOLE]):
        return None
    if all(x.is_integer() for x in numbers):
        return Quantisation(1.0, "answers are whole numbers")
    decimals = next((k for k in range(1, _DECIMALS) if all(round(x, k) == x for x in numbers)), None)
    if decimals is not None:
        return Quantisation(10.0**-decimals, f"answers are rounded to {counted(decimals, 'decimal')}")
    last = max(Fraction(x).denominator.bit_length() - 1 for x in numbers)  # bits after the point
    bits = sorted(significant_bits(x) for x in numbers if x)
    # Of floats, three in four have nearly as many bits as the longest.
    if last <= _FIXED_POINT and bits[len(bits) // 4] < bits[-1] - _BITS_TO_SPARE:
        return Quantisation(2.0**-last, f"answers are multiples of 2**-{last}")
    return None


def narrow_format(numbers: Sequence[float]) -> FloatFormat | None:
    """The narrowest format up to binary32 that holds all of these; None if none does, or if a coarser rule does."""
    if quantisation_of(numbers) is not None:
        return None
    widest = max(map(significant_bits, numbers))
    return next((fmt for fmt in (BINARY16, BINARY32) if widest <= fmt.precision), None)


def significant_bits(x: float) -> int:
    """The number of bits from the first to the last that is 1; 0 for 0."""
    n = abs(Fraction(x).numerator)
    return (n // (n & -n)).bit_length() if n else 0
