"""Where a behaviour begins: bisection to two neighbouring floats, and the name that such a number goes by."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from math import copysign, pi, sqrt

import numpy as np

from driftproof.blackbox.contract.bench import Bench
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32

# The multiples of pi that have a name: these over 1, 2, 3, 4, 6.
Pair = tuple[float, float]
_PARTS_OF_PI = {Fraction(n, d) for n in range(1, 9) for d in (1, 2, 3, 4, 6)}


def edge(changed: Callable[[float], bool], kept: float, gone: float, bench: Bench, hints: Sequence[Pair] = ()) -> Pair:
    """The neighbours a, b of the format, a not changed and b changed, between `kept`, which is not, and `gone`.

    Both ends have one sign, or `kept` is 0. Numbers with few digits are tried first, since most thresholds are such,
    and before them the hints, neighbours in the same sense.
    """
    low, high = kept, gone

    def inside(x: float) -> bool:
        return min(low, high) < x < max(low, high)

    for a, b in hints:
        if inside(a) and inside(b) and changed(b) and not changed(a):
            return a, b
    while inside(middle := _middle(low, high, bench)):
        short = next(filter(inside, _by_roundness(middle, bench)), None)
        if short is not None:
            low, high = (low, short) if changed(short) else (short, high)
            middle = bench.beside(short, low if short == high else high)  # if the threshold is here, that ends it
            if not inside(middle):
                continue
        low, high = (low, middle) if changed(middle) else (middle, high)
    return low, high


def _by_roundness(centre: float, bench: Bench) -> Iterator[float]:
    """Numbers near the centre that somebody may have chosen, those with the fewest digits first."""
    yield from (bench.number(copysign(x, centre)) for x in (pi, 2 * pi, pi / 2))
    # Beyond six digits nobody chose the number, and halving is quicker.
    yield from (bench.number(float(f"{centre:.{digits}e}")) for digits in range(6))


def _middle(low: float, high: float, bench: Bench) -> float:
    """Halfway in magnitude while the ends are far apart, then halfway."""
    small, large = sorted((abs(low), abs(high)))
    if small == 0:
        small = float(bench.format.eta)
        if small == large:
            return low
    middle = sqrt(small) * sqrt(large) if large > 4 * small else small + (large - small) / 2
    return bench.number(copysign(middle, high))


def named(x: float) -> str:
    """x as a reader writes it: 100, 0.01, pi, -2 pi/3, 0.1 in binary32; to the last bit where it has no short name."""
    for part in _PARTS_OF_PI:
        if abs(x) == float(part) * pi:
            times = "" if part.numerator == 1 else f"{part.numerator} "
            over = "" if part.denominator == 1 else f"/{part.denominator}"
            return f"{'-' if x < 0 else ''}{times}pi{over}"
    if x == 0:
        return "0"
    for kind, fmt in ((np.float16, BINARY16), (np.float32, BINARY32)):
        if float(fmt.largest) > abs(x) == float(kind(abs(x))) and len(str(kind(x))) < len(repr(x)):
            return f"{str(kind(x)).removesuffix('.0')} in {fmt.name}"
    return repr(x).removesuffix(".0")


def rounder(first: float, second: float) -> float:
    """The one that is named in fewer characters; the first of equals."""
    return min((first, second), key=lambda x: len(named(x)))
