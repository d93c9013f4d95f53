"""Published values that have no exact form, as answers: what their decimals say, and no digit more."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from flint import arb, ctx, fmpq

from driftproof.symbolic.algebra.certified import FIRST_BITS
from driftproof.texts.questions.value import Value


def as_printed(entry: dict[str, Any]) -> Value:
    """The number known only by its decimal, correctly rounded: it lies within half a unit of the last digit.

    Digits beyond it raise ValueError.
    """
    mantissa, _, exponent = entry["decimal"].partition("e")
    places = len(mantissa.partition(".")[2]) - int(exponent or 0)
    middle, half = Fraction(entry["decimal"]), Fraction(1, 2) * Fraction(10) ** -places

    def enclosure() -> arb:
        if ctx.prec > FIRST_BITS:
            raise ValueError(f"its decimal is published as {entry['decimal']}, which does not decide more digits")
        low, high = (arb(fmpq(x.numerator, x.denominator)) for x in (middle - half, middle + half))
        return low.union(high)

    return Value("", enclosure, entry["evidence"])
