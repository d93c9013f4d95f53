"""A fit held to its bound: at every step read, the error in units of what rounding allows, certified by balls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import NamedTuple

import numpy as np
from flint import arb

from driftproof.blackbox.linear.arithmetics import BALLS, SIZES, precise
from driftproof.blackbox.linear.classes import Rates
from driftproof.blackbox.linear.reading import Floats, Reading
from driftproof.blackbox.linear.search import Fit
from driftproof.symbolic.rounding.formats import BINARY32, FloatFormat

FORWARDS = "but only at h > 0"


class Error(NamedTuple):
    """The worst |read - exact| of some entries, in units of its bound, and relative to 1 + |read|."""

    in_bounds: float
    relative: float


@dataclass(frozen=True)
class Scored:
    """A fit with its worst errors over all steps or, where that is too much, over those that `restriction` names."""

    fit: Fit
    error: Error
    restriction: str = ""

    @property
    def passes(self) -> bool:
        """True when rounding explains every difference."""
        return self.error.in_bounds <= 1


def scored(fit: Fit, reading: Reading) -> Scored:
    """The fit held to its bound; where that fails, with h rounded to binary32 first; where that fails, at fewer steps.

    A fit that fails at a dyadic step within the system's own time is beyond all that, and is not looked at further.
    """
    within = {h for h, _ in reading.steps if 0 < h <= reading.unit and _is_coarse(h)}
    errors: dict[float, Error] = {}
    with precise():
        at_step = _at_step(fit, reading)
        for h, m in sorted(reading.steps, key=lambda step: (step[0] not in within, -step[0])):
            errors[h] = at_step(h, m, None)
            if h in within and errors[h].in_bounds > 1:
                return Scored(fit, errors[h])
        if _worst(errors, _is_coarse).in_bounds <= 1 < _worst(errors).in_bounds:
            rounded = _worst({h: at_step(h, m, BINARY32) for h, m in reading.steps})
            if rounded.in_bounds <= 1:
                return Scored(fit, rounded, "with h rounded to binary32")
    for words, kept in _restrictions(reading.unit):
        worst = _worst(errors, kept)
        if worst.in_bounds <= 1:
            return Scored(fit, worst, words)
    return Scored(fit, _worst(errors))


def _worst(errors: Mapping[float, Error], kept: Callable[[float], bool] = lambda h: True) -> Error:
    found = [error for h, error in errors.items() if kept(h)]
    return Error(max(error.in_bounds for error in found), max(error.relative for error in found))


def _is_coarse(h: float) -> bool:
    """True for a number of binary32."""
    return float(np.float32(h)) == h


def _restrictions(unit: float) -> Sequence[tuple[str, Callable[[float], bool]]]:
    """Where a fit may hold, from everywhere on down."""
    return (
        ("", lambda h: True),
        (FORWARDS, lambda h: h > 0),
        (f"but only at |h| <= {unit:g}", lambda h: abs(h) <= unit),
        (f"but only at 0 < h <= {unit:g}", lambda h: 0 < h <= unit),
    )


def _at_step(fit: Fit, reading: Reading) -> Callable[[float, Floats, FloatFormat | None], Error]:
    """A function of h, of the matrix read there and of a format to which h is rounded first."""
    rates = fit.position, fit.stiffness, fit.damping
    in_balls, in_sizes = ([a.number(x) for x in rates] for a in (BALLS, SIZES))

    def error(h: float, read: Floats, step_format: FloatFormat | None) -> Error:
        used = step_format.nearest(Fraction(h)) if step_format else Fraction(h)
        try:
            exact = fit.model.matrix(BALLS, Rates(BALLS.number(used), *in_balls))
            sizes = fit.model.matrix(SIZES, Rates(SIZES.number(used), *in_sizes))
        except ArithmeticError:  # a pole
            return Error(inf, inf)
        return _error(read, exact, [size.allowance(reading.format) for size in sizes])

    return error


def _error(read: Floats, exact: Sequence[arb], allowed: Sequence[float]) -> Error:
    """The worst errors of the entries; infinite where nothing is known."""
    off = [float(abs(arb(x) - ball).upper()) for x, ball in zip(read, exact, strict=True)]
    if not all(each < inf for each in off):
        return Error(inf, inf)
    in_bounds = max(each / most for each, most in zip(off, allowed, strict=True))
    return Error(in_bounds, max(each / (1 + abs(x)) for each, x in zip(off, read, strict=True)))
