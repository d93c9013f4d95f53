"""Sums of |monomials| and counts of roundings: how far any float program of a formula may be from its exact value.

As in `symbolic.rounding.any_order`: a monomial that passes k roundings in the worst order of evaluation errs by at most
((1 + u)^k - 1) times its size. Here k is the largest one of all monomials, and sizes are floats, so that coefficients
may be irrational and formulas may hold quotients and exponentials. To first order in u, for x with error
kₓu|x|~ and y likewise, |x|~ the sum of |monomials| of x:

    x/y      errs by u (kₓ|x|~ + k_y|y|~|x/y|)/|y| + u|x/y| <= (kₓ + k_y + 1) u (|x|~/|y|)(|y|~/|y|)
    exp(x)   errs by exp(x) u (kₓ|x|~ + 2)                  <= (kₓ + 2) u exp(x)(1 + |x|~), for an exp good to 1 ulp
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, expm1, inf, log1p
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from driftproof.methods.schemes import Method
from driftproof.methods.stepping import stepper
from driftproof.symbolic.rounding.formats import FloatFormat

Coefficients: TypeAlias = NDArray[np.float64]

# A program may work its coefficients out, as in 1/(2 - 2**(1/3)): four operations, each rounded.
COEFFICIENT_ROUNDINGS = 4
# A program may turn its state into units of its own and back: two factors each way.
SCALING_ROUNDINGS = 4
# A program's force may hold parameters, as in -(k/m) q: two operations more than a change of sign.
FORCE_ROUNDINGS = 2


@dataclass(frozen=True, slots=True)
class Sized:
    """A quantity near `value` whose |monomials| sum to `size`, each rounded at most `count` times in its own products.

    Still to be counted are the `additions` of the sum that ends here: any term may be the one that passes them all.
    """

    value: float
    size: float
    count: int = 0
    additions: int = 0

    @property
    def roundings(self) -> int:
        """The most roundings that a monomial passes, in any order."""
        return self.count + self.additions

    def allowance(self, fmt: FloatFormat) -> float:
        """((1 + u)^k - 1) times the size, and k of the smallest subnormals."""
        k = self.roundings + SCALING_ROUNDINGS
        return expm1(k * log1p(float(fmt.u))) * self.size + k * float(fmt.eta)

    def __add__(self, other: Sized) -> Sized:
        """x + y; a zero is no term."""
        if self.size == 0 or other.size == 0:
            return other if self.size == 0 else self
        counts = max(self.count, other.count), self.additions + other.additions + 1
        return Sized(self.value + other.value, self.size + other.size, *counts)

    def __neg__(self) -> Sized:
        """-x, exact."""
        return Sized(-self.value, self.size, self.count, self.additions)

    def __sub__(self, other: Sized) -> Sized:
        """x - y."""
        return self + -other

    def __mul__(self, other: Sized) -> Sized:
        """x y; a factor 0, 1 or -1 is no product."""
        for x, y in ((self, other), (other, self)):
            if x.size == 0 or (x.size == 1 and x.roundings == 0):
                return x if x.size == 0 else Sized(x.value * y.value, y.size, y.count, y.additions)
        return Sized(self.value * other.value, self.size * other.size, self.roundings + other.roundings + 1)

    def __truediv__(self, other: Sized) -> Sized:
        """x/y, as derived above; without bound at y = 0."""
        if other.value == 0:
            return Sized(inf, inf)
        size = self.size / abs(other.value) * (other.size / abs(other.value))
        return Sized(self.value / other.value, size, self.roundings + other.roundings + 1)


def exponential(x: Sized) -> Sized:
    """exp(x), as derived above."""
    return Sized(exp(x.value), exp(x.value) * (1 + x.size), x.roundings + 2)


@dataclass(frozen=True, slots=True)
class SizePolynomial:
    """The same tally for polynomials in |h|: `sizes` are the sums of |monomials| power by power, constant first."""

    sizes: Coefficients
    count: int = 0
    additions: int = 0

    @property
    def roundings(self) -> int:
        """The most roundings that a monomial passes, in any order."""
        return self.count + self.additions

    def __call__(self, h: float) -> float:
        """The sum of |monomials| at |h|."""
        return float(np.polynomial.polynomial.polyval(abs(h), self.sizes))

    def __add__(self, other: SizePolynomial) -> SizePolynomial:
        """x + y; a zero is no term."""
        if not self.sizes.size or not other.sizes.size:
            return other if not self.sizes.size else self
        longer, shorter = sorted((self.sizes, other.sizes), key=len, reverse=True)
        total = longer.copy()
        total[: len(shorter)] += shorter
        return SizePolynomial(total, max(self.count, other.count), self.additions + other.additions + 1)

    def __neg__(self) -> SizePolynomial:
        """-x, of the same size."""
        return self

    def __sub__(self, other: SizePolynomial) -> SizePolynomial:
        """x - y, of the size of x + y."""
        return self + other

    def __mul__(self, other: SizePolynomial) -> SizePolynomial:
        """x y; a factor 0 or 1 is no product."""
        if not self.sizes.size or not other.sizes.size:
            return _NOTHING
        for x, y in ((self, other), (other, self)):
            if x.roundings == 0 and len(x.sizes) == 1 and x.sizes[0] == 1:
                return y
        return SizePolynomial(np.convolve(self.sizes, other.sizes), self.roundings + other.roundings + 1)


_NOTHING = SizePolynomial(np.zeros(0))
_ONE, _STEP = SizePolynomial(np.ones(1)), SizePolynomial(np.array([0.0, 1.0]))


def matrix_sizes(method: Method) -> tuple[SizePolynomial, ...]:
    """The sizes of M_qq, M_qv, M_vq, M_vv of an explicit method on q' = v, v' = -q, as polynomials in |h|.

    Raises MethodError for an implicit method.
    """
    step = stepper(method, _coefficient)
    columns = [step(_force, q, v, _STEP) for q, v in ((_ONE, _NOTHING), (_NOTHING, _ONE))]
    return tuple(entry for row in zip(*columns, strict=True) for entry in row)


def _coefficient(c: object) -> SizePolynomial:
    size = abs(float(c))  # type: ignore[arg-type]
    return SizePolynomial(np.array([size]), 0 if size == 1 else COEFFICIENT_ROUNDINGS)


def _force(q: SizePolynomial) -> SizePolynomial:
    """The force of the oscillator on sizes: a change of sign is none."""
    return SizePolynomial(q.sizes, q.count + FORCE_ROUNDINGS if q.sizes.size else 0, q.additions)
