"""One-step maps that explain steps of a linear system: methods, the exact solution, adjoints.

A candidate is a one-step map of q' = a v, v' = -k q, with a and k read from a tiny step. It explains a reading if, at
every step, each entry is off by no more than a float program of the map may be; this is certified in balls.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, inf, log10, sqrt
from typing import NamedTuple

import numpy as np
from flint import arb, ctx

from driftproof.blackbox.matching.equivalent_methods import (
    CERTIFYING_BITS,
    ExactFlowMap,
    LinearlyEquivalentMethods,
    LinearMap,
    Rates,
    adjoint_methods,
    all_matrices,
    equivalent_methods,
)
from driftproof.blackbox.probes.coefficients import short_rational, simple_rational
from driftproof.blackbox.probes.linear_steps import RATE_BITS, LinearReading, MatrixEntries
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64, FloatFormat

# The most roundings in a rate read at a tiny step, where the slopes of all stages are equal and are only summed. The
# catalogue shows at most 8 (yoshida8_a); the rest allows for a program's own units and parameters.
_RATE_ROUNDINGS = 1 << 8
# Step sizes at which candidates are tried in floats before they are certified, in units of the reading's own time.
TRIED = (0.25, 0.5)
# The factor by which the roundings of one program may exceed those of another: a term of the longest step in the
# catalogue passes some 1060 (ssprk40_2), a term of the shortest step a few. A candidate that is farther off is within
# its bound only because that bound is wide.
MUCH_FARTHER = 1 << 10
# Chosen: the most explanations of one map that are given.
_MOST = 4
# Chosen: a rate that a mistake in a program makes wrong differs from 1 by at least this much.
_LEAST_OFF = Fraction(1, 1024)
FORWARDS = "but only at h > 0"
# A step that is this near to the exact solution at every step size read is far nearer than methods are there, except
# those that are as good as exact themselves, of which no single one can be named.
NEARLY = 2.0**-30
# Names in use for the methods whose keys do not say clearly which of the two updates comes first.
_NAMES = {
    "symplectic_euler": "velocity-first symplectic Euler",
    "symplectic_euler_position_first": "position-first symplectic Euler",
}


def rates_of(reading: LinearReading) -> tuple[Fraction, Fraction]:
    """The a and k of q' = a v, v' = -k q read at the tiny step, as simple rationals if they are near some."""
    assert reading.at_zero is not None
    slack = max(_RATE_ROUNDINGS * float(reading.format.u), 8 * (reading.tiny / reading.unit) ** 2)
    in_position, in_velocity = reading.at_zero[1:3]
    # What a difference such as (exp(h) - 1)/h rounds by, if the tiny step is so long that this is little.
    rounded = 4 * float(reading.format.u) / reading.tiny
    near = rounded if rounded < 2.0**-RATE_BITS else 0.0
    given = in_position / reading.tiny, -in_velocity / reading.tiny
    rates = [1.0 if abs(x - 1) <= near else x for x in given]
    simple = [simple_rational(x, abs(x) * slack) for x in rates]
    a, k = (Fraction(x) if found is None else found for x, found in zip(rates, simple, strict=True))
    return a, k


def tried_steps(reading: LinearReading) -> list[tuple[float, MatrixEntries]]:
    """The steps h with M(h) at which candidates are tried in floats before they are certified."""
    return [(h, m) for h, m in reading.steps if h / reading.unit in TRIED]


class Error(NamedTuple):
    """The largest |read - exact| of some entries, in units of its bound, and relative to 1 + |read|."""

    in_bounds: float
    relative: float

    @property
    def is_rounding(self) -> bool:
        """True if no entry is beyond its bound."""
        return self.in_bounds <= 1


@dataclass(frozen=True)
class LinearCandidate:
    """A map with its worst error over all steps or, if that exceeds the bound, over those that `restriction` names.

    `methods` are the keys of all methods with its matrix, or with its adjoint's if `adjoint`; empty for the exact
    solution. If `known`, the system is q' = v, v' = -q; otherwise the stepper has a stiffness of its own.
    """

    methods: tuple[str, ...]
    adjoint: bool
    position: Fraction
    stiffness: Fraction
    known: bool
    error: Error
    restriction: str = ""

    @property
    def rates_are_right(self) -> bool:
        """True if the rates read are those of q' = v, v' = -q."""
        return self.position == self.stiffness == 1

    @property
    def extras(self) -> int:
        """The number of ways in which the map differs from a method of the catalogue applied to the system."""
        off = self.position != 1 or (self.known and self.stiffness != 1)
        return bool(self.restriction) + off + self.adjoint

    @property
    def words(self) -> str:
        """The name of the map, with its wrong rates and its restriction."""
        name = _NAMES.get(self.methods[0], self.methods[0]) if self.methods else "the exact solution"
        name = f"{'the adjoint of ' * self.adjoint}{name}"
        return f"{name}{self._rates_in_words()}{f', {self.restriction}' if self.restriction else ''}"

    def _rates_in_words(self) -> str:
        a, k = self.position, self.stiffness
        if a == k == -1 or (a == -1 and not self.known):
            return ", with -h for h: it steps back in time"
        if a == k != 1 and self.known:
            return f", with {short_rational(a)} h for h"
        wrong = [f"the position moves by {short_rational(a)} h v"] * (a != 1)
        wrong += [f"the force enters {short_rational(k)} times"] * (self.known and k != 1)
        return f", but {' and '.join(wrong)}" if wrong else ""


def linear_candidates(reading: LinearReading, *, known: bool) -> list[LinearCandidate]:
    """The candidates that explain the reading with the fewest `extras`, with adjoints only if no other always holds."""
    position, stiffness = rates_of(reading)
    if any(rate != 1 and abs(rate - 1) < _LEAST_OFF for rate in ((position, stiffness) if known else (position,))):
        return []
    found: list[LinearCandidate] = []
    for classes in (equivalent_methods, adjoint_methods):
        maps: list[LinearMap] = [*([] if found else [ExactFlowMap()]), *_near(reading, classes(), position, stiffness)]
        explained = (explained_by(each, reading, position, stiffness, known=known) for each in maps)
        found += [each for each in explained if each.error.is_rounding]
        if any(not each.restriction for each in found):
            break
    if not found:
        return []
    everywhere = [each for each in found if not each.restriction] or found
    most = MUCH_FARTHER * (min(each.error.relative for each in everywhere) + float(reading.format.u))
    near = sorted((each for each in everywhere if each.error.relative <= most), key=lambda each: each.extras)
    return [each for each in near if each.extras == near[0].extras][:_MOST]


def nearly_exact(reading: LinearReading, *, known: bool) -> LinearCandidate | None:
    """The exact solution, restricted by "to 1e-13" or the like, if every step read is near to it; None otherwise."""
    simple = ((simple_rational(x, abs(x) * Fraction(NEARLY)), x) for x in rates_of(reading))
    position, stiffness = (x if near is None else near for near, x in simple)
    with ctx.workprec(CERTIFYING_BITS):
        errors = [_error(ExactFlowMap(), Fraction(h), m, reading.format, position, stiffness) for h, m in reading.steps]
    worst = max((error.relative for error in errors), default=inf)
    if not worst <= NEARLY:
        return None
    return LinearCandidate((), False, position, stiffness, known, Error(inf, worst), f"to 1e{ceil(log10(worst))}")


def _error(
    each: LinearMap, h: Fraction, m: MatrixEntries, fmt: FloatFormat, position: Fraction, stiffness: Fraction
) -> Error:
    rates = Rates(float(h), float(position), float(stiffness))
    exact, allowed = each.matrix_at(h, position, stiffness), each.allowances(rates, fmt)
    off = [*map(lambda x, ball: float(abs(arb(x) - ball).upper()), m, exact)]
    if not all(x < inf for x in off):  # a pole
        return Error(inf, inf)
    in_bounds = max(x / most for x, most in zip(off, allowed, strict=True))
    return Error(in_bounds, max(x / (1 + abs(y)) for x, y in zip(off, m, strict=True)))


def _near(
    reading: LinearReading, classes: tuple[LinearlyEquivalentMethods, ...], position: Fraction, stiffness: Fraction
) -> list[LinearlyEquivalentMethods]:
    """The classes that agree with the reading to half the digits at the steps tried."""
    near, most = np.full(len(classes), True), sqrt(reading.format.u)
    for h, m in tried_steps(reading):
        matrices = all_matrices(classes, Rates(h, float(position), float(stiffness)))
        near &= np.isclose(matrices, m, rtol=most, atol=most).all(axis=1)
    return [each for each, is_near in zip(classes, near.tolist(), strict=True) if is_near]


def explained_by(
    each: LinearMap, reading: LinearReading, position: Fraction, stiffness: Fraction, *, known: bool
) -> LinearCandidate:
    """Compare a map with the reading at all steps; if it fails, with h rounded to binary32, and then at fewer steps."""

    def at(h: float, m: MatrixEntries, step_format: FloatFormat = BINARY64) -> Error:
        return _error(each, step_format.nearest(Fraction(h)), m, reading.format, position, stiffness)

    keys, adjoint = (each.keys, each.adjoint) if isinstance(each, LinearlyEquivalentMethods) else ((), False)
    found = LinearCandidate(keys, adjoint, position, stiffness, known, Error(inf, inf))
    with ctx.workprec(CERTIFYING_BITS):
        errors = {h: at(h, m) for h, m in reading.steps}
        if _worst(errors, lambda h: BINARY32.holds(Fraction(h))).is_rounding and not _worst(errors).is_rounding:
            rounded = _worst({h: at(h, m, BINARY32) for h, m in reading.steps})
            if rounded.is_rounding:
                return replace(found, error=rounded, restriction="with h rounded to binary32")
    for words, kept in _restrictions(reading.unit):
        worst = _worst(errors, kept)
        if worst.is_rounding:
            return replace(found, error=worst, restriction=words)
    return replace(found, error=_worst(errors))


def _worst(errors: Mapping[float, Error], kept: Callable[[float], bool] = lambda h: True) -> Error:
    found = [error for h, error in errors.items() if kept(h)]
    return Error(max((e.in_bounds for e in found), default=inf), max((e.relative for e in found), default=inf))


def _restrictions(unit: float) -> Sequence[tuple[str, Callable[[float], bool]]]:
    """The sets of steps at which a map may hold, from all steps down, each with the words for it."""
    return (
        ("", lambda h: True),
        (FORWARDS, lambda h: h == abs(h)),
        (f"but only at |h| <= {unit:g}", lambda h: abs(h) <= unit),
        (f"but only at 0 < h <= {unit:g}", lambda h: h == abs(h) <= unit),
    )
