"""Decimals of exact numbers: named rounding policies, refusal of ties, and the style of signs and exponents.

>>> from driftproof import PRINTED
>>> PRINTED.written("-6.7e-5")
'−6.7×10⁻⁵'
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from driftproof.symbolic.algebra.certified import CertifiableReal

HYPHEN, MINUS = "-", "\N{MINUS SIGN}"
E, TIMES_TEN = "e", "×10"
HALF_EVEN, HALF_AWAY, AWAY = "half-even", "half-away", "away"
SIGNIFICANT, FIXED = "significant", "fixed"
ROUNDING_POLICIES = (HALF_EVEN, HALF_AWAY, AWAY)
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


@dataclass(frozen=True)
class Style:
    """A style of decimals: `rounding`, one of ROUNDING_POLICIES or None; `minus`, "-" or "−"; `exponent`, "e" or "×10".

    The policies half-even and half-away round to the nearest decimal and differ on ties; away rounds every number away
    from 0. With None the rounding is half-even and a tie is refused. Raises ValueError for other names.

    >>> from driftproof import Style, value
    >>> value("1/8").places(2, Style("half-away"))
    '0.13'
    """

    rounding: str | None = None
    minus: str = HYPHEN
    exponent: str = E

    def __post_init__(self) -> None:
        """Raise ValueError for an unknown name."""
        allowed = {"rounding": ROUNDING_POLICIES, "minus": (HYPHEN, MINUS), "exponent": (E, TIMES_TEN)}
        for what, names in allowed.items():
            if (chosen := getattr(self, what)) not in names and (what, chosen) != ("rounding", None):
                raise ValueError(f"{what}: {chosen!r} is unknown; choose one of {', '.join(names)}")

    def written(self, decimal: str) -> str:
        """A decimal such as "-6.7e-5" in this style, e.g. "−6.7×10⁻⁵"."""
        mantissa, _, exponent = decimal.partition("e")
        mantissa = mantissa.replace(HYPHEN, self.minus)
        if not exponent:
            return mantissa
        if self.exponent == E:
            return f"{mantissa}e{exponent.replace(HYPHEN, self.minus)}"
        return f"{mantissa}×10{exponent.translate(_SUPERSCRIPTS)}"


PLAIN = Style()
PRINTED = Style(minus=MINUS, exponent=TIMES_TEN)


class Tie(ValueError):
    """A number half-way between two decimals, for which no rounding policy was named."""


def rounded(x: CertifiableReal, form: str, count: int, style: Style) -> str:
    """x to `count` SIGNIFICANT digits or FIXED places, by the style's policy.

    Raises ValueError for too small a count, Tie, and Uncertified.
    """
    from driftproof.symbolic.algebra import certified

    write = certified.fixed if form == FIXED else certified.significant
    if style.rounding is not None:
        return style.written(write(x, count, style.rounding))
    even = write(x, count, HALF_EVEN)
    # Irrational numbers are never ties; an enclosed rational one on a tie has already raised Uncertified.
    if isinstance(x, Fraction) and even != (away := write(x, count, HALF_AWAY)):
        raise Tie(f"the number is a tie: half-even gives {even}, half-away {away}; choose a rounding")
    return style.written(even)
