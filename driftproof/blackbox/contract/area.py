"""What a step does to areas and to q² + v²: from its columns where it is linear, from differences where it is not."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import sqrt

from driftproof.blackbox.contract.bench import TYPICAL_STEP, Bench, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.stepper.subject import Subject

_AREA, _NORM = "area_preserving", "norm_preserving"
# What a method of high order changes is lost in rounding at the first.
_STEPS = (TYPICAL_STEP, 1.0)
# Four differences, each off by a few d².
_TERMS = 64


def area(subject: Subject) -> tuple[Clause, ...]:
    """The determinant of a step, and what it does to q² + v², twice the oscillator's energy."""
    bench = steady_bench(subject)
    columns = [found for found in (_columns(bench, h) for h in _STEPS) if found is not None]
    if len(columns) < len(_STEPS):
        return _by_differences(bench), Clause(_NORM, None, "not asked: the step is not linear")
    return tuple(
        next((clause for clause in clauses if not clause.holds), clauses[0])
        for clauses in ([_area(bench, m) for m in columns], [_norm(bench, m) for m in columns])
    )


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
    def size(self) -> float:
        """The sizes that are added in the determinant and in the lengths of columns; at least 1."""
        return max(1.0, float(max(abs(x) for x in (self.a, self.b, self.c, self.d)) ** 2))


def _columns(bench: Bench, h: float) -> _Columns | None:
    """The columns of a step that is linear, or linear but for a constant; None if it is not, to rounding."""
    units = (bench.size, 0.0), (0.0, bench.size)
    origin, first, second = (bench.step(*z, h) for z in ((0.0, 0.0), *units))
    q0, v0 = map(Fraction, origin)
    size = Fraction(bench.size)
    (a, c), (b, d) = (((Fraction(x) - q0) / size, (Fraction(y) - v0) / size) for x, y in (first, second))
    q, v = map(Fraction, bench.ordinary)
    seen = bench.step(*bench.ordinary, h)
    for x, row in zip(seen, ((q0, a * q, b * v), (v0, c * q, d * v)), strict=True):
        if abs(Fraction(x) - sum(row)) > Fraction(bench.rounding) * sum(map(abs, row)):
            return None
    return _Columns(h, a, c, b, d, tuple(bench.trial(*z, h) for z in units))


def _area(bench: Bench, m: _Columns) -> Clause:
    where = f"in a step of h = {Fraction(m.h)}"
    return _of_determinant(m.a * m.d - m.b * m.c, bench.rounding * m.size, where, m.trials)


def _of_determinant(determinant: Fraction, allowed: float, where: str, trials: tuple[Trial, ...]) -> Clause:
    if abs(determinant - 1) <= allowed:
        return Clause(_AREA, True, f"areas are kept, to rounding, {where}", trials)
    turned = " and are turned over" if determinant < 0 else ""
    size = abs(determinant)
    words = f"areas {'grow' if size > 1 else 'shrink'} by the factor {_factor(size)}{turned} {where}"
    return Clause(_AREA, False, words, trials)


def _factor(x: Fraction) -> str:
    return f"{float(x):.10g}"


def _norm(bench: Bench, m: _Columns) -> Clause:
    """From the matrix MᵀM: the least and the largest value of |Mz|²/|z|² are its eigenvalues."""
    p, r, s = m.a**2 + m.c**2, m.a * m.b + m.c * m.d, m.b**2 + m.d**2
    mean, spread = (p + s) / 2, sqrt(((p - s) / 2) ** 2 + r**2)
    where, allowed = f"in a step of h = {Fraction(m.h)}", bench.rounding * m.size
    if spread > allowed:
        least, most = float(mean) - spread, float(mean) + spread
        words = f"q**2 + v**2 changes by a factor from {least:.6g} to {most:.6g} {where}, depending on the state"
        return Clause(_NORM, False, words, m.trials)
    if abs(mean - 1) <= allowed:
        return Clause(_NORM, True, f"q**2 + v**2 is kept, to rounding, {where}", m.trials)
    words = f"q**2 + v**2 {'grows' if mean > 1 else 'shrinks'} by the factor {_factor(mean)} {where}"
    return Clause(_NORM, False, words, m.trials)


def _by_differences(bench: Bench) -> Clause:
    """The determinant near a state, from central differences.

    With d = u**(1/3) the terms that they leave out, of the size d², and their rounding, u/d, balance.
    """
    part = 2.0 ** -(bench.format.precision // 3)
    d, (q, v), h = bench.size * part, bench.ordinary, TYPICAL_STEP
    ends = (((q + d, v), (q - d, v)), ((q, v + d), (q, v - d)))
    steps = [[tuple(map(Fraction, bench.step(*z, h))) for z in pair] for pair in ends]
    (a, c), (b, e) = ([(x - y) / Fraction(2 * d) for x, y in zip(*pair, strict=True)] for pair in steps)
    where = f"in a step of h = {Fraction(h)} from near ({q:.3g}, {v:.3g})"
    return _of_determinant(a * e - b * c, _TERMS * part * part, where, (bench.trial(q, v, h),))
