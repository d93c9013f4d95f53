"""Near misses: methods that match a reading but for a few coefficients, or with coefficients of few decimals."""

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
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.symbolic.linear.reduced_tableau import StageCoefficients, reduced, reduced_word

# The decimals tried: from as many as a source may print for doubles, down to where other methods are as near.
_DECIMALS = range(14, 3, -1)
# Fewer wrong coefficients are named one by one, up to `known_methods.FEW_DIFFERENCES`.
_LEAST_OFF = 4
# How far coefficients may be off, in units of their last decimal: if rounded; if worked out by hand, as in old tables.
_HOW_FAR = {0.5: "coefficients rounded to {} decimals", 2.0: "coefficients of {} decimals, off by up to 2 in the last"}

# A digit that is mistyped in a coefficient from which others are computed moves all by less; other methods are farther.
_MISTYPED = 2.0**-13


@dataclass(frozen=True)
class Near:
    """A method that matches a reading but for `differences`, such as "b[2]: -1/3 instead of 1/3", `off` in all."""

    key: str
    differences: tuple[str, ...]
    off: float = 0.0

    @property
    def name(self) -> str:
        """The key of the method, followed by the differences."""
        return f"{self.key} except for {'; '.join(self.differences)}"


def near_misses(reading: ForceReading) -> Iterator[Near]:
    """Yield the Runge-Kutta methods that match but for weights and a row of A, the splittings but for sub-steps."""
    parts = reading.parts or ()
    for method in METHODS.values():
        if isinstance(method, RungeKutta) and method.explicit:
            for kept in dict.fromkeys((tuple(range(method.stages)), _used(method))):
                if len(kept) == reading.calls:
                    yield from _as_tableau(reading, method, kept)
        elif isinstance(method, Splitting):
            yield from _as_splitting(reading, parts, method)


@cache
def _used(method: RungeKutta) -> tuple[int, ...]:
    """The stages that the step depends on."""
    # Nodes that are all different prevent `reduced` from merging equal stages.
    labels = tuple(map(Fraction, range(method.stages)))
    return tuple(int(float(label)) for label in reduced(StageCoefficients(method.a, (method.b, method.b), labels)).c)


def _as_splitting(reading: ForceReading, seen: SubSteps, method: Splitting) -> Iterator[Near]:
    word = reduced_word(method)
    if [kind for kind, _ in word] == [kind for kind, _ in seen]:
        allowed = reading.rounding.of(max(abs(float(x)) for _, x in word))
        pairs = enumerate(zip(seen, word, strict=True))
        places = [(f"{kind} {i}", x, exact) for i, ((kind, x), (_, exact)) in pairs]
        wrong = _differing(places, reading, allowed, allowed)
        yield Near(method.key, wrong)
        mine, its = (np.array([float(x) for _, x in each]) for each in (seen, word))
        if typed := _typed(mine, its, reading.rounding):
            yield Near(method.key, (typed,))
        elif len(wrong) >= _LEAST_OFF and (off := float(np.abs(mine - its).max())) <= _MISTYPED:
            yield Near(method.key, (f"{len(wrong)} coefficients, off by up to {off:.1e}, such as {wrong[0]}",))


def _differing(
    places: Iterable[tuple[str, float, Exact]], reading: ForceReading, allowed: float, slack: float = 0.0
) -> tuple[str, ...]:
    """The coefficients that are farther off than allowed, as text."""
    wrong = (place for place in places if abs(place[1] - float(place[2])) > allowed)
    return tuple(coefficient_difference(*place, reading.format, slack) for place in wrong)


def _as_tableau(reading: ForceReading, method: RungeKutta, kept: Sequence[int]) -> Iterator[Near]:
    """Yield the method if the reading has its A, or its A but for one row; b is read directly and may differ."""
    a = np.array([[float(method.a[i][j]) for j in kept] for i in kept])
    b = np.array(reading.b_velocity)
    allowed = reading.rounding.of(2 * max(1.0, float(np.abs(a).max(initial=0.0)), float(np.abs(b).max())))
    weights = [(f"b[{j}]", x, method.b[j]) for j, x in zip(kept, b.tolist(), strict=True)]
    wrong = _differing(weights, reading, allowed)
    if _induces(a, b, reading):
        yield Near(method.key, wrong)
        return
    for i, row in _other_rows(a, b, reading):
        changed = a.copy()
        changed[i, :i] = row
        if _induces(changed, b, reading):
            # The row was found by a division by its weight, which enlarges its error.
            slack = allowed * max(1.0, 1 / abs(b[i])) if b[i] else allowed
            entries = [(f"a[{kept[i]}][{kept[j]}]", x, method.a[kept[i]][kept[j]]) for j, x in enumerate(row.tolist())]
            yield Near(method.key, (*wrong, *_differing(entries, reading, slack, slack)))


def _other_rows(a: Array, b: Array, reading: ForceReading) -> Iterator[tuple[int, Array]]:
    """Yield, for each stage, its row if all others are the method's: from cᵢ with one entry off, or from all (bA)ⱼ."""
    gaps = np.array(reading.c) - a.sum(axis=1)
    rest = np.array(reading.b_position) - b @ a
    for i in range(1, len(b)):
        for j in range(i) if gaps[i] else ():
            yield i, a[i, :i] + gaps[i] * (np.arange(i) == j)
        if b[i]:
            yield i, a[i, :i] + rest[:i] / b[i]


def _induces(a: Array, b: Array, reading: ForceReading) -> bool:
    """True if the table of A and b on q'' = F(q) is the reading, up to the rounding of both."""
    rounding, sizes = reading.rounding, np.abs(a)
    pairs: Sequence[tuple[Array, object, Array]] = (
        (a @ a, reading.a, sizes @ sizes),
        (b @ a, reading.b_position, np.abs(b) @ sizes),
        (a.sum(axis=1), reading.c, sizes.sum(axis=1)),
        (b.sum(), reading.drift, np.abs(b).sum()),
    )
    return all(
        bool((np.abs(np.array(seen) - made) <= rounding.of(2 * float(size.max()))).all()) for made, seen, size in pairs
    )


def typed_in(read: Fingerprint, methods: Iterable[Candidate], rounding: Rounding) -> Iterator[Near]:
    """Yield the methods whose coefficients, typed with few decimals, are those read."""
    for candidate in methods:
        table = candidate.fingerprint
        alike = read.calls == table.calls and read.weights.shape == table.weights.shape
        if alike and (words := _typed(_numbers(read), _numbers(table), rounding)):
            yield Near(candidate.key, (words,))


def _typed(seen: Array, true: Array, rounding: Rounding) -> str:
    """The decimals to which all coefficients read are given, and how right the last of them is; "" if none are few."""
    noise = rounding.of(1.0) * np.maximum(1.0, np.abs(true))
    off = np.abs(seen - true)
    for most, words in _HOW_FAR.items() if (off > noise).sum() >= _LEAST_OFF else ():
        for k in _DECIMALS:
            near = (off <= most * 10.0**-k + noise) & (np.abs(seen - np.round(seen, k)) <= noise)
            if ((off <= noise) | near).all():
                return words.format(k)
    return ""


def _numbers(table: Fingerprint) -> Array:
    """A, the weights and the nodes as one array."""
    return np.vstack([table.a, table.weights, table.nodes[-1]])
