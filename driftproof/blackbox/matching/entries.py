"""Differences between a tableau read and the one claimed: entries and row sums."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from driftproof.blackbox.matching.tables import exact_tableau, induced_by_tableau
from driftproof.blackbox.probes.coefficients import (
    coefficient_difference,
    coefficient_text,
    exact_shown,
    simple_rational,
)
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.questions import CoefficientReading
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.support.plain_text import counted, table

# Chosen: the most entries that are shown in a table; further ones are only counted.
_MOST_SHOWN = 12


def side_by_side(reading: CoefficientReading, method: RungeKutta | Collocation) -> list[str]:
    """The entries that differ, claimed and read, as a table; then the rows of the A read that do not sum to their c."""
    if reading.calls != method.stages:
        return [f"{method.key} has {counted(method.stages, 'stage')}, {reading.calls} read"]
    rounding, fmt = reading.rounding, reading.format
    full = reading.implicit or not method.explicit
    if isinstance(reading, ForceReading):
        stages, _ = induced_by_tableau(exact_tableau(method))
        weights = {"b_position": reading.b_position, "b_velocity": reading.b_velocity}
        claimed = _entries(stages.a, dict(zip(weights, stages.weights, strict=True)), stages.c, full=full)
    else:
        a, b, c = exact_tableau(method)
        weights, claimed = {"b": reading.b}, _entries(a, {"b": b}, c, full=full)
    read = _entries(reading.a, weights, reading.c or (), full=full)
    rows = [["entry", "claimed", "read", "difference"]]
    for (name, exact), (_, seen) in zip(claimed, read, strict=False):
        off = float(seen) - float(exact)
        if abs(off) > rounding.of(max(1.0, abs(float(exact)))):
            rows.append([name, exact_shown(exact), coefficient_text(float(seen), fmt, rounding.besides), f"{off:.3g}"])
    shown = table(rows[: _MOST_SHOWN + 1], right=(3,)).splitlines() if len(rows) > 1 else []
    more = [f"and {len(rows) - 1 - _MOST_SHOWN} more"] if len(rows) > _MOST_SHOWN + 1 else []
    return [*shown, *more, *(_row_sums(reading, rounding) if isinstance(reading, TableauReading) else [])]


def other_velocities(method: RungeKutta, reading: ForceReading) -> list[str]:
    """The wrong entries in the velocities of the stages, as text, or one line that says what else is wrong."""
    rows, rounding = reading.a_velocity or (), reading.rounding
    if len(rows) != method.stages:
        return [f"the velocities passed to its force are not those of the stages of {method.key}"]
    return [
        f"the velocity of call {i} holds {coefficient_difference(f'F[{j}]', x, method.a[i][j], reading.format)}"
        for i, row in enumerate(rows)
        for j, x in enumerate(row if reading.implicit else row[:i])
        if abs(x - float(method.a[i][j])) > rounding.of(1 + abs(x))
    ] or [f"given its velocities, its positions are not those of the stages of {method.key}"]


def _entries(
    a: Sequence[Sequence[Any]], weights: Mapping[str, Sequence[Any]], c: Sequence[Any], *, full: bool
) -> list[tuple[str, Any]]:
    """The entries of A (if not `full`, only those below the diagonal), of the weights and of c, with their names."""
    below = [(f"a[{i}][{j}]", x) for i, row in enumerate(a) for j, x in enumerate(row if full else row[:i])]
    return [*below, *((f"{name}[{i}]", x) for name, row in {**weights, "c": c}.items() for i, x in enumerate(row))]


def _row_sums(reading: TableauReading, rounding: Rounding) -> list[str]:
    lines = []
    for i, (row, time) in enumerate(zip(reading.a, reading.c or (), strict=False)):
        total = sum(map(Fraction, row), Fraction(0))
        if abs(total - Fraction(time)) > Fraction(rounding.of(sum(map(abs, row)) + abs(time))):
            texts = (coefficient_text(float(x), reading.format, rounding.besides) for x in (total, time))
            lines.append("row {} of A sums to {}, its time c is {}".format(i, *texts))
    return lines


def rational_method(reading: TableauReading, key: str) -> RungeKutta | None:
    """The method read, if every entry of A and b is the rounding of a simple rational, else None; c holds row sums."""
    rounding = reading.rounding

    def exact(x: float) -> Fraction | None:
        return Fraction(x) if x == int(x) else simple_rational(x, rounding.of(abs(x)))

    *a, b = (tuple(x for x in map(exact, row) if x is not None) for row in (*reading.a, reading.b))
    if any(len(row) < reading.calls for row in (*a, b)):
        return None
    return RungeKutta(key, key, 0, "", tuple(a), b, tuple(sum(row, Fraction(0)) for row in a))
