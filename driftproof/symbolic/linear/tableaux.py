"""Linear algebra with a tableau (A, b, c) over Q or a number field, all of it by FLINT's matrices over Q."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

from flint import fmpq, fmpq_mat, fmpq_poly

from driftproof.methods.number_field import NumberField
from driftproof.methods.schemes import Collocation, RungeKutta, is_strictly_lower
from driftproof.symbolic.algebra.polynomials import (
    FieldPolynomial,
    Polynomial,
    Scalar,
    descend,
    dot,
    polynomial,
    scalar,
)

RationalMatrix: TypeAlias = Any


@dataclass(frozen=True)
class Tableau:
    """(A, b, c) with exact scalars; `field` is the number field of the irrational ones, None over Q.

    An element x of a field of degree d is also the d x d matrix over Q of multiplication by x; written so in blocks, a
    matrix over the field is one over Q, and products of matrices are FLINT's. Raises TypeError for two fields at once.
    """

    a: tuple[tuple[Scalar, ...], ...]
    b: tuple[Scalar, ...]
    c: tuple[Scalar, ...]
    field: NumberField | None

    @property
    def stages(self) -> int:
        """s."""
        return len(self.b)

    @property
    def explicit(self) -> bool:
        """True when A is strictly lower triangular."""
        return is_strictly_lower(self.a)

    def moments(self, start: Sequence[Scalar], count: int) -> list[Scalar]:
        """bᵀ Aᵏ v for k below `count`, v = start."""
        vector, found = self._column(start), []
        for k in range(count):
            if k:
                vector = self._matrix * vector
            found.append(self._element(self._weights * vector))
        return found

    def weighted(self, weights: Sequence[Scalar]) -> Tableau:
        """The same A and c with other weights."""
        return replace(self, b=tuple(weights))

    def power(self, k: int) -> tuple[Scalar, ...]:
        """The vector of the cᵢᵏ; for k = 0 the vector of ones."""
        return tuple(c**k for c in self.c)

    def applied(self, vector: Sequence[Scalar]) -> tuple[Scalar, ...]:
        """A v."""
        return tuple(dot(row, vector) for row in self.a)

    def weighed(self, vector: Sequence[Scalar]) -> Scalar:
        """bᵀv."""
        return dot(self.b, vector)

    @cached_property
    def _matrix(self) -> RationalMatrix:
        return self._blocks(self.a)

    @cached_property
    def _weights(self) -> RationalMatrix:
        return self._blocks((self.b,))

    @property
    def _degree(self) -> int:
        return self.field.degree if self.field else 1

    def _blocks(self, rows: Sequence[Sequence[Scalar]]) -> RationalMatrix:
        if not self.field:
            return fmpq_mat([list(row) for row in rows])
        d = self._degree
        blocks = [[_multiplication(x, self.field) for x in row] for row in rows]
        return fmpq_mat([[x for block in row for x in block[i]] for row in blocks for i in range(d)])

    def _column(self, vector: Sequence[Scalar]) -> RationalMatrix:
        entries = [part for x in vector for part in _coordinates(x, self._degree)]
        return fmpq_mat(len(entries), 1, entries)

    def _element(self, column: RationalMatrix) -> Scalar:
        if not self.field:
            return column[0, 0]
        element = FieldPolynomial(self.field, [fmpq_poly([x]) for x in column.entries()])
        lowered = descend(element)
        return element if lowered is element else lowered[0]


@dataclass(frozen=True)
class NodeTableau(Tableau):
    """Collocation at the roots of M, in the basis 1, x, ..., xˢ⁻¹ of Q[x]/M instead of by values at the nodes.

    A is integration from 0, b integration from 0 to 1, and cᵏ the class of xᵏ: all rational where the nodes are not.
    """

    nodes: Polynomial

    def power(self, k: int) -> tuple[Scalar, ...]:
        """The class of xᵏ."""
        return self._class(fmpq_poly([0] * k + [1]))

    @classmethod
    def of(cls, nodes: Polynomial) -> NodeTableau:
        """The tableau of the node polynomial M over Q, of degree s >= 1."""
        size = nodes.degree()
        images = [fmpq_poly([0] * (j + 1) + [fmpq(1, j + 1)]) % nodes for j in range(size)]
        rows = tuple(tuple(image[i] for image in images) for i in range(size))
        weights = tuple(fmpq(1, j + 1) for j in range(size))
        return cls(rows, weights, (), None, nodes)

    def _class(self, p: Polynomial) -> tuple[Scalar, ...]:
        rest = p % self.nodes
        return tuple(rest[i] for i in range(self.stages))


def tableau(method: RungeKutta | Collocation) -> Tableau:
    """The tableau of `method` with exact scalars."""
    if isinstance(method, Collocation):
        return NodeTableau.of(polynomial(method.node_polynomial))
    a = tuple(tuple(scalar(x) for x in row) for row in method.a)
    b, c = (tuple(scalar(x) for x in row) for row in (method.b, method.c))
    return Tableau(a, b, c, method.field)


def _coordinates(x: Scalar, degree: int) -> list[fmpq]:
    if isinstance(x, FieldPolynomial):
        return [p[0] for p in x.parts]
    return [x, *[fmpq(0)] * (degree - 1)]


def _multiplication(x: Scalar, field: NumberField) -> list[list[fmpq]]:
    """Row i, column j: the coordinate i of x αʲ."""
    d = field.degree
    if not isinstance(x, FieldPolynomial):
        return [[x if i == j else fmpq(0) for j in range(d)] for i in range(d)]
    columns = x.multiples()
    return [[column.parts[i][0] for column in columns] for i in range(d)]
