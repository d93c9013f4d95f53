"""SSP coefficients: the published ones, and the conditions by rational solves on both sides."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import fmpq_mat

from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.algebra.polynomials import X, scalar
from driftproof.symbolic.linear import monotonicity
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import (
    GAUSS_2,
    MIDPOINT,
    MIDPOINT_THRICE,
    SDIRK,
    TRAPEZOID,
    limit_text,
    runge_kutta,
)

HALF, SIXTHS = Q(1, 2), (Q(1, 6), Q(1, 6), Q(1, 6))
SSP: dict[str, tuple[RungeKutta, str]] = {
    "forward Euler": (NINE["forward_euler"], "1"), "SSP(2,2)": (NINE["heun2"], "1"),
    "SSP(3,3)": (runge_kutta(((0, 0, 0), (1, 0, 0), (Q(1, 4), Q(1, 4), 0)), (Q(1, 6), Q(1, 6), Q(2, 3))), "1"),
    "SSP(3,2)": (runge_kutta(((0, 0, 0), (Q(1, 2), 0, 0), (Q(1, 2), Q(1, 2), 0)), (Q(1, 3), Q(1, 3), Q(1, 3))), "2"),
    "SSP(4,3)": (runge_kutta(((0,) * 4, (HALF, 0, 0, 0), (HALF, HALF, 0, 0), (*SIXTHS, 0)), (*SIXTHS, HALF)), "2"),
    "classical RK4": (NINE["rk4"], "0"), "explicit midpoint": (NINE["midpoint2"], "0"),
    "Ralston": (runge_kutta(((0, 0), (Q(2, 3), 0)), (Q(1, 4), Q(3, 4))), "1/2"),
    "backward Euler": (runge_kutta(((1,),), (1,)), "oo"), "implicit midpoint": (MIDPOINT, "2"),
    "trapezoid": (TRAPEZOID, "2"), "SDIRK with sqrt(2)": (SDIRK, "1 + sqrt(2)"), "Gauss 2": (GAUSS_2, "0"),
    "the midpoint rule in three stages": (MIDPOINT_THRICE, "2"),
}  # fmt: skip


@pytest.mark.parametrize("name", SSP)
def test_ssp_coefficient_of(name: str) -> None:
    method, radius = SSP[name]
    assert limit_text(ssp_coefficient(method)) == radius


@pytest.mark.parametrize(
    ("second", "radius"),
    [
        *[((X - 1) * (X - 3), "1"), ((2 * X - 1) * (X - 1), "1/2"), ((X - 5) * (X - 6), "4"), ((X - 2) ** 2, "4")],
        *[(1 - 2 * X, "1/2"), (X, "4"), (-X, "0")],
    ],
)
def test_a_later_condition_counts_where_it_fails_before_the_others(
    second: Any, radius: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(monotonicity, "monotonicity_conditions", lambda stages: [4 - X, second])
    assert limit_text(ssp_coefficient(MIDPOINT)) == radius


@pytest.mark.parametrize("name", ["SSP(3,3)", "SSP(4,3)", "SSP(3,2)", "Ralston", "implicit midpoint"])
def test_conditions_hold_inside_the_radius_and_not_beyond(name: str) -> None:
    """The second formula: K(I + rK)⁻¹ by a solve with rational matrices at r (1 ± 10⁻¹²)."""
    method, text = SSP[name]
    radius = Q(text)
    for r, holds in ((radius * Q(10**12 - 1, 10**12), True), (radius, True), (radius * Q(10**12 + 1, 10**12), False)):
        assert _monotonic(method, r) == holds


def _monotonic(method: RungeKutta, r: Q) -> bool:
    size = method.stages + 1
    k = fmpq_mat([[*map(scalar, row), 0] for row in (*method.a, method.b)])
    identity = fmpq_mat([[int(i == j) for j in range(size)] for i in range(size)])
    inverse = k * (identity + k * scalar(r)).inv()
    rows = [[inverse[i, j] for j in range(size)] for i in range(size)]
    return all(x >= 0 for row in rows for x in row) and all(sum(row) * scalar(r) <= 1 for row in rows)
