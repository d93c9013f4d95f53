"""Which method a float stepper is, as far as steps of a linear system tell: explained, or its own matrix recovered."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf

import numpy as np

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.linear.arithmetics import SERIES_LENGTH
from driftproof.blackbox.linear.classes import MethodClass, all_matrices, method_classes
from driftproof.blackbox.linear.explain import Explanation, explanations
from driftproof.blackbox.linear.facts import ENTRIES, MatrixFacts, damping_of, differences, facts_of
from driftproof.blackbox.linear.reading import FAR_OUT, LINEAR, LINEARISED, NOT_LINEAR, Floats, Reading, read
from driftproof.blackbox.linear.recovery import Recovered, recovered
from driftproof.blackbox.linear.score import FORWARDS
from driftproof.blackbox.linear.search import Search
from driftproof.blackbox.probes.simple_rationals import rational_text
from driftproof.blackbox.stepper.doors import MAP
from driftproof.blackbox.stepper.subject import Subject

# A linear stepper that any method may be.
UNDETERMINED = "undetermined"
# Where a limit or a rule disturbs the reading at states of size 1: below most limits, above most rules of rest.
OTHER_SIZES = (2.0**-5, 2.0**-10, 2.0**20)
# In a format with fewer powers of two there are no such sizes.
OWN_RANGE = 100
# A longer text is left to programs.
LONGEST_LINE = 160
MOST_COMPARED, MOST_DIFFERENCES = 8, 4


@dataclass(frozen=True)
class Candidate:
    """A map that the stepper cannot be told from by linear steps.

    `methods` are the catalogue's keys with the same matrix, of which it is made; `extras` counts what makes it differ
    from them. `score` is its worst error in units of the bound, at most 1. q' = a v, v' = -k q with a = `position` and
    k = `stiffness`, and `damping` as `words` use it. `restriction` says at which steps only, if so.
    """

    methods: tuple[str, ...]
    words: str
    extras: int
    score: float
    position: Fraction
    stiffness: Fraction
    damping: Fraction
    restriction: str = ""


@dataclass(frozen=True)
class Nearest:
    """The methods nearest to a stepper that none explains: how far `off` their matrix is at one `h`, and where."""

    methods: tuple[str, ...]
    h: float
    off: float
    differences: tuple[str, ...]


@dataclass(frozen=True)
class LinearFit:
    """What linear steps say of a stepper; plain data.

    `kind` is that of the `Reading`, and `amplitude` the size of the states at which the stepper was read; `format` is
    the one in which it computes. `position`, `stiffness` and `damping` are a, k, g of the system q' = a v,
    v' = -k q - g v that small steps follow, None where there is none. `candidates` are what explains it, the simplest
    first; where there are none, `nearest` is what comes closest. `facts` are those of the exact matrix, where that is
    known. `remarks` are for people.
    """

    kind: str
    amplitude: float
    format: str
    position: Fraction | None = None
    stiffness: Fraction | None = None
    damping: Fraction | None = None
    candidates: tuple[Candidate, ...] = ()
    nearest: Nearest | None = None
    facts: MatrixFacts | None = None
    remarks: tuple[str, ...] = ()

    @property
    def best(self) -> Candidate | None:
        """The simplest explanation."""
        return self.candidates[0] if self.candidates else None

    @property
    def doubts(self) -> int:
        """0 where a method holds at all steps, 1 at all ahead, 2 at some, 3 where there is none."""
        if self.best is None:
            return 3
        return {"": 0, FORWARDS: 1}.get(self.best.restriction, 2)

    @property
    def is_disturbed(self) -> bool:
        """True when something was seen that depends on the size of states, and no method holds at all steps ahead."""
        if self.best is not None:
            return self.doubts > 1
        limited = any(remark.startswith(FAR_OUT) for remark in self.remarks)
        return limited or self.kind == NOT_LINEAR or 0 in (self.position, self.stiffness)

    @property
    def lines(self) -> tuple[str, ...]:
        """The answer in plain English, the most important line first."""
        return tuple(_lines(self))


def linear_fit(subject: Subject) -> LinearFit:
    """The stepper explained by its linear steps: of the oscillator, or of the system that it has built in.

    Some seventy calls, or twice or three times as many where a limit disturbs the first. Lets a Misbehaviour pass.
    """
    known = subject.door.kind != MAP or bool(subject.door.extra)
    first = fitted(read(subject), known=known)
    if first.is_disturbed and subject.format.emin < -OWN_RANGE:
        for size in OTHER_SIZES:
            with suppress(Misbehaviour):
                other = fitted(read(subject, size), known=known)
                if other.kind == LINEAR and other.doubts < first.doubts:
                    return other
    return first


def fitted(reading: Reading, *, known: bool) -> LinearFit:
    """A reading explained; `known`: of the oscillator, q' = v, v' = -q."""
    start = LinearFit(reading.kind, reading.amplitude, reading.format.name, remarks=reading.remarks)
    if reading.at_zero is None or not reading.steps:
        return start
    search = Search(reading)
    rates = (1.0, 1.0) if known else (search.position, search.stiffness)
    if not reading.identifiable:
        return replace(start, nearest=_nearest(*search.tried[0], rates))
    if all((m[0], *m[2:]) == (1, 0, 1) for _, m in reading.steps):
        return replace(start, kind=UNDETERMINED, remarks=("no force acts: all methods agree", *reading.remarks))
    if reading.starts_at_identity:
        position, stiffness = search.exact_rates
        start = replace(start, position=position, stiffness=stiffness)
    if known and reading.ordinary:
        start = replace(start, nearest=_nearest(*reading.ordinary, rates))
    found = explanations(reading, known=known) if 0 not in (search.position, search.stiffness) else []
    return _explained(start, found) if found else _unexplained(start, search, known=known)


def _explained(start: LinearFit, found: Sequence[Explanation]) -> LinearFit:
    """The fit with what explains it, and the facts of the first."""
    candidates = []
    for each in found:
        fit, score = each.scored.fit, each.scored.error.in_bounds
        rates = fit.position, fit.stiffness, fit.damping
        candidates.append(Candidate(fit.model.methods, each.words, each.extras, score, *rates, each.scored.restriction))
    first = found[0].scored.fit
    damping = Fraction(0) if first.model.keeps_damping_per_step else first.damping
    return replace(start, candidates=tuple(candidates), facts=found[0].facts(), damping=damping)


def _unexplained(start: LinearFit, search: Search, *, known: bool) -> LinearFit:
    """The fit with what comes closest, and with the facts of the matrix, if that is a simple function of h."""
    entries = recovered(search.reading)
    if entries is None:
        return replace(start, nearest=_nearest(*search.tried[0], (search.position, search.stiffness)))
    start = replace(start, nearest=_least_different(search, entries, known=known))
    if not all(entry.exact for entry in entries):
        return start
    qq, qv, vq, vv = (entry.function for entry in entries)
    damping = damping_of(vv)
    facts = facts_of(((qq, qv), (vq, vv)), Fraction(1) if known else search.exact_rates[1], damping)
    return replace(start, damping=damping, facts=facts)


def _nearest(h: float, m: Floats, rates: tuple[float, float]) -> Nearest:
    """The methods that are least far off at one step."""
    off, each = _by_distance(h, m, rates)[0]
    return Nearest(each.keys, h, off, ())


def _least_different(search: Search, entries: Sequence[Recovered], *, known: bool) -> Nearest:
    """The method that differs in one coefficient, if there is one; else the methods that are least far off."""
    (h, m), (position, stiffness) = search.tried[0], search.exact_rates
    rates = (Fraction(1), Fraction(1)) if known else (position, stiffness)
    closest = _by_distance(h, m, (float(rates[0]), float(rates[1])))[:MOST_COMPARED]
    told = [(differences(entries, each, *rates), off, each) for off, each in closest]
    found, off, each = min(told, key=lambda one: (len(one[0]) != 1, one[1]))
    return Nearest(each.keys, h, off, tuple(found[:MOST_DIFFERENCES]))


def _by_distance(h: float, m: Floats, rates: tuple[float, float]) -> list[tuple[float, MethodClass]]:
    """The catalogue for q' = a v, v' = -k q, nearest first, with the distance from a matrix read at h."""
    off = np.nan_to_num(np.max(np.abs(all_matrices(h, *rates) - m), axis=1), nan=inf).tolist()
    return sorted(zip(off, method_classes(), strict=True), key=lambda pair: pair[0])


def _lines(fit: LinearFit) -> Iterator[str]:
    yield from _identity(fit)
    if fit.nearest:
        where = "at states of size 1, nearest" if fit.best else "nearest"
        yield f"{where}: {fit.nearest.methods[0]}, off by {fit.nearest.off:.1e} at h = {fit.nearest.h:g}"
        yield from fit.nearest.differences
    if fit.kind == LINEARISED or fit.amplitude != 1:
        yield f"read at states of size {fit.amplitude:.1e}, where the step is linear"
    yield from _rates(fit)
    if fit.facts:
        yield from _facts(fit.facts)
    yield from fit.remarks


def _identity(fit: LinearFit) -> Iterator[str]:
    if fit.best:
        yield f"{fit.best.words}, to rounding in {fit.format}"
        if fit.best.methods[1:]:
            yield f"no linear test tells {fit.best.methods[0]} from {', '.join(fit.best.methods[1:])}"
        yield from (f"or, as the same map: {other.words}" for other in fit.candidates[1:])
    elif fit.kind in (LINEAR, LINEARISED):
        yield f"no method of the catalogue, nor a relative of one, to rounding in {fit.format}"
    else:
        yield f"{fit.kind}: no method can be named"


def _rates(fit: LinearFit) -> Iterator[str]:
    """The system of small steps, where it is not the oscillator."""
    damping = fit.damping or Fraction(0)
    if fit.position is None or fit.stiffness is None or (fit.position == fit.stiffness == 1 and damping == 0):
        return
    if fit.position != 1:
        yield f"order 0: the position moves by {_times(fit.position, 'h v')}"
    drag = f" {'-' if damping > 0 else '+'} {_times(abs(damping), 'v')}" if damping else ""
    yield f"small steps follow q' = {_times(fit.position, 'v')}, v' = {_times(-fit.stiffness, 'q')}{drag}"


def _times(x: Fraction, of: str) -> str:
    """The product in words: 2 v, -v."""
    if abs(x) == 1:
        return of if x == 1 else f"-{of}"
    return f"{rational_text(x)} {of}"


def _facts(facts: MatrixFacts) -> Iterator[str]:
    named = dict(zip(ENTRIES, facts.entries or (), strict=False))
    texts = {**named, "determinant": facts.determinant, "energy multiplier": facts.energy_multiplier}
    yield from (f"{name} = {text}" for name, text in texts.items() if text and len(text) <= LONGEST_LINE)
    if facts.linear_order is None:
        yield f"no difference from the exact solution up to h^{SERIES_LENGTH - 1}"
    elif facts.linear_order < 0:
        yield "no order: a step of h = 0 moves the state"
    else:
        yield f"linear order {facts.linear_order}"
