"""Pseudorandom steps from a domain, the same on every run, and the search for the simplest step that fails."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import ceil, copysign, floor, frexp, ldexp
from random import Random
from typing import TypeAlias

from driftproof.symbolic.rounding.formats import FloatFormat

# q, v and h.
Arguments: TypeAlias = tuple[float, float, float]
# Cumulative probabilities, chosen. Of a size: a corner; any number from end to end; else one drawn by its exponent.
_SIZES = (0.12, 0.3)
# Of a state: q = v = 0; q = 0; v = 0; |q| = |v|; q + h v or v - h q nearly cancels; similar sizes; else any sizes.
_STATES = (0.015, 0.12, 0.23, 0.3, 0.38, 0.65)
# Chosen: the most steps tried in the search for a simpler one, enough to shorten three numbers to one digit each.
_MOST_ASKED = 600


@dataclass(frozen=True)
class Sizes:
    """The positive floats of one format from `low` to `high`; if `low` is 0, all positive floats up to `high`."""

    low: float
    high: float
    format: FloatFormat

    @cached_property
    def least(self) -> float:
        """The smallest; in narrow formats at least the root of the smallest normal number, lest products underflow."""
        if not self.low:
            return float(self.format.eta)
        return float(self.format.nearest(Fraction(max(self.low, 2.0 ** (self.format.emin // 2)))))

    @cached_property
    def most(self) -> float:
        """The largest."""
        return float(self.format.nearest(Fraction(self.high)))

    @cached_property
    def corners(self) -> list[float]:
        """The ends, 1, the smallest normal number and floats next to them, all moved into the range."""
        u, spots = ldexp(1.0, -self.format.precision), (self.least, self.most, 1.0, ldexp(1.0, self.format.emin))
        return sorted({self.inside(x * (1 + k * u)) for x in spots for k in (-1, 0, 2)})

    def rounded(self, x: float) -> float:
        """The number of the format nearest to x >= 0."""
        significand, exponent = frexp(x)
        bits = min(self.format.precision, exponent - self.format.emin + self.format.precision - 1)
        return ldexp(round(ldexp(significand, bits)), exponent - bits)

    def inside(self, x: float) -> float:
        """The number of the range that is nearest to |x|."""
        return max(self.rounded(min(abs(x), self.most)), self.least)

    def significand(self, draw: Random) -> float:
        """Draw a number from 1 to 2 with few bits or all of them, sometimes with all bits 1."""
        bits = draw.choice((1, 2, 5, *[self.format.precision] * 5))
        drawn = (1 << bits) - 1 if draw.random() < 1 / 16 else draw.getrandbits(bits) | 1 << bits - 1
        return ldexp(drawn, 1 - bits)

    def drawn(self, draw: Random) -> float:
        """Draw a number of the range: a corner, or uniformly by size, or uniformly by order of magnitude."""
        kind = bisect(_SIZES, draw.random())
        if kind == 0:
            return draw.choice(self.corners)
        if kind == 1:
            return self.inside(draw.uniform(self.least, self.most))
        exponent = draw.randint(frexp(self.least)[1], frexp(self.most)[1]) - 1
        return self.inside(ldexp(self.significand(draw), exponent))

    def simple(self, *numbers: float) -> list[float]:
        """The numbers in the range; if there is none, its largest power of two, or else its largest number."""
        within = [x for x in numbers if self.least <= abs(x) <= self.most]
        power = ldexp(1.0, frexp(self.most)[1] - 1)
        return within or [power if power >= self.least else self.most]


def steps_within(steps: Sizes, states: Sizes) -> Iterator[Arguments]:
    """Yield steps (q, v, h) without end, the same on every run: q and v from ±`states` or 0, h from `steps`.

    In many of them q and v have similar sizes, so that the rounding of neither hides that of the other.
    """
    draw = Random(0)
    while True:
        h, q, v, kind = steps.drawn(draw), states.drawn(draw), states.drawn(draw), bisect(_STATES, draw.random())
        if kind in (0, 1):
            q = 0.0
        if kind in (0, 2):
            v = 0.0
        elif kind == 3:
            v = q
        elif kind == 4:
            near = 1 + draw.choice((0, 1, -1)) * ldexp(1.0, -draw.randint(1, states.format.precision - 1))
            q, v = (states.inside(h * v * near), v) if draw.random() < 1 / 2 else (q, states.inside(h * q * near))
        elif kind == 5:
            v = states.inside(ldexp(states.significand(draw), frexp(q)[1] - draw.randint(1, 3)))
        yield copysign(q, draw.random() - 1 / 2), copysign(v, draw.random() - 1 / 2), h


def simplest_step(fails: Callable[[Arguments], bool], failing: Arguments, steps: Sizes, states: Sizes) -> Arguments:
    """The simplest step found that fails: of small whole numbers if one does, else `failing` with shorter numbers."""
    few, sizes_of_step = [0.0, *states.simple(1.0, 2.0, -1.0)], steps.simple(1.0, 2.0, 0.5, 0.25)
    places = product(range(len(few)), range(len(few)), range(len(sizes_of_step)))
    for i, j, k in sorted(places, key=lambda at: (sum(at), at)):
        if fails(step := (few[i], few[j], sizes_of_step[k])):
            return step
    asked, best, before = 0, failing, None
    while best != before:
        before = best
        for i, sizes in enumerate((states, states, steps)):
            for x in _simpler(best[i], sizes, signed=i < 2):
                asked += 1
                if asked > _MOST_ASKED:
                    return best
                q, v, h = (x if j == i else best[j] for j in range(3))
                if fails((q, v, h)):
                    best = q, v, h
                    break
    return best


def _simpler(x: float, sizes: Sizes, *, signed: bool) -> list[float]:
    """The numbers tried that are simpler than x, the simplest first, as `_length` orders them."""
    exponent = frexp(x)[1] - 1
    near = [0.0, abs(x), *(x - copysign(abs(x) // 2**k, x) for k in range(1, 13)), x // 1, -(-x // 1)]
    bits = [(way, n) for way in (floor, ceil) for n in (0, 1, 2, 3, 5, 8, 13, 21, 34)]
    short = [ldexp(way(ldexp(x, n - exponent)), exponent - n) for way, n in bits]
    moved = [ldexp(x, -exponent), ldexp(x, -exponent // 2), ldexp(x, -1 if exponent > 0 else 1)]
    within = {y for y in (1.0, *near, *short, *moved) if sizes.least <= abs(y) <= sizes.most and (signed or y > 0)}
    return sorted((y for y in within | ({0.0} if signed else set()) if _length(y) < _length(x)), key=_length)


def _length(x: float) -> tuple[float, ...]:
    """The sorting key of simplicity: whole numbers first, by their size, then others by bits and exponents."""
    if x == round(x):
        return False, abs(x), x < 0
    significand, exponent = frexp(x)
    bits = significand.as_integer_ratio()[1].bit_length()
    return True, bits, abs(exponent), x < 0
