"""R(z) of a Runge-Kutta method, with y₁ = R(hλ) y₀ on y' = λy, by exact linear algebra on its tableau (A, b, c)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import Any, TypeAlias

from flint import fmpq, fmpq_mat, fmpq_poly

from driftproof.methods.number_field import NumberField
from driftproof.methods.schemes import Collocation, RungeKutta, is_strictly_lower
from driftproof.symbolic.algebra.polynomials import (
    ONE,
    FieldPolynomial,
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
    """(A, b, c) with exact scalars; `field` is the number field of the irrational ones, None over Q.

    Every element x of a field of degree d is written as the d x d matrix over Q of multiplication by x. A matrix over
    the field thus is a block matrix over Q, which FLINT multiplies.
    """

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

    def moments(self, start: Sequence[Scalar], count: int) -> list[Scalar]:
        """The moments bᵀ Aᵏ v for k = 0, ..., count - 1 and v = `start`."""
        vector, found = self._column(start), []
        for k in range(count):
            if k:
                vector = self._matrix * vector
            found.append(self._element(self._weights * vector))
        return found

    def power(self, k: int) -> tuple[Scalar, ...]:
        """The vector of the powers cᵢᵏ; all ones for k = 0."""
        return tuple(c**k for c in self.c)

    @cached_property
    def denominator(self) -> Polynomial:
        """det(I - zA); over a number field from the traces of the powers of A, by Newton's identities."""
        if not self.field:
            return fmpq_poly(self._matrix.charpoly().coeffs()[::-1])
        power, traces, found = self._matrix, [], [ONE[0]]
        for k in range(1, self.stages + 1):
            columns = power.tolist()
            firsts = range(0, len(columns), self.field.degree)
            diagonal = [[sum(columns[j + i][j] for j in firsts)] for i in range(self.field.degree)]
            traces.append(self._element(fmpq_mat(diagonal)))
            found.append(-dot(found, traces[::-1]) / k)
            power = power * self._matrix
        return from_scalars(found)

    def times_denominator(self, series: Sequence[Scalar]) -> RationalFunction:
        """The rational function with this series and the denominator det(I - zA); its numerator has no more terms."""
        if self.explicit:  # the denominator is 1
            return RationalFunction(from_scalars(series), ONE)
        product = self.denominator * from_scalars(series)
        return fraction(descend(from_scalars([product[k] for k in range(len(series))])), self.denominator)

    @cached_property
    def _matrix(self) -> RationalMatrix:
        return self._blocks(self.a)

    @cached_property
    def _weights(self) -> RationalMatrix:
        return self._blocks((self.b,))

    def _blocks(self, rows: Sequence[Sequence[Scalar]]) -> RationalMatrix:
        if not self.field:
            return fmpq_mat([list(row) for row in rows])
        blocks = [[_multiplication(x, self.field) for x in row] for row in rows]
        return fmpq_mat([[x for block in row for x in block[i]] for row in blocks for i in range(self.field.degree)])

    def _column(self, vector: Sequence[Scalar]) -> RationalMatrix:
        entries = [row[0] for x in vector for row in _multiplication(x, self.field)] if self.field else list(vector)
        return fmpq_mat(len(entries), 1, entries)

    def _element(self, column: RationalMatrix) -> Scalar:
        if not self.field:
            return column[0, 0]
        return FieldPolynomial(self.field, [fmpq_poly([x]) for x in column.entries()])


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

    @classmethod
    def of(cls, nodes: Polynomial) -> NodeTableau:
        """The tableau for a node polynomial M over Q of degree s >= 1."""
        size = nodes.degree()
        images = [fmpq_poly([0] * (j + 1) + [fmpq(1, j + 1)]) % nodes for j in range(size)]
        rows = tuple(tuple(image[i] for image in images) for i in range(size))
        weights = tuple(fmpq(1, j + 1) for j in range(size))
        return cls(rows, weights, (), None, nodes)


def scalar_tableau(method: RungeKutta | Collocation) -> ScalarTableau:
    """The tableau of `method` with exact scalars."""
    if isinstance(method, Collocation):
        return NodeTableau.of(polynomial(method.node_polynomial))
    a = tuple(tuple(scalar(x) for x in row) for row in method.a)
    b, c = (tuple(scalar(x) for x in row) for row in (method.b, method.c))
    return ScalarTableau(a, b, c, method.field)


def _multiplication(x: Scalar, field: NumberField) -> list[list[fmpq]]:
    """The matrix of multiplication by x: row i, column j holds the coordinate i of x αʲ."""
    d = field.degree
    if not isinstance(x, FieldPolynomial):
        return [[x if i == j else fmpq(0) for j in range(d)] for i in range(d)]
    columns = x.multiples()
    return [[column.parts[i][0] for column in columns] for i in range(d)]


def stability_function(method: RungeKutta | Collocation) -> RationalFunction:
    """R(z) = 1 + z bᵀ(I - zA)⁻¹1 in lowest terms (hairer-wanner-1996, IV.3).

    It comes from the series 1 + Σ zᵏ⁺¹ bᵀAᵏ1, whose product with det(I - zA) ends at zˢ: a polynomial of degree at most
    s for an explicit method, else P/Q with degrees at most s.
    """
    return stability_function_by_moments(scalar_tableau(method))


def stability_function_by_moments(data: ScalarTableau) -> RationalFunction:
    """R(z) of a tableau."""
    return data.times_denominator([ONE[0], *data.moments(data.power(0), data.stages)])


def resolvent(data: ScalarTableau, start: Sequence[Scalar]) -> RationalFunction:
    """bᵀ(I - zA)⁻¹v for v = `start`, in lowest terms."""
    return data.times_denominator(data.moments(start, data.stages))


def prothero_robinson(method: RungeKutta | Collocation, power: int) -> RationalFunction:
    """ψₖ(z) for k = `power` >= 1, with φ(t + h) - y₁ = Σₖ ψₖ(hλ) hᵏ φ⁽ᵏ⁾(t) on y' = λ(y - φ(t)) + φ'(t), y₀ = φ(t).

    ψₖ = (z bᵀ(I - zA)⁻¹(cᵏ/k - A cᵏ⁻¹) + 1/k - bᵀcᵏ⁻¹) / (k - 1)! (hairer-wanner-1996, IV.15). It vanishes for k up
    to the stage order; a nonzero ψₖ with k <= order reduces the order on stiff problems.
    """
    data = scalar_tableau(method)
    nodes = data.power(power - 1)
    defects = [x / power - dot(row, nodes) for x, row in zip(data.power(power), data.a, strict=True)]
    quadrature = fraction(ONE * (fmpq(1, power) - dot(data.b, nodes)))
    total = quadrature + fraction(X) * resolvent(data, defects) if any(defects) else quadrature
    return total * fraction(ONE / factorial(power - 1))
