"""Products and systems of small matrices by sums in turn: the same bits everywhere, whatever BLAS and LAPACK do.

What is asked of a code is held to the last bit by checksums; so must be what the code computes from it.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def product(matrix: Any, x: Any) -> Any:
    """`matrix @ x`, of a row or of several, summed from the first term on."""
    if np.ndim(matrix) == 2:
        return np.array([product(row, x) for row in matrix])
    return sum(weight * each for weight, each in zip(matrix, x, strict=True))


def solved(matrix: Any, right: Any) -> Any:
    """`numpy.linalg.solve(matrix, right)` by Gauss-Jordan elimination, the largest pivot first."""
    rows = np.column_stack((matrix, right)).astype(float)
    for i in range(len(rows)):
        pivot = i + int(np.argmax(abs(rows[i:, i])))
        if rows[pivot, i] == 0:
            raise np.linalg.LinAlgError("Singular matrix")
        rows[[i, pivot]] = rows[[pivot, i]]
        rows[i] /= rows[i, i]
        others = np.arange(len(rows)) != i
        rows[others] -= rows[others, i][:, None] * rows[i]
    return rows[:, -1]
