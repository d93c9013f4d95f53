"""What a step with a Jacobian makes of marks: its own gamma, its differences, and refusals in words."""

import numpy as np
import pytest

from driftproof.blackbox.families.rosenbrock_step import read_rosenbrock_step
from driftproof.blackbox.findings import StepRaised, UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from tests.blackbox.families.linearised_steppers import linearly_implicit_euler, rosenbrock
from tests.looping import some


def test_a_step_in_binary32_is_read_to_its_own_rounding():
    def ros2(f, jac, t, y, h, off=0.0):
        single = lambda x: np.asarray(x, dtype=np.float32)
        y, h, gamma = single(y), np.float32(h), np.float32(1 - 2**-0.5)
        system = np.eye(len(y), dtype=np.float32) - gamma * h * single(jac(t, y))
        k1 = np.linalg.solve(system, single(f(t, y)))
        k2 = np.linalg.solve(system, single(f(t + h, y + h * k1)) - 2 * k1)
        return y + h * (single(1.5) * k1 + single(0.5) * k2) * single(1 + off * (h != 1))

    assert verify(ros2, "ros2", isolate=False).verdict == "is ros2"
    with pytest.raises(NotReadable, match="does not scale with h"):
        read_rosenbrock_step(opened(lambda f, jac, t, y, h: ros2(f, jac, t, y, h, 2.0**-12)))


def test_what_is_no_such_step_is_refused_in_words():
    def limited(f, jac, t, y, h):
        return y + h * np.clip(f(t, y) + h * np.asarray(jac(t, y)) @ f(t, y), -0.5, 0.5)

    ros2 = rosenbrock("ros2", time_slope="none")
    scales = "with other slopes and h = 0.5 it ends at .*, where the coefficients read give .* does not scale with h"
    for step, words in some(
        [
            (limited, "not linear in its slopes"),
            (lambda f, jac, t, y, h: ros2(f, jac, t, y, h) + (h != 1), scales),
            (lambda f, jac, t, y, h: ros2(f, jac, t, y, h) + 0 * (h != 1 and f(t, y)), "on the answers: 2, then 3"),
            (lambda f, jac, t, y, h: ros2(f, jac, t, y, h) + 0 * (any(f(t, y)) and f(t + h, y)), "answers: 4, then 3"),
            (lambda f, jac, t, y, h: y + h * f(t, y), "never calls"),
            (lambda f, jac, t, y, h: y + h * (f(t, y) + 0 * jac(t, y)[0] + 1), "y = 0 does not stay"),
            (lambda f, jac, t, y, h: y + 0 * (f(t, y) + jac(t, y)[0]), "no call moves the step"),
        ]
    ):
        with pytest.raises(NotReadable, match=words):
            read_rosenbrock_step(opened(step))
    subject = opened(linearly_implicit_euler)
    subject.function = lambda f, jac, t, y, h: 1 // 0
    with pytest.raises(StepRaised, match="ZeroDivisionError"):
        read_rosenbrock_step(subject)
    with pytest.raises(UnsupportedCall, match="takes no Jacobian"):
        read_rosenbrock_step(opened(lambda f, t, y, h: y + h * f(t, y)))
