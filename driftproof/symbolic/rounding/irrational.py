"""Real numbers that are known exactly, between rationals: how an irrational coefficient enters a rounding bound."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from driftproof.methods.number_field import Algebraic, Exact
from driftproof.symbolic.rounding.formats import exponent, power_of_two

# The ends of an irrational x are apart by at most this power of two times |x|: bounds are quoted to far fewer digits.
GUARD_BITS = 128


@lru_cache(maxsize=1 << 12)
def ends(x: Exact) -> tuple[Fraction, Fraction]:
    """Rationals low <= x <= high, at most 2**-GUARD_BITS |x| apart; both are x where it is rational."""
    if not isinstance(x, Algebraic):
        return x, x
    if x.is_rational:
        return x.as_fraction(), x.as_fraction()
    bits = 2 * GUARD_BITS
    while True:
        low, high = x.enclosure(bits)
        if low * high > 0:
            # At most three units apart after rounding outwards, and |x| >= 2**exponent - unit.
            unit = power_of_two(exponent(high) - GUARD_BITS - 2)
            if high - low <= unit:
                return low // unit * unit, -(-high // unit) * unit
        bits *= 2


def above(x: Exact) -> Fraction:
    """A rational at or just above x."""
    return ends(x)[1]


def size(x: Exact) -> Exact:
    """|x|."""
    return -x if x < 0 else x


def middle_and_radius(x: Exact) -> tuple[Fraction, Fraction]:
    """A rational m and an r >= 0 with |x - m| <= r; x itself and 0 where it is rational."""
    low, high = ends(x)
    return (low + high) / 2, (high - low) / 2
