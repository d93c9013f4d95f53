"""Error constants, dispersion and dissipation: by R, by the matrix, and in balls."""

from __future__ import annotations

import pytest
from flint import acb, arb, ctx

from driftproof.symbolic.algebra.polynomials import exact
from driftproof.symbolic.linear.oscillator import (
    area_factor,
    is_matrix_symmetric,
    matrix_trace,
    oscillator_matrix,
    stability_function_of,
)
from driftproof.symbolic.linear.phase import (
    angle_error,
    angle_error_series,
    damping_series,
    dispersion,
    dispersion_series,
    dissipation,
    dissipation_series,
    error_constant,
    is_linearly_symmetric,
    leading_dissipation,
    matrix_error,
    modified_rate,
)
from tests.nine import NINE
from tests.symbolic.linear.linear_examples import EVERY, at, ball

PHASES: dict[str, tuple[int, str, tuple[int, str], tuple[int, str] | None]] = {
    "forward_euler": (2, "-1/2", (3, "-1/3"), (2, "1/2")), "backward": (2, "1/2", (3, "-1/3"), (2, "-1/2")),
    "midpoint": (3, "1/12", (3, "-1/12"), None), "rk4": (5, "-1/120", (5, "-1/120"), (6, "-1/144")),
    "rk38": (5, "-1/120", (5, "-1/120"), (6, "-1/144")), "gauss2": (5, "-1/720", (5, "-1/720"), None),
    "gauss3": (7, "1/100800", (7, "-1/100800"), None),
}  # fmt: skip


@pytest.mark.parametrize("key", PHASES)
def test_error_dispersion_and_dissipation(key: str) -> None:
    r = stability_function_of(EVERY[key])
    assert r is not None
    power, constant, phase, size = PHASES[key]
    assert (error_constant(r).power, str(error_constant(r).coefficient)) == (power, constant)
    assert (dispersion(r).power, str(dispersion(r).coefficient)) == phase
    found = dissipation(r)
    assert (found and (found.power, str(found.coefficient))) == size
    assert is_linearly_symmetric(r) == (size is None)


@pytest.mark.parametrize("key", PHASES)
def test_phase_by_r_and_by_the_matrix(key: str) -> None:
    r, m = stability_function_of(EVERY[key]), oscillator_matrix(EVERY[key])
    assert r is not None
    assert angle_error_series(m, 14) == dispersion_series(r, 14)
    assert damping_series(m, 14) == dissipation_series(r, 14)
    assert (angle_error(m), leading_dissipation(m)) == (dispersion(r), dissipation(r))
    assert matrix_error(m) == error_constant(r).power
    assert is_matrix_symmetric(m) == is_linearly_symmetric(r)


ANGLES = {
    "symplectic_euler": (2, (3, "1/24")),
    "velocity_verlet": (3, (3, "1/24")),
    "position_verlet": (3, (3, "1/24")),
}


@pytest.mark.parametrize("key", ANGLES)
def test_splittings_lead_by_h_cubed_over_24(key: str) -> None:
    m = oscillator_matrix(NINE[key])
    power, phase = ANGLES[key]
    assert matrix_error(m) == power
    assert (angle_error(m).power, str(angle_error(m).coefficient)) == phase
    assert leading_dissipation(m) is None
    assert is_matrix_symmetric(m) == key.endswith("verlet")


@pytest.mark.parametrize("key", [*PHASES, *ANGLES, "triple_jump", "nystrom_explicit"])
def test_series_of_the_angle_in_balls(key: str) -> None:
    """At h = 2**-12 the series to h**15 is the angle itself but for a relative 2**-100, say."""
    m = oscillator_matrix(EVERY[key])
    with ctx.workprec(400):
        h = arb(2) ** -12
        half, area = at(matrix_trace(m), h) / 2, at(area_factor(m), h)
        angle = acb(half, (area - half**2).sqrt()).arg() - h
        series = sum((ball(c) * h**k for k, c in enumerate(angle_error_series(m, 16))), arb(0))
        assert abs(angle - series) < h**15
        wrong = series + h**14
        assert not abs(angle - wrong) < h**15


@pytest.mark.parametrize("key", ["rk4", "backward", "gauss2"])
def test_modified_rate_exponentiates_to_r(key: str) -> None:
    r = stability_function_of(EVERY[key])
    assert r is not None
    rate = modified_rate(r, 20)
    assert (exact(rate[0]), exact(rate[1])) == (0, 1)
    with ctx.workprec(300):
        z = arb(2) ** -10
        total = sum((ball(c) * z**k for k, c in enumerate(rate)), arb(0))
        assert abs(at(r, z) - total.exp()) < z**19
