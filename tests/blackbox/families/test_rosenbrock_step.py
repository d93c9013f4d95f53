"""What a step with a Jacobian makes of marks: its own gamma, its differences, and refusals in words."""

import numpy as np
import pytest

from driftproof.blackbox.families.rosenbrock_step import read_rosenbrock_step
from driftproof.blackbox.findings import StepRaised, UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import FACTS_ONLY
from tests.blackbox.families.linearised_steppers import floats, linearly_implicit_euler, ros2_by_hand, rosenbrock
from tests.looping import some


@pytest.mark.parametrize("key", ["ros2", "rodas4"])
def test_alpha_gamma_and_b_are_read_where_each_stage_has_a_call(key):
    method = FACTS_ONLY[key]
    read = read_rosenbrock_step(opened(rosenbrock(key))).table
    for seen, exact in some(zip(read, (method.alpha, method.gamma, [method.b]), strict=True)):
        assert np.allclose(seen, floats(exact), rtol=0, atol=1e-11)  # least squares of some dozen numbers up to 10


@pytest.mark.parametrize(("way", "by"), [("function", "a function"), ("differences", "differences"), ("none", "")])
def test_how_the_derivative_by_t_is_had_is_seen(way, by):
    reading = read_rosenbrock_step(opened(rosenbrock("ros3p", time_slope=way)))
    assert (reading.by, reading.time_slope is None) == (by, by == "")


def test_no_time_is_no_node_and_the_place_of_the_jacobian_is_told():
    assert read_rosenbrock_step(opened(ros2_by_hand)).nodes is None
    assert read_rosenbrock_step(opened(linearly_implicit_euler)).jacobian_at == (0.0, 0.0)
    assert read_rosenbrock_step(opened(rosenbrock("ros2", at_end=True))).jacobian_at == (1.0, 0.0)


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
