"""Identification of a float stepper by its steps of a linear system: a method of the catalogue, or how near one is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf

import numpy as np

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.matching import linear_candidates
from driftproof.blackbox.matching.equivalent_methods import (
    LinearlyEquivalentMethods,
    Rates,
    adjoint_methods,
    all_matrices,
    equivalent_methods,
)
from driftproof.blackbox.matching.matrix_facts import ENTRY_NAMES, SERIES_LENGTH, MatrixFacts, facts_of_class
from driftproof.blackbox.probes import linear_steps as linear
from driftproof.blackbox.probes.coefficients import short_rational
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

# The kind of a linear stepper that cannot be compared with methods: no force acts, or no rates show.
UNDETERMINED = "undetermined"
# Sizes of states for when a limit or a rule disturbs the reading at size 1: two below most limits on the size of a
# state, and one above most thresholds under which a rule puts a state to rest.
OTHER_SIZES = (2.0**-5, 2.0**-10, 2.0**20)
# Steps from those sizes, and from 2**-60 times them, need this many powers of two below 1; binary16 has only 14.
OWN_RANGE = 100
# Solvers in use stop at 1e-4 or below. Chosen: every other method then has to be this many times as far off.
NEARLY, AS_NEAR = 1e-4, 16
# Chosen, as what a reader takes in: the longest line.
LONGEST_LINE = 160


@dataclass(frozen=True)
class Nearest:
    """The methods nearest to a stepper, which share a matrix, and how far `off` it is at one step size h."""

    methods: tuple[str, ...]
    h: float
    off: float


@dataclass(frozen=True)
class LinearFit:
    """The facts that linear steps show of a stepper, as plain data.

    `kind` is the kind of the reading, `amplitude` the size of the states at which it was made, and `format` the one in
    which the stepper computes. `position` and `stiffness` are the a and k of the system q' = a v, v' = -k q that small
    steps follow, but for a drag if no candidate explains them, None if unknown. `candidates` explain the reading, the
    simplest first, and `facts` are those of the first. `nearest` is the closest method if there is no candidate, or the
    closest at states of size 1 if the step is linear at tiny states only. `nearly` is the one method whose steps it
    takes at states of size 1 up to the error of an iterative solver that stops early. `remarks` are for people.
    """

    kind: str
    amplitude: float
    format: str
    position: Fraction | None = None
    stiffness: Fraction | None = None
    candidates: tuple[linear_candidates.LinearCandidate, ...] = ()
    nearest: Nearest | None = None
    facts: MatrixFacts | None = None
    nearly: Nearest | None = None
    remarks: tuple[str, ...] = ()
    limited: bool = False

    @property
    def best(self) -> linear_candidates.LinearCandidate | None:
        """The simplest candidate; None if there is none."""
        return self.candidates[0] if self.candidates else None

    @property
    def doubts(self) -> int:
        """0 if the best candidate holds at all steps, 1 if at all h > 0, 2 if at fewer, 3 if there is none."""
        if self.best is None:
            return 3
        return {"": 0, linear_candidates.FORWARDS: 1}.get(self.best.restriction, 2)

    @property
    def is_disturbed(self) -> bool:
        """True if a reading at states of another size may show more than this one.

        That is so if the best candidate does not hold at all h > 0, or if there is no candidate and something was seen
        that depends on the size of states.
        """
        if self.best is not None:
            return self.doubts > 1
        return self.limited or self.kind == linear.NOT_LINEAR or 0 in (self.position, self.stiffness)

    @property
    def lines(self) -> tuple[str, ...]:
        """The fit as lines of text, the most important first."""
        return tuple(_lines(self))


def linear_fit(subject: ForeignStepper) -> LinearFit:
    """Explain a stepper by its linear steps, on the oscillator or on the system that it has built in.

    It makes some seventy calls, and as many for each other size of states if the first reading is disturbed. Raises the
    Misbehaviour of the first reading.
    """
    known = subject.convention.kind != MAP or bool(subject.convention.extra)
    first = fitted(linear.read_linear_steps(subject), known=known)
    if first.is_disturbed and subject.format.emin < -OWN_RANGE:
        for size in OTHER_SIZES:
            with suppress(Misbehaviour):
                other = fitted(linear.read_linear_steps(subject, size), known=known)
                if other.kind == linear.LINEAR and other.doubts < first.doubts:
                    return other
    return first


def fitted(reading: linear.LinearReading, *, known: bool) -> LinearFit:
    """Explain a reading; if `known`, the system is the oscillator q' = v, v' = -q."""
    kind, remarks, limited = reading.kind, reading.remarks, reading.limited
    start = LinearFit(kind, reading.amplitude, reading.format.name, remarks=remarks, limited=limited)
    if reading.at_zero is None:  # otherwise some steps were read as well
        why = "no tiny step shows a rate: steps do not shrink with h, are noise, or are long in the system's own time"
        return replace(start, kind=UNDETERMINED, remarks=(why, *reading.remarks)) if reading.identifiable else start
    position, stiffness = linear_candidates.rates_of(reading)
    rates = (1.0, 1.0) if known else (float(position), float(stiffness))
    start = replace(start, nearly=_nearly(reading, rates))
    if not reading.identifiable:
        return replace(start, nearest=_nearest(linear_candidates.tried_steps(reading), rates))
    if all((m[0], *m[2:]) == (1, 0, 1) for _, m in reading.steps):
        return replace(start, kind=UNDETERMINED, remarks=("no force acts: all methods agree", *reading.remarks))
    if reading.starts_at_identity:
        start = replace(start, position=position, stiffness=stiffness)
    if known and reading.ordinary:
        h, m = reading.ordinary[0]
        (off, each), *_ = _by_distance(h, m, rates)
        start = replace(start, nearest=Nearest(each.keys, h, off))
    found = linear_candidates.linear_candidates(reading, known=known) if position and stiffness else []
    if all(each.restriction for each in found) and (nearly := linear_candidates.nearly_exact(reading, known=known)):
        return replace(start, candidates=(nearly,), position=nearly.position, stiffness=nearly.stiffness)
    if not found:
        return replace(start, nearest=_nearest(linear_candidates.tried_steps(reading), rates))
    start = replace(start, nearly=None) if start.kind == linear.LINEAR else start
    # The facts are those of the first of the candidates.
    first, system, facts = found[0], Fraction(1) if found[0].known else found[0].stiffness, MatrixFacts(*[None] * 4)
    for each in adjoint_methods() if first.adjoint else equivalent_methods():
        if each.keys == first.methods:
            facts = facts_of_class(each, first.position, first.stiffness, system)
    return replace(start, candidates=tuple(found), facts=facts)


def _nearest(steps: Sequence[tuple[float, linear.MatrixEntries]], rates: tuple[float, float]) -> Nearest | None:
    """The nearest methods at the smallest step size at which none agrees exactly; None if there is no such step."""
    for h, m in sorted(steps):
        off, each = _by_distance(h, m, rates)[0]
        if off > 0:
            return Nearest(each.keys, h, off)
    return None


def _nearly(reading: linear.LinearReading, rates: tuple[float, float]) -> Nearest | None:
    """The class that is near, and far nearer than any other, at states of size 1; None if the step is too nonlinear."""
    dyadic = [(h, m) for h, m in reading.steps if h / reading.unit in linear.ORDINARY_STEPS]
    steps = reading.ordinary or (dyadic if reading.kind == linear.LINEAR and reading.amplitude == 1 else [])
    if not steps or reading.loose > NEARLY:
        return None
    off: dict[tuple[str, ...], float] = {}
    for h, m in steps:
        for distance, each in _by_distance(h, m, rates):
            off[each.keys] = max(distance, off.get(each.keys, 0.0))
    (best, distance), (_, second), *_ = sorted(off.items(), key=lambda pair: pair[1])
    return Nearest(best, steps[0][0], distance) if distance <= NEARLY and AS_NEAR * distance < second else None


def _by_distance(
    h: float, m: linear.MatrixEntries, rates: tuple[float, float]
) -> list[tuple[float, LinearlyEquivalentMethods]]:
    """The classes for q' = a v, v' = -k q with their distances from a matrix read at h, the nearest first."""
    classes = equivalent_methods()
    off = np.nan_to_num(np.max(np.abs(all_matrices(classes, Rates(h, *rates)) - m), axis=1), nan=inf).tolist()
    return sorted(zip(off, classes, strict=True), key=lambda pair: pair[0])


def _lines(fit: LinearFit) -> Iterator[str]:
    yield from _identity(fit)
    if fit.nearest:
        where = "at states of size 1, nearest" if fit.best else "nearest"
        off = f"off by {fit.nearest.off:.1e}" if fit.nearest.off else "the same matrix"
        yield f"{where}: {fit.nearest.methods[0]}, {off} at h = {fit.nearest.h:g}"
    if fit.kind == linear.LINEARISED or fit.amplitude != 1:
        yield f"read at states of size {fit.amplitude:.1e}, where the step is linear"
    yield from _rates(fit)
    if fit.facts:
        yield from _facts(fit.facts)
    yield from fit.remarks


def _identity(fit: LinearFit) -> Iterator[str]:
    if fit.nearly:
        near = f"nearly {fit.nearly.methods[0]} at states of size 1, to {fit.nearly.off:.1e}"
        yield near if fit.nearly.off else f"{fit.nearly.methods[0]} in numbers of few bits at states of size 1"
    if fit.best:
        yield f"{fit.best.words}{f', to rounding in {fit.format}' * fit.best.error.is_rounding}"
        if fit.best.methods[1:]:
            yield f"no linear test distinguishes {fit.best.methods[0]} from {', '.join(fit.best.methods[1:])}"
        yield from (f"or, as the same map: {other.words}" for other in fit.candidates[1:])
    elif fit.kind in (linear.LINEAR, linear.LINEARISED):
        yield f"no method of the catalogue, nor the adjoint of one, to rounding in {fit.format}"
    else:
        yield f"{fit.kind}: no method can be named"


def _rates(fit: LinearFit) -> Iterator[str]:
    """Yield the system that small steps follow, if it is not the oscillator, and is known to have no drag."""
    if fit.position is None or fit.stiffness is None or fit.position == fit.stiffness == 1:
        return
    if fit.position != 1:
        yield f"order 0: the position moves by {_times(fit.position, 'h v')}"
    if fit.best:
        yield f"small steps follow q' = {_times(fit.position, 'v')}, v' = {_times(-fit.stiffness, 'q')}"


def _times(x: Fraction, of: str) -> str:
    """The product as text, such as "2 v", "-v" or "0"."""
    if x == 0:
        return "0"
    if abs(x) == 1:
        return of if x == 1 else f"-{of}"
    return f"{short_rational(x)} {of}"


def _facts(facts: MatrixFacts) -> Iterator[str]:
    named = dict(zip(ENTRY_NAMES, facts.entries or (), strict=False))
    texts = {**named, "determinant": facts.determinant, "energy multiplier": facts.energy_multiplier}
    yield from (f"{name} = {text}" for name, text in texts.items() if text and len(text) <= LONGEST_LINE)
    if facts.linear_order is None:
        yield f"no difference from the exact solution up to h^{SERIES_LENGTH - 1}"
    elif facts.linear_order < 0:
        yield "no order: a step of h = 0 moves the state"
    else:
        yield f"linear order {facts.linear_order}"
