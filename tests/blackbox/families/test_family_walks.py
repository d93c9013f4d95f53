"""Rosenbrock and IMEX steps far from home: right codes pass there, and what is wrong there alone is caught."""

import re

import numpy as np
import pytest
from flint import ctx

from driftproof import verify
from driftproof.blackbox.families import family_walks as walks
from driftproof.blackbox.families.family_walks import ImexWalker, WithDamping, derivatives
from driftproof.blackbox.judging.nonlinear_problems import driven
from driftproof.blackbox.judging.specification import Specification
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import FURTHER_METHODS
from tests.blackbox.families.linearised_steppers import linearly_implicit_euler, rosenbrock
from tests.blackbox.families.split_steppers import imex


def of_matrix(change):
    """ROS2 with another matrix in place of its Jacobian."""
    step = rosenbrock("ros2")
    return lambda f, jac, dfdt, t, y, h: step(f, lambda t, y: change(np.array(jac(t, y))), dfdt, t, y, h)


def of_times(change):
    """ROS2 that asks its right-hand side at other times."""
    step = rosenbrock("ros2")
    return lambda f, jac, dfdt, t, y, h: step(lambda at, y: f(change(at), y), jac, dfdt, t, y, h)


def of_split_times(change):
    """ARS(2,2,2) that asks f at other times."""
    step = imex("ars222")
    return lambda f_explicit, f_implicit, t, y, h: step(lambda at, y: f_explicit(change(at), y), f_implicit, t, y, h)


def back(f, jac, dfdt, t, y, h):
    """ROS2 whose df/dt has the other sign in steps back."""
    return rosenbrock("ros2")(f, jac, lambda t, y: np.sign(h) * np.array(dfdt(t, y)), t, y, h)


WRONG = {
    "a diagonal that is off": (of_matrix(lambda j: j * (1 + 1e-7 * np.eye(len(j)))), "ros2", "in a step of 0.1"),
    "a triangle of the matrix": (of_matrix(np.tril), "ros2", "y[1] is"),
    "times in binary32": (of_times(lambda at: float(np.float32(at))), "ros2", "in a step of 0.1 from t = 0.25"),
    "no sign of h": (back, "ros2", "a step with h < 0 is wrong: in a step of -0.07"),
    "a clock that stands": (of_split_times(lambda at: min(at, 10)), "ars222", "at t = 1004.1 it takes a different st"),
}


@pytest.mark.parametrize(("step", "key", "words"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_elsewhere_alone_is_caught(step, key, words):
    report = verify(step, key, isolate=False)
    assert report.passed is False
    assert report.verdict.startswith(f"is not {key}: ")
    assert words in report.verdict


RIGHT = {
    "rodas3": rosenbrock("rodas3", stored=True),
    "rodas4": rosenbrock("rodas4", time_slope="differences"),
    "ros2": rosenbrock("ros2", time_slope="none"),
    "ark324": imex("ark324"),
}


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("key", "step"), RIGHT.items(), ids=RIGHT)
def test_right_codes_are_right_everywhere_and_the_report_says_where(key, step):
    report = verify(step, key, isolate=False)
    assert report.passed, report.text()
    (line,) = report.section("Steps: passed").lines
    walks = r"\d+ runs, each step from the end of the previous one, the last from another state, with 1 to 7, 9, 13 "
    assert re.match(walks, line)


def test_derivatives_are_those_of_the_problem_to_the_last_bit():
    rows, slopes = derivatives(driven(1, timed=True), 0.5, [0.25])
    # f' of 4 (1 + t) y^2/(1 + y^2) at t = 1/2, y = 1/4; and φ'' + 4 y^2/(1 + y^2) - d/dt (4 (1 + t) φ^2/(1 + φ^2)).
    assert rows == [[6 * 2 * 0.25 / (1 + 0.25**2) ** 2]]
    bell, turned = 0.8, -2 * 0.5 * 0.8**2
    curved = 8 * 0.5**2 * bell**3 - 2 * bell**2
    pulled = 4 * bell**2 / (1 + bell**2) + 6 * 2 * bell * turned / (1 + bell**2) ** 2
    assert slopes[0] == pytest.approx(curved + 4 * 0.0625 / 1.0625 - pulled, rel=1e-15)


def test_stages_that_do_not_converge_are_none_to_be_held_to():
    problem, walker = (
        WithDamping(**vars(driven(1, timed=True))),
        ImexWalker(None, Specification(FURTHER_METHODS["ars111"])),
    )
    with ctx.workprec(192):
        assert walker.own_step(problem, 0.25, [0.5], 0.125)[0].rad() < 1e-30
    with pytest.raises(ArithmeticError, match="the stages of ars111 do not converge"):
        walker.own_step(problem, 0.25, [0.5], 64.0)


@pytest.mark.slow
def test_how_well_stages_are_solved_is_told():
    for key, words in (
        ("ars222", "is ars222, its stages solved to 2.3e-08"),
        ("ars443", "is not ars443: its equations are solved to 1.7e-06 only"),
    ):
        assert verify(imex(key, most=2), key, isolate=False).verdict == words


def test_what_a_step_elsewhere_may_be_off_by_grows_with_the_numbers_and_what_a_solver_leaves():
    """4 (calls + 2) u of twice the size; and four errors of df/dt in h^2, or what is left of the equations."""
    subject, u = opened(rosenbrock("ros2")), 2.0**-53
    linear = walks.RosenbrockWalker(subject, Specification(FURTHER_METHODS["ros2"]), slack=2.0**-26)
    assert linear.allowed(3.0, 5, 0.5) == pytest.approx(4 * (2 * 6 + 2) * u * 6 + 4 * 2.0**-26 * 0.25 * 3, rel=1e-12)
    split = ImexWalker(subject, Specification(FURTHER_METHODS["ars222"]), solved=2.0**-40)
    assert split.allowed(3.0, 5, 0.5) == pytest.approx(4 * (2 * 3 + 2) * u * 6 + 2.0**-40 * 3, rel=1e-12)


@pytest.mark.parametrize(("kind", "share"), [(walks.WithJacobian, 1.0), (walks.WithHalfJacobian, 0.5)])
def test_a_step_is_given_the_jacobian_or_half_of_it(kind, share):
    """Backward Euler's equation made linear, of 4 (1 + t) y^2/(1 + y^2) and what makes its solution known."""
    problem, y, h = kind(**vars(driven(1, timed=True))), 0.25, 0.125
    ((slope,),), _ = derivatives(problem, 0.5, [y])
    (after,) = problem.stepped(opened(linearly_implicit_euler), 0.5, [y], h)
    (rate,) = problem.rate(0.5, [y])
    assert after == pytest.approx(y + h * float(rate) / (1 - h * share * slope), rel=1e-14)
