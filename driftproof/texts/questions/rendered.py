"""An answer as the command line prints it: a bare number where digits are asked for, else all that is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

from driftproof.support.plain_text import as_json
from driftproof.texts.questions.style import AWAY, HALF_EVEN, Style
from driftproof.texts.questions.value import Value
from driftproof.texts.writing.text import LONGEST_SHOWN

# Of a decimal that nobody asked for.
DIGITS = 15


@dataclass(frozen=True)
class Wish:
    """What is asked for: significant digits, or places after the point, or neither; and the style."""

    digits: int | None
    places: int | None
    style: Style

    @property
    def names_a_length(self) -> bool:
        """True where digits or places are asked for."""
        return self.digits is not None or self.places is not None


def rendered(value: Value, wish: Wish, form: str) -> str:
    """The answer in one of FORMATS. Raises what the methods of Value raise."""
    return FORMATS[form](value, wish)


def _decimal(value: Value, wish: Wish) -> str:
    if wish.places is not None:
        return value.places(wish.places, wish.style)
    if wish.digits is not None:
        return value.digits(wish.digits, wish.style)
    return value.digits(DIGITS, replace(wish.style, rounding=_policy(value, wish)))


def _policy(value: Value, wish: Wish) -> str:
    """The rounding that is used; a tie under half-even is an error only where digits are asked for."""
    return wish.style.rounding or (AWAY if value.is_bound else HALF_EVEN)


def _as_text(value: Value, wish: Wish) -> str:
    """The number; without a length asked for also its unit, its exact form where it is short, and the evidence."""
    if wish.names_a_length:
        return _decimal(value, wish)
    exact = value.exact_text
    if not value.is_number or (isinstance(value.exact, Fraction) and value.exact.denominator == 1):
        shown, exact = wish.style.written(str(exact)) if value.is_number else str(exact), None
    else:
        shown = _decimal(value, wish)
    unit = f" {value.unit}" if value.unit else ""
    exactly = f", exactly {exact}" if exact and len(exact) <= LONGEST_SHOWN else ""
    return f"{shown}{unit}{exactly}  ({value.evidence})"


def _as_markdown(value: Value, wish: Wish) -> str:
    """The number; without a length asked for, the exact form in TeX."""
    return _decimal(value, wish) if wish.names_a_length else f"${value.tex()}$"


def _as_json(value: Value, wish: Wish) -> str:
    return as_json(
        {
            "question": value.question,
            "exact": value.exact_text,
            "decimal": _decimal(value, wish) if value.is_number or wish.names_a_length else None,
            "rounding": _policy(value, wish),
            "unit": value.unit,
            "evidence": value.evidence,
        }
    )


FORMATS: dict[str, Callable[[Value, Wish], str]] = {
    "text": _as_text,
    "json": _as_json,
    "tex": lambda value, wish: value.tex(digits=wish.digits, places=wish.places, style=wish.style),
    "mathml": lambda value, wish: value.mathml(digits=wish.digits, places=wish.places, style=wish.style),
    "md": _as_markdown,
}
