"""How close float steps come to their proved bound, and whether one ever exceeds it.

The exact result is computed in a wider type, fast, and the doubt that this leaves is added to every verdict. Let w be
that type's unit roundoff, n the degree in h and |m| the sum of the result's |monomials|. Rounding each coefficient,
Horner's rule (two roundings per degree), multiplying by the state and adding the two columns: a monomial passes
2n + 3 roundings, so with the final subtraction the error found is within (2n + 4) w (|m| + |error found|) of the true
one; the bound has only non-negative terms and one more sum, so it is within (2n + 4) w of itself. Four more cover the
arithmetic of the verdict and the products of roundings. The wider type is chosen such that neither underflow nor
overflow disturbs this. Steps that this does not clear are computed again in integers, as are all where no type is wide
enough; there nothing is in doubt.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, lcm, nextafter
from operator import mul
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from driftproof.methods.programs.stepping import Step, oscillator
from driftproof.symbolic.rounding.polynomials import middle_and_radius
from driftproof.symbolic.rounding.step_bound import COLUMNS, ByPower, StepBound, Terms, in_format

Floats: TypeAlias = Any
# Arrays h, q, v of one shape and type.
Points: TypeAlias = tuple[Floats, Floats, Floats]
Counter: TypeAlias = Callable[[int], Iterable[int]]
Coefficients: TypeAlias = tuple[Fraction, ...]
Table: TypeAlias = tuple[tuple[Coefficients, Coefficients], tuple[Coefficients, Coefficients]]

BITS = {np.dtype(np.float16): np.uint16, np.dtype(np.float32): np.uint32, np.dtype(np.float64): np.uint64}


class Envelope(NamedTuple):
    """What a step should give, M(h) z, and how far off it may be, E|z| + r: coefficients ascending in h, or in |h|."""

    exact: Table
    error: Table
    underflow: tuple[Coefficients, Coefficients]


def envelope_of(bound: StepBound) -> Envelope:
    """The bound in its format. Irrational coefficients of M are fractions near them, and E is larger by how near."""
    rows = zip(
        (bound.entries[:2], bound.entries[2:]), (in_format(x.error, bound.format) for x in bound.outputs), strict=True
    )
    ((mqq, mqv), (qq, qv, rq)), ((mvq, mvv), (vq, vv, rv)) = (_row(entries, errors) for entries, errors in rows)
    return Envelope(((mqq, mqv), (mvq, mvv)), ((qq, qv), (vq, vv)), (rq, rv))


def _row(entries: Iterable[ByPower], errors: Terms) -> tuple[list[Coefficients], list[Coefficients]]:
    """A row of M, and of (E, r) widened by how near to it the first is."""
    middles = []
    bounds = [{in_h: c for (in_h, *state), c in errors.items() if tuple(state) == column} for column in COLUMNS]
    for entry, bound in zip(entries, bounds, strict=False):
        balls = {k: middle_and_radius(c) for k, c in entry.items()}
        middles.append({k: middle for k, (middle, _) in balls.items()})
        for k, (_, radius) in balls.items():
            bound[k] = bound.get(k, Fraction(0)) + radius
    return [_ascending(x) for x in middles], [_ascending(x) for x in bounds]


def _ascending(by_power: dict[int, Fraction]) -> Coefficients:
    return tuple(by_power.get(k, Fraction(0)) for k in range(max(by_power, default=-1) + 1))


class Ratios(NamedTuple):
    """Error over bound, the larger of the two components: certainly from `low` to `high`. NaN after an overflow.

    1 is never between them: where it would be, both are the ratio itself, rounded, but not across 1.
    """

    low: Floats
    high: Floats


@dataclass(frozen=True)
class Worst:
    """The largest error over bound that was seen, at step size `h` and `state` (q, v).

    Of the `checked` steps, `overflowed` had no finite result and say nothing, `violations` certainly exceeded the
    bound, and all others are certainly within it. `ratio` is certain from below.
    """

    ratio: float
    h: float
    state: tuple[float, float]
    checked: int
    overflowed: int
    violations: int

    def merged(self, other: Worst) -> Worst:
        """Both findings together."""
        worse = self if self.ratio >= other.ratio else other
        return Worst(
            worse.ratio,
            worse.h,
            worse.state,
            self.checked + other.checked,
            self.overflowed + other.overflowed,
            self.violations + other.violations,
        )


def error_ratios(step: Step, envelope: Envelope, h: Floats, q: Floats, v: Floats) -> Ratios:
    """Error over bound of one step from each (q, v) at each h, arrays of one shape and float type."""
    degree = max(len(c) for c in _all_coefficients(envelope)) - 1
    with np.errstate(all="ignore"):
        results = step(oscillator, q, v, h)
    finite = np.isfinite(results[0]) & np.isfinite(results[1])
    numbers = [np.where(finite, x, h.dtype.type(0)) for x in (h, q, v, *results)]
    wide = _wider(h.dtype, degree)
    if wide is None:
        low = high = _ratios_in_integers(envelope, numbers)
    else:
        low, high = _ratios(envelope, numbers, degree, wide)
        unclear = (low <= 1) & (high > 1)
        low[unclear] = high[unclear] = _ratios_in_integers(envelope, [x[unclear] for x in numbers])
    return Ratios(np.where(finite, low, np.nan), np.where(finite, high, np.nan))


def worst_of(ratios: Ratios, h: Floats, q: Floats, v: Floats) -> Worst:
    """The worst of the steps that had these ratios."""
    low, high = ratios
    overflowed = np.isnan(low)
    worst = int(np.argmax(np.where(overflowed, -np.inf, low)))
    return Worst(
        ratio=-np.inf if overflowed.all() else float(low[worst]),
        h=float(h[worst]),
        state=(float(q[worst]), float(v[worst])),
        checked=low.size,
        overflowed=int(overflowed.sum()),
        violations=int((high[~overflowed] > 1).sum()),
    )


def _ratios(envelope: Envelope, numbers: Sequence[Floats], degree: int, wide: Any) -> Ratios:
    """The ratios from h, q, v and the two results, all finite, with the arithmetic of `wide`."""
    *values, q1, v1 = (x.astype(wide) for x in numbers)
    sizes = [abs(x) for x in values]
    doubt = np.ldexp(wide.type(2 * degree + 8), -1 - np.finfo(wide).nmant)
    lows, highs = [], []
    for i, result in enumerate((q1, v1)):
        found = abs(result - _linear(envelope.exact[i], values))
        margin = doubt * (_linear(_absolute(envelope.exact[i]), sizes) + found)
        bound = _linear(envelope.error[i], sizes) + _horner(envelope.underflow[i], sizes[0])
        lows.append(_quotient(found - margin, bound * (1 + doubt)))
        highs.append(_quotient(found + margin, bound * (1 - doubt)))
    return Ratios(np.maximum(*lows), np.maximum(*highs))


def _ratios_in_integers(envelope: Envelope, numbers: Sequence[Floats]) -> Floats:
    """The ratios themselves, rounded to binary64 but never across 1."""
    exact = [_Linear.of((*row, ())) for row in envelope.exact]
    bounds = [_Linear.of((*row, free)) for row, free in zip(envelope.error, envelope.underflow, strict=True)]
    ratios = []
    for point in zip(*(x.tolist() for x in numbers), strict=True):
        *values, q1, v1 = (x.as_integer_ratio() for x in point)
        sizes = [(abs(numerator), denominator) for numerator, denominator in values]
        rows = zip((q1, v1), exact, bounds, strict=True)
        ratios.append(max(_ratio(result, m.at(*values), bound.at(*sizes)) for result, m, bound in rows))
    return np.array(ratios, dtype=np.float64)


Rational: TypeAlias = tuple[int, int]


class _Linear(NamedTuple):
    """a(h) q + b(h) v + c(h) in integers: three rows of numerators of one length, and their common denominator."""

    rows: list[list[int]]
    denominator: int

    @staticmethod
    def of(polynomials: tuple[Coefficients, Coefficients, Coefficients]) -> _Linear:
        length = max(map(len, polynomials))
        denominator = lcm(*(c.denominator for p in polynomials for c in map(Fraction, p)))
        rows = [[int(c * denominator) for c in p] + [0] * (length - len(p)) for p in polynomials]
        return _Linear(rows, denominator)

    def at(self, h: Rational, q: Rational, v: Rational) -> Rational:
        degree = len(self.rows[0]) - 1
        powers = [h[0] ** j * h[1] ** (degree - j) for j in range(degree + 1)]
        a, b, c = (sum(map(mul, row, powers)) for row in self.rows)
        numerator = a * q[0] * v[1] + b * v[0] * q[1] + c * q[1] * v[1]
        return numerator, self.denominator * h[1] ** max(degree, 0) * q[1] * v[1]


def _ratio(result: Rational, exact: Rational, bound: Rational) -> float:
    numerator = abs(result[0] * exact[1] - exact[0] * result[1]) * bound[1]
    denominator = result[1] * exact[1] * bound[0]
    if numerator <= denominator:
        return numerator / denominator if denominator else 0.0
    if denominator == 0 or numerator >> 1000 > denominator:
        return inf
    return max(numerator / denominator, nextafter(1.0, inf))


def _wider(dtype: Any, degree: int) -> Any:
    """A type in which steps of `dtype` can be checked, None where there is no such float type.

    Its normal range must hold |h|**degree |q| eta, so degree + 2 times the exponent of the smallest subnormal; that the
    largest numbers stay in range follows, their exponents being smaller.
    """
    narrow = np.finfo(dtype)
    reach = (degree + 2) * -int(np.log2(narrow.smallest_subnormal))
    for wide in (np.finfo(np.float64), np.finfo(np.longdouble)):
        if wide.nmant >= narrow.nmant + 11 and -wide.minexp >= reach:
            return wide.dtype
    return None


def _constant(c: Fraction, like: Floats) -> Any:
    """`c` in the type of `like`, rounded once: an integer of as many bits as that type holds, exactly scaled."""
    if c == 0:
        return like.dtype.type(0)
    exponent = abs(c.numerator).bit_length() - c.denominator.bit_length()
    exponent -= abs(c) < Fraction(2) ** exponent
    shift = np.finfo(like.dtype).nmant - exponent
    return np.ldexp(like.dtype.type(round(c * Fraction(2) ** shift)), -shift)


def _horner(coefficients: Coefficients, h: Floats) -> Any:
    """The polynomial at h, an array; its constant, not an array, where it is one."""
    if not coefficients:
        return 0
    total = _constant(coefficients[-1], h)
    for c in reversed(coefficients[:-1]):
        total = total * h
        if c != 0:
            total = total + _constant(c, h)
    return total


def _linear(row: tuple[Coefficients, Coefficients], values: Sequence[Floats]) -> Floats:
    h, q, v = values
    return _horner(row[0], h) * q + _horner(row[1], h) * v


def _absolute(row: tuple[Coefficients, Coefficients]) -> tuple[Coefficients, Coefficients]:
    return tuple(abs(c) for c in row[0]), tuple(abs(c) for c in row[1])


def _quotient(error: Floats, bound: Floats) -> Floats:
    """error / bound, with 0 for no error and infinity for any other where the bound is 0."""
    ratio = error / np.where(bound == 0, 1, bound)
    return np.where(bound == 0, np.where(error > 0, np.inf, 0.0), ratio)


def _all_coefficients(envelope: Envelope) -> Iterator[Coefficients]:
    for table in (envelope.exact, envelope.error):
        for row in table:
            yield from row
    yield from envelope.underflow


# --- a search that climbs towards the bound: float steps whose rounding errors conspire -----------------------------


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
