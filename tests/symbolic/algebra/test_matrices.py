"""Determinant, adjugate and functions of a matrix, against FLINT's matrices over Q."""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from driftproof.methods.numbers.number_field import square_root
from driftproof.symbolic.algebra.matrices import faddeev_leverrier, matrix_determinant, matrix_product, of_matrix
from driftproof.symbolic.algebra.polynomials import exact, scalar
from driftproof.symbolic.algebra.rational_functions import fraction

X = fmpq_poly([0, 1])
MATRICES = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(st.integers(-5, 5), min_size=n, max_size=n), min_size=n, max_size=n)
)


def rows_of(m: Any) -> list[list[fmpq]]:
    return [[m[i, j] for j in range(m.ncols())] for i in range(m.nrows())]


@given(MATRICES)
def test_determinant_and_adjugate_are_flints(entries: list[list[int]]) -> None:
    rows, m = [[fmpq(x) for x in row] for row in entries], fmpq_mat(entries)
    characteristic, matrices = faddeev_leverrier(rows)
    assert matrix_determinant(rows) == m.det()
    assert characteristic[::-1] == m.charpoly().coeffs()
    identity = fmpq_mat([[int(i == j) for j in range(len(rows))] for i in range(len(rows))])
    assert matrix_product(rows, matrices[-1]) == rows_of(-identity * characteristic[-1])


@given(MATRICES, st.fractions(-1, 1, max_denominator=7))
def test_function_of_a_matrix_is_its_value_by_inverses(entries: list[list[int]], h: Any) -> None:
    """R(hA) for R(z) = (1 + z/3)/(1 - 2z/3), at a number h."""
    found = of_matrix(fraction(1 + X / 3, 1 - 2 * X / 3), [[fmpq(x) for x in row] for row in entries])
    moved = fmpq_mat(entries) * scalar(h)
    identity = fmpq_mat([[int(i == j) for j in range(len(entries))] for i in range(len(entries))])
    below = identity - moved * fmpq(2, 3)
    if below.det() != 0:
        expected = below.inv() * (identity + moved * fmpq(1, 3))
        assert [[f(scalar(h)) for f in row] for row in found] == rows_of(expected)


def test_entries_may_lie_in_a_number_field() -> None:
    root = scalar(square_root(2))
    assert exact(matrix_determinant([[root, scalar(1)], [scalar(3), root]])) == -1
