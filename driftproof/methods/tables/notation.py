"""Tables written as they are printed: rows of exact numbers in a text, zeros at the end of a row left out."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from driftproof.methods.number_field import Exact


def row(text: str) -> tuple[Fraction, ...]:
    """The numbers of the text, which white space separates; "1/6", "0.1" and "2.5e-1" are exact, as everywhere."""
    return tuple(Fraction(word) for word in text.split())


def square(text: str) -> tuple[tuple[Exact, ...], ...]:
    """As many rows as the text has lines, each filled up with zeros to that length."""
    return padded(*(row(line) for line in text.strip().splitlines()))


def numbers(*values: Exact | int) -> tuple[Exact, ...]:
    """The values, integers among them as fractions: for rows in which irrational numbers occur."""
    return tuple(Fraction(x) if isinstance(x, int) else x for x in values)


def padded(*rows: Sequence[Exact | int]) -> tuple[tuple[Exact, ...], ...]:
    """The rows, each filled up with zeros to as many entries as there are rows."""
    return tuple(numbers(*given, *[0] * (len(rows) - len(given))) for given in rows)


def places(stages: int, **entries: str) -> tuple[Fraction, ...]:
    """The row that is zero but for entries such as k7="1/3", counted from 1."""
    filled = [Fraction(0)] * stages
    for name, text in entries.items():
        filled[int(name.removeprefix("k")) - 1] = Fraction(text)
    return tuple(filled)
