"""The tableau (A, b, c) of a Runge-Kutta or collocation method in floats, each entry the exact one rounded once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.polynomials import Polynomial, product, real_roots_between, value_at
from driftproof.methods.schemes import Collocation, Method, MethodError, RungeKutta

# Nodes are known to so many bits before weights are formed of them. What that leaves of a weight's error is below
# 2**-200 times the condition of Lagrange's basis, about 10**4 for ten nodes.
NODE_BITS = 220


@dataclass(frozen=True)
class Tableau:
    """A as s rows of s, b and c with s entries, in binary64; and d = A⁻ᵀ b, or None where A is singular.

    As z₁ = z + h Σ bᵢ fᵢ and Zᵢ = h Σ aᵢⱼ fⱼ, z₁ = z + Σ dᵢ Zᵢ, which evaluates no slope again (hairer-wanner-1996,
    IV.8).
    """

    a: NDArray[np.float64]
    b: NDArray[np.float64]
    c: NDArray[np.float64]
    d: NDArray[np.float64] | None

    @property
    def stages(self) -> int:
        """s."""
        return len(self.b)

    @property
    def stiffly_accurate(self) -> bool:
        """True when the last stage is the result: the last row of A is b."""
        return bool((self.a[-1] == self.b).all())


@cache
def tableau(method: Method) -> Tableau:
    """The tableau of a Runge-Kutta method, or of a collocation method from its node polynomial.

    aᵢⱼ is the integral of Lagrange's j-th polynomial from 0 to cᵢ, bⱼ that from 0 to 1 (hairer-lubich-wanner-2006,
    II.1.2). Raises MethodError for splittings and Nyström methods.
    """
    if isinstance(method, RungeKutta):
        return _floats(method.a, method.b, method.c)
    if not isinstance(method, Collocation):
        raise MethodError(f"{method.key} is no Runge-Kutta method; it has no tableau")
    nodes = _nodes(method.node_polynomial)
    integrals = [_integral(_lagrange(nodes, j)) for j in range(len(nodes))]
    rows = [[value_at(integral, node) for integral in integrals] for node in nodes]
    return _floats(rows, [value_at(integral, Fraction(1)) for integral in integrals], nodes)


def _floats(a: Sequence[Sequence[Any]], b: Sequence[Any], c: Sequence[Any]) -> Tableau:
    d = solved(list(zip(*a, strict=True)), b)
    return Tableau(np.array([_row(row) for row in a]), _row(b), _row(c), None if d is None else _row(d))


def solved(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[Any] | None:
    """The x with `matrix` x = `right`, exact where the entries are, by elimination; None for a singular matrix."""
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


def _nodes(polynomial: Polynomial) -> list[Fraction]:
    """The real roots in order, to NODE_BITS bits; 0, 1 and other short binary fractions exactly."""
    bound = Fraction(1 << ceil(1 + max(abs(x) for x in polynomial)).bit_length())  # beyond Cauchy's: it is monic
    return [_bisected(polynomial, low, high) for low, high in _isolated(polynomial, -bound, bound)]


def _isolated(polynomial: Polynomial, low: Fraction, high: Fraction) -> list[tuple[Fraction, Fraction]]:
    """Intervals (low, high] that hold one root each, in order."""
    count = real_roots_between(polynomial, low, high)
    if count < 2:
        return [(low, high)] * count
    middle = (low + high) / 2
    return _isolated(polynomial, low, middle) + _isolated(polynomial, middle, high)


def _bisected(polynomial: Polynomial, low: Fraction, high: Fraction) -> Fraction:
    """The only root in (low, high], to NODE_BITS bits: below it the polynomial has one sign, above it the other."""
    if value_at(polynomial, high) == 0:
        return high
    rising = value_at(polynomial, high) > 0
    while (high - low) * 2**NODE_BITS > 1:
        middle = (low + high) / 2
        at_middle = value_at(polynomial, middle)
        if at_middle == 0:
            return middle
        low, high = (low, middle) if (at_middle > 0) == rising else (middle, high)
    return high


def _lagrange(nodes: Sequence[Fraction], j: int) -> Polynomial:
    """The polynomial that is 1 at node j and 0 at the others."""
    result: Polynomial = (Fraction(1),)
    for k, node in enumerate(nodes):
        if k != j:
            scale = 1 / (nodes[j] - node)
            result = product(result, (-node * scale, scale))
    return result


def _integral(polynomial: Polynomial) -> Polynomial:
    """The antiderivative that is 0 at 0."""
    return (Fraction(0), *(x / (k + 1) for k, x in enumerate(polynomial)))
