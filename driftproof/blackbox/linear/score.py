"""A fit held to its bound: at every step read, the error in units of what rounding allows, certified by balls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf

import numpy as np
from flint import arb, ctx

from driftproof.blackbox.linear.arithmetics import BALLS, BITS, SIZES
from driftproof.blackbox.linear.classes import Rates
from driftproof.blackbox.linear.reading import Floats, Reading
from driftproof.blackbox.linear.search import Fit
from symbolic.rounding.formats import BINARY32, FloatFormat


@dataclass(frozen=True)
class Scored:
    """A fit with its worst error in units of its bound, over all steps or, where that is too much, over those that
    `restriction` names.
    """

    fit: Fit
    score: float
    restriction: str = ""

    @property
    def passes(self) -> bool:
        """True when rounding explains every difference."""
        return self.score <= 1


def scored(fit: Fit, reading: Reading) -> Scored:
    """The fit held to its bound; where that fails, with h rounded to binary32 first; where that fails, at fewer steps.

    A fit that fails at a dyadic step within the system's own time is beyond all that, and is not looked at further.
    """
    within = [h for h, _ in reading.steps if 0 < h <= reading.unit and _is_coarse(h)]
    scores: dict[float, float] = {}
    matrices = dict(reading.steps)
    with ctx.workprec(BITS):
        at_step = _at_step(fit, reading)
        for h in sorted(matrices, key=lambda h: (h not in within, -h)):
            scores[h] = at_step(h, matrices[h], None)
            if h in within and scores[h] > 1:
                return Scored(fit, scores[h])
        if max(scores.values()) <= 1:
            return Scored(fit, max(scores.values()))
        if all(score <= 1 for h, score in scores.items() if _is_coarse(h)):
            rounded = max(at_step(h, m, BINARY32) for h, m in reading.steps)
            if rounded <= 1:
                return Scored(fit, rounded, "with h rounded to binary32")
    for words, kept in _restrictions(reading.unit):
        worst = max(score for h, score in scores.items() if kept(h))
        if worst <= 1:
            return Scored(fit, worst, words)
    return Scored(fit, max(scores.values()))


def _is_coarse(h: float) -> bool:
    """True for a number of binary32."""
    return float(np.float32(h)) == h


def _restrictions(unit: float) -> Sequence[tuple[str, Callable[[float], bool]]]:
    return (
        ("but only at h > 0", lambda h: h > 0),
        (f"but only at |h| <= {unit:g}", lambda h: abs(h) <= unit),
        (f"but only at 0 < h <= {unit:g}", lambda h: 0 < h <= unit),
    )


def _at_step(fit: Fit, reading: Reading) -> Callable[[float, Floats, FloatFormat | None], float]:
    """A function of h, of the matrix read there and of a format to which h is rounded first: the error, in bounds."""
    rates = fit.position, fit.stiffness, fit.damping
    in_balls, in_sizes = ([a.number(x) for x in rates] for a in (BALLS, SIZES))

    def score(h: float, read: Floats, step_format: FloatFormat | None) -> float:
        used = step_format.nearest(Fraction(h)) if step_format else Fraction(h)
        try:
            exact = fit.model.matrix(BALLS, Rates(BALLS.number(used), *in_balls))
            sizes = fit.model.matrix(SIZES, Rates(SIZES.number(used), *in_sizes))
        except ArithmeticError:  # a pole
            return inf
        return _score(read, exact, [size.allowance(reading.format) for size in sizes])

    return score


def _score(read: Floats, exact: Sequence[arb], allowed: Sequence[float]) -> float:
    """The worst |read - exact| of the entries in units of what is allowed; infinite where nothing is known."""
    worst = 0.0
    for x, ball, most in zip(read, exact, allowed, strict=True):
        off = float(abs(arb(x) - ball).upper())
        worst = max(worst, off / most if off < inf else inf)
    return worst
