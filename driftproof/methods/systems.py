"""Linear systems z' = Az from users' text, exact."""

from __future__ import annotations

from fractions import Fraction
from typing import TypeAlias

from driftproof.methods.expressions import parse_number

LARGEST_SYSTEM = 12

# The rows of A.
System: TypeAlias = tuple[tuple[Fraction, ...], ...]


def parse_system(text: str) -> System:
    """The square matrix A that `text` spells, e.g. "0 1; -1 -1/10": rows by ";", entries by blanks or by ",".

    An entry is an expression in rational numbers, such as -1/10, 0.1 or, between commas also with blanks, 2*(3 + 1).
    Parsed, never evaluated. Raises ValueError in one line that names the place.
    """
    rows = [line.split(",") if "," in line else line.split() for line in text.strip().removesuffix(";").split(";")]
    if len(rows) > LARGEST_SYSTEM:
        raise ValueError(f"the system has {len(rows)} rows; at most {LARGEST_SYSTEM} are read")
    for i, row in enumerate(rows, 1):
        if len(row) != len(rows):
            raise ValueError(f"the system is not square: row {i} of {len(rows)} has {len(row)} entries")
    return tuple(tuple(_entry(x, f"row {i}, entry {j}") for j, x in enumerate(row, 1)) for i, row in enumerate(rows, 1))


def _entry(text: str, where: str) -> Fraction:
    value = parse_number(text, where)
    if not isinstance(value, Fraction):
        raise ValueError(f"{where}: {value} is irrational; the entries of a system are rational")
    return value
