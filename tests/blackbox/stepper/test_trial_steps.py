"""What the first steps of a stepper show: its precision, how many it needs, and slopes that it hands on wrongly."""

import numpy as np
import pytest

from driftproof import verify
from driftproof.blackbox.findings import StaleSlope
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.trial_steps import TRIAL_STATE, TRIAL_STEP
from driftproof.symbolic.rounding.formats import BINARY32, BINARY64


def step(f, t, y, h):
    return y + h * f(t, y)


def test_precision_is_that_of_the_answers_to_a_trial():
    assert opened(step).format is BINARY64
    assert opened(lambda f, t, y, h: np.float32(1) * step(f, t, y, h).astype(np.float32)).format is BINARY32
    again, end = opened(step).begun
    assert list(end) == list(again(opened(step))) == [1.0 + TRIAL_STEP * 0.75, 0.75 - TRIAL_STEP * TRIAL_STATE[0]]


def stale(force, q, v, a, h):
    """Velocity Verlet that hands on the force where it began."""
    q1 = q + h * v + h * h / 2 * a
    return q1, v + h / 2 * (a + force(q1)), force(q)


def test_a_slope_that_is_handed_on_from_the_wrong_place_is_named():
    with pytest.raises(StaleSlope, match="as the slope at its end"):
        opened(stale)


def heun_of_a_slope(y, dydx, x, h, derivs, share=1.0):
    """Heun's step that is handed its slope, with the error estimate beside it, or with a slope that is its start's."""
    last = derivs(x + h, y + h * dydx)
    return y + h / 2 * (dydx + last), h / 2 * (last - dydx) if share else dydx


@pytest.mark.parametrize(("share", "passed"), [(1.0, True), (0.0, False)])
def test_an_error_estimate_beside_the_end_is_no_slope_that_is_handed_on(share, passed):
    step = lambda y, dydx, x, h, derivs: heun_of_a_slope(y, dydx, x, h, derivs, share)
    assert verify(step, "heun_euler21", examples=50, isolate=False).passed is passed
