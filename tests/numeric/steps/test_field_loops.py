"""What loops call of a field is the field, and its derivatives."""

from __future__ import annotations

from fractions import Fraction

import pytest

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.advance import field_rate, float_start
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.steps import field_loops
from driftproof.numeric.steps.elimination import FULL, Band
from driftproof.numeric.steps.field_loops import _looped, band_of, field_writers

COUPLED = VectorField(("sin(y1) * t", "y0 * y2", "y1 - y2 / y0"))


def line_of(n: int) -> VectorField:
    """Two numbers at each of n places, coupled to their neighbours, with other ends."""
    y = lambda i: f"y{i}" if 0 <= i < 2 * n else "a"
    rates = [
        (f"{y(i - 2)} - 2 * y{i} * {y(i + 1)} + {y(i + 2)}", f"y{i} * y{i - 1} + t - {y(i + 2)}")[i % 2]
        for i in range(2 * n)
    ]
    return VectorField(tuple(rates), (("a", Fraction(3, 2)),))


CHOSEN = VectorField(
    ("(y0 * y1 if 2 * y0 > 1 else y1 / y0) + floor(3 * t)", "(y0 * y0 if y1 <= y0 else -y1) * (y1 if t < 1 else y0)")
)


@pytest.mark.parametrize("field", [COUPLED, CHOSEN, line_of(20), *(PROBLEMS[key].field for key in ("kepler", "hires"))])
def test_rates_are_the_fields_and_derivatives_their_differences(field: VectorField) -> None:
    """Differences over 2⁻²⁶ of numbers near 1 are off by some 2⁻²⁴; a row of a band begins left of the diagonal."""
    n, rate, (write, derive, band, *_) = len(field.rates), field_rate(field), field_writers(field, compiled=False)
    y, f, matrix = [1 + i / 8 for i in range(n)], [0.0] * n, [[0.0] * n for _ in range(n)]
    write(0.5, y, f)
    assert f == rate(0.5, y)
    derive(0.5, y, matrix)
    for j in range(n):
        moved = rate(0.5, [x + 2.0**-26 * (i == j) for i, x in enumerate(y)])
        column = [row[j - max(0, i - band.lower)] if abs(i - j) <= band.lower else 0 for i, row in enumerate(matrix)]
        assert column == pytest.approx([(a - b) * 2.0**26 for a, b in zip(moved, f, strict=True)], abs=1e-4, rel=1e-4)


@pytest.mark.long  # numba compiles
def test_compiled_they_are_the_same_bits() -> None:
    np = pytest.importorskip("numpy")
    pytest.importorskip("numba")
    start = float_start(PROBLEMS["oregonator"])
    found = []
    for compiled in (False, True):
        write, derive, _, zeros, _ = field_writers(PROBLEMS["oregonator"].field, compiled=compiled)
        f, matrix = zeros(3), zeros(3, 3)
        write(0.0, np.array(start), f)
        derive(0.0, np.array(start), matrix)
        found.append((list(f), [list(row) for row in matrix]))
    assert found[0] == found[1]


CORNERED = VectorField((*line_of(20).rates, "y0 * y40"), line_of(20).parameters)


@pytest.mark.parametrize("field", [line_of(20), CORNERED])
def test_loops_write_what_stands_in_the_rates(field: VectorField, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second field has a corner, and so no band; both are the bits of the lines one by one."""
    n, found = len(field.rates), []
    y = [1 + i / 64 for i in range(n)]
    for looped in (2, 10**6):
        monkeypatch.setattr(field_loops, "LOOPED", looped)
        write, derive, band, *_ = field_writers(field, compiled=False)
        f, matrix = [0.0] * n, [[0.0] * min(n, band.lower + band.upper + 1) for _ in range(n)]
        write(0.5, y, f)
        derive(0.5, y, matrix)
        found.append((band, f, matrix))
    assert found[0] == found[1]
    assert found[0][0] == (Band(2, 2) if n == 40 else FULL)
    assert found[0][1] == field_rate(field)(0.5, y)


def test_many_alike_rates_are_few_lines() -> None:
    rows = [[f"last[{{i}}] = {rate}"] for rate in line_of(500).rates]
    assert len(list(_looped(rows))) < 12


def test_a_band_is_what_rows_reach_and_taken_where_it_is_less_to_do() -> None:
    near = [{max(0, i - 1), i, min(39, i + 3)} for i in range(40)]
    assert band_of(near) == Band(1, 3)
    assert (band_of(near[:12]), band_of(near[:11])) == (Band(1, 3), FULL)
    assert band_of([set()] * 9) == Band(0, 0)
