"""The tests' own linear algebra is that of NumPy, up to rounding, and refuses the same systems."""

from __future__ import annotations

import numpy as np
import pytest

from tests.plain_algebra import product, solved


def test_products_and_solutions_are_those_of_numpy() -> None:
    draw = np.random.default_rng(1)
    for n in (1, 2, 5):
        matrix, x = draw.normal(size=(n, n)), draw.normal(size=n)
        matrix[0, 0] *= n == 1  # so that rows are exchanged
        assert product(matrix, x) == pytest.approx(matrix @ x, rel=1e-12)
        assert product(x, matrix) == pytest.approx(x @ matrix, rel=1e-12)
        assert solved(matrix, product(matrix, x)) == pytest.approx(x, rel=1e-10)
    with pytest.raises(np.linalg.LinAlgError, match="Singular matrix"):
        solved([[1.0, 2.0], [2.0, 4.0]], [1.0, 1.0])
