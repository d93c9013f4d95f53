"""What families of steps return besides y1: a pair's estimate passes, a wrong one fails, what is not judged is said."""

import numpy as np
import pytest

from driftproof.blackbox.verify import verify
from driftproof.methods.catalogue import FURTHER_METHODS
from tests.blackbox.families.linearised_steppers import rosenbrock
from tests.blackbox.families.remembering_steppers import Remembering
from tests.blackbox.families.split_steppers import imex
from tests.blackbox.handwritten_steppers import euler


@pytest.mark.parametrize(
    ("key", "factor", "off", "words"),
    [
        ("ode23s", 1, 0, "is ode23s"),
        ("rodas3", -1, 0, "is rodas3"),
        ("ros2", 2, 0, "is ros2, but the error estimate is 2 times that of ros2"),
        (
            *("ode23s", 1, 2 / 3),
            "is ode23s, but the error estimate is not that of ode23s: the slope of call 1 enters the estimate with "
            "-1/3 instead of 0.333333",
        ),
    ],
)
def test_an_error_estimate_is_held_to_the_embedded_row(key, factor, off, words):
    """The mistake is the sign of one weight."""
    method = FURTHER_METHODS[key]
    row = [factor * (float(x) - float(z)) for x, z in zip(method.b, method.b_embedded, strict=True)]
    row[1] -= off
    report = verify(rosenbrock(key, estimate=row), key, isolate=False)
    assert (report.verdict.startswith(words), report.passed) == (True, "but" not in words)


def test_another_result_is_that_of_the_other_row_and_a_norm_is_said_not_to_be_judged():
    def pair(f, jac, t, y, h, last=lambda y1, error: y1 - error):
        g, k = 1 - 2**-0.5, [0 * y]
        for c in (0, 1):
            rate = f(t + c * h, y + c * h * k[-1]) - 2 * c * k[-1]
            k.append(np.linalg.solve(np.eye(len(y)) - g * h * np.asarray(jac(t, y)), rate))
        y1, error = y + h * (1.5 * k[1] + 0.5 * k[2]), h / 2 * (k[1] + k[2])
        return y1, last(y1, error)

    assert "other row of ros2" in verify(pair, "ros2", isolate=False).section("Error estimate: passed").lines[0]
    normed = lambda f, jac, t, y, h: pair(f, jac, t, y, h, lambda y1, error: float(np.linalg.norm(error)))
    unsaid = "; what it returns besides y1 is not judged: it is one number, such as a norm of an error estimate"
    report = verify(normed, "ros2", isolate=False)
    assert (report.passed, report.verdict, report.data["remarks"]) == (True, "is ros2" + unsaid, [unsaid[2:]])
    timed = lambda f, jac, t, y, h: pair(f, jac, t, y, h, lambda y1, error: t + h)
    assert verify(timed, "ros2", isolate=False).verdict == "is ros2"


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("off", "wrong"), [(0.0, False), (0.25, True)])
def test_the_other_result_of_a_pair_is_held_to_its_embedded_rows(off, wrong):
    row = np.array([*map(float, FURTHER_METHODS["ark324"].b_explicit_embedded)])
    report = verify(imex("ark324", other=row + off * np.array([0, 1, -1, 0])), "ark324", isolate=False)
    assert report.passed is not wrong
    assert ("the error estimate is not that of ark324: b_explicit[1]" in report.verdict) is wrong


def test_a_run_that_takes_a_jacobian_is_held_to_a_multistep_method_with_differences():
    def two_steps(f, jac, t, y, h, n):
        states, slopes = [y, y + h * f(t, y) + 0 * (jac(t, y) @ y)], [f(t, y)]
        for i in range(1, n):
            slopes.append(f(t + i * h, states[-1]))
            states.append(states[-1] + h * (1.5 * slopes[-1] - 0.5 * slopes[-2]))
        return states[: n + 1]

    report = verify(two_steps, "adams_bashforth2", isolate=False)
    assert (report.passed, "it was handed differences of f" in report.verdict) == (True, True), report.verdict


def test_what_a_method_without_an_embedded_row_returns_is_said_not_to_be_judged():
    report = verify(imex("ars222", other=[1, 0, 0]), "ars222", isolate=False)
    assert report.verdict == "is ars222; what it returns besides y1 is not judged: ars222 defines no error estimate"
    assert report.passed


def test_an_estimate_that_a_step_returns_is_said_not_to_be_judged():
    key = "adams_bashforth2"
    made = Remembering(key, euler)

    def pair(f, t, y, h):
        y1 = made.step(f, t, y, h)
        return y1, y1 - y - h * f(t, y)

    report = verify(pair, key, isolate=False)
    unjudged = "what it returns besides y1 is not judged: no method defines it"
    assert (report.passed, report.data["remarks"]) == (True, [unjudged])
    assert f"started by forward_euler; {unjudged}" in report.verdict
