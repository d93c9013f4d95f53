"""Whether a step can be taken back: by a step of -h, and by turning the velocity round and stepping on."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import log2

from driftproof.blackbox.contract.bench import TYPICAL_STEP, Bench, State, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.stepper.subject import Subject

_SYMMETRIC = "symmetric"
_STEPS = (1.0, 0.5, 0.25, 0.125, 0.0625)
# Measured powers of the methods of the catalogue are nearer than this to the true ones, or no leading term rules yet.
_NEAR = 1 / 8
# There and back from a state with one h.
_Round = Callable[[Bench, State, float], State]


def reversal(subject: Subject) -> tuple[Clause, ...]:
    """S(-h) S(h) = 1, which makes a method symmetric, and (R S(h))² = 1 with R (q, v) = (q, -v), reversible."""
    bench = steady_bench(subject)
    return (
        _clause(bench, _SYMMETRIC, "S(-h) undoes S(h)", _back_in_time),
        _clause(bench, "reversible", "a step with the velocity turned round undoes a step", _turned_round),
    )


def _back_in_time(bench: Bench, z: State, h: float) -> State:
    return bench.step(*bench.step(*z, h), -h)


def _turned_round(bench: Bench, z: State, h: float) -> State:
    q, v = bench.step(*z, h)
    q, v = bench.step(q, -v, h)
    return q, -v


def _clause(bench: Bench, key: str, words: str, back: _Round) -> Clause:
    try:
        defects = [_defect(bench, back, h) for h in _STEPS]
    except Misbehaviour as seen:
        return Clause(key, None, f"not asked: {seen}")
    if max(defects) <= bench.rounding:
        return Clause(key, True, f"{words}, to rounding")
    return Clause(key, False, f"{words} up to {_shown(bench, defects)}", _example(bench, key))


def _defect(bench: Bench, back: _Round, h: float) -> float:
    """How far from its start a state comes back, relative to it, in the larger component; the worse of two states."""
    return max(
        max(abs(x - y) for x, y in zip(back(bench, z, h), z, strict=True)) / max(map(abs, z))
        for z in (bench.ordinary, bench.another)
    )


def _shown(bench: Bench, defects: list[float]) -> str:
    """The defect at h = 1/4, or at the next longer step at which it is more than rounding, and its leading power."""
    seen = [(h, defect) for h, defect in zip(_STEPS, defects, strict=True) if defect > bench.rounding]
    h, defect = min(seen, key=lambda pair: abs(log2(pair[0]) - log2(TYPICAL_STEP)))
    words = f"a defect of {defect:.2g} at h = {Fraction(h)}"
    power = _power([defect for _, defect in seen])
    if power is None:
        return words
    return f"{words} that falls as h**{power}" if power > 0 else f"{words} that does not fall with h"


def _power(defects: list[float]) -> int | None:
    """k where the defects at h, h/2, h/4, ... fall as h**k; None where no whole k is near."""
    if len(defects) < 2:
        return None
    power = log2(defects[-2] / defects[-1])
    return round(power) if abs(power - round(power)) < _NEAR else None


def _example(bench: Bench, key: str) -> tuple[Trial, ...]:
    first = bench.trial(*bench.ordinary, TYPICAL_STEP)
    assert first.answer is not None
    q, v = first.answer
    second = (q, v, -TYPICAL_STEP) if key == _SYMMETRIC else (q, -v, TYPICAL_STEP)
    return first, bench.trial(*second)
