"""A search that climbs towards the bound: float steps whose rounding errors conspire."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import numpy as np

from driftproof.methods.stepping import Step
from driftproof.numeric.worst_case import BITS, Envelope, Floats, Ratios, Worst, error_ratios, worst_of

# Arrays h, q, v of one shape and type.
Points: TypeAlias = tuple[Floats, Floats, Floats]
Counter: TypeAlias = Callable[[int], Iterable[int]]


def search(
    step: Step,
    envelope: Envelope,
    dtype: Any,
    h_range: tuple[float, float],
    seed: int,
    generations: int = 64,
    population: int = 1 << 14,
    counter: Counter = range,
) -> Worst:
    """The worst step found by climbing: the half with the larger errors goes on twice, each tries a neighbour first.

    A neighbour has its bit patterns moved by up to any power of two, from one ulp to many exponents; if its error over
    bound is larger, it takes the place. The first points cover all exponents and the subnormals; low <= |h| <= high
    holds throughout. Checks population * (1 + generations) steps; `counter` is `range` or a progress bar like it. The
    same seed finds the same step.
    """
    rng = np.random.default_rng(seed)
    points = _first_points(rng, np.dtype(dtype), h_range, population)
    ratios = error_ratios(step, envelope, *points)
    worst, scores = worst_of(ratios, *points), _scores(ratios)
    for _ in counter(generations):
        larger = np.resize(np.argsort(scores)[population // 2 :], population)
        points, scores = tuple(x[larger] for x in points), scores[larger]
        trial = _neighbours(rng, points, h_range)
        ratios = error_ratios(step, envelope, *trial)
        worst = worst.merged(worst_of(ratios, *trial))
        better = _scores(ratios) > scores
        points = tuple(np.where(better, new, old) for new, old in zip(trial, points, strict=True))
        scores = np.where(better, _scores(ratios), scores)
    return worst


def random_floats(rng: np.random.Generator, dtype: Any, count: int) -> Floats:
    """Finite floats: half of them with any bit pattern, so at any scale, half within a few powers of two of 1."""
    bits: Any = BITS[dtype]
    anywhere = rng.integers(0, np.iinfo(bits).max, count, dtype=bits, endpoint=True).view(dtype)
    near_one = np.ldexp(rng.uniform(-1, 1, count), rng.integers(-4, 5, count)).astype(dtype)
    return np.where(np.isfinite(anywhere) & (rng.random(count) < 1 / 2), anywhere, near_one)


def random_steps(rng: np.random.Generator, dtype: Any, h_range: tuple[float, float], count: int) -> Floats:
    """Step sizes with low <= |h| <= high, of both signs: half uniform, half uniform over the bit patterns."""
    low, high = (dtype.type(x) for x in h_range)
    bits: Any = BITS[dtype]
    ends = [int(x.view(bits)) for x in (low, high)]
    by_pattern = rng.integers(ends[0], ends[1], count, dtype=bits, endpoint=True).view(dtype)
    uniform = np.clip(rng.uniform(*h_range, count).astype(dtype), low, high)
    size = np.where(rng.random(count) < 1 / 2, by_pattern, uniform)
    return np.where(rng.random(count) < 1 / 2, size, -size)


def _first_points(rng: np.random.Generator, dtype: Any, h_range: tuple[float, float], count: int) -> Points:
    return random_steps(rng, dtype, h_range, count), random_floats(rng, dtype, count), random_floats(rng, dtype, count)


def _neighbours(rng: np.random.Generator, points: Points, h_range: tuple[float, float]) -> Points:
    h, q, v = (_moved(rng, x) for x in points)
    inside = (h_range[0] <= abs(h)) & (abs(h) <= h_range[1])
    return np.where(inside, h, points[0]), q, v


def _moved(rng: np.random.Generator, x: Floats) -> Floats:
    """Half of the numbers as they are, half with the bit pattern moved by at most a random power of two."""
    bits = BITS[x.dtype]
    largest = np.ldexp(1.0, rng.integers(1, 8 * x.dtype.itemsize - 3, x.shape))
    move = np.rint(rng.uniform(-1, 1, x.shape) * largest).astype(np.int64).astype(bits)
    moved = (x.view(bits) + move).view(x.dtype)
    return np.where(np.isfinite(moved) & (rng.random(x.shape) < 1 / 2), moved, x)


def _scores(ratios: Ratios) -> Floats:
    return np.where(np.isnan(ratios.low), -1.0, ratios.low)
