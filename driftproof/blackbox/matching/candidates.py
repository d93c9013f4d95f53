"""Candidates for a reading: methods of the catalogue and their variants, as a right-hand side or a force shows them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property, partial
from typing import Any, TypeAlias

import numpy as np

from driftproof.blackbox.matching import tables
from driftproof.blackbox.matching.tables import Array, FromExact, LiftedTableau, TableRow
from driftproof.blackbox.probes.coefficients import short_rational, simple_rational
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, Method, Nystrom, RungeKutta, Splitting
from driftproof.support.plain_text import counted
from driftproof.symbolic.known_methods import turned_over
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced

# Makes a table of the kind of number wanted, with its drift, which is None for a right-hand side.
Recipe: TypeAlias = Callable[[FromExact], tuple[StageCoefficients, Any]]
# Changes a table into that of the same method with another step, or repeated.
_Change: TypeAlias = Callable[[Any, Any], Any]
# Chosen: the most steps of a method in one that are looked for. Codes take two halves, as extrapolation does, or three
# or four sub-steps; every further number costs a table of each method.
MOST_REPEATED = 4
# How near a solver comes by default; and the first denominator that is too large to be written as a fraction.
_SOLVED_TO, _WRITTEN_OUT = 2.0**-36, 100
EMBEDDED = "with the embedded weights propagated"


@dataclass(frozen=True)
class ExactTable:
    """A table of `BoundedCoefficient`: A above the rows of weights, the nodes if they count, and the drift."""

    entries: tuple[TableRow, ...]
    nodes: TableRow | None
    drift: tables.BoundedCoefficient | None

    @classmethod
    def of(cls, stages: StageCoefficients, drift: Any) -> ExactTable:
        """The table of stages as `symbolic.linear.reduced_tableau` has them; `drift` is None for a right-hand side."""
        weights = stages.weights if drift is not None else stages.weights[:1]
        entries = tuple(tuple(map(tables.bounded, row)) for row in (*stages.a, *weights))
        nodes = tuple(map(tables.bounded, stages.c)) if len(stages.weights) > 1 else None
        return cls(entries, nodes, None if drift is None else tables.bounded(drift))

    @property
    def calls(self) -> int:
        """The number of stages."""
        return len(self.entries[0])

    @cached_property
    def values(self) -> Array:
        """The entries as the nearest floats."""
        return np.array([[float(x.value) for x in row] for row in self.entries])

    @cached_property
    def node_values(self) -> Array:
        """The nodes as the nearest floats; empty if they do not count."""
        return np.array([float(x.value) for x in self.nodes or ()])

    @cached_property
    def scales(self) -> Array:
        """For each stage, the largest factor by which its slope enters a later stage or the result."""
        sizes = np.array([[x.size for x in row] for row in self.entries])
        # A kick moves a later position by its weight times the drift since.
        kicks = np.zeros(self.calls) if self.drift is None else sizes[-1] * self.length
        largest: Array = np.vstack([sizes, kicks]).max(axis=0)
        return largest

    @cached_property
    def length(self) -> float:
        """The size of the largest node or of the drift."""
        return max((x.size for x in (*(self.nodes or ()), *filter(None, [self.drift]))), default=0.0)


@dataclass(frozen=True)
class Candidate:
    """A method, or the variant of it that `relation` names, with the table that an exact reading of it has.

    `steps` is the number of the method's steps, of a part of h each, that it takes in one.
    """

    key: str
    relation: str
    recipe: Recipe
    steps: int = 1

    @cached_property
    def fingerprint(self) -> tables.Fingerprint:
        """The table with every stage, in floats."""
        return tables.Fingerprint(*self.recipe(float))

    @cached_property
    def raw(self) -> ExactTable:
        """The exact table with every stage."""
        return ExactTable.of(*self._exact)

    @cached_property
    def small(self) -> ExactTable:
        """The exact irreducible table: without stages that do not count, and with equal ones merged."""
        stages, drift = self._exact
        return ExactTable.of(reduced(stages), drift)

    @cached_property
    def _exact(self) -> tuple[StageCoefficients, Any]:
        return self.recipe(tables.bounded)


@cache
def field_methods(timed: bool, implicit: bool = False) -> tuple[Candidate, ...]:
    """The explicit, or the implicit, Runge-Kutta methods of the catalogue; their nodes count if `timed`."""
    return tuple(in_field(method, timed) for method in _runge_kutta(implicit))


def in_field(method: RungeKutta | Collocation, timed: bool) -> Candidate:
    """A Runge-Kutta method as it is read through a right-hand side; its nodes count if `timed`."""
    return Candidate(method.key, "", _in_field(partial(tables.tableau_of, method), timed))


@cache
def force_methods(implicit: bool = False) -> tuple[Candidate, ...]:
    """The explicit methods of every family of the catalogue, or the implicit ones, as read through a force."""
    if implicit:
        return tuple(map(on_force, _runge_kutta(implicit)))
    families = (RungeKutta, Splitting, Nystrom)
    ranked = sorted((m for m in METHODS.values() if m.explicit), key=lambda m: families.index(type(m)))
    return tuple(on_force(method) for method in ranked)


def on_force(method: Method) -> Candidate:
    """The method as it is read through a force."""
    if isinstance(method, Splitting):
        return Candidate(method.key, "", partial(tables.induced_by_parts, method.parts))
    if isinstance(method, Nystrom):
        return Candidate(method.key, "", partial(tables.induced_by_nystrom, method))
    return Candidate(method.key, "", _on_force(partial(tables.tableau_of, method)))


def newmark(read: ExactTable) -> Iterator[Candidate]:
    """Yield Newmark's method with the beta and gamma of a table of two stages; nothing for another table."""
    if read.calls != 2:
        return
    last = int(np.argmax(read.node_values))
    seen = (Fraction(read.entries[row][last].value) for row in (2, 3))
    beta, gamma = (simple_rational(x, _SOLVED_TO) or x for x in seen)
    half = Fraction(1, 2)

    def recipe(lift: FromExact) -> tuple[StageCoefficients, Any]:
        ends = [lift(half - beta), lift(beta)]
        rows = [[lift(Fraction(0))] * 2, ends]
        return tables.stages(
            rows, (ends, [lift(1 - gamma), lift(gamma)]), [lift(Fraction(0)), lift(Fraction(1))]
        ), lift(1)

    shown = (str(x) if x.denominator < _WRITTEN_OUT else short_rational(x) for x in (beta, gamma))
    yield Candidate("newmark", "with beta = {} and gamma = {}".format(*shown), recipe)


def field_variants(timed: bool, calls: int, factor: Fraction | None, *, implicit: bool) -> Iterator[Candidate]:
    """Yield variants of the Runge-Kutta methods with `calls` stages that count; `factor` is the step in units of h."""
    for method, candidate in zip(_runge_kutta(implicit), field_methods(timed, implicit), strict=True):
        make = partial(tables.tableau_of, method)
        if isinstance(method, RungeKutta) and method.b_embedded is not None:
            yield Candidate(method.key, EMBEDDED, _in_field(partial(make, weights=method.b_embedded), timed))
        for name, change, by, n in _resized(candidate, calls, factor, tables.tableau_scaled, tables.tableau_repeated):
            yield Candidate(method.key, name, _in_field(_then(make, change, by), timed), n)
    for key, relation, iterated in _iterations(calls, timed) if not implicit else ():
        yield Candidate(key, relation, _in_field(iterated, timed))


def force_variants(calls: int, factor: Fraction | None) -> Iterator[Candidate]:
    """Yield variants as read through a force; for splittings, also the adjoint, and kicks and drifts exchanged."""
    for method in METHODS.values():
        if isinstance(method, RungeKutta) and method.explicit and method.b_embedded:
            embedded = partial(tables.tableau_of, method, weights=method.b_embedded)
            yield Candidate(method.key, EMBEDDED, _on_force(embedded))
    for splitting in METHODS.values():
        if isinstance(splitting, Splitting):
            for relation, other in turned_over(splitting):
                if sum(kind == "kick" and x != 0 for kind, x in other.parts) == calls:
                    yield Candidate(splitting.key, relation, partial(tables.induced_by_parts, other.parts))
    for candidate in force_methods():
        for name, change, by, n in _resized(candidate, calls, factor, tables.induced_scaled, tables.induced_repeated):
            yield Candidate(candidate.key, name, _then(candidate.recipe, change, by), n)
    for key, relation, iterated in _iterations(calls, timed=False):
        yield Candidate(key, relation, _on_force(iterated))


def _resized(
    candidate: Candidate, calls: int, factor: Fraction | None, scaled: _Change, repeated: _Change
) -> Iterator[tuple[str, _Change, Fraction | int, int]]:
    """Yield another step, and several in one, of which the last stage of one may be the first of the next; how many."""
    stages = candidate.fingerprint.used
    if factor and stages == calls:
        yield f"with the step {factor} h in place of h", scaled, factor, 1
    for times in range(2, MOST_REPEATED + 1):
        if times * stages - calls in range(times):
            yield f"{times} steps of h/{times}", repeated, times, times
            if factor == times:
                whole = lambda table, by: scaled(repeated(table, by), Fraction(by))
                yield f"{times} steps of h each instead of h/{times}", whole, times, 1


def _in_field(make: Callable[[FromExact], LiftedTableau], timed: bool) -> Recipe:
    return lambda lift: (tables.timed_stages(make(lift), timed), None)


def _on_force(make: Callable[[FromExact], LiftedTableau]) -> Recipe:
    return lambda lift: tables.induced_by_tableau(make(lift))


def _then(make: Callable[[FromExact], Any], change: _Change, by: Fraction | int) -> Callable[[FromExact], Any]:
    return lambda lift: change(make(lift), by)


def _iterations(calls: int, timed: bool) -> Iterator[tuple[str, str, Callable[[FromExact], LiftedTableau]]]:
    """Yield each implicit method iterated in `calls` calls: one at the start, one per round and nonzero row of A.

    Or the first round is f(y) at the times of the stages, which only a `timed` table tells from one call at the start.
    """
    for method in METHODS.values():
        if isinstance(method, RungeKutta) and not method.explicit:
            make, rows = partial(tables.tableau_of, method), sum(any(row) for row in method.a)
            for state, first in ((False, 1), (True, len({*method.c}))):
                times, rest = divmod(calls - first, rows)
                if rest or (state and (not timed or times < 1)):
                    continue
                count = counted(times + state, "fixed-point iteration")
                start = "state" if state else "slope"
                iterated = _then(make, partial(tables.tableau_iterated, state=state), times)
                yield method.key, f"with {count} from the {start} at the start: explicit", iterated


def _runge_kutta(implicit: bool) -> list[RungeKutta | Collocation]:
    """The Runge-Kutta methods of the catalogue, in its order."""
    return [m for m in METHODS.values() if isinstance(m, RungeKutta | Collocation) and m.explicit != implicit]
