"""A step beside the method's own on a nonlinear problem: every family agrees with itself, and nothing else does."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.judging.agreement import NO_ALLOWANCE
from driftproof.blackbox.judging.nonlinear_step import nonlinear_agreement
from driftproof.blackbox.judging.tolerance import Allowance
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.methods.stepping import stepper
from tests.blackbox import handwritten_steppers as codes

SOLVED = Allowance(solver_tolerance=Fraction(1, 10**12))


def iterated(method):
    """An implicit method, its stages iterated: what converges at small steps."""
    a, b, c = method.tableau(64) if hasattr(method, "tableau") else (method.a, method.b, method.c)
    rows, b, c = [[float(x) for x in row] for row in a], [float(x) for x in b], [float(x) for x in c]

    def step(f, t, y, h):
        y = np.asarray(y)
        k = [0.0 * y for _ in b]
        for _ in range(100):
            k = [
                np.asarray(f(t + node * h, y + h * sum(x * s for x, s in zip(row, k, strict=True))))
                for node, row in zip(c, rows, strict=True)
            ]
        return y + h * sum(x * s for x, s in zip(b, k, strict=True))

    return step


@pytest.mark.parametrize("key", ["rk4", "dormand_prince54", "ssprk104", "velocity_verlet", "yoshida6", "nystrom5"])
def test_an_explicit_method_agrees_with_itself_by_its_force(key):
    found = nonlinear_agreement(opened(stepper(METHODS[key], float), "force"), METHODS[key], NO_ALLOWANCE)
    assert found.holds, found.words
    assert "the method's own step on q'' = exp(-2q)" in found.words


@pytest.mark.parametrize("key", ["rk4", "dormand_prince54", "fehlberg78"])
def test_an_explicit_method_agrees_with_itself_by_its_right_hand_side(key):
    found = nonlinear_agreement(opened(codes.tableau(*codes.floats(METHODS[key])), "field"), METHODS[key], NO_ALLOWANCE)
    assert found.holds, found.words
    assert found.steps == 6


IMPLICIT = [key for key, method in METHODS.items() if not method.explicit and type(method).__name__ != "Nystrom"]


@pytest.mark.parametrize("key", IMPLICIT)
def test_an_implicit_method_agrees_with_itself_and_with_no_neighbour(key):
    method = METHODS[key]
    subject = opened(iterated(method), "field")
    assert nonlinear_agreement(subject, method, SOLVED).holds
    other = METHODS["backward_euler" if key != "backward_euler" else "trapezoid"]
    assert not nonlinear_agreement(subject, other, SOLVED).holds


def test_the_worst_place_is_shown():
    found = nonlinear_agreement(opened(codes.rk38), METHODS["rk4"], NO_ALLOWANCE)
    assert not found.holds
    assert "in a step of 0.0625 from t = " in found.words
    assert "of rk4" in found.words


def test_a_coefficient_that_is_off_by_little_more_than_rounding_is_seen():
    rk4 = METHODS["rk4"]
    assert isinstance(rk4, RungeKutta)
    other = replace(rk4, b=(rk4.b[0] + Fraction(1, 2**34), *rk4.b[1:]))
    assert not nonlinear_agreement(opened(codes.rk4), other, NO_ALLOWANCE).holds


def test_narrow_floats_and_velocities_from_positions_have_their_allowance():
    single = opened(codes.in_precision(codes.rk4, np.float32), "field")
    assert nonlinear_agreement(single, METHODS["rk4"], NO_ALLOWANCE).holds
    quotient = opened(codes.velocity_from_positions)
    allowed = Allowance(velocity_from_positions=True)
    assert nonlinear_agreement(quotient, METHODS["symplectic_euler"], allowed).holds


def test_a_splitting_of_a_right_hand_side_is_compared_without_time():
    subject = opened(codes.symplectic_euler_in_a_field)
    assert "q'' = exp(-2q)" in nonlinear_agreement(subject, METHODS["symplectic_euler"], NO_ALLOWANCE).words


def test_a_built_in_system_is_not_asked():
    with pytest.raises(UnsupportedCall):
        nonlinear_agreement(opened(lambda q, v, h: (q + h * v, v - h * q)), METHODS["rk4"], NO_ALLOWANCE)
