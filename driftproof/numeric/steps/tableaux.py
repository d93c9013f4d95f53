"""The tableau (A, b, c) of a Runge-Kutta or collocation method in floats, each exact entry rounded once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta

# Nodes are computed to this many bits before weights are formed from them. The error of a weight is then below 2**-200
# times the condition of Lagrange's basis, about 10**4 for ten nodes.
NODE_BITS = 220


@dataclass(frozen=True)
class FloatTableau:
    """The tableau in binary64: A as s rows of s entries, b and c with s, and d = A⁻ᵀ b, or None if A is singular.

    With Zᵢ = h Σ aᵢⱼ fⱼ, z + h Σ bᵢ fᵢ is z + Σ dᵢ Zᵢ, which evaluates no slope again (hairer-wanner-1996, IV.8).
    """

    a: NDArray[np.float64]
    b: NDArray[np.float64]
    c: NDArray[np.float64]
    d: NDArray[np.float64] | None

    @property
    def stages(self) -> int:
        """The number of stages, s."""
        return len(self.b)

    @property
    def stiffly_accurate(self) -> bool:
        """True if the last stage is the result: the last row of A is b."""
        return bool((self.a[-1] == self.b).all())


@cache
def float_tableau(method: Method) -> FloatTableau:
    """The tableau of a Runge-Kutta method, or of a collocation method by its nodes. Raises MethodError for others."""
    if isinstance(method, RungeKutta):
        return _floats(method.a, method.b, method.c)
    if not isinstance(method, Collocation):
        raise MethodError(f"{method.key} is not a Runge-Kutta method, so it has no tableau")
    return _floats(*method.tableau(NODE_BITS))


def _floats(a: Sequence[Sequence[Any]], b: Sequence[Any], c: Sequence[Any]) -> FloatTableau:
    d = solved(list(zip(*a, strict=True)), b)
    return FloatTableau(np.array([_row(row) for row in a]), _row(b), _row(c), None if d is None else _row(d))


def solved(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[Any] | None:
    """The solution x of `matrix` x = `right` by elimination, exact if the entries are; None for a singular matrix."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for k in range(len(rows)):
        pivot = next((i for i in range(k, len(rows)) if rows[i][k] != 0), None)
        if pivot is None:
            return None
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i, row in enumerate(rows):
            if i != k and row[k] != 0:
                rows[i] = [x - row[k] * y for x, y in zip(row, rows[k], strict=True)]
    return [row[-1] for row in rows]


def _row(values: Sequence[Any]) -> NDArray[np.float64]:
    return np.array([float(x) for x in values])
