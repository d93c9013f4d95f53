"""Elimination beside exact fractions: full and banded, rows exchanged, and a matrix that has no inverse."""

from __future__ import annotations

from fractions import Fraction as Q
from random import Random

import numpy as np
import pytest

from driftproof.numeric.steps.elimination import FULL, Band, factored, sign_of_determinant, solve
from driftproof.numeric.steps.tableaux import solved


def banded(matrix: list[list[float]], band: Band) -> list[list[float]]:
    """Its rows from max(0, i - lower) on, with room for what exchanges fill in."""
    n, (lower, upper) = len(matrix), band
    return [(row[max(0, i - lower) :] + [0.0] * n)[: min(n, 2 * lower + upper + 1)] for i, row in enumerate(matrix)]


@pytest.mark.parametrize("band", [FULL, Band(1, 1), Band(2, 1), Band(1, 3), Band(0, 2), Band(3, 0)])
@pytest.mark.parametrize("size", [1, 2, 7, 12])
def test_solutions_are_those_of_fractions(band: Band, size: int) -> None:
    """Entries are small whole numbers, of which few bits are lost."""
    random, tried = Random(size), 0
    for _ in range(20):
        inside = lambda i, j: -band.lower <= j - i <= band.upper
        matrix = [
            [float(random.randint(-3, 3) or 1) if inside(i, j) else 0.0 for j in range(size)] for i in range(size)
        ]
        right = [float(random.randint(-9, 9)) for _ in range(size)]
        sign = np.sign(np.linalg.det(matrix))
        exact = solved([[Q(x) for x in row] for row in matrix], [Q(x) for x in right])
        rows, exchanged, x = banded(matrix, band), [0] * size, list(right)
        if exact is None:
            continue
        assert factored(rows, exchanged, size, *band)
        assert sign_of_determinant(rows, exchanged, size, band.lower) == sign
        solve(rows, exchanged, size, x, *band)
        assert x == pytest.approx([float(y) for y in exact], abs=1e-9 * (1 + max(map(abs, exact))))
        tried += 1
    assert tried > 14


def test_rows_are_exchanged_for_a_larger_pivot_and_not_for_one_of_the_same_size() -> None:
    for entry, other, sign in ((2.0, 0, -1), (-2.5, 1, 1), (-2 - 2.0**-40, 1, 0)):
        exchanged, rows = [9, 9], [[-2.0, 1.0], [entry, 1.0]]
        assert factored(rows, exchanged, 2, *FULL)
        assert exchanged == [other, 1]
        assert sign_of_determinant(rows, exchanged, 2, FULL.lower) == sign


def test_a_matrix_without_an_inverse_has_a_zero_pivot() -> None:
    assert min(FULL) > 10**6
    assert not factored([[1.0, 2.0], [2.0, 4.0]], [0, 0], 2, *FULL)
    assert not factored([[0.0, 2.0], [0.0, 4.0]], [0, 0], 2, *FULL)
