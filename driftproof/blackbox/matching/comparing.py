"""Comparison of a coefficient table read from floats with an exact one: equal up to rounding, how far off, or where."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil
from typing import NamedTuple

import numpy as np

from driftproof.blackbox.matching.candidates import ExactTable
from driftproof.blackbox.matching.tables import Array, BoundedCoefficient
from driftproof.blackbox.probes.coefficients import is_nearest
from driftproof.blackbox.probes.scripted_answers import Rounding


class CoefficientPlace(NamedTuple):
    """One coefficient in both tables: its name, the float read, and the exact number with the size of its terms.

    `scale` is the size that its rounding error may scale with: that of the largest number in its column; for a node,
    that of the largest node or of the drift; for the drift, its own.
    """

    name: str
    seen: float
    exact: BoundedCoefficient
    scale: float


class Distance(NamedTuple):
    """The largest distances in units of u: relative to the coefficient's own terms, and to its `scale`.

    `farthest` names the coefficient that has the second.
    """

    of_terms: int
    of_column: int
    farthest: str


@dataclass(frozen=True)
class Comparison:
    """A table read from floats, an exact one with as many stages, and the roundings that the program may have made.

    Two coefficients count as equal if they differ by at most that many roundings of the largest number in their
    column. A code that forms its coefficients as sums, in low storage or as convex combinations, is thus recognised.
    """

    read: ExactTable
    exact: ExactTable
    rounding: Rounding

    def arrangement(self) -> tuple[int, ...] | None:
        """For each stage read, the exact stage with equal coefficients; None if no order of the stages fits."""
        read, exact, allowed = self._in_floats
        if self._same_drift and (np.abs(read - exact) <= allowed).all():
            return tuple(range(self.read.calls))
        return next(self._extended(()), None) if self._same_drift else None

    def differences(self) -> list[CoefficientPlace]:
        """The coefficients that differ, with the stages of both tables in the order in which they stand."""
        read, exact, allowed = self._in_floats
        rows, columns = np.nonzero(np.abs(read - exact) > allowed)  # fast, as there are many candidates
        wrong = {self._name(i, j) for i, j in zip(rows.tolist(), columns.tolist(), strict=True)}
        wrong |= set() if self._same_drift else {"drift"}
        return [place for place in self._places(range(self.read.calls)) if place.name in wrong] if wrong else []

    def distance(self, order: tuple[int, ...]) -> Distance:
        """How far apart the tables are, with the stages in the order of an `arrangement`; 0 if correctly rounded."""
        apart = [(self._roundings(place), place.name) for place in self._places(order)]
        farthest = max(apart, key=lambda pair: pair[0][1])
        return Distance(max(own for (own, _), _ in apart), farthest[0][1], farthest[1])

    @property
    def size(self) -> int:
        """The number of coefficients of the table read; of an explicit A, only the entries below the diagonal count."""
        calls, weights = self.read.calls, len(self.read.entries) - self.read.calls
        above = calls * (calls + 1) // 2 if np.triu(self.read.values[:calls]).any() else 0
        nodes = calls if self.read.nodes is not None else 0
        return calls * (calls - 1) // 2 + above + calls * weights + nodes + (self.read.drift is not None)

    @cached_property
    def _in_floats(self) -> tuple[Array, Array, Array]:
        """Both tables, with the nodes as a last row if these count, and the allowed difference of each entry."""
        read, exact = self.read.values, self.exact.values
        columns = [self.allowed(scale) for scale in self.exact.scales.tolist()]
        allowed = [columns] * len(exact)
        if self.exact.nodes is not None:
            read, exact = np.vstack([read, self.read.node_values]), np.vstack([exact, self.exact.node_values])
            allowed = [*allowed, [self.allowed(self.exact.length)] * len(columns)]
        return read, exact, np.array(allowed)

    def allowed(self, scale: float) -> float:
        """The allowed difference: the program's roundings, and one for taking the exact number as a double."""
        return self.rounding.of(scale) * (1 + 1 / self.rounding.most)

    @property
    def _same_drift(self) -> bool:
        read, exact = self.read.drift, self.exact.drift
        if read is None or exact is None:
            return read is exact
        return abs(float(read.value) - float(exact.value)) <= self.allowed(exact.size)

    def _extended(self, chosen: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        """Yield the arrangements that begin with the `chosen` stages, in lexicographic order."""
        if len(chosen) == self.read.calls:
            yield chosen
        for k in range(self.read.calls):
            if k not in chosen and self._fits((*chosen, k)):
                yield from self._extended((*chosen, k))

    def _fits(self, chosen: tuple[int, ...]) -> bool:
        """True if the stage chosen last has its weights, its node, and its entries with the stages chosen before."""
        i, before, k, (read, exact, allowed) = len(chosen) - 1, list(chosen[:-1]), chosen[-1], self._in_floats
        # Equal rows have equal sums, of which each takes fewer roundings than are allowed.
        if abs(read[i].sum() - exact[k].sum()) > 2 * allowed[k].sum():
            return False
        mine, its = ([*stages, *range(self.read.calls, len(read))] for stages in (range(i + 1), chosen))
        column = np.abs(read[mine, i] - exact[its, k]) <= allowed[its, k]
        return bool(column.all() and (np.abs(read[i, :i] - exact[k, before]) <= allowed[k, before]).all())

    def _places(self, order: Sequence[int]) -> Iterator[CoefficientPlace]:
        calls, scales = self.read.calls, self.exact.scales.tolist()
        rows = [*order, *range(calls, len(self.exact.entries))]
        if self.exact.nodes is not None:
            for i, node in enumerate(self.read.node_values.tolist()):
                yield CoefficientPlace(self._name(len(rows), i), node, self.exact.nodes[order[i]], self.exact.length)
        for i, row in enumerate(rows):
            for j, seen in enumerate(self.read.values[i].tolist()):
                yield CoefficientPlace(self._name(i, j), seen, self.exact.entries[row][order[j]], scales[order[j]])
        if self.read.drift is not None and self.exact.drift is not None:
            yield CoefficientPlace("drift", float(self.read.drift.value), self.exact.drift, self.exact.drift.size)

    def _name(self, row: int, column: int) -> str:
        names = ("b", "c") if self.read.drift is None else ("b_position", "b_velocity", "c")
        calls = self.read.calls
        return f"a[{row}][{column}]" if row < calls else f"{names[row - calls]}[{column}]"

    def _roundings(self, place: CoefficientPlace) -> tuple[int, int]:
        """The distance in units of u times the size of the terms, and of u times the scale, both rounded up."""
        if is_nearest(place.seen, place.exact.value, self.rounding.format):
            return 0, 0
        # Balls so narrow that the count of roundings is the same in every format.
        exact = place.exact.value
        near = exact if isinstance(exact, Fraction) else sum(exact.enclosure(256), Fraction(0)) / 2
        gap = abs(Fraction(place.seen) - near) / self.rounding.format.u
        own = ceil(gap / Fraction(place.exact.size)) if place.exact.size else self.rounding.most + 1
        return own, ceil(gap / Fraction(place.scale)) if place.scale else own
