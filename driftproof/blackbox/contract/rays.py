"""Steps along rays of states, and how a stepper departs from proportionality there: at a border, or in a curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, log2, log10

from driftproof.blackbox.contract.bench import TYPICAL_STEP, Bench, State
from driftproof.blackbox.contract.clauses import Clause, Trial
from driftproof.blackbox.contract.still import NAMES, Still, still
from driftproof.blackbox.contract.thresholds import edge, named

LINEAR = "linear"
# At four times the size at which it shows first, a departure that bends, as the sixth power of the size or less, is not
# this much larger; one that begins at a border is, or a good part of the whole.
_SOON, _SHARP, _PLAIN = 4.0, 2.0**16, 2.0**-4
# Where the step is another so soon, there is no part in which it is the same.
_NEXT = 1 + 2.0**-20


@dataclass(frozen=True)
class Ray:
    """The states s z, s > 0."""

    bench: Bench
    z: State

    @property
    def component(self) -> int:
        """The component that is not 0."""
        return int(self.z[0] == 0)

    def trial(self, s: float) -> Trial:
        """The step from s z."""
        q, v = (self.bench.number(s * x) for x in self.z)
        return self.bench.trial(q, v, TYPICAL_STEP)

    def over(self, s: float) -> tuple[float, float] | None:
        """S(sz)/s; None where there is no finite answer."""
        trial = self.trial(s)
        return (trial.answer[0] / s, trial.answer[1] / s) if trial.answer and trial.finite else None


def apart(first: Sequence[float] | None, second: Sequence[float] | None) -> float:
    """How far one is from the other, relative to it; 0 where there is none, which is another matter."""
    if first is None or second is None or first == second:
        return 0.0
    distance, size = max(abs(x - y) for x, y in zip(first, second, strict=True)), max(map(abs, second))
    return distance / size if size else inf


@dataclass(frozen=True)
class _Border:
    """Where a ray leaves the linear part: at which size of its component, and what is the same beyond, in words."""

    name: str
    is_above: bool
    value: str
    beyond: tuple[str, ...]
    example: tuple[Trial, ...]


def departing(broken: Sequence[tuple[Ray, float, float]]) -> Clause:
    """The clause of a step that is linear up to borders only, or nowhere; of rays with the two s in between."""
    short = still(broken[0][0].bench)
    borders = []
    for ray, low, high in broken:
        if short is not None and _leaves_domain(short, ray, low, high):
            continue  # that is told by another clause
        s = _beginning(ray, low, high)
        soon = _departure(ray, low, _SOON * s)
        if s <= low * _NEXT or soon <= min(_SHARP * ray.bench.rounding, _PLAIN):
            return _nowhere(ray, low, s)
        borders.append(_border(ray, s))
    if not borders:
        return Clause(LINEAR, True, "linear within its domain, to rounding")
    return Clause(LINEAR, False, "; ".join(_in_words(borders)), tuple(t for border in borders for t in border.example))


def _in_words(borders: Sequence[_Border]) -> list[str]:
    """One sentence for each border, or for two that mirror each other."""
    words, left = [], list(borders)
    while left:
        first, *left = left
        mirrored = [b for b in left if (b.name, b.value) == (first.name, first.value)]
        left = [b for b in left if b not in mirrored]
        alone = f"{first.name} = {'' if first.is_above else '-'}{first.value}"
        where = f"|{first.name}| = {first.value}" if mirrored else alone
        more = f": {', '.join(first.beyond)}" if first.beyond else ""
        words.append(f"linear up to {where} and no further{more}")
    return words


def _beginning(ray: Ray, low: float, high: float) -> float:
    """The first s at which the step is not as at `low`."""
    return edge(lambda s: _departure(ray, low, s) > ray.bench.rounding, low, high, ray.bench)[1]


def _departure(ray: Ray, low: float, s: float) -> float:
    return apart(ray.over(s), ray.over(low))


def _nowhere(ray: Ray, low: float, s: float) -> Clause:
    """No part is linear, or only as a curve is near 0: by which power it bends where that is one."""
    soon, later = _departure(ray, low, _SOON * s), _departure(ray, low, _SOON**2 * s)
    power = log2(later / soon) / log2(_SOON) if 0 < soon < inf and 0 < later < inf else 0.0
    bends = low * _SOON < 1 and round(power) > 0 and abs(power - round(power)) < 0.25
    at, name = max(1.0, low * _SOON), NAMES[ray.component]
    words = f"nonlinear: at {name} = {at * ray.z[ray.component]:.3g} it departs from proportionality by "
    words += f"{_departure(ray, low, at):.2g}{f', growing as the power {round(power)} of the size' if bends else ''}"
    return Clause(LINEAR, False, words, (ray.trial(low), ray.trial(at)))


def _border(ray: Ray, s: float) -> _Border:
    far = [ray.trial(_SOON * s), ray.trial(_SOON**2 * s)]
    constant = tuple(filter(None, (_constant(far, component, ray.bench.rounding) for component in (0, 1))))
    value, digits = s * ray.z[ray.component], round(-log10(ray.bench.rounding)) - 2
    return _Border(NAMES[ray.component], value > 0, f"{abs(value):.{digits}g}", constant, (ray.trial(s), far[0]))


def _leaves_domain(short: Still, ray: Ray, low: float, s: float) -> bool:
    """True when a rule changes the state itself, or the one where a linear step would go, before anything moves."""
    straight = ray.over(low)
    states = [ray.z] if straight is None else [ray.z, straight]
    scaled = [[ray.bench.number(s * x) for x in z] for z in states]
    return not all(short.keeps(ray.bench.trial(q, v, short.h)) for q, v in scaled)


def _constant(far: Sequence[Trial], component: int, rounding: float) -> str:
    """What one component does far out: it stays where it is put, or it is changed by the same; its size, in words."""
    if any(trial.answer is None for trial in far):
        return ""
    before, after = ([x[component] for x in xs] for xs in zip(*((t.given, t.answer) for t in far), strict=True))
    changes = [y - x for x, y in zip(before, after, strict=True)]
    if after[0] == after[1] != 0 and before[0] != before[1]:
        return f"the new {NAMES[component]} stays at {named(abs(after[0]))} in size"
    if any(changes) and abs(changes[0] - changes[1]) <= rounding * max(map(abs, (*before, *changes))):
        return f"the change of {NAMES[component]} in a step stays at {abs(changes[0]):.10g} in size"
    return ""
