"""Coefficient tables as seen through a right-hand side or a force: of a method itself, repeated, scaled or iterated.

Their entries may be any kind of number: floats for a fingerprint, `BoundedCoefficient` for a comparison.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property, reduce
from operator import add
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import Collocation, Nystrom, RungeKutta
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients

_Number: TypeAlias = Any
TableRow: TypeAlias = Sequence[_Number]
# Converts an exact coefficient, or the integers 0 and 1, into the kind of number wanted.
FromExact: TypeAlias = Callable[[Any], _Number]
# (A, b, c) of a Runge-Kutta method.
LiftedTableau: TypeAlias = tuple[Sequence[TableRow], TableRow, TableRow]
# A Nyström table, and how far the position drifts in a step without a force, in units of h v.
Induced: TypeAlias = tuple[StageCoefficients, _Number]


@dataclass(frozen=True)
class BoundedCoefficient:
    """An exact number with the sum of the sizes of the terms that form it, which its rounding error scales with."""

    value: Exact
    size: float

    def __add__(self, other: object) -> BoundedCoefficient:
        """The sum; the sizes are added even if the values cancel."""
        right = bounded(other)
        return BoundedCoefficient(self.value + right.value, self.size + right.size)

    __radd__ = __add__

    def __sub__(self, other: object) -> BoundedCoefficient:
        """The difference; the sizes are added."""
        right = bounded(other)
        return BoundedCoefficient(self.value - right.value, self.size + right.size)

    def __mul__(self, other: object) -> BoundedCoefficient:
        """The product of the values, with the product of the sizes."""
        right = bounded(other)
        return BoundedCoefficient(self.value * right.value, self.size * right.size)

    def __eq__(self, other: object) -> bool:
        """True if the values are equal, whatever their sizes."""
        return bool(self.value == bounded(other).value)

    def __bool__(self) -> bool:
        return bool(self.value)


def bounded(x: Any) -> BoundedCoefficient:
    """The number as a `BoundedCoefficient`; unless it is one already, its size is its absolute value."""
    if isinstance(x, BoundedCoefficient):
        return x
    exact = Fraction(x) if isinstance(x, int) else x
    return BoundedCoefficient(exact, abs(float(exact)))


def stages(a: Sequence[TableRow], weights: Sequence[TableRow], c: TableRow) -> StageCoefficients:
    """The stage coefficients with these rows, all as tuples."""
    return StageCoefficients(tuple(map(tuple, a)), tuple(map(tuple, weights)), tuple(c))


def timed_stages(tableau: LiftedTableau, timed: bool) -> StageCoefficients:
    """A tableau as `symbolic.linear.reduced_tableau` takes it; if `timed`, b is given twice, which makes c count."""
    a, b, c = tableau
    return stages(a, (b, b) if timed else (b,), c)


def tableau_of(
    method: RungeKutta | Collocation, lift: FromExact, weights: Sequence[Exact] | None = None
) -> LiftedTableau:
    """A, b and c of a method in the kind of number that `lift` makes, with `weights` in place of b if given."""
    a, b, c = exact_tableau(method)
    return [[lift(x) for x in row] for row in a], [lift(x) for x in weights or b], [lift(x) for x in c]


@cache
def exact_tableau(
    method: RungeKutta | Collocation,
) -> tuple[Sequence[Sequence[Exact]], Sequence[Exact], Sequence[Exact]]:
    """A, b and c; for a collocation method to 256 bits, which no comparison with a float can tell from exact ones."""
    return method.tableau(256) if isinstance(method, Collocation) else (method.a, method.b, method.c)


def tableau_scaled(tableau: LiftedTableau, factor: Fraction) -> LiftedTableau:
    """The tableau of the same method with the step factor·h."""
    a, b, c = tableau
    rows = [[x * factor for x in row] for row in a]
    return rows, [x * factor for x in b], [x * factor for x in c]


def tableau_repeated(tableau: LiftedTableau, times: int) -> LiftedTableau:
    """The tableau of `times` steps of the same method with h/times."""
    a, b, c = tableau
    part, blank, size = Fraction(1, times), [b[0] * 0] * len(b), range(times)
    step = [x * part for x in b]
    rows = [[*step * i, *(x * part for x in row), *blank * (times - 1 - i)] for i in size for row in a]
    return rows, step * times, [(node + i) * part for i in size for node in c]


def tableau_iterated(tableau: LiftedTableau, times: int, state: bool = False) -> LiftedTableau:
    """An implicit method with `times` fixed-point iterations from k = f(y), at the start or, if `state`, at t + cᵢh."""
    a, b, c = tableau
    blank = [b[0] * 0] * len(b)
    rows: list[list[_Number]] = [blank * (times + 1) for _ in b]
    for i in range(times):
        rows += [[*blank * i, *row, *blank * (times - i)] for row in a]
    return rows, [*blank * times, *b], [*(c if state else blank), *list(c) * times]


def induced_by_tableau(tableau: LiftedTableau) -> Induced:
    """The Nyström table of a Runge-Kutta method on q'' = F(q): c = A1, A², weights bA and b, and the drift Σ b."""
    a, b, _ = tableau
    terms = [[(k, y) for k, y in enumerate(row) if y] for row in a]
    squared = [_times(row, terms) for row in a]
    return stages(squared, (_times(b, terms), b), [reduce(add, row) for row in a]), reduce(add, b)


def induced_by_parts(parts: Sequence[tuple[str, Exact]], lift: FromExact) -> Induced:
    """The Nyström table of a splitting on q'' = F(q): a kick y moves a later position by y times the drift since."""
    at, kicks = lift(0), []
    for kind, x in parts:
        if kind == "drift":
            at = at + lift(x)
        elif x:
            kicks.append((at, lift(x)))
    kicks = kicks or [(at, lift(0))]
    rows = [
        [*((c - start) * y for start, y in kicks[:i]), *[lift(0)] * (len(kicks) - i)] for i, (c, _) in enumerate(kicks)
    ]
    ends = [(at - c) * y for c, y in kicks]
    return stages(rows, (ends, [y for _, y in kicks]), [c for c, _ in kicks]), at


def induced_by_nystrom(method: Nystrom, lift: FromExact) -> Induced:
    """The table of a Nyström method, whose drift is 1."""
    rows = [[lift(x) for x in row] for row in (*method.a, method.b_position, method.b_velocity)]
    return stages(rows[:-2], (rows[-2], rows[-1]), [lift(x) for x in method.c]), lift(1)


def induced_scaled(induced: Induced, factor: Fraction) -> Induced:
    """The Nyström table of the same method with the step factor·h."""
    table, drift = induced
    rows = [[x * (factor * factor) for x in row] for row in (*table.a, table.weights[0])]
    kicks = [x * factor for x in table.weights[1]]
    return stages(rows[:-1], (rows[-1], kicks), [x * factor for x in table.c]), drift * factor


def induced_repeated(induced: Induced, times: int) -> Induced:
    """The Nyström table of `times` steps of the same method with h/times.

    A force of an earlier step acts by its weight at the end of that step, and by its kick times the drift since.
    """
    table, drift = induced
    b_position, b_velocity = table.weights
    part, size, zero = Fraction(1, times), range(times), drift * 0

    def since(gap: int, node: _Number) -> list[_Number]:
        pairs = zip(b_position, b_velocity, strict=True)
        return [(end + (drift * gap + node) * kick) * (part * part) for end, kick in pairs]

    rows = [
        [
            *(x for j in range(i) for x in since(i - j - 1, node)),
            *(x * (part * part) for x in row),
            *[zero] * (len(row) * (times - 1 - i)),
        ]
        for i in size
        for node, row in zip(table.c, table.a, strict=True)
    ]
    ends = [x for j in size for x in since(times - j - 1, zero)]
    nodes = [(drift * i + node) * part for i in size for node in table.c]
    return stages(rows, (ends, [x * part for x in b_velocity] * times), nodes), drift


def _times(row: TableRow, matrix: Sequence[Sequence[tuple[int, _Number]]]) -> list[_Number]:
    """The row times a square matrix, which is given by the nonzero terms of its rows."""
    total = [row[0] * 0] * len(row)
    for x, terms in zip(row, matrix, strict=True):
        for k, y in terms if x else ():
            total[k] = total[k] + x * y
    return total


Array: TypeAlias = "np.ndarray[Any, Any]"
# The powers of the nodes whose weighted sums are compared: in the low ones, methods of high order agree.
_POWERS = (0, 11)


class Fingerprint:
    """A table in floats with all its stages; through a right-hand side, the row sums of A count as nodes besides c."""

    def __init__(self, stages: StageCoefficients, drift: Any) -> None:
        """Take a table; for a right-hand side `drift` is None, and c counts if the weights are given twice."""
        self.a = np.array([[float(x) for x in row] for row in stages.a])
        self.weights = np.array([[float(x) for x in row] for row in stages.weights])
        nodes = np.array([float(x) for x in stages.c])
        if drift is None:
            timed, self.weights = len(stages.weights) > 1, self.weights[:1]
            self.nodes = [self.a.sum(axis=1), nodes] if timed else [self.a.sum(axis=1)]
        else:
            self.nodes = [nodes]
        self.ends = self.nodes if drift is None else [*self.nodes, np.array([float(drift)])]

    @property
    def calls(self) -> int:
        """The number of stages."""
        return len(self.a)

    @cached_property
    def used(self) -> int:
        """The number of stages that the result depends on, but at least 1."""
        reached = np.any(self.weights != 0, axis=0)
        for _ in range(self.calls):
            reached = reached | np.any(self.a[reached] != 0, axis=0)
        return max(int(reached.sum()), 1)

    @cached_property
    def length(self) -> float:
        """The size of the largest node."""
        return max(float(np.abs(nodes).max()) for nodes in self.nodes)

    @cached_property
    def scale(self) -> float:
        """The sum over all columns of the largest entry, times the largest node or drift if that exceeds 1."""
        columns = np.abs(np.vstack([self.a, self.weights])).max(axis=0)
        return float(columns.sum()) * max(1.0, *(float(np.abs(places).max()) for places in self.ends))

    def may_be(self, other: Fingerprint, rounding: Rounding) -> bool:
        """False if the methods certainly differ: in sums that do not depend on the order or reduction of the stages.

        The sums are wcᵏ, wAcᵏ and wAAcᵏ for each row w of weights, with the nodes c in units of the largest. If no
        entry is off by more than e times the largest in its column, and s > 1 bounds the sum of these, then wAAcᵏ is
        off by at most e (k + 4) s³ to first order: by e for each of k nodes, of three factors and of the unit.
        """
        unit, scale = self.length or 1.0, 1.0 + max(self.scale, other.scale)
        allowed = rounding.of(2 * (max(_POWERS) + 4) * scale**3)
        pairs = zip(self._sums(unit), other._sums(unit), strict=True)
        return all(bool((np.abs(mine - its) <= allowed).all()) for mine, its in pairs)

    def _sums(self, unit: float) -> Iterator[Array]:
        for nodes in self.nodes:
            for power in _POWERS:
                values = (nodes / unit) ** power
                for _ in range(3):
                    yield self.weights @ values
                    values = self.a @ values
