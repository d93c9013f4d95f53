"""On stiff driven systems the times of stages are judged by steps that show them, and left open where none does."""

from __future__ import annotations

import numpy as np
import pytest

from driftproof import Allowance, verify

FAST, CORNER = 1e5, 2e-6


def driven(t, y):
    """A low-pass filter driven far below its corner frequency."""
    return (np.sin(t) - np.array(y)) / CORNER


def quick(t, y):
    """One driven far above it: the source, not the state, changes in short steps."""
    return (325 * np.sin(2 * np.pi * FAST * t) - np.array(y)) / 1e-6


def clipped(t, y):
    """A diode clipper, so stiff near 1 V that its source does not change in a step as long as its own time."""
    return 1e3 * (np.sin(t) - np.array(y)) - 1e-4 * np.sinh(np.array(y) / 0.045)


def implicit(f, theta, at):
    """The theta method, its equation solved by Newton's method, with the time t + at h of the new stage."""

    def step(t, y, h):
        known, z = y + (1 - theta) * h * f(t, y), np.array(y, dtype=float)
        for _ in range(200):
            apart = 1e-7 * (1 + np.abs(z))
            slope = (f(t + at * h, z + apart) - f(t + at * h, z - apart)) / (2 * apart)
            change = (z - known - theta * h * f(t + at * h, z)) / (1 - theta * h * slope)
            z = z - np.clip(change, -0.1 * (1 + np.abs(z)), 0.1 * (1 + np.abs(z)))
            if np.abs(change).max() < 1e-14:
                break
        return z

    return step


CASES = {
    "fast source": (quick, 1.0, 1.0, "backward_euler", True, "is backward_euler on the system given"),
    "fast source, trapezoid": (quick, 0.5, 1.0, "trapezoid", True, "is trapezoid on the system given"),
    "slow source": (driven, 1.0, 1.0, "backward_euler", True, "is backward_euler on the system given"),
    "slow source, at t": (driven, 1.0, 0.0, "backward_euler", False, "is not backward_euler"),
    "diode": (clipped, 1.0, 1.0, "backward_euler", True, "longer ones, which show its times"),
    "diode, at t": (clipped, 1.0, 0.0, "backward_euler", None, "where backward_euler ends in"),
    "diode, at t + 2h": (clipped, 1.0, 2.0, "backward_euler", None, "where backward_euler ends in"),
    "diode, trapezoid at t": (clipped, 0.5, 0.0, "trapezoid", False, "is not trapezoid: a step of"),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_wrong_time_of_a_stage_does_not_pass_because_steps_are_too_short_to_show_it(name):
    f, theta, at, method, passed, said = CASES[name]
    allowed = Allowance(solver_tolerance=1e-12)
    found = verify(implicit(f, theta, at), method, system=f, allowance=allowed, isolate=False)
    assert (found.passed, said in found.verdict) == (passed, True), found.verdict
