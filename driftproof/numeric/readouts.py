"""Readouts of a final state: errors, energy, phase. Floats or arrays in, the same out."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

# A float or an array of them; pairs (q, v) broadcast against each other.
FloatOrArray: TypeAlias = Any
FloatState: TypeAlias = tuple[FloatOrArray, FloatOrArray]
# Of a problem: the energy less that of the solution at the same time.
ENERGY_ERROR = "energy_error"
# Readouts of all states on the way, which are then kept.
TRAJECTORY, LARGEST_STATE_ERROR, LARGEST_CHANGE, LARGEST_ERROR = ON_THE_WAY = (
    *("trajectory", "largest_error"),
    *("largest_energy_change", "largest_energy_error"),
)


def exact_state(start: FloatState, t: FloatOrArray) -> FloatState:
    """(q₀ cos t + v₀ sin t, v₀ cos t - q₀ sin t), the solution of q' = v, v' = -q at time t, in floats."""
    q, v = start
    c, s = np.cos(t), np.sin(t)
    return q * c + v * s, v * c - q * s


def state_error(state: FloatState, exact: FloatState) -> FloatOrArray:
    """The Euclidean distance between two states, by hypot, which does not overflow where it is representable."""
    return np.hypot(state[0] - exact[0], state[1] - exact[1])


def energy(state: FloatState) -> FloatOrArray:
    """½(q² + v²); inf or 0 only where no float is nearer: for |q| from about 1.9e154 on, and below 3e-162.

    The components are divided by a power of two, which rounds nothing, so that their squares neither overflow nor
    vanish before they are added.
    """
    q, v = state
    if {np.asarray(x).dtype.kind for x in state} != {"f"}:  # exact numbers do not overflow
        return (q * q + v * v) / 2
    _, exponent = np.frexp(np.maximum(np.abs(q), np.abs(v)))
    q, v = np.ldexp(q, -exponent), np.ldexp(v, -exponent)
    return np.ldexp((q * q + v * v) / 2, 2 * exponent)


def float_energy_change(state: FloatState, start: FloatState) -> FloatOrArray:
    """½(q² + v²) at `state` minus that at `start`."""
    return energy(state) - energy(start)


def phase_error(state: FloatState, exact: FloatState) -> FloatOrArray:
    """The signed angle in degrees, in [-180, 180), by which `state` is ahead of (clockwise from) `exact`.

    atan2 of cross and dot product, so it is wrapped by construction: whole turns are not counted. At the origin the
    angle is undefined: NaN in an array, None for a single state, never 0.
    """
    (q, v), (q_exact, v_exact) = _to_unit_box(*state), _to_unit_box(*exact)
    ahead = np.degrees(np.arctan2(q * v_exact - v * q_exact, q * q_exact + v * v_exact))
    ahead = np.where(ahead == 180, -180.0, ahead)
    if ahead.ndim:
        return ahead
    return None if np.isnan(ahead) else float(ahead)


def _to_unit_box(q: FloatOrArray, v: FloatOrArray) -> FloatState:
    """(q, v) divided by max(|q|, |v|), so that products neither overflow nor underflow; NaN at the origin."""
    size = np.maximum(np.abs(q), np.abs(v))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.divide(q, size), np.divide(v, size)
