"""Linear systems by elimination with row exchanges, full or banded: loops over numbers, as `numeric.steps.loops` says.

Row i of a banded matrix holds its columns from max(0, i - lower) on; a full matrix is a band that is wide
enough, with whole rows.
"""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple


class Band(NamedTuple):
    """A band: entries lie at most `lower` columns left and `upper` columns right of the diagonal."""

    lower: int
    upper: int


# A band as wide as any matrix.
FULL = Band(2**40, 2**40)
# Rounding moves pivots by some n u of the largest, u = 2⁻⁵³; chosen: 8000 times as much for n = 1.
CERTAIN = 2.0**-40


def factored(m: Any, exchanged: Any, n: int, lower: int, upper: int) -> bool:
    """Overwrite M with LU, exchanging rows k and `exchanged[k]` for the largest pivot; False for a zero pivot.

    Exchanges cause fill-in: each row must have room for `lower` more entries, as far as there are columns.
    """
    for k in range(n):
        row, first, end = m[k], max(0, k - lower), min(n, k + lower + upper + 1)
        best, largest = k, abs(row[k - first])
        for i in range(k + 1, min(n, k + lower + 1)):
            size = abs(m[i][k - max(0, i - lower)])
            if size > largest:
                best, largest = i, size
        exchanged[k] = best
        if best != k:
            other, start = m[best], max(0, best - lower)
            for j in range(k, end):
                row[j - first], other[j - start] = other[j - start], row[j - first]
        pivot = row[k - first]
        if pivot == 0:
            return False
        for i in range(k + 1, min(n, k + lower + 1)):
            other, start = m[i], max(0, i - lower)
            if other[k - start] != 0:
                other[k - start] = factor = other[k - start] / pivot
                for j in range(k + 1, end):
                    other[j - start] -= factor * row[j - first]
    return True


def sign_of_determinant(m: Any, exchanged: Any, n: int, lower: int) -> int:
    """The sign of det M, given its factors; 0 if a pivot is so small beside the largest that rounding may have it."""
    sign, least, largest = 1, inf, 0.0
    for k in range(n):
        pivot = m[k][k - max(0, k - lower)]
        least, largest = min(least, abs(pivot)), max(largest, abs(pivot))
        if (pivot < 0) != (exchanged[k] != k):
            sign = -sign
    return sign if least > CERTAIN * largest else 0


def solve(m: Any, exchanged: Any, n: int, x: Any, lower: int, upper: int) -> None:
    """Overwrite x with M⁻¹ x, given the factors of M."""
    for k in range(n):
        best = exchanged[k]
        x[k], x[best] = x[best], x[k]
        for i in range(k + 1, min(n, k + lower + 1)):
            x[i] -= m[i][k - max(0, i - lower)] * x[k]
    for k in range(n - 1, -1, -1):
        row, first, value = m[k], max(0, k - lower), x[k]
        for j in range(k + 1, min(n, k + lower + upper + 1)):
            value -= row[j - first] * x[j]
        x[k] = value / row[k - first]
