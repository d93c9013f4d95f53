"""A vector field for the loops over numbers: f and its derivatives, written into rows, in Python or compiled."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from functools import cache
from math import prod

from driftproof.methods.formulas.vector_fields import VectorField, partial_derivative
from driftproof.methods.programs.program_text import indented, maker_text
from driftproof.numeric.steps.elimination import FULL, Band
from driftproof.numeric.steps.engine import program_function
from driftproof.numeric.steps.loops import FieldWriters, RateWriter, allocators, loop

# Systems of at least LOOPED components are written in loops, with periods of at most LONGEST_PERIOD components; chosen:
# shorter systems compile fast as they stand.
LOOPED, LONGEST_PERIOD = 24, 4


@cache
def field_writers(field: VectorField, *, compiled: bool) -> FieldWriters:
    """Return functions that write f and its derivatives, from exact formulas, into the rows that they are given.

    The rows of derivatives are a band if the text of the field shows one that saves enough work.
    """
    reads = field.dependence()
    band = band_of(reads)
    rates = [[f"last[{{i}}] = {rate}"] for rate in field.rates]
    derivatives = [
        [f"last[{{i}}][{_column(i, j, band)}] = {partial_derivative(rate, f'y{j}')}" for j in sorted(read)]
        for i, (rate, read) in enumerate(zip(field.rates, reads, strict=True))
    ]
    rate, jacobian = (loop(_writer(field, lines), compiled=compiled) for lines in (rates, derivatives))
    return FieldWriters(rate, jacobian, band, *allocators(compiled=compiled))


def _column(i: int, j: int, band: Band) -> str:
    """The index of column j in row i as text, where {i} stands for the number i."""
    return f"{{i}}{j - i:+d}" if band == FULL else str(j - max(0, i - band.lower))


def band_of(reads: Sequence[Collection[int]]) -> Band:
    """The band of a matrix whose row i has entries in the columns `reads[i]`; FULL unless the band saves much work.

    Elimination takes about (lower + upper)² n operations in a band, and n³/3 without one.
    """
    lower, upper = (max((0, *(sign * (i - j) for i, row in enumerate(reads) for j in row))) for sign in (1, -1))
    return Band(lower, upper) if 2 * (2 * lower + upper + 1) <= len(reads) else FULL


def _writer(field: VectorField, rows: Sequence[Sequence[str]]) -> RateWriter:
    """Build run(t, y, last) from the lines in `rows`, listed by component, where {i} stands for its number.

    The local names in it are those that no parameter may have. Rows that repeat with the indices shifted become loops,
    because a compiler would take minutes for a thousand rows.
    """
    names = [name for name, _ in field.parameters]
    if len(rows) < LOOPED or any(re.fullmatch(r"y\d+", name) for name in names):
        body = [f"{name} = y[{i}]" for i, name in enumerate(field.components)]
        body += [line.format(i=i) for i, lines in enumerate(rows) for line in lines]
    else:
        body = list(_looped(rows))
    text = maker_text(names, "run", ["def run(t, y, last):", *indented(body or ["pass"])])
    return program_function(text, "field", field.parameters)


def _looped(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of all components as loops over periods of up to LONGEST_PERIOD components."""
    relative = [[_shifted(line, i, 0) for line in lines] for i, lines in enumerate(rows)]
    at = 0
    while at < len(rows):
        period, times = max(((p, _repeated(relative, at, p)) for p in range(1, LONGEST_PERIOD + 1)), key=prod)
        period = period if times > 1 else 1
        yield f"for i in range({at}, {at + period * times}, {period}):"
        lines = [_shifted(line, at + k, k) for k in range(period) for line in rows[at + k]]
        yield from indented(lines or ["pass"])
        at += period * times


def _repeated(relative: Sequence[Sequence[str]], at: int, period: int) -> int:
    """How often the rows from `at` on repeat with that period, counting the first time."""
    end = at + period
    while end < len(relative) and relative[end] == relative[end - period]:
        end += 1
    return (end - at) // period


def _shifted(line: str, component: int, place: int) -> str:
    """The line of a component with i in place of its number minus its place in the period."""
    near = re.sub(r"\by(\d+)\b", lambda found: f"y[i{int(found[1]) - component + place:+d}]", line)
    return near.replace("{i}", f"i + {place}" if place else "i")
