"""Checks of geometry: whether a step is symmetric and reversible, and whether it keeps areas and norms."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import log2, sqrt

from driftproof.blackbox.checks.trials import TYPICAL_STEP, CheckResult, PhasePoint, Trial, TrialRunner, steady_runner
from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

_STEPS = (1.0, 0.5, 0.25, 0.125, 0.0625)
# Measured powers of catalogue methods are nearer to a whole number than this, unless no leading term shows yet.
_NEAR = 1 / 8


def reversal(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check symmetry, S(-h) S(h) = 1, and reversibility, (R S(h))² = 1 with R (q, v) = (q, -v)."""
    runner = steady_runner(subject)
    return (
        _undone(runner, "symmetric", "S(-h) undoes S(h)", turn=1, way=-1),
        _undone(runner, "reversible", "a step with the velocity reversed undoes a step", turn=-1, way=1),
    )


def _undone(runner: TrialRunner, key: str, words: str, turn: int, way: int) -> CheckResult:
    """Check that a step, its velocity times `turn`, is undone by one of `way` h; the worse of two states counts."""

    def defect(z: PhasePoint, h: float) -> float:
        q, v = runner.step(*z, h)
        q, v = runner.step(q, turn * v, way * h)
        return max(abs(x - y) for x, y in zip((q, turn * v), z, strict=True)) / max(map(abs, z))

    try:
        defects = [max(defect(z, h) for z in (runner.ordinary, runner.another)) for h in _STEPS]
    except Misbehaviour as seen:
        return CheckResult(key, None, f"not tested: {seen}")
    if max(defects) <= runner.rounding:
        return CheckResult(key, True, f"{words}, to rounding")
    there = runner.trial(*runner.ordinary, TYPICAL_STEP)
    assert there.answer is not None
    q, v = there.answer
    example = there, runner.trial(q, turn * v, way * TYPICAL_STEP)
    return CheckResult(key, False, f"{words} up to {_shown(runner, defects)}", example)


def _shown(runner: TrialRunner, defects: list[float]) -> str:
    """The defect in words, at h = 1/4 or the nearest h where it is more than rounding, and its leading power."""
    seen = [(h, defect) for h, defect in zip(_STEPS, defects, strict=True) if defect > runner.rounding]
    h, defect = min(seen, key=lambda pair: abs(log2(pair[0]) - log2(TYPICAL_STEP)))
    words = f"a defect of {defect:.2g} at h = {Fraction(h)}"
    if len(seen) < 2:
        return words
    power = log2(seen[-2][1] / seen[-1][1])  # the k for which the defects at h, h/2, h/4, ... fall as h**k
    if not abs(power - round(power)) < _NEAR:
        return words
    return f"{words} that falls as h**{round(power)}" if round(power) > 0 else f"{words} that does not fall with h"


_AREA, _NORM = "area_preserving", "norm_preserving"
# The second step shows changes by methods of high order, which are lost in rounding at the first.
_AREA_STEPS = (TYPICAL_STEP, 1.0)
# Each of four differences is off by d²/6 times a third derivative of the step: room for one of size 100.
_TERMS = 64


def area(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check the determinant of a step, and what it does to q² + v², twice the oscillator's energy."""
    runner = steady_runner(subject)
    columns = [found for found in (_columns(runner, h) for h in _AREA_STEPS) if found is not None]
    if len(columns) < len(_AREA_STEPS):
        return _by_differences(runner), CheckResult(_NORM, None, "not tested: the step is not linear")
    areas = [_area(m.a * m.d - m.b * m.c, runner.rounding * m.size, m.where, m.trials) for m in columns]
    both = areas, [_norm(runner, m) for m in columns]
    return tuple(next((check for check in checks if not check.holds), checks[0]) for checks in both)


@dataclass(frozen=True)
class _Columns:
    """The columns (a, c) = S(1, 0) and (b, d) = S(0, 1), less S(0, 0), of a step of h."""

    h: float
    a: Fraction
    c: Fraction
    b: Fraction
    d: Fraction
    trials: tuple[Trial, ...]

    @property
    def where(self) -> str:
        return f"in a step of h = {Fraction(self.h)}"

    @property
    def size(self) -> float:
        """The size of the terms in the determinant and in the lengths of columns; at least 1."""
        return max(1.0, float(max(abs(x) for x in (self.a, self.b, self.c, self.d)) ** 2))


def _columns(runner: TrialRunner, h: float) -> _Columns | None:
    """The columns of a linear or affine step; None if the step is neither, to rounding."""
    units = (runner.size, 0.0), (0.0, runner.size)
    origin, first, second = (runner.step(*z, h) for z in ((0.0, 0.0), *units))
    q0, v0 = map(Fraction, origin)
    size = Fraction(runner.size)
    (a, c), (b, d) = (((Fraction(x) - q0) / size, (Fraction(y) - v0) / size) for x, y in (first, second))
    q, v = map(Fraction, runner.ordinary)
    seen = runner.step(*runner.ordinary, h)
    for x, row in zip(seen, ((q0, a * q, b * v), (v0, c * q, d * v)), strict=True):
        if abs(Fraction(x) - sum(row)) > Fraction(runner.rounding) * sum(map(abs, row)):
            return None
    return _Columns(h, a, c, b, d, tuple(runner.trial(*z, h) for z in units))


def _area(determinant: Fraction, allowed: float, where: str, trials: tuple[Trial, ...]) -> CheckResult:
    if abs(determinant - 1) <= allowed:
        return CheckResult(_AREA, True, f"areas are preserved, to rounding, {where}", trials)
    turned = " and change orientation" if determinant < 0 else ""
    size = abs(determinant)
    words = f"areas {'grow' if size > 1 else 'shrink'} by the factor {float(size):.10g}{turned} {where}"
    return CheckResult(_AREA, False, words, trials)


def _norm(runner: TrialRunner, m: _Columns) -> CheckResult:
    """Check q² + v² by the matrix MᵀM: its eigenvalues are the least and the largest value of |Mz|²/|z|²."""
    p, r, s = m.a**2 + m.c**2, m.a * m.b + m.c * m.d, m.b**2 + m.d**2
    mean, spread = (p + s) / 2, sqrt(((p - s) / 2) ** 2 + r**2)
    allowed = runner.rounding * m.size
    if spread > allowed:
        least, most = float(mean) - spread, float(mean) + spread
        words = f"q**2 + v**2 changes by a factor from {least:.6g} to {most:.6g} {m.where}, depending on the state"
        return CheckResult(_NORM, False, words, m.trials)
    if abs(mean - 1) <= allowed:
        return CheckResult(_NORM, True, f"q**2 + v**2 is preserved, to rounding, {m.where}", m.trials)
    words = f"q**2 + v**2 {'grows' if mean > 1 else 'shrinks'} by the factor {float(mean):.10g} {m.where}"
    return CheckResult(_NORM, False, words, m.trials)


def _by_differences(runner: TrialRunner) -> CheckResult:
    """Check the determinant near a state, from central differences.

    With d = u**(1/3) their truncation errors, of size d², and their rounding errors, u/d, balance.
    """
    part = 2.0 ** -(runner.format.precision // 3)
    d, (q, v), h = runner.size * part, runner.ordinary, TYPICAL_STEP
    ends = (((q + d, v), (q - d, v)), ((q, v + d), (q, v - d)))
    steps = [[tuple(map(Fraction, runner.step(*z, h))) for z in pair] for pair in ends]
    (a, c), (b, e) = ([(x - y) / Fraction(2 * d) for x, y in zip(*pair, strict=True)] for pair in steps)
    where = f"in a step of h = {Fraction(h)} from near ({q:.3g}, {v:.3g})"
    return _area(a * e - b * c, _TERMS * part * part, where, (runner.trial(q, v, h),))
