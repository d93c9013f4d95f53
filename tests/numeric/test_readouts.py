"""What is read out of a state: distance, energy and wrapped phase, at ±180 degrees, at the origin and at the edges."""

from __future__ import annotations

from fractions import Fraction
from math import cos, hypot, inf, isinf, isnan, nan, nextafter, pi, sin

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from driftproof.numeric.readouts import energy, exact_state, phase_error, state_error

MAX_FLOAT = float(np.finfo(float).max)
ANGLES = st.floats(-pi, pi, allow_nan=False)
SCALES = st.sampled_from((1e-300, 1e-160, 1.0, 1e160, 1e300))


def at_angle(phase: float, size: float = 1.0) -> tuple[float, float]:
    """The state with phase angle atan2(-v, q) = phase."""
    return size * cos(phase), -size * sin(phase)


def test_exact_state_starts_at_the_start_and_moves_clockwise() -> None:
    assert exact_state((1.0, 0.0), 0.0) == (1.0, 0.0)
    q, v = exact_state((1.0, 0.0), 0.5)
    assert (q, v) == (cos(0.5), -sin(0.5))
    assert exact_state((0.0, 1.0), 0.5) == (sin(0.5), cos(0.5))


def test_state_error_is_the_distance_and_does_not_overflow_where_the_energy_does() -> None:
    far, origin = (3e200, 4e200), (0.0, 0.0)
    assert state_error(far, origin) == hypot(3e200, 4e200)
    with np.errstate(over="ignore"):
        assert isinf(energy((np.float64(3e200), np.float64(4e200))))
    assert state_error((3e-320, 4e-320), origin) == hypot(3e-320, 4e-320)
    assert energy((3e-320, 4e-320)) == 0  # it underflows, where the distance does not: a run says so


@given(st.tuples(*[st.floats(-1e155, 1e155) | st.floats(-1e-150, 1e-150)] * 2))
@example((1.5e154, 0.0))
@example((1e-161, 1e-161))
def test_energy_is_the_exact_one_rounded_and_overflows_or_vanishes_only_with_it(state: tuple[float, float]) -> None:
    exact = (Fraction(state[0]) ** 2 + Fraction(state[1]) ** 2) / 2
    with np.errstate(over="ignore"):
        found = float(energy(state))
    if exact > Fraction(MAX_FLOAT):
        assert found >= MAX_FLOAT
    else:  # three roundings of an ordinary number, and one to a subnormal one
        assert abs(Fraction(found) - exact) <= 3 * exact / 2**53 + Fraction(1, 2**1075)


@given(st.floats(-1e60, 1e60), st.floats(-1e60, 1e60))
def test_energy_has_the_bits_of_its_formula_for_ordinary_states(q: float, v: float) -> None:
    q, v = (x if abs(x) > 1e-60 else 0.0 for x in (q, v))
    assert energy((q, v)) == (q * q + v * v) / 2


@given(ANGLES, ANGLES, SCALES, SCALES)
def test_phase_error_is_the_difference_of_angles_wrapped(a: float, b: float, size: float, other: float) -> None:
    found = phase_error(at_angle(a, size), at_angle(b, other))
    assert found is not None
    assert -180 <= found < 180
    whole = (np.degrees(a) - np.degrees(b) - found) / 360
    # A dozen roundings of angles up to 360 degrees: 12 * 360 * 2^-53 degrees, 12 * 2^-53 turns.
    assert abs(whole - round(whole)) < 12 * 2.0**-53


OPPOSITE = [
    ((-1.0, 0.0), (1.0, 0.0)), ((-1.0, -0.0), (1.0, 0.0)), ((0.0, 2.0), (0.0, -2.0)), ((-3.0, 4.0), (3.0, -4.0)),
]  # fmt: skip


@pytest.mark.parametrize(("numerical", "exact"), OPPOSITE)
def test_half_a_turn_is_minus_180_never_180(numerical: tuple[float, float], exact: tuple[float, float]) -> None:
    assert phase_error(numerical, exact) == -180
    assert phase_error(exact, numerical) == -180


def test_angles_beside_half_a_turn_keep_their_sign() -> None:
    assert phase_error((-1.0, -1e-9), (1.0, 0.0)) > 179
    assert phase_error((-1.0, 1e-9), (1.0, 0.0)) < -179
    nearest_below_pi = (-1.0, -nextafter(0, 1))  # an angle that rounds to 180 degrees
    assert phase_error(nearest_below_pi, (1.0, 0.0)) == -180


def test_phase_error_is_undefined_at_the_origin_and_never_zero() -> None:
    assert phase_error((0.0, 0.0), (1.0, 0.0)) is None
    assert phase_error((1.0, 0.0), (0.0, -0.0)) is None
    several = phase_error((np.array([0.0, 1.0]), np.array([0.0, 0.0])), (1.0, 0.0))
    assert isnan(several[0])
    assert several[1] == 0


@pytest.mark.parametrize("x", [nan, inf, -inf])
def test_state_that_is_not_finite_has_no_phase_error_either(x: float) -> None:
    assert phase_error((x, 1.0), (1.0, 0.0)) is None
    assert phase_error((1.0, 0.0), (1.0, x)) is None


def test_smallest_states_have_a_phase() -> None:
    tiny = 5e-324
    assert phase_error((tiny, -tiny), (tiny, 0.0)) == 45
    assert phase_error((tiny, tiny), (1e308, 0.0)) == -45


def test_readouts_of_arrays_are_those_of_their_members() -> None:
    q, v = np.array([1.0, 0.3, -2.0]), np.array([0.0, -0.4, 1.5])
    exact = exact_state((q, v), 1.25)
    for i in range(3):
        member, its_exact = (q[i], v[i]), exact_state((q[i], v[i]), 1.25)
        assert state_error((q, v), exact)[i] == state_error(member, its_exact)
        assert energy((q, v))[i] == energy(member)
        assert phase_error((q, v), exact)[i] == phase_error(member, its_exact)
