"""Which method of the catalogue a reading is; or which variant of one; or which one it is but for what."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, fsum
from typing import NamedTuple

from driftproof.blackbox.matching.candidates import (
    EMBEDDED,
    Candidate,
    ExactTable,
    field_methods,
    field_variants,
    force_methods,
    force_variants,
    in_field,
    newmark,
    on_force,
)
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
from driftproof.symbolic.linear.reduced_tableau import reduced

# A coefficient that is a quotient or a root, computed where it is used, takes four operations at most, as does
# 1/(2 - 2**(1/3)).
FEW_ROUNDINGS = 4
# A method that differs in more coefficients than so many, or in more than every third, is another method: two
# exchanged weights are two differences, and with a node of theirs three.
FEW_DIFFERENCES = 3


@dataclass(frozen=True)
class Match:
    """A method whose coefficients are those read, up to rounding; `relation` says how it is used if not as it stands.

    `roundings` is 0 if each coefficient is the correctly rounded one; else each is off by at most so many u: relative
    to the terms that it is made of, or where `summed`, relative to the largest in its column. `farthest` is the one
    that is. `beside` are differences in calls whose answers the step does not use, as in an error estimate.
    `within` is not 0 where a solver of implicit stages leaves more than rounding: what the coefficients are off by.
    """

    key: str
    relation: str
    roundings: int
    farthest: str
    summed: bool
    beside: tuple[str, ...]
    within: float

    @property
    def name(self) -> str:
        """The key, and the relation."""
        return f"{self.key}, {self.relation}" if self.relation else self.key

    @property
    def closeness(self) -> str:
        """How near the coefficients are, in words."""
        if not self.roundings:
            return "every coefficient correctly rounded"
        if self.within:
            return f"every coefficient within {self.within:.1e}, as its stages are solved"
        within = f"{self.roundings} rounding{'s' * (self.roundings > 1)}"
        if not self.summed:
            return f"every coefficient within {within}"
        return f"the coefficients as sums make them: {self.farthest} is {within} of the largest in its column off"


@dataclass(frozen=True)
class Identity:
    """What a reading is: every method or variant that it cannot be told from; where there is none, what is nearest."""

    matches: tuple[Match, ...] = ()
    near: tuple[Near, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """The methods that it is as they stand, the other rows of pairs included; variants are not among them."""
        suffixes = {"": "", EMBEDDED: catalogue.EMBEDDED_SUFFIX}
        return tuple(m.key + suffixes[m.relation] for m in self.matches if m.relation in suffixes)

    @property
    def lines(self) -> list[str]:
        """What it is, in words."""
        if self.matches:
            names = "; ".join(match.name for match in self.matches)
            tie = [f"called in this way these cannot be told apart: {names}", self.matches[0].closeness]
            key = f" ({self.keys[0]})" if self.keys and self.matches[0].relation else ""
            only = [f"{self.matches[0].name}{key}: {self.matches[0].closeness}"]
            beside = [f"{m.key}: in a call whose answer is not used, {line}" for m in self.matches for line in m.beside]
            return (only if len(self.matches) == 1 else tie) + beside
        names_by_difference: dict[tuple[str, ...], list[str]] = {}
        for near in self.near:
            names_by_difference.setdefault(near.differences, []).append(near.key)
        nearest = [f"nearest: {' or '.join(keys)} but for {'; '.join(d)}" for d, keys in names_by_difference.items()]
        return ["no method of the catalogue", *nearest]


def match_tableau(reading: TableauReading) -> Identity:
    """The Runge-Kutta methods with the tableau read: its irreducible form up to the order of its stages.

    The times count where the code uses them.
    """
    timed, implicit, read = reading.c is not None, reading.implicit, _Read.of(reading)
    variants = field_variants(timed, read.small.calls, _factor(reading.b, read.rounding), implicit=implicit)
    methods = field_methods(timed, implicit)
    return _identity(read, methods, variants, typed_in(read.fingerprint, methods, read.rounding))


def match_forces(reading: ForceReading) -> Identity:
    """The methods that take the step read on every q'' = F(q), of whichever family: their Nyström tables are compared.

    Every Runge-Kutta method and every splitting has one.
    """
    read = _Read.of(reading)
    if reading.implicit:
        return _identity(read, force_methods(implicit=True), newmark(read.small), ())
    variants = force_variants(read.small.calls, _factor((reading.drift,), read.rounding))
    return _identity(read, force_methods(), variants, near_misses(reading))


def matched(reading: CoefficientReading) -> Identity:
    """`match_tableau` or `match_forces`."""
    return match_forces(reading) if isinstance(reading, ForceReading) else match_tableau(reading)


def match_method(reading: CoefficientReading, method: Method) -> Identity:
    """Whether the reading is this method, of the catalogue or not; if it is not, where it differs, if in few places.

    Through a right-hand side no splitting matches, and an implicit method no table without implicit stages.
    """
    read, candidates = _Read.of(reading), list[Candidate]()
    if isinstance(reading, ForceReading):
        return _identity(read, [on_force(method)] if method.explicit != reading.implicit else [], (), ())
    if isinstance(method, RungeKutta | Collocation) and method.explicit != reading.implicit:
        candidates = [in_field(method, reading.c is not None)]
    return _identity(read, candidates, (), typed_in(read.fingerprint, candidates, read.rounding))


class _Read(NamedTuple):
    """A reading as a table, with all its stages and irreducible."""

    raw: ExactTable
    small: ExactTable
    fingerprint: Fingerprint
    rounding: Rounding

    @classmethod
    def of(cls, reading: CoefficientReading) -> _Read:
        """From the coefficients as exact numbers."""
        stages, drift = reading.stages, Fraction(reading.drift) if isinstance(reading, ForceReading) else None
        raw, small = (ExactTable.of(each, drift) for each in (stages, reduced(stages)))
        return cls(raw, small, Fingerprint(stages, drift), reading.rounding)


def _identity(
    read: _Read, methods: Iterable[Candidate], variants: Iterable[Candidate], explained: Iterable[Near]
) -> Identity:
    # Among those that cannot be told apart, a method that makes as many calls comes before a pair that makes more.
    methods = sorted(methods, key=lambda candidate: candidate.fingerprint.calls != read.raw.calls)
    matches = _best(m for c in methods for m in _match(read, c)) or _best(m for c in variants for m in _match(read, c))
    if matches:
        return Identity(matches)
    return Identity(near=_nearest([*explained, *(near for c in methods for near in _near(read, c))]))


def _match(read: _Read, candidate: Candidate) -> Iterator[Match]:
    # Most candidates are told apart without their exact tables, which take long to make.
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
    yield Match(candidate.key, candidate.relation, roundings, distance.farthest, summed, beside or (), within)


def _best(matches: Iterable[Match]) -> tuple[Match, ...]:
    """Those with correctly rounded coefficients, if there are any; in few bits several are within a few roundings."""
    ranked = [((match.summed, match.roundings > 0), match) for match in matches]
    best = min((rank for rank, _ in ranked), default=None)
    return tuple(match for rank, match in ranked if rank == best)


def _near(read: _Read, candidate: Candidate) -> Iterator[Near]:
    """With all stages against all, and irreducible against irreducible: a wrong zero can make a stage useless."""
    pairs = []
    if candidate.fingerprint.calls == read.raw.calls:
        pairs.append((read.raw, candidate.raw))
    if candidate.fingerprint.used == read.small.calls:
        pairs.append((read.small, candidate.small))
    for mine, its in pairs:
        differences = _differences(read, mine, its)
        if differences is not None:
            yield Near(candidate.key, differences)


def _differences(read: _Read, mine: ExactTable, its: ExactTable) -> tuple[str, ...] | None:
    """The few coefficients in which the tables differ; None if they are more, or the tables have other sizes."""
    if mine.calls != its.calls:
        return None
    comparison = Comparison(mine, its, read.rounding)
    places = comparison.differences()
    if len(places) > min(FEW_DIFFERENCES, max(1, comparison.size // 3)):
        return None
    fmt, slack = read.rounding.format, read.rounding.besides
    return tuple(coefficient_difference(p.name, p.seen, p.exact.value, fmt, slack) for p in places)


def _nearest(found: list[Near]) -> tuple[Near, ...]:
    """Those with the fewest differences; of several of one method, the first."""
    few = [near for near in found if near.differences and len(near.differences) <= FEW_DIFFERENCES]
    kept: dict[str, Near] = {}
    for near in few:
        if len(near.differences) == min(len(other.differences) for other in few):
            kept.setdefault(near.key, near)
    return tuple(kept.values())


def _factor(weights: CoefficientRow, rounding: Rounding) -> Fraction | None:
    """By how much the weights are too many, as the simplest fraction that rounding allows: the step in units of h."""
    return simple_rational(fsum(weights), rounding.of(fsum(map(abs, weights))))
