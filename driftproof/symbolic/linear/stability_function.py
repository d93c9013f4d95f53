"""R(z) of a Runge-Kutta method, with y₁ = R(hλ) y₀ on y' = λy, by exact linear algebra on its tableau (A, b, c)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import Any, TypeAlias

from flint import fmpq, fmpq_mat, fmpq_poly

from driftproof.methods.numbers.number_field import NumberField
from driftproof.methods.schemes import Collocation, RungeKutta, is_strictly_lower
from driftproof.symbolic.algebra.matrices import faddeev_leverrier
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    Polynomial,
    Scalar,
    X,
    descend,
    dot,
    from_scalars,
    polynomial,
    scalar,
)
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction

RationalMatrix: TypeAlias = Any


@dataclass(frozen=True)
class ScalarTableau:
    """(A, b, c) with exact scalars; `field` is the number field of the irrational ones, None over Q."""

    a: tuple[tuple[Scalar, ...], ...]
    b: tuple[Scalar, ...]
    c: tuple[Scalar, ...]
    field: NumberField | None

    @property
    def stages(self) -> int:
        """The number of stages s."""
        return len(self.b)

    @property
    def explicit(self) -> bool:
        """True if A is strictly lower triangular."""
        return is_strictly_lower(self.a)

    def moments(self, start: Sequence[Scalar]) -> list[Scalar]:
        """The moments bᵀ Aᵏ v for k = 0, ..., s - 1 and v = `start`."""
        if self.field:
            return [dot(row, start) for row in self._rows]
        return list((fmpq_mat(self._rows) * fmpq_mat(self.stages, 1, list(start))).entries())

    @cached_property
    def _rows(self) -> list[list[Scalar]]:
        """The rows bᵀ Aᵏ for k = 0, ..., s - 1; FLINT computes them over Q."""
        found = [list(self.b)]
        for _ in range(self.stages - 1):
            if self.field:
                found.append([dot(found[-1], column) for column in zip(*self.a, strict=True)])
            else:
                found.append((fmpq_mat(1, self.stages, found[-1]) * self._matrix).entries())
        return found

    def power(self, k: int) -> tuple[Scalar, ...]:
        """The vector of the powers cᵢᵏ; all ones for k = 0."""
        return tuple(c**k for c in self.c)

    @cached_property
    def denominator(self) -> Polynomial:
        """det(I - zA); over a number field by a recursion that takes no remainder of polynomials."""
        if not self.field:
            return fmpq_poly(self._matrix.charpoly().coeffs()[::-1])
        return from_scalars(faddeev_leverrier(self.a)[0])

    def times_denominator(self, series: Sequence[Scalar]) -> RationalFunction:
        """The rational function with this series and the denominator det(I - zA); its numerator has no more terms."""
        if self.explicit:  # the denominator is 1
            return RationalFunction(from_scalars(series), ONE)
        product = self.denominator * from_scalars(series)
        return fraction(descend(from_scalars([product[k] for k in range(len(series))])), self.denominator)

    @cached_property
    def _matrix(self) -> RationalMatrix:
        return fmpq_mat([*map(list, self.a)])


@dataclass(frozen=True)
class NodeTableau(ScalarTableau):
    """Collocation at the roots of M = `nodes`, in the basis 1, x, ..., xˢ⁻¹ of Q[x]/M instead of values at the nodes.

    A is integration from 0, b integration from 0 to 1, and cᵏ the class of xᵏ: rational even if the nodes are not.
    """

    nodes: Polynomial

    def power(self, k: int) -> tuple[Scalar, ...]:
        """The class of xᵏ in the basis 1, x, ..., xˢ⁻¹."""
        rest = fmpq_poly([0] * k + [1]) % self.nodes
        return tuple(rest[i] for i in range(self.stages))


def scalar_tableau(method: RungeKutta | Collocation) -> ScalarTableau:
    """The tableau of `method` with exact scalars."""
    if isinstance(method, Collocation):
        nodes, size = polynomial(method.node_polynomial), method.stages
        weights = tuple(fmpq(1, j + 1) for j in range(size))
        images = [fmpq_poly([*[0] * (j + 1), weight]) % nodes for j, weight in enumerate(weights)]
        return NodeTableau(tuple(tuple(image[i] for image in images) for i in range(size)), weights, (), None, nodes)
    a = tuple(tuple(scalar(x) for x in row) for row in method.a)
    b, c = (tuple(scalar(x) for x in row) for row in (method.b, method.c))
    return ScalarTableau(a, b, c, method.field)


def stability_function(method: RungeKutta | Collocation) -> RationalFunction:
    """R(z) = 1 + z bᵀ(I - zA)⁻¹1 in lowest terms (hairer-wanner-1996, IV.3).

    It comes from the series 1 + Σ zᵏ⁺¹ bᵀAᵏ1, whose product with det(I - zA) ends at zˢ: a polynomial of degree at most
    s for an explicit method, else P/Q with degrees at most s.
    """
    return stability_function_by_moments(scalar_tableau(method))


def stability_function_by_moments(data: ScalarTableau) -> RationalFunction:
    """R(z) of a tableau."""
    return data.times_denominator([ONE[0], *data.moments(data.power(0))])


def resolvent(data: ScalarTableau, start: Sequence[Scalar]) -> RationalFunction:
    """bᵀ(I - zA)⁻¹v for v = `start`, in lowest terms."""
    return data.times_denominator(data.moments(start))


def prothero_robinson(method: RungeKutta | Collocation | ScalarTableau, power: int) -> RationalFunction:
    """ψₖ(z) for k = `power` >= 1, with φ(t + h) - y₁ = Σₖ ψₖ(hλ) hᵏ φ⁽ᵏ⁾(t) on y' = λ(y - φ(t)) + φ'(t), y₀ = φ(t).

    ψₖ = (z bᵀ(I - zA)⁻¹(cᵏ/k - A cᵏ⁻¹) + 1/k - bᵀcᵏ⁻¹) / (k - 1)! (hairer-wanner-1996, IV.15). It vanishes for k up
    to the stage order; a nonzero ψₖ with k <= order reduces the order on stiff problems.
    """
    data = method if isinstance(method, ScalarTableau) else scalar_tableau(method)
    nodes = data.power(power - 1)
    defects = [x / power - dot(row, nodes) for x, row in zip(data.power(power), data.a, strict=True)]
    quadrature = fraction(ONE * (fmpq(1, power) - dot(data.b, nodes)))
    total = quadrature + fraction(X) * resolvent(data, defects) if any(defects) else quadrature
    return total * fraction(ONE / factorial(power - 1))
