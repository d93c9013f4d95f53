"""Matching of a reading to the catalogue: the method, the variant of one, or the nearest methods with differences."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, fsum
from typing import NamedTuple

import numpy as np

from driftproof.blackbox.matching import candidates
from driftproof.blackbox.matching.candidates import EMBEDDED, Candidate, ExactTable
from driftproof.blackbox.matching.comparing import Comparison
from driftproof.blackbox.matching.near_misses import Near, near_misses, typed_in
from driftproof.blackbox.matching.tables import Fingerprint
from driftproof.blackbox.probes.coefficients import coefficient_difference, simple_rational
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.questions import CoefficientReading
from driftproof.blackbox.probes.scripted_answers import CoefficientRow, Rounding
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.methods import catalogue
from driftproof.methods.schemes import Collocation, Method, RungeKutta
from driftproof.support.plain_text import counted
from driftproof.symbolic.known_methods import FEW_DIFFERENCES, are_few, except_for
from driftproof.symbolic.linear.reduced_tableau import reduced

# A coefficient that is computed where it is used, as a quotient or with a root, takes at most four operations, as
# 1/(2 - 2**(1/3)) does.
FEW_ROUNDINGS = 4


@dataclass(frozen=True)
class Match:
    """A method with the coefficients read, up to rounding; `relation` names the variant, "" for the method itself.

    `roundings` is 0 if every coefficient is correctly rounded. Otherwise each is off by at most that many u, relative
    to the size of its own terms, or, if `summed`, to the largest number in its column; `farthest` names the coefficient
    that is farthest off. `beside` lists differences in calls whose answers the step does not use, such as those of an
    error estimate. `within` is how far the coefficients are off if a solver of implicit stages leaves more than
    rounding, else 0. `steps` is the number of steps of parts of h.
    """

    key: str
    relation: str
    roundings: int
    farthest: str
    summed: bool
    beside: tuple[str, ...]
    within: float
    steps: int = 1

    @property
    def name(self) -> str:
        """The key of the method, followed by its relation if it has one."""
        return f"{self.key}, {self.relation}" if self.relation else self.key

    @property
    def closeness(self) -> str:
        """How near the coefficients read are to the method's, in words."""
        if not self.roundings:
            return "every coefficient correctly rounded"
        if self.within:
            return f"every coefficient within {self.within:.1e}, the accuracy of its stage solver"
        within = counted(self.roundings, "rounding")
        if not self.summed:
            return f"every coefficient within {within}"
        return f"coefficients formed as sums: {self.farthest} is off by {within} of the largest in its column"


@dataclass(frozen=True)
class Identity:
    """Every method or variant that a reading cannot be distinguished from; if there is none, the nearest methods."""

    matches: tuple[Match, ...] = ()
    near: tuple[Near, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the matching methods, a pair with its embedded row propagated included, other variants not."""
        suffixes = {"": "", EMBEDDED: catalogue.EMBEDDED_SUFFIX}
        return tuple(m.key + suffixes[m.relation] for m in self.matches if m.relation in suffixes)

    @property
    def lines(self) -> list[str]:
        """The identity as lines of text."""
        if self.matches:
            names = "; ".join(match.name for match in self.matches)
            tie = [f"not distinguishable through this calling convention: {names}", self.matches[0].closeness]
            key = f" ({self.keys[0]})" if self.keys and self.matches[0].relation else ""
            only = [f"{self.matches[0].name}{key}: {self.matches[0].closeness}"]
            beside = [f"{m.key}: in a call whose answer is not used, {line}" for m in self.matches for line in m.beside]
            return (only if len(self.matches) == 1 else tie) + beside
        nearest = except_for((near.key, near.differences) for near in self.near)
        return ["no method of the catalogue", *(f"nearest: {each}" for each in nearest)]


def match_tableau(reading: TableauReading) -> Identity:
    """The Runge-Kutta methods whose irreducible tableau is that of the reading, in some order of the stages.

    The nodes c are compared only if the code passes times to its right-hand side.
    """
    timed, implicit, read = reading.c is not None, reading.implicit, _Read.of(reading)
    variants = candidates.field_variants(timed, read.small.calls, _factor(reading.b, read.rounding), implicit=implicit)
    methods = candidates.field_methods(timed, implicit)
    return _identity(read, methods, variants, typed_in(read.fingerprint, methods, read.rounding))


def match_forces(reading: ForceReading) -> Identity:
    """The methods of any family that take the step read on every q'' = F(q), by comparison of Nyström tables.

    Every Runge-Kutta method and every splitting has such a table.
    """
    read = _Read.of(reading)
    if reading.implicit:
        return _identity(read, candidates.force_methods(implicit=True), candidates.newmark(read.small), ())
    variants = candidates.force_variants(read.small.calls, _factor((reading.drift,), read.rounding))
    return _identity(read, candidates.force_methods(), variants, near_misses(reading))


def matched(reading: CoefficientReading) -> Identity:
    """The identity of a reading through a right-hand side or through a force."""
    return match_forces(reading) if isinstance(reading, ForceReading) else match_tableau(reading)


def match_method(reading: CoefficientReading, method: Method) -> Identity:
    """The identity of a reading compared with this method alone, which need not be one of the catalogue.

    If they differ in few places, `near` holds the differences. Through a right-hand side no splitting matches. An
    implicit method matches only a reading of implicit stages, and an explicit one only a reading of explicit stages.
    """
    read, alone = _Read.of(reading), list[Candidate]()
    if isinstance(reading, ForceReading):
        return _identity(read, [candidates.on_force(method)] if method.explicit != reading.implicit else [], (), ())
    if isinstance(method, RungeKutta | Collocation) and method.explicit != reading.implicit:
        alone = [candidates.in_field(method, reading.c is not None)]
    return _identity(read, alone, (), typed_in(read.fingerprint, alone, read.rounding))


class _Read(NamedTuple):
    """A reading as exact tables: `raw` with all its stages, `small` irreducible."""

    raw: ExactTable
    small: ExactTable
    fingerprint: Fingerprint
    rounding: Rounding

    @classmethod
    def of(cls, reading: CoefficientReading) -> _Read:
        stages, drift = reading.stages, Fraction(reading.drift) if isinstance(reading, ForceReading) else None
        raw, small = (ExactTable.of(each, drift) for each in (stages, reduced(stages)))
        return cls(raw, small, Fingerprint(stages, drift), reading.rounding)


def _identity(
    read: _Read, methods: Iterable[Candidate], variants: Iterable[Candidate], explained: Iterable[Near]
) -> Identity:
    # Of methods that cannot be distinguished, those that make as many calls come before pairs that make more.
    methods = sorted(methods, key=lambda candidate: candidate.fingerprint.calls != read.raw.calls)
    matches = _best(m for c in methods for m in _match(read, c)) or _best(m for c in variants for m in _match(read, c))
    if matches:
        return Identity(matches)
    return Identity(near=_nearest([*explained, *(near for c in methods for near in _near(read, c))]))


def _match(read: _Read, candidate: Candidate) -> Iterator[Match]:
    # Exact tables take long to make, and most candidates are excluded without them.
    if not read.fingerprint.may_be(candidate.fingerprint, read.rounding) or candidate.small.calls != read.small.calls:
        return
    comparison = Comparison(read.small, candidate.small, read.rounding)
    order = comparison.arrangement()
    if order is None:
        return
    distance = comparison.distance(order)
    few = FEW_ROUNDINGS if read.raw.drift is None else read.rounding.most
    unsolved = ceil(read.rounding.besides / read.rounding.format.u)
    summed = distance.of_terms > few + unsolved
    roundings = distance.of_column if summed else distance.of_terms
    within = float(roundings * read.rounding.format.u) if unsolved and roundings > read.rounding.most else 0.0
    beside = _differences(read, read.raw, candidate.raw) if order == tuple(range(len(order))) else ()
    off = roundings, distance.farthest, summed, tuple(beside or ()), within
    yield Match(candidate.key, candidate.relation, *off, candidate.steps)


def _best(matches: Iterable[Match]) -> tuple[Match, ...]:
    """The best-ranked matches: in a format of few bits, several methods may be within a few roundings."""
    ranked = [((match.summed, match.roundings > 0), match) for match in matches]
    best = min((rank for rank, _ in ranked), default=None)
    return tuple(match for rank, match in ranked if rank == best)


def _near(read: _Read, candidate: Candidate) -> Iterator[Near]:
    """Compare the tables with all stages, and the irreducible ones, because a wrong zero can make a stage useless."""
    pairs = []
    if candidate.fingerprint.calls == read.raw.calls:
        pairs.append((read.raw, candidate.raw))
    if candidate.fingerprint.used == read.small.calls:
        pairs.append((read.small, candidate.small))
    for mine, its in pairs:
        differences = _differences(read, mine, its)
        if differences is not None:
            yield Near(candidate.key, tuple(differences), sum(differences.values()))


def _differences(read: _Read, mine: ExactTable, its: ExactTable) -> dict[str, float] | None:
    """The few coefficients in which the tables differ, as text, and how far; None if many, all of A, or of others."""
    if mine.calls != its.calls:
        return None
    comparison = Comparison(mine, its, read.rounding)
    places = comparison.differences()
    any_a = np.any([mine.values, its.values], axis=0)[: mine.calls]
    if not are_few([place.name for place in places], comparison.size, any_a.sum()):
        return None
    fmt, slack = read.rounding.format, read.rounding.besides
    return {
        coefficient_difference(p.name, p.seen, p.exact.value, fmt, slack): abs(p.seen - float(p.exact.value))
        for p in places
    }


def _nearest(found: list[Near]) -> tuple[Near, ...]:
    """The near misses with the fewest differences, the smallest first, and of each method only the first."""
    few = [near for near in found if near.differences and len(near.differences) <= FEW_DIFFERENCES]
    few.sort(key=lambda near: near.off)
    kept: dict[str, Near] = {}
    for near in few:
        if len(near.differences) == min(len(other.differences) for other in few):
            kept.setdefault(near.key, near)
    return tuple(kept.values())


def _factor(weights: CoefficientRow, rounding: Rounding) -> Fraction | None:
    """The sum of the weights, which is the step in units of h, as the simplest fraction that rounding allows."""
    return simple_rational(fsum(weights), rounding.of(fsum(map(abs, weights))))
