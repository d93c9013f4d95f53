"""A Nyström reading as a method with a few coefficients of its own changed: one wrong number shows in many places."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np

from driftproof.blackbox.matching.candidates import Candidate
from driftproof.blackbox.matching.tables import Array, Fingerprint
from driftproof.blackbox.probes.coefficients import coefficient_difference
from driftproof.blackbox.probes.force import ForceReading, SubSteps
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced, reduced_word


@dataclass(frozen=True)
class NearMiss:
    """The method `key` with other values in a few of its own coefficients, each as "b[2]: -1/3 instead of 1/3"."""

    key: str
    differences: tuple[str, ...]


def near_misses(reading: ForceReading) -> Iterator[NearMiss]:
    """The Runge-Kutta methods that the reading is but for weights and a row of A, the splittings but for sub-steps."""
    parts = reading.parts or ()
    for method in METHODS.values():
        if isinstance(method, RungeKutta) and method.explicit:
            for kept in (range(method.stages), _used(method)):
                if len(kept) == reading.calls:
                    yield from _as_tableau(reading, method, kept)
        elif isinstance(method, Splitting):
            yield from _as_splitting(reading, parts, method)


@cache
def _used(method: RungeKutta) -> Sequence[int]:
    """The stages that the step depends on, if those are not all; nodes that are all different keep others apart."""
    labels = tuple(map(Fraction, range(method.stages)))
    kept = [int(float(label)) for label in reduced(StageCoefficients(method.a, (method.b, method.b), labels)).c]
    return kept if len(kept) < method.stages else ()


def _as_splitting(reading: ForceReading, seen: SubSteps, method: Splitting) -> Iterator[NearMiss]:
    word = reduced_word(method)
    if [kind for kind, _ in word] != [kind for kind, _ in seen]:
        return
    allowed = _rounding(reading).of(max(abs(float(x)) for _, x in word))
    pairs = enumerate(zip(seen, word, strict=True))
    wrong = [(f"{kind} {i}", x, exact) for i, ((kind, x), (_, exact)) in pairs if abs(x - float(exact)) > allowed]
    yield NearMiss(method.key, tuple(coefficient_difference(*place, reading.format, allowed) for place in wrong))


def _as_tableau(reading: ForceReading, method: RungeKutta, kept: Sequence[int]) -> Iterator[NearMiss]:
    """b is read as it is; with it, A is the method's, or the method's but for one row."""
    a = np.array([[float(method.a[i][j]) for j in kept] for i in kept])
    b, fmt = np.array(reading.b_velocity), reading.format
    allowed = _rounding(reading).of(2 * max(1.0, float(np.abs(a).max(initial=0.0)), float(np.abs(b).max())))
    weights = [(f"b[{j}]", x, method.b[j]) for j, x in zip(kept, b.tolist(), strict=True)]
    wrong = [coefficient_difference(*place, fmt) for place in weights if abs(place[1] - float(place[2])) > allowed]
    if _induces(a, b, reading):
        yield NearMiss(method.key, tuple(wrong))
        return
    for i, row in _other_rows(a, b, reading):
        changed = a.copy()
        changed[i, :i] = row
        if _induces(changed, b, reading):
            # A row is a quotient by its weight, and as much less certain.
            slack = allowed * max(1.0, 1 / abs(b[i])) if b[i] else allowed
            entries = [(f"a[{kept[i]}][{kept[j]}]", x, method.a[kept[i]][kept[j]]) for j, x in enumerate(row.tolist())]
            rows = [
                coefficient_difference(*place, fmt, slack)
                for place in entries
                if abs(place[1] - float(place[2])) > slack
            ]
            yield NearMiss(method.key, (*wrong, *rows))


def _other_rows(a: Array, b: Array, reading: ForceReading) -> Iterator[tuple[int, Array]]:
    """The row that each stage has if all others are the method's: by cᵢ, where one entry is off, or else by (bA)ⱼ."""
    gaps = np.array(reading.c) - a.sum(axis=1)
    rest = np.array(reading.b_position) - b @ a
    for i in range(1, len(b)):
        for j in range(i) if gaps[i] else ():
            yield i, a[i, :i] + gaps[i] * (np.arange(i) == j)
        if b[i]:
            yield i, a[i, :i] + rest[:i] / b[i]


def _induces(a: Array, b: Array, reading: ForceReading) -> bool:
    """True when A and b have the reading as their table for q'' = F(q), up to the rounding of both."""
    rounding, sizes = _rounding(reading), np.abs(a)
    pairs: Sequence[tuple[Array, object, Array]] = (
        (a @ a, reading.a, sizes @ sizes),
        (b @ a, reading.b_position, np.abs(b) @ sizes),
        (a.sum(axis=1), reading.c, sizes.sum(axis=1)),
        (b.sum(), reading.drift, np.abs(b).sum()),
    )
    return all(
        bool((np.abs(np.array(seen) - made) <= rounding.of(2 * float(size.max()))).all()) for made, seen, size in pairs
    )


def _rounding(reading: ForceReading) -> Rounding:
    return reading.rounding


# From as many as a source may print, in double precision, down to where other methods are as near.
DECIMALS = range(14, 3, -1)
# Fewer are named one by one, up to `match.FEW_DIFFERENCES`.
_LEAST_OFF = 4
# How far numbers may be off, in units of their last decimal: rounded; or worked out by hand, as old tables are.
BY_HAND = 2.0
HOW_FAR = {0.5: "coefficients rounded to {} decimals", BY_HAND: "coefficients of {} decimals, the last up to 2 off"}


def typed_in(read: Fingerprint, methods: Iterable[Candidate], rounding: Rounding) -> Iterator[tuple[str, str]]:
    """The methods whose coefficients, to so many decimals, are those read: keys, and in words how they differ."""
    for candidate in methods:
        for most, words in HOW_FAR.items():
            decimals = _decimals(read, candidate.fingerprint, rounding, most)
            if decimals is not None:
                yield candidate.key, words.format(decimals)
                break


def _decimals(read: Fingerprint, exact: Fingerprint, rounding: Rounding, most: float) -> int | None:
    """The decimals of which each coefficient read is the exact one, or within `most` of the last; None if none."""
    if read.calls != exact.calls or read.weights.shape != exact.weights.shape:
        return None
    seen, true = _numbers(read), _numbers(exact)
    noise = rounding.of(1.0) * np.maximum(1.0, np.abs(true))
    off = np.abs(seen - true)
    if (off > noise).sum() < _LEAST_OFF or not (off <= most * 10.0 ** -DECIMALS[-1]).all():
        return None
    for k in DECIMALS:
        near = (off <= most * 10.0**-k + noise) & (np.abs(seen - np.round(seen, k)) <= noise)
        if ((off <= noise) | near).all():
            return k
    return None


def _numbers(table: Fingerprint) -> Array:
    """All of A, of the weights and of the times."""
    return np.vstack([table.a, table.weights, table.nodes[-1]])
