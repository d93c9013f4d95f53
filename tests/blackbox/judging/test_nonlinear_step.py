"""A step beside the method's own on a nonlinear problem: every family agrees with itself, and nothing else does."""

from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
import pytest

from driftproof.blackbox.judging.nonlinear_problems import NonlinearProblem
from driftproof.blackbox.judging.nonlinear_step import (
    NonlinearComparison,
    nonlinear_agreement,
    nonlinear_twins,
    own_step,
)
from driftproof.blackbox.judging.specification import NO_ALLOWANCE, Allowance, Specification
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.implicit_steppers import all_at_once, fixed_point, table
from tests.blackbox.transcripts import Asked
from tests.catalogue.representatives import THOROUGH

SOLVED = Allowance(solver_tolerance=Fraction(1, 10**12))
RK4 = Specification(METHODS["rk4"])


def iterated(key):
    """An implicit method, its stages iterated: what converges at small steps."""
    return all_at_once(table(key), partial(fixed_point, most=100, tolerance=1e-15))


IMPLICIT = [key for key, method in METHODS.items() if not method.explicit and type(method).__name__ != "Nystrom"]


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("key", IMPLICIT if THOROUGH else IMPLICIT[::3])
def test_an_implicit_method_agrees_with_itself_and_with_no_neighbour(key):
    subject = opened(iterated(key), "field")
    assert nonlinear_agreement(subject, Specification(METHODS[key], SOLVED)).holds
    other = METHODS["backward_euler" if key != "backward_euler" else "trapezoid"]
    assert not nonlinear_agreement(subject, Specification(other, SOLVED)).holds


def test_stages_that_do_not_converge_are_no_step():
    with pytest.raises(ArithmeticError, match="gauss2"):
        own_step(METHODS["gauss2"], NonlinearProblem("", lambda t, y: [64 * y[0]], lambda t: [t]), 0.0, [1.0], 1.0)


@pytest.mark.parametrize(
    ("key", "allowance", "roundings", "more"),
    [
        ("rk4", NO_ALLOWANCE, 4 * (4 + 2), 0.0),
        ("ruth3", Allowance(velocity_from_positions=True), 4 * (6 + 2), 2 * 3.0 * 2.0**-24 / 0.125),
        ("gauss2", Allowance(solver_tolerance=2.0**-20), 4 * (2 + 2), 4 * 3.0 * 2.0**-20),
    ],
)
def test_a_number_may_be_off_by_what_rounding_a_quotient_and_a_solver_leave(key, allowance, roundings, more):
    subject = opened(codes.in_precision(codes.rk4, np.float32), "field")
    found = NonlinearComparison(subject, Specification(METHODS[key], allowance)).allowed(3.0, 1, -0.125)
    assert found == roundings * (2.0**-24 * 2 * 3.0 + 2.0**-149) + more


@pytest.mark.parametrize(("times", "holds"), [(3.9, True), (4.1, False)])
def test_a_solver_may_be_off_by_four_times_its_tolerance(times, holds):
    def off(f, t, y, h):
        return iterated("backward_euler")(f, t, y, h) + times * 1e-9 * (1 + np.max(np.abs(y)) + t)

    wanted = Specification(METHODS["backward_euler"], Allowance(solver_tolerance=Fraction(1, 10**9)))
    assert nonlinear_agreement(opened(off, "field"), wanted).holds == holds


def test_the_worst_place_is_shown(as_before):
    found = nonlinear_agreement(opened(codes.rk38), RK4)
    assert not found.holds
    as_before(found.words)


def test_a_coefficient_that_is_off_by_little_more_than_rounding_is_seen():
    rk4 = METHODS["rk4"]
    assert isinstance(rk4, RungeKutta)
    other = replace(rk4, b=(rk4.b[0] + Fraction(1, 2**34), *rk4.b[1:]))
    assert not nonlinear_agreement(opened(codes.rk4), Specification(other)).holds


def kick_drift_kick(where, times=(0.0, 1.0), left=None):
    """Velocity Verlet as step(f, t, y, h), its force asked at t + times h; one position may be left where it is."""

    def step(f, t, y, h):
        n = len(y) // 2
        y, parts = np.array(y), (np.s_[:n], np.s_[n:]) if where == "halves" else (np.s_[::2], np.s_[1::2])
        q, v = (y[part] for part in parts)
        v += h / 2 * np.array(f(t + times[0] * h, y))[parts[1]]
        q += [0 if i == left and n > left else h * x for i, x in enumerate(v)]
        v += h / 2 * np.array(f(t + times[1] * h, y))[parts[1]]
        return y

    return step


def drift_first(f, t, y, h):
    """Position-first symplectic Euler, whose force belongs to the end of the step."""
    n = len(y) // 2
    q = y[:n] + h * y[n:]
    return np.concatenate([q, y[n:] + h * np.array(f(t + h, np.concatenate([q, y[n:]])))[n:]])


def by_force(left=None, swapped=False):
    """Velocity Verlet as step(force, q, v, h) of several positions; of one it is right."""

    def step(force, q, v, h):
        v = v + h / 2 * force(q)
        q1 = q + h * v
        if left is not None and np.size(q) > left:
            q1[left] = q[left]
        v = v + h / 2 * force(q1)
        return q1, v[::-1] if swapped and np.size(v) > 1 else v

    return step


def with_times(last):
    """Velocity Verlet with a force of position and time, asked at t and t + last h."""

    def step(force, q, v, t, h):
        v = v + h / 2 * force(q, t)
        q = q + h * v
        return q, v + h / 2 * force(q, t + last * h)

    return step


OF_SEVERAL = {
    "halves": kick_drift_kick("halves"), "pairs": kick_drift_kick("pairs"),
    "a position left out": kick_drift_kick("halves", left=1),
    "the other left out": kick_drift_kick("pairs", left=0),
    "a clock that stands": kick_drift_kick("halves", times=(0, 0)),
    "times exchanged": kick_drift_kick("pairs", times=(1, 0)),
    "a force": by_force(), "a force, a position left out": by_force(left=1),
    "a force, rows exchanged": by_force(swapped=True), "a force of time": with_times(1),
    "a force of the wrong time": with_times(0), "drift first": drift_first,
    "drift first, kicked early": lambda f, t, y, h: drift_first(lambda at, z: f(t, z), t, y, h),
}  # fmt: skip
RIGHT = ("halves", "pairs", "a force", "a force of time", "drift first")


@pytest.mark.parametrize("name", OF_SEVERAL)
def test_no_position_and_no_time_of_a_splitting_is_left_out(name, as_before):
    asked = Asked(OF_SEVERAL[name])
    method = METHODS["symplectic_euler_position_first" if name.startswith("drift first") else "velocity_verlet"]
    found = nonlinear_agreement(opened(asked.code), Specification(method))
    assert found.holds == (name in RIGHT), found.words
    as_before(found.words, asked)


def floats_only(force, q, v, h):
    return codes.velocity_verlet(force, float(q), float(v), h)


def of_two_positions(force, q, v, h):
    first, second = q
    return codes.velocity_verlet(force, np.array([first, second]), v, h)


def one_by_one(force, q, v, h):
    pairs = [codes.velocity_verlet(force, x, w, h) for x, w in zip(q, v, strict=True)]
    return [x for x, _ in pairs], [w for _, w in pairs]


LARGEST = {
    codes.velocity_verlet: "a nonlinear q'' = F(q) of 3 positions, one being the time",
    of_two_positions: "a nonlinear q'' = F(q) of 2 positions, one being the time",
    floats_only: "q'' = exp(-2q)",
    one_by_one: "q'' = exp(-2q) of 3 positions",
    codes.symplectic_euler_in_a_field: "a nonlinear q'' = F(t, q)",
    codes.rk4: "a nonlinear q'' = F(t, q) of 3 positions",
    codes.rk4_without_time: "a nonlinear q'' = F(q) of 3 positions, one being the time",
}


@pytest.mark.parametrize(("step", "problem"), LARGEST.items(), ids=lambda each: getattr(each, "__name__", ""))
def test_a_stepper_is_asked_with_the_most_positions_that_it_takes(step, problem):
    assert nonlinear_agreement(opened(step), Specification(METHODS["velocity_verlet"])).problem == problem


def test_of_methods_with_one_linear_step_those_are_kept_whose_nonlinear_steps_it_takes():
    keys = ("implicit_midpoint", "trapezoid", "lobatto_iiib2")
    assert nonlinear_twins(opened(iterated("trapezoid"), "field"), keys) == ("trapezoid",)
    assert nonlinear_twins(opened(iterated("backward_euler"), "field"), keys) == ()
