"""How close float steps come to their proved bound, and whether one ever exceeds it.

The exact result is computed in a wider type, fast, and the doubt that this leaves is added to every verdict. Let w be
that type's unit roundoff, n the degree in h and |m| the sum of the result's |monomials|. Rounding each coefficient,
Horner's rule (two roundings per degree), multiplying by the state and adding the two columns: a monomial passes
2n + 3 roundings, so with the final subtraction the error found is within (2n + 4) w (|m| + |error found|) of the true
one; the bound has only non-negative terms and one more sum, so it is within (2n + 4) w of itself. Four more cover the
arithmetic of the verdict and the products of roundings. Underflow and overflow in the wider type are excluded by
`_LARGEST_DEGREE`. Steps that this does not clear are computed again in fractions, as are all where no wider type exists
(float64 on some platforms); there nothing is in doubt.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from methods.problems import oscillator
from methods.stepping import Step

Floats: TypeAlias = Any
Coefficients: TypeAlias = tuple[Fraction, ...]
Table: TypeAlias = tuple[tuple[Coefficients, Coefficients], tuple[Coefficients, Coefficients]]

BITS = {np.dtype(np.float16): np.uint16, np.dtype(np.float32): np.uint32, np.dtype(np.float64): np.uint64}
# Up to this degree n every |h|**n |q| is in the wider type's normal range: its exponents are n + 1 times the narrow
# type's. The bound's coefficients are at most one eta smaller, which counts like a state.
_LARGEST_DEGREE = {np.dtype(np.float16): 41, np.dtype(np.float32): 5, np.dtype(np.float64): 14}


class Envelope(NamedTuple):
    """What a step should give, M(h) z, and how far off it may be, E|z| + r: coefficients ascending in h, or in |h|."""

    exact: Table
    error: Table
    underflow: tuple[Coefficients, Coefficients]


class Ratios(NamedTuple):
    """Error over bound, the larger of the two components: certainly from `low` to `high`. NaN after an overflow.

    Where `high` exceeds 1, both are exact up to one rounding, and to 1 they compare as the exact ratio does.
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
    """Error over bound of one step from each (q, v) at each h, arrays of one shape and float type.

    Raises ValueError if the method's degree in h is too high for the wider type.
    """
    degree = max(len(c) for c in _all_coefficients(envelope)) - 1
    if degree > _LARGEST_DEGREE[h.dtype]:
        raise ValueError(f"degree {degree} in h; for {h.dtype} at most {_LARGEST_DEGREE[h.dtype]} can be checked")
    with np.errstate(all="ignore"):
        results = step(oscillator, q, v, h)
    finite = np.isfinite(results[0]) & np.isfinite(results[1])
    numbers = [np.where(finite, x, h.dtype.type(0)) for x in (h, q, v, *results)]
    low, high = _ratios(envelope, numbers, degree, _wider(h.dtype))
    unclear = high > 1
    if unclear.any():
        exact = _ratios(envelope, [x[unclear] for x in numbers], degree, np.dtype(object))
        low[unclear], high[unclear] = exact
    low[~finite] = high[~finite] = np.nan
    return Ratios(low, high)


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


def exhaust(step: Step, envelope: Envelope, chunks: Iterable[Floats], states: Sequence[tuple[float, float]]) -> Worst:
    """The worst over all h of all `chunks` (arrays) and all `states`, which must be numbers of the arrays' type."""
    worst: Worst | None = None
    for h in chunks:
        for state in states:
            q, v = (np.full_like(h, x) for x in state)
            found = worst_of(error_ratios(step, envelope, h, q, v), h, q, v)
            worst = worst.merged(found) if worst else found
    if worst is None:
        raise ValueError("no step to check: give at least one chunk of h and one state")
    return worst


def every_finite(dtype: Any, chunk: int = 1 << 20) -> Iterator[Floats]:
    """Every finite number of a 16- or 32-bit float type, in arrays of at most `chunk`, ordered by bit pattern."""
    bits = BITS[np.dtype(dtype)]
    patterns = 1 << (8 * np.dtype(dtype).itemsize)
    for start in range(0, patterns, chunk):
        numbers = np.arange(start, min(start + chunk, patterns), dtype=np.uint64).astype(bits).view(dtype)
        if (finite := numbers[np.isfinite(numbers)]).size:
            yield finite


def _ratios(envelope: Envelope, numbers: Sequence[Floats], degree: int, wide: Any) -> Ratios:
    """The ratios from h, q, v and the two results, all finite, with the arithmetic of `wide`."""
    *values, q1, v1 = (_widen(x, wide) for x in numbers)
    sizes = [abs(x) for x in values]
    doubt = (2 * degree + 8) * _unit_roundoff(wide)
    lows, highs = [], []
    for i, result in enumerate((q1, v1)):
        found = abs(result - _linear(envelope.exact[i], values))
        margin = doubt * (_linear(_absolute(envelope.exact[i]), sizes) + found)
        bound = _linear(envelope.error[i], sizes) + _horner(envelope.underflow[i], sizes[0])
        lows.append(_quotient(found - margin, bound * (1 + doubt)))
        highs.append(_quotient(found + margin, bound * (1 - doubt)))
    return Ratios(np.maximum(*lows), np.maximum(*highs))


def _wider(dtype: Any) -> Any:
    """A type in which `dtype`'s steps can be checked; `object`, for fractions, where the platform has no such float."""
    if dtype != np.float64:
        return np.dtype(np.float64)
    long = np.finfo(np.longdouble)
    return np.dtype(np.longdouble) if long.nmant >= 63 and long.maxexp >= 16384 else np.dtype(object)


def _unit_roundoff(wide: Any) -> Any:
    return Fraction(0) if wide.kind == "O" else np.ldexp(wide.type(1), -1 - np.finfo(wide).nmant)


def _widen(x: Floats, wide: Any) -> Floats:
    return np.frompyfunc(Fraction, 1, 1)(x.astype(float)) if wide.kind == "O" else x.astype(wide)


def _constant(c: Fraction, like: Floats) -> Any:
    """`c` in the type of `like`, rounded once (to nearest, then exactly scaled)."""
    if like.dtype.kind == "O" or c == 0:
        return c if c else 0
    shift = np.finfo(like.dtype).nmant + 1 - (abs(c.numerator).bit_length() - c.denominator.bit_length())
    return np.ldexp(like.dtype.type(round(c * Fraction(2) ** shift)), -shift)


def _horner(coefficients: Coefficients, h: Floats) -> Floats:
    total = h * 0
    for c in reversed(coefficients):
        total = total * h + _constant(c, h)
    return total


def _linear(row: tuple[Coefficients, Coefficients], values: Sequence[Floats]) -> Floats:
    h, q, v = values
    return _horner(row[0], h) * q + _horner(row[1], h) * v


def _absolute(row: tuple[Coefficients, Coefficients]) -> tuple[Coefficients, Coefficients]:
    return tuple(abs(c) for c in row[0]), tuple(abs(c) for c in row[1])


def _quotient(error: Floats, bound: Floats) -> Floats:
    """error / bound; where the bound is 0, 0 for no error and infinity for any other. Never rounded down to 1."""
    ratio = error / np.where(bound == 0, bound + 1, bound)
    if ratio.dtype.kind == "O":
        above = np.nextafter(1.0, 2.0)
        ratio = np.array([max(float(x), above) if x > 1 else float(x) for x in ratio])
    return np.where(bound == 0, np.where(error > 0, np.inf, 0.0), ratio)


def _all_coefficients(envelope: Envelope) -> Iterator[Coefficients]:
    for table in (envelope.exact, envelope.error):
        for row in table:
            yield from row
    yield from envelope.underflow
