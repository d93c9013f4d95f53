"""What loops call of a field is the field, and its derivatives."""

from __future__ import annotations

import pytest

from driftproof.methods.vector_fields import VectorField
from driftproof.numeric.advance import field_rate, float_start
from driftproof.numeric.field_loops import field_writers
from driftproof.numeric.problems.catalogue import PROBLEMS

COUPLED = VectorField(("sin(y1) * t", "y0 * y2", "y1 - y2 / y0"))


@pytest.mark.parametrize("field", [COUPLED, *(PROBLEMS[key].field for key in ("kepler", "hires"))])
def test_rates_are_the_fields_and_derivatives_their_differences(field: VectorField) -> None:
    """Differences over 2⁻²⁶ of numbers near 1 are off by some 2⁻²⁴."""
    n, rate, (write, derive, _, _) = len(field.rates), field_rate(field), field_writers(field, compiled=False)
    y, f, matrix = [1 + i / 8 for i in range(n)], [0.0] * n, [[0.0] * n for _ in range(n)]
    write(0.5, y, f)
    assert f == rate(0.5, y)
    derive(0.5, y, matrix)
    for j in range(n):
        moved = rate(0.5, [x + 2.0**-26 * (i == j) for i, x in enumerate(y)])
        assert [row[j] for row in matrix] == pytest.approx(
            [(a - b) * 2.0**26 for a, b in zip(moved, f, strict=True)], abs=1e-4, rel=1e-4
        )


@pytest.mark.long  # numba compiles
def test_compiled_they_are_the_same_bits() -> None:
    np = pytest.importorskip("numpy")
    pytest.importorskip("numba")
    start = float_start(PROBLEMS["oregonator"])
    found = []
    for compiled in (False, True):
        write, derive, _, kind = field_writers(PROBLEMS["oregonator"].field, compiled=compiled)
        f, matrix = kind.rows(1, 3)[0], kind.rows(3, 3)
        write(0.0, np.array(start), f)
        derive(0.0, np.array(start), matrix)
        found.append((list(f), [list(row) for row in matrix]))
    assert found[0] == found[1]
