"""Square matrices over commutative rings that contain Q: determinant, adjugate, and functions of a matrix."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from flint import fmpq_mat

from driftproof.symbolic.algebra.polynomials import ONE, ZERO, Polynomial, Scalar, descend, dot
from driftproof.symbolic.algebra.rational_functions import RationalFunction, fraction

# Entries in a commutative ring that contains Q, such as scalars or polynomials.
MatrixRows: TypeAlias = Sequence[Sequence[Scalar]]
# Entries are rational functions of the step size h.
StepMatrix: TypeAlias = tuple[tuple[RationalFunction, ...], ...]


def matrix_product(a: MatrixRows, b: MatrixRows) -> list[list[Scalar]]:
    """The matrix product; FLINT computes it if all entries are rational."""
    try:
        return list((fmpq_mat([*map(list, a)]) * fmpq_mat([*map(list, b)])).tolist())
    except TypeError:
        columns = list(zip(*b, strict=True))
        return [[dot(row, column) for column in columns] for row in a]


def faddeev_leverrier(rows: MatrixRows) -> tuple[list[Scalar], list[list[list[Scalar]]]]:
    """Lists (1, c₁, ..., cₙ) and (M₁, ..., Mₙ) with det(λI - A) = Σ cₖ λⁿ⁻ᵏ and adj(λI - A) = Σ Mₖ λⁿ⁻ᵏ.

    M₁ = I, cₖ = -tr(A Mₖ)/k, Mₖ₊₁ = A Mₖ + cₖ I: the recursion divides by integers only.
    """
    size = len(rows)
    zero = rows[0][0] * 0
    current = [[zero + int(i == j) for j in range(size)] for i in range(size)]
    found, matrices = [zero + 1], []
    for k in range(1, size + 1):
        matrices.append(current)
        moved = matrix_product(rows, current)
        c = -sum((moved[i][i] for i in range(size)), zero) / k
        found.append(c)
        current = [[x + c if i == j else x for j, x in enumerate(row)] for i, row in enumerate(moved)]
    return found, matrices


def matrix_determinant(rows: MatrixRows) -> Scalar:
    """The determinant of a square matrix."""
    return faddeev_leverrier(rows)[0][-1] * (-1) ** len(rows)


def of_matrix(r: RationalFunction, rows: MatrixRows) -> StepMatrix:
    """R(hA) = P(hA) Q(hA)⁻¹ for a square matrix A of exact scalars; its entries are rational functions of h."""
    num, den = _at_matrix(r.num, rows), _at_matrix(r.den, rows)
    if r.den == ONE:
        return tuple(tuple(fraction(x, r.den) for x in row) for row in num)
    (*_, last), (*_, adjugate) = faddeev_leverrier(den)  # the inverse is -Mₙ/cₙ
    return tuple(tuple(fraction(descend(-x), last) for x in row) for row in matrix_product(num, adjugate))


def _at_matrix(p: Polynomial, rows: MatrixRows) -> list[list[Polynomial]]:
    """p(hA), by Horner's rule."""
    size = len(rows)
    total: list[list[Polynomial]] = [[ZERO] * size for _ in range(size)]
    for c in reversed(p.coeffs()):
        moved = [[x.left_shift(1) for x in row] for row in matrix_product(rows, total)]
        total = [[x + c if i == j else x for j, x in enumerate(row)] for i, row in enumerate(moved)]
    return total
