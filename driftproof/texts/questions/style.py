"""How a decimal is written: the rounding policy by name, the sign, the exponent."""

from __future__ import annotations

from dataclasses import dataclass

HYPHEN, MINUS = "-", "\N{MINUS SIGN}"
E, TIMES_TEN = "e", "×10"
HALF_EVEN, HALF_AWAY, TOFIXED, AWAY = "half-even", "half-away", "tofixed", "away"
ROUNDINGS = (HALF_EVEN, HALF_AWAY, TOFIXED, AWAY)
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


@dataclass(frozen=True)
class Style:
    """`rounding`, one of ROUNDINGS or None for none named; `minus`, "-" or "−"; `exponent`, "e" or "×10".

    half-even and half-away round to the nearest decimal and differ on ties, away rounds every number away from 0, and
    tofixed does what JavaScript's toFixed and toPrecision do: it rounds the binary64 number nearest to the exact
    value, a tie away from 0. With None the rounding is half-even, and a tie is refused. Raises ValueError for others.
    """

    rounding: str | None = None
    minus: str = HYPHEN
    exponent: str = E

    def __post_init__(self) -> None:
        """Refuse unknown names."""
        for what, chosen, allowed in (
            ("rounding", self.rounding, (None, *ROUNDINGS)),
            ("minus", self.minus, (HYPHEN, MINUS)),
            ("exponent", self.exponent, (E, TIMES_TEN)),
        ):
            if chosen not in allowed:
                names = ", ".join(name for name in allowed if name is not None)
                raise ValueError(f"{what}: {chosen!r} is unknown; choose one of {names}")

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
